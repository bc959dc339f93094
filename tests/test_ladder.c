/* Shows that errors are measured right, on pictures whose true ones are known in closed form: a
 * slanted edge, a light that brightens while the shutter is open, a ball of light over a plane;
 * that errors fall with the number of samples as theory has it; and that a reference knows how
 * far it is off itself. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <zoetrope/ladder.h>

#include "descriptions.h"
#include "sequence/renderer.h"

enum { SIDE = 48, SHOWN_MAX = 64 };

/* ---- pictures that are known ---------------------------------------------------------------
 */

static const char edge_film[] =
    "zoetrope: 1\n"
    "film: { size: [48, 48], rate: 1, duration: 1, view: raw }\n"
    "camera: { position: [0, 0, 1], look_at: [0, 0, 0], fov: 90 deg }\n" /* 2 units across */
    "lights:\n"
    "  - ambient: { intensity: 1 }\n"
    "objects:\n"
    "  - triangle: { vertices: [[-9, -4, 0], [9, 5, 0], [9, -40, 0]], material: { color: white "
    "} }\n";

/* How much of a pixel lies below the line y = x / 2 + 1 / 2 that the triangle ends at: its
 * square, cut by the line (Sutherland and Hodgman 1974), by the shoelace formula. */
static double edge_exact(int column, int row) {
    const double step = 2.0 / SIDE;
    double x0 = -1 + column * step, y0 = 1 - (row + 1) * step, area = 0;
    const double corners[4][2] = {
        {x0, y0}, {x0 + step, y0}, {x0 + step, y0 + step}, {x0, y0 + step}};
    double kept[8][2];
    int count = 0;
    for (int i = 0; i < 4; i++) {
        const double *a = corners[i], *b = corners[(i + 1) % 4];
        double da = a[0] / 2 + 0.5 - a[1], db = b[0] / 2 + 0.5 - b[1];
        if (da >= 0) memcpy(kept[count++], a, sizeof *kept);
        if ((da >= 0) == (db >= 0)) continue;
        for (int k = 0; k < 2; k++) kept[count][k] = a[k] + (b[k] - a[k]) * da / (da - db);
        count++;
    }
    for (int i = 0; i < count; i++) {
        const double *a = kept[i], *b = kept[(i + 1) % count];
        area += (a[0] * b[1] - a[1] * b[0]) / 2;
    }
    return area / (step * step);
}

/* The light grows in a straight line from 0 to 1 while the shutter is open, which sees all. */
static const char ramp_film[] =
    "zoetrope: 1\n"
    "film: { size: [48, 48], rate: 1, duration: 1, view: raw, shutter: 360 deg }\n"
    "camera: { position: [0, 0, 1], look_at: [0, 0, 0], fov: 90 deg }\n"
    "lights:\n"
    "  - ambient: { intensity: { curve: linear, keys: { 0 s: 0, 1 s: 1 } } }\n"
    "objects:\n"
    "  - plane: { normal: [0, 0, 1], material: { color: white } }\n";

static double ramp_exact(int column, int row) {
    (void)column, (void)row;
    return 0.5;
}

/* A ball of light of radius 1 stands 3 above a plane: wherever all of it is above the horizon,
 * it lights as a point in its middle would, I cos / d^2. The camera looks straight down. */
static const char ball_film[] =
    "zoetrope: 1\n"
    "film: { size: [48, 48], rate: 1, duration: 1, view: raw }\n"
    "camera: { position: [0, 0, 2], look_at: [0, 0, 0], up: [0, 1, 0], fov: 90 deg }\n"
    "lights:\n"
    "  - point: { position: [0.5, 0, 3], radius: 1, intensity: 6, shadows: false }\n"
    "objects:\n"
    "  - plane: { normal: [0, 0, 1], material: { color: white } }\n";

static double ball_at(double x, double y) {
    double d2 = (x - 0.5) * (x - 0.5) + y * y + 9;
    return 6 * 3 / (d2 * sqrt(d2));
}

/* Over a pixel by Gauss's rule of three points each way. */
static double ball_exact(int column, int row) {
    const double at[3] = {-0.7745966692414834, 0, 0.7745966692414834},
                 weights[3] = {5 / 18.0, 8 / 18.0, 5 / 18.0}, step = 4.0 / SIDE;
    double sum = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            sum += weights[i] * weights[k] *
                   ball_at(-2 + (column + 0.5 + at[i] / 2) * step,
                           2 - (row + 0.5 + at[k] / 2) * step);
    return sum;
}

