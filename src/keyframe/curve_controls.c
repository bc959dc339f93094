/* The ways between keys: where the inner control points of curved ones are. */
#include <math.h>
#include <string.h>

#include "base/diag.h"
#include "keyframe/curve_inside.h"
#include "keyframe/speeds.h"

/* ---- speeds at keys ------------------------------------------------------------------------
 */

/* Whether the way before the first key is the last one, and the other way round. */
static bool is_closed(const zt_curve *curve) {
    const double *first = curve->points;
    const double *last = first + (int64_t)(curve->key_count - 1) * curve->point_width;
    if (curve->before == ZT_END_LOOP_WITH_OFFSET || curve->after == ZT_END_LOOP_WITH_OFFSET)
        return true;
    if (curve->before != ZT_END_LOOP && curve->after != ZT_END_LOOP) return false;
    if (zt_curve_is_on_sphere(curve))
        return zt_rotation_angle(zt_curve_quat(first), zt_curve_quat(last)) < 1e-12;
    for (int32_t c = 0; c < curve->point_width; c++)
        if (first[c] != last[c]) return false;
    return true;
}

/* One way as a step: half of it, which cannot overflow. False where it is none to go on from:
 * past an end, or a held value. */
static bool step_of(double *step, double *half_s, const zt_curve *curve, int32_t way) {
    int32_t count = curve->key_count - 1;
    if ((way < 0 || way >= count) && !is_closed(curve)) return false;
    way = (way + count) % count;
    if (curve->kinds[way] == ZT_CURVE_HOLD) return false;
    const double *a = curve->points + (int64_t)way * curve->point_width;
    const double *b = a + curve->point_width;
    *half_s = curve->times[way + 1] / 2 - curve->times[way] / 2;
    if (zt_curve_is_on_sphere(curve)) {
        vec3 v = zt_rotation_log(quat_mul(quat_conjugate(zt_curve_quat(a)), zt_curve_quat(b)));
        memcpy(step, &v, sizeof v);
    } else
        for (int32_t c = 0; c < curve->point_width; c++) step[c] = b[c] / 2 - a[c] / 2;
    return true;
}

/* The speeds at key k for a way of this kind, in the unit of step_of. */
static zt_speeds speeds_at(const zt_curve *curve, const zt_key *keys, int32_t k,
                           zt_curve_kind kind) {
    const zt_key *key = &keys[k];
    bool on_sphere = zt_curve_is_on_sphere(curve);
    zt_steps steps = {.width = on_sphere ? 3 : curve->point_width};
    zt_speeds speeds = {0};
    bool before = step_of(steps.before, &steps.before_s, curve, k - 1);
    bool after = step_of(steps.after, &steps.after_s, curve, k);
    if (!before || !after) {
        /* Smooth curves are at rest at their ends, as what is outside; others, and those that
         * go on outside, take the one step for both. */
        bool goes_on = (k == 0 && curve->before == ZT_END_LINEAR) ||
                       (k == curve->key_count - 1 && curve->after == ZT_END_LINEAR);
        if ((kind == ZT_CURVE_SMOOTH || kind == ZT_CURVE_BEZIER) && !goes_on) return speeds;
        memcpy(before ? steps.after : steps.before, before ? steps.before : steps.after,
               sizeof steps.before);
        steps.before_s = steps.after_s = 1;
    }
    if (kind == ZT_CURVE_CATMULL_ROM)
        zt_speeds_catmull_rom(&speeds, &steps);
    else if (kind == ZT_CURVE_TCB)
        zt_speeds_tcb(&speeds, &steps, key->tension, key->continuity, key->bias);
    else if (on_sphere)
        zt_speeds_smooth_turns(&speeds, &steps);
    else
        zt_speeds_smooth(&speeds, &steps);
    return speeds;
}

/* ---- control points ------------------------------------------------------------------------
 */

/* A handle of a Bezier way at one of its ends. */
typedef struct handle {
    const double *value; /* NULL where it is as smooth's */
    double time;         /* its share of the way's time, 0..1 */
    double shortening;   /* of its value */
} handle;

static handle handle_at(const zt_curve *curve, const zt_key *key, int32_t way, bool leaving) {
    const double *value = leaving ? key->after : key->before;
    double half_s = curve->times[way + 1] / 2 - curve->times[way] / 2;
    double time = (leaving ? key->after_s : key->before_s) / 2 / half_s;
    if (!value && time == 0) time = 1.0 / 3;
    return (handle){value, fmin(time, 1), time > 1 ? 1 / time : 1};
}

static double between(double x, double a, double b) {
    return fmin(fmax(x, fmin(a, b)), fmax(a, b));
}

