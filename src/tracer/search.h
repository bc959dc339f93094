/* What a batch of rays meets of meshes, and of primitives that are too many to be asked one by
 * one: hierarchies tell where to look. */
#ifndef ZT_TRACER_SEARCH_H
#define ZT_TRACER_SEARCH_H

#include "tracer/intersect.h"

/* Adds to what a batch has met so far. */
void ZT_KERNEL_NAME(zt_search_nearest)(zt_batch *rays, const zt_bundle *bundle,
                                       const zt_tracer *tracer);
void ZT_KERNEL_NAME(zt_search_any)(zt_batch *rays, const zt_bundle *bundle,
                                   const zt_tracer *tracer);

#endif