static zt_image *exact_image(double (*exact)(int column, int row)) {
    zt_image *image;
    assert_int_equal(zt_image_create(&image, SIDE, SIDE), ZT_OK);
    for (int i = 0; i < SIDE * SIDE; i++)
        for (int c = 0; c < 3; c++) image->pixels[4 * i + c] = (float)exact(i % SIDE, i / SIDE);
    return image;
}

/* ---- what a ladder shows -------------------------------------------------------------------
 */

/* The true errors of what was shown. */
typedef struct truth {
    zt_image *image;
    double reference; /* the reference's */
    double errors[SHOWN_MAX];
    int count;
} truth;

static void find_error(void *user, const zt_rung *rung, const zt_image *image,
                       const zt_image *reference) {
    truth *t = user;
    (void)rung;
    assert_true(t->count < SHOWN_MAX);
    t->reference = zt_compare_rmse(reference, t->image);
    t->errors[t->count++] = zt_compare_rmse(image, t->image);
}

static zt_ladder *climb(truth *t, const char *film, int samples) {
    static const int64_t frame = 0;
    zt_animation *animation = animation_of(film);
    zt_ladder_settings settings = {.render = {.samples = samples},
                                   .frames = &frame,
                                   .frame_count = 1,
                                   .show = t ? find_error : NULL,
                                   .user = t};
    zt_ladder *ladder;
    assert_int_equal(zt_ladder_climb(&ladder, animation, &settings, NULL, (zt_listener){0}),
                     ZT_OK);
    zt_animation_free(&animation);
    return ladder;
}

static void assert_within(double value, double least, double most) {
    if (!(value >= least && value <= most))
        fail_msg("%.4g is not in %.4g .. %.4g", value, least, most);
}

/* Climbs, and holds what the ladder says against the true picture: each rung's error to a few
 * percent where it says that it knows it, the reference's own within half and twice. Returns
 * the slope of the true error by samples, 2 to `samples`. */
static double trustworthy(const char *film, double (*exact)(int column, int row), int samples) {
    truth t = {.image = exact_image(exact)};
    zt_ladder *ladder = climb(&t, film, samples);
    double x[SHOWN_MAX], y[SHOWN_MAX];
    int count = 0, known = 0;
    for (int i = 0; i < ladder->rung_count; i++) {
        const zt_rung *rung = &ladder->rungs[i];
        if (zt_ladder_knows(ladder, rung)) {
            assert_within(rung->error.rmse / t.errors[i], 0.93, 1.15);
            known++;
        }
        bool even = rung->kind == ZT_RUNG_SAMPLES && !rung->other_precision;
        if (!even || rung->sampling.max < 2) continue;
        x[count] = rung->sampling.max;
        y[count++] = t.errors[i];
        assert_within(rung->samples, rung->sampling.max, rung->sampling.max);
    }
    assert_true(known >= 8);
    assert_within(ladder->references[0].error / t.reference, 0.5, 2);
    zt_ladder_free(&ladder);
    zt_image_free(&t.image);
    double slope = zt_ladder_slope(x, y, count);
    print_message("slope %.3f\n", slope);
    return slope;
}

/* An edge through a square: errors of a scrambled net fall as n^-3/4 (Owen 1997). */
static void slanted_edge(void **state) {
    (void)state;
    assert_within(trustworthy(edge_film, edge_exact, 64), -0.86, -0.64);
}

/* One smooth dimension: as n^-3/2 (Owen 1997). */
static void moving_ramp(void **state) {
    (void)state;
    assert_within(trustworthy(ramp_film, ramp_exact, 64), -1.6, -1.35);
}

/* Smooth in two dimensions and two: steeper than an edge. */
static void ball_of_light(void **state) {
    (void)state;
    assert_within(trustworthy(ball_film, ball_exact, 64), -1.6, -0.9);
}

/* Pictures that have nothing to do with each other: their mean is wrong by n^-1/2. Over some
 * 2,500 pixels of 64 pictures the slope is known to 0.01 or so. */
