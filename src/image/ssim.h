/* Structural similarity. */
#ifndef ZT_IMAGE_SSIM_H
#define ZT_IMAGE_SSIM_H

#include <stdint.h>

#include "base/arena.h"
#include <zoetrope/status.h>

/* The mean SSIM of luma (Rec. 709) of two pictures, 3 bytes a pixel: Z. Wang, A. C. Bovik, H.
 * R. Sheikh and E. P. Simoncelli, "Image quality assessment: from error visibility to
 * structural similarity", 2004; by Gaussian windows of 11 x 11 pixels, those that lie within
 * the picture (in smaller pictures all, which then go on as they end). Memory is from the
 * arena. ZT_EMEMORY. */
zt_status zt_ssim(double *mean, const uint8_t *image, const uint8_t *reference, int width,
                  int height, zt_arena *arena);

#endif
