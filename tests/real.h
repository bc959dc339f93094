/* Numbers of higher precision than the code under test has, for references. */
#ifndef ZT_TESTS_REAL_H
#define ZT_TESTS_REAL_H

#include <float.h>
#include <math.h>

#if defined(__SIZEOF_FLOAT128__) && __has_include(<quadmath.h>)
#include <quadmath.h>
typedef __float128 real;
#define REAL(name)   name##q
#define REAL_PI      M_PIq
#define REAL_IS_QUAD 1
#else
typedef long double real;
#define REAL(name)   name##l
#define REAL_PI      3.14159265358979323846264338327950288L
#define REAL_IS_QUAD (LDBL_MANT_DIG >= 113)
#endif

typedef struct real4 {
    real w, x, y, z;
} real4;

static inline real4 real4_scale(real4 q, real s) {
    return (real4){q.w * s, q.x * s, q.y * s, q.z * s};
}
static inline real4 real4_add(real4 a, real4 b) {
    return (real4){a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline real real4_dot(real4 a, real4 b) {
    return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline real4 real4_unit(real4 q) {
    return real4_scale(q, 1 / REAL(sqrt)(real4_dot(q, q)));
}
/* The angle between two unit quaternions on their sphere. */
static inline real real4_angle(real4 a, real4 b) {
    real4 sum = real4_add(a, b), difference = real4_add(a, real4_scale(b, -1));
    return 2 * REAL(atan2)(REAL(sqrt)(real4_dot(difference, difference)),
                           REAL(sqrt)(real4_dot(sum, sum)));
}
/* Slerp as K. Shoemake, "Animating rotation with quaternion curves", 1985, prints it. */
static inline real4 real4_slerp(real4 a, real4 b, real u) {
    real angle = real4_angle(a, b), s = REAL(sin)(angle);
    if (s == 0) return a;
    return real4_add(real4_scale(a, REAL(sin)((1 - u) * angle) / s),
                     real4_scale(b, REAL(sin)(u * angle) / s));
}

#endif
