/* Films whose kind has no pieces (GIF has one palette for all, APNG tells how many frames it
 * has): their frames wait in pieces of FFV1, which loses nothing, and become the film when all
 * are there. */
#ifndef ZT_ENCODE_VIDEO_STORE_H
#define ZT_ENCODE_VIDEO_STORE_H

#include "encode/video_join.h"
#include "encode/video_part.h"

/* Makes the film at `path` of `count` pieces. `choice` is the film's own; `like` a frame like
 * those that were stored. `frame_count` is how many came. */
zt_status zt_video_store_join(int64_t *frame_count, const char *path,
                              const zt_video_choice *choice, const zt_output_format *format,
                              const zt_video_part *part, const zt_video_piece *const *pieces,
                              int64_t count, const AVFrame *like, const zt_video_ear *ear);

#endif
