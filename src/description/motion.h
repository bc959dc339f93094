/* Properties of things: a constant, or something that moves it. */
#ifndef ZT_DESCRIPTION_MOTION_H
#define ZT_DESCRIPTION_MOTION_H

#include "description/reading.h"

/* The names of an owner's properties, from the table; returns their number. */
int zt_motion_names(const char *names[ZT_FIELD_NAMES_MAX], zt_owner owner);

/* Sets all properties of the owner's thing number `index` in the scene at rest, and makes
 * tracks of those that move. `place` is where the thing is named, `name` how its tracks are
 * called: "ball", "sphere 3". Mistakes are told and counted; ZT_EMEMORY is all that can fail.
 */
zt_status zt_motion_read(zt_reading *reading, const zt_fields *fields, zt_owner owner,
                         int32_t index, const char *name, const zt_place *place);

/* Adds a track of a thing, which gets its name. ZT_EMEMORY. */
zt_status zt_motion_add(zt_reading *reading, const zt_track *track, const char *thing);

/* Moves the tracks to the animation, in the order of the description. */
zt_status zt_motion_close(zt_reading *reading);

#endif
