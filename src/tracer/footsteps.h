/* The classic integrator's steps, taken down in a footprint. What is known of bundles anyway
 * costs nothing; little else is looked at. */
#ifndef ZT_TRACER_FOOTSTEPS_H
#define ZT_TRACER_FOOTSTEPS_H

#include "tracer/bundle.h"
#include "tracer/outline.h"
#include "tracer/points.h"

static inline void zt_hold_reals(zt_bvh_box *all, const zt_box *box, bool first) {
    zt_bvh_box more = zt_outwards(box);
    zt_hold_box(all, &more, first);
}

static inline zt_footstep *zt_step_after(zt_footprint *f, int32_t depth) {
    return &f->steps[depth < ZT_FOOTPRINT_STEPS ? depth : ZT_FOOTPRINT_STEPS - 1];
}

/* Rays that have been traced, all of them still there. Of many things with ties it is not said
 * in which order they are asked: that makes no difference where two meet, but where three do it
 * may. */
static inline void zt_tread_rays(zt_footprint *f, int32_t depth, const zt_bundle *bundle,
                                 const zt_batch *rays, const zt_tracer *tracer) {
    zt_footstep *step = zt_step_after(f, depth);
    zt_hold_reals(&step->origins, &bundle->origins, !step->there);
    zt_hold_reals(&step->directions, &bundle->directions, !step->there);
    step->there = true;
    int32_t close = 0, gone = 0;
    for (int i = 0; tracer->crowd_count > 0 && i < rays->count; i++) close |= rays->close[i];
    for (int i = 0; i < rays->count; i++) gone |= rays->hit[i] < 0;
    f->doubtful |= (close & CLOSE_SEVERAL) != 0;
    step->leaves |= gone != 0;
}

/* The points where rays ended; of smooth meshes they are lifted off their ends. */
static inline void zt_tread_points(zt_footprint *f, int32_t depth, const zt_points *points,
                                   const zt_tracer *tracer, const zt_outline *outline) {
    zt_footstep *step = zt_step_after(f, depth);
    zt_hold_reals(&step->points, &points->places, !step->ends);
    step->ends = true;
    int count = points->source >= 0 ? 1 : points->count;
    for (int k = 0; k < count; k++) {
        const zt_primitive *p = &tracer->primitives[points->primitive[k]];
        f->met |= zt_footprint_bit(outline->things[points->primitive[k]].shape);
        step->leaves |= p->kind == ZT_PRIMITIVE_MESH && tracer->placed[p->placed].smooth;
    }
}

/* A lamp that was asked at the points: which of them face it, and to which of those nothing
 * hides it. Where it was asked from is a random number's to say for those with a size, so that
 * other points may face it the next time. */
static inline void zt_tread_lamp(zt_footprint *f, const zt_lamp *lamp, zt_hash place,
                                 const zt_points *p, const zt_batch *shadow,
                                 const int32_t *wanted, bool hidden) {
    const zt_origins *from = shadow->from;
    const real3 at = lamp->poses->position;
    int32_t faced = 1, lit = 1;
    if (lamp->kind == ZT_LAMP_POINT && !lamp->moves) {
        faced = lit = 0;
        for (int k = 0; k < p->count; k++) {
            real vx = at.x - from->x[k], vy = at.y - from->y[k], vz = at.z - from->z[k];
            int32_t faces = real_dot(p->nx[k], p->ny[k], p->nz[k], vx, vy, vz) > 0;
            int32_t open = hidden ? !(wanted[k] & (shadow->hit[k] >= 0)) : 1;
            faced |= faces;
            lit |= faces & open;
        }
    }
    f->faced |= faced ? zt_footprint_bit(place) : 0;
    f->lit |= lit ? zt_footprint_bit(place) : 0;
}

#endif
