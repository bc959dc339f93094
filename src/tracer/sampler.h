/* Where in a pixel its samples lie. */
#ifndef ZT_TRACER_SAMPLER_H
#define ZT_TRACER_SAMPLER_H

#include <stdint.h>

/* What scrambles the samples of a pixel. */
typedef struct zt_pixel_seeds {
    uint32_t order, x, y;
} zt_pixel_seeds;

zt_pixel_seeds zt_sample_seeds(int32_t column, int32_t row);

/* The places (x, y), in pixels from the top left corner, of sample number `sample` of
 * `sample_count` in each of `count` pixels. A single sample is in the middle; several are the
 * first two dimensions of Sobol's sequence with Owen scrambling keyed by the pixel (Burley,
 * "Practical hash-based Owen scrambling", JCGT 9(4), 2020). The frame is no part of the key:
 * what holds still looks the same from frame to frame. */
void zt_sample_pixels(float *x, float *y, const int32_t *column, const int32_t *row,
                      const zt_pixel_seeds *seeds, int count, int sample, int sample_count);

#endif
