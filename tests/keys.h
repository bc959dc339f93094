/* Short ways to make curves in tests. */
#ifndef ZT_TESTS_KEYS_H
#define ZT_TESTS_KEYS_H

#include <math.h>

#include "draw.h"
#include "keyframe/curve.h"

/* cmocka.h comes before this header. */
static inline zt_curve curve_of(zt_arena *arena, const zt_curve_spec *spec) {
    zt_curve curve;
    assert_int_equal(zt_curve_from_keys(&curve, arena, spec), ZT_OK);
    return curve;
}

static inline zt_key key(double time_s, const double *value, zt_curve_kind kind) {
    return (zt_key){.time_s = time_s, .value = value, .kind = kind};
}

/* A curve all of one kind through values that lie one after the other. */
static inline zt_status curve_through(zt_curve *curve, zt_arena *arena, zt_curve_kind kind,
                                      zt_value_kind value_kind, int count, const double *times,
                                      const double *values) {
    zt_key *keys = ZT_PUSH(arena, zt_key, (size_t)count);
    assert_non_null(keys);
    for (int k = 0; k < count; k++)
        keys[k] = key(times[k], values + k * zt_value_width(value_kind), kind);
    return zt_curve_from_keys(
        curve, arena,
        &(zt_curve_spec){.value_kind = value_kind, .key_count = count, .keys = keys});
}

static inline double eval1(const zt_curve *curve, double time_s) {
    double value[ZT_VALUE_WIDTH_MAX];
    zt_curve_eval(value, curve, time_s);
    return value[0];
}

static inline quat eval_quat(const zt_curve *curve, double time_s) {
    quat q;
    zt_curve_eval((double *)&q, curve, time_s);
    return q;
}

static inline vec3 eval_vec(const zt_curve *curve, double time_s) {
    vec3 v;
    zt_curve_eval((double *)&v, curve, time_s);
    return v;
}

static inline void assert_near(double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance)) fail_msg("%.17g is not %.17g", found, expected);
}

/* Rising times with spacings between the two. They begin at any magnitude, since the smallest
 * spacings exist near zero only. */
static inline void draw_times(draw *d, double *times, int count, double low, double high) {
    times[0] = draw_between(d, -1, 1) * draw_magnitude(d, low, high);
    for (int k = 1; k < count; k++) {
        times[k] = times[k - 1] + draw_magnitude(d, low, high);
        if (!(times[k] > times[k - 1])) times[k] = nextafter(times[k - 1], INFINITY);
    }
}

/* The angular velocity between two times, in the frame of the first. */
static inline vec3 turning(const zt_curve *curve, double from, double to) {
    quat q = quat_mul(quat_conjugate(eval_quat(curve, from)), eval_quat(curve, to));
    double scale = (q.w < 0 ? -2 : 2) / (to - from);
    return vec3_scale((vec3){q.x, q.y, q.z}, scale);
}

#endif
