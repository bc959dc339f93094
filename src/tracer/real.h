/* What rays are made of: single or double precision. The files of the kernels are compiled once
 * for each, with ZT_REAL_IS_DOUBLE defined or not. Space is relative to the camera: the
 * subtraction is made in double precision before anything becomes `real`. */
#ifndef ZT_TRACER_REAL_H
#define ZT_TRACER_REAL_H

#include <float.h>
#include <math.h>
#include <stdint.h>

#if defined ZT_REAL_IS_DOUBLE
typedef double real;
typedef int64_t real_bits; /* as many bits */
typedef uint64_t real_code;
#define REAL_BITS_MAX      INT64_MAX
#define ZT_REAL_NAME(name) name##_double
#define REAL_ROUNDING      0x1p-53 /* the relative error of one rounding */
#define REAL_LEAST         DBL_MIN /* the least number of full precision above 0 */
static inline real real_sqrt(real a) { return sqrt(a); }
static inline real real_abs(real a) { return fabs(a); }
#else
typedef float real;
typedef int32_t real_bits;
typedef uint32_t real_code;
#define REAL_BITS_MAX      INT32_MAX
#define ZT_REAL_NAME(name) name##_single
#define REAL_ROUNDING      0x1p-24f
#define REAL_LEAST         FLT_MIN
static inline real real_sqrt(real a) { return sqrtf(a); }
static inline real real_abs(real a) { return fabsf(a); }
#endif

#define REAL_INFINITY ((real)INFINITY)

static inline real real_max(real a, real b) { return a > b ? a : b; }
static inline real real_min(real a, real b) { return a < b ? a : b; }

/* a b - c d, right to the last bits of its own however much of it cancels; a b - c d and
 * c d - a b are each other's negatives. Products of floats are exact in double; of doubles the
 * roundings are made good (T. J. Dekker, "A floating-point technique for extending the
 * available precision", 1971). */
#if defined ZT_REAL_IS_DOUBLE
static inline double rounding_of_product(double a, double b, double product) {
    const double split = 0x1p27 + 1;
    double ca = split * a, cb = split * b;
    double ah = ca - (ca - a), al = a - ah, bh = cb - (cb - b), bl = b - bh;
    return ((ah * bh - product) + ah * bl + al * bh) + al * bl;
}
static inline double real_products(real a, real b, real c, real d) {
    double p = a * b, q = c * d;
    double low = rounding_of_product(a, b, p) - rounding_of_product(c, d, q);
    return (p - q) + (real_abs(low) < REAL_INFINITY ? low : 0); /* too large to be split */
}
#else
static inline double real_products(real a, real b, real c, real d) {
    return (double)a * (double)b - (double)c * (double)d;
}
#endif

typedef struct real3 {
    real x, y, z;
} real3;

static inline real real_dot(real ax, real ay, real az, real bx, real by, real bz) {
    return ax * bx + ay * by + az * bz;
}

#endif
