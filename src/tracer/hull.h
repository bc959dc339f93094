/* A hull: boxes around the parts of a mesh, for a first look at which rays may meet it at all.
 * Asking an acceleration structure costs some hundred cycles a ray even where there is nothing
 * near; a few boxes, many rays at a time, cost a tenth of that. */
#ifndef ZT_TRACER_HULL_H
#define ZT_TRACER_HULL_H

#include "scene/mesh.h"
#include "tracer/primitives.h"

/* A box along the axes; low > high where it is empty. */
typedef struct zt_box {
    real3 low, high;
} zt_box;

enum { ZT_HULL_LEVELS = 6 }; /* the finest level has 2^(levels - 1) boxes */

/* Level l is boxes[2^l] … boxes[2^(l+1) - 1]; each level's boxes hold all triangles. In the
 * mesh's space, `origin` left out. */
typedef struct zt_hull {
    zt_box boxes[1 << ZT_HULL_LEVELS];
} zt_hull;

/* Halves the triangles again and again along the longest side of the box around their middles.
 * `order` is room for triangle_count indices. */
void zt_hull_build(zt_hull *hull, const zt_mesh *mesh, int32_t *order);

#endif
