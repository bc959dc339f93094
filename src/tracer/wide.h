/* Numbers of 113 bits, in software, where the compiler has them: for what cancels while a scene
 * is prepared. */
#ifndef ZT_TRACER_WIDE_H
#define ZT_TRACER_WIDE_H

#include <math.h>
#include <stdbool.h>

#include "base/xform.h"

#if defined __SIZEOF_FLOAT128__
__extension__ typedef __float128 wide;
#else
typedef long double wide;
#endif

typedef struct wide3 {
    wide x, y, z;
} wide3;

/* The linear part of a transform, by its columns. */
typedef struct wide_axes {
    wide3 x, y, z;
} wide_axes;

static inline wide3 widen(vec3 v) { return (wide3){v.x, v.y, v.z}; }
static inline vec3 wide_narrow(wide3 a, wide scale) {
    return (vec3){(double)(a.x * scale), (double)(a.y * scale), (double)(a.z * scale)};
}

static inline wide wide_abs(wide a) { return a < 0 ? -a : a; }
static inline wide wide_max_abs(wide3 a) {
    wide x = wide_abs(a.x), y = wide_abs(a.y), z = wide_abs(a.z);
    return x > y ? x > z ? x : z : y > z ? y : z;
}
static inline wide3 wide_sub(wide3 a, wide3 b) {
    return (wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline wide wide_dot(wide3 a, wide3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline wide3 wide_cross(wide3 a, wide3 b) {
    return (wide3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline wide3 wide_combine(wide_axes m, wide3 v) {
    return (wide3){m.x.x * v.x + m.y.x * v.y + m.z.x * v.z,
                   m.x.y * v.x + m.y.y * v.y + m.z.y * v.z,
                   m.x.z * v.x + m.y.z * v.y + m.z.z * v.z};
}

static inline wide_axes wide_axes_of(const xform *m) {
    return (wide_axes){widen(m->x), widen(m->y), widen(m->z)};
}

/* Scale along the axes, then rotate, as xform_place does. */
static inline wide_axes wide_placed(quat q, vec3 scale) {
    wide w = q.w, i = q.x, j = q.y, k = q.z, a = scale.x, b = scale.y, c = scale.z;
    return (wide_axes){
        {a * (1 - 2 * (j * j + k * k)), a * 2 * (i * j + w * k), a * 2 * (i * k - w * j)},
        {b * 2 * (i * j - w * k), b * (1 - 2 * (i * i + k * k)), b * 2 * (j * k + w * i)},
        {c * 2 * (i * k + w * j), c * 2 * (j * k - w * i), c * (1 - 2 * (i * i + j * j))}};
}

/* The cross products of the columns: the rows of what undoes it, times the determinant. */
static inline wide_axes wide_cofactors(wide_axes m) {
    return (wide_axes){wide_cross(m.y, m.z), wide_cross(m.z, m.x), wide_cross(m.x, m.y)};
}

/* Beyond this stretch double precision does not invert a transform well enough for double
 * precision. */
#define WIDE_STRETCH 100

static inline double wide_longest(const xform *m) {
    return fmax(vec3_length(m->x), fmax(vec3_length(m->y), vec3_length(m->z)));
}

/* Whether a transform and what double precision makes of its inverse are so. */
static inline bool wide_is_askew(const xform *m, const xform *back) {
    return !(wide_longest(m) * wide_longest(back) < WIDE_STRETCH);
}

/* What undoes a transform, right to the last bits however askew its axes are: in double their
 * cross products cancel where one group stretches what another one turns. */
static inline xform wide_inverse(const xform *m) {
    xform back = xform_inverse(m);
    if (!wide_is_askew(m, &back)) return back;
    wide_axes cofactors = wide_cofactors(wide_axes_of(m));
    const wide3 r[3] = {cofactors.x, cofactors.y, cofactors.z};
    wide scale = 1 / wide_dot(r[0], widen(m->x));
    vec3 rows[3];
    double shift[3];
    for (int i = 0; i < 3; i++) {
        rows[i] = wide_narrow(r[i], scale);
        shift[i] = (double)(-wide_dot(r[i], widen(m->shift)) * scale);
    }
    return (xform){{rows[0].x, rows[1].x, rows[2].x},
                   {rows[0].y, rows[1].y, rows[2].y},
                   {rows[0].z, rows[1].z, rows[2].z},
                   {shift[0], shift[1], shift[2]}};
}

#endif
