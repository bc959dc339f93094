/* Shows that curves pass through their keys exactly, follow their closed forms in between,
 * never leave the interval of two keys where that is promised, and are functions of time alone.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <zoetrope/rate.h>

#include "base/pool.h"
#include "keys.h"
#include "real.h"

enum { KEYS_MAX = 64 };

static zt_curve make(zt_arena *arena, zt_curve_kind kind, zt_value_kind value_kind, int count,
                     const double *times, const double *values) {
    zt_curve curve;
    assert_int_equal(curve_through(&curve, arena, kind, value_kind, count, times, values),
                     ZT_OK);
    return curve;
}

/* Hold, linear and smooth at times for which paper gives the value. */
static void closed_forms(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double times[] = {0, 1, 3, 4}, values[] = {0, 2, 10, 10};
    zt_curve hold = make(&arena, ZT_CURVE_HOLD, ZT_VALUE_NUMBER, 4, times, values);
    assert_true(eval1(&hold, 0.999) == 0 && eval1(&hold, 1) == 2 && eval1(&hold, 2.99) == 2);
    zt_curve linear = make(&arena, ZT_CURVE_LINEAR, ZT_VALUE_ANGLE, 4, times, values);
    assert_true(eval1(&linear, 0.25) == 0.5 && eval1(&linear, 2.5) == 8);
    assert_true(eval1(&linear, 3.7) == 10);
    /* Two keys: rest to rest. */
    zt_curve ramp = make(&arena, ZT_CURVE_SMOOTH, ZT_VALUE_NUMBER, 2, times, values);
    for (double u = 0; u <= 1; u += 0.125)
        assert_near(eval1(&ramp, u), 2 * u * u * (3 - 2 * u), 1e-15);
    /* Steffen at 1 s: mean speeds 2 and 4, the parabola's 2 * 2/3 + 4 * 1/3 = 8/3; at most
     * twice the smaller; so the cubic Hermite on 1..3 s begins at 8/3 a second and ends at
     * rest. */
    zt_curve smooth = make(&arena, ZT_CURVE_SMOOTH, ZT_VALUE_NUMBER, 4, times, values);
    assert_near(eval1(&smooth, 2), (2 + 10) / 2.0 + 2 * (8 / 3.0) / 8, 1e-14);
    assert_near(eval1(&smooth, 0.5), 1 - 1 * (8 / 3.0) / 8, 1e-15);
    assert_true(eval1(&smooth, 3.4) == 10);
    const zt_curve *curves[] = {&hold, &linear, &smooth};
    for (int i = 0; i < 3; i++) {
        assert_true(eval1(curves[i], -1) == 0 && eval1(curves[i], -INFINITY) == 0);
        assert_true(eval1(curves[i], 99) == 10 && eval1(curves[i], INFINITY) == 10);
        assert_true(eval1(curves[i], NAN) == 0);
    }
    assert_string_equal(zt_curve_name(ZT_CURVE_HOLD), "hold");
    assert_string_equal(zt_curve_name(ZT_CURVE_LINEAR), "linear");
    assert_string_equal(zt_curve_name(ZT_CURVE_SMOOTH), "smooth");
    zt_arena_free(&arena);
}

/* Each channel of each kind of value moves by itself; switches hold whatever is asked for. */
static void kinds_of_values(void **state) {
    (void)state;
    zt_arena arena = {0};
    const double times[] = {0, 2};
    double values[18], value[9];
    for (int c = 0; c < 18; c++) values[c] = c < 9 ? c : 3 * c;
    const zt_value_kind kinds[] = {ZT_VALUE_NUMBER, ZT_VALUE_ANGLE, ZT_VALUE_VECTOR,
                                   ZT_VALUE_SCALE,  ZT_VALUE_COLOR, ZT_VALUE_VERTICES};
    for (int i = 0; i < 6; i++)
        for (zt_curve_kind kind = ZT_CURVE_LINEAR; kind <= ZT_CURVE_SMOOTH; kind++) {
            int width = zt_value_width(kinds[i]);
            zt_curve curve = make(&arena, kind, kinds[i], 2, times, values);
            zt_curve_eval(value, &curve, 1);
            for (int c = 0; c < width; c++)
                assert_near(value[c], (values[c] + values[width + c]) / 2, 1e-14);
        }
    const double on[] = {0, 1, 0};
    const double at[] = {0, 1, 2};
    for (zt_curve_kind kind = 0; kind < ZT_CURVE_KIND_COUNT; kind++) {
        zt_curve curve = make(&arena, kind, ZT_VALUE_SWITCH, 3, at, on);
        assert_true(eval1(&curve, 0.99) == 0 && eval1(&curve, 1.99) == 1 &&
                    eval1(&curve, 2) == 0);
    }
    zt_arena_free(&arena);
}

