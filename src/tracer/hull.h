/* A hull: boxes around the parts of a mesh, for a first look at which rays may meet it at all.
 * Asking an acceleration structure costs some hundred cycles a ray even where there is nothing
 * near; a few boxes, many rays at a time, cost a tenth of that. */
#ifndef ZT_TRACER_HULL_H
#define ZT_TRACER_HULL_H

#include "scene/mesh.h"
#include "tracer/bvh.h"

/* Box 1 holds all triangles; boxes 2 i and 2 i + 1 hold those of box i. In the mesh's space,
 * `origin` left out. */
enum { ZT_HULL_LEVELS = 6 };
typedef struct zt_hull {
    zt_bvh_box boxes[1 << ZT_HULL_LEVELS];
} zt_hull;

/* Halves the triangles again and again along the longest side of the box around their middles.
 * `order` is room for triangle_count indices. */
void zt_hull_build(zt_hull *hull, const zt_mesh *mesh, int32_t *order);

#endif
