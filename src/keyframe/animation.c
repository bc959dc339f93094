#include "keyframe/animation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A copy of an array in the arena; NULL when out of memory. */
static void *copy(zt_arena *arena, const void *array, size_t element_size, int32_t count) {
    void *own = zt_arena_push_array(arena, element_size, (size_t)count);
    if (own && count) memcpy(own, array, element_size * (size_t)count);
    return own;
}

/* Between its keys a curve may overshoot, but no radius becomes negative. */
static void keep_in_range(double *value, const zt_property *property) {
    const double unit =
        property->unit ? 3.14159265358979323846 / 180 : 1; /* "deg" is the only one */
    for (int c = 0; c < zt_value_width(property->kind); c++)
        value[c] = fmin(fmax(value[c], property->min * unit), property->max * unit);
}

zt_status zt_animation_freeze(zt_scene *scene, const zt_animation *animation, double time_s,
                              zt_arena *arena) {
    const zt_scene *rest = &animation->rest;
    *scene = *rest;
    scene->materials =
        copy(arena, rest->materials, sizeof *rest->materials, rest->material_count);
    scene->lights = copy(arena, rest->lights, sizeof *rest->lights, rest->light_count);
    scene->objects = copy(arena, rest->objects, sizeof *rest->objects, rest->object_count);
    if (!scene->materials || !scene->lights || !scene->objects) return ZT_EMEMORY;
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        double value[ZT_VALUE_WIDTH_MAX];
        zt_curve_eval(value, &track->curve, time_s);
        keep_in_range(value, track->property);
        zt_property_set(track->property, scene, track->index, value);
    }
    return ZT_OK;
}

void zt_animation_free(zt_animation **animation) {
    if (!*animation) return;
    zt_arena_free(&(*animation)->arena);
    free(*animation);
    *animation = NULL;
}

const zt_film *zt_animation_film(const zt_animation *animation) { return &animation->film; }

zt_contents zt_animation_contents(const zt_animation *animation) {
    const zt_scene *scene = &animation->rest;
    zt_contents contents = {.material_count = scene->material_count,
                            .track_count = animation->track_count};
    for (int32_t i = 0; i < scene->object_count; i++) switch (scene->objects[i].shape) {
        case ZT_SHAPE_PLANE:
            contents.plane_count++;
            break;
        case ZT_SHAPE_SPHERE:
            contents.sphere_count++;
            break;
        case ZT_SHAPE_TRIANGLE:
            contents.triangle_count++;
            break;
        case ZT_SHAPE_GROUP:
            contents.group_count++;
            break;
        case ZT_SHAPE_MESH:
            contents.mesh_count++;
            contents.mesh_triangle_count +=
                scene->meshes[scene->objects[i].mesh].triangle_count;
            break;
        case ZT_SHAPE_COUNT:
            break;
        }
    for (int32_t i = 0; i < scene->light_count; i++)
        if (scene->lights[i].kind == ZT_LIGHT_AMBIENT)
            contents.ambient_light_count++;
        else
            contents.point_light_count++;
    return contents;
}

zt_movement zt_animation_movement(const zt_animation *animation, int index) {
    const zt_track *track = &animation->tracks[index];
    const zt_curve *curve = &track->curve;
    return (zt_movement){.name = track->name,
                         .curve = zt_curve_label(curve),
                         .key_count = curve->key_count,
                         .first_s = curve->times[0],
                         .last_s = curve->times[curve->key_count - 1]};
}
