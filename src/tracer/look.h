/* Looking into hierarchies, once for each width of instructions: what is promised is said in
 * tracer/bvh.h. */
#ifndef ZT_TRACER_LOOK_H
#define ZT_TRACER_LOOK_H

#include "tracer/bvh.h"
#include "tracer/isa.h"

/* How much further than the nearest hit so far a hierarchy looks, for the roundings of its
 * distances; and how long before the box around all there is its rays begin, as a share of its
 * size: so that they begin before all that is in it, and yet so near that single precision
 * keeps what counts. */
#define ZT_LOOK_FURTHER (1 + 0x1p-18f)
#define ZT_LOOK_BEFORE  ((real)0x1p-4)

zt_bvh_look ZT_KERNEL_NAME(zt_bvh_look);

#endif
