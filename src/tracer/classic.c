/* The classic integrator. A step of its loop: intersect the batch, find what it hit, light it,
 * mirror it, again. Compiled once for each width of instructions and each precision
 * (tracer/isa.h). */
#include "tracer/classic.h"

#include <math.h>
#include <string.h>

#include "tracer/footsteps.h"
#include "tracer/intersect.h"
#include "tracer/lamps.h"
#include "tracer/points.h"
#include "tracer/sampler.h"

#define intersect   ZT_KERNEL_NAME(zt_intersect)
#define occlude     ZT_KERNEL_NAME(zt_occlude)
#define may_meet    ZT_KERNEL_NAME(zt_may_meet)
#define find_points ZT_KERNEL_NAME(zt_points_find)
#define aim         ZT_KERNEL_NAME(zt_lamp_aim)

/* What one thread works with; its contents mean nothing between calls. */
typedef struct work {
    zt_origins from; /* of the rays, and then of the shadow rays as well */
    zt_batch rays, shadow;
    zt_points points;
    /* Light at the points: of all lamps so far, and of one lamp. */
    alignas(64) real sum_r[ZT_BATCH];
    alignas(64) real sum_g[ZT_BATCH];
    alignas(64) real sum_b[ZT_BATCH];
    zt_lamp_light lamp;
    alignas(64) uint32_t hidden[ZT_BATCH]; /* a hash of the lamps that something hides */
    alignas(64) int32_t wanted[ZT_BATCH];  /* which of the rays or points go on */
    alignas(64) int32_t list[ZT_BATCH];    /* the numbers of those */
} work;

/* Loops run over whole groups of lanes: what lies beyond the count is computed and never used,
 * but must be safe to compute. */

static bool all_wanted(const work *w, int count) {
    int32_t all = 1;
    for (int i = 0; i < count; i++) all &= w->wanted[i];
    return all;
}

static int count_wanted(const work *w, int count) {
    int32_t wanted = 0;
    for (int i = 0; i < count; i++) wanted += w->wanted[i];
    return wanted;
}

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

/* Makes the batch the first rays, with unit directions. */
static void begin(work *restrict w, const zt_rays *restrict given) {
    zt_batch *restrict rays = &w->rays;
    zt_origins *restrict from = &w->from;
    w->rays.from = w->shadow.from = &w->from;
    rays->count = given->count;
    w->points.moved = false;
    int padded = zt_batch_padded(given->count);
    WIDE_LOOP for (int i = 0; i < padded; i++) {
        real x = (real)given->ox[i], y = (real)given->oy[i], z = (real)given->oz[i];
        real dx = (real)given->dx[i], dy = (real)given->dy[i], dz = (real)given->dz[i];
        real unit = 1 / real_sqrt(real_dot(dx, dy, dz, dx, dy, dz));
        from->x[i] = x;
        from->y[i] = y;
        from->z[i] = z;
        from->near[i] = real_max(real_max(real_abs(x), real_abs(y)), real_abs(z)) * TIE;
        from->source[i] = -1;
        rays->dx[i] = dx * unit;
        rays->dy[i] = dy * unit;
        rays->dz[i] = dz * unit;
        w->points.pixel[i] = i;
        w->points.weight[i] = 1;
    }
}

/* When each ray is: on its way from which moment to the next, and how far. */
static void begin_moments(zt_origins *from, const zt_tracer *tracer, const float *time,
                          int count) {
    for (int i = 0; i < zt_batch_padded(count); i++)
        from->between[i] =
            (real)zt_exposure_find(&from->moment[i], tracer->exposure, tracer->moment_at,
                                   i < count ? (double)time[i] : 0);
}

/* Moves what ray i carries through time to place k; numbers in `list` are no less than their
 * places. */
static void move_moments(zt_origins *restrict from, const int32_t *restrict list, int count) {
    WIDE_LOOP for (int k = 0; k < count; k++) {
        int32_t i = list[k];
        from->moment[k] = from->moment[i];
        from->between[k] = from->between[i];
    }
}

