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

/* The same of products that are rounded first, which never changes the sign of their difference
 * to the opposite: lets through all that the exact ones let through, and few others. */
static inline bool about_one_side(const real *x, const real *y) {
    real u = x[1] * y[2] - y[1] * x[2];
    real v = x[2] * y[0] - y[2] * x[0];
    real w = x[0] * y[1] - y[0] * x[1];
    return ((u >= 0) & (v >= 0) & (w >= 0)) | ((u <= 0) & (v <= 0) & (w <= 0));
}

/* Where a ray meets one leaning triangle, in (0, *t], `*triangle` being that which is at *t
 * already, or -1: sets both and returns true where this one, `index`, counts before it. The
 * products of single precision are exact in double. */
static inline bool settle(real *t, int32_t *triangle, const real *x, const real *y,
                          const real *z, real inverse, int32_t index) {
    double u = (double)x[1] * (double)y[2] - (double)y[1] * (double)x[2];
    double v = (double)x[2] * (double)y[0] - (double)y[2] * (double)x[0];
    double w = (double)x[0] * (double)y[1] - (double)y[0] * (double)x[1];
    double area = u + v + w;
    double depth = (u * (double)z[0] + v * (double)z[1] + w * (double)z[2]) / area;
    real at = (real)(depth * (double)inverse);
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
        inside[k] = about_one_side((real[3]){x[0][k], x[1][k], x[2][k]},
                                   (real[3]){y[0][k], y[1][k], y[2][k]});
        any |= inside[k];
    }
    if (!any) return false;
    bool found = false;
    for (int k = 0; k < ZT_CLUSTER; k++)
        if (inside[k])
            found |= settle(t, triangle, (real[3]){x[0][k], x[1][k], x[2][k]},
                            (real[3]){y[0][k], y[1][k], y[2][k]},
                            (real[3]){z[0][k], z[1][k], z[2][k]}, rays->inverse[i],
                            cluster->triangles[k]);
    return found;
}

/* The same for the rays first … first + 15 whose bits are set in `lanes`, which all run along
 * one axis most: one triangle after the other, all rays at a time. t and triangle are of ray
 * number 0. Returns the bits of those for which something is found. */
static inline uint32_t zt_meet_cluster_lanes(real *t, int32_t *triangle,
                                             const zt_cluster *cluster,
                                             const zt_leaning_rays *rays, int begin,
                                             uint32_t lanes) {
    enum { LANES = ZT_BVH_LANES };
    int axis = rays->axis[begin + __builtin_ctz(lanes)], first = axis == 2 ? 0 : axis + 1,
        second = axis == 0 ? 2 : axis - 1;
    const real *restrict a = rays->o[0] + begin, *restrict b = rays->o[1] + begin,
                         *restrict c = rays->o[2] + begin;
    const real *restrict lean_a = rays->lean[0] + begin, *restrict lean_b =
                                                             rays->lean[1] + begin;
    uint32_t found = 0;
    for (int k = 0; k < ZT_CLUSTER; k++) {
        _Alignas(64) real x[3][LANES];
        _Alignas(64) real y[3][LANES];
        _Alignas(64) real z[3][LANES];
        _Alignas(64) int32_t inside[LANES];
        for (int corner = 0; corner < 3; corner++) {
            const real px = (real)cluster->corners[corner][first][k],
                       py = (real)cluster->corners[corner][second][k],
                       pz = (real)cluster->corners[corner][axis][k];
            WIDE_LOOP for (int l = 0; l < LANES; l++) {
                z[corner][l] = pz - c[l];
                x[corner][l] = (px - a[l]) - lean_a[l] * z[corner][l];
                y[corner][l] = (py - b[l]) - lean_b[l] * z[corner][l];
            }
        }
        WIDE_LOOP for (int l = 0; l < LANES; l++)
            inside[l] = about_one_side((real[3]){x[0][l], x[1][l], x[2][l]},
                                       (real[3]){y[0][l], y[1][l], y[2][l]})
                        << l;
        uint32_t set = 0;
        for (int l = 0; l < LANES; l++) set |= (uint32_t)inside[l];
        for (set &= lanes; set; set &= set - 1) {
            int l = __builtin_ctz(set);
            found |= (uint32_t)settle(t + begin + l, triangle + begin + l,
                                      (real[3]){x[0][l], x[1][l], x[2][l]},
                                      (real[3]){y[0][l], y[1][l], y[2][l]},
                                      (real[3]){z[0][l], z[1][l], z[2][l]},
                                      rays->inverse[begin + l], cluster->triangles[k])
                     << l;
        }
    }
    return found;
}

/* Whether the rays first … first + 15 whose bits are set run along one axis most. */
static inline bool zt_lean_alike(const zt_leaning_rays *rays, int begin, uint32_t lanes) {
    int32_t axis = rays->axis[begin + __builtin_ctz(lanes)], others = 0;
    for (uint32_t set = lanes; set; set &= set - 1)
        others |= rays->axis[begin + __builtin_ctz(set)] ^ axis;
    return !others;
}

#endif
