/* Properties of things: a constant, or keys that become a curve. */
#ifndef ZT_DESCRIPTION_MOTION_H
#define ZT_DESCRIPTION_MOTION_H

#include "base/arena.h"
#include "description/fields.h"
#include "keyframe/animation.h"

/* A description being read. The scene's arrays have room for all that the text may hold before
 * the first property is read. */
typedef struct zt_reading {
    zt_mistakes mistakes;
    zt_animation *animation; /* what it becomes; `film` is read before everything else */
    zt_arena *temporary;     /* memory that lives as long as the reading */
    struct zt_track_link *first_track, *last_track;
} zt_reading;

/* The names of an owner's properties, from the table; returns their number. */
int zt_motion_names(const char *names[ZT_FIELD_NAMES_MAX], zt_owner owner);

/* Sets all properties of the owner's thing number `index` in the scene at rest, and makes
 * tracks of those that have keys. `place` is where the thing is named, `name` how its tracks
 * are called: "ball", "sphere 3". Mistakes are told and counted; ZT_EMEMORY is all that can
 * fail. */
zt_status zt_motion_read(zt_reading *reading, const zt_fields *fields, zt_owner owner,
                         int32_t index, const char *name, const zt_place *place);

/* Moves the tracks to the animation, in the order of the description. */
zt_status zt_motion_close(zt_reading *reading);

#endif
