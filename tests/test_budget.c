/* Budgets of time: what frames are allotted, on machines that are made up here and that are as
 * fast as was thought, or not; and films rendered again by the manifest that remembers it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "program.h"
#include "scenes.h"
#include "sequence/budget.h"
#include "sequence/forecast.h"

/* ---- machines that are made up --------------------------------------------------------------
 */

typedef struct machine {
    zt_plan plan;
    double slow;   /* than it was when the costs were measured */
    double jitter; /* of each frame's time */
} machine;

enum { FRAMES_MAX = 1000, FIRST = 7 };

/* What each frame took, and all of them. */
typedef struct outcome {
    zt_sampling sampling[FRAMES_MAX];
    double frame_s[FRAMES_MAX], all_s;
} outcome;

static bool adaptive(const zt_plan *p) { return p->sampling.min != p->sampling.max; }

/* What the film is in truth: frames in the middle cost more, and are noisier. */
static double bell(const zt_plan *p, int64_t frame) {
    double x = 2.0 * (double)(frame - FIRST) / (double)(p->frame_count - 1) - 1;
    return 1 - x * x;
}
static double true_cost(const zt_plan *p, int64_t frame, double work) {
    return 0.01 + (adaptive(p) ? 2e-6 : 0.002) * (1 + bell(p, frame)) * work;
}
static double noise(const zt_plan *p, int64_t frame) { return 0.1 + 0.2 * bell(p, frame); }

/* Errors fall by samples^-0.5 here; adaptive ones ask for error^-1.7 work. */
static machine new_machine(int frame_count, zt_budget budget, zt_sampling sampling) {
    static int64_t frames[FRAMES_MAX];
    for (int i = 0; i < FRAMES_MAX; i++) frames[i] = FIRST + i;
    machine m = {.plan = {.frames = frames,
                          .frame_count = frame_count,
                          .budget = budget,
                          .sampling = sampling,
                          .power = 1.7,
                          .cost_count = ZT_COSTS_MAX},
                 .slow = 1};
    for (int i = 0; i < ZT_COSTS_MAX; i++) {
        int64_t frame = 7 + (frame_count - 1) * i / (ZT_COSTS_MAX - 1);
        double e = noise(&m.plan, frame) / 0.2, fixed = true_cost(&m.plan, frame, 0);
        m.plan.costs[i] = (zt_cost){frame, fixed, true_cost(&m.plan, frame, 1) - fixed,
                                    adaptive(&m.plan) ? 1 : e * e};
    }
    return m;
}

/* Renders the film, `passed_s` after its budget began. */
static outcome run_machine(machine *m, double passed_s) {
    outcome o = {.all_s = passed_s};
    uint64_t random = 5;
    zt_plan_begin(&m->plan, passed_s);
    for (int i = 0; i < m->plan.frame_count; i++) {
        int64_t f = m->plan.frames[i];
        zt_sampling s = o.sampling[i] = zt_plan_sampling(&m->plan, f);
        double work = adaptive(&m->plan) ? pow(s.error, -1.7) : s.max;
        o.frame_s[i] = m->slow * (1 + m->jitter * test_between(&random, -1, 1)) *
                       true_cost(&m->plan, f, work);
        o.all_s += o.frame_s[i];
        zt_plan_done(&m->plan, f, o.frame_s[i], o.all_s);
    }
    return o;
}

static const zt_sampling even = {.min = 4, .max = 4},
                         by_error = {.min = 4, .max = 64, .error = 0.01};

static void assert_within(double value, double wanted, double share) {
    if (fabs(value - wanted) > share * wanted)
        fail_msg("%g is not within %g %% of %g", value, 100 * share, wanted);
}

/* The film is done in its time, whether the machine turns out to be as fast as it was, faster
 * or slower, and however uneven. */
static void films_are_done_in_time(void **state) {
    (void)state;
    const struct {
        double slow, jitter, off;
    } cases[] = {{1, 0, 0.03},      {1, 0.2, 0.03}, {0.8, 0.05, 0.05},
                 {1.3, 0.05, 0.05}, {2, 0.1, 0.12}, {0.5, 0.1, 0.12}};
    for (int a = 0; a < 2; a++)
        for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
            machine m = new_machine(200, (zt_budget){.film_s = 60}, a ? by_error : even);
            m.slow = cases[i].slow;
            m.jitter = cases[i].jitter;
            assert_within(run_machine(&m, 6).all_s, 60, cases[i].off);
        }
}

/* All frames have about the same error, those between the nine that were looked at too, though
 * some take twice as long for each and some are three times as noisy; what is adaptive has one
 * error for all. */
