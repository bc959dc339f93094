/* Vectors of three doubles: points, directions and colours. */
#ifndef ZT_BASE_VEC_H
#define ZT_BASE_VEC_H

#include <math.h>

typedef struct vec3 {
    double x, y, z;
} vec3;

static inline vec3 vec3_add(vec3 a, vec3 b) { return (vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline vec3 vec3_sub(vec3 a, vec3 b) { return (vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline vec3 vec3_scale(vec3 a, double s) { return (vec3){a.x * s, a.y * s, a.z * s}; }
static inline double vec3_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

static inline vec3 vec3_cross(vec3 a, vec3 b) {
    return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/* The largest magnitude among the components. */
static inline double vec3_max_abs(vec3 a) {
    return fmax(fmax(fabs(a.x), fabs(a.y)), fabs(a.z));
}

/* Length without overflow or underflow on the way. */
static inline double vec3_length(vec3 a) {
    double m = vec3_max_abs(a);
    if (!(m > 0) || isinf(m)) return m;
    vec3 u = {a.x / m, a.y / m, a.z / m};
    return m * sqrt(vec3_dot(u, u));
}

/* The unit vector along `a`, whatever its magnitude; zero stays zero. */
static inline vec3 vec3_normalize(vec3 a) {
    double m = vec3_max_abs(a);
    if (!(m > 0)) return (vec3){0, 0, 0};
    vec3 u = {a.x / m, a.y / m, a.z / m};
    return vec3_scale(u, 1 / sqrt(vec3_dot(u, u)));
}

static inline vec3 vec3_min(vec3 a, vec3 b) {
    return (vec3){fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z)};
}
static inline vec3 vec3_max(vec3 a, vec3 b) {
    return (vec3){fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z)};
}

#endif
