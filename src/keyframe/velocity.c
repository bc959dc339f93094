#include "keyframe/velocity.h"

#include <math.h>
#include <string.h>

#include "keyframe/curve_inside.h"

/* Numbers of a velocity. */
static int32_t velocity_width(const zt_curve *curve) {
    return curve->value_kind == ZT_VALUE_ROTATION ? 3 : curve->width;
}

static bool stands_still(double *velocity, const zt_curve *curve) {
    memset(velocity, 0, (size_t)velocity_width(curve) * sizeof *velocity);
    return true;
}

static bool all_finite(const double *numbers, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        if (!isfinite(numbers[i])) return false;
    return true;
}

/* A turn in the frame of `q`, as one around the fixed axes. */
static void write_turn(double *velocity, quat q, vec3 turn) {
    quat v = {0, turn.x, turn.y, turn.z};
    v = quat_mul(q, quat_mul(v, quat_conjugate(q)));
    memcpy(velocity, (double[3]){v.x, v.y, v.z}, 3 * sizeof *velocity);
}

static bool spring_velocity(double *velocity, const zt_curve *curve,
                            const zt_curve_spot *spot) {
    if (curve->value_kind == ZT_VALUE_ROTATION) return false;
    int32_t width = curve->point_width;
    const double *x = curve->motions + (int64_t)spot->key * 2 * width, *w = x + width;
    zt_spring_step step =
        zt_spring_between(curve->spring, curve->times[spot->key], spot->time_s);
    double numbers[ZT_VALUE_WIDTH_MAX];
    for (int32_t c = 0; c < width; c++)
        numbers[c] = curve->spring->frequency * (step.w_x * x[c] + step.w_w * w[c]);
    if (!all_finite(numbers, width)) return false;
    memcpy(velocity, numbers, (size_t)width * sizeof *velocity);
    return true;
}

/* On beyond an end, and at it. */
static bool end_velocity(double *velocity, const zt_curve *curve, bool at_last) {
    const double *speed = curve->end_speeds + (at_last ? curve->point_width : 0);
    if (!zt_curve_is_on_sphere(curve)) {
        memcpy(velocity, speed, (size_t)curve->width * sizeof *velocity);
        return true;
    }
    const double *key = curve->points + (at_last ? 4 * (int64_t)(curve->key_count - 1) : 0);
    write_turn(velocity, zt_curve_quat(key), (vec3){2 * speed[0], 2 * speed[1], 2 * speed[2]});
    return true;
}

static double cubic_slope(double a, double first, double second, double b, double s) {
    double t = 1 - s;
    return 3 * (t * t * (first - a) + 2 * s * t * (second - first) + s * s * (b - second));
}

static bool way_velocity(double *velocity, const zt_curve *curve, const zt_curve_spot *spot) {
    int32_t way = spot->key, width = curve->point_width;
    zt_curve_kind kind = (zt_curve_kind)curve->kinds[way];
    const double *a = curve->points + (int64_t)way * width, *b = a + width;
    double per_s = 1 / (curve->times[way + 1] - curve->times[way]);
    if (kind == ZT_CURVE_HOLD) return stands_still(velocity, curve);
    if (curve->eases && curve->eases[way]) return false;
    if (zt_curve_is_on_sphere(curve)) {
        if (kind != ZT_CURVE_LINEAR) return false;
        quat from = zt_curve_quat(a);
        vec3 half = zt_rotation_log(quat_mul(quat_conjugate(from), zt_curve_quat(b)));
        write_turn(velocity, from, vec3_scale(half, 2 * per_s));
        return true;
    }
    double numbers[ZT_VALUE_WIDTH_MAX];
    if (kind == ZT_CURVE_BEZIER) {
        const double *time = curve->handle_times[way];
        per_s /= cubic_slope(0, time[0], time[1], 1, spot->s);
    }
    const double *controls =
        kind == ZT_CURVE_LINEAR ? NULL : curve->controls + (int64_t)way * curve->control_width;
    for (int32_t c = 0; c < width; c++)
        numbers[c] = per_s * (controls ? cubic_slope(a[c], controls[c], controls[width + c],
                                                     b[c], spot->s)
                                       : b[c] - a[c]);
    if (!all_finite(numbers, width)) return false;
    memcpy(velocity, numbers, (size_t)width * sizeof *velocity);
    return true;
}

bool zt_curve_velocity(double *velocity, const zt_curve *curve, double time_s) {
    int32_t last = curve->key_count - 1;
    if (last == 0) return stands_still(velocity, curve);
    if (time_s < curve->times[0] && curve->before == ZT_END_HOLD)
        return stands_still(velocity, curve);
    if (curve->space != ZT_SPACE_VALUES) return false;
    zt_curve_spot spot = zt_curve_find(curve, time_s);
    bool backwards = (spot.round < 0 ? curve->before : curve->after) == ZT_END_PING_PONG &&
                     fmod(spot.round, 2) != 0;
    bool offset = spot.round != 0 && curve->value_kind == ZT_VALUE_ROTATION;
    if (backwards || offset) return false;
    if (curve->spring) return spring_velocity(velocity, curve, &spot);
    if (spot.beyond_s < 0) return end_velocity(velocity, curve, false);
    if (spot.key == last)
        return curve->after == ZT_END_LINEAR ? end_velocity(velocity, curve, true)
                                             : stands_still(velocity, curve);
    return way_velocity(velocity, curve, &spot);
}
