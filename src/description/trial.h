/* A first look at what is driven, before anything is rendered. */
#ifndef ZT_DESCRIPTION_TRIAL_H
#define ZT_DESCRIPTION_TRIAL_H

#include "description/reading.h"

/* Puts the animation's tracks in order, and freezes the first, the middle and the last frame,
 * so that what needs itself, or has no value there, is told. The scene at rest gets the values
 * of time 0. ZT_EDESCRIPTION where something was told and counted; ZT_EMEMORY. */
zt_status zt_trial(zt_reading *reading);

#endif
