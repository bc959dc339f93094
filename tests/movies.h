/* For tests of movies: a test card, and films read again with libavformat and libavcodec. After
 * files.h; cmocka.h comes first. */
#ifndef ZT_TESTS_MOVIES_H
#define ZT_TESTS_MOVIES_H

#include <math.h>
#include <string.h>

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>

#include "files.h"
#include <zoetrope/output.h>

enum { FRAMES_MAX = 512 };

static heard movie_heard; /* of the movie that was opened last */

/* Opens a movie; fails with what was told where that is refused. */
static inline zt_output *open_movie_by(const char *path, const zt_output_format *format,
                                       const zt_output_option *options) {
    zt_output *output;
    if (zt_output_open(&output, path, format, options, listener_of(&movie_heard)) != ZT_OK)
        fail_msg("%s", movie_heard.text);
    return output;
}

static inline zt_output *open_movie(const char *path, const zt_output_format *format) {
    return open_movie_by(path, format, NULL);
}

static inline void close_movie(zt_output **output) {
    if (zt_output_close(output) != ZT_OK || movie_heard.error_count > 0)
        fail_msg("%s", movie_heard.text);
    assert_null(*output);
}

/* Frames 7, 8, .. of moving pictures: that a film begins elsewhere does not show in the movie.
 */
static inline void write_movie_by(const char *path, const zt_output_format *format,
                                  const zt_output_option *options, int frame_count) {
    zt_output *output = open_movie_by(path, format, options);
    for (int f = 0; f < frame_count; f++) {
        zt_image *image = picture(format->width, format->height, f);
        assert_int_equal(zt_output_write(output, image, f + 7), ZT_OK);
        zt_image_free(&image);
    }
    close_movie(&output);
}

static inline void write_movie(const char *path, const zt_output_format *format,
                               int frame_count) {
    write_movie_by(path, format, NULL, frame_count);
}

/* A file opened for reading: the packets of its pictures in the order of the file. */
typedef struct film {
    AVFormatContext *container;
    AVStream *stream;
    AVPacket *packets[FRAMES_MAX];
    int packet_count;
} film;

static inline film film_open(const char *path) {
    film m = {0};
    assert_int_equal(avformat_open_input(&m.container, path, NULL, NULL), 0);
    assert_true(avformat_find_stream_info(m.container, NULL) >= 0);
    m.stream = m.container->streams[0];
    AVPacket *packet = av_packet_alloc();
    while (av_read_frame(m.container, packet) >= 0) {
        if (packet->stream_index == 0) {
            assert_true(m.packet_count < FRAMES_MAX);
            m.packets[m.packet_count++] = packet;
            packet = av_packet_alloc();
        } else {
            av_packet_unref(packet);
        }
    }
    av_packet_free(&packet);
    return m;
}

static inline void film_close(film *m) {
    for (int i = 0; i < m->packet_count; i++) av_packet_free(&m->packets[i]);
    avformat_close_input(&m->container);
}

/* Decodes packets first .. last - 1 by a decoder, by name or the codec's own, that has seen
 * nothing else. The frames are the caller's. */
static inline int decode_by(const char *name, const film *m, int first, int last,
                            AVFrame *frames[FRAMES_MAX]) {
    const AVCodec *codec = name ? avcodec_find_decoder_by_name(name)
                                : avcodec_find_decoder(m->stream->codecpar->codec_id);
    AVCodecContext *decoder = avcodec_alloc_context3(codec);
    assert_int_equal(avcodec_parameters_to_context(decoder, m->stream->codecpar), 0);
    decoder->err_recognition = AV_EF_EXPLODE;
    decoder->thread_count = 1;
    decoder->pkt_timebase = m->stream->time_base;
    assert_int_equal(avcodec_open2(decoder, codec, NULL), 0);
    int frame_count = 0;
    for (int p = first; p <= last; p++) {
        assert_int_equal(avcodec_send_packet(decoder, p < last ? m->packets[p] : NULL), 0);
        for (;;) {
            AVFrame *frame = av_frame_alloc();
            if (avcodec_receive_frame(decoder, frame) < 0) {
                av_frame_free(&frame);
                break;
            }
            assert_true(frame_count < FRAMES_MAX);
            frames[frame_count++] = frame;
        }
    }
    avcodec_free_context(&decoder);
    return frame_count;
}

static inline int decode(const film *m, int first, int last, AVFrame *frames[FRAMES_MAX]) {
    return decode_by(NULL, m, first, last, frames);
}

static inline void free_frames(AVFrame **frames, int count) {
    for (int i = 0; i < count; i++) av_frame_free(&frames[i]);
}

/* Patches of the test card, linear. */
static const float patches[][3] = {
    {1, 0, 0},          {0, 1, 0},       {0, 0, 1},       {1, 1, 0},          {0, 1, 1},
    {1, 0, 1},          {1, 1, 1},       {0, 0, 0},       {.02f, .02f, .02f}, {.1f, .1f, .1f},
    {.18f, .18f, .18f}, {.4f, .4f, .4f}, {.7f, .7f, .7f}, {.6f, .3f, .2f},    {.9f, .6f, .45f},
    {.2f, .09f, .05f},  {.5f, 0, 0},     {0, .2f, 0},     {0, 0, .3f},        {.05f, 0, .2f},
    {.8f, .5f, 0},      {0, .5f, .8f},   {.3f, .9f, .1f}, {3, -1, .5f},
};
enum { PATCH_COUNT = sizeof patches / sizeof *patches, PATCH_COLUMNS = 6 };

/* The card: patches of `size` pixels a side, six beside each other. */
static inline zt_image *test_card(int size) {
    zt_image *card;
    int width = PATCH_COLUMNS * size, height = PATCH_COUNT / PATCH_COLUMNS * size;
    assert_int_equal(zt_image_create(&card, width, height), ZT_OK);
    for (int i = 0; i < width * height; i++)
        memcpy(card->pixels + 4 * (size_t)i,
               patches[i / width / size * PATCH_COLUMNS + i % width / size], sizeof *patches);
    return card;
}

/* What a display gets for a linear value, of 0..1, by the definition of the view. */
static inline double display_value(double linear, zt_view view) {
    linear = fmin(1, fmax(0, linear));
    if (view == ZT_VIEW_RAW) return linear;
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

#endif
