/* Shows that paths are measured by their true length, followed at constant speed, and leaned
 * into in their curves. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "keyframe/path.h"
#include "keys.h"
#include "real.h"

static const double pi = 3.14159265358979323846;

enum { POINTS_MAX = 32 };

static zt_curve *through(zt_arena *arena, const vec3 *points, int count, zt_curve_kind kind,
                         zt_curve_end end) {
    zt_key keys[POINTS_MAX];
    for (int k = 0; k < count; k++) keys[k] = key(k * k, (const double *)&points[k], kind);
    zt_curve *curve = ZT_PUSH(arena, zt_curve, 1);
    *curve = curve_of(arena, &(zt_curve_spec){.value_kind = ZT_VALUE_VECTOR,
                                              .key_count = count,
                                              .keys = keys,
                                              .after = end});
    return curve;
}

static zt_path path_through(zt_arena *arena, const vec3 *points, int count, zt_curve_kind kind,
                            zt_curve_end end) {
    zt_path path;
    assert_int_equal(zt_path_make(&path, arena, through(arena, points, count, kind, end)),
                     ZT_OK);
    return path;
}

static void assert_at(vec3 found, vec3 expected, double tolerance) {
    if (!(vec3_length(vec3_sub(found, expected)) <= tolerance))
        fail_msg("(%.17g, %.17g, %.17g) is not (%.17g, %.17g, %.17g)", found.x, found.y,
                 found.z, expected.x, expected.y, expected.z);
}

/* Straight legs are their lengths together, however the keys' times are, and one stops at the
 * ends. */
static void straight_legs(void **state) {
    (void)state;
    zt_arena arena = {0};
    const vec3 points[] = {{0, 0, 0}, {3, 0, 0}, {3, 0, 0}, {3, 4, 0}};
    zt_path path = path_through(&arena, points, 4, ZT_CURVE_LINEAR, ZT_END_HOLD);
    vec3 direction;
    assert_near(path.length, 7, 1e-15);
    assert_false(path.closed);
    assert_at(zt_path_point(&path, 1.5), (vec3){1.5, 0, 0}, 1e-15);
    direction = zt_path_direction(&path, 1.5);
    assert_at(direction, (vec3){1, 0, 0}, 1e-15);
    assert_at(zt_path_point(&path, 5), (vec3){3, 2, 0}, 1e-15);
    direction = zt_path_direction(&path, 5);
    assert_at(direction, (vec3){0, 1, 0}, 1e-15);
    assert_at(zt_path_point(&path, -1), points[0], 0);
    assert_at(zt_path_point(&path, 99), points[3], 0);
    assert_at(zt_path_point(&path, NAN), points[0], 0);
    assert_at(zt_path_point(&path, INFINITY), points[3], 0);
    zt_arena_free(&arena);
}

/* A parabola, whose length has a closed form: y = x^2 from -1 to 2, as one Hermite way. */
static void parabola(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double from[] = {-1, 1, 0}, to[] = {2, 4, 0}, leave[] = {3, -6, 0},
                 arrive[] = {3, 12, 0};
    const zt_key keys[] = {{.value = from, .kind = ZT_CURVE_HERMITE, .after = leave},
                           {.time_s = 1, .value = to, .before = arrive}};
    zt_curve curve = curve_of(
        &arena, &(zt_curve_spec){.value_kind = ZT_VALUE_VECTOR, .key_count = 2, .keys = keys});
    zt_path path;
    assert_int_equal(zt_path_make(&path, &arena, &curve), ZT_OK);
    for (double x = -1; x <= 2; x += 0.125) {
        double s[2], ends[] = {-1, x};
        for (int i = 0; i < 2; i++)
            s[i] = ends[i] / 2 * hypot(1, 2 * ends[i]) + asinh(2 * ends[i]) / 4;
        vec3 direction;
        assert_at(zt_path_point(&path, s[1] - s[0]), (vec3){x, x * x, 0}, 1e-12);
        direction = zt_path_direction(&path, s[1] - s[0]);
        assert_at(direction, vec3_normalize((vec3){1, 2 * x, 0}), 1e-11);
    }
    zt_arena_free(&arena);
}

/* Through points anywhere: equal distances are equal lengths of a polyline of a million legs.
 */
static void constant_speed(void **state) {
    (void)state;
    draw d = {1, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 20; round++) {
        zt_arena_reset(&arena);
        vec3 points[8];
        for (int k = 0; k < 8; k++)
            points[k] = (vec3){draw_between(&d, -1, 1), draw_between(&d, -1, 1),
                               draw_between(&d, -1, 1)};
        zt_curve *curve = through(&arena, points, 8, ZT_CURVE_CATMULL_ROM, ZT_END_HOLD);
        zt_path path;
        assert_int_equal(zt_path_make(&path, &arena, curve), ZT_OK);
        double length = 0, next = path.length / 10;
        vec3 last = points[0];
        int found = 0;
        for (int way = 0; way < 7; way++)
            for (int i = 1; i <= 20000; i++) {
                double t = way * way + (2 * way + 1) * i / 20000.0;
                vec3 p = eval_vec(curve, t);
                length += vec3_length(vec3_sub(p, last));
                last = p;
                if (length < next) continue;
                worst = fmax(worst, vec3_length(vec3_sub(zt_path_point(&path, length), p)));
                next += path.length / 10;
                found++;
            }
        worst = fmax(worst, fabs(length - path.length));
        assert_true(found >= 9);
    }
    printf("  path: worst distance to a polyline %.2g\n", worst);
    assert_true(worst < 1e-7); /* the polyline's own: (1 / 20000)^2 of curvature */
    zt_arena_free(&arena);
}

