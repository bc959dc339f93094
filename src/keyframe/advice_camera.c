/* Advice on the camera: what it looks along, and what it is inside of. */
#include <math.h>

#include "base/text.h"
#include "keyframe/advice.h"

/* Nearer than half a degree to its up vector, a camera has no up worth the name. */
static const double sine_min = 0.0087;

/* What was found while going through the film's moments. */
typedef struct findings {
    double along_up_s, at_itself_s; /* the first moment; NAN for never */
    double *inside_s, *outside_s;   /* per object: the first and the last moment within it */
    int64_t triangles_left;         /* that may still be looked at for being inside of meshes */
    vec3 ahead, aside;              /* of the moment before: the view, and it without its up */
} findings;

static const zt_track *track_named(const zt_animation *animation, const char *name) {
    for (int32_t i = 0; i < animation->track_count; i++)
        if (zt_text_equal(animation->tracks[i].name, name)) return &animation->tracks[i];
    return NULL;
}

/* Where the camera's movement stands in the description; NULL for a camera at rest. */
static const zt_place *camera_place(const zt_animation *animation) {
    static const char *const names[] = {"camera.look_at", "camera.position", "camera.up"};
    for (int i = 0; i < 3; i++) {
        const zt_track *track = track_named(animation, names[i]);
        if (track && track->place.line > 0) return &track->place;
    }
    return NULL;
}

static void look_along(findings *f, const zt_camera *camera, double time_s) {
    if (!camera->aimed) return;
    vec3 ahead = vec3_normalize(vec3_sub(camera->look_at, camera->position));
    vec3 up = vec3_normalize(camera->up);
    vec3 aside = vec3_sub(ahead, vec3_scale(up, vec3_dot(ahead, up)));
    if (vec3_max_abs(ahead) == 0) {
        if (isnan(f->at_itself_s)) f->at_itself_s = time_s;
        return;
    }
    /* Near to the axis on both sides of it: it was crossed in between. */
    bool crossed = vec3_dot(aside, f->aside) < 0 && vec3_dot(ahead, f->ahead) > 0.95;
    if (isnan(f->along_up_s) && (vec3_length(aside) < sine_min || crossed))
        f->along_up_s = time_s;
    f->ahead = ahead;
    f->aside = aside;
}

/* Whether a point of the mesh's space is within the mesh. */
static bool within_mesh(findings *f, const zt_mesh *mesh, vec3 point) {
    bool in_bounds = point.x > mesh->low.x && point.x < mesh->high.x && point.y > mesh->low.y &&
                     point.y < mesh->high.y && point.z > mesh->low.z && point.z < mesh->high.z;
    if (!in_bounds || f->triangles_left < mesh->triangle_count) return false;
    f->triangles_left -= mesh->triangle_count;
    return fabs(zt_mesh_winding(mesh, point)) > 0.5;
}

/* Whether the eye, where `world` has its origin, is within an object; a flattened one has no
 * inside. */
static bool within(findings *f, const zt_scene *scene, const zt_object *object,
                   const xform *world) {
    xform place = *world;
    if (object->shape == ZT_SHAPE_MESH) {
        const zt_placement *p = &object->placement;
        xform own = xform_place(p->position, p->rotation, p->scale);
        place = xform_mul(world, &own);
    }
    vec3 eye = xform_inverse(&place).shift;
    if (object->shape == ZT_SHAPE_MESH)
        return within_mesh(f, &scene->meshes[object->mesh], eye);
    return vec3_length(vec3_sub(eye, object->sphere.center)) < object->sphere.radius;
}

static void look_around(findings *f, const zt_scene *scene, xform *worlds, double time_s) {
    zt_scene_worlds(worlds, scene, scene->camera.position);
    for (int32_t i = 0; i < scene->object_count; i++) {
        const zt_object *object = &scene->objects[i];
        if (object->shape != ZT_SHAPE_SPHERE && object->shape != ZT_SHAPE_MESH) continue;
        if (!within(f, scene, object, &worlds[i])) continue;
        if (isnan(f->inside_s[i])) f->inside_s[i] = time_s;
        f->outside_s[i] = time_s;
    }
}

