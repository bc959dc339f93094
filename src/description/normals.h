/* Normals of vertices for meshes whose files have none. */
#ifndef ZT_DESCRIPTION_NORMALS_H
#define ZT_DESCRIPTION_NORMALS_H

#include <zoetrope/status.h>

#include "base/arena.h"
#include "scene/mesh.h"

/* Gives each vertex whose three numbers in `normals` are zero a unit one: the sum of the
 * normals of the triangles that have this very vertex, each as much as the angle it has there
 * (Thuermer and Wuethrich, "Computing vertex normals from polygonal facets", Journal of
 * Graphics Tools 3(1), 1998), on the side that most of the given ones are on. Where the sum is
 * nothing, the normal of one of the triangles. ZT_EMEMORY. */
zt_status zt_normals_complete(float *normals, const zt_mesh *mesh);

/* Makes all of a mesh's normals, in the arena. ZT_EMEMORY. */
zt_status zt_normals_make(zt_mesh *mesh, zt_arena *arena);

#endif
