/* Reading meshes from PLY files (Greg Turk, "The PLY Polygon File Format", 1994). */
#ifndef ZT_DESCRIPTION_PLY_H
#define ZT_DESCRIPTION_PLY_H

#include <zoetrope/status.h>

#include "base/arena.h"
#include "base/diag.h"
#include "scene/mesh.h"

/* Reads ASCII and binary files of both byte orders, any order and type of properties; polygons are
 * triangulated as fans or, where they are not convex, by clipping ears. The arrays go to the arena.
 * Nothing in the file is believed before it is checked: memory stays within a small multiple of
 * the file's size. ZT_EDESCRIPTION after telling, with the place in the PLY file where that helps,
 * for a file that is no legal PLY, has no vertices or no faces; ZT_EFILE when it cannot be read.
 * `place` is where the description names the file, or NULL; told along as a note's place. */
zt_status zt_ply_read(zt_mesh *mesh, zt_arena *arena, const char *path, const zt_place *place,
                      zt_listener listener);

#endif
