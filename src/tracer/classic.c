/* The classic integrator. A step of its loop: intersect the batch, gather what it hit, light
 * it, mirror it, again. Compiled once for each width of instructions (tracer/isa.h). */
#include "tracer/classic.h"

#include <math.h>
#include <string.h>

#include "tracer/intersect.h"
#include "tracer/isa.h"

#define intersect ZT_ISA_NAME(zt_intersect)
#define occlude   ZT_ISA_NAME(zt_occlude)

/* A point is projected onto its surface, which leaves a few roundings of the largest number in
 * the arithmetic between the two; the next ray's own intersection adds about as many again.
 * Twice what they sum up to (16) is a bound that holds for planes, spheres and triangles. */
#define MARGIN_ROUNDINGS 32

zt_classic_trace ZT_ISA_NAME(zt_classic_trace);

/* Loops run over whole groups of lanes: what lies beyond the count is computed and never used,
 * but must be safe to compute. */

/* Compacts, of `count` numbers 0, 1, …, those that are wanted; the rest of the last group of
 * lanes repeats the first. */
static int list_wanted(int32_t *restrict list, const int32_t *restrict wanted, int count) {
    int listed = 0;
    for (int i = 0; i < count; i++) {
        list[listed] = i;
        listed += wanted[i];
    }
    for (int i = listed; i < zt_batch_padded(listed); i++) list[i] = list[0];
    return listed;
}

static inline void gather_hit(zt_classic_work *restrict w, int k, const zt_batch *restrict rays,
                              int i) {
    real t = rays->t[i], dx = rays->dx[i], dy = rays->dy[i], dz = rays->dz[i];
    int32_t hit = rays->hit[i];
    w->primitive[k] = hit > 0 ? hit : 0;
    w->part[k] = rays->part[i];
    w->dx[k] = dx;
    w->dy[k] = dy;
    w->dz[k] = dz;
    w->px[k] = rays->ox[i] + t * dx;
    w->py[k] = rays->oy[i] + t * dy;
    w->pz[k] = rays->oz[i] + t * dz;
}

/* Gathers the rays that hit something into the points. `pixel` and `weight` of the work belong
 * to the rays before, to the points after. */
static void gather_hits(zt_classic_work *restrict w, const zt_batch *restrict rays) {
    int padded = zt_batch_padded(rays->count), missed = 0;
    WIDE_LOOP for (int i = 0; i < padded; i++) w->wanted[i] = rays->hit[i] >= 0;
    for (int i = 0; i < rays->count; i++) missed |= !w->wanted[i];
    w->count = rays->count;
    if (!missed) {
        WIDE_LOOP for (int i = 0; i < padded; i++) gather_hit(w, i, rays, i);
        return;
    }
    w->count = list_wanted(w->list, w->wanted, rays->count);
    for (int k = 0; k < w->count; k++) {
        int i = w->list[k]; /* i >= k, so compacting in place overwrites nothing still wanted */
        w->pixel[k] = w->pixel[i];
        w->weight[k] = w->weight[i];
    }
    padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) gather_hit(w, k, rays, w->list[k]);
}

/* The normal and the corrected position of point k, of a kind of which a zt_surface says all. A
 * row of zeros leaves the position as it is. */
static inline void find_surface(zt_classic_work *restrict w, int k, const zt_surface *s) {
    real qx = w->px[k] - s->center.x, qy = w->py[k] - s->center.y, qz = w->pz[k] - s->center.z;
    real nx = s->normal.x + s->bend * qx, ny = s->normal.y + s->bend * qy,
         nz = s->normal.z + s->bend * qz;
    real unit = 1 / sqrtf(real_max(real_dot(nx, ny, nz, nx, ny, nz), 1e-30f));
    nx *= unit;
    ny *= unit;
    nz *= unit;
    real off = real_dot(nx, ny, nz, qx, qy, qz) - s->level;
    w->px[k] -= off * nx;
    w->py[k] -= off * ny;
    w->pz[k] -= off * nz;
    w->nx[k] = nx;
    w->ny[k] = ny;
    w->nz[k] = nz;
    w->margin[k] = s->extent;
    w->color_r[k] = s->color.x;
    w->color_g[k] = s->color.y;
    w->color_b[k] = s->color.z;
    w->reflectivity[k] = s->reflectivity;
}

/* All points; where they lie on one primitive, as most of a tile's do, nothing is gathered. */
static void find_surfaces(zt_classic_work *restrict w, const zt_tracer *tracer) {
    int32_t first = w->primitive[0], others = 0;
    int padded = zt_batch_padded(w->count);
    for (int k = 0; k < w->count; k++) others |= w->primitive[k] ^ first;
    if (others) {
        WIDE_LOOP for (int k = 0; k < padded; k++)
            find_surface(w, k, &tracer->surfaces[w->primitive[k]]);
    } else if (w->count > 0) {
        const zt_surface only = tracer->surfaces[first];
        WIDE_LOOP for (int k = 0; k < padded; k++) find_surface(w, k, &only);
    }
}

