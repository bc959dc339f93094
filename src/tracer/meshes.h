/* Triangle meshes, and what makes them fast to hit: the run owns a hierarchy and a hull for
 * each mesh, in the mesh's own space, built when a ray first enters its bounds, and hierarchies
 * of what a frame has many of. */
#ifndef ZT_TRACER_MESHES_H
#define ZT_TRACER_MESHES_H

#include <stdatomic.h>
#include <stdbool.h>

#include <zoetrope/status.h>

#include "scene/mesh.h"
#include "tracer/bvh.h"
#include "tracer/clusters.h"
#include "tracer/hull.h"

typedef struct zt_meshes zt_meshes;

/* `meshes` must outlive the result. What is built is built with `threads` threads. */
zt_status zt_meshes_open(zt_meshes **out, const zt_mesh *meshes, int32_t mesh_count,
                         int threads, zt_listener listener);
void zt_meshes_close(zt_meshes **meshes);

/* What is built of one mesh, `origin` left out. */
typedef struct zt_built_mesh {
    const zt_mesh *mesh;
    zt_meshes *owner;
    zt_hash content;   /* of the mesh */
    zt_bvh_box around; /* the mesh, and a little more where it has an origin */
    atomic_bool built; /* there is what follows: */
    zt_clusters clusters;
    zt_bvh *bvh; /* over their boxes */
    zt_hull *hull;
} zt_built_mesh;

/* Has Embree load, and all threads start that will build; also where nothing is built yet.
 * Fails, and tells it, where that cannot be. */
zt_status zt_meshes_start(zt_meshes *meshes);

/* All that a mesh needs before any ray. Fails, and tells it, where it cannot be built. */
zt_status zt_meshes_begin(zt_built_mesh **built, zt_meshes *meshes, int32_t mesh);

/* Has a mesh built that was begun, and is not. Legal from several threads: one builds, others
 * wait. False where that fails: then it is never met, and zt_meshes_status() says why. */
bool zt_meshes_build(zt_built_mesh *built);

static inline bool zt_mesh_is_built(const zt_built_mesh *built) {
    return atomic_load_explicit(&built->built, memory_order_acquire);
}

/* Whether mesh number `mesh` is built: rays came near it. */
bool zt_meshes_met(const zt_meshes *meshes, int32_t mesh);

/* Of all that was built so far; to be asked once rays have been traced. */
zt_status zt_meshes_status(const zt_meshes *meshes);

/* More bounded things than this are a crowd: they are asked through a hierarchy. */
enum { ZT_SINGLE_MAX = 32 };

/* A hierarchy over boxes: one that serves one frame; or, of what `stays`, one that is kept for
 * as long as the boxes are the same. */
zt_status zt_meshes_crowd(const zt_bvh **crowd, zt_meshes *meshes, bool stays,
                          const zt_bvh_box *boxes, int32_t count);

#endif
