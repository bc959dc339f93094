/* Shows what curves do before their first and after their last key, that springs carry on from
 * key to key, and that nothing whatever makes a curve give out what is no number. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "keyframe/rotation.h"
#include "keys.h"
#include "real.h"

/* ---- straight on ---------------------------------------------------------------------------
 */

/* The speed at a time, from the two sides given, by differences of the second order. */
static double speed(const zt_curve *curve, double time_s, double h) {
    return (4 * eval1(curve, time_s + h) - 3 * eval1(curve, time_s) -
            eval1(curve, time_s + 2 * h)) /
           (2 * h);
}

/* Whatever the kind of the last way, the curve goes straight on at the speed it has there, and
 * the same before the first key. */
static void straight_on(void **state) {
    (void)state;
    zt_arena arena = {0};
    zt_ease ease, sine;
    assert_null(zt_ease_parse(&ease, &arena, "cubic-bezier(0.3, 0.6, 0.5, 0.8)"));
    assert_null(zt_ease_parse(&sine, &arena, "linear(0, 0.2 40%, 1)"));
    const double values[] = {1, 2, 4, 3}, tangents[] = {0.7, -0.3, 0.9, 1.1};
    for (int kind = ZT_CURVE_LINEAR; kind < ZT_CURVE_KIND_COUNT + 2; kind++) {
        zt_key keys[4];
        for (int k = 0; k < 4; k++) {
            keys[k] = key(2 * k + k % 2 * 0.5, &values[k], (zt_curve_kind)kind);
            keys[k].before = keys[k].after = &tangents[k];
            keys[k].before_s = keys[k].after_s = 0.4;
            keys[k].tension = -0.5;
            keys[k].bias = 0.3;
            if (kind >= ZT_CURVE_KIND_COUNT) {
                keys[k].kind = ZT_CURVE_LINEAR;
                keys[k].ease = kind == ZT_CURVE_KIND_COUNT ? &ease : &sine;
            }
        }
        zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_NUMBER,
                                                           .key_count = 4,
                                                           .keys = keys,
                                                           .before = ZT_END_LINEAR,
                                                           .after = ZT_END_LINEAR});
        double first = keys[0].time_s, last = keys[3].time_s;
        double begin = speed(&curve, first, 1e-5), end = speed(&curve, last, -1e-5);
        assert_true(fabs(begin) > 1e-3 && fabs(end) > 1e-3);
        assert_near(eval1(&curve, first - 5), 1 - 5 * begin, 1e-7);
        assert_near(eval1(&curve, last + 5), 3 + 5 * end, 1e-7);
        assert_near(eval1(&curve, last + 10) - eval1(&curve, last + 5),
                    eval1(&curve, last + 5) - eval1(&curve, last), 1e-12);
        assert_true(eval1(&curve, first) == 1 && eval1(&curve, last) == 3);
    }
    zt_arena_free(&arena);
}

/* Rotations turn on as fast as they did, whatever their kind. */
static void turning_on(void **state) {
    (void)state;
    zt_arena arena = {0};
    draw d = {1, 0};
    for (int kind = ZT_CURVE_LINEAR; kind < ZT_CURVE_KIND_COUNT; kind++) {
        quat q[4];
        zt_key keys[4];
        for (int k = 0; k < 4; k++) {
            q[k] = draw_rotation(&d);
            keys[k] = key(k + 0.2 * (k % 2), (const double *)&q[k], (zt_curve_kind)kind);
        }
        const double tangent[] = {0.3, -0.2, 0.5, 0.7};
        if (kind == ZT_CURVE_HERMITE) keys[0].after = keys[3].before = tangent;
        zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_ROTATION,
                                                           .key_count = 4,
                                                           .keys = keys,
                                                           .before = ZT_END_LINEAR,
                                                           .after = ZT_END_LINEAR});
        double last = keys[3].time_s, h = 1e-6;
        vec3 before = turning(&curve, last - h, last), after = turning(&curve, last, last + h);
        vec3 later = turning(&curve, last + 7, last + 7 + h);
        assert_true(vec3_length(after) > 0.01);
        assert_near(vec3_length(vec3_sub(before, after)), 0, 1e-4);
        assert_near(vec3_length(vec3_sub(later, after)), 0, 1e-8);
        before = turning(&curve, -h, 0), after = turning(&curve, 0, h);
        assert_near(vec3_length(vec3_sub(before, after)), 0, 1e-4);
    }
    zt_arena_free(&arena);
}

