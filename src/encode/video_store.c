#include "encode/video_store.h"

#include <stdlib.h>
#include <string.h>

#include <libavutil/pixdesc.h>

#include "base/pool.h"
#include "encode/video_encoder.h"

/* The stored frames, in order. */
typedef struct tape {
    const zt_video_ear *ear;
    const zt_video_part *part;
    const zt_video_piece *const *pieces;
    int64_t count, next; /* pieces, and the one that is read */
    zt_piece_reader reader;
    AVCodecContext *decoder;
    AVFrame *frame; /* that was read last */
} tape;

/* A film that is made of them: the next frame is made while one is encoded. */
typedef struct making {
    zt_video_store *store;
    tape tape;
    uint16_t *line;
    AVFrame *next; /* NULL: there is none */
    zt_status status;
    AVCodecContext *encoder;
    AVPacket *packet;
    zt_video_join join;
    int64_t sent; /* frames, to the encoder */
} making;

static zt_status open_decoder(tape *t, const AVCodecParameters *parameters) {
    const AVCodec *codec = avcodec_find_decoder(parameters->codec_id);
    if (!codec) return zt_libav_refuse(t->ear, AVERROR_DECODER_NOT_FOUND);
    t->decoder = avcodec_alloc_context3(codec);
    t->frame = av_frame_alloc();
    if (!t->decoder || !t->frame) return ZT_EMEMORY;
    AV_TRY(t->ear, avcodec_parameters_to_context(t->decoder, parameters));
    t->decoder->err_recognition = AV_EF_EXPLODE | AV_EF_CRCCHECK;
    t->decoder->thread_count = 0; /* one a core: what is decoded does not depend on it */
    AV_TRY(t->ear, avcodec_open2(t->decoder, codec, NULL));
    return ZT_OK;
}

static zt_status open_piece(tape *t) {
    AV_TRY(t->ear, zt_video_part_read(&t->reader, t->part, t->pieces[t->next]));
    return t->decoder ? ZT_OK : open_decoder(t, t->reader.stream->codecpar);
}

/* Gives the decoder the next packet, or the end. */
static zt_status feed(tape *t) {
    for (; t->next < t->count; t->next++) {
        if (!t->reader.container) ZT_TRY(open_piece(t));
        int error = zt_piece_next(&t->reader);
        if (error >= 0) error = avcodec_send_packet(t->decoder, t->reader.packet);
        if (error >= 0) return ZT_OK;
        if (error != AVERROR_EOF) return zt_libav_refuse(t->ear, error);
        zt_piece_end(&t->reader);
    }
    AV_TRY(t->ear, avcodec_send_packet(t->decoder, NULL));
    return ZT_OK;
}

/* Reads the next frame; false after the last. */
static zt_status read_frame(bool *there, tape *t) {
    for (;;) {
        int error = t->decoder ? avcodec_receive_frame(t->decoder, t->frame) : AVERROR(EAGAIN);
        *there = error >= 0;
        if (error == AVERROR_EOF) return ZT_OK;
        if (error != AVERROR(EAGAIN)) AV_TRY(t->ear, error);
        if (*there) return ZT_OK;
        ZT_TRY(feed(t));
    }
}

static void stop(tape *t) {
    zt_piece_end(&t->reader);
    avcodec_free_context(&t->decoder);
    av_frame_free(&t->frame);
}

static void rewind_tape(tape *t) {
    stop(t);
    t->next = 0;
}

zt_status zt_video_store_open(zt_video_store *s, const zt_video_choice *choice,
                              const AVFrame *like, const zt_video_ear *ear) {
    *s = (zt_video_store){.ear = ear, .choice = choice, .like = like};
    if (!choice->codec->palette) return ZT_OK;
    s->door = zt_module_door("video_palette", "a GIF", ear->listener);
    if (!s->door) return ZT_EUNSUPPORTED;
    AV_TRY(ear, s->door->open(&s->palette, like));
    return ZT_OK;
}

void zt_video_store_close(zt_video_store *s) {
    if (s->door) s->door->close(s->palette);
    *s = (zt_video_store){0};
}

/* Which colours are chosen may depend on the order in which they are counted. */
zt_status zt_video_store_see(zt_video_store *s, AVFrame *frame, int64_t position) {
    if (!s->door || position != s->counted) return ZT_OK;
    AV_TRY(s->ear, s->door->count(s->palette, frame));
    s->counted++;
    return ZT_OK;
}

/* Counts the colours of those that were not seen. */
static zt_status choose_palette(zt_video_store *s, tape *t, int64_t frame_count) {
    bool there = s->counted < frame_count;
    for (int64_t i = 0; there; i++) {
        ZT_TRY(read_frame(&there, t));
        if (there) ZT_TRY(zt_video_store_see(s, t->frame, i));
    }
    rewind_tape(t);
    AV_TRY(s->ear, s->door->choose(s->palette));
    return ZT_OK;
}

