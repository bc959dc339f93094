/* Solids in their canonical places: where a ray meets them, and what they are like near a
 * point. Straight code without branches, so that a loop over a batch becomes as wide as the
 * machine is.
 *
 * zt_<kind>_meet gives the nearest t > near >= 0 at which f + t e meets the solid, where it is
 * left if f + near e is inside, or infinity. e may have any length that squares without
 * overflow or underflow.
 * `leaving` is 0 where the ray begins elsewhere. It is 1 where the ray begins on this very
 * surface and goes outward, and -1 where it goes inward: the root at 0 is then left out,
 * however f was rounded. Convex solids are never met again outward and always left inward, at
 * the least t there is if need be.
 *
 * zt_<kind>_surface gives, for a point near the surface, the face that it is nearest to,
 * measured where the solid is: `m` has the rows that take directions from there. In a thin
 * one's own space another face may be nearer than the one that the point lies on but for
 * roundings.
 *
 * What the two parameters p0, p1 of all functions are:
 *   disk      z = 0, radius 1
 *   box       from -1 to 1 along each axis
 *   ball      radius 1
 *   cylinder  z from 0 to 1, radius 1, closed
 *   cone      z from 0 to 1, radius p0 at 0 and p1 at 1, the greater of them 1; closed
 *   capsule   within 1 of the way from z = 0 to z = p0
 *   torus     within p0 in (0, 1] of the circle of radius 1 about z (solids_torus.h)
 *
 * Backward stable: what comes out is exact for a ray whose origin and direction are moved by a
 * few roundings of |f| and of |e|, and a solid by a few roundings of its size. To that end,
 * quadratics are solved about the point of the ray nearest to where their surface is, not about
 * f: Haines, Gunther and Akenine-Moller, "Precision improvements for ray/sphere intersection",
 * Ray Tracing Gems, 2019. */
#ifndef ZT_TRACER_SOLIDS_H
#define ZT_TRACER_SOLIDS_H

#include <float.h>
#include <stdbool.h>
#include <stdint.h>

#include "tracer/real.h"

#if defined ZT_REAL_IS_DOUBLE
#define REAL_LEAST DBL_MIN
#else
#define REAL_LEAST FLT_MIN
#endif

/* The unit outward normal of the nearest face, and the signed distance to it, to first order.
 */
typedef struct zt_face {
    real nx, ny, nz, off;
} zt_face;

/* Rows of the matrix that takes directions to the solid's own space. */
typedef struct zt_rows {
    real3 x, y, z;
} zt_rows;

/* A gradient of that space as it is beyond it. */
static inline real3 zt_gradient(const zt_rows *m, real nx, real ny, real nz) {
    return (real3){m->x.x * nx + m->y.x * ny + m->z.x * nz,
                   m->x.y * nx + m->y.y * ny + m->z.y * nz,
                   m->x.z * nx + m->y.z * ny + m->z.z * nz};
}

static inline real length_of(real3 v) {
    return real_sqrt(real_dot(v.x, v.y, v.z, v.x, v.y, v.z));
}

/* The part of a ray from `in` to `out` that lies within something; none where in > out. */
typedef struct zt_stretch {
    real in, out;
} zt_stretch;

/* What both have. A bound of `b` that is NaN bounds nothing. */
static inline zt_stretch stretch_both(zt_stretch a, zt_stretch b) {
    return (zt_stretch){b.in > a.in ? b.in : a.in, b.out < a.out ? b.out : a.out};
}

/* From the first to the last that one or the other has. */
static inline zt_stretch stretch_hull(zt_stretch a, zt_stretch b) {
    bool some_a = a.in <= a.out, some_b = b.in <= b.out;
    real in = some_a ? a.in : REAL_INFINITY, out = some_a ? a.out : -REAL_INFINITY;
    return (zt_stretch){(some_b & (b.in < in)) ? b.in : in,
                        (some_b & (b.out > out)) ? b.out : out};
}

/* Where a ray meets a convex solid that it crosses along a stretch. If there is none, but it
 * began inward, it hardly entered, and is out at once. */
static inline real stretch_meet(zt_stretch s, int32_t leaving, real near) {
    bool some = (s.in <= s.out) & (s.out > REAL_LEAST);
    real left = some ? s.out : REAL_LEAST;
    real elsewhere = some ? (s.in > near ? s.in : s.out) : REAL_INFINITY;
    return leaving == 0 ? elsewhere : leaving > 0 ? REAL_INFINITY : left;
}

/* Between the planes x = low and x = high. A ray along them has no end, or none of it is there.
 */
static inline zt_stretch slab_stretch(real f, real e, real low, real high) {
    real in = e < 0 ? f - high : low - f, out = e < 0 ? f - low : high - f;
    real scale = 1 / real_abs(e);
    return (zt_stretch){in * scale, out * scale};
}