/* ---- loops ---------------------------------------------------------------------------------
 */

static zt_curve looped(zt_arena *arena, zt_curve_end end, zt_curve_kind kind, int count,
                       const double *times, const double *values) {
    zt_key keys[16];
    for (int k = 0; k < count; k++) keys[k] = key(times[k], &values[k], kind);
    return curve_of(arena, &(zt_curve_spec){.value_kind = ZT_VALUE_NUMBER,
                                            .key_count = count,
                                            .keys = keys,
                                            .before = end,
                                            .after = end});
}

/* A loop of ten frames shows ten frames, at any rate, forwards and backwards, for a day: the
 * last key is the first one again, and no frame comes twice or too late. */
static void loops(void **state) {
    (void)state;
    zt_arena arena = {0};
    const int rates[][2] = {{24, 1}, {25, 1}, {30, 1}, {60, 1}, {30000, 1001}, {24000, 1001}};
    for (int r = 0; r < 6; r++) {
        double times[11], values[11];
        for (int k = 0; k <= 10; k++) {
            times[k] = (double)((k + 7) * rates[r][1]) / rates[r][0];
            values[k] = k;
        }
        zt_curve curve = looped(&arena, ZT_END_LOOP, ZT_CURVE_HOLD, 11, times, values);
        zt_curve there = looped(&arena, ZT_END_PING_PONG, ZT_CURVE_LINEAR, 11, times, values);
        zt_curve offset =
            looped(&arena, ZT_END_LOOP_WITH_OFFSET, ZT_CURVE_HOLD, 11, times, values);
        for (int64_t frame = -3000; frame < 2600000; frame += frame < 3000 ? 1 : 997) {
            double t = (double)((frame + 7) * rates[r][1]) / rates[r][0];
            int in_round = (int)((frame % 10 + 10) % 10),
                in_two = (int)((frame % 20 + 20) % 20);
            assert_true(eval1(&curve, t) == in_round);
            assert_true(eval1(&there, t) == (in_two <= 10 ? in_two : 20 - in_two));
            assert_true(eval1(&offset, t) == (double)frame);
        }
    }
    zt_arena_free(&arena);
}

/* Smooth, Catmull-Rom and TCB loops have no corner where they close; nor do their offsets. */
static void loops_close(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double times[] = {1, 2, 4, 5}, values[] = {0, 3, 1, 0}, rising[] = {0, 1, 3, 4};
    const zt_curve_kind kinds[] = {ZT_CURVE_SMOOTH, ZT_CURVE_TCB};
    for (int i = 0; i < 2; i++)
        for (int rises = 0; rises < 2; rises++) {
            zt_curve curve = looped(&arena, rises ? ZT_END_LOOP_WITH_OFFSET : ZT_END_LOOP,
                                    kinds[i], 4, times, rises ? rising : values);
            for (double seam = -3; seam < 20; seam += 4) {
                double before = speed(&curve, seam, -1e-5), after = speed(&curve, seam, 1e-5);
                assert_near(before, after, 1e-4);
                if (rises) assert_true(after > 0.5);
                assert_near(eval1(&curve, seam), rises ? seam - 1 : 0, 1e-14);
            }
        }
    zt_arena_free(&arena);
}

/* Rotations repeated with their offset turn on and on, around any axis. */
static void rotations_with_offset(void **state) {
    (void)state;
    zt_arena arena = {0};
    draw d = {2, 0};
    for (int round = 0; round < 200; round++) {
        zt_arena_reset(&arena);
        quat begin = draw_rotation(&d), side = draw_rotation(&d);
        vec3 axis = vec3_normalize((vec3){side.x, side.y, side.z});
        quat end = quat_mul(quat_axis_angle(axis, 1.3), begin);
        const zt_key keys[] = {key(0, (double *)&begin, ZT_CURVE_LINEAR),
                               key(2, (double *)&end, ZT_CURVE_LINEAR)};
        zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_ROTATION,
                                                           .key_count = 2,
                                                           .keys = keys,
                                                           .before = ZT_END_LOOP_WITH_OFFSET,
                                                           .after = ZT_END_LOOP_WITH_OFFSET});
        for (double t = -20; t < 20; t += 0.37) {
            quat expected = quat_mul(quat_axis_angle(axis, 1.3 * t / 2), begin);
            assert_true(zt_rotation_angle(eval_quat(&curve, t), expected) < 1e-13);
        }
    }
    zt_arena_free(&arena);
}

