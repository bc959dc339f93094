/* Replay: that the samples which it tells of are those that made the pixel, that what it says
 * of their rays is so, and what the program prints of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <zoetrope/animation.h>
#include <zoetrope/replay.h>

#include "program.h"
#include "scenes.h"

/* ---- what was told, kept --------------------------------------------------------------------
 */

enum { SAMPLES_MAX = 600, RAYS_MAX = 6, LAMPS_MAX = 4 };

typedef struct told_ray {
    zt_replay_ray ray;
    zt_replay_lamp lamps[LAMPS_MAX];
    char hit[32], hiders[LAMPS_MAX][32];
} told_ray;

typedef struct told_sample {
    zt_replay_sample sample;
    told_ray rays[RAYS_MAX];
} told_sample;

typedef struct told_pixel {
    told_sample samples[SAMPLES_MAX];
    int count;
    zt_replayed result;
} told_pixel;

static void keep(void *user, const zt_replay_sample *sample) {
    told_pixel *told = user;
    assert_in_range(told->count, 0, SAMPLES_MAX - 1);
    told_sample *s = &told->samples[told->count++];
    s->sample = *sample;
    assert_in_range(sample->ray_count, 1, RAYS_MAX);
    for (int i = 0; i < sample->ray_count; i++) {
        told_ray *to = &s->rays[i];
        to->ray = sample->rays[i];
        snprintf(to->hit, sizeof to->hit, "%s", to->ray.hit ? to->ray.hit : "nothing");
        assert_in_range(to->ray.lamp_count, 0, LAMPS_MAX);
        for (int k = 0; k < to->ray.lamp_count && to->ray.hit; k++) {
            to->lamps[k] = to->ray.lamps[k];
            snprintf(to->hiders[k], sizeof to->hiders[k], "%s",
                     to->lamps[k].hider ? to->lamps[k].hider : "");
        }
    }
}

typedef struct film_open {
    zt_animation *animation;
    zt_renderer *renderer;
} film_open;

