/* The surfaces of solids near points. Included by kernels. */
#ifndef ZT_TRACER_POINTS_SOLIDS_H
#define ZT_TRACER_POINTS_SOLIDS_H

#include "tracer/points.h"

/* A number for each of the faces of a solid that meet at edges. */
static inline int32_t zt_face_number(zt_face f, zt_primitive_kind kind) {
    bool cornered = kind == ZT_PRIMITIVE_BOX;
    bool edged = cornered || kind == ZT_PRIMITIVE_CYLINDER || kind == ZT_PRIMITIVE_CONE;
    int32_t end = f.nz > 0 ? 1 : 2, side = f.nx > 0 ? 3 : f.nx < 0 ? 4 : f.ny > 0 ? 5 : 6;
    bool flat = (f.nx == 0) & (f.ny == 0);
    return !edged ? 0 : flat ? end : cornered ? side : 0;
}

/* Finds the normal at point k of a solid with the rows x, y and z, and corrects the position:
 * with its own space's distance f and normal n there, the gradient of the distance is g = M^T
 * n, and one step of Newton's, f / |g|^2 g, leads onto the surface. */
#define ZT_FIND_SOLID(kind, KIND)                                                              \
    static inline void zt_find_##kind(zt_points *restrict w, zt_origins *restrict from, int k, \
                                      real3 rx, real3 ry, real3 rz, real3 center, real a,      \
                                      real b) {                                                \
        real gx = from->x[k] - center.x, gy = from->y[k] - center.y,                           \
             gz = from->z[k] - center.z;                                                       \
        const zt_rows m = {rx, ry, rz};                                                        \
        zt_face f = zt_##kind##_surface(real_dot(rx.x, rx.y, rx.z, gx, gy, gz),                \
                                        real_dot(ry.x, ry.y, ry.z, gx, gy, gz),                \
                                        real_dot(rz.x, rz.y, rz.z, gx, gy, gz), a, b, &m);     \
        real3 g = zt_gradient(&m, f.nx, f.ny, f.nz);                                           \
        real nx = g.x, ny = g.y, nz = g.z;                                                     \
        real unit = 1 / real_sqrt(real_dot(nx, ny, nz, nx, ny, nz)), step = f.off * unit;      \
        nx *= unit;                                                                            \
        ny *= unit;                                                                            \
        nz *= unit;                                                                            \
        from->x[k] -= step * nx;                                                               \
        from->y[k] -= step * ny;                                                               \
        from->z[k] -= step * nz;                                                               \
        w->nx[k] = nx;                                                                         \
        w->ny[k] = ny;                                                                         \
        w->nz[k] = nz;                                                                         \
        w->face[k] = zt_face_number(f, ZT_PRIMITIVE_##KIND);                                   \
    }
ZT_FIND_SOLID(ball, BALL)
ZT_FIND_SOLID(disk, DISK)
ZT_FIND_SOLID(box, BOX)
ZT_FIND_SOLID(cylinder, CYLINDER)
ZT_FIND_SOLID(cone, CONE)
ZT_FIND_SOLID(capsule, CAPSULE)
ZT_FIND_SOLID(torus, TORUS)

#endif
