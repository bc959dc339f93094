/* The animation: a scene at rest, and the tracks that move it. Immutable once it is read. */
#ifndef ZT_KEYFRAME_ANIMATION_H
#define ZT_KEYFRAME_ANIMATION_H

#include <zoetrope/animation.h>

#include "base/arena.h"
#include "base/diag.h"
#include "keyframe/constraint.h"
#include "keyframe/curve.h"
#include "keyframe/formula.h"
#include "keyframe/property.h"
#include "scene/scene.h"

/* What drives a property. */
typedef enum zt_track_kind {
    ZT_TRACK_CURVE, /* keys */
    ZT_TRACK_FORMULA,
    ZT_TRACK_FOLLOW,
    ZT_TRACK_ORBIT,
    ZT_TRACK_OFFSET,
    ZT_TRACK_LOOK_AT,
    ZT_TRACK_KIND_COUNT
} zt_track_kind;

/* A property, and what drives it. */
typedef struct zt_track {
    const zt_property *property;
    int32_t index;    /* which of the owner's things, as zt_property_set takes it */
    const char *name; /* "ball.center" */
    zt_track_kind kind;
    union {
        zt_curve curve;
        zt_formula formula;
        zt_follow follow;
        zt_orbit orbit;
        zt_offset offset;
        zt_look_at look_at;
    };
    zt_place place;             /* of the property in the description */
    const zt_place *key_places; /* one per key of the curve; NULL where none is known */
} zt_track;

/* Something that has properties. */
typedef struct zt_thing {
    zt_owner owner;
    int32_t index;    /* as zt_property_get takes it */
    const char *name; /* "camera", "ball", "sphere 2" */
    zt_place place;   /* where the description has it; line 0 where that is not known */
} zt_thing;

/* The struct itself is the reader's calloc; zt_animation_free gives it back. */
struct zt_animation {
    zt_arena arena; /* owns all below but the formulas */
    zt_film film;
    zt_scene rest; /* all that does not move has its value here */
    const zt_track *tracks;
    int32_t track_count;
    const zt_thing *things; /* all of them, moving or not */
    int32_t thing_count;
    const int32_t *order; /* of evaluation: indices of tracks, each after those that it needs;
                             NULL for the tracks' own order */
    zt_formulas formulas;
};

/* The scene of the moment `time_s`, in the arena: a copy of the scene at rest with each track's
 * value written into it, brought into its property's range; the tube of a torus is made no
 * wider than its radius. Meshes are shared with the animation. The same bits for the same time,
 * from any number of threads at once. ZT_EDESCRIPTION: formulas have no value at this time,
 * which is told with their places; ZT_EMEMORY. */
zt_status zt_animation_freeze(zt_scene *scene, const zt_animation *animation, double time_s,
                              zt_arena *arena, zt_listener listener);

/* Of each object of the scene at rest: it is at the same place, as seen from where the camera
 * is, at all times; written to `stays`. */
void zt_animation_stays(bool *stays, const zt_animation *animation);

/* The same into the arrays of a scene that was frozen before, of the same animation. */
zt_status zt_animation_freeze_again(zt_scene *scene, const zt_animation *animation,
                                    double time_s, zt_listener listener);

#endif
