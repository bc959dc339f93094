#include "sequence/chords.h"

#include <float.h>
#include <math.h>

#include "scene/clearance.h"
#include "sequence/marks.h"

/* ---- what moves -----------------------------------------------------------------------------
 */

static void add(zt_chords *chords, zt_part part, int mark_count) {
    part.first = chords->mark_count;
    part.count = mark_count;
    chords->mark_count += mark_count;
    chords->parts[chords->part_count++] = part;
}

/* Places in the group around the foot of the origin on a plane, as far around it as it is away:
 * what a pattern shows there moves with the group. NULL where they cannot be known. */
static const xform *make_anchor(const xform *world, vec3 foot, double reach, zt_arena *arena) {
    xform *anchor = ZT_PUSH(arena, xform, 1);
    if (!anchor) return NULL;
    xform back = xform_inverse(world);
    xform around = {{reach, 0, 0}, {0, reach, 0}, {0, 0, reach}, foot};
    *anchor = xform_mul(&back, &around);
    return isfinite(anchor->shift.x + anchor->x.x + anchor->y.x + anchor->z.x) ? anchor : NULL;
}

static void add_object(zt_chords *chords, const zt_scene *scene, int32_t index, int32_t by,
                       zt_arena *arena) {
    const zt_object *object = &scene->objects[index];
    const xform *world = &chords->worlds[index];
    zt_part part = {.kind = ZT_PART_OBJECT, .index = index, .by = by};
    if (object->shape != ZT_SHAPE_PLANE) {
        vec3 marks[ZT_MARKS_MAX];
        int count = zt_marks_of_object(marks, object, world, scene->meshes);
        if (count > 0) add(chords, part, count);
        return;
    }
    vec3 normal;
    double distance = zt_marks_plane(&normal, &object->plane, world);
    part.reach = fabs(distance) > 0 ? fabs(distance) : 1;
    bool in_group = object->parent >= 0;
    if (in_group && scene->materials[object->material].pattern != ZT_PATTERN_NONE)
        part.anchor = make_anchor(world, vec3_scale(normal, distance), part.reach, arena);
    add(chords, part, part.anchor ? 10 : 2);
}

/* Which objects have tracks, or are in a group that does: by[i] is the one with the track, or
 * -1. What else the tracks move is added at once. */
static void add_tracks(zt_chords *chords, int32_t *by, bool *lamps, bool *powers) {
    const zt_animation *animation = chords->animation;
    bool camera = false;
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        const zt_property *property = track->property;
        bool is_light =
            property->owner >= ZT_OWNER_AMBIENT && property->owner <= ZT_OWNER_RECTANGLE_LIGHT;
        if (property->owner == ZT_OWNER_CAMERA)
            camera = true;
        else if (property->owner == ZT_OWNER_MATERIAL || property->kind == ZT_VALUE_SWITCH)
            add(chords,
                (zt_part){.kind = ZT_PART_VALUE,
                          .index = track->index,
                          .by = track->index,
                          .property = property},
                1);
        else if (!is_light)
            by[track->index] = track->index;
        else if (property->offset == offsetof(zt_light, color) ||
                 property->offset == offsetof(zt_light, intensity))
            powers[track->index] = true;
        else
            lamps[track->index] = true;
    }
    for (int32_t i = 0; i < animation->rest.light_count; i++) {
        if (powers[i]) add(chords, (zt_part){.kind = ZT_PART_POWER, .index = i}, 1);
        if (lamps[i]) add(chords, (zt_part){.kind = ZT_PART_LAMP, .index = i}, 8);
    }
    if (!camera) return;
    add(chords, (zt_part){.kind = ZT_PART_EYE}, 1);
    add(chords, (zt_part){.kind = ZT_PART_VIEW}, 5);
    add(chords, (zt_part){.kind = ZT_PART_OPENING}, 4);
}

