/* Analytic primitives made ready for rays, and the distance at which a ray meets one: straight
 * code without branches, so that a loop over a batch becomes as wide as the machine is. */
#ifndef ZT_TRACER_PRIMITIVES_H
#define ZT_TRACER_PRIMITIVES_H

#include <stdbool.h>
#include <stdint.h>

#include "tracer/real.h"
#include "tracer/solids.h"
#include "tracer/solids_torus.h"

typedef enum zt_primitive_kind {
    ZT_PRIMITIVE_PLANE,
    ZT_PRIMITIVE_SPHERE,
    ZT_PRIMITIVE_TRIANGLE,
    ZT_PRIMITIVE_MESH,
    /* Solids, each in a space of its own (tracer/solids.h). */
    ZT_PRIMITIVE_BALL, /* a sphere in a group that stretches it */
    ZT_PRIMITIVE_DISK,
    ZT_PRIMITIVE_BOX,
    ZT_PRIMITIVE_CYLINDER,
    ZT_PRIMITIVE_CONE,
    ZT_PRIMITIVE_CAPSULE,
    ZT_PRIMITIVE_TORUS,
    ZT_PRIMITIVE_KIND_COUNT
} zt_primitive_kind;

static inline bool zt_kind_is_solid(zt_primitive_kind kind) {
    return kind >= ZT_PRIMITIVE_BALL;
}

/* A box along the axes; low > high where it is empty. */
typedef struct zt_box {
    real3 low, high;
} zt_box;

/* The largest number in a box. */
static inline real zt_box_size(const zt_box *b) {
    real low = real_max(real_max(real_abs(b->low.x), real_abs(b->low.y)), real_abs(b->low.z));
    real high =
        real_max(real_max(real_abs(b->high.x), real_abs(b->high.y)), real_abs(b->high.z));
    return real_max(low, high);
}

/* The intersections with what is within a box may round out of it by this many roundings of the
 * largest number there is, times the primitive's `stretch`. */
#define BOX_ROUNDINGS 32

/* One thing to hit, in the space relative to the camera. Primitives stand in the order of their
 * objects. */
typedef struct zt_primitive {
    zt_primitive_kind kind;
    int32_t object; /* its index in the scene */
    zt_box box;     /* around all but planes */
    real stretch;   /* how many times more roundings than a sphere's its arithmetic may have */
    /* Of what moves, else NULL: where it is at which moment (tracer/motion.h). Then the box is
     * around all of its way, and what follows says nothing. */
    const real *poses;
    real unit; /* of the poses of a solid: what their axes are given in, a power of two */
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
            real3 vertices[3];
        } triangle;
        struct {
            real3 rows[3]; /* of the matrix that takes directions to the solid's space */
            real3 center;  /* where that space's origin is */
            real a, b;     /* of a cone: its radii; of a capsule: its length; of a torus: the
                              tube's radius */
        } solid;
        int32_t placed; /* of a mesh: its index among the placed ones */
    };
} zt_primitive;

/* Each function below gives the nearest distance above `near` >= 0 at which the ray o + t d,
 * |d| = 1, meets the primitive, or infinity (or NaN, which compares as no hit); a closed one
 * that begins nearer is met where it ends. `leaving` is 0 for a ray that begins elsewhere, 1
 * for one that begins on this surface and goes on outside of it, -1 for one that goes on
 * inside. */

/* The normal has any length. */
static inline real zt_plane_meet(real3 n, real distance, real ox, real oy, real oz, real dx,
                                 real dy, real dz, int32_t leaving, real near) {
    real t =
        (distance - real_dot(n.x, n.y, n.z, ox, oy, oz)) / real_dot(n.x, n.y, n.z, dx, dy, dz);
    return ((t > near) & (leaving == 0)) ? t : REAL_INFINITY;
}

static inline real zt_plane_distance(const zt_primitive *p, real ox, real oy, real oz, real dx,
                                     real dy, real dz, int32_t leaving, real near) {
    return zt_plane_meet(p->plane.normal, p->plane.distance, ox, oy, oz, dx, dy, dz, leaving,
                         near);
}

/* Roots of t^2 - 2 b t + c = 0 with the part across the ray, |f + b d|^2, in place of the
 * cancelling b^2 - c: Haines, Gunther and Akenine-Moller, "Precision improvements for
 * ray/sphere intersection", Ray Tracing Gems, 2019. The far one counts from inside. Of a ray
 * that leaves the sphere inwards one root is 0, and the other one, 2 b, is positive. */
