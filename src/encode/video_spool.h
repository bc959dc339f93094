/* Frames that wait for their piece of a film to be complete: what took long to render is kept
 * in a file, as it goes to the encoder, so that a program that is killed has to render little
 * again. Each has its key and a checksum. */
#ifndef ZT_ENCODE_VIDEO_SPOOL_H
#define ZT_ENCODE_VIDEO_SPOOL_H

#include <stdbool.h>
#include <stdint.h>

#include <libavutil/frame.h>

#include <zoetrope/hash.h>

#include "encode/video_libav.h"

/* A frame in the file. */
typedef struct zt_video_spooled {
    int64_t position; /* in the film */
    zt_hash key;      /* of what it shows, and how it is converted */
    double render_s;  /* that it took */
    int64_t at;       /* its numbers */
} zt_video_spooled;

/* Zeroed, but for `file` -1: nothing is open. */
typedef struct zt_video_spool {
    const zt_video_ear *ear;
    char *path;
    int file; /* made when the first frame comes */
    int64_t size, frame_size;
    uint8_t *bytes;      /* one frame's */
    const AVFrame *like; /* borrowed: all are of its kind */
    zt_video_spooled *frames;
    int64_t count, capacity;
} zt_video_spool;

/* Opens the file at `path`, if it is there, for frames like `like`. `keeps`: with those that
 * are there whole. */
zt_status zt_video_spool_open(zt_video_spool *spool, const char *path, const AVFrame *like,
                              bool keeps, const zt_video_ear *ear);

/* The frame of a position with this key; NULL: there is none. */
const zt_video_spooled *zt_video_spool_find(const zt_video_spool *spool, int64_t position,
                                            zt_hash key);

/* Adds a frame. */
zt_status zt_video_spool_put(zt_video_spool *spool, const AVFrame *frame, int64_t position,
                             zt_hash key, double render_s);

/* A new frame, of the caller to free, as it was put. */
zt_status zt_video_spool_get(AVFrame **frame, const zt_video_spool *spool,
                             const zt_video_spooled *spooled);

/* Forgets all, where none is of `position` or behind it. */
zt_status zt_video_spool_pass(zt_video_spool *spool, int64_t position);

/* `keeps`: the file stays, if there is a frame in it. */
void zt_video_spool_close(zt_video_spool *spool, bool keeps);

#endif
