/* The shutter: a frame's opening becomes an exposure, with as many moments as what moves asks
 * for. */
#ifndef ZT_SEQUENCE_SHUTTER_H
#define ZT_SEQUENCE_SHUTTER_H

#include <zoetrope/hash.h>

#include "base/arena.h"
#include "keyframe/animation.h"
#include "scene/exposure.h"
#include "sequence/chords.h"

/* Why an opening was divided as it was. */
typedef struct zt_division {
    int32_t moment_count, step_count;
    bool asked;         /* something asked for more than a first and a last moment: */
    zt_part_thing most; /* what did so most often */
    double off; /* how far anything is off its way at most, as a share of what is allowed;
                   above 1 where the limits of bisection were reached, */
    zt_part_thing worst; /* by this */
    int32_t stepping;    /* the track that changes at once, or -1 */
} zt_division;

/* What the scene is while the shutter is open for a frame, for a picture so many pixels high.
 *
 * The opening is bisected at multiples of 1/ZT_TIME_CELLS until, between two moments, nothing
 * leaves the straight way by more than the shutter's error as the camera sees it, and no color
 * by more than ZT_CHORD_SHARE; so it was found at some points of time between them, spread
 * unevenly, at least three. What moves less than can be seen is still. What changes at once is
 * shut in between two neighboring multiples. Scenes that take too much memory, and what is too
 * fast for neighboring multiples, end it earlier, which `division` tells. Fails as
 * zt_animation_freeze does. */
zt_status zt_shutter_expose(zt_exposure *exposure, zt_division *division,
                            const zt_animation *animation, int64_t frame, int height,
                            zt_arena *arena, zt_listener listener);

/* The scene in the middle of a frame's opening. Fails as zt_animation_freeze does. */
zt_status zt_shutter_middle(zt_scene *scene, const zt_animation *animation, int64_t frame,
                            zt_arena *arena, zt_listener listener);

/* The time of a moment of a frame's opening, in seconds: 0 is its begin, ZT_TIME_CELLS its end.
 */
double zt_shutter_time(const zt_animation *animation, int64_t frame, double cell);

/* What the random numbers of a frame are keyed by: the places of samples in their pixels by the
 * seed and the camera, all others by the seed and all of the exposure, so that noise changes
 * from frame to frame, but frames in which nothing changes come out identical. */
void zt_shutter_keys(uint64_t *place_key, uint64_t *frame_key, const zt_exposure *exposure,
                     const zt_sampling *sampling);

/* A hash of the camera while the shutter is open. */
zt_hash zt_shutter_view(const zt_exposure *exposure);

/* A hash of all that an exposure holds, but for what is in its meshes. */
zt_hash zt_shutter_content(const zt_exposure *exposure);

#endif
