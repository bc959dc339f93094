/* Triangle meshes, and what makes them fast to hit. The door to Embree.
 *
 * The run owns a zt_meshes: one structure per mesh, built when first needed, in the mesh's own
 * space. Each frame places instances of them. */
#ifndef ZT_TRACER_MESHES_H
#define ZT_TRACER_MESHES_H

#include <stdbool.h>

#include <zoetrope/status.h>

#include "base/xform.h"
#include "scene/scene.h"
#include "tracer/hull.h"
#include "tracer/primitives.h"
#include "tracer/ray.h"

typedef struct zt_meshes zt_meshes;

/* `meshes` must outlive the result. Embree is not started before a mesh is placed. */
zt_status zt_meshes_open(zt_meshes **out, const zt_mesh *meshes, int32_t mesh_count,
                         zt_listener listener);
void zt_meshes_close(zt_meshes **meshes);

/* Begins a frame: nothing is placed. */
void zt_meshes_clear(zt_meshes *meshes);

/* Places mesh number `mesh` as the primitive number `primitive`; `place` takes the mesh's space
 * to the space relative to the camera and is not singular. */
zt_status zt_meshes_place(zt_meshes *meshes, int32_t mesh, int32_t primitive,
                          const xform *place);

/* Makes the placed meshes ready for rays. */
zt_status zt_meshes_commit(zt_meshes *meshes);

/* The hull of a placed mesh: a box around it in the space relative to the camera, boxes in the
 * mesh's space, and the way there. A point p relative
 * to the camera is at (row . p) + at, give or take rounding * (reach * max |p| + size). */
typedef struct zt_placed_hull {
    real3 rows[3];
    real3 at;
    real reach, size;
    zt_box around;
    const zt_box *boxes; /* as in zt_hull */
    int level;           /* how many times to look at the halves: 0 for box 1 alone */
} zt_placed_hull;

enum { ZT_HULLS_MAX = 32 };

/* Hulls that hold all that is placed; few, however many meshes there are. Rays that meet none
 * of them need not be asked about below. Valid until the next frame begins. */
int zt_meshes_hulls(const zt_placed_hull **hulls, const zt_meshes *meshes);

/* For the rays whose numbers are listed: finds hits nearer than the batch's `t`, and equally
 * near ones of primitives before the batch's `hit`. Distances are those of the plane of the
 * triangle found, in double precision. */
void zt_meshes_intersect(const zt_meshes *meshes, zt_batch *rays, const int32_t *list,
                         int list_count);

/* For the rays whose numbers are listed: sets `hit` to 0 where a triangle is met before `t`. */
void zt_meshes_occlude(const zt_meshes *meshes, zt_batch *rays, const int32_t *list,
                       int list_count);

/* The flat normal (unit, to either side) and a corner of triangle `part` of the placed
 * `primitive`, and the largest coordinate that its arithmetic deals with. */
void zt_meshes_surface(real3 *normal, real3 *corner, real *extent, const zt_meshes *meshes,
                       int32_t primitive, int32_t part);

#endif
