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
        real along_x = real_abs(dx[i]), along_y = real_abs(dy[i]), along_z = real_abs(dz[i]);
        bool x = (along_x >= along_y) & (along_x >= along_z);
        bool y = !x & (along_y >= along_z);
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

/* The same of products that are rounded first, which never changes the sign of their difference
 * to the opposite: lets through all that the exact ones let through, and few others. */
static inline bool about_one_side(real x0, real y0, real x1, real y1, real x2, real y2) {
    real u = x1 * y2 - y1 * x2, v = x2 * y0 - y2 * x0, w = x0 * y1 - y0 * x1;
    int above = real_min(real_min(u, v), w) >= 0, below = real_max(real_max(u, v), w) <= 0;
    return above | below;
}

/* Where ray number i meets triangle number k of a cluster, in (0, *t], `*triangle` being that
 * which is at *t already, or -1: sets both and returns true where this one counts first. */
static inline bool settle(real *t, int32_t *triangle, const zt_cluster *cluster, int k,
                          const zt_leaning_rays *rays, int i) {
    int axis = rays->axis[i], first = axis == 2 ? 0 : axis + 1,
        second = axis == 0 ? 2 : axis - 1;
    real x[3], y[3], z[3];
    for (int corner = 0; corner < 3; corner++) {
        z[corner] = (real)cluster->corners[corner][axis][k] - rays->o[2][i];
        x[corner] = ((real)cluster->corners[corner][first][k] - rays->o[0][i]) -
                    rays->lean[0][i] * z[corner];
        y[corner] = ((real)cluster->corners[corner][second][k] - rays->o[1][i]) -
                    rays->lean[1][i] * z[corner];
    }
    double u = real_products(x[1], y[2], y[1], x[2]);
    double v = real_products(x[2], y[0], y[2], x[0]);
    double w = real_products(x[0], y[1], y[0], x[1]);
    double area = u + v + w;
    double depth = (u * (double)z[0] + v * (double)z[1] + w * (double)z[2]) / area;
    real at = (real)(depth * (double)rays->inverse[i]);
    int32_t index = cluster->triangles[k];
    if (!(one_side(u, v, w) & (area != 0) & (at > 0))) return false;
    if (!((at < *t) | ((at == *t) & ((*triangle < 0) | (index < *triangle))))) return false;
    *t = at;
    *triangle = index;
    return true;
}

/* The nearest triangle of a cluster that ray number i meets in (0, *t], as above: all triangles
 * at a time. */
static inline bool zt_meet_cluster(real *t, int32_t *triangle, const zt_cluster *cluster,
                                   const zt_leaning_rays *rays, int i) {
    int axis = rays->axis[i], first = axis == 2 ? 0 : axis + 1,
        second = axis == 0 ? 2 : axis - 1;
    real a = rays->o[0][i], b = rays->o[1][i], c = rays->o[2][i];
    real lean_a = rays->lean[0][i], lean_b = rays->lean[1][i];
    uint32_t inside = 0; /* bit k: triangle k */
    const float *x0 = cluster->corners[0][first], *x1 = cluster->corners[1][first],
                *x2 = cluster->corners[2][first];
    const float *y0 = cluster->corners[0][second], *y1 = cluster->corners[1][second],
                *y2 = cluster->corners[2][second];
    const float *z0 = cluster->corners[0][axis], *z1 = cluster->corners[1][axis],
                *z2 = cluster->corners[2][axis];
    for (int k = 0; k < ZT_CLUSTER; k++) {
        real d0 = (real)z0[k] - c, d1 = (real)z1[k] - c, d2 = (real)z2[k] - c;
        bool in =
            about_one_side(((real)x0[k] - a) - lean_a * d0, ((real)y0[k] - b) - lean_b * d0,
                           ((real)x1[k] - a) - lean_a * d1, ((real)y1[k] - b) - lean_b * d1,
                           ((real)x2[k] - a) - lean_a * d2, ((real)y2[k] - b) - lean_b * d2);
        inside |= -(uint32_t)in & 1u << k;
    }
    bool found = false;
    for (; inside; inside &= inside - 1)
        found |= settle(t, triangle, cluster, __builtin_ctz(inside), rays, i);
    return found;
}

/* The same for the rays begin … begin + 15 whose bits are set in `lanes`, which all run along
 * one axis most: one triangle after the other, all rays at a time. t and triangle are of ray
 * number 0. Returns the bits of those for which something is found. */
static inline uint32_t zt_meet_cluster_lanes(real *t, int32_t *triangle,
                                             const zt_cluster *cluster,
                                             const zt_leaning_rays *rays, int begin,
                                             uint32_t lanes) {
    int axis = rays->axis[begin + __builtin_ctz(lanes)], first = axis == 2 ? 0 : axis + 1,
        second = axis == 0 ? 2 : axis - 1;
    const real *restrict a = rays->o[0] + begin, *restrict b = rays->o[1] + begin,
                         *restrict c = rays->o[2] + begin;
    const real *restrict lean_a = rays->lean[0] + begin, *restrict lean_b =
                                                             rays->lean[1] + begin;
    _Alignas(64) int32_t inside[ZT_BVH_LANES] = {0}; /* bit k: triangle k */
    for (int k = 0; k < ZT_CLUSTER; k++) {
        const real x0 = (real)cluster->corners[0][first][k],
                   x1 = (real)cluster->corners[1][first][k],
                   x2 = (real)cluster->corners[2][first][k];
        const real y0 = (real)cluster->corners[0][second][k],
                   y1 = (real)cluster->corners[1][second][k],
                   y2 = (real)cluster->corners[2][second][k];
        const real z0 = (real)cluster->corners[0][axis][k],
                   z1 = (real)cluster->corners[1][axis][k],
                   z2 = (real)cluster->corners[2][axis][k];
        const int32_t bit = 1 << k;
        WIDE_LOOP for (int l = 0; l < ZT_BVH_LANES; l++) {
            real d0 = z0 - c[l], d1 = z1 - c[l], d2 = z2 - c[l];
            bool in =
                about_one_side((x0 - a[l]) - lean_a[l] * d0, (y0 - b[l]) - lean_b[l] * d0,
                               (x1 - a[l]) - lean_a[l] * d1, (y1 - b[l]) - lean_b[l] * d1,
                               (x2 - a[l]) - lean_a[l] * d2, (y2 - b[l]) - lean_b[l] * d2);
            inside[l] |= -in & bit;
        }
    }
    uint32_t some = 0, found = 0;
    for (int l = 0; l < ZT_BVH_LANES; l++) some |= -(uint32_t)(inside[l] != 0) & 1u << l;
    for (lanes &= some; lanes; lanes &= lanes - 1) {
        int l = __builtin_ctz(lanes), i = begin + l;
        for (int32_t left = inside[l]; left; left &= left - 1)
            if (settle(&t[i], &triangle[i], cluster, __builtin_ctz((unsigned)left), rays, i))
                found |= 1u << l;
    }
    return found;
}

/* Whether the rays begin … begin + 15 run along one axis most. */
static inline bool zt_lean_alike(const zt_leaning_rays *rays, int begin) {
    int32_t axis = rays->axis[begin], others = 0;
    for (int l = 1; l < ZT_BVH_LANES; l++) others |= rays->axis[begin + l] ^ axis;
    return !others;
}

#endif
