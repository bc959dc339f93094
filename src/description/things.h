/* Names of things and of their properties, for what refers to them. */
#ifndef ZT_DESCRIPTION_THINGS_H
#define ZT_DESCRIPTION_THINGS_H

#include "description/node.h"
#include "keyframe/animation.h"

struct zt_reading;

/* Zeroed is empty. The array is the reading's temporary memory. */
typedef struct zt_things {
    zt_thing *all; /* sorted by name once all are known */
    int32_t count, room;
} zt_things;

/* Notes a thing as it is read; the name must outlive the reading. ZT_EMEMORY. */
zt_status zt_things_add(struct zt_reading *reading, zt_owner owner, int32_t index,
                        const char *name, const zt_place *place);

/* Once all are known, before the first is looked for: gives them to the animation, too, in the
 * order of the description. ZT_EMEMORY. */
zt_status zt_things_close(struct zt_reading *reading);

/* Finds a property by its thing's name and its own: "ball.center", "key light.color". */
bool zt_find_property(zt_reference *reference, const zt_things *things, const char *name);

/* The same, and the thing that is meant by a name and is somewhere, by the property that says
 * where; false after telling what is wrong. */
bool zt_read_property(zt_reference *reference, struct zt_reading *reading, const zt_node *node,
                      const char *what);
bool zt_read_place(zt_reference *reference, struct zt_reading *reading, const zt_node *node,
                   const char *what);

/* Shows the names of properties, as many as are worth it; they live as long as the reading. */
void zt_suggest_properties(struct zt_reading *reading, zt_nearest *nearest);

#endif
