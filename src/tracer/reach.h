/* Which lamps may shine on a batch of points at all. Exact: a lamp is left out only where
 * bounds that include all roundings say that the points turn away from it, or that each of its
 * shadow rays meets one and the same thing on its way; so that leaving it out adds the same
 * nothing as asking would. */
#ifndef ZT_TRACER_REACH_H
#define ZT_TRACER_REACH_H

#include "tracer/footprint.h"
#include "tracer/isa.h"
#include "tracer/points.h"
#include "tracer/tracer.h"

/* What blocked lamps from a thread's last batches: likely it will again. Any contents will do;
 * they decide how long it takes, and nothing else. */
typedef struct zt_reach_memory {
    uint8_t useful[ZT_BLOCKERS_MAX]; /* blockers, in the order in which they were asked */
    uint32_t useful_count;
    int32_t left;  /* how many lamps were */
    uint32_t next; /* the one to try next of the others */
} zt_reach_memory;

/* Bounds of a batch's points, with all that decides which lamps reach them. */
typedef struct zt_reach_points {
    zt_box places, normals;
    real3 least_color;              /* of all points */
    const struct zt_labels *labels; /* as in zt_rays */
    zt_footprint *footprint;        /* grows by the lamps that are left out; may be NULL */
    const zt_outline *outline;
} zt_reach_points;

/* Of lamps first … first + ZT_BATCH - 1, in order, those that may shine on the points: their
 * numbers to `list`; returns how many there are. To `hidden`, the sum of the labels of those
 * that something hides from all points, which face them; 0 without labels. */
int ZT_KERNEL_NAME(zt_reach_list)(int32_t *list, uint32_t *hidden, zt_reach_memory *memory,
                                  const zt_reach_points *points, const zt_tracer *tracer,
                                  int32_t first);

#endif