/* One key has no rounds to make, and each end is chosen by itself. */
static void ends_differ(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double values[] = {3, 5};
    zt_key keys[] = {key(1, &values[0], ZT_CURVE_LINEAR), key(2, &values[1], ZT_CURVE_LINEAR)};
    for (zt_curve_end end = 0; end < ZT_END_COUNT; end++) {
        zt_curve one = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_NUMBER,
                                                         .key_count = 1,
                                                         .keys = keys,
                                                         .before = end,
                                                         .after = end});
        assert_true(eval1(&one, -9) == 3 && eval1(&one, 1) == 3 && eval1(&one, 9) == 3);
        assert_true(strlen(zt_curve_end_name(end)) >= 4);
    }
    zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_NUMBER,
                                                       .key_count = 2,
                                                       .keys = keys,
                                                       .before = ZT_END_LINEAR,
                                                       .after = ZT_END_PING_PONG});
    assert_true(eval1(&curve, 0) == 1 && eval1(&curve, 2.25) == 4.5 &&
                eval1(&curve, 3.25) == 3.5);
    /* Where a time falls: the way, the share of its time, and the round. */
    zt_curve_spot spot = zt_curve_find(&curve, 3.25);
    assert_true(spot.key == 0 && spot.u == 0.25 && spot.round == 2 && spot.beyond_s == 0);
    spot = zt_curve_find(&curve, 0.5);
    assert_true(spot.key == 0 && spot.u == 0 && spot.beyond_s == -0.5);
    zt_arena_free(&arena);
}

/* ---- springs -------------------------------------------------------------------------------
 */

/* Position and speed of the undimensioned spring after an angle, for ratios below 1. */
static void swing(real *x, real *w, real ratio, real angle) {
    real s = REAL(sqrt)(1 - ratio * ratio), e = REAL(exp)(-ratio * angle);
    real c = REAL(cos)(s * angle), d = REAL(sin)(s * angle) / s, x0 = *x;
    *x = e * (x0 * (c + ratio * d) + *w * d);
    *w = e * (*w * (c - ratio * d) - x0 * d);
}

/* Over any number of keys the spring is where a reference that swings from key to key is, asked
 * in any order; and it arrives at the last key's value in the end. */
static void springs(void **state) {
    (void)state;
    enum { COUNT = 8 };
    draw d = {3, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 500; round++) {
        zt_arena_reset(&arena);
        double times[COUNT], values[COUNT];
        zt_key keys[COUNT];
        draw_times(&d, times, COUNT, 0.1, 10);
        for (int k = 0; k < COUNT; k++) {
            values[k] = draw_between(&d, -1, 1);
            keys[k] = key(times[k], &values[k], ZT_CURVE_HOLD);
        }
        double frequency = draw_magnitude(&d, 0.1, 1e6), ratio = draw_between(&d, 0.001, 0.9);
        zt_spring spring = zt_spring_make(frequency, ratio);
        zt_curve curve = curve_of(&arena, &(zt_curve_spec){.value_kind = ZT_VALUE_NUMBER,
                                                           .key_count = COUNT,
                                                           .keys = keys,
                                                           .spring = &spring});
        real x = 0, w = 0;
        for (int k = 0; k < COUNT; k++) {
            if (k) x += (real)values[k - 1] - values[k];
            double t = times[k] + draw_unit(&d) * (k + 1 < COUNT ? times[k + 1] - times[k] : 9);
            real x_t = x, w_t = w;
            swing(&x_t, &w_t, ratio, (real)frequency * ((real)t - times[k]));
            worst = fmax(worst, fabs((double)(values[k] + x_t - eval1(&curve, t))));
            if (k + 1 < COUNT)
                swing(&x, &w, ratio, (real)frequency * ((real)times[k + 1] - times[k]));
        }
        assert_true(eval1(&curve, times[0] - 1) == values[0]);
        assert_true(eval1(&curve, times[0]) == values[0]);
        assert_near(eval1(&curve, times[COUNT - 1] + 1e7 / frequency), values[COUNT - 1],
                    1e-12);
        assert_string_equal(zt_curve_label(&curve), "spring");
    }
    printf("  spring over %d keys: worst error %.2g of values of 1\n", COUNT, worst);
    assert_true(worst < 1e-12);
    zt_arena_free(&arena);
}

