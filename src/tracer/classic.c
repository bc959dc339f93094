/* The classic integrator. A step of its loop: intersect the batch, find what it hit, light it,
 * mirror it, again. Compiled once for each width of instructions and each precision
 * (tracer/isa.h). */
#include "tracer/classic.h"

#include <string.h>

#include "tracer/footsteps.h"
#include "tracer/intersect.h"
#include "tracer/sampler.h"
#include "tracer/work.h"

#define intersect    ZT_KERNEL_NAME(zt_intersect)
#define find_points  ZT_KERNEL_NAME(zt_points_find)
#define spread       ZT_KERNEL_NAME(zt_points_spread)
#define begin        ZT_KERNEL_NAME(zt_work_begin)
#define keep_hits    ZT_KERNEL_NAME(zt_work_keep_hits)
#define light_points ZT_KERNEL_NAME(zt_work_light)

static inline void deliver_point(zt_radiance *restrict light, const zt_work *restrict w, int i,
                                 int k) {
    light->r[i] += (float)(w->points.weight[k] * w->sum_r[k]);
    light->g[i] += (float)(w->points.weight[k] * w->sum_g[k]);
    light->b[i] += (float)(w->points.weight[k] * w->sum_b[k]);
}

static void begin_paths(zt_work *w) {
    memset(w->points.face, 0, sizeof w->points.face);
    memset(w->points.cell, 0, sizeof w->points.cell);
    memset(w->hidden, 0, sizeof w->hidden);
}

/* Lengthens the paths by the points: what each lies on, and what of that and of its light has
 * edges that can be seen. */
static void deliver_paths(zt_radiance *restrict light, zt_work *restrict w,
                          const uint32_t *restrict labels) {
    const zt_points *restrict p = &w->points;
    uint32_t *restrict path = w->hidden;
    int padded = zt_batch_padded(p->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        int32_t source = w->from.source[k], inside = source >= 0 ? source & 1 : 0;
        uint32_t part = (uint32_t)(2 * p->face[k] + inside) << 1 | (uint32_t)p->cell[k];
        uint32_t what = labels[p->primitive[k]] ^ part;
        uint32_t whole = zt_sample_mix(what + 1) ^ path[k];
        path[k] = zt_sample_mix(light->path[p->moved ? p->pixel[k] : k] + whole);
    }
    if (p->moved)
        for (int k = 0; k < p->count; k++) light->path[p->pixel[k]] = path[k];
    else
        memcpy(light->path, path, sizeof light->path);
}

static void deliver(zt_radiance *restrict light, const zt_work *restrict w) {
    int padded = zt_batch_padded(w->points.count);
    if (w->points.moved)
        for (int k = 0; k < w->points.count; k++)
            deliver_point(light, w, w->points.pixel[k], k);
    else
        WIDE_LOOP for (int k = 0; k < padded; k++) deliver_point(light, w, k, k);
}

/* Which of the first rays met something: all of them are still there. */
static void deliver_cover(zt_radiance *restrict light, const zt_work *restrict w) {
    int padded = zt_batch_padded(w->rays.count);
    WIDE_LOOP for (int i = 0; i < padded; i++) light->a[i] = w->rays.hit[i] < 0 ? 0 : 1;
}

/* Lets go of rays of which all that they may still bring is less than half of the last place
 * of what there is already. */
static void leave_faint(zt_work *restrict w, const zt_radiance *restrict light,
                        real brightest) {
    const zt_points *restrict p = &w->points;
    int padded = zt_batch_padded(p->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        int32_t i = p->pixel[k];
        float most = (float)(p->weight[k] * brightest) * 0x1p26f;
        bool faint = (most < light->r[i]) & (most < light->g[i]) & (most < light->b[i]);
        w->wanted[k] &= !faint;
    }
}

/* Mirrors all rays at flat points, if they reflect and none may be let go: with bounds of their
 * new directions. */
static void mirror_flat(zt_work *restrict w) {
    zt_batch *restrict rays = &w->rays;
    zt_points *restrict p = &w->points;
    const real3 n = p->normal;
    const real reflects = p->reflects;
    zt_ranging x = ZT_RANGING, y = ZT_RANGING, z = ZT_RANGING;
    WIDE_LOOP for (int k = 0; k < zt_batch_padded(p->count); k++) {
        p->weight[k] *= reflects;
        mirror_ray(rays, k, n.x, n.y, n.z);
        zt_range_add(&x, rays->dx[k]);
        zt_range_add(&y, rays->dy[k]);
        zt_range_add(&z, rays->dz[k]);
    }
    w->directions = zt_ranges_end(&x, &y, &z);
}