/* Lets go of the rays that hit nothing. */
static void keep_hits(work *restrict w, const zt_tracer *tracer) {
    zt_batch *restrict rays = &w->rays;
    zt_origins *restrict from = &w->from;
    zt_points *restrict p = &w->points;
    int count = rays->count, padded = zt_batch_padded(count);
    WIDE_LOOP for (int i = 0; i < padded; i++) w->wanted[i] = rays->hit[i] >= 0;
    if (all_wanted(w, count)) return;
    rays->count = list_wanted(w->list, w->wanted, count);
    p->moved = true;
    padded = zt_batch_padded(rays->count);
    if (tracer->moves) move_moments(from, w->list, padded);
    /* Numbers in the list are no less than their places, so that moving down overwrites nothing
     * that is still wanted. */
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        int32_t i = w->list[k];
        from->x[k] = from->x[i];
        from->y[k] = from->y[i];
        from->z[k] = from->z[i];
        rays->dx[k] = rays->dx[i];
        rays->dy[k] = rays->dy[i];
        rays->dz[k] = rays->dz[i];
        rays->t[k] = rays->t[i];
        rays->hit[k] = rays->hit[i];
        rays->part[k] = rays->part[i];
        p->pixel[k] = p->pixel[i];
        p->weight[k] = p->weight[i];
    }
}

/* Cuts to 0..1; what is no number becomes 0. */
#if defined __AVX512F__
/* The same by bits, which from 0 to infinity are ordered as the numbers are, and beyond it for
 * all else: two instructions, where the comparisons become seven. */
static real cut(real x) {
    const real one = 1, infinity = REAL_INFINITY;
    real_code code, top, last;
    memcpy(&code, &x, sizeof code);
    memcpy(&top, &one, sizeof top);
    memcpy(&last, &infinity, sizeof last);
    code = code > last ? 0 : code;
    code = code < top ? code : top;
    memcpy(&x, &code, sizeof x);
    return x;
}
#else
static real cut(real x) {
    real low = x > 0 ? x : 0;
    return low < 1 ? low : 1;
}
#endif

/* What a lamp gives point k where nothing is in between: added to the sums; or, where it may be
 * `hidden`, kept, with a shadow ray for it if it is any. Others look no distance, and meet
 * nothing. */
static inline void give(work *restrict w, int k, bool hidden, real r, real g, real b,
                        zt_lamp_way way) {
    zt_batch *restrict shadow = &w->shadow;
    r = cut(r * w->points.color_r[k]);
    g = cut(g * w->points.color_g[k]);
    b = cut(b * w->points.color_b[k]);
    if (hidden) {
        bool wanted = r + g + b > 0;
        w->lamp.r[k] = r;
        w->lamp.g[k] = g;
        w->lamp.b[k] = b;
        w->wanted[k] = wanted;
        shadow->dx[k] = way.x;
        shadow->dy[k] = way.y;
        shadow->dz[k] = way.z;
        shadow->t[k] = wanted ? way.distance : 0;
        shadow->hit[k] = -1;
    } else {
        w->sum_r[k] += r;
        w->sum_g[k] += g;
        w->sum_b[k] += b;
    }
}

/* The light of a point that stands still. */
static inline void shine(work *restrict w, const zt_lamp *lamp, bool hidden) {
    const zt_origins *restrict from = &w->from;
    const zt_points *restrict p = &w->points;
    const zt_lamp_pose pose = *lamp->poses;
    int padded = zt_batch_padded(p->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        zt_lamp_way way = zt_point_way(&pose, from->x[k], from->y[k], from->z[k], p->nx[k],
                                       p->ny[k], p->nz[k], 0, 0);
        give(w, k, hidden, pose.power.x * way.fade, pose.power.y * way.fade,
             pose.power.z * way.fade, way);
    }
    w->shadow.count = p->count;
}

/* The light of a lamp that has a size or moves: of one place on it for each point. */
static inline void shine_from_places(work *restrict w, const zt_lamp *lamp, bool hidden,
                                     const zt_rays *given, uint32_t dimension, bool straight) {
    zt_batch *restrict shadow = &w->shadow;
    int padded = zt_batch_padded(w->points.count);
    aim(&w->lamp, shadow, lamp, &w->points, given, dimension, straight);
    WIDE_LOOP for (int k = 0; k < padded; k++)
        give(w, k, hidden, w->lamp.r[k], w->lamp.g[k], w->lamp.b[k],
             (zt_lamp_way){shadow->dx[k], shadow->dy[k], shadow->dz[k], shadow->t[k], 0});
    shadow->count = w->points.count;
}

/* Of lamp number `index`, after so many mirrors. */
static void shine_any(work *w, const zt_tracer *tracer, int32_t index, bool hidden,
                      const zt_rays *given, int32_t depth) {
    const zt_lamp *lamp = &tracer->lamps[index];
    uint32_t dimension = (uint32_t)(ZT_DIMENSION_LAMPS + depth * tracer->lamp_count + index);
    bool plain = lamp->kind == ZT_LAMP_POINT && !lamp->moves;
    bool straight = lamp->moves && tracer->exposure->moment_count == 2;
    if (plain && hidden)
        shine(w, lamp, true);
    else if (plain)
        shine(w, lamp, false);
    else if (hidden)
        shine_from_places(w, lamp, true, given, dimension, straight);
    else
        shine_from_places(w, lamp, false, given, dimension, straight);
}

