/* Developing: linear light becomes the numbers that a display or a file of integers wants. */
#ifndef ZT_IMAGE_DEVELOP_H
#define ZT_IMAGE_DEVELOP_H

#include <stdint.h>

#include <zoetrope/image.h>

/* Develops rows first .. last - 1 to 8 bits: 3 bytes R G B a pixel, rows `stride` bytes apart,
 * the first of them at `bytes`. Each value is the nearest of the 256 to the exact result of the
 * view; what is no number becomes 0. */
void zt_develop_rgb8(uint8_t *bytes, size_t stride, const zt_image *image, zt_view view,
                     int first, int last);

/* The same to 16 bits: rows `stride` bytes apart, each value the nearest of the 65536. */
void zt_develop_rgb16(uint16_t *values, size_t stride, const zt_image *image, zt_view view,
                      int first, int last);

/* One value through the view to 0..1, in double: the definition that the above is held to. What
 * lies outside of 0 .. the view's white (1; 5.6 of filmic) is cut; what is no number becomes 0.
 */
double zt_develop_value(double linear, zt_view view);

/* The inverse for the sRGB view: a display value of 0..1 to linear light. */
double zt_srgb_to_linear(double display);

#endif
