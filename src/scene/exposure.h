/* An exposure: what the scene is while the shutter is open. To the light wing, time is a
 * fraction of one such opening. */
#ifndef ZT_SCENE_EXPOSURE_H
#define ZT_SCENE_EXPOSURE_H

#include "scene/scene.h"

/* The same things at moments of the opening. Between two moments everything goes straight on:
 * centres, corners and the axes of transforms as they stand in the space relative to the first
 * moment's camera, radii, colours. There are as many moments as that asks for. Arrays belong to
 * the arena that they were made in. */
typedef struct zt_exposure {
    const zt_scene *moments; /* moment_count; of the first where nothing moves */
    const double *times;     /* likewise: fractions, rising from 0 to 1; multiples of 1/4096 */
    const bool *steps; /* of moment i: what differs at the next one changes at once, halfway */
    int32_t moment_count; /* at least 1; 1: nothing moves, and times and steps are not read */
} zt_exposure;

/* A scene in which nothing moves. */
static inline zt_exposure zt_exposure_of(const zt_scene *scene) {
    return (zt_exposure){.moments = scene, .moment_count = 1};
}

#endif
