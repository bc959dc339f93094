/* The rate of a film: a rational number of frames a second, so that 30000/1001 is exact. */
#ifndef ZOETROPE_RATE_H
#define ZOETROPE_RATE_H

#include <stdint.h>

/* num/den frames a second; both positive. */
typedef struct zt_rate {
    int32_t num, den;
} zt_rate;

/* The time of a frame in seconds: frame * den / num, rounded once. Exact products (and so the
 * nearest double to the true time) for |frame * den| up to 2^53; never accumulated. */
static inline double zt_rate_time(zt_rate rate, int64_t frame) {
    return (double)(frame * rate.den) / (double)rate.num;
}

#endif