/* At a key's time the value is the key's own, bit for bit, whatever stands around it. */
static void exact_at_keys(void **state) {
    (void)state;
    draw d = {1, 0};
    zt_arena arena = {0};
    for (int round = 0; round < 20000; round++) {
        zt_arena_reset(&arena);
        int count = 1 + draw_below(&d, KEYS_MAX);
        double times[KEYS_MAX], values[KEYS_MAX * 3], value[3];
        draw_times(&d, times, count, 1e-9, 1e9);
        for (int i = 0; i < 3 * count; i++) values[i] = draw_nasty(&d);
        zt_curve_kind kind = (zt_curve_kind)draw_below(&d, ZT_CURVE_KIND_COUNT);
        zt_curve curve = make(&arena, kind, ZT_VALUE_VECTOR, count, times, values);
        for (int k = 0; k < count; k++) {
            zt_curve_eval(value, &curve, times[k]);
            assert_memory_equal(value, values + 3 * k, sizeof value);
        }
    }
    zt_arena_free(&arena);
}

/* Fails where a curve leaves the interval of two keys; returns at how many times it looked. */
static int check_between_keys(const zt_curve *curve, const double *times,
                              const double *values) {
    static const double fractions[] = {0x1p-40, 0.1, 0.5, 0.9, 1 - 0x1p-40};
    int checked = 0;
    for (int k = 0; k + 1 < curve->key_count; k++)
        for (int i = 0; i < 5; i++) {
            double t = times[k] + fractions[i] * (times[k + 1] - times[k]);
            if (t >= times[k + 1]) continue;
            double value = eval1(curve, t);
            double low = fmin(values[k], values[k + 1]), high = fmax(values[k], values[k + 1]);
            checked++;
            if (!(value >= low && value <= high))
                fail_msg("%g is not between %g and %g", value, low, high);
        }
    return checked;
}

/* Smooth and linear stay between their two keys, and finite, for a million sets of keys. */
static void never_leaves_its_keys(void **state) {
    (void)state;
    draw d = {2, 0};
    zt_arena arena = {0};
    int64_t checked = 0;
    for (int round = 0; round < 1000000; round++) {
        zt_arena_reset(&arena);
        int count = 2 + draw_below(&d, 4);
        double times[5], values[5];
        bool instant = draw_below(&d, 16) == 0; /* spacings of one unit in the last place */
        draw_times(&d, times, count, instant ? 1e-300 : 1e-9, instant ? 1e-9 : 1e9);
        for (int k = 0; k < count; k++)
            values[k] = k && draw_below(&d, 6) == 0 ? values[k - 1] : draw_nasty(&d);
        /* Each set is smooth; some are linear as well. */
        for (int way = draw_below(&d, 8) ? 1 : 0; way < 2; way++) {
            zt_curve curve = make(&arena, way ? ZT_CURVE_SMOOTH : ZT_CURVE_LINEAR,
                                  ZT_VALUE_NUMBER, count, times, values);
            checked += check_between_keys(&curve, times, values);
        }
    }
    printf("  %lld values between two keys, none outside\n", (long long)checked);
    zt_arena_free(&arena);
}

/* Steffen's slopes and the cubic Hermite polynomials in higher precision, as his paper has
 * them. */