static void frames_end_with_the_same_error(void **state) {
    (void)state;
    machine m = new_machine(200, (zt_budget){.film_s = 200}, even);
    outcome o = run_machine(&m, 0);
    double first = noise(&m.plan, 7) / sqrt(o.sampling[0].max);
    assert_true(o.sampling[100].max > 7 * o.sampling[0].max);
    for (int i = 0; i < 200; i++)
        assert_within(noise(&m.plan, 7 + i) / sqrt(o.sampling[i].max), first, 0.1);
    m = new_machine(200, (zt_budget){.film_s = 200}, by_error);
    o = run_machine(&m, 0);
    for (int i = 0; i < 200; i++) {
        assert_within(o.sampling[i].error, o.sampling[0].error, 0.05);
        assert_int_equal(o.sampling[i].min, 4);
        assert_true(o.sampling[i].max > 1000);
    }
}

/* Noise does not pump: also while a plan is corrected, no frame differs much from the one
 * before; and where one sample more would be much, their number does not go up and down. */
static void counts_are_smooth(void **state) {
    (void)state;
    for (int a = 0; a < 4; a++) {
        zt_budget budget = a & 1 ? (zt_budget){.film_s = 200} : (zt_budget){.frame_s = 1};
        machine m = new_machine(200, budget, a & 2 ? by_error : even);
        m.slow = 1.5;
        m.jitter = 0.3;
        outcome o = run_machine(&m, 0);
        for (int i = 1; i < 200; i++) {
            double ratio = a & 2 ? o.sampling[i].error / o.sampling[i - 1].error
                                 : (double)o.sampling[i].max / o.sampling[i - 1].max;
            double step = a & 2 ? 1.06 : 1.15 + 1.0 / o.sampling[i].max;
            assert_true(ratio < step && ratio > 1 / step);
        }
    }
    machine m = new_machine(200, (zt_budget){.film_s = 200 * 0.013}, even);
    for (int i = 0; i < ZT_COSTS_MAX; i++) /* alike; one and a half samples fit */
        m.plan.costs[i] = (zt_cost){m.plan.costs[i].frame, 0.01, 0.002, 1};
    m.jitter = 0.02;
    outcome o = run_machine(&m, 0);
    int changes = 0;
    for (int i = 1; i < 200; i++) changes += o.sampling[i].max != o.sampling[i - 1].max;
    assert_true(changes <= 2);
}

/* With a budget for each frame, each takes as long, soon also where the machine is slower. */
static void frames_are_done_in_time(void **state) {
    (void)state;
    for (int a = 0; a < 2; a++) {
        machine m = new_machine(100, (zt_budget){.frame_s = 0.5}, a ? by_error : even);
        outcome o = run_machine(&m, 3);
        for (int i = 0; i < 100; i++) assert_within(o.frame_s[i], 0.5, 0.03);
        m = new_machine(100, (zt_budget){.frame_s = 0.5}, a ? by_error : even);
        m.slow = 1.4;
        o = run_machine(&m, 3);
        for (int i = 12; i < 100; i++) assert_within(o.frame_s[i], 0.5, 0.06);
    }
}

/* A frame that is noisier than all that were looked at ends: once it has had, on average, the
 * samples that take half as long again as it is allotted. */
static void noisy_frames_end(void **state) {
    (void)state;
    zt_sampling sampling = {.min = 4, .max = 64, .error = 0.01};
    machine m = new_machine(24, (zt_budget){.frame_s = 2}, sampling);
    zt_plan_begin(&m.plan, 0);
    assert_int_equal(zt_plan_sampling(&m.plan, 9).mean_max, 0); /* nothing is known */
    m.plan.sample_s = 0.05;
    for (int i = 0; i < m.plan.frame_count; i++) {
        int bound = zt_plan_sampling(&m.plan, m.plan.frames[i]).mean_max;
        assert_in_range(bound, 57, 61);
    }
}

/* Less than one sample is none: the least is taken, and said to take longer. More than
 * is of use is not taken. One frame is a film, too. */
static void ends_of_the_range(void **state) {
    (void)state;
    machine m = new_machine(50, (zt_budget){.film_s = 0.1}, even);
    outcome o = run_machine(&m, 5);
    for (int i = 0; i < 50; i++) assert_int_equal(o.sampling[i].max, 1);
    assert_within(zt_plan_least_s(&m.plan), o.all_s - 5, 0.02);
    m = new_machine(50, (zt_budget){.film_s = 1e9}, even);
    o = run_machine(&m, 0);
    for (int i = 0; i < 50; i++) assert_int_equal(o.sampling[i].max, 65536);
    m = new_machine(50, (zt_budget){.film_s = 1e9}, even);
    m.plan.enough = 64;
    o = run_machine(&m, 0);
    for (int i = 0; i < 50; i++) assert_int_equal(o.sampling[i].max, 64);
    m = new_machine(2, (zt_budget){.film_s = 2}, even);
    m.plan.frame_count = 1;
    m.plan.cost_count = 1;
    zt_plan_begin(&m.plan, 0.2);
    int samples = zt_plan_sampling(&m.plan, 7).max;
    assert_within(0.2 + true_cost(&m.plan, 7, samples), 2, 0.02);
    for (int a = 0; a < 2; a++) { /* by an error; what the pilot took is the film's */
        m = new_machine(2, a ? (zt_budget){.film_s = 2} : (zt_budget){.frame_s = 2}, by_error);
        m.plan.frame_count = 1;
        m.plan.cost_count = 1;
        zt_plan_begin(&m.plan, 0.6);
        double work = pow(zt_plan_sampling(&m.plan, 7).error, -1.7);
        assert_within(true_cost(&m.plan, 7, work), a ? 1.4 : 2, 0.02);
    }
}

