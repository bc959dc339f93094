/* From what the tracer of a precision has to footprints and outlines, which have none. */
#ifndef ZT_TRACER_OUTLINE_H
#define ZT_TRACER_OUTLINE_H

#include "tracer/footprint.h"
#include "tracer/tracer.h"

/* A number as a float that is no greater, or no less. What is none is as good as any. */
static inline float zt_downwards(real x) {
    float f = (float)x;
    return !(x == x) ? -INFINITY : (real)f > x ? nextafterf(f, -INFINITY) : f;
}
static inline float zt_upwards(real x) {
    float f = (float)x;
    return !(x == x) ? INFINITY : (real)f < x ? nextafterf(f, INFINITY) : f;
}
static inline zt_bvh_box zt_outwards(const zt_box *b) {
    return (zt_bvh_box){
        {zt_downwards(b->low.x), zt_downwards(b->low.y), zt_downwards(b->low.z)},
        {zt_upwards(b->high.x), zt_upwards(b->high.y), zt_upwards(b->high.z)}};
}

/* What zt_outline_make() and zt_labels_make() do. */
zt_status ZT_REAL_NAME(zt_outline)(zt_outline *outline, const zt_tracer *tracer,
                                   zt_arena *arena);
zt_status ZT_REAL_NAME(zt_labels)(zt_labels *labels, const zt_tracer *tracer, zt_arena *arena);

#endif
