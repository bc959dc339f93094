/* Slates: frames that images were converted to, kept to be converted to again. An encoder that
 * has done with one leaves in it what the next image may partly show as well. */
#ifndef ZT_ENCODE_VIDEO_SLATES_H
#define ZT_ENCODE_VIDEO_SLATES_H

#include <stdbool.h>
#include <stdint.h>

#include <libavutil/frame.h>

#include <zoetrope/image.h>

#include "encode/video_libav.h"

typedef struct zt_video_slates zt_video_slates;

/* A frame, and the stamps of the tiles that it shows (image/stamps.h). */
typedef struct zt_video_slate {
    AVFrame *frame;
    uint64_t *stamps;
    bool taken;
    int64_t turn; /* when it was given back */
} zt_video_slate;

/* ZT_EMEMORY. */
zt_status zt_video_slates_open(zt_video_slates **slates);

/* Those that are still referred to elsewhere go when they are not. */
void zt_video_slates_close(zt_video_slates **slates);

/* Takes the slate for frames like this one that was given back last and that nobody refers to
 * any more, or makes one, which is zero; to be given back, and not to be written to from then
 * on. From any thread. */
zt_status zt_video_slates_take(zt_video_slate **slate, zt_video_slates *slates, int width,
                               int height, enum AVPixelFormat pixels, const zt_video_ear *ear);
void zt_video_slates_give(zt_video_slates *slates, zt_video_slate *slate);

/* Counts tiles that were not converted, as a slate showed them already; and how many these are
 * so far, once nobody counts any more. */
void zt_video_slates_spare(zt_video_slates *slates, int64_t tiles);
int64_t zt_video_slates_spared(const zt_video_slates *slates);

#endif
