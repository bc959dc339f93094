/* Random scenes of things of all kinds that move or do not, with a model whose triangles are
 * also models of their own. */
#ifndef ZT_TESTS_CULLED_SCENES_H
#define ZT_TESTS_CULLED_SCENES_H

#include "scenes.h"

/* The triangles of the whole along a bow, far from its own origin, but for the last ones, which
 * nearly lie on each other. A model of one triangle also has some without area, which no ray
 * meets, so that its bounds are those of the whole and rays are taken to its space in the same
 * way. */
enum { PARTS = 30, LAYERS = 12, FLAT = 3, MODELS = 1 + PARTS };
static float positions[PARTS * 9 + 1];
static uint32_t whole[PARTS * 3], pieces[PARTS][(1 + FLAT) * 3];
static zt_mesh models[MODELS];

static inline void make_models(uint64_t *seed) {
    uint32_t least[3] = {0, 0, 0}, most[3] = {0, 0, 0};
    zt_mesh mesh = {.origin = {1000, -2000, 500},
                    .positions = positions,
                    .triangles = whole,
                    .vertex_count = PARTS * 3,
                    .triangle_count = PARTS,
                    .low = {INFINITY, INFINITY, INFINITY},
                    .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = 0; i < PARTS * 3; i++) {
        double along = 4.0 * (i / 3) / PARTS;
        vec3 p = vec3_add((vec3){2 * cos(along), 2 * sin(along), along / 2},
                          vec3_scale(test_direction(seed), .6));
        whole[i] = i;
        float *at = positions + 3 * (size_t)i;
        at[0] = (float)p.x, at[1] = (float)p.y, at[2] = (float)p.z;
        if (i / 3 > PARTS - LAYERS)
            for (int axis = 0; axis < 3; axis++) at[axis] = at[axis - 9] + 0x1p-17f;
        vec3 v = vec3_add(mesh.origin, (vec3){(double)at[0], (double)at[1], (double)at[2]});
        mesh.low = vec3_min(mesh.low, v);
        mesh.high = vec3_max(mesh.high, v);
        for (int axis = 0; axis < 3; axis++) {
            if (at[axis] < positions[3 * least[axis] + axis]) least[axis] = i;
            if (at[axis] > positions[3 * most[axis] + axis]) most[axis] = i;
        }
    }
    models[0] = mesh;
    for (int k = 0; k < PARTS; k++) {
        for (int i = 0; i < 3; i++) pieces[k][i] = whole[3 * k + i];
        for (int axis = 0; axis < FLAT; axis++) {
            uint32_t *flat = pieces[k] + 3 + 3 * axis;
            flat[0] = flat[1] = least[axis];
            flat[2] = most[axis];
        }
        models[1 + k] = mesh;
        models[1 + k].triangles = pieces[k];
        models[1 + k].triangle_count = 1 + FLAT;
    }
}

static inline void random_solid(zt_object *o, uint64_t *seed, vec3 at, double size) {
    vec3 axis = test_direction(seed);
    vec3 end = vec3_add(at, vec3_scale(axis, size * test_between(seed, .2, 2)));
    double radius = size * test_between(seed, .2, 1);
    switch (o->shape) {
    case ZT_SHAPE_SPHERE:
        o->sphere = (zt_sphere){at, radius};
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++)
            o->triangle.vertices[i] =
                vec3_add(at, vec3_scale(test_direction(seed), 1.5 * size));
        break;
    case ZT_SHAPE_DISK:
        o->disk = (zt_disk){at, axis, radius};
        break;
    case ZT_SHAPE_BOX:
        o->box.center = at;
        o->box.size = (vec3){radius, size * test_between(seed, .1, 2), size};
        o->box.rotation = quat_axis_angle(axis, test_between(seed, 0, 6));
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CAPSULE:
        o->tube = (zt_tube){at, end, radius / 2, 0};
        break;
    case ZT_SHAPE_CONE:
        o->tube = (zt_tube){at, end, radius, radius * fmax(0, test_between(seed, -1, 1))};
        break;
    case ZT_SHAPE_TORUS:
        o->torus = (zt_torus){at, axis, radius, radius * test_between(seed, .05, 1)};
        break;
    default:
        break;
    }
}

static inline vec3 random_scale(uint64_t *seed) {
    return (vec3){exp(test_between(seed, -1, 1)), exp(test_between(seed, -1, 1)),
                  -exp(test_between(seed, -1, 1))};
}

