/* A movie: images are converted, encoded and, when the file is complete, held against what it
 * became; only then it gets its name. */
#include "encode/video.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include "base/text.h"
#include "encode/aside.h"
#include "encode/video_check.h"
#include "encode/video_palette.h"
#include "encode/video_pixels.h"
#include "encode/video_reader.h"
#include "encode/video_writer.h"

typedef struct movie {
    zt_video_ear ear;
    zt_video_choice choice;
    zt_output_option *options; /* a copy, which the choice points into */
    zt_output_format format;
    zt_video_pixels *pixels;
    mtx_t converting;
    zt_aside aside;
    zt_video_writer writer; /* of the film; of a GIF only when its palette is known */
    int64_t frame_count;
    zt_video_sample samples[ZT_VIDEO_SAMPLE_COUNT];
    /* Where the palette is made from the film: that, and the pictures until then. */
    const zt_video_palette_door *door;
    void *palette;
    zt_aside store_aside;
    zt_video_ear store_ear;
    zt_video_choice store_choice;
    zt_video_writer store;
} movie;

static void movie_free(movie *m) {
    zt_video_writer_close(&m->writer);
    zt_video_writer_close(&m->store);
    zt_video_pixels_close(&m->pixels);
    mtx_destroy(&m->converting);
    if (m->door) m->door->close(m->palette);
    for (int i = 0; i < ZT_VIDEO_SAMPLE_COUNT; i++) av_frame_free(&m->samples[i].frame);
    zt_aside_drop(&m->aside);
    zt_aside_drop(&m->store_aside);
    for (zt_output_option *o = m->options; o && o->name; o++) {
        free((char *)o->name);
        free((char *)o->value);
    }
    free(m->options);
    free((char *)m->ear.target);
    free((char *)m->store_ear.target);
    free(m);
}

/* Options are the caller's only while a movie is opened, and some are asked for later. */
static zt_status copy_options(movie *m, const zt_output_option *options) {
    size_t count = 0;
    while (options && options[count].name) count++;
    m->options = calloc(count + 1, sizeof *m->options);
    if (!m->options) return ZT_EMEMORY;
    for (size_t i = 0; i < count; i++) {
        m->options[i].value = strdup(options[i].value);
        m->options[i].name = strdup(options[i].name);
        if (!m->options[i].name || !m->options[i].value) return ZT_EMEMORY;
    }
    return ZT_OK;
}

/* A frame of the kind that will come, for its tags. */
static zt_status make_first(movie *m, AVFrame **first) {
    zt_image *image = NULL;
    ZT_TRY(zt_image_create(&image, m->format.width, m->format.height));
    zt_status status = zt_video_pixels_convert(first, m->pixels, image, &m->ear);
    zt_image_free(&image);
    return status;
}

/* Pictures wait in FFV1, which loses nothing, until the palette is known. */
static zt_status open_store(movie *m, const AVFrame *first) {
    static const zt_output_option options[][3] = {
        {{"codec", "ffv1"}, {"pixel-format", "bgr0"}, {NULL, NULL}},
        {{"codec", "ffv1"}, {"pixel-format", "bgra"}, {NULL, NULL}}};
    m->store_ear = m->ear;
    m->store_ear.target = zt_text_print("%s.frames.mkv", m->ear.target);
    if (!m->store_ear.target) return ZT_EMEMORY;
    m->door = zt_module_door("video_palette", "a GIF", m->ear.listener);
    if (!m->door) return ZT_EUNSUPPORTED;
    AV_TRY(&m->ear, m->door->open(&m->palette, first));
    ZT_TRY(zt_video_choose(&m->store_choice, &m->format,
                           options[first->format == AV_PIX_FMT_BGRA], &m->store_ear));
    ZT_TRY(zt_aside_open(&m->store_aside, m->store_ear.target, m->ear.listener));
    return zt_video_writer_open(&m->store, m->store_aside.path, &m->store_choice, &m->format,
                                first, &m->store_ear);
}

