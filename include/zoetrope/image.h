/* Finished pixels. */
#ifndef ZOETROPE_IMAGE_H
#define ZOETROPE_IMAGE_H

#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How linear light becomes the numbers of a display. */
typedef enum zt_view {
    ZT_VIEW_RAW, /* the numbers as they are, cut to 0..1 */
    ZT_VIEW_SRGB /* the sRGB transfer function, IEC 61966-2-1 */
} zt_view;

/* Linear light, Rec. 709 primaries, float. `pixels` holds height * width * 4 numbers, rows from
 * the top, each pixel R G B A with A = 1 where the picture is opaque. */
typedef struct zt_image {
    int width, height;
    float *pixels;
} zt_image;

/* The largest width and height an image may have. */
enum { ZT_IMAGE_SIDE_MAX = 65536 };

/* Makes a black, opaque image. ZT_EARGUMENT where a side is not in 1..ZT_IMAGE_SIDE_MAX. */
zt_status zt_image_create(zt_image **image, int width, int height);
void zt_image_free(zt_image **image);

#ifdef __cplusplus
}
#endif
#endif
