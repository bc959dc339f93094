#include "keyframe/rotation.h"

#include <float.h>
#include <string.h>

static const vec3 still = {0, 0, 0};

/* ---- as they are written -------------------------------------------------------------------
 */

quat zt_rotation_unit(quat q) {
    double n2 = quat_dot(q, q);
    if (fabs(n2 - 1) <= 4 * DBL_EPSILON) return q;
    double m = fmax(fmax(fabs(q.w), fabs(q.x)), fmax(fabs(q.y), fabs(q.z)));
    if (!(m > 0)) return quat_identity();
    return quat_normalize((quat){q.w / m, q.x / m, q.y / m, q.z / m});
}

bool zt_rotation_order_is_sound(const char *order) {
    return strlen(order) == 3 && strchr(order, 'x') && strchr(order, 'y') && strchr(order, 'z');
}

quat zt_rotation_euler(vec3 angles, const char *order) {
    quat q = quat_identity();
    for (int i = 0; i < 3; i++) {
        vec3 turn = {order[i] == 'x' ? angles.x : 0, order[i] == 'y' ? angles.y : 0,
                     order[i] == 'z' ? angles.z : 0};
        q = quat_mul(zt_rotation_of_turn(turn), q);
    }
    return zt_rotation_unit(q);
}

quat zt_rotation_of_turn(vec3 turn) { return zt_rotation_exp(vec3_scale(turn, 0.5)); }

/* The unit quaternion that takes the axes to three perpendicular unit vectors, by its largest
 * component (S. W. Shepperd, "Quaternion from rotation matrix", 1978). */
static quat of_axes(vec3 x, vec3 y, vec3 z) {
    double w2 = 1 + x.x + y.y + z.z, x2 = 1 + x.x - y.y - z.z, y2 = 1 - x.x + y.y - z.z,
           z2 = 1 - x.x - y.y + z.z;
    quat q;
    if (w2 >= x2 && w2 >= y2 && w2 >= z2)
        q = (quat){w2, y.z - z.y, z.x - x.z, x.y - y.x};
    else if (x2 >= y2 && x2 >= z2)
        q = (quat){y.z - z.y, x2, x.y + y.x, z.x + x.z};
    else if (y2 >= z2)
        q = (quat){z.x - x.z, x.y + y.x, y2, y.z + z.y};
    else
        q = (quat){x.y - y.x, z.x + x.z, y.z + z.y, z2};
    return zt_rotation_unit(q);
}

quat zt_rotation_look(vec3 direction, vec3 up, double roll) {
    quat rolled = zt_rotation_of_turn((vec3){0, 0, roll});
    vec3 back = vec3_scale(vec3_normalize(direction), -1);
    if (vec3_max_abs(back) == 0) return rolled;
    vec3 right = vec3_cross(vec3_normalize(up), back);
    if (vec3_max_abs(right) < 1e-12) {
        double x = fabs(back.x), y = fabs(back.y), z = fabs(back.z);
        vec3 least = x <= y && x <= z ? (vec3){1, 0, 0}
                     : y <= z         ? (vec3){0, 1, 0}
                                      : (vec3){0, 0, 1};
        right = vec3_cross(least, back);
    }
    right = vec3_normalize(right);
    return zt_rotation_unit(quat_mul(of_axes(right, vec3_cross(back, right), back), rolled));
}

/* ---- between them --------------------------------------------------------------------------
 */

double zt_rotation_angle(quat a, quat b) {
    quat q = quat_mul(quat_conjugate(a), b);
    return 2 * atan2(vec3_length((vec3){q.x, q.y, q.z}), fabs(q.w));
}

double zt_rotation_short_way(quat a, quat b) {
    /* Half turns, but for the rounding of their angles. */
    const double tolerance = 1e-12;
    return quat_dot(a, b) < -tolerance ? -1 : 1;
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
        (2 * u - 1) * atan2(d, s); /* from the middle, half the separation each way */
    return zt_rotation_unit(quat_add(quat_scale(quat_normalize(sum), cos(angle)),
                                     quat_scale(quat_normalize(difference), sin(angle))));
}

vec3 zt_rotation_log(quat q) {
    vec3 v = {q.x, q.y, q.z};
    double sine = vec3_length(v);
    return sine > 0 ? vec3_scale(v, atan2(sine, q.w) / sine) : still;
}

quat zt_rotation_exp(vec3 half_turn) {
    double angle = vec3_length(half_turn);
    if (!(angle < HUGE_VAL)) return quat_identity(); /* nobody can tell which way it ends */
    double sinc = angle > 0 ? sin(angle) / angle : 1;
    return zt_rotation_unit(
        (quat){cos(angle), half_turn.x * sinc, half_turn.y * sinc, half_turn.z * sinc});
}

zt_rotation_arc zt_rotation_arc_make(quat a, quat b, vec3 leave, vec3 arrive) {
    vec3 first = vec3_scale(leave, 1.0 / 3), last = vec3_scale(arrive, 1.0 / 3);
    quat whole = quat_mul(quat_conjugate(a), b);
    quat begin = quat_conjugate(zt_rotation_exp(first));
    quat end = quat_conjugate(zt_rotation_exp(last));
    return (zt_rotation_arc){
        {first, zt_rotation_log(quat_mul(quat_mul(begin, whole), end)), last}};
}

quat zt_rotation_arc_eval(const zt_rotation_arc *arc, quat a, double u) {
    /* The Bernstein polynomials of degree 3, summed up from the last one. */
    double v = 1 - u, b3 = u * u * u, b2 = b3 + 3 * u * u * v, b1 = b2 + 3 * u * v * v;
    quat q = quat_mul(a, zt_rotation_exp(vec3_scale(arc->half_turns[0], b1)));
    q = quat_mul(q, zt_rotation_exp(vec3_scale(arc->half_turns[1], b2)));
    return zt_rotation_unit(quat_mul(q, zt_rotation_exp(vec3_scale(arc->half_turns[2], b3))));
}

/* v + f (turn x v) + g (turn x (turn x v)). */
static vec3 twisted(vec3 v, vec3 turn, double f, double g) {
    vec3 once = vec3_cross(turn, v), twice = vec3_cross(turn, once);
    return vec3_add(v, vec3_add(vec3_scale(once, f), vec3_scale(twice, g)));
}

vec3 zt_rotation_velocity(vec3 turn, vec3 turn_speed) {
    double a = vec3_length(turn), half = sin(a / 2);
    if (!(a > 0)) return turn_speed;
    /* The series, where a difference would cancel. */
    double g = a < 1e-2 ? 1.0 / 6 - a * a / 120 : (a - sin(a)) / (a * a * a);
    return twisted(turn_speed, turn, -2 * (half / a) * (half / a), g);
}

vec3 zt_rotation_turn_speed(vec3 turn, vec3 velocity) {
    double a = vec3_length(turn);
    double g = a < 1e-2 ? 1.0 / 12 + a * a / 720 : (1 / a - 0.5 / tan(a / 2)) / a;
    return twisted(velocity, turn, 0.5, g);
}
