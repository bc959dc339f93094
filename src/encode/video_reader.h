/* Reading films back. */
#ifndef ZT_ENCODE_VIDEO_READER_H
#define ZT_ENCODE_VIDEO_READER_H

#include <stdbool.h>

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>

/* Zeroed: nothing is open. */
typedef struct zt_video_reader {
    AVFormatContext *container;
    AVStream *stream; /* of the pictures */
    AVCodecContext *decoder;
    AVPacket *packet;
    AVFrame *frame; /* the one that was decoded last */
    /* Which pictures are wanted, by their times: others need not be decoded where nothing
     * refers to them. NULL: all. */
    bool (*wants)(const void *user, int64_t pts);
    const void *user;
} zt_video_reader;

/* All give 0, or an error of libav's. `decoder` by name; NULL: the codec's own. Closing is
 * needed after failures, too. */
int zt_video_reader_open(zt_video_reader *reader, const char *path, const char *decoder);

/* Decodes the next picture. AVERROR_EOF after the last one. */
int zt_video_reader_next(zt_video_reader *reader);

/* Goes on with the picture at or before `pts` that others do not lead up to, where the file is
 * one that allows that; else stays, and is false. */
bool zt_video_reader_seek(zt_video_reader *reader, int64_t pts);

void zt_video_reader_close(zt_video_reader *reader);

#endif