/* ---- films ----------------------------------------------------------------------------------
 */

/* How many a manifest says that each pixel of a frame takes. */
static int samples_of(const char *manifest, int frame) {
    char words[32];
    snprintf(words, sizeof words, "{\"frame\": %d, \"samples\": ", frame);
    const char *at = strstr(manifest, words);
    if (!at) fail_msg("no frame %d in %s", frame, manifest);
    return atoi(at + strlen(words));
}

/* The film, with as many samples as an error asks for. */
static void write_adaptive_film(void) {
    char text[sizeof film + 64];
    const char *at = strstr(film, " }\n");
    snprintf(text, sizeof text, "%.*s, samples: { min: 4, max: 64, error: 0.01 }%s",
             (int)(at - film), film, at);
    write_text("adaptive.yaml", text);
}

/* A film with a budget is done in about that time, has more than one sample a pixel, says
 * which, and comes out with the same bits again by its manifest, whatever the clock says and on
 * one thread; a part of it, too. What a manifest does not hold is refused. */
static void films_come_out_again(void **state) {
    (void)state;
    char manifest[TEXT_MAX];
    const char *films[] = {"film.yaml", "film.yaml", "adaptive.yaml"};
    const char *budgets[] = {"--time 1s", "--time-per-frame 200ms", "--time 1s"};
    write_adaptive_film();
    for (int i = 0; i < 3; i++) {
        char command[256];
        snprintf(command, sizeof command, "render %s -o a.hash %s", films[i], budgets[i]);
        zoetrope_succeeds(command);
        read_text(manifest, "a.hash.manifest");
        assert_contains(manifest, films[i]);
        assert_contains(manifest, "\"size\": [64, 36]");
        if (i < 2) assert_true(samples_of(manifest, 0) > 4 && samples_of(manifest, 5) > 4);
        snprintf(command, sizeof command,
                 "render %s --manifest a.hash.manifest --threads 1 -o b.hash", films[i]);
        zoetrope_succeeds(command);
        assert_true(same_files("a.hash", "b.hash"));
        assert_false(exists("b.hash.manifest")); /* nothing was chosen */
    }
    zoetrope_succeeds("render film.yaml --frames 2-3 --time 300ms --size 32x18 -o a.hash");
    zoetrope_succeeds("render film.yaml --manifest a.hash.manifest -o b.hash");
    assert_true(same_files("a.hash", "b.hash"));
    run *r = zoetrope("frame film.yaml 1 --manifest a.hash.manifest -o c.hash");
    assert_int_equal(r->code, 2);
    assert_contains(r->err, "the manifest has no frame 1");
    assert_false(exists("c.hash"));
}

/* What cannot be is said; what makes no sense is refused before anything is rendered. */
static void misuse(void **state) {
    (void)state;
    const struct {
        const char *arguments;
        int code;
        const char *told;
    } cases[] = {
        {"render film.yaml --time", 2, "such as --time=20min"},
        {"render film.yaml --time 20", 2, "--time 20: must be a time"},
        {"render film.yaml --time 0s", 2, "must be a time"},
        {"render film.yaml --time -1s", 2, "must be a time"},
        {"render film.yaml --time 1e3s", 2, "must be a time"},
        {"render film.yaml --time 1..2s", 2, "must be a time"},
        {"render film.yaml --time 0x2s", 2, "must be a time"},
        {"render film.yaml --time-per-frame 2m", 2, "--time-per-frame 2m: must be a time"},
        {"render film.yaml --time 2s --time-per-frame 2s", 2, "do not go together"},
        {"render film.yaml --time 2s --samples 4", 2, "--time and --samples"},
        {"render film.yaml --manifest x --samples 4", 2, "--manifest and --samples"},
        {"render film.yaml --manifest x --time 2s", 2, "do not go together"},
        {"check film.yaml --time 2s", 2, "check takes no --time"},
        {"preview film.yaml --time 2s", 2, "preview takes no --time"},
        {"render film.yaml --manifest missing", 3, "cannot read missing"},
        {"render film.yaml --manifest film.yaml", 3, "film.yaml:1:1: error: here must be a {"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run *r = zoetrope(cases[i].arguments);
        if (r->code != cases[i].code)
            fail_msg("zoetrope %s ended with %d", cases[i].arguments, r->code);
        assert_contains(r->err, cases[i].told);
    }
    assert_int_equal(entry_count("."), 1); /* film.yaml alone */
    run *r = zoetrope("frame film.yaml 0 --size 2000x2000 --time 1ms -o x.hash");
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "warning: the film takes about");
    zoetrope_succeeds("render film.yaml --manifest x.hash.manifest --frames 0 -o y.hash");
    assert_true(same_files("x.hash", "y.hash"));
}

