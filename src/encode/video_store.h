/* Films whose kind has no pieces (GIF has one palette for all, APNG tells how many frames it
 * has): their frames wait in pieces of a codec that loses nothing, and become the film when all
 * are there. */
#ifndef ZT_ENCODE_VIDEO_STORE_H
#define ZT_ENCODE_VIDEO_STORE_H

#include "encode/video_join.h"
#include "encode/video_palette.h"
#include "encode/video_part.h"

/* Zeroed: nothing is open. */
typedef struct zt_video_store {
    const zt_video_ear *ear;
    const zt_video_choice *choice;     /* the film's own */
    const AVFrame *like;               /* a frame like those that are stored */
    const zt_video_palette_door *door; /* NULL: no palette */
    void *palette;
    int64_t counted; /* frames from the film's first on, whose colours are */
} zt_video_store;

/* All is borrowed. */
zt_status zt_video_store_open(zt_video_store *store, const zt_video_choice *choice,
                              const AVFrame *like, const zt_video_ear *ear);

/* Shows a frame that was stored at a position of the film, so that it need not be read again
 * for its colours; in turn, any of them. Only its time changes. */
zt_status zt_video_store_see(zt_video_store *store, AVFrame *frame, int64_t position);

/* Makes the film at `path` of `count` pieces. `frame_count` is how many came. */
zt_status zt_video_store_join(int64_t *frame_count, zt_video_store *store, const char *path,
                              const zt_output_format *format, const zt_video_part *part,
                              const zt_video_piece *const *pieces, int64_t count);
void zt_video_store_close(zt_video_store *store);

#endif
