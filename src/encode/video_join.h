/* The finished film: packets from wherever they were encoded, with the sound, in the container
 * of its name. */
#ifndef ZT_ENCODE_VIDEO_JOIN_H
#define ZT_ENCODE_VIDEO_JOIN_H

#include <libavformat/avformat.h>

#include "encode/video_codecs.h"
#include "encode/video_part.h"
#include "encode/video_sound.h"

/* Zeroed: nothing is open. */
typedef struct zt_video_join {
    AVFormatContext *container;
    AVStream *stream; /* of the pictures */
    AVRational rate;
    int64_t frame_count;   /* that were put */
    zt_video_sound *sound; /* NULL: silent */
} zt_video_join;

/* Writes the head of the file at `path`, for packets like `of`. */
zt_status zt_video_join_open(zt_video_join *join, const char *path,
                             const zt_video_choice *choice, const zt_output_format *format,
                             const AVCodecParameters *of, const zt_video_ear *ear);

/* Writes the next packet, in the order of decoding, and the sound that goes with it. Its times
 * are frame numbers; it is changed. */
zt_status zt_video_join_put(zt_video_join *join, AVPacket *packet, const zt_video_ear *ear);

/* Completes the file. */
zt_status zt_video_join_finish(zt_video_join *join, const zt_video_ear *ear);

/* Closes what is open, finished or not. */
void zt_video_join_close(zt_video_join *join);

/* Makes the film at `path` of `count` pieces that follow each other, with packets like `of`;
 * `checksum` is that of its packets. */
zt_status zt_video_join_pieces(zt_hash *checksum, const char *path,
                               const zt_video_choice *choice, const zt_output_format *format,
                               const AVCodecParameters *of, const zt_video_part *part,
                               const zt_video_piece *const *pieces, int64_t count,
                               const zt_video_ear *ear);

#endif
