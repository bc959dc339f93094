/* What movies are made of: luma, and chroma for each 2 x 2 pixels. */
#ifndef ZT_IMAGE_YUV_H
#define ZT_IMAGE_YUV_H

#include <stdint.h>

#include <zoetrope/image.h>

/* Develops an image of even width and height to 8-bit Y'CbCr 4:2:0: planes Y, Cb, Cr, their
 * rows strides[i] bytes apart. From the view's numbers, each the nearest of 256, by the matrix
 * and the limited range of ITU-R BT.709-6 (items 3.2 to 3.5), rounded to the nearest. Chroma is
 * sited left: the mean of both rows, weighted 1 2 1 over three columns, the middle one being
 * the left of the two; at the left edge the first column stands for the missing one. */
void zt_develop_yuv420(uint8_t *const planes[3], const int strides[3], const zt_image *image,
                       zt_view view);

#endif