/* The same numbers in another layout. */
static void copy_numbers(AVFrame *out, const AVFrame *stored, uint16_t *line) {
    const AVPixFmtDescriptor *from = av_pix_fmt_desc_get(stored->format),
                             *to = av_pix_fmt_desc_get(out->format);
    memset(out->buf[0]->data, 0, out->buf[0]->size); /* writing adds bits */
    for (int y = 0; y < out->height; y++)
        for (int c = 0; c < to->nb_components; c++) {
            av_read_image_line(line, (const uint8_t **)stored->data, stored->linesize, from, 0,
                               y, c, out->width, 0);
            av_write_image_line(line, out->data, out->linesize, to, 0, y, c, out->width);
        }
}

/* A new frame like those of the film. */
static zt_status make_frame(AVFrame **out, const zt_video_store *s) {
    AVFrame *frame = *out = av_frame_alloc();
    if (!frame) return ZT_EMEMORY;
    frame->width = s->like->width;
    frame->height = s->like->height;
    frame->format = s->choice->pixels;
    AV_TRY(s->ear, av_frame_copy_props(frame, s->like));
    AV_TRY(s->ear, av_frame_get_buffer(frame, 0));
    return ZT_OK;
}

static zt_status make_next(making *m) {
    const zt_video_store *s = m->store;
    bool there;
    ZT_TRY(read_frame(&there, &m->tape));
    if (!there) return ZT_OK;
    AVFrame *stored = m->tape.frame;
    AV_TRY(s->ear, av_frame_copy_props(stored, s->like));
    if (s->door) {
        AV_TRY(s->ear, s->door->use(&m->next, s->palette, stored));
        return ZT_OK;
    }
    ZT_TRY(make_frame(&m->next, s));
    copy_numbers(m->next, stored, m->line);
    return ZT_OK;
}

static void run_errand(void *user) {
    making *m = user;
    zt_libav_listen();
    m->status = make_next(m);
}

static zt_status put_packet(void *user, AVPacket *packet) {
    making *m = user;
    return zt_video_join_put(&m->join, packet, m->store->ear);
}

static zt_status encode(making *m, AVFrame *frame) {
    if (frame) {
        frame->pts = m->sent++;
        frame->pict_type = AV_PICTURE_TYPE_NONE;
    }
    return zt_video_encode(m->encoder, frame, m->packet, put_packet, m, m->store->ear);
}

static zt_status encode_all(making *m) {
    zt_errand *errand = NULL;
    ZT_TRY(zt_errand_open(&errand, run_errand, m));
    zt_errand_send(errand);
    for (bool more = true; more;) {
        zt_errand_wait(errand);
        AVFrame *frame = m->next;
        m->next = NULL;
        more = frame && m->status == ZT_OK;
        if (more) zt_errand_send(errand);
        zt_status status = more ? encode(m, frame) : ZT_OK;
        av_frame_free(&frame);
        if (status == ZT_OK) continue;
        zt_errand_close(&errand);
        return status;
    }
    zt_errand_close(&errand);
    ZT_TRY(m->status);
    return encode(m, NULL);
}

/* The encoder gets frames of the film's pixels; and the file what it says of itself. */
static zt_status open_join(making *m, const char *path, const zt_output_format *format) {
    const zt_video_store *s = m->store;
    const AVOutputFormat *muxer = av_guess_format(s->choice->container->muxer, NULL, NULL);
    ZT_TRY(zt_video_encoder_open(&m->encoder, s->choice, muxer, s->like, m->tape.part->rate,
                                 s->ear));
    AVCodecParameters *of = avcodec_parameters_alloc();
    if (!of) return ZT_EMEMORY;
    int error = avcodec_parameters_from_context(of, m->encoder);
    zt_status status = error < 0
                           ? zt_libav_refuse(s->ear, error)
                           : zt_video_join_open(&m->join, path, s->choice, format, of, s->ear);
    avcodec_parameters_free(&of);
    return status;
}

static zt_status make_film(making *m, const char *path, const zt_output_format *format) {
    zt_video_store *s = m->store;
    const zt_video_piece *last = m->tape.pieces[m->tape.count - 1];
    m->packet = av_packet_alloc();
    m->line = malloc((size_t)s->like->width * sizeof *m->line);
    if (!m->packet || !m->line) return ZT_EMEMORY;
    if (s->door) ZT_TRY(choose_palette(s, &m->tape, last->first + last->count));
    ZT_TRY(open_join(m, path, format));
    ZT_TRY(encode_all(m));
    return zt_video_join_finish(&m->join, s->ear);
}

zt_status zt_video_store_join(int64_t *frame_count, zt_video_store *store, const char *path,
                              const zt_output_format *format, const zt_video_part *part,
                              const zt_video_piece *const *pieces, int64_t count) {
    making m = {.store = store,
                .tape = {.ear = store->ear, .part = part, .pieces = pieces, .count = count}};
    zt_status status = make_film(&m, path, format);
    *frame_count = m.sent;
    zt_video_join_close(&m.join);
    zt_video_encoder_close(&m.encoder, NULL);
    stop(&m.tape);
    av_frame_free(&m.next);
    av_packet_free(&m.packet);
    free(m.line);
    return status;
}
