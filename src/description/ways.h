/* The words of a curve: how it goes from key to key, easings, ends, springs. */
#ifndef ZT_DESCRIPTION_WAYS_H
#define ZT_DESCRIPTION_WAYS_H

#include "description/node.h"
#include "keyframe/curve.h"

struct zt_reading;

/* Easings that were read, by the node that holds their text, so that what an alias repeats is
 * read once. Zeroed is empty. */
typedef struct zt_eases {
    struct zt_known_ease *slots;
    size_t capacity, count;
} zt_eases;

/* How a curve goes from one key to the next. */
typedef struct zt_way {
    zt_curve_kind kind;  /* ZT_CURVE_KIND_COUNT where something is wrong with its word */
    const zt_ease *ease; /* or NULL */
} zt_way;

/* Of these, *good is false where something is wrong, which is told; ZT_EMEMORY is all that can
 * fail. `what` is the key that the node belongs to. */

/* A kind of curve ("smooth"), or an easing ("ease-in-out"), which is linear and eased. */
zt_status zt_read_way(zt_way *way, bool *good, struct zt_reading *reading, const zt_node *node,
                      const char *what);

/* An easing, in the animation's memory. NULL for "linear". */
zt_status zt_read_ease(const zt_ease **ease, bool *good, struct zt_reading *reading,
                       const zt_node *node, const char *what);

/* "hold", "linear", "loop", "ping-pong" or "loop-with-offset". */
bool zt_read_end(zt_curve_end *end, struct zt_reading *reading, const zt_node *node,
                 const char *what);

/* { stiffness, damping, mass: 1 } or { frequency (Hz), damping_ratio: 0.5 }. */
bool zt_read_spring(zt_spring *spring, struct zt_reading *reading, const zt_node *node);

#endif
