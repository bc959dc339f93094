/* Advice on lamps: points on surfaces, where light has no distance to fall off over; and lamps
 * inside of what lets none of it out. */
#include <math.h>
#include <stdlib.h>

#include "keyframe/advice.h"

/* Nearer than this, 1 / d^2 says little. */
static const double touching = 1e-6;

/* The first object that something was met of, and when. */
typedef struct finding {
    int32_t object;
    zt_advice_span span;
} finding;

typedef struct findings {
    finding *on, *inside; /* of each light */
} findings;

static void met(finding *f, int32_t object, double time_s) {
    if (isnan(f->span.first_s)) f->object = object;
    if (f->object == object) zt_advice_met(&f->span, time_s);
}

/* Of a lamp with a size all must be inside, but for its skin, which nothing hides
 * (tracer/lamps.h). A camera that is inside as well may be meant to be: a room. */
static bool shuts_in(const zt_advice_moment *moment, const zt_light *light,
                     const zt_object *object, xform world) {
    if (!light->shadows || !zt_advice_within(moment, object, &world)) return false;
    double reach = zt_light_reach(light) * (1 + 0x1p-10);
    if (reach > 0 && zt_advice_touches(moment, object, &world, reach)) return false;
    vec3 eye = vec3_sub(moment->scene->camera.position, light->position);
    world.shift = vec3_sub(world.shift, eye);
    return !zt_advice_within(moment, object, &world);
}

static void look(void *user, const zt_advice_moment *moment) {
    findings *f = user;
    const zt_scene *scene = moment->scene;
    for (int32_t l = 0; l < scene->light_count; l++) {
        const zt_light *light = &scene->lights[l];
        if (light->kind == ZT_LIGHT_AMBIENT) continue;
        bool is_point = zt_light_reach(light) <= touching;
        zt_scene_worlds(moment->worlds, scene, light->position);
        for (int32_t i = 0; i < scene->object_count; i++) {
            const zt_object *object = &scene->objects[i];
            if (is_point && zt_advice_touches(moment, object, &moment->worlds[i], touching))
                met(&f->on[l], i, moment->time_s);
            else if (shuts_in(moment, light, object, moment->worlds[i]))
                met(&f->inside[l], i, moment->time_s);
        }
    }
}

static void tell(const finding *found, const zt_animation *animation, const char *where,
                 const char *what, zt_listener listener) {
    int told = 0;
    for (int32_t l = 0; l < animation->rest.light_count && told < ZT_ADVICE_TOLD_MAX; l++) {
        if (isnan(found[l].span.first_s)) continue;
        zt_advice_words when = zt_advice_when(&animation->film, found[l].span);
        zt_owner owner = (zt_owner)(ZT_OWNER_AMBIENT + animation->rest.lights[l].kind);
        zt_advice_name lamp = zt_advice_name_of(animation, owner, l);
        zt_tell_at(listener, ZT_WARNING, lamp.place, "%s is %s %s %s: %s", lamp.text, where,
                   zt_advice_name_of_object(animation, found[l].object).text, when.text, what);
        told++;
    }
}

zt_status zt_advice_lamps(const zt_animation *animation, zt_listener listener) {
    int32_t count = animation->rest.light_count;
    zt_arena arena = {0};
    findings f = {ZT_PUSH(&arena, finding, (size_t)count),
                  ZT_PUSH(&arena, finding, (size_t)count)};
    zt_status status = f.on && f.inside ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK) {
        for (int32_t l = 0; l < count; l++) f.on[l].span = f.inside[l].span = zt_advice_never;
        status = zt_advice_each_moment(animation, count, look, &f, listener);
    }
    if (status == ZT_OK) {
        tell(f.on, animation, "on the surface of",
             "its light, which falls off with the distance, is cut there", listener);
        tell(f.inside, animation, "inside of",
             "none of its light gets out; \"shadows: false\" lets it", listener);
    }
    zt_arena_free(&arena);
    return status;
}
