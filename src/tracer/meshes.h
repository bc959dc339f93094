/* Triangle meshes, and what makes them fast to hit: the run owns a hierarchy and a hull for
 * each mesh, in the mesh's own space, built when first needed, and hierarchies of what a
 * frame has many of. */
#ifndef ZT_TRACER_MESHES_H
#define ZT_TRACER_MESHES_H

#include <stdbool.h>

#include <zoetrope/status.h>

#include "scene/mesh.h"
#include "tracer/bvh.h"
#include "tracer/clusters.h"
#include "tracer/hull.h"

typedef struct zt_meshes zt_meshes;

/* `meshes` must outlive the result. Nothing is built before it is asked for; then with
 * `threads` threads. */
zt_status zt_meshes_open(zt_meshes **out, const zt_mesh *meshes, int32_t mesh_count,
                         int threads, zt_listener listener);
void zt_meshes_close(zt_meshes **meshes);

/* What is built of one mesh, `origin` left out: clusters of its triangles, the hierarchy over
 * their boxes, and the hull. */
typedef struct zt_built_mesh {
    const zt_mesh *mesh;
    zt_hash content; /* of the mesh */
    zt_clusters clusters;
    zt_bvh *bvh;
    zt_hull *hull;
} zt_built_mesh;
zt_status zt_meshes_build(const zt_built_mesh **built, zt_meshes *meshes, int32_t mesh);

/* A hierarchy over boxes: one that serves one frame; or, of what `stays`, one that is kept for
 * as long as the boxes are the same. */
zt_status zt_meshes_crowd(const zt_bvh **crowd, zt_meshes *meshes, bool stays,
                          const zt_bvh_box *boxes, int32_t count);

#endif
