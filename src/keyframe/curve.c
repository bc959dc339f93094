#include "keyframe/curve.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "keyframe/curve_inside.h"
#include "keyframe/oklab.h"

const char *zt_curve_name(zt_curve_kind kind) {
    static const char *const names[ZT_CURVE_KIND_COUNT] = {
        "hold", "linear", "smooth", "catmull-rom", "bezier", "hermite", "tcb"};
    return names[kind];
}

const char *zt_curve_end_name(zt_curve_end end) {
    static const char *const names[ZT_END_COUNT] = {"hold", "linear", "loop", "ping-pong",
                                                    "loop-with-offset"};
    return names[end];
}

const char *zt_curve_label(const zt_curve *curve) {
    if (curve->spring) return "spring";
    if (curve->key_count == 1) return zt_curve_name(ZT_CURVE_HOLD);
    for (int32_t k = 1; k + 1 < curve->key_count; k++)
        if (curve->kinds[k] != curve->kinds[0] ||
            (curve->eases && curve->eases[k] != curve->eases[0]))
            return "mixed";
    if (curve->eases && curve->eases[0]) return "eased";
    return zt_curve_name((zt_curve_kind)curve->kinds[0]);
}

/* ---- where a time falls --------------------------------------------------------------------
 */

/* The last key at or before a time; 0 before the first. Looks where it would be if keys were
 * evenly spaced, then in strides that double, then by halving: near to constant for dense keys,
 * and never worse than logarithmic. */
