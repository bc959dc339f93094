/* The shape of each way is a cubic Bezier curve. Its length is integrated by Gauss and
 * Legendre's rule from mark to mark; a distance is looked up among the marks, and between two
 * of them found by Newton's method. */
#include "keyframe/path.h"

#include <math.h>

#include "base/diag.h"

typedef struct shape {
    vec3 points[4];
} shape;

static vec3 vec3_of(const double *p) { return (vec3){p[0], p[1], p[2]}; }

static vec3 between(vec3 a, vec3 b, double u) {
    return vec3_add(vec3_scale(a, 1 - u), vec3_scale(b, u));
}

static shape shape_of(const zt_path *path, int32_t way) {
    const zt_curve *curve = path->curve;
    vec3 a = vec3_of(curve->points + 3 * (int64_t)way);
    vec3 b = vec3_of(curve->points + 3 * (int64_t)way + 3);
    if (curve->kinds[way] <= ZT_CURVE_LINEAR)
        return (shape){{a, between(a, b, 1.0 / 3), between(a, b, 2.0 / 3), b}};
    const double *controls = curve->controls + (int64_t)way * curve->control_width;
    return (shape){{a, vec3_of(controls), vec3_of(controls + 3), b}};
}

static vec3 position(const shape *s, double u) {
    vec3 p = between(s->points[0], s->points[1], u), q = between(s->points[1], s->points[2], u);
    vec3 r = between(s->points[2], s->points[3], u);
    return between(between(p, q, u), between(q, r, u), u);
}

static vec3 derivative(const shape *s, double u) {
    vec3 p = vec3_sub(s->points[1], s->points[0]), q = vec3_sub(s->points[2], s->points[1]);
    vec3 r = vec3_sub(s->points[3], s->points[2]);
    return vec3_scale(between(between(p, q, u), between(q, r, u), u), 3);
}

static double length_between(const shape *s, double from, double to) {
    static const double nodes[] = {0.18343464249564980, 0.52553240991632899,
                                   0.79666647741362674, 0.96028985649753623};
    static const double weights[] = {0.36268378337836198, 0.31370664587788729,
                                     0.22238103445337447, 0.10122853629037626};
    double middle = (from + to) / 2, half = (to - from) / 2, sum = 0;
    for (int i = 0; i < 4; i++)
        sum += weights[i] * (vec3_length(derivative(s, middle - half * nodes[i])) +
                             vec3_length(derivative(s, middle + half * nodes[i])));
    return half * sum;
}

/* The parameter between two marks at which a way has a length, measured from the first of them.
 */
static double parameter_at(const shape *s, double from, double to, double length) {
    enum { STEPS_MAX = 60 };
    double low = from, high = to, whole = length_between(s, from, to);
    if (!(whole > 0)) return from;
    double u = from + (to - from) * fmin(length / whole, 1);
    for (int i = 0; i < STEPS_MAX; i++) {
        double error = length_between(s, from, u) - length;
        if (error < 0)
            low = u;
        else
            high = u;
        double next = u - error / vec3_length(derivative(s, u));
        if (!(next >= low && next <= high)) next = low + (high - low) / 2;
        double step = fabs(next - u);
        u = next;
        if (step <= 1e-16) break;
    }
    return u;
}

/* The mark at or before a distance; of several at one distance the last, so that ways without
 * length are stepped over. */