/* A film of which all samples agree is known to be exact. */
static void exact_films_are_known(void **state) {
    (void)state;
    write_text("blank.yaml", "zoetrope: 1\n"
                             "film: { size: [32, 32], duration: 4 }\n"
                             "camera: { position: [0, 0, 6], look_at: [0, 0, 0] }\n"
                             "lights: [ ambient: { intensity: 0.5 } ]\n"
                             "objects: [ box: { center: [0, 0, 0], size: 100 } ]\n");
    run *r = zoetrope("render blank.yaml --time 500ms -o x.hash");
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "no samples of a pixel differ");
    char manifest[TEXT_MAX];
    read_text(manifest, "x.hash.manifest");
    for (int f = 0; f < 4; f++) assert_int_equal(samples_of(manifest, f), 64);
}

/* A picture of which the first samples of all pixels take a second, and further ones, of a few
 * of them, as errors ^ -1.5 and four times as long each. */
enum { MIDDLES = 1000000 };
static double samples_at(int error) {
    return MIDDLES * (1 + pow(zt_expect_error(error), -1.5) / 500);
}
static double seconds_at(int error) { return 1 + 4 * (samples_at(error) / MIDDLES - 1); }

/* As it is seen with an error, when so many times too many further samples are expected. */
static zt_forecast seen_at(int error, double too_many, bool is_random) {
    zt_forecast f = {.many = 1, .least = MIDDLES, .growth = 1, .error = error, .times = 1};
    f.samples = samples_at(error);
    f.all_s = seconds_at(error);
    f.sample_s = f.all_s / f.samples;
    f.expected.is_random = is_random;
    for (int i = error; i < ZT_EXPECT_COUNT; i++)
        f.expected.further[i] = too_many * (samples_at(i) - samples_at(error));
    return f;
}

/* Two looks tell what many more samples take: what each of these takes, and that where light
 * is random too few of them at first mean nothing. Rather more than less is thought of. */
static void further_samples_are_foreseen(void **state) {
    (void)state;
    const int few = 3 * ZT_EXPECT_OCTAVE, some = 6 * ZT_EXPECT_OCTAVE;
    for (int is_random = 0; is_random < 2; is_random++)
        for (int more = some; more < 8 * ZT_EXPECT_OCTAVE; more++) {
            const zt_forecast before = seen_at(few, is_random ? 2 : 1, is_random);
            zt_forecast f = seen_at(some, 1, is_random);
            zt_forecast_learn(&f, &before);
            const double seconds = zt_forecast_seconds(&f, more);
            assert_within(seconds, 1.15 * seconds_at(more), 0.18);
            const int found = zt_forecast_error(&f, seconds);
            assert_int_equal(found, more);
        }
}

/* Of a larger picture the least samples are as many more; others as its edges are longer, or,
 * of random light, as it has more pixels. */
static void larger_pictures_are_foreseen(void **state) {
    (void)state;
    for (int is_random = 0; is_random < 2; is_random++) {
        const zt_forecast f = seen_at(6 * ZT_EXPECT_OCTAVE, 1, is_random);
        const zt_forecast large = zt_forecast_larger(&f, 4);
        const double more = f.samples - f.least;
        assert_within(large.least, 4 * f.least, 1e-12);
        assert_within(large.samples, 4 * f.least + (is_random ? 4 : 2) * more, 1e-12);
        assert_within(zt_forecast_seconds(&large, large.error), large.all_s, 1e-12);
        if (is_random) assert_within(large.all_s, 4 * f.all_s, 1e-12);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(further_samples_are_foreseen),
        cmocka_unit_test(larger_pictures_are_foreseen),
        cmocka_unit_test(films_are_done_in_time),
        cmocka_unit_test(frames_end_with_the_same_error),
        cmocka_unit_test(counts_are_smooth),
        cmocka_unit_test(frames_are_done_in_time),
        cmocka_unit_test(noisy_frames_end),
        cmocka_unit_test(ends_of_the_range),
        IN_DIRECTORY(films_come_out_again),
        IN_DIRECTORY(misuse),
        IN_DIRECTORY(exact_films_are_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
