/* What random numbers are keyed by: hashes of what an exposure holds, number by number, since
 * structs have bytes between their fields that say nothing. */
#include <string.h>

#include "base/hash.h"
#include "base/random.h"
#include "sequence/shutter.h"

enum { NUMBERS_MAX = 64 };

/* Numbers that are hashed together. */
typedef struct bundle {
    double numbers[NUMBERS_MAX];
    int count;
} bundle;

static void put(bundle *b, double number) {
    b->numbers[b->count++] = number + 0.0; /* -0 is 0 */
}

static void put_vec(bundle *b, vec3 v) {
    put(b, v.x);
    put(b, v.y);
    put(b, v.z);
}

static void put_quat(bundle *b, quat q) {
    put(b, q.w);
    put_vec(b, (vec3){q.x, q.y, q.z});
}

static uint64_t add(uint64_t key, const bundle *b) {
    zt_hash hash = zt_hash_bytes(b->numbers, (size_t)b->count * sizeof *b->numbers);
    return zt_random_key(zt_random_key(key, hash.high), hash.low);
}

static uint64_t add_camera(uint64_t key, const zt_camera *c) {
    bundle b = {.count = 0};
    put_vec(&b, c->position);
    put_vec(&b, c->look_at);
    put_vec(&b, c->up);
    put_quat(&b, c->rotation);
    put_vec(&b, c->focus_on);
    const double numbers[] = {c->aimed,         c->roll,           c->lens,    c->fov,
                              c->focal_length,  c->sensor_height,  c->height,  c->aperture,
                              c->f_number,      c->focus_distance, c->focused, c->blades,
                              c->blade_rotation};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) put(&b, numbers[i]);
    return add(key, &b);
}

static void put_shape(bundle *b, const zt_object *o) {
    switch (o->shape) {
    case ZT_SHAPE_PLANE:
        put_vec(b, o->plane.normal);
        put(b, o->plane.distance);
        break;
    case ZT_SHAPE_SPHERE:
        put_vec(b, o->sphere.center);
        put(b, o->sphere.radius);
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++) put_vec(b, o->triangle.vertices[i]);
        break;
    case ZT_SHAPE_DISK:
        put_vec(b, o->disk.center);
        put_vec(b, o->disk.normal);
        put(b, o->disk.radius);
        break;
    case ZT_SHAPE_BOX:
        put_vec(b, o->box.center);
        put_vec(b, o->box.size);
        put_quat(b, o->box.rotation);
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
    case ZT_SHAPE_CAPSULE:
        put_vec(b, o->tube.from);
        put_vec(b, o->tube.to);
        put(b, o->tube.radius);
        put(b, o->tube.end_radius);
        break;
    case ZT_SHAPE_TORUS:
        put_vec(b, o->torus.center);
        put_vec(b, o->torus.axis);
        put(b, o->torus.radius);
        put(b, o->torus.tube_radius);
        break;
    case ZT_SHAPE_MESH:
    case ZT_SHAPE_GROUP:
        put_vec(b, o->placement.position);
        put_quat(b, o->placement.rotation);
        put_vec(b, o->placement.scale);
        break;
    case ZT_SHAPE_COUNT:
        break;
    }
}

static uint64_t add_object(uint64_t key, const zt_object *o, int32_t index) {
    bundle b = {.count = 0};
    const int32_t numbers[] = {index,   (int32_t)o->shape, o->parent,       o->material,
                               o->mesh, o->smooth,         o->vertex_colors};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) put(&b, numbers[i]);
    put_shape(&b, o);
    return add(key, &b);
}

static uint64_t add_material(uint64_t key, const zt_material *m, int32_t index) {
    bundle b = {.count = 0};
    put(&b, index);
    put(&b, m->pattern);
    put_vec(&b, m->color);
    put(&b, m->reflectivity);
    put_vec(&b, m->other_color);
    put(&b, m->pattern_size);
    put_vec(&b, m->pattern_direction);
    return add(key, &b);
}

static uint64_t add_light(uint64_t key, const zt_light *l, int32_t index) {
    bundle b = {.count = 0};
    put(&b, index);
    put(&b, l->kind);
    put_vec(&b, l->color);
    put(&b, l->intensity);
    put_vec(&b, l->position);
    put(&b, l->shadows);
    put(&b, l->radius);
    put_quat(&b, l->rotation);
    put(&b, l->width);
    put(&b, l->height);
    return add(key, &b);
}

/* All of a scene; of a later moment only what is not as at the first one. Scenes of one
 * exposure are copies of one, so that bytes of equal things are equal. */
static uint64_t add_scene(uint64_t key, const zt_scene *scene, const zt_scene *first) {
    bool all = scene == first;
    key = add_camera(key, &scene->camera);
    key = zt_random_key(key, (uint64_t)scene->reflection_depth);
    for (int32_t i = 0; i < scene->object_count; i++)
        if (all || memcmp(&scene->objects[i], &first->objects[i], sizeof *scene->objects) != 0)
            key = add_object(key, &scene->objects[i], i);
    for (int32_t i = 0; i < scene->material_count; i++)
        if (all ||
            memcmp(&scene->materials[i], &first->materials[i], sizeof *scene->materials) != 0)
            key = add_material(key, &scene->materials[i], i);
    for (int32_t i = 0; i < scene->light_count; i++)
        if (all || memcmp(&scene->lights[i], &first->lights[i], sizeof *scene->lights) != 0)
            key = add_light(key, &scene->lights[i], i);
    return key;
}

void zt_shutter_keys(uint64_t *place_key, uint64_t *frame_key, const zt_exposure *exposure,
                     const zt_sampling *sampling) {
    const uint64_t seed = zt_random_key(0, sampling->seed);
    const zt_scene *moments = exposure->moments;
    const int32_t last = exposure->moment_count - 1;
    *place_key = *frame_key = seed;
    if (sampling->seed_fixed) return;
    *place_key = add_camera(add_camera(seed, &moments[0].camera), &moments[last].camera);
    uint64_t key = zt_random_key(seed, (uint64_t)exposure->moment_count);
    for (int32_t i = 0; i <= last; i++) {
        bundle b = {.count = 0};
        if (last > 0) {
            put(&b, exposure->times[i]);
            put(&b, i < last && exposure->steps[i]);
        }
        key = add_scene(add(key, &b), &moments[i], moments);
    }
    *frame_key = key;
}