/* Adds a lamp's light where nothing hides it. */
static void add_lamp(work *restrict w) {
    int padded = zt_batch_padded(w->points.count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        bool open = w->shadow.hit[k] < 0;
        w->sum_r[k] += open ? w->lamp.r[k] : 0;
        w->sum_g[k] += open ? w->lamp.g[k] : 0;
        w->sum_b[k] += open ? w->lamp.b[k] : 0;
    }
}

/* Takes note of where lamp number `index` is hidden. */
static void note_hidden(work *restrict w, int32_t index) {
    const uint32_t number = zt_sample_mix((uint32_t)index + 1);
    int padded = zt_batch_padded(w->points.count);
    WIDE_LOOP for (int k = 0; k < padded; k++) w->hidden[k] ^=
        w->shadow.hit[k] >= 0 ? number : 0;
}

/* The sums of the ambient lights at the rays' times. */
static void add_ambient(work *restrict w, const zt_tracer *tracer) {
    const zt_points *restrict p = &w->points;
    const real *restrict between = w->from.between;
    const int32_t *restrict moment = w->from.moment;
    int padded = zt_batch_padded(p->count);
    const real3 still = tracer->ambient, *moving = tracer->ambients;
    if (!moving) WIDE_LOOP for (int k = 0; k < padded; k++) {
            w->sum_r[k] = still.x * p->color_r[k];
            w->sum_g[k] = still.y * p->color_g[k];
            w->sum_b[k] = still.z * p->color_b[k];
        }
    else
        WIDE_LOOP for (int k = 0; k < padded; k++) {
            const real3 *a = &moving[moment[k]], *b = a + 1;
            real t = between[k];
            w->sum_r[k] = (a->x * (1 - t) + b->x * t) * p->color_r[k];
            w->sum_g[k] = (a->y * (1 - t) + b->y * t) * p->color_g[k];
            w->sum_b[k] = (a->z * (1 - t) + b->z * t) * p->color_b[k];
        }
}

/* Sums up the light at the points; returns how many shadow rays were traced. */
static int light_points(work *restrict w, const zt_tracer *tracer, const zt_box *around,
                        const zt_rays *given, int32_t depth) {
    const zt_points *restrict p = &w->points;
    int traced = 0;
    add_ambient(w, tracer);
    for (int32_t i = 0; i < tracer->lamp_count; i++) {
        const zt_lamp *lamp = &tracer->lamps[i];
        zt_bundle bundle = zt_bundle_to(*around, lamp->bounds, p->source);
        bool hidden = lamp->shadows && may_meet(&bundle, tracer);
        shine_any(w, tracer, i, hidden, given, depth);
        int wanted = hidden ? count_wanted(w, p->count) : 0;
        traced += wanted;
        if (wanted > 0) {
            occlude(&w->shadow, &bundle, tracer);
            add_lamp(w);
            if (given->wants_path) note_hidden(w, i);
        }
        if (given->footprint)
            zt_tread_lamp(given->footprint, lamp, p, &w->shadow, w->wanted, hidden);
    }
    return traced;
}

static inline void deliver_point(zt_radiance *restrict light, const work *restrict w, int i,
                                 int k) {
    light->r[i] += (float)(w->points.weight[k] * w->sum_r[k]);
    light->g[i] += (float)(w->points.weight[k] * w->sum_g[k]);
    light->b[i] += (float)(w->points.weight[k] * w->sum_b[k]);
}

static void begin_paths(work *w) {
    memset(w->points.face, 0, sizeof w->points.face);
    memset(w->points.cell, 0, sizeof w->points.cell);
    memset(w->hidden, 0, sizeof w->hidden);
}

/* Lengthens the paths by the points: what each lies on, and what of that and of its light has
 * edges that can be seen. */
