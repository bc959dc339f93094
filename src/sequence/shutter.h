/* The shutter: a frame's opening becomes an exposure, with as many moments as what moves asks
 * for. */
#ifndef ZT_SEQUENCE_SHUTTER_H
#define ZT_SEQUENCE_SHUTTER_H

#include "base/arena.h"
#include "keyframe/animation.h"
#include "scene/exposure.h"

/* What the scene is while the shutter is open for a frame, for a picture so many pixels high.
 * Fails as zt_animation_freeze does. */
zt_status zt_shutter_expose(zt_exposure *exposure, const zt_animation *animation, int64_t frame,
                            int height, zt_arena *arena, zt_listener listener);

/* What the random numbers of a frame are keyed by: the places of samples in their pixels by the
 * seed and the camera, all others by the seed and all of the exposure, so that noise changes
 * from frame to frame, but frames in which nothing changes come out identical. */
void zt_shutter_keys(uint64_t *place_key, uint64_t *frame_key, const zt_exposure *exposure,
                     const zt_sampling *sampling);

#endif
