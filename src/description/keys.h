/* Keys of one property: values at times, and what is written beside them. */
#ifndef ZT_DESCRIPTION_KEYS_H
#define ZT_DESCRIPTION_KEYS_H

#include "description/reading.h"

/* What is written about a property that moves: a mapping, and one that it takes in by "use",
 * or NULL. */
typedef struct zt_said {
    const zt_property *property;
    zt_fields own;
    const zt_node *shared;
} zt_said;

/* The value of a key, its own before the shared one; or NULL. */
const zt_node *zt_said_field(const zt_said *said, const char *name);

/* How the keys' times and values are changed: "delay", "speed" and "scale". */
typedef struct zt_change {
    double delay_s, speed, scale;
} zt_change;

/* The keys, in the order of time. */
typedef struct zt_keys {
    int32_t count;
    zt_key *keys;
    const zt_node *const *whens; /* what says the time of each */
    zt_curve_space space;
} zt_keys;

/* Whether a way can be one of the property's, which is told where not. */
bool zt_suits(zt_reading *reading, const zt_node *node, zt_way way,
              const zt_property *property);

/* Reads "keys", or "at" and "values". `usual` is the way of those that do not say one; `space`
 * is NULL where it is not said. *good is false where something is wrong, which is told.
 * ZT_EMEMORY. */
zt_status zt_keys_read(zt_keys *keys, bool *good, zt_reading *reading, const zt_said *said,
                       zt_change change, zt_way usual, const zt_curve_space *space);

#endif