/* A rotation on a spring around one axis is the spring of its angle; around any, it neither
 * jumps nor changes its speed at a key. */
static void springs_of_rotations(void **state) {
    (void)state;
    draw d = {4, 0};
    zt_arena arena = {0};
    double worst = 0, corner = 0;
    for (int round = 0; round < 300; round++) {
        zt_arena_reset(&arena);
        zt_spring spring = zt_spring_make(draw_magnitude(&d, 1, 10), draw_between(&d, 0.05, 2));
        double angles[5];
        quat about[5], any[5], side = draw_rotation(&d);
        vec3 axis = vec3_normalize((vec3){side.x, side.y, side.z});
        zt_key keys[3][5];
        for (int k = 0; k < 5; k++) {
            angles[k] = draw_between(&d, -0.7, 0.7);
            about[k] = quat_axis_angle(axis, angles[k]);
            any[k] = draw_rotation(&d);
            keys[0][k] = key(k, &angles[k], ZT_CURVE_HOLD);
            keys[1][k] = key(k, (double *)&about[k], ZT_CURVE_HOLD);
            keys[2][k] = key(k, (double *)&any[k], ZT_CURVE_HOLD);
        }
        zt_curve curves[3];
        for (int i = 0; i < 3; i++)
            curves[i] = curve_of(
                &arena, &(zt_curve_spec){.value_kind = i ? ZT_VALUE_ROTATION : ZT_VALUE_ANGLE,
                                         .key_count = 5,
                                         .keys = keys[i],
                                         .spring = &spring});
        for (double t = 0; t < 6; t += 0.05) {
            quat expected = quat_axis_angle(axis, eval1(&curves[0], t));
            worst = fmax(worst, zt_rotation_angle(eval_quat(&curves[1], t), expected));
        }
        for (int k = 1; k < 5; k++) {
            const double h = 1e-6;
            vec3 before = turning(&curves[2], k - h, k), after = turning(&curves[2], k, k + h);
            corner = fmax(corner, vec3_length(vec3_sub(before, after)));
        }
    }
    printf("  spring around one axis: worst error %.2g; worst corner around any %.2g rad/s\n",
           worst, corner);
    assert_true(worst < 1e-12);
    assert_true(corner < 0.01); /* accelerations reach frequency^2 * pi = 314, times h, twice */
    zt_arena_free(&arena);
}

/* ---- anything ------------------------------------------------------------------------------
 */

/* Keys as wild as they come, of every kind in every space with every end, springs and eases:
 * all that comes out is finite, and every rotation is one. */
