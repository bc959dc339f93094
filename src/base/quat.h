/* Rotations as unit quaternions w + xi + yj + zk. */
#ifndef ZT_BASE_QUAT_H
#define ZT_BASE_QUAT_H

#include "base/vec.h"

typedef struct quat {
    double w, x, y, z;
} quat;

static inline quat quat_identity(void) { return (quat){1, 0, 0, 0}; }
static inline quat quat_scale(quat q, double s) {
    return (quat){q.w * s, q.x * s, q.y * s, q.z * s};
}
static inline quat quat_add(quat a, quat b) {
    return (quat){a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline double quat_dot(quat a, quat b) {
    return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline quat quat_conjugate(quat q) { return (quat){q.w, -q.x, -q.y, -q.z}; }

/* First b, then a: the product rotates as the matrices A B do. */
static inline quat quat_mul(quat a, quat b) {
    return (quat){
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
    };
}

/* The unit quaternion along `q`; zero becomes the identity. */
static inline quat quat_normalize(quat q) {
    double n = sqrt(quat_dot(q, q));
    return n > 0 ? quat_scale(q, 1 / n) : quat_identity();
}

/* A turn by `angle` radians around a unit `axis`, counterclockwise seen from its tip. */
static inline quat quat_axis_angle(vec3 axis, double angle) {
    double s = sin(angle / 2);
    return (quat){cos(angle / 2), axis.x * s, axis.y * s, axis.z * s};
}

/* Euler angles in radians, turned around the fixed axes in the order x, y, z: Rz Ry Rx. */
static inline quat quat_euler_xyz(vec3 angles) {
    quat x = quat_axis_angle((vec3){1, 0, 0}, angles.x);
    quat y = quat_axis_angle((vec3){0, 1, 0}, angles.y);
    quat z = quat_axis_angle((vec3){0, 0, 1}, angles.z);
    return quat_mul(z, quat_mul(y, x));
}

#endif