/* How far the origin is from a surface, as well as it is quickly found. */
static double distance_to(double *far, const zt_object *object, const xform *world,
                          const zt_mesh *meshes) {
    vec3 marks[ZT_MARKS_MAX], center;
    if (object->shape == ZT_SHAPE_PLANE)
        return fabs(zt_marks_plane(&center, &object->plane, world));
    int count = zt_marks_of_object(marks, object, world, meshes);
    if (count == 0) return INFINITY;
    double radius = zt_marks_ball(&center, marks, count), distance = vec3_length(center);
    if (!(radius > 0) || !isfinite(distance + radius)) return INFINITY;
    *far = fmax(*far, distance + radius);
    if (distance > 2 * radius) return distance - radius;
    double least =
        fmin(vec3_length(world->x), fmin(vec3_length(world->y), vec3_length(world->z)));
    double away = fabs(zt_clearance(object, xform_inverse(world).shift)) * least;
    return fmax(away < distance ? away : distance - radius, ZT_MARK_NEAREST * radius);
}

static void find_distances(zt_chords *chords, const zt_scene *scene) {
    chords->near = INFINITY;
    chords->far = 0;
    for (int32_t i = 0; i < scene->object_count; i++)
        chords->near = fmin(chords->near, distance_to(&chords->far, &scene->objects[i],
                                                      &chords->worlds[i], scene->meshes));
    if (!(chords->near < INFINITY)) chords->near = 1;
    chords->near = fmax(chords->near, ZT_MARK_ROUNDINGS * vec3_max_abs(chords->origin));
    chords->far = fmax(chords->far, chords->near);
}

static zt_status find_parts(zt_chords *chords, const zt_scene *scene, zt_arena *arena) {
    size_t objects = (size_t)scene->object_count, lights = (size_t)scene->light_count;
    int32_t *by = ZT_PUSH(arena, int32_t, objects);
    bool *lamps = ZT_PUSH(arena, bool, lights), *powers = ZT_PUSH(arena, bool, lights);
    size_t most = objects + 2 * lights + (size_t)chords->animation->track_count + 3;
    chords->parts = ZT_PUSH(arena, zt_part, most);
    if (!by || !lamps || !powers || !chords->parts) return ZT_EMEMORY;
    for (size_t i = 0; i < objects; i++) by[i] = -1;
    add_tracks(chords, by, lamps, powers);
    for (int32_t i = 0; i < scene->object_count; i++) {
        int32_t parent = scene->objects[i].parent;
        if (by[i] < 0 && parent >= 0) by[i] = by[parent];
        if (by[i] >= 0) add_object(chords, scene, i, by[i], arena);
    }
    return ZT_OK;
}

zt_status zt_chords_open(zt_chords *chords, zt_glance **first, const zt_animation *animation,
                         double time_s, int height, zt_arena *arena, zt_listener listener) {
    zt_scene scene;
    const zt_film *film = &animation->film;
    *first = NULL;
    ZT_TRY(zt_animation_freeze(&scene, animation, time_s, arena, listener));
    *chords = (zt_chords){.animation = animation,
                          .height = height,
                          .error = film->shutter.error,
                          .aspect = (double)film->width / film->height,
                          .origin = scene.camera.position,
                          .worlds = ZT_PUSH(arena, xform, (size_t)scene.object_count)};
    if (!chords->worlds) return ZT_EMEMORY;
    zt_scene_worlds(chords->worlds, &scene, chords->origin);
    find_distances(chords, &scene);
    ZT_TRY(find_parts(chords, &scene, arena));
    zt_glance *glance = ZT_PUSH(arena, zt_glance, 1);
    if (!glance) return ZT_EMEMORY;
    *glance = (zt_glance){.scene = scene,
                          .marks = ZT_PUSH(arena, vec3, (size_t)chords->mark_count),
                          .allowed = ZT_PUSH(arena, double, (size_t)chords->part_count)};
    if (!glance->marks || !glance->allowed) return ZT_EMEMORY;
    zt_marks_make(glance, chords);
    *first = glance;
    return ZT_OK;
}

