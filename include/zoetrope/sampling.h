/* What is asked of a picture: how many samples, where, and how they become pixels. */
#ifndef ZOETROPE_SAMPLING_H
#define ZOETROPE_SAMPLING_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How much a sample counts for a pixel, by its distance along x and along y. */
typedef enum zt_filter {
    ZT_FILTER_BOX,
    ZT_FILTER_TENT,
    ZT_FILTER_GAUSSIAN,
    ZT_FILTER_MITCHELL, /* B = C = 1/3 (Mitchell and Netravali, 1988) */
    ZT_FILTER_BLACKMAN_HARRIS,
    ZT_FILTER_COUNT
} zt_filter;

/* What a filter is called: "blackman-harris". */
const char *zt_filter_name(zt_filter filter);

typedef struct zt_sampling {
    int min, max; /* samples a pixel; where they are the same, as many in each */
    double error; /* a pixel whose estimated standard error, in linear light, is below this is
                     left, at edges below less where it takes few; 0 where min = max */
    int mean_max; /* no further samples once pixels would have more than so many on average; 0:
                     no bound. Of adaptive sampling, for budgets */
    bool edges;   /* begin with one sample a pixel, and go on only where neighbours differ */
    zt_filter filter;
    double filter_width; /* from end to end, pixels; 0: the filter's own */
    uint32_t seed;
    bool seed_fixed; /* the same noise in all frames, instead of another one in each */
} zt_sampling;

#ifdef __cplusplus
}
#endif
#endif
