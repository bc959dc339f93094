/* A mesh of triangles: numbers as a file gave them, in the mesh's own space. */
#ifndef ZT_SCENE_MESH_H
#define ZT_SCENE_MESH_H

#include <stdint.h>

#include <zoetrope/hash.h>

#include "base/vec.h"

/* Owns nothing: the arrays belong to the arena that the reader was given. */
typedef struct zt_mesh {
    /* Positions are stored as `origin` + float, so that a model far from its own origin keeps
     * its shape; the origin is zero where the file's numbers fit floats as they are. */
    vec3 origin;
    const float *positions; /* vertex_count * 3, and at least one more float to read behind */
    const uint32_t *triangles; /* triangle_count * 3 indices of vertices, each < vertex_count */
    const float *normals;      /* vertex_count * 3, unit; NULL where there are none */
    const float *colors;       /* vertex_count * 3, linear light; NULL where there are none */
    int32_t vertex_count, triangle_count;
    vec3 low, high; /* bounds of the positions with `origin` added */
} zt_mesh;

/* Corner 0, 1 or 2 of a triangle in the mesh's space. */
static inline vec3 zt_mesh_corner(const zt_mesh *mesh, int32_t triangle, int corner) {
    const float *p =
        mesh->positions + 3 * (int64_t)mesh->triangles[3 * (int64_t)triangle + corner];
    return vec3_add(mesh->origin, (vec3){(double)p[0], (double)p[1], (double)p[2]});
}

/* How often the surface winds around a point of the mesh's space: 1 within a closed mesh and 0
 * outside, shares of it where the mesh has holes; negative where it is wound inside out. The
 * sum of the solid angles of all triangles (van Oosterom and Strackee, "The solid angle of a
 * plane triangle", IEEE Trans. Biomed. Eng. 30(2), 1983; Jacobson, Kavan and Sorkine-Hornung,
 * "Robust inside-outside segmentation using generalized winding numbers", 2013). */
double zt_mesh_winding(const zt_mesh *mesh, vec3 point);

/* A hash of all that it holds. */
zt_hash zt_mesh_content(const zt_mesh *mesh);

#endif
