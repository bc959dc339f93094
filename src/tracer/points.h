/* The points where rays end: what surface is there, how it looks, and how it shines. */
#ifndef ZT_TRACER_POINTS_H
#define ZT_TRACER_POINTS_H

#include "tracer/isa.h"
#include "tracer/tracer.h"

/* The paths of a batch that hit something, one for each ray: its number among the first rays,
 * how much of its light arrives, and the surface there. The points themselves stand in the
 * origins of the rays that go on from them. */
typedef struct zt_points {
    alignas(64) int32_t pixel[ZT_BATCH];
    alignas(64) real weight[ZT_BATCH];
    alignas(64) int32_t primitive[ZT_BATCH];
    alignas(64) real nx[ZT_BATCH];
    alignas(64) real ny[ZT_BATCH];
    alignas(64) real nz[ZT_BATCH];
    alignas(64) real color_r[ZT_BATCH];
    alignas(64) real color_g[ZT_BATCH];
    alignas(64) real color_b[ZT_BATCH];
    alignas(64) real reflectivity[ZT_BATCH];
    alignas(64) int32_t closed[ZT_BATCH]; /* as in zt_surface */
    /* Which of a solid's faces that meet at edges; and whether a pattern's cell is one of the
     * other color. Set where there are solids, and patterns. */
    alignas(64) int32_t face[ZT_BATCH];
    alignas(64) int32_t cell[ZT_BATCH];
    /* All lie on one flat thing without a pattern, and the rays came from one side of it: then
     * its looks are here, and of the arrays only pixel and weight say something until
     * zt_points_spread() fills the others. */
    bool flat;
    real3 normal, color;
    real reflects;
    zt_box places;  /* bounds of where they are */
    int32_t source; /* the primitive that they all lie on, none of them inside it, or -1 */
    int count;
    bool moved; /* some rays have gone, so that point k may not be that of ray k any more */
} zt_points;

/* Moves the rays of a batch, all of which have hit something, to where they end, and finds the
 * surfaces there: sets the origins (a few roundings off the surface, on the side that the rays
 * came from, with their sources) and the points but for pixel and weight. */
void ZT_KERNEL_NAME(zt_points_find)(zt_points *points, zt_batch *rays, const zt_tracer *tracer);

/* Fills the arrays of points that may be flat. They stay so. */
void ZT_KERNEL_NAME(zt_points_spread)(zt_points *points);

#endif
