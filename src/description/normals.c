#include "description/normals.h"

#include <stdbool.h>

/* The unit normal of a triangle; zero where it has no area. */
static vec3 face_normal(const vec3 corners[3]) {
    return vec3_normalize(
        vec3_cross(vec3_sub(corners[1], corners[0]), vec3_sub(corners[2], corners[0])));
}

/* Of two vectors, as exact near 0 and half a turn as anywhere. */
static double angle_between(vec3 a, vec3 b) {
    return atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b));
}

static void find_corners(vec3 corners[3], const zt_mesh *mesh, int32_t triangle) {
    for (int i = 0; i < 3; i++) corners[i] = zt_mesh_corner(mesh, triangle, i);
}

static void add_face(vec3 *sums, const zt_mesh *mesh, int32_t triangle) {
    vec3 corners[3];
    find_corners(corners, mesh, triangle);
    vec3 normal = face_normal(corners);
    if (vec3_max_abs(normal) == 0) return;
    for (int i = 0; i < 3; i++) {
        vec3 *sum = &sums[mesh->triangles[3 * (int64_t)triangle + i]], at = corners[i];
        double angle = angle_between(vec3_sub(corners[(i + 1) % 3], at),
                                     vec3_sub(corners[(i + 2) % 3], at));
        *sum = vec3_add(*sum, vec3_scale(normal, angle));
    }
}

/* Vertices whose triangles cancel each other out take what one of them says. */
static void add_face_to_empty(vec3 *sums, const zt_mesh *mesh, int32_t triangle) {
    const double least = 1e-9; /* the sum of two that face each other is a rounding, not 0 */
    vec3 corners[3];
    find_corners(corners, mesh, triangle);
    for (int i = 0; i < 3; i++) {
        vec3 *sum = &sums[mesh->triangles[3 * (int64_t)triangle + i]];
        if (vec3_max_abs(*sum) < least) *sum = face_normal(corners);
    }
}

static bool is_given(const float *n) { return n[0] != 0 || n[1] != 0 || n[2] != 0; }

/* 1, or -1 where the normals that are given point to the other side than the triangles wind. */
static double side_of_given(const float *normals, const vec3 *sums, int32_t vertex_count) {
    double agreed = 0;
    for (int64_t i = 0; i < vertex_count; i++) {
        const float *n = normals + 3 * i;
        agreed += vec3_dot((vec3){(double)n[0], (double)n[1], (double)n[2]}, sums[i]);
    }
    return agreed < 0 ? -1 : 1;
}

zt_status zt_normals_complete(float *normals, const zt_mesh *mesh) {
    zt_arena scratch = {0};
    vec3 *sums = ZT_PUSH(&scratch, vec3, (size_t)mesh->vertex_count);
    if (!sums) return ZT_EMEMORY;
    for (int32_t i = 0; i < mesh->triangle_count; i++) add_face(sums, mesh, i);
    for (int32_t i = 0; i < mesh->triangle_count; i++) add_face_to_empty(sums, mesh, i);
    double side = side_of_given(normals, sums, mesh->vertex_count);
    for (int64_t i = 0; i < mesh->vertex_count; i++) {
        float *n = normals + 3 * i;
        if (is_given(n)) continue;
        vec3 sum = vec3_normalize(vec3_scale(sums[i], side));
        if (vec3_max_abs(sum) == 0) sum.y = 1; /* no triangle with an area has it */
        n[0] = (float)sum.x;
        n[1] = (float)sum.y;
        n[2] = (float)sum.z;
    }
    zt_arena_free(&scratch);
    return ZT_OK;
}

zt_status zt_normals_make(zt_mesh *mesh, zt_arena *arena) {
    float *normals = ZT_PUSH(arena, float, 3 * (size_t)mesh->vertex_count);
    if (!normals) return ZT_EMEMORY;
    mesh->normals = normals;
    return zt_normals_complete(normals, mesh);
}
