/* The classic integrator, one source for each width of instructions: CMake compiles it once for
 * each, with ZT_ISA as the ending of its only public name. Loops run over structures of arrays,
 * without branches, so that the compiler makes them as wide as it may; without fused operations
 * and reordering, all widths give the same bits.
 *
 * A step of the loop: intersect the batch, gather what it hit, light it, mirror it, again. */
#include "tracer/classic.h"

#include <math.h>
#include <string.h>

#define PASTE(a, b)    a##b
#define NAME(isa)      PASTE(zt_classic_trace_, isa)
#define WIDE_LOOP      _Pragma("GCC ivdep")
#define ZT_CLASSIC_ISA NAME(ZT_ISA)

/* A point is projected onto its surface, which leaves a few roundings of the largest number in
 * the arithmetic between the two; the next ray's own intersection adds about as many again.
 * Twice what they sum up to (16) is a bound that holds for planes, spheres and triangles. */
#define MARGIN_ROUNDINGS 32

zt_classic_trace ZT_CLASSIC_ISA;

static real real_max(real a, real b) { return a > b ? a : b; }
static real real_min(real a, real b) { return a < b ? a : b; }

/* A loop for each kind of primitive. What is nearer by nothing leaves the earlier hit. */
#define DEFINE_LOOPS(kind)                                                                     \
    static void kind##_intersect(zt_batch *restrict rays, const zt_primitive *p,               \
                                 int32_t index, int count) {                                   \
        WIDE_LOOP for (int i = 0; i < count; i++) {                                            \
            real t = zt_##kind##_distance(p, rays->ox[i], rays->oy[i], rays->oz[i],            \
                                          rays->dx[i], rays->dy[i], rays->dz[i]);              \
            real nearest = rays->t[i];                                                         \
            int32_t hit = rays->hit[i];                                                        \
            rays->t[i] = t < nearest ? t : nearest;                                            \
            rays->hit[i] = t < nearest ? index : hit;                                          \
        }                                                                                      \
    }
DEFINE_LOOPS(plane)
DEFINE_LOOPS(sphere)
DEFINE_LOOPS(ellipsoid)
DEFINE_LOOPS(triangle)

static void intersect_analytic(zt_batch *rays, const zt_tracer *tracer) {
    int count = zt_batch_padded(rays->count);
    for (int32_t index = 0; index < tracer->primitive_count; index++) {
        const zt_primitive *p = &tracer->primitives[index];
        switch (p->kind) {
        case ZT_PRIMITIVE_PLANE:
            plane_intersect(rays, p, index, count);
            break;
        case ZT_PRIMITIVE_SPHERE:
            sphere_intersect(rays, p, index, count);
            break;
        case ZT_PRIMITIVE_ELLIPSOID:
            ellipsoid_intersect(rays, p, index, count);
            break;
        case ZT_PRIMITIVE_TRIANGLE:
            triangle_intersect(rays, p, index, count);
            break;
        case ZT_PRIMITIVE_MESH:
            break;
        }
    }
}

/* ZT_BATCH_LANES rays in the space of a hull: origins, one over directions, how far to look,
 * and how much room the boxes need for the roundings of all that. */
typedef struct lanes {
    alignas(64) real ox[ZT_BATCH_LANES];
    alignas(64) real oy[ZT_BATCH_LANES];
    alignas(64) real oz[ZT_BATCH_LANES];
    alignas(64) real kx[ZT_BATCH_LANES];
    alignas(64) real ky[ZT_BATCH_LANES];
    alignas(64) real kz[ZT_BATCH_LANES];
    alignas(64) real t[ZT_BATCH_LANES];
    alignas(64) real room[ZT_BATCH_LANES];
    alignas(64) int32_t meets[ZT_BATCH_LANES];
} lanes;