/* Within 1 of the origin, for a direction of the length whose square is a. */
static inline zt_stretch ball_stretch(real fx, real fy, real fz, real ex, real ey, real ez,
                                      real a) {
    real scale = 1 / a, k = -real_dot(fx, fy, fz, ex, ey, ez) * scale;
    real gx = fx + k * ex, gy = fy + k * ey, gz = fz + k * ez;
    real inside = 1 - real_dot(gx, gy, gz, gx, gy, gz);
    real half = real_sqrt(real_max(inside, 0) * scale);
    return (zt_stretch){inside < 0 ? REAL_INFINITY : k - half, k + half};
}

/* Within 1 of the axis z, for a unit direction. */
static inline zt_stretch tube_stretch(real fx, real fy, real ex, real ey) {
    real a = ex * ex + ey * ey;
    bool along = a < REAL_ROUNDING * REAL_ROUNDING * REAL_ROUNDING * REAL_ROUNDING;
    real scale = along ? REAL_INFINITY : 1 / a;
    real k = along ? 0 : -(fx * ex + fy * ey) * scale;
    real gx = fx + k * ex, gy = fy + k * ey;
    real inside = 1 - (gx * gx + gy * gy);
    real half = real_sqrt(real_max(inside, 0) * scale);
    return (zt_stretch){inside < 0 ? REAL_INFINITY : k - half, k + half};
}

/* ---- disk ---- */

static inline real zt_disk_meet(real fx, real fy, real fz, real ex, real ey, real ez, real p0,
                                real p1, int32_t leaving, real near) {
    (void)p0, (void)p1;
    real t = -fz / ez;
    real x = fx + t * ex, y = fy + t * ey;
    return ((x * x + y * y <= 1) & (t > near) & (leaving == 0)) ? t : REAL_INFINITY;
}

static inline zt_face zt_disk_surface(real x, real y, real z, real p0, real p1,
                                      const zt_rows *m) {
    (void)x, (void)y, (void)p0, (void)p1, (void)m;
    return (zt_face){0, 0, 1, z};
}

/* ---- box ---- */

static inline real zt_box_meet(real fx, real fy, real fz, real ex, real ey, real ez, real p0,
                               real p1, int32_t leaving, real near) {
    (void)p0, (void)p1;
    zt_stretch s = {-REAL_INFINITY, REAL_INFINITY};
    s = stretch_both(s, slab_stretch(fx, ex, -1, 1));
    s = stretch_both(s, slab_stretch(fy, ey, -1, 1));
    s = stretch_both(s, slab_stretch(fz, ez, -1, 1));
    return stretch_meet(s, leaving, near);
}

static inline zt_face zt_box_surface(real x, real y, real z, real p0, real p1,
                                     const zt_rows *m) {
    (void)p0, (void)p1;
    real ax = real_abs(x), ay = real_abs(y), az = real_abs(z);
    real lx = (ax - 1) / length_of(m->x), ly = (ay - 1) / length_of(m->y),
         lz = (az - 1) / length_of(m->z);
    bool is_x = (lx >= ly) & (lx >= lz), is_y = !is_x & (ly >= lz), is_z = !is_x & !is_y;
    real nx = x < 0 ? -1 : 1, ny = y < 0 ? -1 : 1, nz = z < 0 ? -1 : 1;
    real off = is_x ? ax - 1 : is_y ? ay - 1 : az - 1;
    return (zt_face){is_x ? nx : 0, is_y ? ny : 0, is_z ? nz : 0, off};
}

/* ---- ball ---- */

static inline real zt_ball_meet(real fx, real fy, real fz, real ex, real ey, real ez, real p0,
                                real p1, int32_t leaving, real near) {
    (void)p0, (void)p1;
    real a = real_dot(ex, ey, ez, ex, ey, ez);
    return stretch_meet(ball_stretch(fx, fy, fz, ex, ey, ez, a), leaving, near);
}

/* Of what is everywhere 1 away from (x, y, z) = 0; a normal also there. */
static inline zt_face round_face(real x, real y, real z) {
    real length = real_sqrt(real_dot(x, y, z, x, y, z));
    bool none = length == 0;
    real scale = 1 / (none ? 1 : length);
    return (zt_face){none ? 1 : x * scale, y * scale, z * scale, length - 1};
}

static inline zt_face zt_ball_surface(real x, real y, real z, real p0, real p1,
                                      const zt_rows *m) {
    (void)p0, (void)p1, (void)m;
    return round_face(x, y, z);
}

/* ---- cylinder ---- */

static inline real zt_cylinder_meet(real fx, real fy, real fz, real ex, real ey, real ez,
                                    real p0, real p1, int32_t leaving, real near) {
    (void)p0, (void)p1;
    real scale = 1 / real_sqrt(real_dot(ex, ey, ez, ex, ey, ez));
    zt_stretch side = tube_stretch(fx, fy, ex * scale, ey * scale);
    zt_stretch s = {side.in * scale, side.out * scale};
    return stretch_meet(stretch_both(s, slab_stretch(fz, ez, 0, 1)), leaving, near);
}

