/* Affine transforms: a 3 x 3 linear part given by its columns, then a shift. */
#ifndef ZT_BASE_XFORM_H
#define ZT_BASE_XFORM_H

#include "base/bits.h"
#include "base/quat.h"
#include "base/vec.h"

typedef struct xform {
    vec3 x, y, z; /* where the unit vectors go */
    vec3 shift;   /* where the origin goes */
} xform;

static inline xform xform_identity(void) {
    return (xform){{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
}

/* To the last bit. */
static inline bool xform_equal(const xform *a, const xform *b) {
    return zt_bits_equal(a, b, sizeof *a);
}

static inline vec3 xform_vector(const xform *m, vec3 v) {
    return (vec3){m->x.x * v.x + m->y.x * v.y + m->z.x * v.z,
                  m->x.y * v.x + m->y.y * v.y + m->z.y * v.z,
                  m->x.z * v.x + m->y.z * v.y + m->z.z * v.z};
}
static inline vec3 xform_point(const xform *m, vec3 p) {
    return vec3_add(xform_vector(m, p), m->shift);
}

/* First b, then a. */
static inline xform xform_mul(const xform *a, const xform *b) {
    return (xform){xform_vector(a, b->x), xform_vector(a, b->y), xform_vector(a, b->z),
                   xform_point(a, b->shift)};
}

/* Scale along the axes, then rotate by the unit quaternion q, then move. */
static inline xform xform_place(vec3 position, quat q, vec3 scale) {
    double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z,
           yz = q.y * q.z, wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    vec3 x = {1 - 2 * (yy + zz), 2 * (xy + wz), 2 * (xz - wy)};
    vec3 y = {2 * (xy - wz), 1 - 2 * (xx + zz), 2 * (yz + wx)};
    vec3 z = {2 * (xz + wy), 2 * (yz - wx), 1 - 2 * (xx + yy)};
    return (xform){vec3_scale(x, scale.x), vec3_scale(y, scale.y), vec3_scale(z, scale.z),
                   position};
}

static inline double xform_determinant(const xform *m) {
    return vec3_dot(vec3_cross(m->x, m->y), m->z);
}

/* What undoes a transform. Not finite where the linear part is singular. */
static inline xform xform_inverse(const xform *m) {
    double scale = 1 / xform_determinant(m);
    /* The rows of the inverse are the cross products of the columns. */
    vec3 r = vec3_scale(vec3_cross(m->y, m->z), scale);
    vec3 s = vec3_scale(vec3_cross(m->z, m->x), scale);
    vec3 t = vec3_scale(vec3_cross(m->x, m->y), scale);
    vec3 back = {-vec3_dot(r, m->shift), -vec3_dot(s, m->shift), -vec3_dot(t, m->shift)};
    return (xform){{r.x, s.x, t.x}, {r.y, s.y, t.y}, {r.z, s.z, t.z}, back};
}

/* Takes a normal of a surface to the normal of the transformed surface, not of unit length: the
 * cofactors of the linear part, which exist where the inverse does not. A mirroring transform
 * keeps the side: outside stays outside. */
static inline vec3 xform_normal(const xform *m, vec3 n) {
    vec3 c = vec3_add(vec3_add(vec3_scale(vec3_cross(m->y, m->z), n.x),
                               vec3_scale(vec3_cross(m->z, m->x), n.y)),
                      vec3_scale(vec3_cross(m->x, m->y), n.z));
    return xform_determinant(m) < 0 ? vec3_scale(c, -1) : c;
}

#endif
