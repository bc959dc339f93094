/* Which containers and codecs there are, and what a movie's options come to: one table drives
 * names, refusals, encoders and tags. */
#ifndef ZT_ENCODE_VIDEO_CODECS_H
#define ZT_ENCODE_VIDEO_CODECS_H

#include <stdbool.h>
#include <stdint.h>

#include <libavcodec/avcodec.h>

#include <zoetrope/output.h>

#include "encode/video_libav.h"

/* A file's kind, chosen by its ending. */
typedef struct zt_container {
    const char *ending, *muxer;
    const char *settings;           /* the tag that holds them; NULL: none of its own */
    const char *codec;              /* where none is asked for */
    const char *sound;              /* the encoder of sound; NULL: it holds none */
    enum AVCodecID takes_sound[12]; /* that is copied; AV_CODEC_ID_NONE after the last */
    bool has_boxes;                 /* of ISO/IEC 14496-12: moov goes before mdat */
    int ticks_a_second;             /* that frames' times are rounded to; 0: exact */
    int rate_max;                   /* frames a second that players show; 0: any */
    bool has_delays;                /* from frame to frame, instead of times */
} zt_container;

/* Something that an encoder is told besides what was asked for. */
typedef struct zt_codec_setting {
    const char *name, *value;
    const char *pixels; /* only with this pixel format; NULL: always */
} zt_codec_setting;

/* Another codec that loses nothing, and its pixel format. */
typedef struct zt_codec_store {
    const char *codec, *pixels;
} zt_codec_store;

enum { ZT_CODEC_LIST_MAX = 10 };

/* A codec, by the name of the option. Lists of texts end with NULL. */
typedef struct zt_codec {
    const char *name, *title; /* "h264", "H.264" */
    const char *encoder;      /* as libavcodec calls it */
    const char *decoder;      /* of alpha, where libavcodec's own leaves it out; else NULL */
    const char *endings[4];
    const char *pixels[ZT_CODEC_LIST_MAX];    /* the first one where none is asked for */
    zt_codec_store stored[ZT_CODEC_LIST_MAX]; /* how frames of each wait, where the kind of
                                                 file has no pieces */
    const char *opaque_in; /* the ending of files that have no place for its alpha; or NULL */
    int width_min, height_min;
    const char *crf; /* where none is asked for; NULL: there is no such scale */
    int crf_max;
    bool has_bitrate;
    const char *const *presets; /* from the fastest to the slowest; NULL: none */
    const char *preset_option, *preset;
    zt_codec_setting settings[7];
    const char *avx512_params; /* that "-params" among them have besides on processors with
                                  AVX-512; NULL: none */
    int thread_count;          /* fixed: what comes out may depend on it */
    bool threads_take_frames;  /* each one of its own */
    uint32_t tag;              /* in MP4 and MOV; 0: by the muxer */
    bool alone;                /* each picture is encoded by itself, on one thread; what comes
                                  out depends on nothing before */
    bool lossless;             /* the decoded pixels are those that were sent */
    bool palette;              /* made from the film */
    double bits_a_pixel;       /* of a usual film */
} zt_codec;

/* All that there are; the last ones have no ending, no name. */
extern const zt_container zt_containers[];
extern const zt_codec zt_codecs[];

/* What was chosen, all of it known to exist and to fit together. The texts are the options'. */
typedef struct zt_video_choice {
    const zt_container *container;
    const zt_codec *codec;
    const AVCodec *encoder;
    enum AVPixelFormat pixels;
    const zt_codec_store *stored; /* of the codec's; NULL: it has pieces */
    const char *crf, *preset;     /* NULL: does not apply */
    int thread_count;             /* the codec's, or as many as there are frames for */
    int64_t bitrate;              /* bits a second; 0: by crf, or by itself */
    const zt_output_option *options;
} zt_video_choice;

/* Understands the options. ZT_EARGUMENT, or ZT_EUNSUPPORTED for what this FFmpeg cannot encode,
 * after telling what there is instead. */
zt_status zt_video_choose(zt_video_choice *choice, const zt_output_format *format,
                          const zt_output_option *options, const zt_video_ear *ear);

/* Puts the choice, with the person's encoder-options, into a context that was allocated for its
 * encoder and is not yet open. */
zt_status zt_video_configure(AVCodecContext *encoder, const zt_video_choice *choice,
                             const zt_video_ear *ear);

/* "H.264 (libx264), yuv420p, crf 18, preset veryfast", for people. */
void zt_video_describe(char *text, size_t size, const zt_video_choice *choice);

#endif
