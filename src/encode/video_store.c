#include "encode/video_store.h"

#include <stdlib.h>
#include <string.h>

#include <libavutil/pixdesc.h>

#include "encode/video_encoder.h"
#include "encode/video_palette.h"

typedef struct store {
    const zt_video_ear *ear;
    const zt_video_part *part;
    const zt_video_piece *const *pieces;
    int64_t piece_count;
    const AVFrame *like;
    AVCodecContext *decoder, *encoder;
    AVPacket *packet;
    AVFrame *stored, *frame; /* as it was decoded; as it is encoded, where that is another */
    uint16_t *line;
    zt_video_join join;
    int64_t sent;                      /* frames, to the encoder */
    const zt_video_palette_door *door; /* NULL: no palette */
    void *palette;
    zt_status (*use)(struct store *s);
} store;

static zt_status put_packet(void *user, AVPacket *packet) {
    store *s = user;
    return zt_video_join_put(&s->join, packet, s->ear);
}

static zt_status encode(store *s, AVFrame *frame) {
    if (frame) {
        frame->pts = s->sent++;
        frame->pict_type = AV_PICTURE_TYPE_NONE;
    }
    return zt_video_encode(s->encoder, frame, s->packet, put_packet, s, s->ear);
}

static zt_status count_colours(store *s) {
    AV_TRY(s->ear, s->door->count(s->palette, s->stored));
    return ZT_OK;
}

static zt_status use_palette(store *s) {
    AVFrame *frame = NULL;
    AV_TRY(s->ear, s->door->use(&frame, s->palette, s->stored));
    zt_status status = encode(s, frame);
    av_frame_free(&frame);
    return status;
}

/* The same numbers in another layout. */
static zt_status use_as_it_is(store *s) {
    AVFrame *f = s->frame;
    const AVPixFmtDescriptor *from = av_pix_fmt_desc_get(s->stored->format),
                             *to = av_pix_fmt_desc_get(f->format);
    AV_TRY(s->ear, av_frame_make_writable(f));
    memset(f->buf[0]->data, 0, f->buf[0]->size); /* writing adds bits */
    for (int y = 0; y < f->height; y++)
        for (int c = 0; c < to->nb_components; c++) {
            av_read_image_line(s->line, (const uint8_t **)s->stored->data, s->stored->linesize,
                               from, 0, y, c, f->width, 0);
            av_write_image_line(s->line, f->data, f->linesize, to, 0, y, c, f->width);
        }
    return encode(s, f);
}

/* Takes what the decoder has ready. */
static zt_status use_ready(store *s) {
    for (;;) {
        int error = avcodec_receive_frame(s->decoder, s->stored);
        if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return ZT_OK;
        AV_TRY(s->ear, error);
        AV_TRY(s->ear, av_frame_copy_props(s->stored, s->like));
        ZT_TRY(s->use(s));
    }
}

static zt_status decode_piece(store *s, zt_piece_reader *reader) {
    for (;;) {
        int error = zt_piece_next(reader);
        if (error == AVERROR_EOF) return ZT_OK;
        AV_TRY(s->ear, error);
        AV_TRY(s->ear, avcodec_send_packet(s->decoder, reader->packet));
        ZT_TRY(use_ready(s));
    }
}

static zt_status open_decoder(store *s, const AVCodecParameters *parameters) {
    const AVCodec *codec = avcodec_find_decoder(parameters->codec_id);
    if (!codec) return zt_libav_refuse(s->ear, AVERROR_DECODER_NOT_FOUND);
    s->decoder = avcodec_alloc_context3(codec);
    if (!s->decoder) return ZT_EMEMORY;
    AV_TRY(s->ear, avcodec_parameters_to_context(s->decoder, parameters));
    s->decoder->err_recognition = AV_EF_EXPLODE | AV_EF_CRCCHECK;
    s->decoder->thread_count = 0; /* one a core: what is decoded does not depend on it */
    AV_TRY(s->ear, avcodec_open2(s->decoder, codec, NULL));
    return ZT_OK;
}

