/* Where, when and through which point of the lens the samples of pixels are taken: a function
 * of the pixel and the sample's number alone, so that any of them can be taken again by itself.
 */
#ifndef ZT_RENDER_SAMPLES_H
#define ZT_RENDER_SAMPLES_H

#include "render/render.h"

/* Of a batch: some samples of each pixel, one after the other. */
typedef struct zt_places {
    alignas(64) float x[ZT_BATCH]; /* in the picture, pixels from its top left corner */
    alignas(64) float y[ZT_BATCH];
    alignas(64) float u[ZT_BATCH]; /* in the lens */
    alignas(64) float v[ZT_BATCH];
    alignas(
        64) float weight[ZT_BATCH]; /* 1, or -1 where a filter is negative; of signed filters */
    /* Of pixels: what the numbers are keyed by; of where samples are taken, and of all else. */
    alignas(64) uint32_t place_key[ZT_BATCH];
    alignas(64) uint32_t key[ZT_BATCH];
} zt_places;

/* The number of the sample that is in the middle of its pixel. */
enum { ZT_SAMPLE_MIDDLE = -1 };

/* The keys of `count` pixels. */
void zt_samples_key(zt_places *places, const zt_render_job *job, const int32_t *column,
                    const int32_t *row, int count);

/* Sample number `sample` of each of `count` pixels, whose keys are there: its place, as number
 * `first` of the batch and on, and its time and key in the rays, where these are read. The
 * places are for zt_lens_rays(). A single sample is in the middle, whatever its number. */
void zt_samples_take(zt_places *places, zt_rays *rays, const zt_render_job *job,
                     const int32_t *column, const int32_t *row, int first, int count,
                     int sample);

#endif
