/* Where one ray meets the triangles of a cluster. Watertight (Woop, Benthin and Wald,
 * "Watertight ray/triangle intersection", JCGT 2(1), 2013): space is sheared so that the ray
 * runs along an axis through the origin, the same for all triangles; what is left is on which
 * side of each edge the origin lies. Edges belong to both of their triangles, so that none is
 * passed by; of hits that are equally near the triangle with the lowest index counts. */
#ifndef ZT_TRACER_TRIANGLES_H
#define ZT_TRACER_TRIANGLES_H

#include <stdbool.h>
#include <stdint.h>

#include "tracer/clusters.h"
#include "tracer/isa.h"
#include "tracer/real.h"

/* Rays o + t d made ready. `axis` (0, 1, 2) is the one that a ray runs along most; o is the
 * origin with the axes in cyclic order, so that this one is last; the others lean by `lean`
 * for each unit of it; inverse is 1 / d along it. */
typedef struct zt_leaning_rays {
    _Alignas(64) real o[3][ZT_BVH_RAYS];
    _Alignas(64) real lean[2][ZT_BVH_RAYS];
    _Alignas(64) real inverse[ZT_BVH_RAYS];
    _Alignas(64) int32_t axis[ZT_BVH_RAYS];
} zt_leaning_rays;

static inline void zt_lean_rays(zt_leaning_rays *rays, const real *ox, const real *oy,
                                const real *oz, const real *dx, const real *dy, const real *dz,
                                int count) {
    WIDE_LOOP
    for (int i = 0; i < count; i++) {
        bool x = (real_abs(dx[i]) >= real_abs(dy[i])) & (real_abs(dx[i]) >= real_abs(dz[i]));
        bool y = !x & (real_abs(dy[i]) >= real_abs(dz[i]));
        real along = x ? dx[i] : y ? dy[i] : dz[i];
        rays->o[0][i] = x ? oy[i] : y ? oz[i] : ox[i];
        rays->o[1][i] = x ? oz[i] : y ? ox[i] : oy[i];
        rays->o[2][i] = x ? ox[i] : y ? oy[i] : oz[i];
        rays->lean[0][i] = (x ? dy[i] : y ? dz[i] : dx[i]) / along;
        rays->lean[1][i] = (x ? dz[i] : y ? dx[i] : dy[i]) / along;
        rays->inverse[i] = 1 / along;
        rays->axis[i] = x ? 0 : y ? 1 : 2;
    }
}

static inline bool one_side(double u, double v, double w) {
    return ((u >= 0) & (v >= 0) & (w >= 0)) | ((u <= 0) & (v <= 0) & (w <= 0));
}

/* The nearest triangle that ray number i meets in (0, *t], `*triangle` being that which is at
 * *t already, or -1: sets both and returns true where there is one that counts before it.
 *
 * In single precision products are first rounded, which never changes the sign of their
 * difference to the opposite; for the few triangles that this lets through they are exact, in
 * double. */
static inline bool zt_meet_cluster(real *t, int32_t *triangle, const zt_cluster *cluster,
                                   const zt_leaning_rays *rays, int i) {
    int axis = rays->axis[i], first = axis == 2 ? 0 : axis + 1,
        second = axis == 0 ? 2 : axis - 1;
    real a = rays->o[0][i], b = rays->o[1][i], c = rays->o[2][i];
    real lean_a = rays->lean[0][i], lean_b = rays->lean[1][i];
    real x[3][ZT_CLUSTER], y[3][ZT_CLUSTER], z[3][ZT_CLUSTER];
    int32_t inside[ZT_CLUSTER], any = 0;
    for (int corner = 0; corner < 3; corner++) {
        const float *px = cluster->corners[corner][first];
        const float *py = cluster->corners[corner][second];
        const float *pz = cluster->corners[corner][axis];
        for (int k = 0; k < ZT_CLUSTER; k++) {
            z[corner][k] = (real)pz[k] - c;
            x[corner][k] = ((real)px[k] - a) - lean_a * z[corner][k];
            y[corner][k] = ((real)py[k] - b) - lean_b * z[corner][k];
        }
    }
    for (int k = 0; k < ZT_CLUSTER; k++) {
        real u = x[1][k] * y[2][k] - y[1][k] * x[2][k];
        real v = x[2][k] * y[0][k] - y[2][k] * x[0][k];
        real w = x[0][k] * y[1][k] - y[0][k] * x[1][k];
        inside[k] = ((u >= 0) & (v >= 0) & (w >= 0)) | ((u <= 0) & (v <= 0) & (w <= 0));
        any |= inside[k];
    }
    if (!any) return false;
    bool found = false;
    for (int k = 0; k < ZT_CLUSTER; k++) {
        if (!inside[k]) continue;
        double u = (double)x[1][k] * (double)y[2][k] - (double)y[1][k] * (double)x[2][k];
        double v = (double)x[2][k] * (double)y[0][k] - (double)y[2][k] * (double)x[0][k];
        double w = (double)x[0][k] * (double)y[1][k] - (double)y[0][k] * (double)x[1][k];
        double area = u + v + w;
        double depth = (u * (double)z[0][k] + v * (double)z[1][k] + w * (double)z[2][k]) / area;
        real at = (real)(depth * (double)rays->inverse[i]);
        if (!(one_side(u, v, w) & (area != 0) & (at > 0))) continue;
        int32_t index = cluster->triangles[k];
        if (!((at < *t) | ((at == *t) & ((*triangle < 0) | (index < *triangle))))) continue;
        *t = at;
        *triangle = index;
        found = true;
    }
    return found;
}

#endif