static int32_t key_before(const zt_curve *curve, double time_s) {
    const double *times = curve->times;
    int32_t count = curve->key_count, low = 0, high = count, stride = 1;
    double guess = (time_s - times[0]) * curve->keys_per_s;
    int32_t at = !(guess > 0) ? 0 : guess < count - 1 ? (int32_t)guess : count - 1;
    if (times[at] <= time_s) {
        for (low = at; stride < count - low && times[low + stride] <= time_s; stride *= 2)
            low += stride;
        if (stride < count - low) high = low + stride;
    } else {
        for (high = at; high > stride && times[high - stride] > time_s; stride *= 2)
            high -= stride;
        if (stride < high) low = high - stride;
    }
    while (high - low > 1) {
        int32_t middle = low + (high - low) / 2;
        if (times[middle] <= time_s)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Takes a time back to where the keys are, in a loop. */
static void unroll(zt_curve_spot *spot, const zt_curve *curve, bool back_and_forth) {
    double first = curve->times[0], last = curve->times[curve->key_count - 1];
    double span = last - first, x = spot->time_s - first, rest = fmod(x, span);
    if (rest < 0) rest += span;
    spot->round = rint((x - rest) / span);
    /* A time that is on a key but for its own rounding shall be exactly there: held values and
     * jumps would be a frame late. */
    double tolerance =
        4 * DBL_EPSILON * fmax(fabs(spot->time_s), fmax(fabs(first), fabs(last)));
    if (rest + tolerance >= span) rest = 0, spot->round++;
    double time_s = back_and_forth && fmod(spot->round, 2) != 0 ? last - rest : first + rest;
    double key_s = curve->times[key_before(curve, time_s + tolerance)];
    spot->time_s = fabs(key_s - time_s) <= tolerance ? key_s : time_s;
}

static void leave_keys(zt_curve_spot *spot, const zt_curve *curve, zt_curve_end end,
                       double edge_s) {
    switch (end) {
    case ZT_END_LINEAR:
        spot->beyond_s = spot->time_s - edge_s;
        spot->time_s = edge_s;
        break;
    case ZT_END_LOOP:
    case ZT_END_LOOP_WITH_OFFSET:
    case ZT_END_PING_PONG:
        unroll(spot, curve, end == ZT_END_PING_PONG);
        break;
    case ZT_END_HOLD:
    case ZT_END_COUNT:
        break;
    }
}

/* Where `time_s` is between two times: 0..1, since rounding keeps order. */
static double fraction(double time_s, double first, double last) {
    if (!isfinite(last - first)) time_s /= 2, first /= 2, last /= 2;
    return (time_s - first) / (last - first);
}

static double way_parameter(const zt_curve *curve, int32_t way, double u) {
    if (curve->kinds[way] == ZT_CURVE_BEZIER)
        return zt_ease_bezier_parameter(curve->handle_times[way][0],
                                        curve->handle_times[way][1], u);
    if (!curve->eases || !curve->eases[way]) return u;
    double s = zt_ease_eval(curve->eases[way], u);
    return isfinite(s) ? s : u;
}

zt_curve_spot zt_curve_find(const zt_curve *curve, double time_s) {
    zt_curve_spot spot = {.time_s = time_s};
    int32_t last = curve->key_count - 1;
    double first_s = curve->times[0], last_s = curve->times[last];
    if (last > 0 && isfinite(time_s)) {
        if (time_s < first_s)
            leave_keys(&spot, curve, curve->before, first_s);
        else if (time_s > last_s || (time_s == last_s && curve->after == ZT_END_LOOP))
            leave_keys(&spot, curve, curve->after, last_s);
    }
    spot.key = key_before(curve, spot.time_s);
    double key_s = curve->times[spot.key];
    if (spot.key < last && spot.time_s > key_s) {
        spot.u = fraction(spot.time_s, key_s, curve->times[spot.key + 1]);
        spot.s = way_parameter(curve, spot.key, spot.u);
    }
    return spot;
}

/* ---- the value there -----------------------------------------------------------------------
 */

/* From a to b: never beyond either for u in 0..1, else straight on. */
static double along(double a, double b, double u) {
    double value = a + u * (b - a);
    if (!isfinite(value)) value = 2 * (a / 2 + u * (b / 2 - a / 2));
    double low = a < b ? a : b, high = a < b ? b : a;
    if (u < 0 || u > 1) low = -DBL_MAX, high = DBL_MAX;
    return value < low ? low : value > high ? high : value;
}

static double bernstein(double a, double first, double second, double b, double s) {
    double t = 1 - s;
    return a + s * (3 * t * (t * (first - a) + s * (second - a)) + s * s * (b - a));
}

/* A cubic Bezier curve: within its control points for s in 0..1. */
static double cubic(double a, double first, double second, double b, double s) {
    double value = bernstein(a, first, second, b, s);
    if (!isfinite(value)) value = 8 * bernstein(a / 8, first / 8, second / 8, b / 8, s);
    double low = a < b ? a : b, high = a < b ? b : a;
    double inner_low = first < second ? first : second;
    double inner_high = first < second ? second : first;
    low = inner_low < low ? inner_low : low;
    high = inner_high > high ? inner_high : high;
    if (s < 0 || s > 1) return value;
    return value < low ? low : value > high ? high : value;
}

static void eval_way(double *point, const zt_curve *curve, const zt_curve_spot *spot) {
    int32_t k = spot->key, width = curve->point_width;
    const double *a = curve->points + (int64_t)k * width, *b = a + width;
    double s = spot->s;
    zt_curve_kind kind = spot->u > 0 ? (zt_curve_kind)curve->kinds[k] : ZT_CURVE_HOLD;
    const double *controls =
        kind > ZT_CURVE_LINEAR ? curve->controls + (int64_t)k * curve->control_width : NULL;
    if (kind == ZT_CURVE_HOLD) {
        memcpy(point, a, (size_t)width * sizeof *point);
    } else if (zt_curve_is_on_sphere(curve) && kind != ZT_CURVE_HERMITE) {
        quat from = zt_curve_quat(a);
        quat q = kind == ZT_CURVE_LINEAR
                     ? zt_rotation_slerp(from, zt_curve_quat(b), s)
                     : zt_rotation_arc_eval((const zt_rotation_arc *)controls, from, s);
        memcpy(point, &q, sizeof q);
    } else if (kind == ZT_CURVE_LINEAR) {
        for (int32_t c = 0; c < width; c++) point[c] = along(a[c], b[c], s);
    } else {
        for (int32_t c = 0; c < width; c++)
            point[c] = cubic(a[c], controls[c], controls[width + c], b[c], s);
        if (zt_curve_is_on_sphere(curve)) {
            quat q = zt_rotation_unit(zt_curve_quat(point));
            memcpy(point, &q, sizeof q);
        }
    }
}

/* On from an end in a straight line, or turning on. */
static void go_on(double *point, const zt_curve *curve, double beyond_s) {
    const double *speed = curve->end_speeds + (beyond_s < 0 ? 0 : curve->point_width);
    if (zt_curve_is_on_sphere(curve)) {
        vec3 half_turn = {speed[0] * beyond_s, speed[1] * beyond_s, speed[2] * beyond_s};
        quat q = zt_rotation_unit(quat_mul(zt_curve_quat(point), zt_rotation_exp(half_turn)));
        memcpy(point, &q, sizeof q);
        return;
    }
    for (int32_t c = 0; c < curve->point_width; c++) point[c] += speed[c] * beyond_s;
}

/* Repeats the way from the first key to the last one as often as there were rounds. */
static void offset(double *point, const zt_curve *curve, double round) {
    const double *first = curve->points;
    const double *last = first + (int64_t)(curve->key_count - 1) * curve->point_width;
    if (zt_curve_is_on_sphere(curve)) {
        quat way = quat_mul(zt_curve_quat(last), quat_conjugate(zt_curve_quat(first)));
        quat rounds = zt_rotation_exp(vec3_scale(zt_rotation_log(way), round));
        quat q = zt_rotation_unit(quat_mul(rounds, zt_curve_quat(point)));
        memcpy(point, &q, sizeof q);
        return;
    }
    for (int32_t c = 0; c < curve->point_width; c++) point[c] += round * (last[c] - first[c]);
}

static void from_space(double *value, const zt_curve *curve, const double *point) {
    if (curve->space == ZT_SPACE_OKLAB) {
        vec3 light = zt_oklab_to_light((vec3){point[0], point[1], point[2]});
        memcpy(value, &light, sizeof light);
    } else if (curve->space == ZT_SPACE_TURNS) {
        quat q = zt_rotation_of_turn((vec3){point[0], point[1], point[2]});
        memcpy(value, &q, sizeof q);
    } else
        memcpy(value, point, (size_t)curve->width * sizeof *value);
    for (int32_t c = 0; c < curve->width; c++) value[c] = zt_curve_finite(value[c]);
}

void zt_curve_eval(double *value, const zt_curve *curve, double time_s) {
    zt_curve_spot spot = zt_curve_find(curve, time_s);
    bool offsets = spot.round != 0 &&
                   (spot.round < 0 ? curve->before : curve->after) == ZT_END_LOOP_WITH_OFFSET;
    if (!(spot.u > 0) && !curve->spring && spot.beyond_s == 0 && !offsets) {
        memcpy(value, curve->values + (int64_t)spot.key * curve->width,
               (size_t)curve->width * sizeof *value);
        return;
    }
    double point[ZT_VALUE_WIDTH_MAX] = {0}; /* wide enough for all spaces */
    if (curve->spring)
        zt_curve_spring_eval(point, curve, spot.key, spot.time_s);
    else
        eval_way(point, curve, &spot);
    if (spot.beyond_s != 0) go_on(point, curve, spot.beyond_s);
    if (offsets) offset(point, curve, spot.round);
    from_space(value, curve, point);
}
