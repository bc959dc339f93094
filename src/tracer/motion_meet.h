/* What a batch of rays meets of primitives that move, each ray at its own time. */
#ifndef ZT_TRACER_MOTION_MEET_H
#define ZT_TRACER_MOTION_MEET_H

#include "tracer/isa.h"
#include "tracer/tracer.h"

/* For one primitive that moves and is not a mesh, and the groups of lanes from ray number
 * `first` up to `end`: their nearest hits, in any order of primitives; or, with `any`, whether
 * shadow rays meet it. As for what stands still (tracer/intersect.c). */
void ZT_KERNEL_NAME(zt_meet_moving)(zt_batch *rays, const zt_tracer *tracer, int32_t index,
                                    int first, int end, bool any);

#endif
