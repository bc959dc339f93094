/* R'G'B' of 16 bits as Y'CbCr of more than 8. libswscale does this, too, but makes white 943 of
 * 10 bits instead of 940. */
#ifndef ZT_ENCODE_VIDEO_YCBCR_H
#define ZT_ENCODE_VIDEO_YCBCR_H

#include <libavutil/frame.h>

/* Fills `frame`, planar Y'CbCr in little-endian 16 bits, from `rgb` of the same size, RGB48 or
 * RGBA64: BT.709, limited range, each number the nearest. A chroma sample is sited left in its
 * pair of pixels and is their mean and their neighbours', 1:2:1; of two rows it is the mean.
 * `scratch` has place for 2 * (width + 2) floats. */
void zt_video_ycbcr(AVFrame *frame, const AVFrame *rgb, float *scratch);

#endif
