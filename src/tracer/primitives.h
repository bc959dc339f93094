/* Analytic primitives made ready for rays, and the distance at which a ray meets one: straight
 * code without branches, so that a loop over a batch becomes as wide as the machine is. */
#ifndef ZT_TRACER_PRIMITIVES_H
#define ZT_TRACER_PRIMITIVES_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#include "tracer/ray.h"

typedef enum zt_primitive_kind {
    ZT_PRIMITIVE_PLANE,
    ZT_PRIMITIVE_SPHERE,
    ZT_PRIMITIVE_ELLIPSOID, /* a sphere in a group that stretches it */
    ZT_PRIMITIVE_TRIANGLE,
    ZT_PRIMITIVE_MESH /* intersected by meshes.c */
} zt_primitive_kind;

/* A box along the axes; low > high where it is empty. */
typedef struct zt_box {
    real3 low, high;
} zt_box;

/* The largest number in a box. */
static inline real zt_box_size(const zt_box *b) {
    real low = real_max(real_max(fabsf(b->low.x), fabsf(b->low.y)), fabsf(b->low.z));
    real high = real_max(real_max(fabsf(b->high.x), fabsf(b->high.y)), fabsf(b->high.z));
    return real_max(low, high);
}

/* One thing to hit, in the space relative to the camera. Primitives stand in the order of their
 * objects; of equally near hits the first one counts. */
typedef struct zt_primitive {
    zt_primitive_kind kind;
    int32_t object; /* its index in the scene */
    int32_t mesh;   /* of a mesh: the index in the scene, else -1 */
    zt_box box;     /* around spheres and triangles */
    union {
        struct {
            real3 normal; /* unit */
            real distance;
        } plane;
        struct {
            real3 center;
            real radius;
        } sphere;
        struct {
            real3 to_unit[3]; /* rows of the matrix that makes it the unit sphere */
            real3 center;
        } ellipsoid;
        struct {
            real3 vertices[3];
        } triangle;
    };
} zt_primitive;

/* Each function below gives the nearest positive distance at which the ray o + t d, |d| = 1,
 * meets the primitive, or infinity (or NaN, which compares as no hit). */

static inline real zt_plane_distance(const zt_primitive *p, real ox, real oy, real oz, real dx,
                                     real dy, real dz) {
    real3 n = p->plane.normal;
    real t = (p->plane.distance - real_dot(n.x, n.y, n.z, ox, oy, oz)) /
             real_dot(n.x, n.y, n.z, dx, dy, dz);
    return t > 0 ? t : REAL_INFINITY;
}

/* Roots of a t^2 - 2 b t + c = 0 with the part across the ray, `across2` = |f + (b/a) d|^2, in
 * place of the cancelling b^2 - a c: Haines, Gunther and Akenine-Moller, "Precision
 * improvements for ray/sphere intersection", Ray Tracing Gems, 2019. The far one counts from
 * inside. */
static inline real sphere_root(real a, real b, real c, real radius2, real across2) {
    real inside = radius2 - across2;
    real half = sqrtf(a * (inside > 0 ? inside : 0));
    real q = b + (b < 0 ? -half : half);
    real t0 = c / q, t1 = q / a;
    real first = t0 < t1 ? t0 : t1, second = t0 < t1 ? t1 : t0;
    real t = first > 0 ? first : second;
    return ((inside > 0) & (t > 0)) ? t : REAL_INFINITY;
}

static inline real zt_sphere_distance(const zt_primitive *p, real ox, real oy, real oz, real dx,
                                      real dy, real dz) {
    real3 center = p->sphere.center;
    real r2 = p->sphere.radius * p->sphere.radius;
    real fx = ox - center.x, fy = oy - center.y, fz = oz - center.z;
    real b = -real_dot(fx, fy, fz, dx, dy, dz);
    real lx = fx + b * dx, ly = fy + b * dy, lz = fz + b * dz;
    real c = real_dot(fx, fy, fz, fx, fy, fz) - r2;
    return sphere_root(1, b, c, r2, real_dot(lx, ly, lz, lx, ly, lz));
}

