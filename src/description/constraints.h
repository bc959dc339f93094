/* What drives properties besides keys, as it is written: expressions, "= 1 + sin(t)", and
 * constraints, { orbit: ... }. What they refer to may stand further down, so it is looked up
 * when all has been read. */
#ifndef ZT_DESCRIPTION_CONSTRAINTS_H
#define ZT_DESCRIPTION_CONSTRAINTS_H

#include "description/reading.h"

/* Reads the value of a property where it is one of these: *taken, and then there is nothing
 * else to read, whether or not it was right. `thing` is how the thing's tracks are called.
 * ZT_EMEMORY is all that can fail. */
zt_status zt_constraint_read(bool *taken, zt_reading *reading, const zt_node *node,
                             const zt_property *property, int32_t index, const char *thing);

/* Once the animation has its tracks (zt_motion_close): finds what they refer to, puts them in
 * order, and tries them at a few frames. ZT_EDESCRIPTION where that cannot be done, which is
 * told and counted; ZT_EUNSUPPORTED where there are expressions and nothing to evaluate them;
 * ZT_EMEMORY. */
zt_status zt_constraints_close(zt_reading *reading);

#endif
