/* Polygons in space become triangles. */
#ifndef ZT_DESCRIPTION_TRIANGULATE_H
#define ZT_DESCRIPTION_TRIANGULATE_H

#include <stdint.h>

#include <zoetrope/status.h>

#include "base/arena.h"

/* Working memory for one polygon after the other. */
typedef struct zt_triangulator {
    const double *positions; /* of the vertices, x y z each; not owned */
    struct zt_polygon_corner *ring;
    int64_t patience; /* comparisons left for polygons that need more than their share */
    int32_t given_up; /* polygons cut without looking, or not wholly so */
} zt_triangulator;

/* For polygons of up to `most_corners`; its memory comes from `scratch`. ZT_EMEMORY. */
zt_status zt_triangulator_create(zt_triangulator *t, zt_arena *scratch, const double *positions,
                                 int32_t most_corners);

/* Cuts the polygon of `count` >= 3 corners, indices of vertices, into count - 2 triangles that
 * wind as it does. A convex polygon becomes a fan around its first corner. Any other one loses
 * ear after ear (Meisters, "Polygons have ears", 1975), seen along the axis nearest to its
 * normal; corners may repeat, as those of a bridge to a hole do. A polygon that is flat as a
 * line or crosses itself gives some triangles. The time is bounded: when the patience for all
 * polygons together is used up, what is left of one is cut without looking, and given_up counts
 * it. */
void zt_triangulate(zt_triangulator *t, uint32_t *triangles, const uint32_t *corners,
                    int32_t count);

#endif
