/* In which order tracks are evaluated: each after those whose properties it reads. */
#ifndef ZT_KEYFRAME_ORDER_H
#define ZT_KEYFRAME_ORDER_H

#include "keyframe/animation.h"

/* Who is told of tracks that wait for one another: tracks[0] reads what tracks[1] drives, and
 * so on, and the last one reads what tracks[0] drives. A track may wait for itself. */
typedef struct zt_cycle_listener {
    void (*tell)(void *user, const zt_animation *animation, const int32_t *tracks,
                 int32_t count);
    void *user;
} zt_cycle_listener;

/* Writes animation->order: the tracks' own, but that each comes after what it needs. No
 * property may be driven twice. ZT_EDESCRIPTION where there is a cycle, all of which are told
 * in which a first track (in the tracks' order) comes by its first ways; ZT_EMEMORY. */
zt_status zt_animation_sort(zt_animation *animation, zt_cycle_listener cycles);

#endif