static real smooth_reference(const double *times, const double *values, int count, double t) {
    int k = 0;
    while (k + 2 < count && times[k + 1] <= t) k++;
    real slopes[2] = {0, 0};
    for (int end = 0; end < 2; end++) {
        int i = k + end;
        if (i == 0 || i + 1 == count) continue;
        real h0 = (real)times[i] - times[i - 1], h1 = (real)times[i + 1] - times[i];
        real s0 = ((real)values[i] - values[i - 1]) / h0;
        real s1 = ((real)values[i + 1] - values[i]) / h1;
        real p = REAL(fabs)((s0 * h1 + s1 * h0) / (h0 + h1)) / 2;
        real least = REAL(fmin)(REAL(fmin)(REAL(fabs)(s0), REAL(fabs)(s1)), p);
        if (s0 > 0 && s1 > 0) slopes[end] = 2 * least;
        if (s0 < 0 && s1 < 0) slopes[end] = -2 * least;
    }
    real h = (real)times[k + 1] - times[k], u = ((real)t - times[k]) / h;
    return (1 + 2 * u) * (1 - u) * (1 - u) * values[k] + u * (1 - u) * (1 - u) * h * slopes[0] +
           u * u * (3 - 2 * u) * values[k + 1] - u * u * (1 - u) * h * slopes[1];
}

/* Smooth is Steffen's curve, at rest at both ends, to within rounding. */
static void smooth_is_steffens(void **state) {
    (void)state;
    draw d = {3, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 50000; round++) {
        zt_arena_reset(&arena);
        double times[6], values[6];
        draw_times(&d, times, 6, 1e-3, 1e3);
        for (int k = 0; k < 6; k++) values[k] = draw_between(&d, -10, 10);
        zt_curve curve = make(&arena, ZT_CURVE_SMOOTH, ZT_VALUE_NUMBER, 6, times, values);
        for (int i = 0; i < 8; i++) {
            double t = draw_between(&d, times[0], times[5]);
            real expected = smooth_reference(times, values, 6, t);
            worst = fmax(worst, fabs((double)(expected - eval1(&curve, t))));
        }
    }
    printf("  smooth: worst error %.2g for values of 10\n", worst);
    assert_true(worst < 2e-14);
    zt_arena_free(&arena);
}

/* The speeds on both sides of a key are the same, however uneven the times: neither smooth ways
 * nor TCB's with continuity 0 have a corner. */
static void no_corners(void **state) {
    (void)state;
    draw d = {4, 0};
    zt_arena arena = {0};
    double worst = 0;
    for (int round = 0; round < 40000; round++) {
        zt_arena_reset(&arena);
        double times[5], values[5];
        draw_times(&d, times, 5, 0.1, 10);
        for (int k = 0; k < 5; k++) values[k] = draw_between(&d, -1, 1);
        zt_curve_kind kind = round % 2 ? ZT_CURVE_TCB : ZT_CURVE_SMOOTH;
        zt_curve curve = make(&arena, kind, ZT_VALUE_NUMBER, 5, times, values);
        const double h = 1e-5;
        /* At its ends, only what is smooth is at rest. */
        for (int k = round % 2; k < 5 - round % 2; k++) {
            double at = eval1(&curve, times[k]);
            double before = (at - eval1(&curve, times[k] - h)) / h;
            double after = (eval1(&curve, times[k] + h) - at) / h;
            worst = fmax(worst, fabs(after - before));
        }
    }
    printf("  smooth, tcb: worst change of speed at a key %.2g\n", worst);
    assert_true(worst < 0.05); /* 2nd derivatives reach 6 * 2 / 0.1^2, times h = 1e-5, twice */
    zt_arena_free(&arena);
}

/* A frame's time is the double nearest to the true one, however long the film. */
static void frame_times(void **state) {
    (void)state;
    const zt_rate rates[] = {{24, 1}, {25, 1}, {30000, 1001}, {24000, 1001}, {60000, 1001}};
    for (int r = 0; r < 5; r++)
        for (int64_t n = 0; n <= 100000000; n += n < 100000 ? 1 : 9973) {
            double expected = (double)((real)n * rates[r].den / rates[r].num);
            if (zt_rate_time(rates[r], n) != expected) fail_msg("frame %lld", (long long)n);
        }
}