/* Opens what is written; of the caller to close. */
static film_open open_text(const char *text, const zt_render_settings *settings) {
    film_open f;
    write_text("text.yaml", text);
    assert_int_equal(zt_animation_read(&f.animation, "text.yaml", NULL, 0, (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(zt_renderer_open(&f.renderer, f.animation, settings, (zt_listener){0}),
                     ZT_OK);
    return f;
}
static void close_film(film_open *f) {
    zt_renderer_close(&f->renderer);
    zt_animation_free(&f->animation);
}

static void replay(told_pixel *told, const film_open *f, int64_t frame, int column, int row) {
    zt_replay to = {keep, told};
    told->count = 0;
    assert_int_equal(
        zt_renderer_replay(&told->result, f->renderer, frame, column, row, &to, NULL), ZT_OK);
    assert_int_equal(told->count, told->result.sample_count);
}

static vec3 vector(const double v[3]) { return (vec3){v[0], v[1], v[2]}; }

static void assert_near(double a, double b, double error) {
    if (!(fabs(a - b) <= error)) fail_msg("%.9g is not %.9g within %g", a, b, error);
}

/* ---- a film with all that samples are for ---------------------------------------------------
 */

/* The film with some lines for `film` and `camera`. All moves while the shutter is open. */
static const char *busy_film(const char *film_words, const char *camera_words) {
    static char text[2048];
    snprintf(
        text, sizeof text,
        "zoetrope: 1\n"
        "film: { size: [48, 32], duration: 24, reflections: 2, shutter: 270 deg%s }\n"
        "camera: { position: { keys: { 0: [0, 1.5, 6], 23: [3, 1.5, 6] } },\n"
        "          look_at: [0, 1, 0]%s }\n"
        "lights:\n"
        "  - ambient: { intensity: 0.2 }\n"
        "  - point: { name: bulb, position: [2, 4, 3], radius: 0.5, intensity: 20 }\n"
        "  - rectangle_light: { name: panel, position: [-2, 4, 2], rotation: [-90, 0, 0],\n"
        "                       width: 1, height: 1, intensity: 10 }\n"
        "objects:\n"
        "  - plane: { normal: [0, 1, 0], material: { color: gray, reflectivity: 0.3 } }\n"
        "  - sphere: { radius: 0.6, material: { color: white, reflectivity: 0.2 },\n"
        "              center: { keys: { 0: [-2, 0.6, 0], 12: [0, 2, 0], 23: [2, 0.6, 0] } } "
        "}\n",
        film_words, camera_words);
    return text;
}

/* The light of the samples that are told adds up to the pixel of the rendered frame, for all
 * ways to sample; and there are as many of them as that asks for. */
static void samples_make_the_pixel(void **state) {
    (void)state;
    static told_pixel told;
    const struct {
        const char *film, *camera;
        int count; /* of each pixel; 0: as many as it needs */
    } cases[] = {
        {"", "", 1},
        {", samples: 2", "", 2},
        {", samples: 16", ", aperture: 0.1, focus_distance: 6", 16},
        {", samples: 37, seed: 5", ", lens: orthographic, height: 4", 37},
        {", samples: 16, filter: gaussian", "", 16},
        {", samples: 64, filter: mitchell", "", 64},
        {", samples: 9, filter: { kind: blackman-harris, width: 3 }", "", 9},
        {", samples: { min: 4, max: 64, error: 0.003 }", "", 0},
        {", samples: { min: 1, max: 512, error: 0.004 }, filter: tent", "", 0},
        {", quality: edges", "", 0},
    };
    uint64_t random = 1;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        film_open f = open_text(busy_film(cases[i].film, cases[i].camera),
                                &(zt_render_settings){.threads = 2});
        int low = SAMPLES_MAX, high = 0, colors = 0;
        double before = -1;
        for (int k = 0; k < 12; k++) {
            int column = (int)test_between(&random, 0, 48),
                row = (int)test_between(&random, 0, 32), frame = 2 * k;
            replay(&told, &f, frame, column, row);
            for (int c = 0; c < 3; c++)
                assert_near(told.result.mean[c], (double)told.result.pixel[c],
                            1e-5 * told.result.mean[c] + 1e-7);
            low = told.count < low ? told.count : low;
            high = told.count > high ? told.count : high;
            colors += told.result.mean[0] != before;
            before = told.result.mean[0];
        }
        assert_true(colors >= 4); /* it is not all one color */
        if (cases[i].count)
            assert_true(low == cases[i].count && high == low);
        else if (high <= low)
            fail_msg("case %zu: %d to %d samples", i, low, high);
        close_film(&f);
    }
}

/* The mean is the pixel also where as many samples count negatively as positively. */
static void weights_that_cancel_out(void **state) {
    (void)state;
    static told_pixel told;
    film_open f = open_text(busy_film(", samples: 2, filter: mitchell", ""),
                            &(zt_render_settings){.threads = 2});
    int cancelled = 0;
    for (int k = 0; k < 48; k++) {
        replay(&told, &f, 0, k, 20);
        cancelled += told.samples[0].sample.weight + told.samples[1].sample.weight == 0;
        for (int c = 0; c < 3; c++)
            assert_near(told.result.mean[c], (double)told.result.pixel[c], 1e-6);
    }
    assert_true(cancelled > 0);
    close_film(&f);
}

/* A sample by itself is what it is among all of them: the same places, rays and light. */
static void any_sample_alone(void **state) {
    (void)state;
    static told_pixel all, one;
    film_open f = open_text(busy_film(", samples: 16", ", aperture: 0.1, focus_distance: 6"),
                            &(zt_render_settings){0});
    replay(&all, &f, 12, 25, 20);
    zt_replay to = {keep, &one};
    for (int i = 15; i >= 0; i--) {
        one.count = 0;
        assert_int_equal(zt_renderer_replay_sample(f.renderer, 12, 25, 20, i, &to), ZT_OK);
        const zt_replay_sample *a = &all.samples[i].sample, *b = &one.samples[0].sample;
        assert_int_equal(a->number, i);
        assert_int_equal(b->number, i);
        assert_memory_equal(a->place, b->place, sizeof a->place);
        assert_memory_equal(a->lens, b->lens, sizeof a->lens);
        assert_memory_equal(a->light, b->light, sizeof a->light);
        assert_true(a->time_s == b->time_s && a->timed && a->through_lens);
        assert_int_equal(a->ray_count, b->ray_count);
        for (int k = 0; k < a->ray_count; k++)
            assert_memory_equal(all.samples[i].rays[k].ray.direction,
                                one.samples[0].rays[k].ray.direction, 3 * sizeof(double));
    }
    one.count = 0; /* one that rendering would not take */
    assert_int_equal(zt_renderer_replay_sample(f.renderer, 12, 25, 20, 1000000, &to), ZT_OK);
    assert_int_equal(one.count, 1);
    assert_int_equal(zt_renderer_replay_sample(f.renderer, 12, 25, 20, -1, &to), ZT_EARGUMENT);
    assert_int_equal(zt_renderer_replay_sample(f.renderer, 12, 48, 20, 0, &to), ZT_EARGUMENT);
    assert_int_equal(zt_renderer_replay_sample(f.renderer, 12, 0, -1, 0, &to), ZT_EARGUMENT);
    close_film(&f);
}

/* ---- what is said of rays -------------------------------------------------------------------
 */

/* Far from the world's origin: a ball that moves, a wall that hides one lamp from part of the
 * floor, and a lamp below the floor. */
static const char far_away[] =
    "zoetrope: 1\n"
    "film: { size: [64, 48], duration: 10, rate: 10, samples: 8, shutter: 360 deg }\n"
    "camera: { position: [1000, 502, 10], look_at: [1000, 500.5, 0], fov: 50 deg }\n"
    "lights:\n"
    "  - ambient: { intensity: 0.1 }\n"
    "  - point: { name: lamp, position: [998, 504, 1], intensity: 12 }\n"
    "  - point: { name: cellar, position: [1000, 490, 0], intensity: 50 }\n"
    "  - point: { name: night, position: [1003, 503, 4], intensity: 9, color: black }\n"
    "objects:\n"
    "  - plane: { name: floor, normal: [0, 1, 0], distance: 500,\n"
    "             material: { color: [0.9, 0.6, 0.3] } }\n"
    "  - box: { name: wall, center: [999, 501, 0], size: [0.2, 2, 3],\n"
    "           material: { color: [0.2, 0.5, 0.7] } }\n"
    "  - sphere: { name: ball, radius: 0.5, material: { color: white, reflectivity: 0.5 },\n"
    "              center: { curve: linear, keys: { 0: [1001, 501, 0], 10: [1002, 501, 0] } } "
    "}\n";

static const vec3 lamp_at = {998, 504, 1};

static bool within(const vec3 *p, double x, double y, double z) {
    return fabs(p->x - x) < 1e-4 && fabs(p->y - y) < 1e-4 && fabs(p->z - z) < 1e-4;
}

/* Whether the way from a point to the lamp goes through the wall: its slab of x alone decides
 * for points of the floor to its right, as far as it is high and deep. */
static bool behind_wall(vec3 p) {
    for (int i = 1; i < 4000; i++) {
        vec3 q = vec3_add(p, vec3_scale(vec3_sub(lamp_at, p), i / 4000.0));
        if (fabs(q.x - 999) < 0.1 && q.y < 502 && fabs(q.z) < 1.5) return true;
    }
    return false;
}

static void check_hit(const told_ray *r, double time_s) {
    vec3 from = vector(r->ray.origin), way = vector(r->ray.direction),
         point = vector(r->ray.point), normal = vector(r->ray.normal);
    vec3 end = vec3_add(from, vec3_scale(way, r->ray.distance));
    assert_near(vec3_length(way), 1, 1e-6);
    assert_near(vec3_length(normal), 1, 1e-5);
    assert_true(vec3_dot(normal, way) < 1e-5);
    assert_true(within(&end, point.x, point.y, point.z));
    assert_int_equal(r->ray.triangle, -1);
    if (strcmp(r->hit, "floor") == 0) {
        assert_near(point.y, 500, 1e-4);
        assert_near(fabs(normal.y), 1, 1e-6);
    } else if (strcmp(r->hit, "ball") == 0) { /* where it is at this sample's time */
        vec3 out = vec3_sub(point, (vec3){1001 + time_s, 501, 0});
        assert_near(vec3_length(out), 0.5, 2e-3);
        assert_near(vec3_dot(out, normal), 0.5, 2e-3);
    } else {
        assert_string_equal(r->hit, "wall");
        assert_true(fabs(point.x - 999) < 0.1001 && fabs(point.z) < 1.5001);
    }
}

static void check_lamps(const told_ray *r, int *lit, int *hidden) {
    vec3 point = vector(r->ray.point), normal = vector(r->ray.normal);
    assert_int_equal(r->ray.lamp_count, 3);
    const zt_replay_lamp *lamp = &r->lamps[0], *cellar = &r->lamps[1], *night = &r->lamps[2];
    vec3 at = vector(lamp->point);
    assert_true(within(&at, lamp_at.x, lamp_at.y, lamp_at.z));
    vec3 way = vec3_sub(lamp_at, point);
    if (vec3_dot(way, normal) < -1e-3) assert_int_equal(lamp->gift, ZT_GIFT_BEHIND);
    if (strcmp(r->hit, "floor") != 0) return;
    assert_int_equal(cellar->gift, ZT_GIFT_BEHIND);
    assert_true(night->gift == ZT_GIFT_NOTHING || night->gift == ZT_GIFT_HIDDEN);
    if (lamp->gift == ZT_GIFT_LIGHT) {
        *lit += 1;
        assert_false(behind_wall(point));
        return;
    }
    assert_int_equal(lamp->gift, ZT_GIFT_HIDDEN);
    if (strcmp(r->hiders[0], "wall") != 0) return; /* then the ball */
    *hidden += 1;
    assert_int_equal(lamp->hider_triangle, -1);
    vec3 met = vec3_add(point, vec3_scale(vec3_normalize(way), lamp->hider_distance));
    assert_true(fabs(met.x - 999) < 0.1001 && met.y < 502.0001 && fabs(met.z) < 1.5001);
}

/* The light that the lamps which are said to shine give by the model's own formula is the
 * sample's, where nothing mirrors. */
static void check_light(const told_sample *s) {
    const told_ray *r = &s->rays[0];
    const vec3 floor = {0.9, 0.6, 0.3};
    if (strcmp(r->hit, "floor") != 0) return;
    vec3 way = vec3_sub(lamp_at, vector(r->ray.point));
    double d = vec3_length(way), fade = 12 / (d * d) * fabs(way.y) / d;
    if (r->lamps[0].gift != ZT_GIFT_LIGHT) fade = 0;
    const double wanted[3] = {floor.x * (fade + 0.1), floor.y * (fade + 0.1),
                              floor.z * (fade + 0.1)};
    for (int c = 0; c < 3; c++) assert_near((double)s->sample.light[c], wanted[c], 1e-4);
}

/* Points are where the things are, at the time of the sample and in the coordinates of the
 * description; normals and distances fit; each lamp is said to be what it is. */
static void what_is_said_is_so(void **state) {
    (void)state;
    static told_pixel told;
    film_open f = open_text(far_away, &(zt_render_settings){0});
    int lit = 0, hidden = 0, balls = 0, mirrored = 0, walls = 0;
    for (int row = 2; row < 48; row += 5)
        for (int column = 1; column < 64; column += 3) {
            replay(&told, &f, 4, column, row);
            for (int i = 0; i < told.count; i++) {
                const told_sample *s = &told.samples[i];
                double time_s = s->sample.time_s;
                assert_true(s->sample.timed && !s->sample.through_lens);
                assert_true(time_s >= 0.4 && time_s <= 0.5);
                assert_near(s->sample.opening, (time_s - 0.4) / 0.1, 1e-9);
                assert_true(s->sample.place[0] >= column && s->sample.place[0] <= column + 1);
                assert_true(s->sample.place[1] >= row && s->sample.place[1] <= row + 1);
                for (int k = 0; k < s->sample.ray_count; k++) {
                    const told_ray *r = &s->rays[k];
                    if (!r->ray.hit) continue;
                    check_hit(r, time_s);
                    check_lamps(r, &lit, &hidden);
                    balls += strcmp(r->hit, "ball") == 0;
                    walls += strcmp(r->hit, "wall") == 0;
                }
                check_light(s);
                bool on_ball = strcmp(s->rays[0].hit, "ball") == 0;
                assert_true((s->sample.ray_count > 1) == on_ball);
                mirrored += on_ball;
            }
        }
    /* All of it was met. */
    assert_true(lit > 100 && hidden > 10 && balls > 10 && walls > 10 && mirrored > 10);
    close_film(&f);
}

/* Of a mesh, the triangle is told by its number in the file; so it is of what hides a lamp. */
static void triangles_have_numbers(void **state) {
    (void)state;
    static told_pixel told;
    write_text("two.ply", "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\n"
                          "property float y\nproperty float z\nelement face 2\n"
                          "property list uchar int vertex_indices\nend_header\n"
                          "-9 -9 0\n0 -9 0\n0 9 0\n0 -9 0\n9 -9 0\n0 9 0\n3 0 1 2\n3 3 4 5\n");
    film_open f = open_text("zoetrope: 1\n"
                            "film: { size: [16, 16], duration: 1 }\n"
                            "camera: { position: [0, 0, 10], look_at: [0, 0, 0] }\n"
                            "lights: [ point: { name: lamp, position: [0, 0, -10] } ]\n"
                            "objects:\n"
                            "  - mesh: { name: two, file: two.ply }\n"
                            "  - plane: { name: ground, normal: [0, 1, 0], distance: -1 }\n",
                            &(zt_render_settings){0});
    replay(&told, &f, 0, 1, 7);
    assert_string_equal(told.samples[0].rays[0].hit, "two");
    assert_int_equal(told.samples[0].rays[0].ray.triangle, 0);
    replay(&told, &f, 0, 14, 7);
    assert_int_equal(told.samples[0].rays[0].ray.triangle, 1);
    assert_int_equal(told.samples[0].sample.number, -1); /* a single one is in the middle */
    replay(&told, &f, 0, 2, 15);
    assert_string_equal(told.samples[0].rays[0].hit, "ground");
    assert_int_equal(told.samples[0].rays[0].lamps[0].gift, ZT_GIFT_HIDDEN);
    assert_string_equal(told.samples[0].rays[0].hiders[0], "two");
    assert_int_equal(told.samples[0].rays[0].lamps[0].hider_triangle, 0);
    close_film(&f);
}

/* ---- the program ----------------------------------------------------------------------------
 */

static void program_prints(void **state) {
    (void)state;
    run *r = zoetrope("frame film.yaml 2 --pixel 24,16 --samples 3");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    assert_contains(r->out, "sample 0, at 24.");
    assert_contains(r->out, "sample 2, at ");
    assert_contains(r->out, "meets ball after ");
    assert_contains(r->out, "point 1 at [2, 4, 2]");
    double mean[3], pixel[3];
    const char *means = strstr(r->out, "mean of the samples' light ["),
               *pixels = strstr(r->out, "the pixel of the frame     [");
    assert_true(means && pixels);
    assert_int_equal(
        sscanf(strchr(means, '['), "[%lf, %lf, %lf]", &mean[0], &mean[1], &mean[2]), 3);
    assert_int_equal(
        sscanf(strchr(pixels, '['), "[%lf, %lf, %lf]", &pixel[0], &pixel[1], &pixel[2]), 3);
    for (int c = 0; c < 3; c++) assert_near(mean[c], pixel[c], 1e-6);
    r = zoetrope("frame film.yaml 2 --pixel 24,16 --samples 3 --sample 2");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "sample 2, at ");
    assert_null(strstr(r->out, "sample 0"));
    assert_null(strstr(r->out, "pixel of the frame"));
    r = zoetrope("frame film.yaml 2 --pixel 0,0");
    assert_contains(r->out, "meets nothing");
    assert_int_equal(entry_count("."), 1); /* film.yaml alone */
    const struct {
        const char *arguments, *told;
    } cases[] = {
        {"frame film.yaml 2 --pixel 64,0", "there is no pixel 64,0: the picture is 64x36"},
        {"frame film.yaml 2 --pixel 0,36", "there is no pixel 0,36"},
        {"frame film.yaml 2 --pixel 5", "--pixel 5: must be column and row"},
        {"frame film.yaml 2 --pixel 5,6,7", "must be column and row"},
        {"frame film.yaml 2 --pixel -1,6", "must be column and row"},
        {"frame film.yaml 2 --pixel 1,99999999999999", "must be column and row"},
        {"frame film.yaml 2 --sample 1", "--sample is one of a --pixel's"},
        {"frame film.yaml 2 --pixel 1,1 --sample x", "--sample x: must be a number from 0"},
        {"frame film.yaml 2 --pixel 1,1 --sample -1", "--sample -1: must be a number"},
        {"frame film.yaml 2 --pixel 1,1 -o x.png", "--pixel and --output do not go together"},
        {"frame film.yaml 2 --pixel 1,1 --time 1s", "do not go together"},
        {"render film.yaml --pixel 1,1", "render takes no --pixel"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        r = zoetrope(cases[i].arguments);
        if (r->code != 2) fail_msg("zoetrope %s ended with %d", cases[i].arguments, r->code);
        assert_contains(r->err, cases[i].told);
        assert_string_equal(r->out, "");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(samples_make_the_pixel), IN_DIRECTORY(weights_that_cancel_out),
        IN_DIRECTORY(any_sample_alone),       IN_DIRECTORY(what_is_said_is_so),
        IN_DIRECTORY(triangles_have_numbers), IN_DIRECTORY(program_prints),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
