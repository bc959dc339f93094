/* Channels are interpolated as fractions of the way from one key's value to the next one's, so
 * that no slope in units a second, which could overflow, is ever formed. */
#include "keyframe/curve.h"

#include <math.h>
#include <string.h>

#include "base/diag.h"
#include "keyframe/rotation.h"

enum { ARC_SIZE = sizeof(zt_rotation_arc) / sizeof(double) };

const char *zt_curve_name(zt_curve_kind kind) {
    static const char *const names[ZT_CURVE_COUNT] = {"hold", "linear", "smooth"};
    return names[kind];
}

/* The speed at a key, as a multiple of the mean speed of the step on one of its
 * sides: M. Steffen, "A simple method for monotonic interpolation in one dimension", 1990, with
 * slopes divided by that mean speed. `relation` is the mean speed of the other step in the same
 * measure, `weight` this step's share of the time of both. The result is in 0..2. */
static double speed_factor(double relation, double weight) {
    if (!(relation > 0)) return 0;
    double parabola = relation * weight + (1 - weight);
    return 2 * fmin(fmin(1, relation), parabola / 2);
}

/* Two factors of the mean speed for each step and channel: at its begin and at its end. Both
 * ends of the curve are at rest, as they are outside. */
static void smooth_channels(double *slopes, const zt_curve *curve) {
    int32_t width = curve->width;
    for (int32_t k = 1; k + 1 < curve->key_count; k++) {
        double before_s = curve->times[k] / 2 - curve->times[k - 1] / 2;
        double after_s = curve->times[k + 1] / 2 - curve->times[k] / 2;
        double weight = after_s / (before_s + after_s);
        const double *value = curve->values + (int64_t)k * width;
        double *slope = slopes + (int64_t)k * 2 * width;
        for (int32_t c = 0; c < width; c++) {
            double before = value[c] / 2 - value[c - width] / 2;
            double after = value[c + width] / 2 - value[c] / 2;
            double relation = (before / after) * (after_s / before_s);
            slope[2 * (c - width) + 1] = speed_factor(1 / relation, 1 - weight);
            slope[2 * c] = speed_factor(relation, weight);
        }
    }
}

static bool keys_are_sound(int32_t key_count, int32_t width, const double *times,
                           const double *values) {
    for (int32_t k = 0; k < key_count; k++) {
        if (!isfinite(times[k]) || (k > 0 && !(times[k] > times[k - 1]))) return false;
        for (int32_t c = 0; c < width; c++)
            if (!isfinite(values[(int64_t)k * width + c])) return false;
    }
    return true;
}

static zt_status prepare_smooth(zt_curve *curve, zt_arena *arena) {
    size_t segment_count = (size_t)(curve->key_count - 1);
    bool rotation = curve->value_kind == ZT_VALUE_ROTATION;
    size_t size = rotation ? ARC_SIZE : 2 * (size_t)curve->width;
    double *slopes = ZT_PUSH(arena, double, segment_count *size);
    if (!slopes) return ZT_EMEMORY;
    if (rotation)
        zt_rotation_smooth((zt_rotation_arc *)slopes, (const quat *)curve->values, curve->times,
                           curve->key_count);
    else
        smooth_channels(slopes, curve);
    curve->slopes = slopes;
    return ZT_OK;
}

zt_status zt_curve_make(zt_curve *curve, zt_arena *arena, zt_curve_kind kind,
                        zt_value_kind value_kind, int32_t key_count, const double *times,
                        const double *values) {
    int32_t width = zt_value_width(value_kind);
    if (key_count < 1 || !keys_are_sound(key_count, width, times, values)) return ZT_EARGUMENT;
    size_t count = (size_t)key_count, value_count = count * (size_t)width;
    double *own_times = ZT_PUSH(arena, double, count);
    double *own_values = ZT_PUSH(arena, double, value_count);
    if (!own_times || !own_values) return ZT_EMEMORY;
    memcpy(own_times, times, count * sizeof *times);
    memcpy(own_values, values, value_count * sizeof *values);
    if (value_kind == ZT_VALUE_ROTATION) zt_rotation_align((quat *)own_values, key_count);
    *curve = (zt_curve){.kind = value_kind == ZT_VALUE_SWITCH ? ZT_CURVE_HOLD : kind,
                        .value_kind = value_kind,
                        .width = width,
                        .key_count = key_count,
                        .times = own_times,
                        .values = own_values};
    return curve->kind == ZT_CURVE_SMOOTH ? prepare_smooth(curve, arena) : ZT_OK;
}

/* The last key at or before a time that is after the first key's. */
static int32_t key_before(const zt_curve *curve, double time_s) {
    int32_t low = 0, high = curve->key_count;
    while (high - low > 1) {
        int32_t middle = low + (high - low) / 2;
        if (curve->times[middle] <= time_s)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Where `time_s` is between two times: 0..1, since rounding keeps order. */
static double fraction(double time_s, double first, double last) {
    double u = (time_s - first) / (last - first);
    return isfinite(last - first) ? u : (time_s / 2 - first / 2) / (last / 2 - first / 2);
}

/* From a to b, never beyond either. */
static double mix(double a, double b, double u) {
    double value = a + u * (b - a);
    if (!isfinite(b - a)) value = 2 * (a / 2 + u * (b / 2 - a / 2));
    return fmin(fmax(value, fmin(a, b)), fmax(a, b));
}

/* The monotone cubic from 0 to 1 that begins and ends with these speeds, each in 0..2. */
static double ramp(double u, double begin, double end) {
    return u * (begin + u * (3 - 2 * begin - end + u * (begin + end - 2)));
}

static void eval_rotation(double *value, const zt_curve *curve, int32_t segment, double u) {
    const quat *keys = (const quat *)curve->values + segment;
    quat q = curve->kind == ZT_CURVE_LINEAR
                 ? zt_rotation_slerp(keys[0], keys[1], u)
                 : zt_rotation_arc_eval((const zt_rotation_arc *)curve->slopes + segment,
                                        keys[0], u);
    memcpy(value, &q, sizeof q);
}

void zt_curve_eval(double *value, const zt_curve *curve, double time_s) {
    int32_t width = curve->width;
    int32_t k = time_s > curve->times[0] ? key_before(curve, time_s) : 0;
    const double *a = curve->values + (int64_t)k * width, *b = a + width;
    if (curve->kind == ZT_CURVE_HOLD || k + 1 == curve->key_count ||
        !(time_s > curve->times[k])) {
        memcpy(value, a, (size_t)width * sizeof *value);
        return;
    }
    double u = fraction(time_s, curve->times[k], curve->times[k + 1]);
    if (curve->value_kind == ZT_VALUE_ROTATION) {
        eval_rotation(value, curve, k, u);
        return;
    }
    const double *slope = curve->slopes ? curve->slopes + (int64_t)k * 2 * width : NULL;
    for (int32_t c = 0; c < width; c++) {
        double way = slope ? ramp(u, slope[2 * c], slope[2 * c + 1]) : u;
        value[c] = mix(a[c], b[c], way);
    }
}
