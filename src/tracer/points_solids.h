/* The surfaces of solids near points. Included by kernels. */
#ifndef ZT_TRACER_POINTS_SOLIDS_H
#define ZT_TRACER_POINTS_SOLIDS_H

#include "tracer/points.h"

/* Finds the normal at point k of a solid with the rows x, y and z, and corrects the position:
 * with its own space's distance f and normal n there, the gradient of the distance is g = M^T
 * n, and one step of Newton's, f / |g|^2 g, leads onto the surface. */
#define ZT_FIND_SOLID(kind)                                                                    \
    static inline void zt_find_##kind(zt_points *restrict w, zt_origins *restrict from, int k, \
                                      real3 rx, real3 ry, real3 rz, real3 center, real a,      \
                                      real b) {                                                \
        real gx = from->x[k] - center.x, gy = from->y[k] - center.y,                           \
             gz = from->z[k] - center.z;                                                       \
        zt_face f = zt_##kind##_surface(real_dot(rx.x, rx.y, rx.z, gx, gy, gz),                \
                                        real_dot(ry.x, ry.y, ry.z, gx, gy, gz),                \
                                        real_dot(rz.x, rz.y, rz.z, gx, gy, gz), a, b);         \
        real nx = rx.x * f.nx + ry.x * f.ny + rz.x * f.nz;                                     \
        real ny = rx.y * f.nx + ry.y * f.ny + rz.y * f.nz;                                     \
        real nz = rx.z * f.nx + ry.z * f.ny + rz.z * f.nz;                                     \
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
    }
ZT_FIND_SOLID(ball)
ZT_FIND_SOLID(disk)
ZT_FIND_SOLID(box)
ZT_FIND_SOLID(cylinder)
ZT_FIND_SOLID(cone)
ZT_FIND_SOLID(capsule)
ZT_FIND_SOLID(torus)

#endif
