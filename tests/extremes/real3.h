/* Vectors and affine transforms of the reference's numbers. */
#ifndef ZT_TESTS_REAL3_H
#define ZT_TESTS_REAL3_H

#include "base/xform.h"
#include "real.h"

typedef struct real3 {
    real x, y, z;
} real3;

static inline real3 real3_of(vec3 v) { return (real3){v.x, v.y, v.z}; }
static inline vec3 real3_round(real3 v) {
    return (vec3){(double)v.x, (double)v.y, (double)v.z};
}
static inline real3 real3_add(real3 a, real3 b) {
    return (real3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline real3 real3_sub(real3 a, real3 b) {
    return (real3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline real3 real3_scale(real3 a, real s) { return (real3){a.x * s, a.y * s, a.z * s}; }
static inline real real3_dot(real3 a, real3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline real3 real3_cross(real3 a, real3 b) {
    return (real3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline real3 real3_along(real3 o, real t, real3 d) {
    return real3_add(o, real3_scale(d, t));
}
static inline real real3_length(real3 a) { return REAL(sqrt)(real3_dot(a, a)); }
static inline real3 real3_unit(real3 a) {
    real length = real3_length(a);
    return length > 0 ? real3_scale(a, 1 / length) : (real3){0, 0, 0};
}
static inline real real_abs(real a) { return a < 0 ? -a : a; }
static inline real real_max(real a, real b) { return a > b ? a : b; }
static inline real real_min(real a, real b) { return a < b ? a : b; }

/* Two unit vectors that make a right-handed system with the unit vector z. */
static inline void real3_frame(real3 *x, real3 *y, real3 z) {
    real3 axis = real_abs(z.x) < (real)0.6 ? (real3){1, 0, 0} : (real3){0, 1, 0};
    *x = real3_unit(real3_cross(axis, z));
    *y = real3_cross(z, *x);
}

/* Columns of a linear part, then a shift: as xform. */
typedef struct affine {
    real3 x, y, z, shift;
} affine;

static inline real3 affine_vector(const affine *m, real3 v) {
    return real3_add(real3_add(real3_scale(m->x, v.x), real3_scale(m->y, v.y)),
                     real3_scale(m->z, v.z));
}
static inline real3 affine_point(const affine *m, real3 p) {
    return real3_add(affine_vector(m, p), m->shift);
}
/* First b, then a. */
static inline affine affine_mul(const affine *a, const affine *b) {
    return (affine){affine_vector(a, b->x), affine_vector(a, b->y), affine_vector(a, b->z),
                    affine_point(a, b->shift)};
}

/* The transform that xform_place makes, by the same formula: the quaternion as it is. */
static inline affine affine_place(vec3 position, quat q, real3 scale) {
    real w = q.w, i = q.x, j = q.y, k = q.z;
    real3 x = {1 - 2 * (j * j + k * k), 2 * (i * j + w * k), 2 * (i * k - w * j)};
    real3 y = {2 * (i * j - w * k), 1 - 2 * (i * i + k * k), 2 * (j * k + w * i)};
    real3 z = {2 * (i * k + w * j), 2 * (j * k - w * i), 1 - 2 * (i * i + j * j)};
    return (affine){real3_scale(x, scale.x), real3_scale(y, scale.y), real3_scale(z, scale.z),
                    real3_of(position)};
}

/* The rows of the inverse of the linear part; false where it is singular. */
static inline bool affine_inverse_rows(real3 rows[3], const affine *m) {
    real3 yz = real3_cross(m->y, m->z);
    real determinant = real3_dot(yz, m->x);
    if (determinant == 0) return false;
    rows[0] = real3_scale(yz, 1 / determinant);
    rows[1] = real3_scale(real3_cross(m->z, m->x), 1 / determinant);
    rows[2] = real3_scale(real3_cross(m->x, m->y), 1 / determinant);
    return true;
}

#endif