/* Each frame of all pieces, in order. */
static zt_status use_all(store *s, zt_status (*use)(store *s)) {
    zt_status status = ZT_OK;
    s->use = use;
    for (int64_t i = 0; i < s->piece_count && status == ZT_OK; i++) {
        zt_piece_reader reader;
        int error = zt_video_part_read(&reader, s->part, s->pieces[i]);
        if (error < 0) status = zt_libav_refuse(s->ear, error);
        if (status == ZT_OK && !s->decoder) status = open_decoder(s, reader.stream->codecpar);
        if (status == ZT_OK) status = decode_piece(s, &reader);
        zt_piece_end(&reader);
    }
    ZT_TRY(status);
    AV_TRY(s->ear, avcodec_send_packet(s->decoder, NULL));
    ZT_TRY(use_ready(s));
    avcodec_free_context(&s->decoder);
    return ZT_OK;
}

static zt_status choose_palette(store *s) {
    s->door = zt_module_door("video_palette", "a GIF", s->ear->listener);
    if (!s->door) return ZT_EUNSUPPORTED;
    AV_TRY(s->ear, s->door->open(&s->palette, s->like));
    ZT_TRY(use_all(s, count_colours));
    AV_TRY(s->ear, s->door->choose(s->palette));
    return ZT_OK;
}

static zt_status make_frame(store *s, const zt_video_choice *choice) {
    s->packet = av_packet_alloc();
    s->stored = av_frame_alloc();
    s->frame = av_frame_alloc();
    s->line = malloc((size_t)s->like->width * sizeof *s->line);
    if (!s->packet || !s->stored || !s->frame || !s->line) return ZT_EMEMORY;
    AV_TRY(s->ear, av_frame_copy_props(s->frame, s->like));
    s->frame->width = s->like->width;
    s->frame->height = s->like->height;
    s->frame->format = choice->pixels;
    AV_TRY(s->ear, av_frame_get_buffer(s->frame, 0));
    return ZT_OK;
}

static zt_status open_join(store *s, const char *path, const zt_video_choice *choice,
                           const zt_output_format *format) {
    const AVOutputFormat *muxer = av_guess_format(choice->container->muxer, NULL, NULL);
    ZT_TRY(zt_video_encoder_open(&s->encoder, choice, muxer, s->frame, s->part->rate, s->ear));
    AVCodecParameters *of = avcodec_parameters_alloc();
    if (!of) return ZT_EMEMORY;
    int error = avcodec_parameters_from_context(of, s->encoder);
    zt_status status = error < 0
                           ? zt_libav_refuse(s->ear, error)
                           : zt_video_join_open(&s->join, path, choice, format, of, s->ear);
    avcodec_parameters_free(&of);
    return status;
}

static zt_status join_all(store *s, const char *path, const zt_video_choice *choice,
                          const zt_output_format *format) {
    ZT_TRY(make_frame(s, choice));
    if (choice->codec->palette) ZT_TRY(choose_palette(s));
    ZT_TRY(open_join(s, path, choice, format));
    ZT_TRY(use_all(s, s->door ? use_palette : use_as_it_is));
    ZT_TRY(encode(s, NULL));
    return zt_video_join_finish(&s->join, s->ear);
}

zt_status zt_video_store_join(int64_t *frame_count, const char *path,
                              const zt_video_choice *choice, const zt_output_format *format,
                              const zt_video_part *part, const zt_video_piece *const *pieces,
                              int64_t count, const AVFrame *like, const zt_video_ear *ear) {
    store s = {.ear = ear, .part = part, .pieces = pieces, .piece_count = count, .like = like};
    zt_status status = join_all(&s, path, choice, format);
    *frame_count = s.sent;
    zt_video_join_close(&s.join);
    avcodec_free_context(&s.decoder);
    zt_video_encoder_close(&s.encoder, NULL);
    av_packet_free(&s.packet);
    av_frame_free(&s.stored);
    av_frame_free(&s.frame);
    free(s.line);
    if (s.door) s.door->close(s.palette);
    return status;
}
