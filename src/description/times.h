/* Times, and the rate that turns frames into times. */
#ifndef ZT_DESCRIPTION_TIMES_H
#define ZT_DESCRIPTION_TIMES_H

#include <zoetrope/rate.h>

#include "description/mistakes.h"
#include "description/node.h"

/* A point of time, as it was written: seconds or a frame. */
typedef struct zt_moment {
    bool is_frame;
    int64_t frame;
    double seconds;
} zt_moment;

/* "1.5 s", "500 ms", or a whole number of frames. `what` is NULL where the node is itself a
 * key. */
bool zt_read_moment(zt_moment *moment, zt_mistakes *mistakes, const zt_node *node,
                    const char *what);

/* Exactly the time of its frame for a moment written as one. */
double zt_moment_s(zt_moment moment, zt_rate rate);

/* "24", "30000/1001" or "29.97", which becomes 2997/100, exactly its digits; warns where a
 * decimal stands for one of the rates of television, n * 1000/1001. */
bool zt_read_rate(zt_rate *rate, zt_mistakes *mistakes, const zt_node *node, const char *what);

#endif
