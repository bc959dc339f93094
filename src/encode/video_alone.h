/* Encoders for kinds of which each picture stands alone: as many as threads ask at once, so
 * that pictures are encoded side by side, each on one core, and none waits for another. */
#ifndef ZT_ENCODE_VIDEO_ALONE_H
#define ZT_ENCODE_VIDEO_ALONE_H

#include <libavformat/avformat.h>

#include "encode/video_codecs.h"

typedef struct zt_video_alone zt_video_alone;

/* For frames like `like`; the choice and it are borrowed. `encoder` is one by that choice:
 * where its pictures do not stand alone, *alone is NULL, and nothing fails. */
zt_status zt_video_alone_open(zt_video_alone **alone, const zt_video_choice *choice,
                              const AVCodecContext *encoder, const AVFrame *like);

/* The frame's packet, of the caller to free, without a time. From any thread, several at once.
 */
zt_status zt_video_alone_encode(AVPacket **packet, zt_video_alone *alone, const AVFrame *frame,
                                const zt_video_ear *ear);
void zt_video_alone_close(zt_video_alone **alone);

#endif
