/* What advice shares: moments, going through their scenes, where points are, and words. */
#include <math.h>
#include <stdio.h>

#include "keyframe/advice.h"
#include "scene/clearance.h"

int64_t zt_advice_moment_count(const zt_film *film, int64_t most) {
    int64_t count = (film->frame_count - 1) * ZT_ADVICE_MOMENTS_PER_FRAME + 1;
    return count < most ? count : most < 1 ? 1 : most;
}

double zt_advice_moment_s(const zt_film *film, int64_t index, int64_t count) {
    double last = (double)(film->frame_count - 1);
    double frame = count > 1 ? last * (double)index / (double)(count - 1) : 0;
    if (frame == rint(frame)) return zt_rate_time(film->rate, (int64_t)frame);
    return frame * film->rate.den / film->rate.num;
}

zt_status zt_advice_each_moment(const zt_animation *animation, int32_t point_count,
                                zt_advice_look *look, void *user, zt_listener listener) {
    const zt_film *film = &animation->film;
    int64_t objects = animation->rest.object_count, tracks = animation->track_count;
    int64_t triangles_left = ZT_ADVICE_TRIANGLES_MAX;
    int64_t most = ZT_ADVICE_WORK_MAX / (objects * point_count + tracks + 1);
    if (most > ZT_ADVICE_MOMENTS_MAX) most = ZT_ADVICE_MOMENTS_MAX;
    int64_t count = tracks > 0 ? zt_advice_moment_count(film, most) : 1;
    zt_arena arena = {0};
    zt_status status = ZT_OK;
    for (int64_t i = 0; i < count && status == ZT_OK; i++) {
        zt_scene scene;
        zt_advice_moment moment = {.time_s = zt_advice_moment_s(film, i, count),
                                   .scene = &scene,
                                   .triangles_left = &triangles_left};
        zt_arena_reset(&arena);
        status = zt_animation_freeze(&scene, animation, moment.time_s, &arena, listener);
        if (status != ZT_OK) break;
        moment.worlds = ZT_PUSH(&arena, xform, (size_t)objects);
        if (moment.worlds)
            look(user, &moment);
        else
            status = ZT_EMEMORY;
    }
    zt_arena_free(&arena);
    return status;
}

/* ---- where points are -----------------------------------------------------------------------
 */

/* From the space of an object's numbers, of a mesh's model, to that of `world`. */
static xform place_of(const zt_object *object, const xform *world) {
    if (object->shape != ZT_SHAPE_MESH) return *world;
    const zt_placement *p = &object->placement;
    xform own = xform_place(p->position, p->rotation, p->scale);
    return xform_mul(world, &own);
}

/* Whether a mesh may be looked at all over, and a point of its space is near its bounds. */
static bool is_near(const zt_advice_moment *moment, const zt_mesh *mesh, vec3 point,
                    double distance) {
    vec3 low = vec3_sub(mesh->low, point), high = vec3_sub(point, mesh->high);
    bool near = fmax(fmax(low.x, low.y), low.z) <= distance &&
                fmax(fmax(high.x, high.y), high.z) <= distance &&
                *moment->triangles_left >= mesh->triangle_count;
    if (near) *moment->triangles_left -= mesh->triangle_count;
    return near;
}

bool zt_advice_within(const zt_advice_moment *moment, const zt_object *object,
                      const xform *world) {
    xform place = place_of(object, world);
    vec3 point = xform_inverse(&place).shift; /* not finite in what is flattened */
    if (object->shape != ZT_SHAPE_MESH) return zt_clearance(object, point) < 0;
    const zt_mesh *mesh = &moment->scene->meshes[object->mesh];
    return is_near(moment, mesh, point, 0) && fabs(zt_mesh_winding(mesh, point)) > 0.5;
}

bool zt_advice_touches(const zt_advice_moment *moment, const zt_object *object,
                       const xform *world, double distance) {
    xform place = place_of(object, world);
    double scale = fmax(vec3_length(place.x), fmax(vec3_length(place.y), vec3_length(place.z)));
    vec3 point = xform_inverse(&place).shift;
    if (object->shape != ZT_SHAPE_MESH)
        return fabs(zt_clearance(object, point)) * scale <= distance;
    const zt_mesh *mesh = &moment->scene->meshes[object->mesh];
    return is_near(moment, mesh, point, distance / scale) &&
           zt_mesh_clearance(mesh, point) * scale <= distance;
}

/* ---- words ----------------------------------------------------------------------------------
 */

void zt_advice_met(zt_advice_span *span, double time_s) {
    if (isnan(span->first_s)) span->first_s = time_s;
    span->last_s = time_s;
}

zt_advice_words zt_advice_when(const zt_film *film, zt_advice_span span) {
    zt_advice_words words;
    bool once = span.first_s == span.last_s;
    snprintf(words.text, sizeof words.text, "%s %s%s%s", once ? "at" : "from",
             zt_moment_in_words(film->rate, span.first_s).text, once ? "" : " to ",
             once ? "" : zt_moment_in_words(film->rate, span.last_s).text);
    return words;
}

zt_advice_name zt_advice_name_of(const zt_animation *animation, zt_owner owner, int32_t index) {
    for (int32_t i = 0; i < animation->thing_count; i++) {
        const zt_thing *thing = &animation->things[i];
        if (thing->owner == owner && thing->index == index)
            return (zt_advice_name){thing->name, thing->place.line > 0 ? &thing->place : NULL};
    }
    return (zt_advice_name){zt_owner_name(owner), NULL};
}

zt_advice_name zt_advice_name_of_object(const zt_animation *animation, int32_t object) {
    zt_shape shape = animation->rest.objects[object].shape;
    zt_owner owner = (zt_owner)(ZT_OWNER_PLANE + (shape - ZT_SHAPE_PLANE));
    return zt_advice_name_of(animation, owner, object);
}