static void deliver_paths(zt_radiance *restrict light, work *restrict w) {
    const zt_points *restrict p = &w->points;
    uint32_t *restrict path = w->hidden;
    int padded = zt_batch_padded(p->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        int32_t source = w->from.source[k], inside = source >= 0 ? source & 1 : 0;
        uint32_t what = (uint32_t)(16 * p->primitive[k] + 2 * p->face[k] + inside) << 1 |
                        (uint32_t)p->cell[k];
        uint32_t whole = zt_sample_mix(what + 1) ^ path[k];
        path[k] = zt_sample_mix(light->path[p->moved ? p->pixel[k] : k] + whole);
    }
    if (p->moved)
        for (int k = 0; k < p->count; k++) light->path[p->pixel[k]] = path[k];
    else
        memcpy(light->path, path, sizeof light->path);
}

static void deliver(zt_radiance *restrict light, const work *restrict w) {
    int padded = zt_batch_padded(w->points.count);
    if (w->points.moved)
        for (int k = 0; k < w->points.count; k++)
            deliver_point(light, w, w->points.pixel[k], k);
    else
        WIDE_LOOP for (int k = 0; k < padded; k++) deliver_point(light, w, k, k);
}

/* Turns ray k, which ended at point k, to its mirrored direction. */
static inline void mirror_ray(work *restrict w, int k) {
    zt_batch *restrict rays = &w->rays;
    const zt_points *restrict p = &w->points;
    real nx = p->nx[k], ny = p->ny[k], nz = p->nz[k];
    real twice = -2 * real_dot(nx, ny, nz, rays->dx[k], rays->dy[k], rays->dz[k]);
    real dx = rays->dx[k] + twice * nx, dy = rays->dy[k] + twice * ny,
         dz = rays->dz[k] + twice * nz;
    /* Unit but for roundings, of which one step of Newton's for 1 / sqrt leaves none. */
    real unit = (real)1.5 - (real)0.5 * real_dot(dx, dy, dz, dx, dy, dz);
    rays->dx[k] = dx * unit;
    rays->dy[k] = dy * unit;
    rays->dz[k] = dz * unit;
}

