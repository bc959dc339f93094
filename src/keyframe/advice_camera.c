/* Advice on the camera: what it looks along, what it focuses on, and what it is inside of. */
#include <math.h>

#include "base/text.h"
#include "keyframe/advice.h"

/* Nearer than half a degree to its up vector, a camera has no up worth the name. */
static const double sine_min = 0.0087;

/* What was found while going through the film's moments. */
typedef struct findings {
    double along_up_s, at_itself_s; /* the first moment; NAN for never */
    zt_advice_span behind;          /* focused on what is behind it */
    bool opens;                     /* at some moment */
    zt_advice_span *inside;         /* per object: within it */
    vec3 ahead, aside;              /* of the moment before: the view, and it without its up */
} findings;

static const zt_track *track_named(const zt_animation *animation, const char *name) {
    for (int32_t i = 0; i < animation->track_count; i++)
        if (zt_text_equal(animation->tracks[i].name, name)) return &animation->tracks[i];
    return NULL;
}

/* Where the first of the camera's properties that moves stands in the description, or the
 * camera itself; NULL where that is not known. */
static const zt_place *place_of(const zt_animation *animation, const char *const names[3]) {
    for (int i = 0; i < 3; i++) {
        const zt_track *track = track_named(animation, names[i]);
        if (track && track->place.line > 0) return &track->place;
    }
    return zt_advice_name_of(animation, ZT_OWNER_CAMERA, 0).place;
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

static void look_through(findings *f, const zt_camera *camera, double time_s) {
    if (!(zt_camera_opening(camera) > 0)) return;
    f->opens = true;
    if (camera->focused && !(zt_camera_depth(camera, camera->focus_on) > 0))
        zt_advice_met(&f->behind, time_s);
}

static void look(void *user, const zt_advice_moment *moment) {
    findings *f = user;
    const zt_scene *scene = moment->scene;
    look_along(f, &scene->camera, moment->time_s);
    look_through(f, &scene->camera, moment->time_s);
    zt_scene_worlds(moment->worlds, scene, scene->camera.position);
    for (int32_t i = 0; i < scene->object_count; i++)
        if (zt_advice_within(moment, &scene->objects[i], &moment->worlds[i]))
            zt_advice_met(&f->inside[i], moment->time_s);
}

static void tell_lens(const findings *f, const zt_animation *animation, zt_listener listener) {
    static const char *const focus[] = {"camera.focus_on", "camera.position", "camera.look_at"},
                             *const opening[] = {"camera.aperture", "camera.f_number",
                                                 "camera.focal_length"};
    if (!isnan(f->behind.first_s))
        zt_tell_at(listener, ZT_WARNING, place_of(animation, focus),
                   "the camera focuses on a point that is not ahead of it %s: nothing is sharp",
                   zt_advice_when(&animation->film, f->behind).text);
    if (f->opens && animation->film.sampling.max == 1)
        zt_tell_at(listener, ZT_WARNING, place_of(animation, opening),
                   "what is out of focus will be grains: a pixel takes 1 sample; \"film\" may "
                   "say \"samples: 64\"");
}

static void tell(const findings *f, const zt_animation *animation, zt_listener listener) {
    static const char *const names[] = {"camera.look_at", "camera.position", "camera.up"};
    zt_rate rate = animation->film.rate;
    const zt_place *place = place_of(animation, names);
    if (!isnan(f->at_itself_s))
        zt_tell_at(listener, ZT_WARNING, place,
                   "the camera looks at the very point where it is, at %s",
                   zt_moment_in_words(rate, f->at_itself_s).text);
    if (!isnan(f->along_up_s))
        zt_tell_at(listener, ZT_WARNING, place,
                   "the camera looks along its up vector at %s: the picture turns over there; "
                   "choose another \"up\"",
                   zt_moment_in_words(rate, f->along_up_s).text);
    tell_lens(f, animation, listener);
    int told = 0;
    for (int32_t i = 0; i < animation->rest.object_count && told < ZT_ADVICE_TOLD_MAX; i++) {
        if (isnan(f->inside[i].first_s)) continue;
        zt_tell_at(listener, ZT_WARNING, place, "the camera is inside of %s %s",
                   zt_advice_name_of_object(animation, i).text,
                   zt_advice_when(&animation->film, f->inside[i]).text);
        told++;
    }
}

zt_status zt_advice_camera(const zt_animation *animation, zt_listener listener) {
    size_t count = (size_t)animation->rest.object_count;
    zt_arena arena = {0};
    findings f = {.along_up_s = NAN,
                  .at_itself_s = NAN,
                  .behind = zt_advice_never,
                  .inside = ZT_PUSH(&arena, zt_advice_span, count)};
    zt_status status = f.inside ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK) {
        for (size_t i = 0; i < count; i++) f.inside[i] = zt_advice_never;
        status = zt_advice_each_moment(animation, 1, look, &f, listener);
    }
    if (status == ZT_OK) tell(&f, animation, listener);
    zt_arena_free(&arena);
    return status;
}
