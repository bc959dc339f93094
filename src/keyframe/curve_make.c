/* Making curves: what can be worked out once is worked out here. */
#include <math.h>
#include <string.h>

#include "base/diag.h"
#include "keyframe/curve_inside.h"
#include "keyframe/oklab.h"

/* ---- checks --------------------------------------------------------------------------------
 */

static bool all_finite(const double *numbers, int32_t count) {
    for (int32_t i = 0; numbers && i < count; i++)
        if (!isfinite(numbers[i])) return false;
    return true;
}

/* A handle of a way of this kind; others are not read. */
static bool handle_is_sound(const zt_curve *curve, const double *value, double time_s,
                            zt_curve_kind kind) {
    if (kind != ZT_CURVE_BEZIER && kind != ZT_CURVE_HERMITE) return true;
    bool is_turn = zt_curve_is_on_sphere(curve) && kind == ZT_CURVE_BEZIER;
    return all_finite(value, is_turn ? 3 : curve->point_width) && time_s >= 0 &&
           isfinite(time_s);
}

static bool is_sound(const zt_curve *curve, const zt_curve_spec *spec) {
    if (spec->key_count < 1) return false;
    if (spec->space == ZT_SPACE_OKLAB && spec->value_kind != ZT_VALUE_COLOR) return false;
    if (spec->space == ZT_SPACE_TURNS && spec->value_kind != ZT_VALUE_ROTATION) return false;
    for (int32_t k = 0; k < spec->key_count; k++) {
        const zt_key *key = &spec->keys[k];
        zt_curve_kind arriving = k > 0 ? key[-1].kind : ZT_CURVE_HOLD;
        const double shape[] = {key->tension, key->continuity, key->bias};
        if (!isfinite(key->time_s) || (k > 0 && !(key->time_s > key[-1].time_s))) return false;
        if (!key->value || !all_finite(key->value, curve->point_width)) return false;
        if (!handle_is_sound(curve, key->before, key->before_s, arriving)) return false;
        if (!handle_is_sound(curve, key->after, key->after_s, key->kind)) return false;
        if (!all_finite(shape, 3)) return false;
    }
    return true;
}

/* ---- keys ----------------------------------------------------------------------------------
 */

/* A key's value as it is given out, and as a point of the curve's space. */
static void convert(double *value, double *point, const zt_curve *curve, const double *given) {
    if (curve->space == ZT_SPACE_TURNS) {
        quat q = zt_rotation_of_turn((vec3){given[0], given[1], given[2]});
        memcpy(value, &q, sizeof q);
        memcpy(point, given, 3 * sizeof *point);
        return;
    }
    memcpy(value, given, (size_t)curve->width * sizeof *value);
    if (zt_curve_is_on_sphere(curve)) {
        quat q = zt_rotation_unit(zt_curve_quat(given));
        memcpy(value, &q, sizeof q);
    }
    if (curve->space == ZT_SPACE_OKLAB) {
        vec3 lab = zt_oklab_from_light((vec3){given[0], given[1], given[2]});
        memcpy(point, &lab, sizeof lab);
    }
}

static void align(double *quats, const zt_curve_spec *spec) {
    double sign = 1;
    quat before = zt_curve_quat(quats);
    for (int32_t k = 1; k < spec->key_count; k++) {
        quat given = zt_curve_quat(quats + 4 * (int64_t)k);
        if (spec->keys[k - 1].kind != ZT_CURVE_HERMITE)
            sign *= zt_rotation_short_way(before, given);
        before = given;
        given = quat_scale(given, sign);
        memcpy(quats + 4 * (int64_t)k, &given, sizeof given);
    }
}

static zt_status copy_keys(zt_curve *curve, zt_arena *arena, const zt_curve_spec *spec) {
    size_t count = (size_t)curve->key_count;
    double *times = ZT_PUSH(arena, double, count);
    double *values = ZT_PUSH(arena, double, count *(size_t)curve->width);
    double *points = values;
    if (curve->space != ZT_SPACE_VALUES)
        points = ZT_PUSH(arena, double, count *(size_t)curve->point_width);
    if (!times || !values || !points) return ZT_EMEMORY;
    for (size_t k = 0; k < count; k++) {
        times[k] = spec->keys[k].time_s;
        convert(values + k * (size_t)curve->width, points + k * (size_t)curve->point_width,
                curve, spec->keys[k].value);
    }
    if (zt_curve_is_on_sphere(curve)) align(values, spec);
    curve->times = times;
    if (count > 1) curve->keys_per_s = (double)(count - 1) / (times[count - 1] - times[0]);
    curve->values = values;
    curve->points = points;
    return ZT_OK;
}

/* Switches and springs have no ways of their own. */
static zt_status copy_kinds(zt_curve *curve, zt_arena *arena, const zt_key *keys, bool hold) {
    size_t count = (size_t)curve->key_count;
    uint8_t *kinds = ZT_PUSH(arena, uint8_t, count);
    const zt_ease **eases = NULL;
    if (!kinds) return ZT_EMEMORY;
    for (size_t k = 0; k + 1 < count; k++) {
        const zt_key *key = &keys[k];
        kinds[k] = (uint8_t)(hold ? ZT_CURVE_HOLD : key->kind);
        if (hold || !key->ease) continue;
        if (!eases && !(eases = ZT_PUSH(arena, const zt_ease *, count))) return ZT_EMEMORY;
        eases[k] = key->ease;
    }
    curve->kinds = kinds;
    curve->eases = eases;
    return ZT_OK;
}