static void enter_hull(lanes *restrict l, const zt_batch *restrict rays, int first,
                       const zt_placed_hull *hull) {
    const real3 rx = hull->rows[0], ry = hull->rows[1], rz = hull->rows[2], at = hull->at;
    const real reach = hull->reach, size = hull->size;
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        real ox = rays->ox[first + j], oy = rays->oy[first + j], oz = rays->oz[first + j];
        real dx = rays->dx[first + j], dy = rays->dy[first + j], dz = rays->dz[first + j];
        l->ox[j] = real_dot(rx.x, rx.y, rx.z, ox, oy, oz) + at.x;
        l->oy[j] = real_dot(ry.x, ry.y, ry.z, ox, oy, oz) + at.y;
        l->oz[j] = real_dot(rz.x, rz.y, rz.z, ox, oy, oz) + at.z;
        l->kx[j] = 1 / real_dot(rx.x, rx.y, rx.z, dx, dy, dz);
        l->ky[j] = 1 / real_dot(ry.x, ry.y, ry.z, dx, dy, dz);
        l->kz[j] = 1 / real_dot(rz.x, rz.y, rz.z, dx, dy, dz);
        l->t[j] = rays->t[first + j];
        real largest = real_max(real_max(fabsf(ox), fabsf(oy)), fabsf(oz));
        l->room[j] = 32 * REAL_ROUNDING * (reach * largest + size);
        l->meets[j] = 0;
    }
}

/* Adds to `meets` the rays that meet a box, grown by their room, before their t; a doubt (what
 * is no number compares as false) counts as meeting. Distances to the sides may each be off by
 * a few roundings (Ize, "Robust BVH ray traversal", JCGT 2(2), 2013). */
static inline void meet_box(lanes *restrict l, const zt_box box) {
    const real less = 1 - 16 * REAL_ROUNDING, more = 1 + 16 * REAL_ROUNDING;
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        real room = l->room[j];
        real x0 = (box.low.x - room - l->ox[j]) * l->kx[j];
        real x1 = (box.high.x + room - l->ox[j]) * l->kx[j];
        real y0 = (box.low.y - room - l->oy[j]) * l->ky[j];
        real y1 = (box.high.y + room - l->oy[j]) * l->ky[j];
        real z0 = (box.low.z - room - l->oz[j]) * l->kz[j];
        real z1 = (box.high.z + room - l->oz[j]) * l->kz[j];
        real enter = real_max(real_max(real_min(x0, x1), real_min(y0, y1)), real_min(z0, z1));
        real leave = real_min(real_min(real_max(x0, x1), real_max(y0, y1)), real_max(z0, z1));
        l->meets[j] |=
            !(leave < 0) & !(enter * less > leave * more) & !(enter * less > l->t[j] * more);
    }
}

static inline bool any_meets(const lanes *l) {
    int32_t any = 0;
    for (int j = 0; j < ZT_BATCH_LANES; j++) any |= l->meets[j];
    return any;
}

/* Lists the rays that may meet a mesh before their t; `open_only` leaves out the ones that have
 * met something. */
static int list_mesh_rays(zt_classic_work *restrict w, const zt_batch *restrict rays,
                          const zt_tracer *tracer, bool open_only) {
    const zt_placed_hull *hulls;
    int hull_count = zt_meshes_hulls(&hulls, tracer->meshes), count = 0;
    for (int first = 0; first < rays->count; first += ZT_BATCH_LANES) {
        int32_t meets[ZT_BATCH_LANES] = {0};
        for (int h = 0; h < hull_count; h++) {
            lanes l;
            enter_hull(&l, rays, first, &hulls[h]);
            meet_box(&l, *hulls[h].whole);
            if (!any_meets(&l)) continue;
            memset(l.meets, 0, sizeof l.meets);
            for (int b = 0; b < hulls[h].part_count; b++) meet_box(&l, hulls[h].parts[b]);
            for (int j = 0; j < ZT_BATCH_LANES; j++) meets[j] |= l.meets[j];
        }
        for (int j = 0; j < ZT_BATCH_LANES && first + j < rays->count; j++) {
            w->mesh_list[count] = first + j;
            count += meets[j] & (!open_only | (rays->hit[first + j] < 0));
        }
    }
    return count;
}

/* Gathers the rays that hit something into the points. `pixel` and `weight` of the work belong
 * to the rays before, to the points after. */
