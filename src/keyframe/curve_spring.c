/* A spring that carries a value from key to key. Its motion at each key is worked out once, so
 * that any moment is one step from the key before it. */
#include <string.h>

#include "keyframe/curve_inside.h"

/* Position from rest, and speed, of up to nine channels. */
typedef struct motion {
    double x[ZT_VALUE_WIDTH_MAX], w[ZT_VALUE_WIDTH_MAX];
} motion;

static motion motion_after(const zt_curve *curve, const double *motions, int32_t key,
                           double time_s) {
    int32_t width = zt_curve_motion_width(curve) / 2;
    const double *x = motions + (int64_t)key * 2 * width, *w = x + width;
    zt_spring_step step = zt_spring_between(curve->spring, curve->times[key], time_s);
    motion m = {0};
    for (int32_t c = 0; c < width; c++) {
        m.x[c] = zt_curve_finite(step.x_x * x[c] + step.x_w * w[c]);
        m.w[c] = zt_curve_finite(step.w_x * x[c] + step.w_w * w[c]);
    }
    return m;
}

static vec3 first_three(const double *x) { return (vec3){x[0], x[1], x[2]}; }

/* Seen from a new place to rest, the motion is the same; only its numbers change. */
static void change_rest(motion *m, const zt_curve *curve, int32_t key) {
    const double *next = curve->points + (int64_t)key * curve->point_width;
    const double *old = next - curve->point_width;
    if (!zt_curve_is_on_sphere(curve)) {
        for (int32_t c = 0; c < curve->point_width; c++)
            m->x[c] = zt_curve_finite(m->x[c] + (old[c] - next[c]));
        return;
    }
    vec3 turn = first_three(m->x), speed = first_three(m->w);
    quat q = quat_mul(zt_curve_quat(old), zt_rotation_of_turn(turn));
    quat from_rest = quat_mul(quat_conjugate(zt_curve_quat(next)), q);
    if (from_rest.w < 0) from_rest = quat_scale(from_rest, -1);
    vec3 new_turn = vec3_scale(zt_rotation_log(from_rest), 2);
    speed = zt_rotation_turn_speed(new_turn, zt_rotation_velocity(turn, speed));
    memcpy(m->x, &new_turn, sizeof new_turn);
    memcpy(m->w, &speed, sizeof speed);
}

void zt_curve_spring_motions(double *motions, const zt_curve *curve) {
    int32_t width = zt_curve_motion_width(curve) / 2;
    memset(motions, 0, 2 * (size_t)width * sizeof *motions);
    for (int32_t k = 1; k < curve->key_count; k++) {
        motion m = motion_after(curve, motions, k - 1, curve->times[k]);
        change_rest(&m, curve, k);
        double *to = motions + (int64_t)k * 2 * width;
        memcpy(to, m.x, (size_t)width * sizeof *to);
        memcpy(to + width, m.w, (size_t)width * sizeof *to);
    }
}

void zt_curve_spring_eval(double *point, const zt_curve *curve, int32_t key, double time_s) {
    const double *rest = curve->points + (int64_t)key * curve->point_width;
    if (!(time_s > curve->times[0])) time_s = curve->times[0];
    motion m = motion_after(curve, curve->motions, key, time_s);
    if (zt_curve_is_on_sphere(curve)) {
        quat q = zt_rotation_unit(
            quat_mul(zt_curve_quat(rest), zt_rotation_of_turn(first_three(m.x))));
        memcpy(point, &q, sizeof q);
        return;
    }
    for (int32_t c = 0; c < curve->point_width; c++)
        point[c] = zt_curve_finite(rest[c] + m.x[c]);
}