/* ---- ends and springs ----------------------------------------------------------------------
 */

/* What the parameter of a way gains in a second at its begin or end. */
static double parameter_speed(const zt_curve *curve, int32_t way, bool at_last) {
    double per_s = 1 / (curve->times[way + 1] - curve->times[way]);
    if (curve->kinds[way] == ZT_CURVE_BEZIER) {
        const double *time = curve->handle_times[way];
        double handle = at_last ? 1 - time[1] : time[0];
        return handle > 0 ? per_s / (3 * handle) : 0;
    }
    const zt_ease *ease = curve->eases ? curve->eases[way] : NULL;
    if (!ease) return per_s;
    /* Beyond its ends an easing goes straight on. */
    return per_s * (at_last ? zt_ease_eval(ease, 2) - zt_ease_eval(ease, 1)
                            : zt_ease_eval(ease, 0) - zt_ease_eval(ease, -1));
}

/* The first or the last leg of a way's control polygon, times their number: the derivative
 * there by the way's parameter. Of rotations, as a half turn in the frame of the key. */
static void end_leg(double *leg, const zt_curve *curve, int32_t way, bool at_last) {
    zt_curve_kind kind = (zt_curve_kind)curve->kinds[way];
    int32_t width = curve->point_width;
    const double *a = curve->points + (int64_t)way * width, *b = a + width;
    const double *from = a, *to = b, *controls = NULL;
    if (kind == ZT_CURVE_HOLD) return;
    if (kind > ZT_CURVE_LINEAR) {
        controls = curve->controls + (int64_t)way * curve->control_width;
        if (at_last)
            from = controls + width;
        else
            to = controls;
    }
    if (!zt_curve_is_on_sphere(curve)) {
        /* Ways of these kinds have controls, which the analyzer cannot know. */
        for (int32_t c = 0; c < width; c++)
            leg[c] = (controls ? 3 : 1) * (to[c] - from[c]); /* NOLINT(*NullDereference) */
        return;
    }
    vec3 v;
    quat key_inverse = quat_conjugate(zt_curve_quat(at_last ? b : a));
    if (kind == ZT_CURVE_LINEAR)
        v = zt_rotation_log(quat_mul(quat_conjugate(zt_curve_quat(a)), zt_curve_quat(b)));
    else if (kind == ZT_CURVE_HERMITE) {
        quat q = quat_add(zt_curve_quat(to), quat_scale(zt_curve_quat(from), -1));
        q = quat_mul(key_inverse, quat_scale(q, 3));
        v = (vec3){q.x, q.y, q.z};
    } else
        v = vec3_scale(((const zt_rotation_arc *)controls)->half_turns[at_last ? 2 : 0], 3);
    memcpy(leg, &v, sizeof v);
}

static zt_status make_end_speeds(zt_curve *curve, zt_arena *arena) {
    bool goes_on = curve->before == ZT_END_LINEAR || curve->after == ZT_END_LINEAR;
    int32_t width = curve->point_width;
    if (!goes_on || curve->key_count == 1) return ZT_OK;
    double *speeds = ZT_PUSH(arena, double, 2 * (size_t)width);
    if (!speeds) return ZT_EMEMORY;
    for (int end = 0; end < 2; end++) {
        int32_t way = end ? curve->key_count - 2 : 0;
        double *speed = speeds + end * width, per_s = parameter_speed(curve, way, end);
        end_leg(speed, curve, way, end);
        for (int32_t c = 0; c < width; c++) speed[c] = zt_curve_clip(curve, speed[c] * per_s);
    }
    curve->end_speeds = speeds;
    return ZT_OK;
}

static zt_status make_spring(zt_curve *curve, zt_arena *arena, const zt_spring *given) {
    size_t width = (size_t)zt_curve_motion_width(curve);
    zt_spring *spring = ZT_PUSH(arena, zt_spring, 1);
    double *motions = ZT_PUSH(arena, double, width *(size_t)curve->key_count);
    if (!spring || !motions) return ZT_EMEMORY;
    *spring = *given;
    curve->spring = spring;
    zt_curve_spring_motions(motions, curve);
    curve->motions = motions;
    return ZT_OK;
}

zt_status zt_curve_from_keys(zt_curve *curve, zt_arena *arena, const zt_curve_spec *spec) {
    bool is_switch = spec->value_kind == ZT_VALUE_SWITCH;
    bool springs = spec->spring && !is_switch;
    int32_t width = zt_value_width(spec->value_kind);
    *curve = (zt_curve){.value_kind = spec->value_kind,
                        .space = spec->space,
                        .before = spec->before,
                        .after = spec->after,
                        .key_count = spec->key_count,
                        .width = width,
                        .point_width = spec->space == ZT_SPACE_VALUES ? width : 3};
    if (!is_sound(curve, spec)) return ZT_EARGUMENT;
    /* A spring comes to rest by itself. */
    if (springs && curve->before == ZT_END_LINEAR) curve->before = ZT_END_HOLD;
    if (springs && curve->after == ZT_END_LINEAR) curve->after = ZT_END_HOLD;
    ZT_TRY(copy_keys(curve, arena, spec));
    ZT_TRY(copy_kinds(curve, arena, spec->keys, is_switch || springs));
    if (springs) return make_spring(curve, arena, spec->spring);
    ZT_TRY(zt_curve_make_controls(curve, arena, spec->keys));
    return make_end_speeds(curve, arena);
}
