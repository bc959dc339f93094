/* An exposure: what the scene is while the shutter is open. To the light wing, time is a
 * fraction of one such opening. */
#ifndef ZT_SCENE_EXPOSURE_H
#define ZT_SCENE_EXPOSURE_H

#include <zoetrope/status.h>

#include "base/arena.h"
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
    /* Of each object: it is at the same place, as seen from where the camera is, in all frames,
     * so that what is made of it may be kept. NULL: of none is that known. */
    const bool *stays;
} zt_exposure;

/* All moments are at multiples of this share of the opening. */
enum { ZT_TIME_CELLS = 4096 };

/* For each cell of time, an equal share of the opening, the last moment that is not after its
 * beginning. Of an exposure in which something moves. ZT_EMEMORY. */
zt_status zt_exposure_index(const uint16_t **moment_at, const zt_exposure *exposure,
                            zt_arena *arena);

/* On its way from which moment to the next a time is, and how far, 0 to 1: what steps is at one
 * or the other. Times before 0 and after 1 are taken for these. */
static inline double zt_exposure_find(int32_t *moment, const zt_exposure *exposure,
                                      const uint16_t *moment_at, double time) {
    double t = fmin(fmax(time, 0), 1);
    int cell = (int)(t * ZT_TIME_CELLS);
    int32_t m = *moment = moment_at[cell < ZT_TIME_CELLS ? cell : ZT_TIME_CELLS - 1];
    double between = (t - exposure->times[m]) / (exposure->times[m + 1] - exposure->times[m]);
    return exposure->steps[m] ? (between < 0.5 ? 0 : 1) : between;
}

/* A scene in which nothing moves. */
static inline zt_exposure zt_exposure_of(const zt_scene *scene) {
    return (zt_exposure){.moments = scene, .moment_count = 1};
}

#endif
