/* Reading meshes from PLY files (Greg Turk, "The PLY Polygon File Format", 1994). */
#ifndef ZT_DESCRIPTION_PLY_H
#define ZT_DESCRIPTION_PLY_H

#include <zoetrope/status.h>

#include "base/arena.h"
#include "base/diag.h"
#include "scene/mesh.h"

/* Reads ASCII and binary files of both byte orders, any order and type of properties. Polygons
 * of the element "face" become triangles as zt_triangulate says, those of fewer than three
 * corners nothing; the element "tristrips" is read too. No triangle is dropped for having no
 * area, and no vertex for being used by none, but the bounds are those of the vertices in use.
 *
 * Of `parts`, what each vertex has: normals (nx, ny, nz of any type), made unit ones, those
 * that are zero or not finite as zt_normals_complete says; and colors (red, green, blue), from
 * uchar and ushort as a display shows them, from float and double as light, negatives as 0.
 * Where not all three numbers are there, there is none.
 *
 * The arrays go to the arena. Nothing in the file is believed before it is checked: time grows
 * with its size alone, and memory stays below 20 times of that and 4 MB. ZT_EDESCRIPTION after
 * telling, with the line where there is one, for a file that is no PLY, contradicts itself, or
 * has no faces; ZT_EFILE when it cannot be read; ZT_EMEMORY. `place` is where the description
 * names the file, or NULL: it is told along. */
typedef enum zt_ply_part { ZT_PLY_NORMALS = 1, ZT_PLY_COLORS = 2 } zt_ply_part;
zt_status zt_ply_read(zt_mesh *mesh, zt_arena *arena, const char *path, unsigned parts,
                      const zt_place *place, zt_listener listener);

#endif