/* Makes the mirrored rays of the points that reflect the next batch. */
static void mirror(work *restrict w, const zt_tracer *tracer) {
    zt_batch *restrict rays = &w->rays;
    zt_origins *restrict from = &w->from;
    zt_points *restrict p = &w->points;
    int padded = zt_batch_padded(p->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        w->wanted[k] = p->reflectivity[k] > 0;
        p->weight[k] *= p->reflectivity[k];
        mirror_ray(w, k);
    }
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

static zt_bundle bundle_around(const work *w, zt_box origins, int32_t source) {
    const zt_batch *r = &w->rays;
    return (zt_bundle){.origins = origins,
                       .directions = zt_range3(r->dx, r->dy, r->dz, r->count),
                       .source = source};
}

/* Which of the first rays met something: all of them are still there. */
static void deliver_cover(zt_radiance *restrict light, const work *restrict w) {
    int padded = zt_batch_padded(w->rays.count);
    WIDE_LOOP for (int i = 0; i < padded; i++) light->a[i] = w->rays.hit[i] < 0 ? 0 : 1;
}

static void trace(zt_radiance *light, const zt_tracer *tracer, const zt_rays *given,
                  void *memory) {
    work *w = memory;
    memset(light->r, 0, sizeof light->r);
    memset(light->g, 0, sizeof light->g);
    memset(light->b, 0, sizeof light->b);
    if (given->wants_path) memset(light->path, 0, sizeof light->path);
    begin(w, given);
    if (tracer->moves) begin_moments(&w->from, tracer, given->time, given->count);
    zt_box around = zt_range3(w->from.x, w->from.y, w->from.z, w->rays.count);
    w->points.source = -1;
    for (int32_t depth = 0; w->rays.count > 0; depth++) {
        zt_bundle bundle = bundle_around(w, around, w->points.source);
        *(depth == 0 ? &light->counts.primary : &light->counts.mirror) += w->rays.count;
        intersect(&w->rays, &bundle, tracer, depth == 0 ? ZT_BVH_COHERENT : ZT_BVH_SCATTERED);
        if (given->wants_cover && depth == 0) deliver_cover(light, w);
        if (given->footprint) zt_tread_rays(given->footprint, depth, &bundle, &w->rays, tracer);
        keep_hits(w, tracer);
        if (w->rays.count == 0) return;
        if (given->wants_path) begin_paths(w);
        find_points(&w->points, &w->rays, tracer);
        around = zt_range3(w->from.x, w->from.y, w->from.z, w->rays.count);
        if (given->footprint)
            zt_tread_points(given->footprint, depth, &w->points, &around, tracer);
        light->counts.shadow += light_points(w, tracer, &around, given, depth);
        deliver(light, w);
        if (given->wants_path) deliver_paths(light, w);
        if (depth >= tracer->reflection_depth) return;
        mirror(w, tracer);
    }
}

/* ---- probes ---------------------------------------------------------------------------------
 */

static void begin_probes(work *w, zt_rays *given, const zt_tracer *tracer,
                         const zt_probe *probes, int count) {
    *given = (zt_rays){.count = count};
    for (int i = 0; i < count; i++) {
        given->ox[i] = probes[i].origin.x;
        given->oy[i] = probes[i].origin.y;
        given->oz[i] = probes[i].origin.z;
        given->dx[i] = probes[i].direction.x;
        given->dy[i] = probes[i].direction.y;
        given->dz[i] = probes[i].direction.z;
        given->time[i] = (float)probes[i].time;
        given->key[i] = probes[i].key;
        given->sample[i] = probes[i].sample;
    }
    begin(w, given);
    if (tracer->moves) begin_moments(&w->from, tracer, given->time, count);
    for (int i = 0; i < count; i++) w->from.source[i] = probes[i].source;
}

static vec3 at(const real *x, const real *y, const real *z, int k) {
    return (vec3){(double)x[k], (double)y[k], (double)z[k]};
}

static void tell_hits(zt_probe *probes, const work *w, const zt_tracer *tracer) {
    const zt_points *p = &w->points;
    for (int k = 0; k < p->count; k++) {
        zt_probe *probe = &probes[p->pixel[k]];
        const zt_primitive *primitive = &tracer->primitives[p->primitive[k]];
        probe->object = primitive->object;
        probe->part = primitive->kind == ZT_PRIMITIVE_MESH ? w->rays.part[k] : -1;
        probe->distance = (double)w->rays.t[k];
        probe->point = probe->mirror_origin = at(w->from.x, w->from.y, w->from.z, k);
        probe->normal = at(p->nx, p->ny, p->nz, k);
        probe->color = at(p->color_r, p->color_g, p->color_b, k);
        probe->mirror_source = w->from.source[k];
    }
}

static void tell_lamp(zt_probe *probes, const work *w, const zt_lamp *lamp) {
    const zt_batch *shadow = &w->shadow;
    for (int k = 0; k < w->points.count; k++) {
        zt_probe *probe = &probes[w->points.pixel[k]];
        bool open = w->wanted[k] && shadow->hit[k] < 0;
        probe->lit |= (uint64_t)open << (lamp->light & 63);
        if (!probe->lamp_points) continue;
        vec3 from = at(w->from.x, w->from.y, w->from.z, k),
             way = at(shadow->dx, shadow->dy, shadow->dz, k);
        probe->lamp_points[lamp->light] = vec3_add(from, vec3_scale(way, (double)shadow->t[k]));
    }
}

static void probe_lamps(zt_probe *probes, work *w, const zt_tracer *tracer,
                        const zt_rays *given) {
    zt_box around = zt_range3(w->from.x, w->from.y, w->from.z, w->rays.count);
    for (int32_t i = 0; i < tracer->lamp_count; i++) {
        const zt_lamp *lamp = &tracer->lamps[i];
        zt_bundle bundle = zt_bundle_to(around, lamp->bounds, w->points.source);
        shine_any(w, tracer, i, true, given, probes->depth);
        if (lamp->shadows) occlude(&w->shadow, &bundle, tracer);
        tell_lamp(probes, w, lamp);
    }
}

static void probe(const zt_tracer *tracer, zt_probe *probes, int count, void *memory) {
    work *w = memory;
    zt_rays given;
    begin_probes(w, &given, tracer, probes, count);
    for (int i = 0; i < count; i++) {
        probes[i].object = probes[i].part = -1;
        probes[i].lit = 0;
    }
    zt_bundle bundle = bundle_around(w, zt_range3(w->from.x, w->from.y, w->from.z, count), -1);
    intersect(&w->rays, &bundle, tracer, ZT_BVH_SCATTERED);
    keep_hits(w, tracer);
    if (w->rays.count == 0) return;
    find_points(&w->points, &w->rays, tracer);
    tell_hits(probes, w, tracer);
    if (!probes->unlit) probe_lamps(probes, w, tracer, &given);
    for (int k = 0; k < w->points.count; k++) {
        mirror_ray(w, k);
        probes[w->points.pixel[k]].mirror_direction = at(w->rays.dx, w->rays.dy, w->rays.dz, k);
    }
}

const zt_kernel ZT_KERNEL_NAME(zt_kernel) = {trace, probe, sizeof(work)};