static inline quat random_turn(uint64_t *seed) {
    return quat_axis_angle(test_direction(seed), test_between(seed, 0, 6));
}

/* So that the model's middle comes to somewhere near. */
static inline void place_mesh(zt_object *o, uint64_t *seed, vec3 at, double size) {
    o->mesh = 0;
    zt_placement *p = &o->placement;
    *p = (zt_placement){{0, 0, 0}, random_turn(seed), vec3_scale(random_scale(seed), size)};
    xform place = xform_place(p->position, p->rotation, p->scale);
    p->position = vec3_sub(at, xform_point(&place, models[0].origin));
}

/* Things of all kinds and sizes, by themselves and in groups that shear them. */
static inline void make_scene(test_scene *s, uint64_t *seed, int things) {
    scene_begin(s);
    scene_material(s, (vec3){1, 1, 1}, .5);
    s->scene.meshes = models;
    s->scene.mesh_count = MODELS;
    int32_t groups[3] = {-1};
    for (int i = 1; i < 3; i++) {
        zt_object *group = scene_object(s, ZT_SHAPE_GROUP, -1);
        groups[i] = s->scene.object_count - 1;
        group->parent = groups[i - 1];
        group->placement = (zt_placement){vec3_scale(test_direction(seed), .5),
                                          random_turn(seed), random_scale(seed)};
    }
    for (int i = 0; i < things; i++) {
        zt_shape shape = (zt_shape)(test_random(seed) * ZT_SHAPE_GROUP);
        if (shape == ZT_SHAPE_PLANE && i % 4) shape = ZT_SHAPE_SPHERE;
        zt_object *o = scene_object(s, shape, 0);
        o->parent = groups[(int)(test_random(seed) * 3)];
        double size = exp(test_between(seed, -4, .5));
        vec3 at = vec3_scale(test_direction(seed), test_between(seed, .5, 6));
        if (shape == ZT_SHAPE_PLANE)
            o->plane = (zt_plane){test_direction(seed), test_between(seed, 4, 9)};
        else if (shape == ZT_SHAPE_MESH)
            place_mesh(o, seed, at, size / 2);
        else
            random_solid(o, seed, at, size);
    }
    s->scene.camera.position = vec3_scale(test_direction(seed), exp(test_between(seed, -2, 4)));
    /* Shells, as near to each other as things may be that are not the same. */
    vec3 at = vec3_scale(test_direction(seed), 4);
    if (things % 4 == 0) at = vec3_add(s->scene.camera.position, vec3_scale(at, .1));
    double gap = 8 * 0x1p-20 * (vec3_length(s->scene.camera.position) + 5);
    for (int i = 0; i < things / 3; i++) scene_sphere(s, at, .5 + i * gap, 0);
    for (int i = 0; i < 3; i++)
        scene_point_light(s, vec3_scale(test_direction(seed), test_between(seed, 0, 9)), 1);
}

/* Carries, turns and grows about half of the things, by more at each moment. */
static inline void carry(test_scene *s, uint64_t seed, double amount) {
    for (int32_t i = 0; i < s->scene.object_count; i++) {
        zt_object *o = &s->objects[i];
        vec3 way = vec3_scale(test_direction(&seed), amount * test_random(&seed));
        vec3 axis = test_direction(&seed);
        bool turns = o->shape == ZT_SHAPE_MESH || o->shape == ZT_SHAPE_GROUP;
        if (test_random(&seed) < (o->shape == ZT_SHAPE_GROUP ? .8 : .5)) continue;
        if (o->shape == ZT_SHAPE_PLANE)
            o->plane.distance += amount;
        else if (o->shape == ZT_SHAPE_TRIANGLE)
            o->triangle.vertices[0] = vec3_add(o->triangle.vertices[0], way);
        else if (o->shape >= ZT_SHAPE_CYLINDER && o->shape <= ZT_SHAPE_CAPSULE &&
                 o->shape != ZT_SHAPE_TORUS) {
            o->tube.from = vec3_add(o->tube.from, way);
            o->tube.radius *= 1 + .3 * amount;
        } else if (turns) {
            o->placement.rotation =
                quat_mul(quat_axis_angle(axis, .5 * amount), o->placement.rotation);
            o->placement.position = vec3_add(o->placement.position, way);
        } else { /* they all begin with their centers */
            o->sphere.center = vec3_add(o->sphere.center, way);
        }
    }
}

#endif
