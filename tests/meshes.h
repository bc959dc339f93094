/* Meshes that tests make themselves. */
#ifndef ZT_TESTS_MESHES_H
#define ZT_TESTS_MESHES_H

#include <stdbool.h>
#include <stdlib.h>

#include "scene/mesh.h"

/* The cube from -1 to 1, wound outward. Constant. */
static inline zt_mesh cube_mesh(void) {
    static const float positions[] = {-1, -1, -1, 1,  -1, -1, -1, 1, -1, 1, 1, -1, -1,
                                      -1, 1,  1,  -1, 1,  -1, 1,  1, 1,  1, 1, 0};
    static const uint32_t triangles[] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                         2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return (zt_mesh){.positions = positions,
                     .triangles = triangles,
                     .vertex_count = 8,
                     .triangle_count = 12,
                     .low = {-1, -1, -1},
                     .high = {1, 1, 1}};
}

/* The square from -1 to 1 across y. Constant. */
static inline zt_mesh square_mesh(void) {
    static const float positions[] = {-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1, 0};
    static const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    return (zt_mesh){.positions = positions,
                     .triangles = triangles,
                     .vertex_count = 4,
                     .triangle_count = 2,
                     .low = {-1, 0, -1},
                     .high = {1, 0, 1}};
}

/* An octahedron whose triangles are cut into four so many times, each corner moved to the unit
 * sphere; its normals are its corners. Corners are not shared. */
typedef struct ball_mesh {
    zt_mesh mesh;
    float *positions;
    uint32_t *triangles;
} ball_mesh;

static inline void ball_cut(ball_mesh *ball, vec3 a, vec3 b, vec3 c, int times) {
    if (times == 0) {
        const vec3 corners[3] = {a, b, c};
        for (int i = 0; i < 3; i++) {
            float *p = ball->positions + 3 * (size_t)ball->mesh.vertex_count;
            p[0] = (float)corners[i].x, p[1] = (float)corners[i].y, p[2] = (float)corners[i].z;
            ball->triangles[ball->mesh.vertex_count] = (uint32_t)ball->mesh.vertex_count;
            ball->mesh.vertex_count++;
        }
        ball->mesh.triangle_count++;
        return;
    }
    vec3 ab = vec3_normalize(vec3_add(a, b)), bc = vec3_normalize(vec3_add(b, c)),
         ca = vec3_normalize(vec3_add(c, a));
    ball_cut(ball, a, ab, ca, times - 1);
    ball_cut(ball, ab, b, bc, times - 1);
    ball_cut(ball, ca, bc, c, times - 1);
    ball_cut(ball, ab, bc, ca, times - 1);
}

static inline ball_mesh make_ball(int times) {
    size_t corners = (size_t)24 << 2 * times;
    ball_mesh ball = {.positions = calloc(3 * corners + 1, sizeof(float)),
                      .triangles = calloc(corners, sizeof(uint32_t))};
    if (!ball.positions || !ball.triangles) abort();
    for (int i = 0; i < 8; i++) {
        vec3 x = {i & 1 ? -1 : 1, 0, 0}, y = {0, i & 2 ? -1 : 1, 0}, z = {0, 0, i & 4 ? -1 : 1};
        bool turned = (i & 1) ^ (i >> 1 & 1) ^ (i >> 2);
        ball_cut(&ball, x, turned ? z : y, turned ? y : z, times);
    }
    ball.mesh.positions = ball.mesh.normals = ball.positions;
    ball.mesh.triangles = ball.triangles;
    ball.mesh.low = (vec3){-1, -1, -1};
    ball.mesh.high = (vec3){1, 1, 1};
    return ball;
}

static inline void free_ball(ball_mesh *ball) {
    free(ball->positions);
    free(ball->triangles);
}

#endif