/* One inner control point of a way over channels: the one next to its key `k`. */
static void control_point(double *control, zt_curve *curve, const zt_key *keys, int32_t way,
                          bool leaving) {
    zt_curve_kind kind = (zt_curve_kind)curve->kinds[way];
    int32_t k = leaving ? way : way + 1, width = curve->point_width;
    const zt_key *key = &keys[k];
    const double *own = curve->points + (int64_t)k * width;
    const double *other = leaving ? own + width : own - width;
    double sign = leaving ? 1 : -1;
    if (kind == ZT_CURVE_HERMITE) {
        const double *tangent = leaving ? key->after : key->before;
        double third_s = curve->times[way + 1] / 3 - curve->times[way] / 3;
        /* Where the chain has turned a quaternion to its other sign, its tangents turn too. */
        if (zt_curve_is_on_sphere(curve) &&
            quat_dot(zt_curve_quat(own), zt_curve_quat(key->value)) < 0)
            sign = -sign;
        for (int32_t c = 0; c < width; c++)
            control[c] =
                zt_curve_clip(curve, own[c] + (tangent ? sign * tangent[c] * third_s : 0));
        return;
    }
    handle h = {NULL, 1.0 / 3, 1};
    if (kind == ZT_CURVE_BEZIER) h = handle_at(curve, key, way, leaving);
    if (h.value) {
        for (int32_t c = 0; c < width; c++)
            control[c] = zt_curve_clip(curve, own[c] + h.value[c] * h.shortening);
        return;
    }
    zt_speeds speeds = speeds_at(curve, keys, k, kind);
    const double *speed = leaving ? speeds.leave : speeds.arrive;
    for (int32_t c = 0; c < width; c++) {
        control[c] = zt_curve_clip(curve, own[c] + sign * 2 * speed[c] * h.time);
        if (kind == ZT_CURVE_SMOOTH || kind == ZT_CURVE_BEZIER)
            control[c] = between(control[c], own[c], other[c]);
    }
}

/* How far a rotation would turn in the time of its way at the speed that it leaves or arrives
 * with. */
static vec3 arc_speed(zt_curve *curve, const zt_key *keys, int32_t way, bool leaving) {
    zt_curve_kind kind = (zt_curve_kind)curve->kinds[way];
    int32_t k = leaving ? way : way + 1;
    handle h = {NULL, 1.0 / 3, 1};
    if (kind == ZT_CURVE_BEZIER) h = handle_at(curve, &keys[k], way, leaving);
    if (h.value) {
        double factor =
            (leaving ? 1.5 : -1.5) * h.shortening; /* three times half of the turn */
        return (vec3){zt_curve_clip(curve, factor * h.value[0]),
                      zt_curve_clip(curve, factor * h.value[1]),
                      zt_curve_clip(curve, factor * h.value[2])};
    }
    zt_speeds speeds = speeds_at(curve, keys, k, kind);
    const double *speed = leaving ? speeds.leave : speeds.arrive;
    double factor = 3 * h.time;
    return (vec3){zt_curve_clip(curve, factor * speed[0]),
                  zt_curve_clip(curve, factor * speed[1]),
                  zt_curve_clip(curve, factor * speed[2])};
}

static zt_status make_handle_times(zt_curve *curve, zt_arena *arena, const zt_key *keys) {
    size_t way_count = (size_t)curve->key_count - 1;
    double(*times)[2] = zt_arena_push_array(arena, sizeof *times, way_count);
    if (!times) return ZT_EMEMORY;
    for (int32_t way = 0; way < (int32_t)way_count; way++) {
        times[way][0] = handle_at(curve, &keys[way], way, true).time;
        times[way][1] = 1 - handle_at(curve, &keys[way + 1], way, false).time;
    }
    curve->handle_times = (const double(*)[2])times;
    return ZT_OK;
}

zt_status zt_curve_make_controls(zt_curve *curve, zt_arena *arena, const zt_key *keys) {
    enum { ARC_WIDTH = sizeof(zt_rotation_arc) / sizeof(double) };
    bool on_sphere = zt_curve_is_on_sphere(curve), any = false, any_bezier = false;
    int32_t way_count = curve->key_count - 1, width = curve->point_width;
    for (int32_t way = 0; way < way_count; way++) {
        any |= curve->kinds[way] > ZT_CURVE_LINEAR;
        any_bezier |= curve->kinds[way] == ZT_CURVE_BEZIER;
    }
    if (!any) return ZT_OK;
    if (any_bezier) ZT_TRY(make_handle_times(curve, arena, keys));
    curve->control_width = on_sphere ? ARC_WIDTH : 2 * width;
    double *controls = ZT_PUSH(arena, double, (size_t)way_count *(size_t)curve->control_width);
    if (!controls) return ZT_EMEMORY;
    for (int32_t way = 0; way < way_count; way++) {
        double *own = controls + (int64_t)way * curve->control_width;
        if (curve->kinds[way] <= ZT_CURVE_LINEAR) continue;
        if (!on_sphere || curve->kinds[way] == ZT_CURVE_HERMITE) {
            control_point(own, curve, keys, way, true);
            control_point(own + width, curve, keys, way, false);
            continue;
        }
        const double *a = curve->points + (int64_t)way * width;
        vec3 leave = arc_speed(curve, keys, way, true);
        vec3 arrive = arc_speed(curve, keys, way, false);
        zt_rotation_arc arc =
            zt_rotation_arc_make(zt_curve_quat(a), zt_curve_quat(a + width), leave, arrive);
        memcpy(own, &arc, sizeof arc);
    }
    curve->controls = controls;
    return ZT_OK;
}