/* A closed path goes round for ever, without a corner where it closes. */
static void round_and_round(void **state) {
    (void)state;
    zt_arena arena = {0};
    vec3 points[24];
    for (int k = 0; k < 24; k++) points[k] = (vec3){cos(k * pi / 12), 0, -sin(k * pi / 12)};
    zt_path path;
    assert_int_equal(zt_path_through(&path, &arena, points, 24, true), ZT_OK);
    assert_true(path.closed);
    assert_near(path.length, 2 * pi, 0.003);
    for (int quarter = -8; quarter < 8; quarter++) {
        vec3 p = zt_path_point(&path, path.length * quarter / 4);
        assert_at(p, points[(6 * quarter + 48) % 24], 1e-12);
    }
    assert_at(zt_path_direction(&path, -1e-9), zt_path_direction(&path, 1e-9), 1e-7);
    /* It bends to the left all the way, the same everywhere; to the right, seen from below. */
    for (double s = 0; s < 20; s += 0.1) {
        assert_near(zt_path_bend(&path, s, (vec3){0, 1, 0}), 1, 0.05);
        assert_near(zt_path_bend(&path, s, (vec3){0, -3, 0}), -1, 0.05);
    }
    zt_arena_free(&arena);
}

/* A straight that goes into a wide bend to the left, then a narrow one to the right: how much
 * one leans follows, without a jump, and the narrowest bend is 1. */
static void bends(void **state) {
    (void)state;
    zt_arena arena = {0};
    vec3 points[POINTS_MAX];
    int count = 0;
    const vec3 up = {0, 0, 2};
    for (int i = 0; i < 5; i++) points[count++] = (vec3){i - 5, 0, 0};
    for (int i = 0; i <= 8; i++)
        points[count++] = (vec3){4 * sin(i * pi / 16), 4 - 4 * cos(i * pi / 16), 0};
    for (int i = 1; i <= 8; i++)
        points[count++] = (vec3){5 - cos(i * pi / 8), 4 + sin(i * pi / 8), 0};
    zt_path path;
    assert_int_equal(zt_path_through(&path, &arena, points, count, false), ZT_OK);
    double last = 0, left = 0, right = 0;
    for (double s = 0; s < path.length; s += 1e-3) {
        double bend = zt_path_bend(&path, s, up);
        assert_true(fabs(bend - last) < 0.02 && bend >= -1 && bend <= 1);
        if (s < 2.5) assert_near(bend, 0, 1e-12);
        left = fmax(left, bend);
        right = fmin(right, bend);
        last = bend;
    }
    assert_near(right, -1, 0.01);
    assert_near(left, 0.25, 0.1); /* a quarter of the curvature, where the bends are even */
    const vec3 line[] = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}};
    assert_int_equal(zt_path_through(&path, &arena, line, 3, false), ZT_OK);
    assert_true(zt_path_bend(&path, 1, up) == 0);
    zt_arena_free(&arena);
}

/* What has no length, or none that is a number, and what is no path. */
static void odd_paths(void **state) {
    (void)state;
    draw d = {2, 0};
    zt_arena arena = {0};
    const vec3 same[] = {{1, 2, 3}, {1, 2, 3}};
    zt_path path = path_through(&arena, same, 2, ZT_CURVE_CATMULL_ROM, ZT_END_HOLD);
    vec3 direction;
    assert_at(zt_path_point(&path, 1), same[0], 0);
    direction = zt_path_direction(&path, 1);
    assert_at(direction, (vec3){0, 0, 0}, 0);
    assert_true(zt_path_bend(&path, 1, (vec3){0, 1, 0}) == 0);
    assert_int_equal(zt_path_through(&path, &arena, same, 1, true), ZT_EARGUMENT);
    zt_curve *one = through(&arena, same, 1, ZT_CURVE_LINEAR, ZT_END_HOLD);
    assert_int_equal(zt_path_make(&path, &arena, one), ZT_EARGUMENT);
    const vec3 far[] = {{-1.7e308, 0, 0}, {1.7e308, 0, 0}};
    zt_curve *endless = through(&arena, far, 2, ZT_CURVE_LINEAR, ZT_END_HOLD);
    assert_int_equal(zt_path_make(&path, &arena, endless), ZT_EARGUMENT);
    for (int round = 0; round < 3000; round++) {
        zt_arena_reset(&arena);
        vec3 points[6];
        for (int k = 0; k < 6; k++)
            points[k] = (vec3){draw_nasty(&d), draw_nasty(&d), draw_nasty(&d)};
        zt_curve *curve = through(
            &arena, points, 6, (zt_curve_kind)draw_below(&d, ZT_CURVE_KIND_COUNT), ZT_END_HOLD);
        if (zt_path_make(&path, &arena, curve) != ZT_OK) continue;
        for (int i = 0; i < 10; i++) {
            double s = path.length * draw_between(&d, -0.1, 1.1);
            vec3 p = zt_path_point(&path, s);
            direction = zt_path_direction(&path, s);
            assert_true(fabs(zt_path_bend(&path, s, (vec3){0, 1, 0})) <= 1);
            assert_true(isfinite(p.x) && isfinite(p.y) && isfinite(p.z));
            double length = vec3_length(direction);
            assert_true(length == 0 || fabs(length - 1) < 1e-14);
        }
    }
    zt_arena_free(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_legs),  cmocka_unit_test(parabola),
        cmocka_unit_test(constant_speed), cmocka_unit_test(round_and_round),
        cmocka_unit_test(bends),          cmocka_unit_test(odd_paths),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
