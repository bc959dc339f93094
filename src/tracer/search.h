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

/* Likewise of one mesh, which is primitive number `index`: rays first .. first +
 * ZT_BATCH_LANES - 1 whose bits are set; with `any`, one hit is enough. */
void ZT_KERNEL_NAME(zt_search_mesh_lanes)(zt_batch *rays, const zt_tracer *tracer,
                                          int32_t index, int first, uint32_t set, bool any);

#endif
