/* Curves of properties: keys, the ways between them, ends, springs. */
#ifndef ZT_DESCRIPTION_CURVES_H
#define ZT_DESCRIPTION_CURVES_H

#include "description/reading.h"

/* Reads a mapping with "keys", with "at" and "values", or with "use", into the curve and the
 * places of a track whose property is known. *good is false where something is wrong, which is
 * told. ZT_EMEMORY. */
zt_status zt_curve_read(zt_track *track, bool *good, zt_reading *reading, const zt_node *node);

/* The same from the named mapping that `use` holds the name of. */
zt_status zt_curve_use(zt_track *track, bool *good, zt_reading *reading, const zt_node *use);

/* Tells what is wrong with the names in "timings" and "curves", whether they are used or not.
 */
void zt_curves_check(zt_reading *reading);

#endif
