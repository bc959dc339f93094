/* How far points are from surfaces. For asking about a scene, not for rays. */
#ifndef ZT_SCENE_CLEARANCE_H
#define ZT_SCENE_CLEARANCE_H

#include "scene/scene.h"

/* The distance of a point of the object's space from the object's surface, negative within a
 * solid. INFINITY where there is no surface: of what has no size, and of groups; of meshes,
 * which are asked with zt_mesh_clearance; and for points that are not finite. */
double zt_clearance(const zt_object *object, vec3 point);

/* The distance of a point of a mesh's space from its nearest triangle. Looks at each of them.
 */
double zt_mesh_clearance(const zt_mesh *mesh, vec3 point);

#endif