static inline real zt_sphere_meet(real3 center, real radius, real ox, real oy, real oz, real dx,
                                  real dy, real dz, int32_t leaving, real near) {
    real r2 = radius * radius;
    real fx = ox - center.x, fy = oy - center.y, fz = oz - center.z;
    real b = -real_dot(fx, fy, fz, dx, dy, dz);
    real lx = fx + b * dx, ly = fy + b * dy, lz = fz + b * dz;
    real c = real_dot(fx, fy, fz, fx, fy, fz) - r2;
    real inside = r2 - real_dot(lx, ly, lz, lx, ly, lz);
    real half = real_sqrt(real_max(inside, 0));
    real q = b + (b < 0 ? -half : half), s = c / q;
    real first = real_min(s, q), second = real_max(s, q);
    real t = first > near ? first : second;
    t = ((inside > 0) & (t > near)) ? t : REAL_INFINITY;
    real through = real_max(2 * b, REAL_LEAST);
    return leaving == 0 ? t : leaving < 0 ? through : REAL_INFINITY;
}

static inline real zt_sphere_distance(const zt_primitive *p, real ox, real oy, real oz, real dx,
                                      real dy, real dz, int32_t leaving, real near) {
    return zt_sphere_meet(p->sphere.center, p->sphere.radius, ox, oy, oz, dx, dy, dz, leaving,
                          near);
}

/* The side of the origin that a directed edge a -> b has it on, twice the area they span: right
 * to its last bits, so that a sliver is met where it is and not anywhere along it. The edge
 * taken the other way round gives exactly the negative. */
static inline double edge_side(real ax, real ay, real bx, real by) {
    return real_products(ax, by, ay, bx);
}

/* Whether a point exactly on the edge a -> b of a counterclockwise triangle is its own: true
 * for one direction of an edge and false for the other, so it belongs to one of two neighbours.
 */
static inline bool edge_owned(real ax, real ay, real bx, real by) {
    return (by > ay) | ((by == ay) & (bx < ax));
}

/* Watertight: Woop, Benthin and Wald, "Watertight ray/triangle intersection", JCGT 2(1), 2013.
 * The triangle is sheared so that the ray, of any length, runs along an axis; what is left is a
 * 2D test of which side of its edges the origin lies on, and neighbours agree on their common
 * edge. */
static inline real zt_triangle_meet(real3 v0, real3 v1, real3 v2, real ox, real oy, real oz,
                                    real dx, real dy, real dz) {
    real along_x = real_abs(dx), along_y = real_abs(dy), along_z = real_abs(dz);
    bool x_longest = (along_x >= along_y) & (along_x >= along_z);
    bool y_longest = !x_longest & (along_y >= along_z);
    /* The axes in cyclic order, so that z is the one along which the ray runs most. */
    real ex = x_longest ? dy : y_longest ? dz : dx;
    real ey = x_longest ? dz : y_longest ? dx : dy;
    real ez = x_longest ? dx : y_longest ? dy : dz;
    real shear_x = ex / ez, shear_y = ey / ez;
    const real3 vertices[3] = {v0, v1, v2};
    real x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        real3 v = vertices[i];
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

static inline real zt_triangle_distance(const zt_primitive *p, real ox, real oy, real oz,
                                        real dx, real dy, real dz, int32_t leaving, real near) {
    const real3 *v = p->triangle.vertices;
    real t = zt_triangle_meet(v[0], v[1], v[2], ox, oy, oz, dx, dy, dz);
    return ((t > near) & (leaving == 0)) ? t : REAL_INFINITY;
}

/* A solid's: the ray is taken to its space, where distances along it stay what they are. */
#define ZT_SOLID_DISTANCE(kind)                                                                \
    static inline real zt_##kind##_distance(const zt_primitive *p, real ox, real oy, real oz,  \
                                            real dx, real dy, real dz, int32_t leaving,        \
                                            real near) {                                       \
        const real3 *m = p->solid.rows;                                                        \
        real3 c = p->solid.center;                                                             \
        real gx = ox - c.x, gy = oy - c.y, gz = oz - c.z;                                      \
        return zt_##kind##_meet(real_dot(m[0].x, m[0].y, m[0].z, gx, gy, gz),                  \
                                real_dot(m[1].x, m[1].y, m[1].z, gx, gy, gz),                  \
                                real_dot(m[2].x, m[2].y, m[2].z, gx, gy, gz),                  \
                                real_dot(m[0].x, m[0].y, m[0].z, dx, dy, dz),                  \
                                real_dot(m[1].x, m[1].y, m[1].z, dx, dy, dz),                  \
                                real_dot(m[2].x, m[2].y, m[2].z, dx, dy, dz), p->solid.a,      \
                                p->solid.b, leaving, near);                                    \
    }
ZT_SOLID_DISTANCE(ball)
ZT_SOLID_DISTANCE(disk)
ZT_SOLID_DISTANCE(box)
ZT_SOLID_DISTANCE(cylinder)
ZT_SOLID_DISTANCE(cone)
ZT_SOLID_DISTANCE(capsule)
ZT_SOLID_DISTANCE(torus)

#endif