/* The face of the side of something round about z, or that of the cap it is nearer to. */
static inline zt_face capped_face(zt_face side, real z, const zt_rows *m) {
    zt_face cap = {0, 0, z > (real)0.5 ? 1 : -1, z > (real)0.5 ? z - 1 : -z};
    real steep = length_of(zt_gradient(m, side.nx, side.ny, side.nz));
    bool on_cap = cap.off * steep > side.off * length_of(m->z);
    return (zt_face){on_cap ? cap.nx : side.nx, on_cap ? cap.ny : side.ny,
                     on_cap ? cap.nz : side.nz, on_cap ? cap.off : side.off};
}

static inline zt_face zt_cylinder_surface(real x, real y, real z, real p0, real p1,
                                          const zt_rows *m) {
    (void)p0, (void)p1;
    return capped_face(round_face(x, y, 0), z, m);
}

/* ---- cone ---- */

/* About the point nearest to the middle of the narrow end, which is taken to z = 0. There, what
 * x^2 + y^2 and the radius w = w0 + t w1 are made of is as small as the cone is where it is
 * met; the quadratic x^2 + y^2 - w^2 is negative on the other nappe too, but only beyond the
 * caps. */
static inline zt_stretch cone_side_stretch(real fx, real fy, real fz, real ex, real ey, real ez,
                                           real narrow) {
    real slope = 1 - narrow;
    real k = -real_dot(fx, fy, fz, ex, ey, ez);
    real gx = fx + k * ex, gy = fy + k * ey, gz = fz + k * ez;
    real w0 = narrow + slope * gz, w1 = slope * ez;
    real a = ex * ex + ey * ey - w1 * w1;
    real b = gx * ex + gy * ey - w0 * w1;
    real c = gx * gx + gy * gy - w0 * w0;
    real square = b * b - a * c;
    real half = real_sqrt(real_max(square, 0));
    real q = b < 0 ? half - b : -half - b;
    real t0 = q / a, t1 = q == 0 ? t0 : c / q;
    real first = k + (t0 < t1 ? t0 : t1), second = k + (t0 < t1 ? t1 : t0);
    /* Steeper than the sides, the ray is within them from some point on, or up to it. */
    bool steep = a < 0;
    bool widens = w1 > 0;
    real in = steep ? (widens ? second : -REAL_INFINITY) : first;
    real out = steep ? (widens ? REAL_INFINITY : first) : second;
    bool none = (!steep) & ((square < 0) | ((q == 0) & (c > 0)));
    return (zt_stretch){none ? REAL_INFINITY : in, none ? -REAL_INFINITY : out};
}

static inline real zt_cone_meet(real fx, real fy, real fz, real ex, real ey, real ez, real p0,
                                real p1, int32_t leaving, real near) {
    real scale = 1 / real_sqrt(real_dot(ex, ey, ez, ex, ey, ez));
    bool turned = p0 > p1;
    zt_stretch side = cone_side_stretch(fx, fy, turned ? 1 - fz : fz, ex * scale, ey * scale,
                                        (turned ? -ez : ez) * scale, real_min(p0, p1));
    side = (zt_stretch){side.in * scale, side.out * scale};
    return stretch_meet(stretch_both(slab_stretch(fz, ez, 0, 1), side), leaving, near);
}

static inline zt_face zt_cone_surface(real x, real y, real z, real p0, real p1,
                                      const zt_rows *m) {
    zt_face around = round_face(x, y, 0);
    real slope = p1 - p0;
    real scale = 1 / real_sqrt(1 + slope * slope);
    real off = around.off + 1 - (p0 + slope * z);
    zt_face side = {around.nx * scale, around.ny * scale, -slope * scale, off * scale};
    return capped_face(side, z, m);
}

/* ---- capsule ---- */

static inline real zt_capsule_meet(real fx, real fy, real fz, real ex, real ey, real ez,
                                   real p0, real p1, int32_t leaving, real near) {
    (void)p1;
    real scale = 1 / real_sqrt(real_dot(ex, ey, ez, ex, ey, ez));
    real ux = ex * scale, uy = ey * scale, uz = ez * scale;
    zt_stretch between =
        stretch_both(slab_stretch(fz, uz, 0, p0), tube_stretch(fx, fy, ux, uy));
    zt_stretch s = stretch_hull(ball_stretch(fx, fy, fz, ux, uy, uz, 1),
                                ball_stretch(fx, fy, fz - p0, ux, uy, uz, 1));
    s = stretch_hull(s, between);
    return stretch_meet((zt_stretch){s.in * scale, s.out * scale}, leaving, near);
}

static inline zt_face zt_capsule_surface(real x, real y, real z, real p0, real p1,
                                         const zt_rows *m) {
    (void)p1, (void)m;
    return round_face(x, y, z < 0 ? z : z > p0 ? z - p0 : 0);
}

#endif
