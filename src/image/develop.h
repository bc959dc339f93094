/* Developing: linear light becomes the numbers that a display or a file of integers wants. */
#ifndef ZT_IMAGE_DEVELOP_H
#define ZT_IMAGE_DEVELOP_H

#include <stdint.h>

#include <zoetrope/image.h>

/* Develops rows first .. last - 1 to 8 bits: 3 bytes R G B a pixel, rows `stride` bytes apart, the
 * first of them at `bytes`. Each value is the nearest of the 256 to the exact result of the view;
 * what is no number becomes 0. */
void zt_develop_rgb8(uint8_t *bytes, size_t stride, const zt_image *image, zt_view view,
                     int first, int last);

/* One value of 0..1 through the view, in double: the definition that the above is held to. */
double zt_develop_value(double linear, zt_view view);

/* The inverse for the sRGB view: a display value of 0..1 to linear light. */
double zt_srgb_to_linear(double display);

#endif
