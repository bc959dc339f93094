/* What a batch of rays meets, of all that a scene has. */
#ifndef ZT_TRACER_INTERSECT_H
#define ZT_TRACER_INTERSECT_H

#include "tracer/isa.h"
#include "tracer/tracer.h"

/* The nearest hit of each ray (origins, directions and count given): sets t, hit and part; hit
 * is -1 and t infinite where there is none. Of equally near hits the first object's counts. */
void ZT_ISA_NAME(zt_intersect)(zt_batch *rays, const zt_tracer *tracer);

/* Whether anything is hit before t (given): hit, given as -1, stays so where nothing is. */
void ZT_ISA_NAME(zt_occlude)(zt_batch *rays, const zt_tracer *tracer);

#endif
