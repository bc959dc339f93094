#include "keyframe/rotation.h"

#include <float.h>

/* Steps whose keys' quaternions are this near to perpendicular are half turns, but for the
 * rounding of their angles. */
static const double half_turn_tolerance = 1e-12;

quat zt_rotation_unit(quat q) {
    double n2 = quat_dot(q, q);
    if (fabs(n2 - 1) <= 8 * DBL_EPSILON) return q;
    double m = fmax(fmax(fabs(q.w), fabs(q.x)), fmax(fabs(q.y), fabs(q.z)));
    if (!(m > 0)) return quat_identity();
    return quat_normalize((quat){q.w / m, q.x / m, q.y / m, q.z / m});
}

void zt_rotation_align(quat *keys, int32_t count) {
    double sign = 1;
    quat before = quat_identity();
    for (int32_t k = 0; k < count; k++) {
        quat given = zt_rotation_unit(keys[k]);
        if (k > 0 && quat_dot(before, given) < -half_turn_tolerance) sign = -sign;
        keys[k] = quat_scale(given, sign);
        before = given;
    }
}

/* q less its part along the direction of d. */
static quat across(quat q, quat d) {
    return quat_add(q, quat_scale(d, -quat_dot(q, d) / quat_dot(d, d)));
}

quat zt_rotation_slerp(quat a, quat b, double u) {
    quat sum = quat_add(a, b), difference = quat_add(b, quat_scale(a, -1));
    double s = sqrt(quat_dot(sum, sum)), d = sqrt(quat_dot(difference, difference));
    if (!(s > 0) || !(d > 0)) return a;
    /* Sum and difference are perpendicular but for the rounding in the lengths of a and b,
     * which the shorter of them magnifies. */
    if (s < d)
        sum = across(sum, difference);
    else
        difference = across(difference, sum);
    double angle =
        (2 * u - 1) * atan2(d, s); /* from the middle, half of the separation each way */
    return zt_rotation_unit(quat_add(quat_scale(quat_normalize(sum), cos(angle)),
                                     quat_scale(quat_normalize(difference), sin(angle))));
}

/* The turn whose exponential is the unit quaternion q: at most half a round of the sphere. */
static vec3 logarithm(quat q) {
    vec3 v = {q.x, q.y, q.z};
    double sine = vec3_length(v);
    return sine > 0 ? vec3_scale(v, atan2(sine, q.w) / sine) : (vec3){0, 0, 0};
}

static quat exponential(vec3 v) {
    double angle = vec3_length(v);
    double sinc = angle > 0 ? sin(angle) / angle : 1;
    return (quat){cos(angle), v.x * sinc, v.y * sinc, v.z * sinc};
}

/* How far the key between two steps turns during the time of the step `after`, where `relation`
 * is that time over the time of the step `before`. Both steps, and the result, are turns in the
 * key's own frame. */
static vec3 tangent(vec3 before, vec3 after, double relation) {
    double b = vec3_length(before) * relation, a = vec3_length(after);
    if (!(a > 0) || !(b > 0)) return (vec3){0, 0, 0};
    double weight = relation / (1 + relation);
    vec3 mean = vec3_add(vec3_scale(before, relation * weight), vec3_scale(after, 1 - weight));
    double cosine = vec3_dot(vec3_normalize(before), vec3_normalize(after));
    /* Turning on in one direction keeps its speed, turning back comes to rest. */
    double speed = fmin(vec3_length(mean), 2 * fmin(a, b)) * (1 + cosine) / 2;
    return vec3_scale(vec3_normalize(mean), fmax(speed, 0));
}

void zt_rotation_smooth(zt_rotation_arc *arcs, const quat *keys, const double *times,
                        int32_t count) {
    /* First each arc holds in [1] its whole step, and in [0] and [2] thirds of the tangents. */
    for (int32_t k = 0; k + 1 < count; k++)
        arcs[k] = (zt_rotation_arc){
            .turns[1] = logarithm(quat_mul(quat_conjugate(keys[k]), keys[k + 1]))};
    for (int32_t k = 1; k + 1 < count; k++) {
        vec3 before = arcs[k - 1].turns[1], after = arcs[k].turns[1];
        /* Limited, so that no product overflows where one step is instantaneous beside the
         * other. */
        double relation = (times[k + 1] / 2 - times[k] / 2) / (times[k] / 2 - times[k - 1] / 2);
        relation = fmin(fmax(relation, 1e-100), 1e100);
        arcs[k - 1].turns[2] = vec3_scale(tangent(after, before, 1 / relation), 1.0 / 3);
        arcs[k].turns[0] = vec3_scale(tangent(before, after, relation), 1.0 / 3);
    }
    for (int32_t k = 0; k + 1 < count; k++) {
        quat step = quat_mul(quat_conjugate(keys[k]), keys[k + 1]);
        quat begin = exponential(vec3_scale(arcs[k].turns[0], -1));
        quat end = exponential(vec3_scale(arcs[k].turns[2], -1));
        arcs[k].turns[1] = logarithm(quat_mul(quat_mul(begin, step), end));
    }
}

quat zt_rotation_arc_eval(const zt_rotation_arc *arc, quat a, double u) {
    /* The Bernstein polynomials of degree 3, summed up from the last one. */
    double v = 1 - u, b3 = u * u * u, b2 = b3 + 3 * u * u * v, b1 = b2 + 3 * u * v * v;
    quat q = quat_mul(a, exponential(vec3_scale(arc->turns[0], b1)));
    q = quat_mul(q, exponential(vec3_scale(arc->turns[1], b2)));
    return zt_rotation_unit(quat_mul(q, exponential(vec3_scale(arc->turns[2], b3))));
}
