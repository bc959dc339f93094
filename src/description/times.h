/* Times, and the rate that turns frames into times. */
#ifndef ZT_DESCRIPTION_TIMES_H
#define ZT_DESCRIPTION_TIMES_H

#include <zoetrope/animation.h>
#include <zoetrope/rate.h>

#include "description/mistakes.h"
#include "description/node.h"

/* How a time was written. */
typedef enum zt_time_unit { ZT_TIME_SECONDS, ZT_TIME_FRAMES, ZT_TIME_PERCENT } zt_time_unit;

/* A point of time, as it was written. */
typedef struct zt_moment {
    zt_time_unit unit;
    int64_t frame; /* of ZT_TIME_FRAMES */
    double number; /* of the others: seconds, or hundredths of the film */
} zt_moment;

/* "1.5 s", "500 ms", a whole number of frames, "25 %" of the film, or the timecode
 * "hh:mm:ss:ff", which counts as many frames a second as the rate rounded up and leaves none
 * out. `what` is NULL where the node is itself a key. */
bool zt_read_moment(zt_moment *moment, zt_mistakes *mistakes, const zt_node *node,
                    const char *what, zt_rate rate);

/* The same as seconds: exactly the time of a frame for one that is written as a frame. */
bool zt_read_time(double *time_s, zt_mistakes *mistakes, const zt_node *node, const char *what,
                  const zt_film *film);

/* "24", "30000/1001" or "29.97", which becomes 2997/100, exactly its digits; warns where a
 * decimal stands for one of the rates of television, n * 1000/1001. */
bool zt_read_rate(zt_rate *rate, zt_mistakes *mistakes, const zt_node *node, const char *what);

#endif
