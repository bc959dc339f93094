/* A finished film, read again and held against what was sent. */
#ifndef ZT_ENCODE_VIDEO_CHECK_H
#define ZT_ENCODE_VIDEO_CHECK_H

#include "encode/video_codecs.h"

/* Below this, a decoded picture is another one. */
#define ZT_VIDEO_PSNR_MIN 15.0

/* Pictures kept for the comparison: of a film that is encoded at once the first, the last, and
 * one between half of it and its end. */
enum { ZT_VIDEO_SAMPLE_COUNT = 3 };

typedef struct zt_video_sample {
    AVFrame *frame; /* as it was sent; NULL: none */
    int64_t number;
} zt_video_sample;

/* What the file should be. */
typedef struct zt_video_expected {
    const zt_video_choice *choice;
    const AVFrame *like; /* a frame of its size, with its tags */
    zt_rate rate;
    int64_t frame_count;
    bool has_sound;
    zt_hash checksum; /* of its packets (encode/video_piece.h); zero: not known */
    zt_video_sample samples[ZT_VIDEO_SAMPLE_COUNT]; /* by rising number; fewer, or none */
} zt_video_expected;

/* Reads the file at `path`: how many frames, each at its time and all times there; size, codec,
 * pixel format, and the tags of colour in container and stream; moov before mdat; whether the
 * packets are those that were encoded; the samples decoded and compared. ZT_EFILE after telling
 * what is not so. `psnr` is the least of the samples', INFINITY where all are the same to the
 * bit. */
zt_status zt_video_check(double *psnr, const char *path, const zt_video_expected *expected,
                         const zt_video_ear *ear);

#endif
