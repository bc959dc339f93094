/* Small scenes put together by hand, for tests below the description. */
#ifndef ZT_TESTS_SCENES_H
#define ZT_TESTS_SCENES_H

#include "scene/scene.h"

enum { SCENE_OBJECTS_MAX = 2048, SCENE_LIGHTS_MAX = 64, SCENE_MATERIALS_MAX = 8 };

typedef struct test_scene {
    zt_scene scene;
    zt_object objects[SCENE_OBJECTS_MAX];
    zt_light lights[SCENE_LIGHTS_MAX];
    zt_material materials[SCENE_MATERIALS_MAX];
} test_scene;

/* An empty scene: the eye in the origin, looking along -z with a fov of 90 degrees. */
static inline void scene_begin(test_scene *s) {
    *s = (test_scene){0};
    s->scene = (zt_scene){
        .camera = {.rotation = {1, 0, 0, 0}, .up = {0, 1, 0}, .fov = 1.57079632679489661923},
        .objects = s->objects,
        .lights = s->lights,
        .materials = s->materials,
        .reflection_depth = 4};
}

static inline int32_t scene_material(test_scene *s, vec3 color, double reflectivity) {
    s->materials[s->scene.material_count] =
        (zt_material){.color = color, .reflectivity = reflectivity};
    return s->scene.material_count++;
}

static inline zt_object *scene_object(test_scene *s, zt_shape shape, int32_t material) {
    zt_object *object = &s->objects[s->scene.object_count++];
    *object = (zt_object){.shape = shape, .parent = -1, .material = material, .mesh = -1};
    if (shape == ZT_SHAPE_MESH || shape == ZT_SHAPE_GROUP)
        object->placement = (zt_placement){{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}};
    return object;
}

static inline void scene_plane(test_scene *s, vec3 normal, double distance, int32_t material) {
    scene_object(s, ZT_SHAPE_PLANE, material)->plane = (zt_plane){normal, distance};
}

static inline void scene_sphere(test_scene *s, vec3 center, double radius, int32_t material) {
    scene_object(s, ZT_SHAPE_SPHERE, material)->sphere = (zt_sphere){center, radius};
}

static inline void scene_triangle(test_scene *s, vec3 a, vec3 b, vec3 c, int32_t material) {
    scene_object(s, ZT_SHAPE_TRIANGLE, material)->triangle = (zt_triangle){{a, b, c}};
}

static inline zt_light *scene_point_light(test_scene *s, vec3 position, double intensity) {
    zt_light *light = &s->lights[s->scene.light_count++];
    *light = (zt_light){.kind = ZT_LIGHT_POINT,
                        .color = {1, 1, 1},
                        .intensity = intensity,
                        .position = position,
                        .shadows = true};
    return light;
}

static inline void scene_ambient(test_scene *s, vec3 color, double intensity) {
    s->lights[s->scene.light_count++] =
        (zt_light){.kind = ZT_LIGHT_AMBIENT, .color = color, .intensity = intensity};
}

/* Numbers that look random and are the same in each run. */
static inline double test_random(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-53;
}
static inline double test_between(uint64_t *state, double low, double high) {
    return low + (high - low) * test_random(state);
}
static inline vec3 test_direction(uint64_t *state) {
    for (;;) {
        vec3 v = {test_between(state, -1, 1), test_between(state, -1, 1),
                  test_between(state, -1, 1)};
        if (vec3_dot(v, v) <= 1 && vec3_dot(v, v) > 1e-4) return vec3_normalize(v);
    }
}

#endif
