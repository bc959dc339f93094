#include "keyframe/animation.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static void copy(void *own, const void *array, size_t element_size, int32_t count) {
    if (count) memcpy(own, array, element_size * (size_t)count);
}

/* Between its keys a curve may overshoot, but no radius becomes negative; nor is anything
 * larger than the largest double. */
static void keep_in_range(double *value, const zt_property *property) {
    const double unit =
        property->unit ? 3.14159265358979323846 / 180 : 1; /* "deg" is the only one */
    const double min = fmax(property->min * unit, -DBL_MAX),
                 max = fmin(property->max * unit, DBL_MAX);
    for (int c = 0; c < zt_value_width(property->kind); c++)
        value[c] = fmin(fmax(value[c], min), max);
}

/* The tube of a torus is no wider than its hole. */
static void keep_tori(zt_scene *scene) {
    for (int32_t i = 0; i < scene->object_count; i++) {
        zt_object *object = &scene->objects[i];
        if (object->shape == ZT_SHAPE_TORUS)
            object->torus.tube_radius = fmin(object->torus.tube_radius, object->torus.radius);
    }
}

static zt_status eval_formula(double *value, const zt_track *track, const zt_scene *scene,
                              const zt_animation *animation, double time_s,
                              zt_listener listener) {
    zt_expression_mistake mistake;
    zt_status status =
        zt_formula_eval(value, &track->formula, &animation->formulas, track->property->kind,
                        scene, animation->film.rate, time_s, &mistake);
    if (status != ZT_EDESCRIPTION) return status;
    zt_place place = zt_formula_place(&track->formula, &mistake);
    zt_tell_at(listener, ZT_ERROR, &place, "\"%s\" has no value at %.6g s: %s", track->name,
               time_s, mistake.text);
    return status;
}

/* The value of a track, from what the scene holds by now; `has_value` is false where it stays
 * as it is. */
static zt_status eval_track(double *value, bool *has_value, const zt_track *track,
                            const zt_scene *scene, const zt_animation *animation, double time_s,
                            zt_listener listener) {
    const zt_reference driven = {track->property, track->index};
    *has_value = true;
    switch (track->kind) {
    case ZT_TRACK_CURVE:
        zt_curve_eval(value, &track->curve, time_s);
        break;
    case ZT_TRACK_FORMULA:
        return eval_formula(value, track, scene, animation, time_s, listener);
    case ZT_TRACK_FOLLOW:
        zt_follow_eval(value, &track->follow, driven, time_s);
        break;
    case ZT_TRACK_ORBIT:
        *has_value = zt_orbit_eval(value, &track->orbit, driven, scene, time_s);
        break;
    case ZT_TRACK_OFFSET:
        zt_offset_eval(value, &track->offset, scene);
        break;
    case ZT_TRACK_LOOK_AT:
        *has_value = zt_look_at_eval(value, &track->look_at, driven, scene);
        break;
    case ZT_TRACK_KIND_COUNT:
        *has_value = false;
        break;
    }
    return ZT_OK;
}

zt_status zt_animation_freeze(zt_scene *scene, const zt_animation *animation, double time_s,
                              zt_arena *arena, zt_listener listener) {
    const zt_scene *rest = &animation->rest;
    *scene = *rest;
    scene->materials = ZT_PUSH(arena, zt_material, (size_t)rest->material_count);
    scene->lights = ZT_PUSH(arena, zt_light, (size_t)rest->light_count);
    scene->objects = ZT_PUSH(arena, zt_object, (size_t)rest->object_count);
    if (!scene->materials || !scene->lights || !scene->objects) return ZT_EMEMORY;
    return zt_animation_freeze_again(scene, animation, time_s, listener);
}

zt_status zt_animation_freeze_again(zt_scene *scene, const zt_animation *animation,
                                    double time_s, zt_listener listener) {
    const zt_scene *rest = &animation->rest;
    scene->camera = rest->camera;
    copy(scene->materials, rest->materials, sizeof *rest->materials, rest->material_count);
    copy(scene->lights, rest->lights, sizeof *rest->lights, rest->light_count);
    copy(scene->objects, rest->objects, sizeof *rest->objects, rest->object_count);
    zt_status result = ZT_OK;
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[animation->order ? animation->order[i] : i];
        double value[ZT_VALUE_WIDTH_MAX];
        bool has_value;
        zt_status status =
            eval_track(value, &has_value, track, scene, animation, time_s, listener);
        if (status == ZT_EDESCRIPTION) { /* there may be others to tell */
            result = status;
            continue;
        }
        ZT_TRY(status);
        if (!has_value) continue;
        keep_in_range(value, track->property);
        zt_property_set(track->property, scene, track->index, value);
    }
    keep_tori(scene);
    return result;
}

void zt_animation_stays(bool *stays, const zt_animation *animation) {
    const zt_scene *rest = &animation->rest;
    bool camera_stays = true;
    for (int32_t i = 0; i < rest->object_count; i++) stays[i] = true;
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        if (track->property->owner >= ZT_OWNER_PLANE)
            stays[track->index] = false;
        else if (track->property->owner == ZT_OWNER_CAMERA)
            camera_stays &= !zt_text_equal(track->property->name, "position");
    }
    for (int32_t i = 0; i < rest->object_count; i++) {
        int32_t parent = rest->objects[i].parent;
        stays[i] &= camera_stays && (parent < 0 || stays[parent]);
    }
}

void zt_animation_free(zt_animation **animation) {
    if (!*animation) return;
    zt_formulas *formulas = &(*animation)->formulas;
    if (formulas->door) formulas->door->close(&formulas->expressions);
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
        case ZT_SHAPE_DISK:
            contents.disk_count++;
            break;
        case ZT_SHAPE_BOX:
            contents.box_count++;
            break;
        case ZT_SHAPE_CYLINDER:
            contents.cylinder_count++;
            break;
        case ZT_SHAPE_CONE:
            contents.cone_count++;
            break;
        case ZT_SHAPE_TORUS:
            contents.torus_count++;
            break;
        case ZT_SHAPE_CAPSULE:
            contents.capsule_count++;
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
    for (int32_t i = 0; i < scene->light_count; i++) switch (scene->lights[i].kind) {
        case ZT_LIGHT_AMBIENT:
            contents.ambient_light_count++;
            break;
        case ZT_LIGHT_POINT:
            contents.point_light_count++;
            break;
        case ZT_LIGHT_DISK:
            contents.disk_light_count++;
            break;
        case ZT_LIGHT_RECTANGLE:
            contents.rectangle_light_count++;
            break;
        }
    return contents;
}

zt_movement zt_animation_movement(const zt_animation *animation, int index) {
    static const char *const kinds[ZT_TRACK_KIND_COUNT] = {[ZT_TRACK_FORMULA] = "expression",
                                                           [ZT_TRACK_FOLLOW] = "follow",
                                                           [ZT_TRACK_ORBIT] = "orbit",
                                                           [ZT_TRACK_OFFSET] = "offset",
                                                           [ZT_TRACK_LOOK_AT] = "look_at"};
    const zt_track *track = &animation->tracks[index];
    zt_movement movement = {.name = track->name, .driver = kinds[track->kind]};
    if (track->kind == ZT_TRACK_CURVE) {
        movement.driver = zt_curve_label(&track->curve);
        movement.key_count = track->curve.key_count;
        movement.first_s = track->curve.times[0];
        movement.last_s = track->curve.times[track->curve.key_count - 1];
    } else if (track->kind == ZT_TRACK_FOLLOW) {
        movement.first_s = track->follow.from_s;
        movement.last_s = track->follow.to_s;
    }
    return movement;
}
