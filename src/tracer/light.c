/* The light at a batch's points. Compiled once for each width of instructions and each
 * precision (tracer/isa.h). */
#include <string.h>

#include "tracer/footsteps.h"
#include "tracer/intersect.h"
#include "tracer/sampler.h"
#include "tracer/work.h"

#define aim       ZT_KERNEL_NAME(zt_lamp_aim)
#define spread    ZT_KERNEL_NAME(zt_points_spread)
#define shine_any ZT_KERNEL_NAME(zt_work_shine)

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

/* What a lamp gives point k, of such a color, where nothing is in between: added to the sums;
 * or, where it may be `hidden`, kept, with a shadow ray for it if it is any. Others look no
 * distance, and meet nothing. */
static inline void give(zt_work *restrict w, int k, bool hidden, real3 color, real r, real g,
                        real b, zt_lamp_way way) {
    zt_batch *restrict shadow = &w->shadow;
    r = cut(r * color.x);
    g = cut(g * color.y);
    b = cut(b * color.z);
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
static inline void shine(zt_work *restrict w, const zt_lamp *lamp, bool hidden, bool flat) {
    const zt_origins *restrict from = &w->from;
    const zt_points *restrict p = &w->points;
    const zt_lamp_pose pose = *lamp->poses;
    const real3 normal = p->normal, color = p->color;
    int padded = zt_batch_padded(p->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        real3 n = flat ? normal : (real3){p->nx[k], p->ny[k], p->nz[k]};
        real3 c = flat ? color : (real3){p->color_r[k], p->color_g[k], p->color_b[k]};
        zt_lamp_way way =
            zt_point_way(&pose, from->x[k], from->y[k], from->z[k], n.x, n.y, n.z, 0, 0);
        give(w, k, hidden, c, pose.power.x * way.fade, pose.power.y * way.fade,
             pose.power.z * way.fade, way);
    }
    w->shadow.count = p->count;
}

/* The light of a lamp that has a size or moves: of one place on it for each point. */
static inline void shine_from_places(zt_work *restrict w, const zt_lamp *lamp, bool hidden,
                                     const zt_rays *given, uint32_t dimension, bool straight) {
    zt_batch *restrict shadow = &w->shadow;
    const zt_points *restrict p = &w->points;
    int padded = zt_batch_padded(w->points.count);
    spread(&w->points);
    aim(&w->lamp, shadow, lamp, &w->points, given, dimension, straight);
    WIDE_LOOP for (int k = 0; k < padded; k++)
        give(w, k, hidden, (real3){p->color_r[k], p->color_g[k], p->color_b[k]}, w->lamp.r[k],
             w->lamp.g[k], w->lamp.b[k],
             (zt_lamp_way){shadow->dx[k], shadow->dy[k], shadow->dz[k], shadow->t[k], 0});
    shadow->count = w->points.count;
}

void ZT_KERNEL_NAME(zt_work_shine)(zt_work *w, const zt_tracer *tracer, int32_t index,
                                   bool hidden, const zt_rays *given, int32_t depth) {
    const zt_lamp *lamp = &tracer->lamps[index];
    uint32_t dimension = (uint32_t)(ZT_DIMENSION_LAMPS + depth * tracer->lamp_count + index);
    bool plain = lamp->kind == ZT_LAMP_POINT && !lamp->moves;
    bool straight = lamp->moves && tracer->exposure->moment_count == 2;
    const bool flat = w->points.flat;
    if (plain && hidden)
        flat ? shine(w, lamp, true, true) : shine(w, lamp, true, false);
    else if (plain)
        flat ? shine(w, lamp, false, true) : shine(w, lamp, false, false);
    else if (hidden)
        shine_from_places(w, lamp, true, given, dimension, straight);
    else
        shine_from_places(w, lamp, false, given, dimension, straight);
}

/* Adds a lamp's light where nothing hides it. */
static void add_lamp(zt_work *restrict w) {
    int padded = zt_batch_padded(w->points.count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        bool open = w->shadow.hit[k] < 0;
        w->sum_r[k] += open ? w->lamp.r[k] : 0;
        w->sum_g[k] += open ? w->lamp.g[k] : 0;
        w->sum_b[k] += open ? w->lamp.b[k] : 0;
    }
}

/* Takes note of where the lamp of that label is hidden. */
static void note_hidden(zt_work *restrict w, uint32_t label) {
    int padded = zt_batch_padded(w->points.count);
    WIDE_LOOP for (int k = 0; k < padded; k++) w->hidden[k] +=
        w->shadow.hit[k] >= 0 ? label : 0;
}

/* The sums of the ambient lights at the rays' times. */
static void add_ambient(zt_work *restrict w, const zt_tracer *tracer) {
    const zt_points *restrict p = &w->points;
    const real *restrict between = w->from.between;
    const int32_t *restrict moment = w->from.moment;
    int padded = zt_batch_padded(p->count);
    const real3 still = tracer->ambient, *moving = tracer->ambients, color = p->color;
    if (p->flat) WIDE_LOOP for (int k = 0; k < padded; k++) {
            w->sum_r[k] = still.x * color.x;
            w->sum_g[k] = still.y * color.y;
            w->sum_b[k] = still.z * color.z;
        }
    else if (!moving)
        WIDE_LOOP for (int k = 0; k < padded; k++) {
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

/* ---- all lamps ------------------------------------------------------------------------------
 */

/* One lamp's light; returns how many shadow rays that took. */
static int light_by(zt_work *w, const zt_tracer *tracer, int32_t index, const zt_rays *given,
                    int32_t depth) {
    const zt_lamp *lamp = &tracer->lamps[index];
    zt_bundle bundle = zt_bundle_to(w->points.places, lamp->bounds, w->points.source);
    bool hidden = lamp->shadows && ZT_KERNEL_NAME(zt_may_meet)(&bundle, tracer);
    shine_any(w, tracer, index, hidden, given, depth);
    int wanted = hidden ? count_wanted(w, w->points.count) : 0;
    if (wanted > 0) {
        ZT_KERNEL_NAME(zt_occlude)(&w->shadow, &bundle, tracer);
        add_lamp(w);
        if (given->labels) note_hidden(w, given->labels->lamps[index]);
    }
    if (given->footprint)
        zt_tread_lamp(given->footprint, lamp, given->outline->lamps[index].place, &w->points,
                      &w->shadow, w->wanted, hidden);
    return wanted;
}

/* What of the points decides which lamps reach them. */
static zt_reach_points bound_points(const zt_work *w, const zt_rays *given) {
    const zt_points *p = &w->points;
    zt_reach_points bounds = {.places = p->places,
                              .labels = given->labels,
                              .footprint = given->footprint,
                              .outline = given->outline};
    bounds.normals =
        p->flat ? (zt_box){p->normal, p->normal} : zt_range3(p->nx, p->ny, p->nz, p->count);
    if (given->labels)
        bounds.least_color = zt_range3(p->color_r, p->color_g, p->color_b, p->count).low;
    return bounds;
}

/* The lamps that may reach the points, of all that there are. */
static int light_reached(zt_work *w, const zt_tracer *tracer, const zt_rays *given,
                         int32_t depth) {
    const zt_reach_points bounds = bound_points(w, given);
    int traced = 0;
    for (int32_t first = 0; first < tracer->lamp_count; first += ZT_BATCH) {
        uint32_t hidden;
        int count =
            ZT_KERNEL_NAME(zt_reach_list)(w->list, &hidden, &w->reach, &bounds, tracer, first);
        for (int i = 0; i < count; i++) traced += light_by(w, tracer, w->list[i], given, depth);
        if (given->labels && hidden)
            for (int k = 0; k < w->points.count; k++) w->hidden[k] += hidden;
    }
    return traced;
}

int ZT_KERNEL_NAME(zt_work_light)(zt_work *w, zt_ray_counts *counts, const zt_tracer *tracer,
                                  const zt_rays *given, int32_t depth) {
    int traced = 0;
    add_ambient(w, tracer);
    if (tracer->reach) traced = light_reached(w, tracer, given, depth);
    for (int32_t i = 0; !tracer->reach && i < tracer->lamp_count; i++)
        if (tracer->lamps[i].shines || given->footprint)
            traced += light_by(w, tracer, i, given, depth);
    counts->shadow += traced;
    counts->shadow_avoided += (int64_t)w->points.count * tracer->lamp_count - traced;
    return traced;
}
