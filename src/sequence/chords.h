/* Chords: how far things leave the straight way between two moments, which is the measure by
 * which a shutter's opening is divided. */
#ifndef ZT_SEQUENCE_CHORDS_H
#define ZT_SEQUENCE_CHORDS_H

#include "base/arena.h"
#include "keyframe/animation.h"

/* What may be left, as a share, of colors, intensities and reflectivity. */
#define ZT_CHORD_SHARE (1.0 / 512)

/* Something that a track moves: a thing's place, its color, the camera's view ... */
typedef struct zt_part zt_part;

/* What is the same for all moments of an opening. Arrays belong to the arena. */
typedef struct zt_chords {
    const zt_animation *animation;
    int height;     /* pixels */
    double error;   /* how many of them places may be off */
    double aspect;  /* the picture's width over its height */
    vec3 origin;    /* all places are relative to it: the first moment's camera */
    double near;    /* how far from there the nearest surface is, at least about; */
    double far;     /* and the end of the farthest bounded thing */
    zt_part *parts; /* part_count of them */
    int32_t part_count, mark_count;
    xform *worlds; /* room for those of all objects */
} zt_chords;

/* A moment that is looked at. */
typedef struct zt_glance zt_glance;
struct zt_glance {
    double cell; /* in parts of ZT_TIME_CELLS of the opening */
    zt_scene scene;
    vec3 *marks;     /* points of each part, that go straight where the tracer's numbers do */
    double *allowed; /* how far those of each part may be off */
    zt_glance *next; /* in a list of those that are free */
};

/* Finds what the tracks move, and looks at the first moment. Fails as zt_animation_freeze does.
 */
zt_status zt_chords_open(zt_chords *chords, zt_glance **first, const zt_animation *animation,
                         double time_s, int height, zt_arena *arena, zt_listener listener);

/* What a glance takes: bytes. */
size_t zt_chords_glance_size(const zt_chords *chords);

/* Room for a glance; NULL when out of memory. */
zt_glance *zt_glance_push(const zt_chords *chords, zt_arena *arena);

/* Looks at another moment. Fails as zt_animation_freeze does. */
zt_status zt_glance_at(zt_glance *glance, const zt_chords *chords, double time_s,
                       zt_listener listener);

/* What is off most, as a share of what is allowed. */
typedef struct zt_gap {
    double share;
    int32_t part;
} zt_gap;

/* What is off at `t` if all goes straight on from `a` to `b`, of which way it is at the share
 * `between`. */
zt_gap zt_chords_gap(const zt_chords *chords, const zt_glance *a, const zt_glance *b,
                     const zt_glance *t, double between);

/* The thing that a part belongs to: for members of groups, the innermost one that has a track
 * of its own; and whether the part is allowed so much of a pixel, rather than a share. */
typedef struct zt_part_thing {
    zt_owner owner;
    int32_t index;
    bool is_place;
} zt_part_thing;
zt_part_thing zt_chords_thing(const zt_chords *chords, int32_t part);

#endif