static inline real zt_ellipsoid_distance(const zt_primitive *p, real ox, real oy, real oz,
                                         real dx, real dy, real dz) {
    const real3 *m = p->ellipsoid.to_unit;
    real3 center = p->ellipsoid.center;
    real gx = ox - center.x, gy = oy - center.y, gz = oz - center.z;
    real fx = real_dot(m[0].x, m[0].y, m[0].z, gx, gy, gz);
    real fy = real_dot(m[1].x, m[1].y, m[1].z, gx, gy, gz);
    real fz = real_dot(m[2].x, m[2].y, m[2].z, gx, gy, gz);
    real ex = real_dot(m[0].x, m[0].y, m[0].z, dx, dy, dz);
    real ey = real_dot(m[1].x, m[1].y, m[1].z, dx, dy, dz);
    real ez = real_dot(m[2].x, m[2].y, m[2].z, dx, dy, dz);
    real a = real_dot(ex, ey, ez, ex, ey, ez);
    real b = -real_dot(fx, fy, fz, ex, ey, ez), k = b / a;
    real lx = fx + k * ex, ly = fy + k * ey, lz = fz + k * ez;
    real c = real_dot(fx, fy, fz, fx, fy, fz) - 1;
    return sphere_root(a, b, c, 1, real_dot(lx, ly, lz, lx, ly, lz));
}

/* The side of the origin that a directed edge a -> b has it on, twice the area they span. The
 * products of floats are exact in double, so the sign is that of the exact result, and the edge
 * taken the other way round gives exactly the negative. */
static inline double edge_side(real ax, real ay, real bx, real by) {
    return (double)ax * (double)by - (double)ay * (double)bx;
}

/* Whether a point exactly on the edge a -> b of a counterclockwise triangle is its own: true
 * for one direction of an edge and false for the other, so it belongs to one of two neighbours.
 */
static inline bool edge_owned(real ax, real ay, real bx, real by) {
    return (by > ay) | ((by == ay) & (bx < ax));
}

/* Watertight: Woop, Benthin and Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013.
 * The triangle is sheared so that the ray runs along an axis; what is left is a 2D test of
 * which side of its edges the origin lies on, and neighbours agree on their common edge. */
static inline real zt_triangle_distance(const zt_primitive *p, real ox, real oy, real oz,
                                        real dx, real dy, real dz) {
    bool x_longest = (fabsf(dx) >= fabsf(dy)) & (fabsf(dx) >= fabsf(dz));
    bool y_longest = !x_longest & (fabsf(dy) >= fabsf(dz));
    /* The axes in cyclic order, so that z is the one along which the ray runs most. */
    real ex = x_longest ? dy : y_longest ? dz : dx;
    real ey = x_longest ? dz : y_longest ? dx : dy;
    real ez = x_longest ? dx : y_longest ? dy : dz;
    real shear_x = ex / ez, shear_y = ey / ez;
    real x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        real3 v = p->triangle.vertices[i];
        real vx = v.x - ox, vy = v.y - oy, vz = v.z - oz;
        z[i] = x_longest ? vx : y_longest ? vy : vz;
        x[i] = (x_longest ? vy : y_longest ? vz : vx) - shear_x * z[i];
        y[i] = (x_longest ? vz : y_longest ? vx : vy) - shear_y * z[i];
    }
    double u = edge_side(x[1], y[1], x[2], y[2]);
    double v = edge_side(x[2], y[2], x[0], y[0]);
    double w = edge_side(x[0], y[0], x[1], y[1]);
    double area = u + v + w;
    bool clockwise = area < 0;
    bool u_in = clockwise ? u < 0 : u > 0, v_in = clockwise ? v < 0 : v > 0,
         w_in = clockwise ? w < 0 : w > 0;
    u_in |= (u == 0) & (edge_owned(x[1], y[1], x[2], y[2]) != clockwise);
    v_in |= (v == 0) & (edge_owned(x[2], y[2], x[0], y[0]) != clockwise);
    w_in |= (w == 0) & (edge_owned(x[0], y[0], x[1], y[1]) != clockwise);
    double t = (u * (double)z[0] + v * (double)z[1] + w * (double)z[2]) / (area * (double)ez);
    return (u_in & v_in & w_in & (area != 0) & (t > 0)) ? (real)t : REAL_INFINITY;
}

#endif
