/* Developing: linear light becomes the numbers that a display or a file of integers wants. */
#ifndef ZT_IMAGE_DEVELOP_H
#define ZT_IMAGE_DEVELOP_H

#include <stdint.h>

#include <zoetrope/image.h>

#include "image/color.h"

/* What becomes of A. Colours come multiplied by it. */
typedef enum zt_alpha {
    ZT_ALPHA_LEFT_OUT, /* three numbers a pixel, as over black */
    ZT_ALPHA_DIVIDED,  /* A behind them, and colours that are divided by it first */
    ZT_ALPHA_KEPT      /* A behind them, and colours as they are */
} zt_alpha;

/* How images are developed. */
typedef struct zt_developing {
    zt_view view;
    const zt_color *color; /* counts instead of the view; NULL: none */
    zt_alpha alpha;
} zt_developing;

/* A row of `width` pixels, R G B A each, to three numbers of 0..1 a pixel: within 4e-7 of the
 * exact result of a view; light below 2^-21, and what is no number, becomes 0. */
void zt_develop_row(float *shown, const float *pixels, int width, const zt_developing *how);

/* Cuts a number to 0..1: all that becomes of A. What is no number becomes 0. */
static inline float zt_develop_cut(float number) {
    float some = number > 0 ? number : 0;
    return some < 1 ? some : 1;
}

/* Develops rows first .. last - 1 to 8 bits: 3 or 4 bytes a pixel, rows `stride` bytes apart,
 * the first of them at `bytes`. Colours are dithered (image/dither.h), A is the nearest. */
void zt_develop_8(uint8_t *bytes, size_t stride, const zt_image *image,
                  const zt_developing *how, int first, int last);

/* The same to 16 bits, not dithered: rows `stride` bytes apart, each value at most 0.53 steps
 * from the exact one. */
void zt_develop_16(uint16_t *values, size_t stride, const zt_image *image,
                   const zt_developing *how, int first, int last);

/* One value through the view to 0..1, in double: the definition that the above is held to. What
 * lies outside of 0 .. the view's white (1; 5.6 of filmic) is cut; what is no number becomes 0.
 */
double zt_develop_value(double linear, zt_view view);

/* The inverse for the sRGB view: a display value of 0..1 to linear light. */
double zt_srgb_to_linear(double display);

#endif