/* ---- glances --------------------------------------------------------------------------------
 */

size_t zt_chords_glance_size(const zt_chords *chords) {
    const zt_scene *scene = &chords->animation->rest;
    return sizeof(zt_glance) + (size_t)scene->object_count * sizeof *scene->objects +
           (size_t)scene->material_count * sizeof *scene->materials +
           (size_t)scene->light_count * sizeof *scene->lights +
           (size_t)chords->mark_count * sizeof(vec3) +
           (size_t)chords->part_count * sizeof(double);
}

zt_glance *zt_glance_push(const zt_chords *chords, zt_arena *arena) {
    const zt_scene *rest = &chords->animation->rest;
    zt_glance *glance = ZT_PUSH(arena, zt_glance, 1);
    if (!glance) return NULL;
    zt_scene *scene = &glance->scene;
    *scene = *rest;
    scene->materials = ZT_PUSH(arena, zt_material, (size_t)rest->material_count);
    scene->lights = ZT_PUSH(arena, zt_light, (size_t)rest->light_count);
    scene->objects = ZT_PUSH(arena, zt_object, (size_t)rest->object_count);
    glance->marks = ZT_PUSH(arena, vec3, (size_t)chords->mark_count);
    glance->allowed = ZT_PUSH(arena, double, (size_t)chords->part_count);
    bool all = scene->materials && scene->lights && scene->objects && glance->marks;
    return all && glance->allowed ? glance : NULL;
}

zt_status zt_glance_at(zt_glance *glance, const zt_chords *chords, double time_s,
                       zt_listener listener) {
    ZT_TRY(zt_animation_freeze_again(&glance->scene, chords->animation, time_s, listener));
    zt_marks_make(glance, chords);
    return ZT_OK;
}

/* ---- chords ---------------------------------------------------------------------------------
 */

zt_gap zt_chords_gap(const zt_chords *chords, const zt_glance *a, const zt_glance *b,
                     const zt_glance *t, double between) {
    zt_gap gap = {0, -1};
    for (int32_t i = 0; i < chords->part_count; i++) {
        const zt_part *part = &chords->parts[i];
        double most = 0, allowed = t->allowed[i];
        for (int32_t k = part->first; k < part->first + part->count; k++) {
            vec3 way = vec3_sub(b->marks[k], a->marks[k]);
            vec3 off = vec3_sub(vec3_sub(t->marks[k], a->marks[k]), vec3_scale(way, between));
            double square = vec3_dot(off, off);
            if (square > most) most = square; /* what is no number is not met by rays */
        }
        if (zt_part_is_relative(part)) allowed = part->most_allowed;
        if (!(most > gap.share * gap.share * allowed * allowed)) continue;
        gap.share = allowed > 0 ? fmin(sqrt(most) / allowed, DBL_MAX) : DBL_MAX;
        gap.part = i;
    }
    return gap;
}

zt_part_thing zt_chords_thing(const zt_chords *chords, int32_t index) {
    const zt_part *part = &chords->parts[index];
    const zt_scene *rest = &chords->animation->rest;
    switch (part->kind) {
    case ZT_PART_OBJECT:
        return (zt_part_thing){
            (zt_owner)(ZT_OWNER_PLANE + (rest->objects[part->by].shape - ZT_SHAPE_PLANE)),
            part->by, true};
    case ZT_PART_LAMP:
    case ZT_PART_POWER:
        return (zt_part_thing){
            (zt_owner)(ZT_OWNER_AMBIENT + (rest->lights[part->index].kind - ZT_LIGHT_AMBIENT)),
            part->index, part->kind == ZT_PART_LAMP};
    case ZT_PART_VALUE:
        return (zt_part_thing){part->property->owner, part->index, false};
    case ZT_PART_EYE:
    case ZT_PART_VIEW:
    case ZT_PART_OPENING:
        break;
    }
    return (zt_part_thing){ZT_OWNER_CAMERA, 0, true};
}
