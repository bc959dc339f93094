/* Kinks: where within a shutter's opening keys may bend a curve or make it jump, so that it is
 * looked at there. */
#ifndef ZT_SEQUENCE_KINKS_H
#define ZT_SEQUENCE_KINKS_H

#include "keyframe/animation.h"

/* Writes the moments next to such keys, rising, within 1 .. ZT_TIME_CELLS - 1: of an opening
 * from one time to a later one, in parts of ZT_TIME_CELLS of it. At most `most` of them, evenly
 * chosen where there are more. Returns how many. */
int zt_kinks(int *cells, int most, const zt_animation *animation, double from_s, double to_s);

#endif
