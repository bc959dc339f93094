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

/* The largest width and height an image may have, and how many further channels. */
enum { ZT_IMAGE_SIDE_MAX = 65536, ZT_IMAGE_CHANNELS_MAX = 16 };

/* A further channel: height * width numbers, rows from the top. */
typedef struct zt_channel {
    const char *name;
    float *values;
} zt_channel;

/* Linear light, Rec. 709 primaries, float. `pixels` holds height * width * 4 numbers, rows from
 * the top, each pixel R G B A with A = 1 where the picture is opaque. */
typedef struct zt_image {
    int width, height;
    float *pixels;
    zt_channel channels[ZT_IMAGE_CHANNELS_MAX];
    int channel_count;
} zt_image;

/* Makes a black, opaque image. ZT_EARGUMENT where a side is not in 1..ZT_IMAGE_SIDE_MAX. */
zt_status zt_image_create(zt_image **image, int width, int height);
void zt_image_free(zt_image **image);

/* Adds a channel of zeros, which asks rendering to fill it. Known are
 *
 *   "samples"  how many samples the pixel took
 *   "error"    its estimated standard error in linear light, the root of the mean square of
 * red, green and blue; -1 where there is no estimate, as where all take as many samples
 *
 * `name` must outlive the image. Nothing happens where the image has such a channel already.
 * ZT_EMEMORY; ZT_EARGUMENT where it has ZT_IMAGE_CHANNELS_MAX others. */
zt_status zt_image_add_channel(zt_image *image, const char *name);

/* The numbers of a channel, or NULL. */
float *zt_image_channel(const zt_image *image, const char *name);

#ifdef __cplusplus
}
#endif
#endif
