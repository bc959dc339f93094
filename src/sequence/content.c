/* What random numbers are keyed by: hashes of what an exposure holds, number by number, since
 * structs have bytes between their fields that say nothing. */
#include "base/hash.h"
#include "base/random.h"
#include "sequence/shutter.h"

enum { NUMBERS_MAX = 512 };

/* Numbers that are hashed together, and what those before them came to. */
typedef struct stream {
    uint64_t key, other; /* two words that are made in different orders */
    int count;
    double numbers[NUMBERS_MAX];
} stream;

static void flush(stream *s) {
    zt_hash hash = zt_hash_bytes(s->numbers, (size_t)s->count * sizeof *s->numbers);
    s->key = zt_random_key(zt_random_key(s->key, hash.high), hash.low);
    s->other = zt_random_key(zt_random_key(s->other, hash.low), hash.high);
    s->count = 0;
}

static void put(stream *s, double number) {
    s->numbers[s->count++] = number + 0.0; /* -0 is 0 */
    if (s->count == NUMBERS_MAX) flush(s);
}

static void put_vec(stream *s, vec3 v) {
    put(s, v.x);
    put(s, v.y);
    put(s, v.z);
}

static void put_quat(stream *s, quat q) {
    put(s, q.w);
    put_vec(s, (vec3){q.x, q.y, q.z});
}

static void put_camera(stream *s, const zt_camera *c) {
    put_vec(s, c->position);
    put_vec(s, c->look_at);
    put_vec(s, c->up);
    put_quat(s, c->rotation);
    put_vec(s, c->focus_on);
    const double numbers[] = {c->aimed,         c->roll,           c->lens,    c->fov,
                              c->focal_length,  c->sensor_height,  c->height,  c->aperture,
                              c->f_number,      c->focus_distance, c->focused, c->blades,
                              c->blade_rotation};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) put(s, numbers[i]);
}

static void put_shape(stream *s, const zt_object *o) {
    switch (o->shape) {
    case ZT_SHAPE_PLANE:
        put_vec(s, o->plane.normal);
        put(s, o->plane.distance);
        break;
    case ZT_SHAPE_SPHERE:
        put_vec(s, o->sphere.center);
        put(s, o->sphere.radius);
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++) put_vec(s, o->triangle.vertices[i]);
        break;
    case ZT_SHAPE_DISK:
        put_vec(s, o->disk.center);
        put_vec(s, o->disk.normal);
        put(s, o->disk.radius);
        break;
    case ZT_SHAPE_BOX:
        put_vec(s, o->box.center);
        put_vec(s, o->box.size);
        put_quat(s, o->box.rotation);
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
    case ZT_SHAPE_CAPSULE:
        put_vec(s, o->tube.from);
        put_vec(s, o->tube.to);
        put(s, o->tube.radius);
        put(s, o->tube.end_radius);
        break;
    case ZT_SHAPE_TORUS:
        put_vec(s, o->torus.center);
        put_vec(s, o->torus.axis);
        put(s, o->torus.radius);
        put(s, o->torus.tube_radius);
        break;
    case ZT_SHAPE_MESH:
    case ZT_SHAPE_GROUP:
        put_vec(s, o->placement.position);
        put_quat(s, o->placement.rotation);
        put_vec(s, o->placement.scale);
        break;
    case ZT_SHAPE_COUNT:
        break;
    }
}

static void put_object(stream *s, const zt_object *o, int32_t index) {
    const int32_t numbers[] = {index,   (int32_t)o->shape, o->parent,       o->material,
                               o->mesh, o->smooth,         o->vertex_colors};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) put(s, numbers[i]);
    put_shape(s, o);
}

static void put_material(stream *s, const zt_material *m, int32_t index) {
    put(s, index);
    put(s, m->pattern);
    put_vec(s, m->color);
    put(s, m->reflectivity);
    put_vec(s, m->other_color);
    put(s, m->pattern_size);
    put_vec(s, m->pattern_direction);
}

static void put_light(stream *s, const zt_light *l, int32_t index) {
    put(s, index);
    put(s, l->kind);
    put_vec(s, l->color);
    put(s, l->intensity);
    put_vec(s, l->position);
    put(s, l->shadows);
    put(s, l->radius);
    put_quat(s, l->rotation);
    put(s, l->width);
    put(s, l->height);
}

/* All of a scene; of a later moment only what is not as at the first one. */
static void put_scene(stream *s, const zt_scene *scene, const zt_scene *first) {
    bool all = scene == first;
    put_camera(s, &scene->camera);
    put(s, scene->reflection_depth);
    for (int32_t i = 0; i < scene->object_count; i++)
        if (all || !zt_object_equal(&scene->objects[i], &first->objects[i]))
            put_object(s, &scene->objects[i], i);
    for (int32_t i = 0; i < scene->material_count; i++)
        if (all || !zt_material_equal(&scene->materials[i], &first->materials[i]))
            put_material(s, &scene->materials[i], i);
    for (int32_t i = 0; i < scene->light_count; i++)
        if (all || !zt_light_equal(&scene->lights[i], &first->lights[i]))
            put_light(s, &scene->lights[i], i);
}

/* All of its moments. */
static void put_exposure(stream *s, const zt_exposure *exposure) {
    const zt_scene *moments = exposure->moments;
    const int32_t last = exposure->moment_count - 1;
    for (int32_t i = 0; i <= last; i++) {
        if (last > 0) {
            put(s, exposure->times[i]);
            put(s, i < last && exposure->steps[i]);
        }
        put_scene(s, &moments[i], moments);
    }
}

zt_hash zt_shutter_content(const zt_exposure *exposure) {
    const zt_scene *first = exposure->moments;
    stream s;
    s.key = s.other = 0;
    s.count = 0;
    put(&s, exposure->moment_count);
    put(&s, first->object_count);
    put(&s, first->material_count);
    put(&s, first->light_count);
    put_exposure(&s, exposure);
    flush(&s);
    return (zt_hash){s.key, s.other};
}

zt_hash zt_shutter_view(const zt_exposure *exposure) {
    const zt_camera *first = &exposure->moments->camera;
    bool moves = false;
    stream s;
    s.key = s.other = 0;
    s.count = 0;
    put_camera(&s, first);
    for (int32_t i = 1; i < exposure->moment_count; i++)
        moves |= !zt_camera_equal(&exposure->moments[i].camera, first);
    /* Of a still one, what else moves may ask for more moments or fewer. */
    for (int32_t i = 1; moves && i < exposure->moment_count; i++) {
        put(&s, exposure->times[i]);
        put(&s, exposure->steps[i - 1]);
        put_camera(&s, &exposure->moments[i].camera);
    }
    flush(&s);
    return (zt_hash){s.key, s.other};
}

void zt_shutter_keys(uint64_t *place_key, uint64_t *frame_key, const zt_exposure *exposure,
                     const zt_sampling *sampling) {
    const uint64_t seed = zt_random_key(0, sampling->seed);
    const zt_scene *moments = exposure->moments;
    const int32_t last = exposure->moment_count - 1;
    *place_key = *frame_key = seed;
    if (sampling->seed_fixed) return;
    stream s;
    s.key = s.other = seed;
    s.count = 0;
    put_camera(&s, &moments[0].camera);
    put_camera(&s, &moments[last].camera);
    flush(&s);
    *place_key = s.key;
    put_exposure(&s, exposure);
    flush(&s);
    *frame_key = s.key;
}
