/* A palette for a whole film, by libavfilter's palettegen and paletteuse. A module of its own
 * (base/module.h): libavfilter brings 60 more libraries, and only GIF asks for it. */
#ifndef ZT_ENCODE_VIDEO_PALETTE_H
#define ZT_ENCODE_VIDEO_PALETTE_H

#include <libavutil/frame.h>

#include <zoetrope/status.h>

#include "base/module.h"

/* Frames are of one size, in one format of R'G'B'. All calls give 0, or an error of libav's. */
typedef struct zt_video_palette_door {
    /* Begins counting colours. */
    int (*open)(void **palette, const AVFrame *first);
    int (*count)(void *palette, AVFrame *frame);
    /* All have been counted. Chooses the colours that show the film best, and one for what is
     * transparent. */
    int (*choose)(void *palette);
    /* A new frame in PAL8, of the caller to free: the frame in those colours, dithered. */
    int (*use)(AVFrame **out, void *palette, AVFrame *frame);
    void (*close)(void *palette); /* NULL is no harm */
} zt_video_palette_door;

#endif
