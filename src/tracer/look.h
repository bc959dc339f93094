/* Looking into hierarchies, once for each width of instructions: what is promised is said in
 * tracer/bvh.h. */
#ifndef ZT_TRACER_LOOK_H
#define ZT_TRACER_LOOK_H

#include "tracer/bvh.h"
#include "tracer/isa.h"

zt_bvh_look ZT_KERNEL_NAME(zt_bvh_look);

#endif
