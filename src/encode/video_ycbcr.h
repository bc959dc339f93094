/* R'G'B' as Y'CbCr of ITU-R BT.709 in limited range, as numbers of steps of 8 bits. */
#ifndef ZT_ENCODE_VIDEO_YCBCR_H
#define ZT_ENCODE_VIDEO_YCBCR_H

#include <stdbool.h>

/* Of `width` pixels side by side, three numbers of 0..1 each: their luma, 16..235; and their
 * chroma, -112..112, is added to the sums, each of which begins with a place before the first
 * pixel and ends with one behind the last. */
void zt_video_luma(float *luma, float *cb, float *cr, const float *shown, int width);

/* The sums of `row_count` rows become a line of chroma, 16..240, and zero. `halved`: a number
 * is sited left in its pair of pixels and is their mean and their neighbours', 1:2:1; the first
 * `before` pixels, one or none, are only a neighbour, else the first pixel is its own, as in a
 * picture's first column. */
void zt_video_chroma(float *line, float *sums, int width, int before, bool halved,
                     int row_count);

#endif
