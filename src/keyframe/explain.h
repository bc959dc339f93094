/* What explaining and advising share. */
#ifndef ZT_KEYFRAME_EXPLAIN_H
#define ZT_KEYFRAME_EXPLAIN_H

#include <zoetrope/explain.h>

#include "keyframe/animation.h"

/* What one unit of a property as it is written is in the numbers of curves: radians of "deg".
 */
double zt_property_unit(const zt_property *property);

/* The words for a frame or a time: "frame 37", "1.51 s" between frames. */
typedef struct zt_moment_words {
    char text[48];
} zt_moment_words;
zt_moment_words zt_moment_in_words(zt_rate rate, double time_s);

#endif
