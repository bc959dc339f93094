/* The animation: a scene at rest, and the tracks that move it. Immutable once it is read. */
#ifndef ZT_KEYFRAME_ANIMATION_H
#define ZT_KEYFRAME_ANIMATION_H

#include <zoetrope/animation.h>

#include "base/arena.h"
#include "base/diag.h"
#include "keyframe/curve.h"
#include "keyframe/property.h"
#include "scene/scene.h"

/* A curve and the property that it drives. */
typedef struct zt_track {
    const zt_property *property;
    int32_t index;    /* which of the owner's things, as zt_property_set takes it */
    const char *name; /* "ball.center" */
    zt_curve curve;
    zt_place place;             /* of the property in the description */
    const zt_place *key_places; /* one per key of the curve; NULL where none is known */
} zt_track;

/* The struct itself is the reader's calloc; zt_animation_free gives it back. */
struct zt_animation {
    zt_arena arena; /* owns all below */
    zt_film film;
    zt_scene rest; /* all that does not move has its value here */
    const zt_track *tracks;
    int32_t track_count;
};

/* The scene of the moment `time_s`, in the arena: a copy of the scene at rest with each track's
 * value written into it. Meshes are shared with the animation. ZT_EMEMORY is all that can fail.
 */
zt_status zt_animation_freeze(zt_scene *scene, const zt_animation *animation, double time_s,
                              zt_arena *arena);

#endif