static void never_no_number(void **state) {
    (void)state;
    enum { COUNT = 5 };
    static const char *const texts[] = {"back-in-out(1e6)", "elastic-out(1e6, 1e-6)",
                                        "linear(1e300, -1e300)",
                                        "cubic-bezier(0,1e300,1,-1e300)", "steps(3)"};
    draw d = {5, 0};
    zt_arena words = {0}, arena = {0};
    zt_ease eases[5];
    for (int i = 0; i < 5; i++) assert_null(zt_ease_parse(&eases[i], &words, texts[i]));
    int64_t values_seen = 0, clipped = 0;
    for (int round = 0; round < 60000; round++) {
        zt_arena_reset(&arena);
        zt_value_kind value_kind = (zt_value_kind)draw_below(&d, ZT_VALUE_SWITCH + 1);
        zt_curve_space space = ZT_SPACE_VALUES;
        if (value_kind == ZT_VALUE_COLOR && draw_below(&d, 2)) space = ZT_SPACE_OKLAB;
        if (value_kind == ZT_VALUE_ROTATION && draw_below(&d, 2)) space = ZT_SPACE_TURNS;
        double times[COUNT], numbers[COUNT][3][ZT_VALUE_WIDTH_MAX];
        bool wild = draw_below(&d, 3) == 0;
        draw_times(&d, times, COUNT, wild ? 1e-300 : 1e-9, wild ? 1e300 : 1e9);
        zt_key keys[COUNT];
        for (int k = 0; k < COUNT; k++) {
            for (int i = 0; i < 3 * ZT_VALUE_WIDTH_MAX; i++)
                numbers[k][i / 9][i % 9] = draw_nasty(&d);
            keys[k] = key(times[k], numbers[k][0],
                          (zt_curve_kind)draw_below(&d, ZT_CURVE_KIND_COUNT));
            if (draw_below(&d, 2)) keys[k].before = numbers[k][1];
            if (draw_below(&d, 2)) keys[k].after = numbers[k][2];
            keys[k].before_s = fabs(draw_nasty(&d));
            keys[k].after_s = fabs(draw_nasty(&d));
            keys[k].tension = draw_nasty(&d);
            keys[k].continuity = draw_nasty(&d);
            keys[k].bias = draw_nasty(&d);
            if (draw_below(&d, 3) == 0) keys[k].ease = &eases[draw_below(&d, 5)];
        }
        zt_spring spring =
            zt_spring_make(draw_magnitude(&d, 1e-6, 1e9), draw_magnitude(&d, 1e-9, 1e6));
        zt_curve curve = curve_of(
            &arena, &(zt_curve_spec){.value_kind = value_kind,
                                     .space = space,
                                     .key_count = 1 + draw_below(&d, COUNT),
                                     .keys = keys,
                                     .before = (zt_curve_end)draw_below(&d, ZT_END_COUNT),
                                     .after = (zt_curve_end)draw_below(&d, ZT_END_COUNT),
                                     .spring = draw_below(&d, 4) ? NULL : &spring});
        clipped += curve.clipped;
        for (int i = 0; i < 20; i++) {
            double t = draw_below(&d, 2) ? draw_between(&d, times[0], times[COUNT - 1])
                                         : times[0] + draw_nasty(&d);
            double value[ZT_VALUE_WIDTH_MAX];
            zt_curve_eval(value, &curve, t);
            for (int c = 0; c < curve.width; c++, values_seen++)
                if (!isfinite(value[c]))
                    fail_msg("%s of value %d in space %d at %g is %g", zt_curve_label(&curve),
                             (int)value_kind, (int)space, t, value[c]);
            if (value_kind != ZT_VALUE_ROTATION) continue;
            double length = sqrt(value[0] * value[0] + value[1] * value[1] +
                                 value[2] * value[2] + value[3] * value[3]);
            if (!(fabs(length - 1) < 1e-14)) fail_msg("length %.17g", length);
        }
    }
    printf("  %lld values finite; %lld of 60000 curves clipped\n", (long long)values_seen,
           (long long)clipped);
    zt_arena_free(&words);
    zt_arena_free(&arena);
}

/* Specifications that make no sense are refused. */
static void refused(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double value[4] = {1, 0, 0, 0}, none[4] = {NAN, 0, 0, 0};
    zt_key keys[2] = {key(0, value, ZT_CURVE_BEZIER), key(1, value, ZT_CURVE_BEZIER)};
    zt_curve_spec spec = {.value_kind = ZT_VALUE_NUMBER, .key_count = 2, .keys = keys};
    zt_curve curve;
    assert_int_equal(zt_curve_from_keys(&curve, &arena, &spec), ZT_OK);
    spec.space = ZT_SPACE_OKLAB;
    assert_int_equal(zt_curve_from_keys(&curve, &arena, &spec), ZT_EARGUMENT);
    spec.space = ZT_SPACE_TURNS;
    assert_int_equal(zt_curve_from_keys(&curve, &arena, &spec), ZT_EARGUMENT);
    spec.space = ZT_SPACE_VALUES;
    const zt_key wrong[] = {
        {.time_s = 1, .value = none},
        {.time_s = 1, .value = NULL},
        {.time_s = 1, .value = value, .kind = ZT_CURVE_HERMITE, .after = none},
        {.time_s = 1, .value = value, .before = none},
        {.time_s = 1, .value = value, .kind = ZT_CURVE_BEZIER, .after_s = -1},
        {.time_s = 1, .value = value, .before_s = NAN},
        {.time_s = 1, .value = value, .tension = INFINITY},
        {.time_s = 0, .value = value},
        {.time_s = -1, .value = value},
        {.time_s = NAN, .value = value},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        keys[1] = wrong[i];
        assert_int_equal(zt_curve_from_keys(&curve, &arena, &spec), ZT_EARGUMENT);
    }
    zt_arena_free(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_on),
        cmocka_unit_test(turning_on),
        cmocka_unit_test(loops),
        cmocka_unit_test(loops_close),
        cmocka_unit_test(rotations_with_offset),
        cmocka_unit_test(ends_differ),
        cmocka_unit_test(springs),
        cmocka_unit_test(springs_of_rotations),
        cmocka_unit_test(never_no_number),
        cmocka_unit_test(refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