static int64_t mark_before(const zt_path *path, double distance) {
    int64_t low = 0, high = (int64_t)path->way_count * ZT_PATH_MARKS;
    while (high - low > 1) {
        int64_t middle = low + (high - low) / 2;
        if (path->lengths[middle] <= distance)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Along the way at u; where it stands still, along what is next to it. */
static vec3 direction_at(const shape *s, double u) {
    vec3 along = derivative(s, u);
    double extent = vec3_max_abs(vec3_sub(s->points[3], s->points[0])) +
                    vec3_max_abs(vec3_sub(s->points[2], s->points[1]));
    if (vec3_max_abs(along) > 1e-9 * extent) return vec3_normalize(along);
    double ahead = fmin(u + 1e-3, 1), behind = fmax(u - 1e-3, 0);
    return vec3_normalize(vec3_sub(position(s, ahead), position(s, behind)));
}

/* Where on which way one is after a distance. */
static double find(shape *s, const zt_path *path, double distance) {
    if (path->closed && path->length > 0) {
        distance = fmod(distance, path->length);
        if (distance < 0) distance += path->length;
    }
    if (!(distance > 0)) distance = 0;
    int64_t mark = mark_before(path, distance);
    *s = shape_of(path, (int32_t)(mark / ZT_PATH_MARKS));
    double from = (double)(mark % ZT_PATH_MARKS) / ZT_PATH_MARKS;
    double to = from + 1.0 / ZT_PATH_MARKS;
    if (distance >= path->length) return to;
    return parameter_at(s, from, to, distance - path->lengths[mark]);
}

vec3 zt_path_point(const zt_path *path, double distance) {
    shape s;
    double u = find(&s, path, distance);
    return position(&s, u);
}

vec3 zt_path_direction(const zt_path *path, double distance) {
    shape s;
    double u = find(&s, path, distance);
    return direction_at(&s, u);
}

/* ---- bends ---------------------------------------------------------------------------------
 */

/* The directions some way behind and ahead: a quarter of a way, taken as they are on the
 * average. */
static void look_round(vec3 *behind, vec3 *ahead, const zt_path *path, double distance) {
    double reach = path->length / (4 * path->way_count);
    *behind = zt_path_direction(path, distance - reach);
    *ahead = zt_path_direction(path, distance + reach);
}

static double narrowest_bend(const zt_path *path) {
    double narrowest = 0;
    for (int64_t mark = 0; mark <= (int64_t)path->way_count * ZT_PATH_MARKS; mark++) {
        vec3 behind, ahead;
        look_round(&behind, &ahead, path, path->lengths[mark]);
        double angle = atan2(vec3_length(vec3_cross(behind, ahead)), vec3_dot(behind, ahead));
        narrowest = fmax(narrowest, angle);
    }
    return narrowest;
}

double zt_path_bend(const zt_path *path, double distance, vec3 up) {
    const double straight = 1e-6;
    if (!(path->narrowest > straight)) return 0;
    vec3 behind, ahead;
    look_round(&behind, &ahead, path, distance);
    up = vec3_normalize(up);
    double sine = vec3_dot(up, vec3_cross(behind, ahead));
    double cosine = vec3_dot(behind, ahead) - vec3_dot(behind, up) * vec3_dot(ahead, up);
    return fmin(fmax(atan2(sine, cosine) / path->narrowest, -1), 1);
}

/* ---- making --------------------------------------------------------------------------------
 */

zt_status zt_path_make(zt_path *path, zt_arena *arena, const zt_curve *curve) {
    if (curve->value_kind != ZT_VALUE_VECTOR || curve->key_count < 2 || curve->spring)
        return ZT_EARGUMENT;
    *path = (zt_path){.curve = curve, .way_count = curve->key_count - 1};
    size_t mark_count = (size_t)path->way_count * ZT_PATH_MARKS;
    double *lengths = ZT_PUSH(arena, double, mark_count + 1), length = 0;
    if (!lengths) return ZT_EMEMORY;
    for (int32_t way = 0; way < path->way_count; way++) {
        shape s = shape_of(path, way);
        for (int mark = 0; mark < ZT_PATH_MARKS; mark++) {
            lengths[(int64_t)way * ZT_PATH_MARKS + mark] = length;
            length += length_between(&s, (double)mark / ZT_PATH_MARKS,
                                     (double)(mark + 1) / ZT_PATH_MARKS);
        }
    }
    if (!isfinite(length)) return ZT_EARGUMENT;
    lengths[mark_count] = path->length = length;
    path->lengths = lengths;
    vec3 first = vec3_of(curve->points);
    vec3 last = vec3_of(curve->points + 3 * (int64_t)path->way_count);
    path->closed = vec3_max_abs(vec3_sub(first, last)) <= 1e-12 * length;
    path->narrowest = narrowest_bend(path);
    return ZT_OK;
}

zt_status zt_path_through(zt_path *path, zt_arena *arena, const vec3 *points,
                          int32_t point_count, bool closed) {
    if (point_count < 2) return ZT_EARGUMENT;
    int32_t key_count = point_count + closed;
    zt_curve *curve = ZT_PUSH(arena, zt_curve, 1);
    zt_key *keys = ZT_PUSH(arena, zt_key, (size_t)key_count);
    if (!curve || !keys) return ZT_EMEMORY;
    for (int32_t k = 0; k < key_count; k++)
        keys[k] = (zt_key){.time_s = k,
                           .value = (const double *)&points[k % point_count],
                           .kind = ZT_CURVE_CATMULL_ROM};
    zt_curve_spec spec = {.value_kind = ZT_VALUE_VECTOR,
                          .key_count = key_count,
                          .keys = keys,
                          .after = closed ? ZT_END_LOOP : ZT_END_HOLD};
    ZT_TRY(zt_curve_from_keys(curve, arena, &spec));
    return zt_path_make(path, arena, curve);
}
