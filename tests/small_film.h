/* A small film that is put together by hand: a camera, a material, a lamp, a ball, a group with
 * a second ball in it. cmocka.h comes first. */
#ifndef ZT_TESTS_SMALL_FILM_H
#define ZT_TESTS_SMALL_FILM_H

#include <stdlib.h>
#include <string.h>

#include "keyframe/animation.h"
#include "keys.h"

enum { BALL, GROUP, INNER, THING_COUNT = 6, TRACKS_MAX = 8, KEYS_MAX = 16 };

static inline zt_animation *small_film(int64_t frame_count, zt_rate rate) {
    zt_animation *film = calloc(1, sizeof *film);
    assert_non_null(film);
    zt_arena *arena = &film->arena;
    film->film = (zt_film){.rate = rate, .frame_count = frame_count};
    film->rest = (zt_scene){.materials = ZT_PUSH(arena, zt_material, 1),
                            .lights = ZT_PUSH(arena, zt_light, 1),
                            .objects = ZT_PUSH(arena, zt_object, 3),
                            .material_count = 1,
                            .light_count = 1,
                            .object_count = 3};
    const zt_thing things[THING_COUNT] = {
        {ZT_OWNER_CAMERA, 0, "camera", {0}},
        {ZT_OWNER_MATERIAL, 0, "clay", {0}},
        {ZT_OWNER_POINT, 0, "lamp", {"small.yaml", NULL, 4, 5, 4}},
        {ZT_OWNER_SPHERE, BALL, "ball", {0}},
        {ZT_OWNER_GROUP, GROUP, "group", {0}},
        {ZT_OWNER_SPHERE, INNER, "inner ball", {0}}};
    zt_thing *own = ZT_PUSH(arena, zt_thing, THING_COUNT);
    memcpy(own, things, sizeof things);
    for (int i = 0; i < THING_COUNT; i++)
        zt_property_rest(&film->rest, own[i].owner, own[i].index);
    film->rest.objects[INNER].parent = GROUP;
    film->rest.camera.aimed = true;
    film->rest.camera.position = (vec3){0, 0, 10};
    film->rest.lights[0].position = (vec3){0, 40, 0}; /* outside of all balls */
    film->things = own;
    film->thing_count = THING_COUNT;
    film->tracks = ZT_PUSH(arena, zt_track, TRACKS_MAX);
    return film;
}

/* A track of "ball.center" and so on, to be filled. The place of the property is line 10 of
 * film.yaml, those of its keys are lines 11, 12 ... */
static inline zt_track *add_track(zt_animation *film, const char *name) {
    zt_track *track = (zt_track *)&film->tracks[film->track_count++];
    zt_place *places = ZT_PUSH(&film->arena, zt_place, KEYS_MAX);
    const char *dot = strrchr(name, '.');
    *track = (zt_track){.name = name,
                        .place = {.file = "film.yaml", .line = 10, .column = 5},
                        .key_places = places};
    for (int k = 0; k < KEYS_MAX; k++)
        places[k] = (zt_place){.file = "film.yaml", .line = 11 + k, .column = 7};
    for (int i = 0; i < film->thing_count; i++) {
        const zt_thing *thing = &film->things[i];
        if (strlen(thing->name) != (size_t)(dot - name) ||
            strncmp(thing->name, name, strlen(thing->name)) != 0)
            continue;
        track->property = zt_property_find(thing->owner, dot + 1);
        track->index = thing->index;
    }
    assert_non_null(track->property);
    return track;
}

/* A track through keys, of the kind of value that its property has. */
static inline void add_keys(zt_animation *film, const char *name, zt_curve_spec spec) {
    zt_track *track = add_track(film, name);
    spec.value_kind = track->property->kind;
    track->curve = curve_of(&film->arena, &spec);
}

/* All of one kind, through values that lie one after the other. */
static inline void add_simple(zt_animation *film, const char *name, zt_curve_kind kind,
                              int count, const double *times, const double *values) {
    zt_track *track = add_track(film, name);
    assert_int_equal(curve_through(&track->curve, &film->arena, kind, track->property->kind,
                                   count, times, values),
                     ZT_OK);
}

#endif
