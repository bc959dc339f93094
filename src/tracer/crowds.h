/* What a batch of rays meets of a crowd. */
#ifndef ZT_TRACER_CROWDS_H
#define ZT_TRACER_CROWDS_H

#include "tracer/intersect.h"

/* Adds to what the batch has met so far; with `any`, one hit is enough. */
void ZT_KERNEL_NAME(zt_search_crowd)(zt_batch *rays, const zt_tracer *tracer,
                                     const zt_crowd *crowd, bool any);

#endif