typedef struct query {
    const zt_curve *curve;
    const double *times;
    double (*values)[4];
} query;

static void ask(void *user, int task, int worker) {
    (void)worker;
    const query *q = user;
    zt_curve_eval(q->values[task], q->curve, q->times[task]);
}

/* Forwards, backwards, at random, and from four threads: the same bits. */
static void order_does_not_matter(void **state) {
    (void)state;
    enum { COUNT = 4000 };
    static double times[COUNT], forwards[COUNT][4], other[COUNT][4];
    draw d = {5, 0};
    zt_pool *pool;
    assert_int_equal(zt_pool_open(&pool, 4), ZT_OK);
    zt_arena arena = {0};
    for (int i = 0; i < COUNT; i++) times[i] = (double)i * 1001 / 30000;
    for (int kind = 0; kind < ZT_CURVE_KIND_COUNT * 2; kind++) {
        double at[40], values[160];
        draw_times(&d, at, 40, 1, 5);
        for (int k = 0; k < 40; k++) {
            at[k] -= at[0] * (k > 0);
            quat q = draw_rotation(&d);
            memcpy(values + 4 * k, &q, sizeof q);
        }
        at[0] = 0;
        zt_curve curve = make(&arena, (zt_curve_kind)(kind / 2),
                              kind % 2 ? ZT_VALUE_ROTATION : ZT_VALUE_VECTOR, 40, at, values);
        memset(forwards, 0, sizeof forwards);
        memset(other, 0, sizeof other);
        for (int i = 0; i < COUNT; i++) zt_curve_eval(forwards[i], &curve, times[i]);
        for (int i = COUNT; i-- > 0;) zt_curve_eval(other[i], &curve, times[i]);
        assert_memory_equal(forwards, other, sizeof other);
        for (int i = 0; i < 4 * COUNT; i++) {
            int frame = draw_below(&d, COUNT);
            zt_curve_eval(other[frame], &curve, times[frame]);
        }
        assert_memory_equal(forwards, other, sizeof other);
        memset(other, 0, sizeof other);
        zt_pool_run(pool, COUNT, ask, &(query){&curve, times, other});
        assert_memory_equal(forwards, other, sizeof other);
    }
    zt_pool_close(&pool);
    zt_arena_free(&arena);
}

/* Keys that are none are refused: none at all, times that stand still or run back, no numbers.
 */
static void unsound_keys(void **state) {
    (void)state;
    zt_arena arena = {0};
    zt_curve curve;
    const double sound[] = {0, 1, 2};
    const double unsound[][3] = {
        {0, 1, 1}, {0, 2, 1}, {NAN, 1, 2}, {0, NAN, 1}, {0, 1, INFINITY}};
    for (int i = 0; i < 5; i++)
        assert_int_equal(curve_through(&curve, &arena, ZT_CURVE_LINEAR, ZT_VALUE_NUMBER, 3,
                                       unsound[i], sound),
                         ZT_EARGUMENT);
    for (int i = 2; i < 5; i++)
        assert_int_equal(curve_through(&curve, &arena, ZT_CURVE_SMOOTH, ZT_VALUE_NUMBER, 3,
                                       sound, unsound[i]),
                         ZT_EARGUMENT);
    assert_int_equal(
        curve_through(&curve, &arena, ZT_CURVE_HOLD, ZT_VALUE_NUMBER, 0, sound, sound),
        ZT_EARGUMENT);
    zt_arena_free(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),       cmocka_unit_test(kinds_of_values),
        cmocka_unit_test(exact_at_keys),      cmocka_unit_test(never_leaves_its_keys),
        cmocka_unit_test(smooth_is_steffens), cmocka_unit_test(no_corners),
        cmocka_unit_test(frame_times),        cmocka_unit_test(order_does_not_matter),
        cmocka_unit_test(unsound_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