/* What will hold all frames, at a guess. */
static zt_status check_room(const movie *m) {
    double pixels = (double)m->format.width * m->format.height *
                    (double)(m->format.frame_count > 0 ? m->format.frame_count : 1);
    double bits = m->choice.codec->bits_a_pixel * pixels;
    if (m->choice.bitrate)
        bits = (double)m->choice.bitrate * (double)m->format.frame_count * m->format.rate.den /
               m->format.rate.num;
    if (m->choice.codec->palette) bits += 8 * pixels;
    return zt_aside_room(&m->aside, bits / 8, m->ear.listener);
}

static zt_status open_all(movie *m, const char *target, const zt_output_option *options) {
    m->ear.target = strdup(target);
    if (!m->ear.target) return ZT_EMEMORY;
    ZT_TRY(copy_options(m, options));
    ZT_TRY(zt_video_choose(&m->choice, &m->format, m->options, &m->ear));
    const zt_container *kind = m->choice.container;
    if (zt_wish_value(options, "audio") && !kind->sound)
        zt_tell(m->ear.listener, ZT_WARNING, "%s has no sound: %s files hold none", target,
                kind->ending);
    ZT_TRY(zt_aside_open(&m->aside, target, m->ear.listener));
    ZT_TRY(check_room(m));
    /* What a palette is made from is R'G'B'. */
    enum AVPixelFormat pixels =
        m->choice.pixels == AV_PIX_FMT_PAL8 ? AV_PIX_FMT_BGR0 : m->choice.pixels;
    ZT_TRY(zt_video_pixels_open(&m->pixels, &m->format, pixels, &m->ear));
    AVFrame *first = NULL;
    ZT_TRY(make_first(m, &first));
    zt_status status =
        zt_video_writer_open(&m->writer, m->aside.path, &m->choice, &m->format, first, &m->ear);
    if (status == ZT_OK && m->choice.codec->palette) status = open_store(m, first);
    av_frame_free(&first);
    return status;
}

static zt_status open_movie(void **state, const char *target, const zt_output_format *format,
                            const zt_output_option *options, zt_listener listener) {
    zt_libav_listen();
    movie *m = calloc(1, sizeof *m);
    if (!m) return ZT_EMEMORY;
    if (mtx_init(&m->converting, mtx_plain) != thrd_success) {
        free(m);
        return ZT_EMEMORY;
    }
    m->format = *format;
    m->ear.listener = listener;
    zt_status status = open_all(m, target, options);
    if (status == ZT_OK)
        *state = m;
    else
        movie_free(m);
    return status;
}

/* Keeps the first frame, the newest one, and, so that it need not be known how many come, the
 * newest whose number is a power of two. */
static zt_status keep_sample(movie *m, const AVFrame *frame, int64_t number) {
    const bool wanted[ZT_VIDEO_SAMPLE_COUNT] = {
        number == 0, number > 0 && (number & (number - 1)) == 0, number > 0};
    for (int i = 0; i < ZT_VIDEO_SAMPLE_COUNT; i++) {
        if (!wanted[i]) continue;
        av_frame_free(&m->samples[i].frame);
        m->samples[i].number = number;
        m->samples[i].frame = av_frame_clone(frame);
        if (!m->samples[i].frame) return ZT_EMEMORY;
    }
    return ZT_OK;
}

static zt_status put(movie *m, AVFrame *frame) {
    ZT_TRY(keep_sample(m, frame, m->frame_count++));
    if (!m->palette) return zt_video_writer_put(&m->writer, frame, &m->ear);
    AV_TRY(&m->ear, m->door->count(m->palette, frame));
    return zt_video_writer_put(&m->store, frame, &m->store_ear);
}

static bool movie_wants(void *state, int64_t position) {
    (void)state, (void)position;
    return true;
}

