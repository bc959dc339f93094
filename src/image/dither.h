/* Dithering: numbers become codes of few bits so that their mean over a few pixels is kept, and
 * slow changes do not become bands. */
#ifndef ZT_IMAGE_DITHER_H
#define ZT_IMAGE_DITHER_H

#include <stdint.h>

enum { ZT_DITHER_SIDE = 64 }; /* pixels, after which the mask begins again both ways */

/* The mask's row of a picture's row `y`: thresholds 0 .. 255, each as often in the mask as any
 * other. It is the same in all frames, so that what stands still does. */
const uint8_t *zt_dither_row(int y);

/* The code of a number of steps: the one below or the one above, in shares of 1 / 256 as far as
 * it is from them. What is a whole number but for 1 / 512 is that. With `threshold` 128 it is
 * the nearest. The number is one of 0 .. 2^16. */
static inline int32_t zt_dither_code(float steps, uint8_t threshold) {
    return ((int32_t)(steps * 256 + 0.5F) + threshold) >> 8;
}

/* Codes of a line, columns first .. first + count - 1: `scale` times each number, by a row of
 * the mask; the nearest where that is NULL. */
void zt_dither_line(uint16_t *codes, const float *numbers, int first, int count, float scale,
                    const uint8_t *row);

#endif