static void white_noise(void **state) {
    (void)state;
    zt_animation *animation = animation_of(ramp_film);
    zt_render_settings settings = {.samples = 2};
    zt_renderer *renderer;
    zt_image *image, *mean, *exact = exact_image(ramp_exact);
    double x[8], y[8];
    int count = 0;
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(zt_image_create(&image, SIDE, SIDE), ZT_OK);
    assert_int_equal(zt_image_create(&mean, SIDE, SIDE), ZT_OK);
    for (int i = 0; i < 4 * SIDE * SIDE; i++) mean->pixels[i] = 0;
    for (int n = 1; n <= 64; n++) {
        renderer->sampling.seed = (uint32_t)n * 7919;
        assert_int_equal(zt_renderer_frame(renderer, 0, image, NULL), ZT_OK);
        for (int i = 0; i < 4 * SIDE * SIDE; i++)
            mean->pixels[i] += (image->pixels[i] - mean->pixels[i]) / (float)n;
        if ((n & (n - 1)) != 0) continue;
        x[count] = n;
        y[count++] = zt_compare_rmse(mean, exact);
    }
    assert_within(zt_ladder_slope(x, y, count), -0.54, -0.46);
    zt_image_free(&image);
    zt_image_free(&mean);
    zt_image_free(&exact);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

/* ---- what is measured ----------------------------------------------------------------------
 */

/* Rungs, their order, their rays and times; and that the second series is in the precision that
 * the first is not in, which for a plain edge shows the same picture. */
static void rungs(void **state) {
    (void)state;
    static const int counts[] = {1, 2, 3, 4, 6, 8, 12, 16};
    zt_ladder *ladder = climb(NULL, edge_film, 16);
    assert_int_equal(ladder->samples, 16);
    assert_int_equal(ladder->reference_count, 1);
    assert_int_equal(ladder->references[0].samples, 256);
    assert_int_equal(ladder->frame_count, 1);
    int other = 0;
    for (int i = 0; i < ladder->rung_count; i++) {
        const zt_rung *rung = &ladder->rungs[i];
        if (i < 8) assert_int_equal(rung->sampling.max, counts[i]);
        assert_int_equal(rung->precision,
                         rung->other_precision ? ZT_PRECISION_DOUBLE : ZT_PRECISION_SINGLE);
        assert_true(rung->primary_rays >= SIDE * SIDE && rung->frame_s > 0);
        assert_true(rung->cpu_s > 0 && rung->peak_bytes > 1e6);
        assert_true(rung->stages.freeze_s >= 0 && rung->stages.prepare_s >= 0);
        assert_true(rung->stages.render_s > 0 && rung->stages.write_s > 0);
        assert_true(rung->stages.render_s <= rung->frame_s);
        assert_true(isnan(rung->flicker)); /* the film has a single frame */
        if (!rung->other_precision) continue;
        for (int k = 0; k < 8; k++)
            if (counts[k] == rung->sampling.max)
                assert_within(rung->error.rmse / ladder->rungs[k].error.rmse, 0.999, 1.001);
        other++;
    }
    assert_int_equal(other, 3); /* 1, 4 and 16 */
    assert_true(ladder->left_out_count >= 5 && strstr(ladder->precision, "single"));
    zt_ladder_free(&ladder);
}

/* Each filter is measured against a reference by the same filter: else it would be off by how
 * much the filters differ, which no number of samples lessens. */
static void filters(void **state) {
    (void)state;
    static const int64_t frame = 0;
    zt_animation *animation = animation_of(edge_film);
    zt_ladder_settings settings = {
        .render = {.samples = 16}, .frames = &frame, .frame_count = 1, .filters = true};
    zt_ladder *ladder;
    assert_int_equal(zt_ladder_climb(&ladder, animation, &settings, NULL, (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(ladder->reference_count, ZT_FILTER_COUNT);
    for (int i = 1; i < ladder->rung_count; i++) {
        const zt_rung *rung = &ladder->rungs[i], *before = rung - 1;
        assert_int_equal(rung->sampling.filter, ladder->references[rung->reference].filter);
        if (rung->reference > 0 && rung->reference == before->reference &&
            rung->sampling.max > 4)
            assert_true(rung->error.rmse < 0.6 * before->error.rmse);
    }
    zt_ladder_free(&ladder);
    zt_animation_free(&animation);
}

/* Noise that differs from frame to frame flickers by the root of two times the error; frames in
 * which nothing changes do not flicker at all. */
static void flicker(void **state) {
    (void)state;
    static const char *const films[] = {
        "zoetrope: 1\n"
        "film: { size: [48, 48], rate: 1, duration: 2, view: raw, shutter: 360 deg }\n"
        "camera: { position: [0, 0, 1], look_at: [0, 0, 0], fov: 90 deg }\n"
        "lights:\n"
        "  - ambient: { intensity: { curve: linear, keys: { 0 s: 0, 2 s: 2 } } }\n"
        "objects:\n"
        "  - plane: { normal: [0, 0, 1], material: { color: white } }\n",
        "zoetrope: 1\n"
        "film: { size: [48, 48], rate: 1, duration: 2, view: raw }\n"
        "camera: { position: [0, 0, 2], look_at: [0, 0, 0], up: [0, 1, 0], fov: 90 deg }\n"
        "lights:\n"
        "  - point: { position: [0.5, 0, 3], radius: 1, intensity: 6, shadows: false }\n"
        "objects:\n"
        "  - plane: { normal: [0, 0, 1], material: { color: white } }\n"};
    for (int film = 0; film < 2; film++) {
        zt_ladder *ladder = climb(NULL, films[film], 16);
        assert_int_equal(ladder->frame_count, 2);
        for (int i = 0; i < ladder->rung_count; i++) {
            const zt_rung *rung = &ladder->rungs[i];
            assert_true(rung->error.rmse > 0);
            if (film == 1)
                assert_true(rung->flicker == 0);
            else if (zt_ladder_knows(ladder, rung))
                assert_within(rung->flicker / rung->error.rmse, 1.3, 1.52);
        }
        zt_ladder_free(&ladder);
    }
}

/* A limit of time leaves out what would take longer; asking to stop stops; and no frames, or
 * more samples than a reference can have 16 times of, are refused. */
static bool at_once(void *user) {
    (void)user;
    return true;
}

static void limits(void **state) {
    (void)state;
    static const int64_t frame = 0;
    zt_animation *animation = animation_of(edge_film);
    zt_ladder_settings settings = {.frames = &frame, .frame_count = 1, .frame_limit_s = 1e-9};
    zt_ladder *ladder;
    heard h;
    assert_int_equal(zt_ladder_climb(&ladder, animation, &settings, NULL, (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(ladder->samples, 1);
    zt_ladder_free(&ladder);
    zt_watcher watcher = {.stopped = at_once};
    assert_int_equal(zt_ladder_climb(&ladder, animation, &settings, &watcher, (zt_listener){0}),
                     ZT_ESTOPPED);
    assert_null(ladder);
    settings.render.samples = 4097;
    assert_int_equal(zt_ladder_climb(&ladder, animation, &settings, NULL, listener_of(&h)),
                     ZT_EARGUMENT);
    assert_told(&h, "at most 4096");
    settings = (zt_ladder_settings){.frames = &frame};
    assert_int_equal(zt_ladder_climb(&ladder, animation, &settings, NULL, listener_of(&h)),
                     ZT_EARGUMENT);
    zt_animation_free(&animation);
}

/* ---- what follows --------------------------------------------------------------------------
 */

/* A power has the slope of its exponent and no knee; two powers have theirs where they meet. */
static void slope_and_knee(void **state) {
    (void)state;
    double x[12], y[12], bent[12];
    for (int i = 0; i < 12; i++) {
        x[i] = 0.01 * pow(2, i);
        y[i] = 3 * pow(x[i], -0.7);
    }
    for (int i = 0; i < 12; i++) bent[i] = y[i] * pow(fmax(x[i] / x[5], 1), 0.6);
    assert_within(zt_ladder_slope(x, y, 12), -0.7 - 1e-12, -0.7 + 1e-12);
    assert_int_equal(zt_ladder_knee(x, y, 12), -1);
    assert_int_equal(zt_ladder_knee(x, bent, 12), 5);
    assert_int_equal(zt_ladder_knee(x, bent, 2), -1);
    assert_int_equal(zt_ladder_knee(x, bent, 0), -1);
    assert_true(isnan(zt_ladder_slope(x, y, 1)));
}

/* The quickest rung that is good enough; none by another filter or in a precision that has to
 * be asked for; none that the reference cannot vouch for. */
static void choose(void **state) {
    (void)state;
    zt_rung list[] = {{.frame_s = 1, .error.rmse = 0.1},
                      {.frame_s = 4, .error.rmse = 0.01},
                      {.frame_s = 3, .error.rmse = 0.009},
                      {.frame_s = 2, .error.rmse = 0.001, .other_precision = true},
                      {.frame_s = 2, .error.rmse = 0.001, .reference = 1},
                      {.frame_s = 9, .error.rmse = 0.002}};
    zt_ladder ladder = {.rungs = list, .rung_count = 6, .reference_count = 2};
    ladder.references[0].error = 0.001;
    assert_int_equal(zt_ladder_choose(&ladder, 0.1), 0);
    assert_int_equal(zt_ladder_choose(&ladder, 0.01), 2);
    assert_int_equal(zt_ladder_choose(&ladder, 0.005), 5);
    assert_int_equal(zt_ladder_choose(&ladder, 0.0021), -1);
    assert_true(zt_ladder_knows(&ladder, &list[1]));
    assert_false(zt_ladder_knows(&ladder, &list[5]));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slanted_edge),   cmocka_unit_test(moving_ramp),
        cmocka_unit_test(ball_of_light),  cmocka_unit_test(white_noise),
        cmocka_unit_test(rungs),          cmocka_unit_test(filters),
        cmocka_unit_test(flicker),        cmocka_unit_test(limits),
        cmocka_unit_test(slope_and_knee), cmocka_unit_test(choose),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