/* The same for an ellipsoid: with f(p) = |M (p - c)|^2 - 1 the normal is along the gradient g
 * of f / 2, and f / (2 |g|) is the distance to first order. */
static void find_ellipsoid(zt_classic_work *w, int k, const zt_primitive *p) {
    const real3 *m = p->ellipsoid.to_unit;
    double q[3] = {(double)w->px[k] - (double)p->ellipsoid.center.x,
                   (double)w->py[k] - (double)p->ellipsoid.center.y,
                   (double)w->pz[k] - (double)p->ellipsoid.center.z};
    double g[3] = {0, 0, 0}, f = -1;
    for (int i = 0; i < 3; i++) {
        double e = (double)m[i].x * q[0] + (double)m[i].y * q[1] + (double)m[i].z * q[2];
        f += e * e;
        g[0] += e * (double)m[i].x;
        g[1] += e * (double)m[i].y;
        g[2] += e * (double)m[i].z;
    }
    double length2 = g[0] * g[0] + g[1] * g[1] + g[2] * g[2], unit = 1 / sqrt(length2);
    double step = f / (2 * length2);
    w->px[k] = (real)((double)w->px[k] - step * g[0]);
    w->py[k] = (real)((double)w->py[k] - step * g[1]);
    w->pz[k] = (real)((double)w->pz[k] - step * g[2]);
    w->nx[k] = (real)(g[0] * unit);
    w->ny[k] = (real)(g[1] * unit);
    w->nz[k] = (real)(g[2] * unit);
}

/* The same for a triangle of a mesh. */
static void find_mesh(zt_classic_work *w, int k, const zt_meshes *meshes) {
    real3 normal, corner;
    real extent;
    zt_meshes_surface(&normal, &corner, &extent, meshes, w->primitive[k], w->part[k]);
    real off = real_dot(normal.x, normal.y, normal.z, w->px[k] - corner.x, w->py[k] - corner.y,
                        w->pz[k] - corner.z);
    w->px[k] -= off * normal.x;
    w->py[k] -= off * normal.y;
    w->pz[k] -= off * normal.z;
    w->nx[k] = normal.x;
    w->ny[k] = normal.y;
    w->nz[k] = normal.z;
    w->margin[k] = extent;
}

/* Points of the kinds that need more than a zt_surface. */
static void find_other_surfaces(zt_classic_work *w, const zt_tracer *tracer) {
    for (int k = 0; k < w->count; k++) {
        const zt_primitive *p = &tracer->primitives[w->primitive[k]];
        if (p->kind == ZT_PRIMITIVE_MESH)
            find_mesh(w, k, tracer->meshes);
        else if (p->kind == ZT_PRIMITIVE_ELLIPSOID)
            find_ellipsoid(w, k, p);
    }
}

/* Turns the normals to the side that the rays came from, makes the margin a length, and begins
 * the sum of light with the ambient. */
static void face_rays(zt_classic_work *restrict w, real3 ambient) {
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        real nx = w->nx[k], ny = w->ny[k], nz = w->nz[k];
        bool away = real_dot(nx, ny, nz, w->dx[k], w->dy[k], w->dz[k]) > 0;
        w->nx[k] = away ? -nx : nx;
        w->ny[k] = away ? -ny : ny;
        w->nz[k] = away ? -nz : nz;
        real coordinate = real_max(real_max(fabsf(w->px[k]), fabsf(w->py[k])), fabsf(w->pz[k]));
        w->margin[k] = (coordinate + w->margin[k]) * (MARGIN_ROUNDINGS * REAL_ROUNDING);
        w->sum_r[k] = ambient.x * w->color_r[k];
        w->sum_g[k] = ambient.y * w->color_g[k];
        w->sum_b[k] = ambient.z * w->color_b[k];
    }
}

/* Cuts to 0..1; what is no number becomes 0. */
static real cut(real x) {
    real low = x > 0 ? x : 0;
    return low < 1 ? low : 1;
}

/* What a lamp gives each point where nothing is in between; false where it gives nothing to
 * any. */
static bool shine(zt_classic_work *restrict w, const zt_lamp *lamp) {
    const real3 at = lamp->position, power = lamp->power;
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        real vx = at.x - w->px[k], vy = at.y - w->py[k], vz = at.z - w->pz[k];
        real toward = real_dot(w->nx[k], w->ny[k], w->nz[k], vx, vy, vz);
        real near = 1 / sqrtf(real_dot(vx, vy, vz, vx, vy, vz)); /* one over the distance */
        real fade = toward * near * near * near;
        fade = toward > 0 ? fade : 0;
        real r = cut(power.x * fade * w->color_r[k]);
        real g = cut(power.y * fade * w->color_g[k]);
        real b = cut(power.z * fade * w->color_b[k]);
        w->lamp_r[k] = r;
        w->lamp_g[k] = g;
        w->lamp_b[k] = b;
        w->wanted[k] = r + g + b > 0;
    }
    int32_t any = 0;
    for (int k = 0; k < w->count; k++) any |= w->wanted[k];
    return any;
}

