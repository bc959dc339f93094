/* An encoder and the file that its packets go to. */
#ifndef ZT_ENCODE_VIDEO_WRITER_H
#define ZT_ENCODE_VIDEO_WRITER_H

#include <libavformat/avformat.h>

#include "encode/video_codecs.h"
#include "encode/video_sound.h"

/* Zeroed: nothing is open. */
typedef struct zt_video_writer {
    AVFormatContext *container;
    AVCodecContext *encoder;
    AVStream *stream; /* the container's */
    AVPacket *packet;
    AVRational rate;
    int64_t frame_count;   /* given to the encoder */
    zt_video_sound *sound; /* NULL: silent */
} zt_video_writer;

/* Opens the encoder by the choice and writes the head of the file at `path`. `first` is a frame
 * like all that will come, with its tags. */
zt_status zt_video_writer_open(zt_video_writer *writer, const char *path,
                               const zt_video_choice *choice, const zt_output_format *format,
                               const AVFrame *first, const zt_video_ear *ear);

/* Encodes the next frame, and writes what is ready and the sound that goes with it. */
zt_status zt_video_writer_put(zt_video_writer *writer, AVFrame *frame, const zt_video_ear *ear);

/* Completes the file. */
zt_status zt_video_writer_finish(zt_video_writer *writer, const zt_video_ear *ear);

/* Closes what is open, finished or not. */
void zt_video_writer_close(zt_video_writer *writer);

#endif