static zt_status make_frame(void **made, void *state, const zt_image *image, int64_t number) {
    (void)number; /* a movie has no gaps and begins at 0, whatever the numbers */
    movie *m = state;
    AVFrame *frame = NULL;
    zt_libav_listen();
    mtx_lock(&m->converting);
    zt_status status = zt_video_pixels_convert(&frame, m->pixels, image, &m->ear);
    mtx_unlock(&m->converting);
    *made = frame;
    return status;
}

static void drop_frame(void *state, void *made) {
    (void)state;
    AVFrame *frame = made;
    av_frame_free(&frame);
}

static zt_status write_frame(void *state, void *made, int64_t number) {
    (void)number;
    zt_libav_listen();
    zt_status status = put(state, made);
    drop_frame(state, made);
    return status;
}

static zt_status use_palette(movie *m, zt_video_reader *stored) {
    for (;;) {
        int error = zt_video_reader_next(stored);
        if (error == AVERROR_EOF) return ZT_OK;
        AV_TRY(&m->store_ear, error);
        AVFrame *frame = NULL;
        AV_TRY(&m->ear, m->door->use(&frame, m->palette, stored->frame));
        zt_status status = zt_video_writer_put(&m->writer, frame, &m->ear);
        av_frame_free(&frame);
        ZT_TRY(status);
    }
}

/* All pictures are there: now they get their colours. */
static zt_status encode_stored(movie *m) {
    ZT_TRY(zt_video_writer_finish(&m->store, &m->store_ear));
    AV_TRY(&m->ear, m->door->choose(m->palette));
    zt_video_reader stored;
    int error = zt_video_reader_open(&stored, m->store_aside.path, NULL);
    zt_status status =
        error < 0 ? zt_libav_refuse(&m->store_ear, error) : use_palette(m, &stored);
    zt_video_reader_close(&stored);
    return status;
}

static void tell_checked(const movie *m, double psnr) {
    char rate[32], quality[48] = "the same to the bit";
    const zt_rate *r = &m->format.rate;
    snprintf(rate, sizeof rate, r->den == 1 ? "%d" : "%d/%d", r->num, r->den);
    if (isfinite(psnr)) snprintf(quality, sizeof quality, "PSNR %.1f dB at least", psnr);
    zt_tell(m->ear.listener, ZT_NOTE, "%s: %" PRId64 " frame%s, %s, %s fps, checked: %s",
            m->ear.target, m->frame_count, m->frame_count == 1 ? "" : "s",
            m->choice.codec->title, rate, quality);
}

/* A film that fails the check does not get its name, but hours of work are not thrown away. */
static zt_status check_film(movie *m) {
    zt_video_expected expected = {.choice = &m->choice,
                                  .rate = m->format.rate,
                                  .frame_count = m->frame_count,
                                  .has_sound = m->writer.sound != NULL};
    for (int i = 0; i < ZT_VIDEO_SAMPLE_COUNT; i++) expected.samples[i] = m->samples[i];
    double psnr;
    zt_status status = zt_video_check(&psnr, m->aside.path, &expected, &m->ear);
    if (status == ZT_OK) tell_checked(m, psnr);
    if (status == ZT_EFILE) zt_aside_leave(&m->aside, m->ear.listener);
    return status;
}

static zt_status complete(movie *m) {
    if (m->palette) ZT_TRY(encode_stored(m));
    ZT_TRY(zt_video_writer_finish(&m->writer, &m->ear));
    ZT_TRY(check_film(m));
    return zt_aside_keep(&m->aside, m->ear.listener);
}

static zt_status close_movie(void *state, bool keep) {
    zt_libav_listen();
    zt_status status = keep ? complete(state) : ZT_OK;
    movie_free(state);
    return status;
}

ZT_MODULE_DOOR(zt_video_door, video) = {open_movie,  movie_wants, make_frame,
                                        write_frame, drop_frame,  close_movie};
