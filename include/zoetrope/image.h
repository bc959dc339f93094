/* Finished pixels. */
#ifndef ZOETROPE_IMAGE_H
#define ZOETROPE_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/hash.h>
#include <zoetrope/rate.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How linear light becomes the numbers of a display. */
typedef enum zt_view {
    ZT_VIEW_RAW,    /* the numbers as they are, cut to 0..1 */
    ZT_VIEW_SRGB,   /* the sRGB transfer function, IEC 61966-2-1 */
    ZT_VIEW_REC709, /* the transfer function of cameras, ITU-R BT.709-6 */
    ZT_VIEW_FILMIC, /* a tone curve that reaches white at 5.6, then the sRGB function */
    ZT_VIEW_COUNT
} zt_view;

/* What a view is called: "srgb". */
const char *zt_view_name(zt_view view);

/* The largest width and height an image may have, and how many further channels. */
enum { ZT_IMAGE_SIDE_MAX = 65536, ZT_IMAGE_CHANNELS_MAX = 24 };

/* What an image is of, for those who work on with it; files hold as much of it as their format
 * can. Texts are NULL where they are not known, and not the image's own, unless it was read. */
typedef struct zt_image_info {
    bool known; /* else the rest says nothing */
    int64_t frame;
    zt_rate rate;
    zt_hash key;     /* of all that decides the pixels */
    double render_s; /* seconds of wall time */
    uint64_t seed;
    /* By rows, for points as rows on the left of them; the spaces are those of OpenEXR's
     * standard attributes worldToCamera (x to the right, y up, z ahead) and worldToNDC (x / w
     * and y / w are 0, 0 in the picture's upper left corner and 1, 1 in its lower right one).
     * All zeros where there is no such matrix. */
    double world_to_camera[16], world_to_ndc[16];
    const char *title, *description; /* the film's name, and its file's */
    const char *view;                /* how a display shows it: a zt_view's name */
    const char *settings;            /* all else that decides the pixels, as a text to be read
                                        again by a program */
} zt_image_info;

/* A further channel: height * width numbers, rows from the top. */
typedef struct zt_channel {
    const char *name;
    float *values;
} zt_channel;

/* Linear light, Rec. 709 primaries, float. `pixels` holds height * width * 4 numbers, rows from
 * the top, each pixel R G B A: colours are multiplied by A, how much of the pixel is covered:
 * by what was rendered of a transparent background, else 1. Filters that are negative somewhere
 * take A a little out of 0..1, as they do colours, so that over another picture,
 * R + (1 - A) * R of that one, it is as if that had been the background. */
typedef struct zt_image {
    int width, height;
    float *pixels;
    bool linear;      /* false: read from a file of numbers for a display */
    bool transparent; /* A was asked for: files have it even where it is 1 everywhere */
    zt_channel channels[ZT_IMAGE_CHANNELS_MAX];
    int channel_count;
    zt_image_info info;
    uint64_t *stamps; /* of tiles, for those who make the same of the same again; NULL: none */
    struct zt_image_text *texts; /* the image's own: of one that was read, those of its info,
                                    and its channels' names; else NULL */
} zt_image;

/* Makes a black, opaque image. ZT_EARGUMENT where a side is not in 1..ZT_IMAGE_SIDE_MAX. */
zt_status zt_image_create(zt_image **image, int width, int height);
void zt_image_free(zt_image **image);

/* Reads an image file's numbers as they are stored: an OpenEXR file's linear light exactly,
 * integers as 0..1 with no transfer function undone; grey as R = G = B, A = 1 where the file
 * has none; of OpenEXR the further channels, too, whatever part of the file has them. What it
 * is of is known where an OpenEXR, PNG or TIFF file that was written here says so, but for
 * matrices and the time it took. The caller frees the image. ZT_EFILE after telling why. */
zt_status zt_image_read(zt_image **image, const char *path, zt_listener listener);

/* Adds a channel of zeros, which asks rendering to fill it where it knows the name
 * (zoetrope/aov.h). `name` must outlive the image. Nothing happens where the image has such a
 * channel already. ZT_EMEMORY; ZT_EARGUMENT where it has ZT_IMAGE_CHANNELS_MAX others. */
zt_status zt_image_add_channel(zt_image *image, const char *name);

/* The numbers of a channel, or NULL. */
float *zt_image_channel(const zt_image *image, const char *name);

#ifdef __cplusplus
}
#endif
#endif
