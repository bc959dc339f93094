/* Samples of a block of pixels become pixels of an image. */
#ifndef ZT_RENDER_PIXELS_H
#define ZT_RENDER_PIXELS_H

#include <stdbool.h>
#include <stdint.h>

#include "tracer/kernel.h"

/* Adds a sample of each pixel, from `first` in the batch on, to the sums, and to how many were
 * taken; of transparent pictures also whether it met something. Returns how many were left out
 * because they are not finite. */
int zt_pixels_add(zt_radiance *sum, int32_t *taken, const zt_radiance *light, int first,
                  int count, bool transparent);

/* Makes the sums the means; A is 1 of pictures that are not transparent. */
void zt_pixels_average(zt_radiance *sum, const int32_t *taken, int count, bool transparent);

/* The same for a single sample of each pixel: what is not finite becomes 0. */
int zt_pixels_settle(zt_radiance *light, int count, bool transparent);

/* Makes pixels side by side those of rays that met nothing. */
void zt_pixels_clear(float *pixels, int count, bool transparent);

/* Writes means to an image of such a width, at the listed places. `whole`: of each row of four
 * pixels all are listed, one after the other. */
void zt_pixels_fill(float *pixels, int width, const zt_radiance *mean, const int32_t *column,
                    const int32_t *row, int count, bool whole);
void zt_pixels_fill_paths(uint32_t *paths, int width, const uint32_t *path,
                          const int32_t *column, const int32_t *row, int count, bool whole);

#endif