static void gather_hits(zt_classic_work *w, const zt_batch *rays) {
    int count = 0;
    for (int i = 0; i < rays->count; i++) {
        w->list[count] = i;
        count += rays->hit[i] >= 0;
    }
    for (int k = 0; k < count; k++) {
        int i = w->list[k]; /* i >= k, so compacting in place overwrites nothing still wanted */
        w->pixel[k] = w->pixel[i];
        w->weight[k] = w->weight[i];
    }
    WIDE_LOOP for (int k = 0; k < count; k++) {
        int i = w->list[k];
        real t = rays->t[i], dx = rays->dx[i], dy = rays->dy[i], dz = rays->dz[i];
        w->primitive[k] = rays->hit[i];
        w->part[k] = rays->part[i];
        w->dx[k] = dx;
        w->dy[k] = dy;
        w->dz[k] = dz;
        w->px[k] = rays->ox[i] + t * dx;
        w->py[k] = rays->oy[i] + t * dy;
        w->pz[k] = rays->oz[i] + t * dz;
    }
    w->count = count;
}

/* The normal and the corrected position of point k, of a kind of which a zt_surface says all.
 */
static inline void find_surface(zt_classic_work *restrict w, int k, const zt_surface *s) {
    real qx = w->px[k] - s->center.x, qy = w->py[k] - s->center.y, qz = w->pz[k] - s->center.z;
    real nx = s->normal.x + s->bend * qx, ny = s->normal.y + s->bend * qy,
         nz = s->normal.z + s->bend * qz;
    real unit = 1 / sqrtf(real_dot(nx, ny, nz, nx, ny, nz));
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
    WIDE_LOOP for (int k = 0; k < w->count; k++) others |= w->primitive[k] ^ first;
    if (others) {
        WIDE_LOOP for (int k = 0; k < w->count; k++)
            find_surface(w, k, &tracer->surfaces[w->primitive[k]]);
    } else if (w->count > 0) {
        const zt_surface only = tracer->surfaces[first];
        WIDE_LOOP for (int k = 0; k < w->count; k++) find_surface(w, k, &only);
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

/* Points of the kinds that need more than a zt_surface. Their position is computed anew, for
 * the loop above has spoilt it. */
static void find_other_surfaces(zt_classic_work *w, const zt_tracer *tracer,
                                const zt_batch *rays) {
    for (int k = 0; k < w->count; k++) {
        const zt_primitive *p = &tracer->primitives[w->primitive[k]];
        if (p->kind != ZT_PRIMITIVE_MESH && p->kind != ZT_PRIMITIVE_ELLIPSOID) continue;
        int i = w->list[k];
        w->px[k] = rays->ox[i] + rays->t[i] * rays->dx[i];
        w->py[k] = rays->oy[i] + rays->t[i] * rays->dy[i];
        w->pz[k] = rays->oz[i] + rays->t[i] * rays->dz[i];
        if (p->kind == ZT_PRIMITIVE_MESH)
            find_mesh(w, k, tracer->meshes);
        else
            find_ellipsoid(w, k, p);
    }
}

/* Turns the normals to the side that the rays came from, makes the margin a length, and begins
 * the sum of light with the ambient. */
static void face_rays(zt_classic_work *restrict w, real3 ambient) {
    WIDE_LOOP for (int k = 0; k < w->count; k++) {
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

/* What a lamp gives each point where nothing is in between. */
static void shine(zt_classic_work *restrict w, const zt_lamp *lamp) {
    real3 at = lamp->position, power = lamp->power;
    WIDE_LOOP for (int k = 0; k < w->count; k++) {
        real vx = at.x - w->px[k], vy = at.y - w->py[k], vz = at.z - w->pz[k];
        real square = real_dot(vx, vy, vz, vx, vy, vz);
        real toward = real_dot(w->nx[k], w->ny[k], w->nz[k], vx, vy, vz);
        real fade = toward / sqrtf(square) / square;
        fade = toward > 0 ? fade : 0;
        real r = cut(power.x * fade * w->color_r[k]);
        real g = cut(power.y * fade * w->color_g[k]);
        real b = cut(power.z * fade * w->color_b[k]);
        w->lamp_r[k] = r;
        w->lamp_g[k] = g;
        w->lamp_b[k] = b;
        w->lit[k] = r + g + b > 0;
    }
}

/* Takes a lamp's light from the points that something hides from it. */
static void cast_shadows(zt_classic_work *restrict w, const zt_tracer *tracer,
                         const zt_lamp *lamp) {
    int count = 0;
    for (int k = 0; k < w->count; k++) {
        w->list[count] = k;
        count += w->lit[k];
    }
    if (count == 0) return;
    zt_batch *restrict shadow = &w->shadow;
    real3 at = lamp->position;
    WIDE_LOOP for (int j = 0; j < count; j++) {
        int k = w->list[j];
        real ox = w->px[k] + w->margin[k] * w->nx[k], oy = w->py[k] + w->margin[k] * w->ny[k],
             oz = w->pz[k] + w->margin[k] * w->nz[k];
        real vx = at.x - ox, vy = at.y - oy, vz = at.z - oz;
        real distance = sqrtf(real_dot(vx, vy, vz, vx, vy, vz));
        shadow->ox[j] = ox;
        shadow->oy[j] = oy;
        shadow->oz[j] = oz;
        shadow->dx[j] = vx / distance;
        shadow->dy[j] = vy / distance;
        shadow->dz[j] = vz / distance;
        shadow->t[j] = distance;
        shadow->hit[j] = -1;
    }
    shadow->count = count;
    intersect_analytic(shadow, tracer);
    if (tracer->meshes) {
        int mesh_rays = list_mesh_rays(w, shadow, tracer, true);
        zt_meshes_occlude(tracer->meshes, shadow, w->mesh_list, mesh_rays);
    }
    for (int j = 0; j < count; j++) {
        if (shadow->hit[j] < 0) continue;
        int k = w->list[j];
        w->lamp_r[k] = w->lamp_g[k] = w->lamp_b[k] = 0;
    }
}

static void add_lamp(zt_classic_work *restrict w) {
    WIDE_LOOP for (int k = 0; k < w->count; k++) {
        w->sum_r[k] += w->lamp_r[k];
        w->sum_g[k] += w->lamp_g[k];
        w->sum_b[k] += w->lamp_b[k];
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

/* Makes the mirrored rays of the points that reflect the next batch. */
static void mirror(zt_batch *restrict rays, zt_classic_work *restrict w) {
    int count = 0;
    for (int k = 0; k < w->count; k++) {
        w->list[count] = k;
        count += w->reflectivity[k] > 0;
    }
    for (int j = 0; j < count; j++) {
        int k = w->list[j];
        w->pixel[j] = w->pixel[k];
        w->weight[j] = w->weight[k] * w->reflectivity[k];
    }
    WIDE_LOOP for (int j = 0; j < count; j++) {
        int k = w->list[j];
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
    rays->count = count;
}

void ZT_CLASSIC_ISA(zt_radiance *light, const zt_tracer *tracer, zt_batch *rays,
                    zt_classic_work *work) {
    memset(light, 0, sizeof *light);
    for (int i = 0; i < rays->count; i++) {
        work->pixel[i] = i;
        work->weight[i] = 1;
    }
    for (int32_t depth = 0; rays->count > 0; depth++) {
        for (int i = 0; i < zt_batch_padded(rays->count); i++) {
            rays->t[i] = REAL_INFINITY;
            rays->hit[i] = -1;
        }
        intersect_analytic(rays, tracer);
        if (tracer->meshes) {
            int mesh_rays = list_mesh_rays(work, rays, tracer, false);
            zt_meshes_intersect(tracer->meshes, rays, work->mesh_list, mesh_rays);
        }
        gather_hits(work, rays);
        find_surfaces(work, tracer);
        if (tracer->has_other_surfaces) find_other_surfaces(work, tracer, rays);
        face_rays(work, tracer->ambient);
        for (int32_t i = 0; i < tracer->lamp_count; i++) {
            shine(work, &tracer->lamps[i]);
            if (tracer->lamps[i].shadows) cast_shadows(work, tracer, &tracer->lamps[i]);
            add_lamp(work);
        }
        deliver(light, work);
        if (depth >= tracer->reflection_depth) break;
        mirror(rays, work);
    }
}