static const char *object_name(const zt_animation *animation, int32_t object) {
    bool mesh = animation->rest.objects[object].shape == ZT_SHAPE_MESH;
    zt_owner owner = mesh ? ZT_OWNER_MESH : ZT_OWNER_SPHERE;
    for (int32_t i = 0; i < animation->thing_count; i++)
        if (animation->things[i].owner == owner && animation->things[i].index == object)
            return animation->things[i].name;
    return mesh ? "a mesh" : "a sphere";
}

static void tell(const findings *f, const zt_animation *animation, zt_listener listener) {
    zt_rate rate = animation->film.rate;
    const zt_place *place = camera_place(animation);
    if (!isnan(f->at_itself_s))
        zt_tell_at(listener, ZT_WARNING, place,
                   "the camera looks at the very point where it is, at %s",
                   zt_moment_in_words(rate, f->at_itself_s).text);
    if (!isnan(f->along_up_s))
        zt_tell_at(listener, ZT_WARNING, place,
                   "the camera looks along its up vector at %s: the picture turns over there; "
                   "choose another \"up\"",
                   zt_moment_in_words(rate, f->along_up_s).text);
    for (int32_t i = 0; i < animation->rest.object_count; i++) {
        if (isnan(f->inside_s[i])) continue;
        bool once = f->inside_s[i] == f->outside_s[i];
        zt_tell_at(listener, ZT_WARNING, place, "the camera is inside of %s %s %s%s%s",
                   object_name(animation, i), once ? "at" : "from",
                   zt_moment_in_words(rate, f->inside_s[i]).text, once ? "" : " to ",
                   once ? "" : zt_moment_in_words(rate, f->outside_s[i]).text);
    }
}

static zt_status look(findings *f, const zt_animation *animation, zt_arena *arena,
                      zt_listener listener) {
    const zt_film *film = &animation->film;
    int64_t objects = animation->rest.object_count, tracks = animation->track_count;
    int64_t most = ZT_ADVICE_WORK_MAX / (objects + tracks + 1);
    if (most > ZT_ADVICE_MOMENTS_MAX) most = ZT_ADVICE_MOMENTS_MAX;
    int64_t count = tracks > 0 ? zt_advice_moment_count(film, most) : 1;
    for (int64_t i = 0; i < count; i++) {
        double time_s = zt_advice_moment_s(film, i, count);
        zt_scene scene;
        zt_arena_reset(arena);
        ZT_TRY(zt_animation_freeze(&scene, animation, time_s, arena, listener));
        xform *worlds = ZT_PUSH(arena, xform, (size_t)objects);
        if (!worlds) return ZT_EMEMORY;
        look_along(f, &scene.camera, time_s);
        look_around(f, &scene, worlds, time_s);
    }
    return ZT_OK;
}

zt_status zt_advice_camera(const zt_animation *animation, zt_listener listener) {
    size_t count = (size_t)animation->rest.object_count;
    zt_arena own = {0}, frame = {0};
    findings f = {.triangles_left = ZT_ADVICE_TRIANGLES_MAX,
                  .along_up_s = NAN,
                  .at_itself_s = NAN,
                  .inside_s = ZT_PUSH(&own, double, count),
                  .outside_s = ZT_PUSH(&own, double, count)};
    zt_status status = f.inside_s && f.outside_s ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK) {
        for (size_t i = 0; i < count; i++) f.inside_s[i] = NAN;
        status = look(&f, animation, &frame, listener);
    }
    if (status == ZT_OK) tell(&f, animation, listener);
    zt_arena_free(&frame);
    zt_arena_free(&own);
    return status;
}