/* Makes the shadow rays of all points: those that get no light look no distance, and meet
 * nothing. */
static void aim_at_lamp(zt_classic_work *restrict w, const zt_lamp *lamp) {
    zt_batch *restrict shadow = &w->shadow;
    const real3 at = lamp->position;
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        real ox = w->px[k] + w->margin[k] * w->nx[k], oy = w->py[k] + w->margin[k] * w->ny[k],
             oz = w->pz[k] + w->margin[k] * w->nz[k];
        real vx = at.x - ox, vy = at.y - oy, vz = at.z - oz;
        real distance = sqrtf(real_dot(vx, vy, vz, vx, vy, vz)), near = 1 / distance;
        shadow->ox[k] = ox;
        shadow->oy[k] = oy;
        shadow->oz[k] = oz;
        shadow->dx[k] = vx * near;
        shadow->dy[k] = vy * near;
        shadow->dz[k] = vz * near;
        shadow->t[k] = w->wanted[k] ? distance : 0;
        shadow->hit[k] = -1;
    }
    shadow->count = w->count;
}

/* Adds a lamp's light where nothing hides it. */
static void add_lamp(zt_classic_work *restrict w) {
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        bool open = w->shadow.hit[k] < 0;
        w->sum_r[k] += open ? w->lamp_r[k] : 0;
        w->sum_g[k] += open ? w->lamp_g[k] : 0;
        w->sum_b[k] += open ? w->lamp_b[k] : 0;
    }
}

static void deliver(zt_radiance *restrict light, const zt_classic_work *restrict w) {
    for (int k = 0; k < w->count; k++) {
        int i = w->pixel[k];
        light->r[i] += w->weight[k] * w->sum_r[k];
        light->g[i] += w->weight[k] * w->sum_g[k];
        light->b[i] += w->weight[k] * w->sum_b[k];
    }
}

/* Makes ray j the mirrored one of point k. */
static inline void mirror_ray(zt_batch *restrict rays, int j, const zt_classic_work *restrict w,
                              int k) {
    real nx = w->nx[k], ny = w->ny[k], nz = w->nz[k];
    real twice = -2 * real_dot(nx, ny, nz, w->dx[k], w->dy[k], w->dz[k]);
    real dx = w->dx[k] + twice * nx, dy = w->dy[k] + twice * ny, dz = w->dz[k] + twice * nz;
    real unit = 1 / sqrtf(real_dot(dx, dy, dz, dx, dy, dz));
    rays->ox[j] = w->px[k] + w->margin[k] * nx;
    rays->oy[j] = w->py[k] + w->margin[k] * ny;
    rays->oz[j] = w->pz[k] + w->margin[k] * nz;
    rays->dx[j] = dx * unit;
    rays->dy[j] = dy * unit;
    rays->dz[j] = dz * unit;
}

/* Makes the mirrored rays of the points that reflect the next batch. */
static void mirror(zt_batch *restrict rays, zt_classic_work *restrict w) {
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) w->wanted[k] = w->reflectivity[k] > 0;
    rays->count = list_wanted(w->list, w->wanted, w->count);
    bool all = rays->count == w->count;
    for (int j = 0; j < rays->count; j++) {
        int k = w->list[j];
        w->pixel[j] = w->pixel[k];
        w->weight[j] = w->weight[k] * w->reflectivity[k];
    }
    padded = zt_batch_padded(rays->count);
    if (all) {
        WIDE_LOOP for (int j = 0; j < padded; j++) mirror_ray(rays, j, w, j);
    } else {
        WIDE_LOOP for (int j = 0; j < padded; j++) mirror_ray(rays, j, w, w->list[j]);
    }
}

void ZT_ISA_NAME(zt_classic_trace)(zt_radiance *light, const zt_tracer *tracer, zt_batch *rays,
                                   zt_classic_work *work) {
    memset(light, 0, sizeof *light);
    for (int i = 0; i < rays->count; i++) {
        work->pixel[i] = i;
        work->weight[i] = 1;
    }
    for (int32_t depth = 0; rays->count > 0; depth++) {
        intersect(rays, tracer);
        gather_hits(work, rays);
        find_surfaces(work, tracer);
        if (tracer->has_other_surfaces) find_other_surfaces(work, tracer);
        face_rays(work, tracer->ambient);
        for (int32_t i = 0; i < tracer->lamp_count; i++) {
            const zt_lamp *lamp = &tracer->lamps[i];
            if (!shine(work, lamp)) continue;
            aim_at_lamp(work, lamp);
            if (lamp->shadows) occlude(&work->shadow, tracer);
            add_lamp(work);
        }
        deliver(light, work);
        if (depth >= tracer->reflection_depth) break;
        mirror(rays, work);
    }
}
