/* Filters: that samples fall as dense as each filter is large, that pictures of a constant are
 * constant, and that edges become what the integral of the filter says.
 *
 * The numbers are fixed, so that a test which passes always does. Limits of chi-square are
 * those that perfect samples would miss with a probability of 6e-9 each (5.7 standard
 * deviations); that of edges is stated where it is. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "chance.h"
#include "rendering.h"

static const double deviations = 5.7;
static const double own_widths[ZT_FILTER_COUNT] = {1, 2, 2, 4, 4};

/* The filters once more, from their papers: by the distance from the middle as a share s of
 * half the width. */
static double filter_at(zt_filter filter, double s) {
    double a = fabs(s), x = 2 * a, pi = acos(-1);
    if (a > 1) return 0;
    switch (filter) {
    case ZT_FILTER_BOX:
        return 1;
    case ZT_FILTER_TENT:
        return 1 - a;
    case ZT_FILTER_GAUSSIAN:
        return exp(-s * s / (2 * 0.5 * 0.5)); /* sigma: a quarter of it all */
    case ZT_FILTER_MITCHELL: {                /* equation 8 of the paper, B = C = 1/3 */
        double b = 1.0 / 3, c = 1.0 / 3;
        double near =
            (12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + 6 - 2 * b;
        double far = (-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x +
                     (-12 * b - 48 * c) * x + 8 * b + 24 * c;
        return (x < 1 ? near : far) / 6;
    }
    default:
        return 0.35875 + 0.48829 * cos(pi * s) + 0.14128 * cos(2 * pi * s) +
               0.01168 * cos(3 * pi * s);
    }
}

/* The integral of a filter, or of its magnitude, over low .. high, by many small steps. */
static double integral(zt_filter filter, double low, double high, bool of_magnitude) {
    enum { STEPS = 2000 };
    double sum = 0, step = (high - low) / STEPS;
    for (int i = 0; i < STEPS; i++) {
        double f = filter_at(filter, low + (i + 0.5) * step);
        sum += (of_magnitude ? fabs(f) : f) * step;
    }
    return sum;
}

static const zt_warp *warp_of(zt_arena *arena, zt_filter filter, double width) {
    const zt_warp *warp;
    zt_sampling sampling = {.filter = filter, .filter_width = width};
    assert_int_equal(zt_warp_prepare(&warp, &sampling, arena), ZT_OK);
    return warp;
}

/* Counts of samples in bins against the integral of the filter's magnitude over each, both
 * across and along; bins that expect less than ten samples are taken together. */
static void check_density(zt_filter filter, double width) {
    enum { BINS = 24, BATCHES = 4000 };
    static int counts[BINS][BINS];
    zt_arena arena = {0};
    const zt_warp *warp = warp_of(&arena, filter, width);
    assert_non_null(warp);
    memset(counts, 0, sizeof counts);
    uint64_t state = 11;
    for (int batch = 0; batch < BATCHES; batch++) {
        float x[ZT_BATCH], y[ZT_BATCH], weight[ZT_BATCH];
        for (int i = 0; i < ZT_BATCH; i++) {
            x[i] = (float)(int)(test_random(&state) * 0x1p24) * 0x1p-24f;
            y[i] = (float)(int)(test_random(&state) * 0x1p24) * 0x1p-24f;
        }
        zt_warp_places(x, y, weight, warp, ZT_BATCH);
        for (int i = 0; i < ZT_BATCH; i++) {
            double s = 2 * ((double)x[i] - 0.5) / width, t = 2 * ((double)y[i] - 0.5) / width;
            assert_true(fabs(s) <= 1 + 1e-6 && fabs(t) <= 1 + 1e-6);
            double f = filter_at(filter, s) * filter_at(filter, t);
            if (fabs(f) > 1e-5) assert_true(weight[i] == (f < 0 ? -1 : 1));
            int column = (int)fmin(fmax((s + 1) / 2 * BINS, 0), BINS - 1);
            int row = (int)fmin(fmax((t + 1) / 2 * BINS, 0), BINS - 1);
            counts[row][column]++;
        }
    }
    double share[BINS], all = integral(filter, -1, 1, true);
    for (int i = 0; i < BINS; i++)
        share[i] = integral(filter, 2.0 * i / BINS - 1, 2.0 * (i + 1) / BINS - 1, true) / all;
    double sum = 0, few_expected = 0, few = 0;
    int cells = 0;
    for (int i = 0; i < BINS * BINS; i++) {
        double expected = share[i / BINS] * share[i % BINS] * BATCHES * ZT_BATCH;
        double count = counts[i / BINS][i % BINS];
        if (expected < 10) {
            few_expected += expected;
            few += count;
            continue;
        }
        sum += (count - expected) * (count - expected) / expected;
        cells++;
    }
    if (few_expected >= 10) {
        sum += (few - few_expected) * (few - few_expected) / few_expected;
        cells++;
    }
    if (sum > chi_square_limit(cells - 1, deviations))
        fail_msg("filter %d, width %g: chi-square %g of %d", (int)filter, width, sum,
                 cells - 1);
    zt_arena_free(&arena);
}

static void samples_fall_where_filters_are_large(void **state) {
    (void)state;
    for (int filter = 0; filter < ZT_FILTER_COUNT; filter++) {
        if (filter != ZT_FILTER_BOX) check_density((zt_filter)filter, own_widths[filter]);
        check_density((zt_filter)filter, 3);
    }
}

/* The box of one pixel changes nothing. */
static void the_plain_box_is_no_filter(void **state) {
    (void)state;
    zt_arena arena = {0};
    assert_null(warp_of(&arena, ZT_FILTER_BOX, 0));
    assert_null(warp_of(&arena, ZT_FILTER_BOX, 1));
    assert_non_null(warp_of(&arena, ZT_FILTER_BOX, 2));
    zt_arena_free(&arena);
}

/* A wall that fills the picture, of colors that floats hold with all their digits. */
static void wall(test_scene *s) {
    scene_begin(s);
    scene_plane(s, (vec3){0, 0, 1}, -1, scene_material(s, (vec3){0.7, 0.3, 1.0 / 3}, 0));
    scene_ambient(s, white, 0.9);
}

/* A constant comes out as that constant: where samples count negatively to the last bit, and
 * else alike in all pixels. */
static void constants_stay_constant(void **state) {
    (void)state;
    enum { SIDE = 20 };
    test_scene s;
    int64_t left_out;
    wall(&s);
    zt_image *one = render(&s.scene, SIDE, SIDE, 1, 2);
    for (int filter = 0; filter < ZT_FILTER_COUNT; filter++)
        for (int samples = 1; samples <= 33; samples += samples < 8 ? 1 : 25) {
            zt_sampling sampling = {samples, samples, .filter = (zt_filter)filter, .seed = 3};
            zt_image *image = render_sampled(&left_out, &s.scene, SIDE, SIDE, sampling, 2);
            for (int i = 0; i < 4 * SIDE * SIDE; i++) {
                double own = (double)image->pixels[i], first = (double)image->pixels[i % 4];
                assert_true(own == first);
                assert_float_equal(own, (double)one->pixels[i],
                                   filter == ZT_FILTER_MITCHELL ? 0 : 1e-6);
            }
            zt_image_free(&image);
        }
    zt_image_free(&one);
}

/* A white half of the picture: what is on the right of the line x = at + slope y, in pixels. */
enum { EDGE_SIDE = 16 };
static const double edge_at = 5.3, edge_slope = 0.37;

static void half(test_scene *s) {
    const double pixel = 2.0 / EDGE_SIDE;
    scene_begin(s);
    int32_t material = scene_material(s, white, 0);
    vec3 corners[3];
    for (int i = 0; i < 2; i++) {
        double y = i ? -40 : 60, x = edge_at + edge_slope * y;
        corners[i] = (vec3){x * pixel - 1, 1 - y * pixel, -1};
    }
    corners[2] = (vec3){200, 0, -1};
    scene_triangle(s, corners[0], corners[1], corners[2], material);
    scene_ambient(s, white, 1);
}

/* What a filter makes of it: by rows, each with the share of the filter that is on the right.
 */
static double covered(zt_filter filter, double width, int column, int row) {
    enum { ROWS = 400, CELLS = 4000 };
    static double below[CELLS + 1];
    double all = integral(filter, -1, 1, false), sum = 0;
    for (int i = 0; i < CELLS; i++)
        below[i + 1] = below[i] + filter_at(filter, (2 * i + 1.0) / CELLS - 1) * 2 / CELLS;
    for (int i = 0; i < ROWS; i++) {
        double t = (2 * i + 1.0) / ROWS - 1;
        double y = row + 0.5 + t * width / 2;
        double s = (edge_at + edge_slope * y - column - 0.5) / (width / 2);
        double cell = fmin(fmax((s + 1) / 2, 0), 1) * CELLS;
        int whole = (int)fmin(cell, CELLS - 1);
        double left = below[whole] + (cell - whole) * (below[whole + 1] - below[whole]);
        sum += filter_at(filter, t) * (1 - left / below[CELLS]) * 2 / ROWS;
    }
    return sum / all;
}

/* 4,096 samples in 16 independent parts: their mean is off by more than three of its standard
 * errors with a probability of 0.009 (Student's t, 15 degrees of freedom). Each filter has at
 * least 22 pixels at the edge and at most 110: that more than 9 of these are off by as much has
 * a probability below 1e-6 (Poisson's, of a mean of 1). */
static void edges_are_the_integral_of_the_filter(void **state) {
    (void)state;
    enum { PARTS = 16, SAMPLES = 256, OFF_MAX = 9 };
    test_scene s;
    int64_t left_out;
    half(&s);
    for (int filter = 0; filter < ZT_FILTER_COUNT; filter++) {
        double sum[EDGE_SIDE][EDGE_SIDE] = {{0}}, squares[EDGE_SIDE][EDGE_SIDE] = {{0}};
        for (int part = 0; part < PARTS; part++) {
            zt_sampling sampling = {SAMPLES, SAMPLES, .filter = (zt_filter)filter,
                                    .seed = 100 + (uint32_t)part};
            zt_image *image =
                render_sampled(&left_out, &s.scene, EDGE_SIDE, EDGE_SIDE, sampling, 2);
            for (int y = 0; y < EDGE_SIDE; y++)
                for (int x = 0; x < EDGE_SIDE; x++) {
                    double value = pixel_at(image, x, y).x;
                    sum[y][x] += value;
                    squares[y][x] += value * value;
                }
            zt_image_free(&image);
        }
        int off = 0, at_edge = 0;
        for (int y = 0; y < EDGE_SIDE; y++)
            for (int x = 0; x < EDGE_SIDE; x++) {
                double wanted = covered((zt_filter)filter, own_widths[filter], x, y);
                double mean = sum[y][x] / PARTS;
                double variance = (squares[y][x] / PARTS - mean * mean) / (PARTS - 1);
                double error = sqrt(fmax(variance, 0));
                assert_float_equal(mean, wanted, 0.02);
                if (error < 1e-6) continue;
                at_edge++;
                off += fabs(mean - wanted) > 3 * error + 2e-5; /* the reference's own error */
            }
        assert_in_range(at_edge, 20, 120);
        if (off > OFF_MAX) fail_msg("filter %d: %d of %d off", filter, off, at_edge);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_fall_where_filters_are_large),
        cmocka_unit_test(the_plain_box_is_no_filter),
        cmocka_unit_test(constants_stay_constant),
        cmocka_unit_test(edges_are_the_integral_of_the_filter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