/* Makes the mirrored rays of the points that reflect the next batch. */
static void mirror(zt_work *restrict w, const zt_radiance *light, const zt_tracer *tracer,
                   bool may_be_faint) {
    zt_batch *restrict rays = &w->rays;
    zt_origins *restrict from = &w->from;
    zt_points *restrict p = &w->points;
    int padded = zt_batch_padded(p->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        w->wanted[k] = p->reflectivity[k] > 0;
        p->weight[k] *= p->reflectivity[k];
        mirror_ray(rays, k, p->nx[k], p->ny[k], p->nz[k]);
    }
    if (may_be_faint) leave_faint(w, light, tracer->brightest);
    if (all_wanted(w, p->count)) return;
    if (count_wanted(w, p->count) == 0) {
        rays->count = 0;
        return;
    }
    rays->count = list_wanted(w->list, w->wanted, p->count);
    p->moved = true;
    padded = zt_batch_padded(rays->count);
    if (tracer->moves) move_moments(from, w->list, padded);
    WIDE_LOOP for (int k = 0; k < padded; k++) { /* moving down, as in keep_hits */
        int32_t i = w->list[k];
        from->x[k] = from->x[i];
        from->y[k] = from->y[i];
        from->z[k] = from->z[i];
        from->near[k] = from->near[i];
        from->source[k] = from->source[i];
        rays->dx[k] = rays->dx[i];
        rays->dy[k] = rays->dy[i];
        rays->dz[k] = rays->dz[i];
        p->pixel[k] = p->pixel[i];
        p->weight[k] = p->weight[i];
    }
}

static void go_on(zt_work *w, const zt_radiance *light, const zt_tracer *tracer,
                  bool may_be_faint) {
    const zt_points *p = &w->points;
    zt_batch *rays = &w->rays;
    if (p->flat && !(p->reflects > 0)) {
        rays->count = 0;
    } else if (p->flat && !may_be_faint) {
        mirror_flat(w);
    } else {
        spread(&w->points);
        mirror(w, light, tracer, may_be_faint);
        w->directions = zt_range3(rays->dx, rays->dy, rays->dz, rays->count);
    }
}

/* Says nothing of where a batch's rays begin. */
static void forget_places(zt_points *p) {
    const real3 end = {REAL_INFINITY, REAL_INFINITY, REAL_INFINITY};
    p->places = (zt_box){{-end.x, -end.y, -end.z}, end};
    p->source = -1;
}

/* `plain`: the scene is, and only light is asked for: said before the loop, it changes nothing.
 */
static inline __attribute__((always_inline)) bool trace_any(zt_radiance *light,
                                                            const zt_tracer *tracer,
                                                            const zt_rays *given, zt_work *w,
                                                            const bool plain) {
    memset(light->r, 0, sizeof light->r);
    memset(light->g, 0, sizeof light->g);
    memset(light->b, 0, sizeof light->b);
    zt_footprint *footprint = plain ? NULL : given->footprint;
    const bool wants_path = !plain && given->labels;
    const bool everything = !plain && tracer->everything;
    const bool whole = wants_path || everything;
    if (wants_path) memset(light->path, 0, sizeof light->path);
    begin(w, tracer, given);
    light->counts.batches++;
    if (everything) forget_places(&w->points);
    for (int32_t depth = 0; w->rays.count > 0; depth++) {
        zt_bundle bundle = {.origins = w->points.places,
                            .directions = w->directions,
                            .source = w->points.source};
        *(depth == 0 ? &light->counts.primary : &light->counts.mirror) += w->rays.count;
        bool any = intersect(&w->rays, &bundle, tracer);
        if (given->wants_cover && depth == 0) deliver_cover(light, w);
        if (footprint) zt_tread_rays(footprint, depth, &bundle, &w->rays, tracer);
        if (any) keep_hits(w, tracer);
        if (!any || w->rays.count == 0) {
            light->counts.bare_batches += depth == 0;
            return depth > 0;
        }
        if (wants_path) begin_paths(w);
        find_points(&w->points, &w->rays, tracer);
        if (everything) forget_places(&w->points);
        if (footprint || wants_path) spread(&w->points);
        if (footprint) zt_tread_points(footprint, depth, &w->points, tracer, given->outline);
        int traced = light_points(w, &light->counts, tracer, given, depth);
        deliver(light, w);
        if (wants_path) deliver_paths(light, w, given->labels->things);
        int count = w->rays.count;
        if (depth < tracer->reflection_depth)
            go_on(w, light, tracer, depth >= tracer->faint_depth && !whole);
        else
            w->rays.count = 0;
        if (depth < tracer->asked_depth) light->counts.mirror_avoided += count - w->rays.count;
        if (depth == 0 && w->points.flat && traced + w->rays.count == 0)
            light->counts.flat_batches++;
    }
    return true;
}

static bool trace(zt_radiance *light, const zt_tracer *tracer, const zt_rays *given,
                  void *memory) {
    return trace_any(light, tracer, given, memory, false);
}

static bool trace_plain(zt_radiance *light, const zt_tracer *tracer, const zt_rays *given,
                        void *memory) {
    return trace_any(light, tracer, given, memory, true);
}

static bool may_meet(const zt_tracer *tracer, vec3 low, vec3 high) {
    /* No longer than 1, as directions of bundles are; their own have a few roundings. */
    const double scale =
        1 / (most_of(-low.x, high.x) + most_of(-low.y, high.y) + most_of(-low.z, high.z));
    const double room = 16 * (double)REAL_ROUNDING;
    zt_bundle bundle = {
        .directions = {{(real)(low.x * scale - room), (real)(low.y * scale - room),
                        (real)(low.z * scale - room)},
                       {(real)(high.x * scale + room), (real)(high.y * scale + room),
                        (real)(high.z * scale + room)}},
        .source = -1};
    return ZT_KERNEL_NAME(zt_may_meet)(&bundle, tracer);
}

const zt_kernel ZT_KERNEL_NAME(zt_kernel) = {trace, trace_plain, may_meet,
                                             ZT_KERNEL_NAME(zt_work_probe), sizeof(zt_work)};
