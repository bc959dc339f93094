#include "encode/video_join.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/text.h"

enum { TIMESCALE_MIN = 10000 };

/* How the film was made, in words. */
enum { ENCODING_MAX = 512 };

static void describe(char text[ENCODING_MAX], const zt_video_choice *choice,
                     const zt_output_format *format) {
    char how[256];
    zt_video_describe(how, sizeof how, choice);
    snprintf(text, ENCODING_MAX, "Zoetrope: %s, %dx%d, %d/%d frames a second, view %s", how,
             format->width, format->height, format->rate.num, format->rate.den,
             format->color.wished ? "of OpenColorIO" : zt_view_name(format->view));
}

/* What the file says of itself, where its kind holds that: how it was encoded, and, in a tag
 * that the kind has, how it was rendered. */
static zt_status write_metadata(zt_video_join *w, const zt_video_choice *choice,
                                const zt_output_format *format, const zt_video_ear *ear) {
    char encoding[ENCODING_MAX];
    describe(encoding, choice, format);
    const struct {
        const char *name, *value;
    } tags[] = {{"title", zt_wish_value(choice->options, "title")},
                {"comment", zt_wish_value(choice->options, "comment")},
                {"description", encoding},
                {choice->container->settings, format->settings}};
    for (size_t i = 0; i < sizeof tags / sizeof *tags; i++)
        if (tags[i].name && tags[i].value)
            AV_TRY(ear, av_dict_set(&w->container->metadata, tags[i].name, tags[i].value, 0));
    return ZT_OK;
}

/* The movie counts in the same fractions of a second as its pictures: with FFmpeg's
 * milliseconds the film would end up to one too late. */
static int write_header(zt_video_join *w, const zt_container *kind) {
    int64_t timescale = w->rate.num;
    while (timescale < TIMESCALE_MIN) timescale *= 2;
    AVDictionary *options = NULL;
    int error = 0;
    if (kind->has_boxes) {
        error = av_dict_set(&options, "movflags", "+faststart+write_colr", 0);
        if (error >= 0)
            error = av_dict_set_int(&options, "video_track_timescale", timescale, 0);
        if (error >= 0) error = av_dict_set_int(&options, "movie_timescale", timescale, 0);
    } else if (kind->rate_max || zt_text_equal(kind->muxer, "apng")) {
        error = av_dict_set(&options, kind->rate_max ? "loop" : "plays", "0", 0); /* for ever */
    }
    if (error >= 0) error = avformat_write_header(w->container, &options);
    av_dict_free(&options);
    return error;
}

static zt_status open_file(zt_video_join *w, const char *path, const zt_container *kind,
                           const zt_video_ear *ear) {
    char *url = zt_video_url(path);
    if (!url) return ZT_EMEMORY;
    int error = avformat_alloc_output_context2(&w->container, NULL, kind->muxer, url);
    if (error >= 0) error = avio_open(&w->container->pb, url, AVIO_FLAG_WRITE);
    free(url);
    AV_TRY(ear, error);
    w->container->flags |= AVFMT_FLAG_BITEXACT; /* nothing random, no versions */
    /* What an encoder of sound puts before its beginning does not move the pictures. */
    w->container->avoid_negative_ts = AVFMT_AVOID_NEG_TS_DISABLED;
    return ZT_OK;
}

/* QuickTime's tag for the software, which has to do for the settings, too. The head leaves it
 * out; the end writes it. */
static zt_status write_software(zt_video_join *w, const zt_video_choice *choice,
                                const zt_output_format *format, const zt_video_ear *ear) {
    AVDictionary **tags = &w->container->metadata;
    const AVDictionaryEntry *encoding = av_dict_get(*tags, "description", NULL, 0);
    bool joint = format->settings && !choice->container->settings;
    char *text = zt_text_print("%s%s%s", encoding->value, joint ? "; " : "",
                               joint ? format->settings : "");
    if (!text) return ZT_EMEMORY;
    AV_TRY(ear, av_dict_set(tags, "encoder", text, AV_DICT_DONT_STRDUP_VAL));
    return ZT_OK;
}

/* Sound, texts and the head, which depend on the stream. */
static zt_status begin(zt_video_join *w, const zt_video_choice *choice,
                       const zt_output_format *format, const zt_video_ear *ear) {
    const char *sound = zt_wish_value(choice->options, "audio");
    if (sound && choice->container->sound)
        ZT_TRY(zt_video_sound_open(&w->sound, sound, w->container, choice->container, ear));
    ZT_TRY(write_metadata(w, choice, format, ear));
    AV_TRY(ear, write_header(w, choice->container));
    return write_software(w, choice, format, ear);
}

zt_status zt_video_join_open(zt_video_join *w, const char *path, const zt_video_choice *choice,
                             const zt_output_format *format, const AVCodecParameters *of,
                             const zt_video_ear *ear) {
    *w = (zt_video_join){0};
    av_reduce(&w->rate.num, &w->rate.den, format->rate.num, format->rate.den, INT32_MAX);
    ZT_TRY(open_file(w, path, choice->container, ear));
    AVStream *stream = w->stream = avformat_new_stream(w->container, NULL);
    if (!stream) return ZT_EMEMORY;
    AV_TRY(ear, avcodec_parameters_copy(stream->codecpar, of));
    stream->time_base = av_inv_q(w->rate);
    stream->avg_frame_rate = stream->r_frame_rate = w->rate;
    stream->sample_aspect_ratio = (AVRational){1, 1};
    return begin(w, choice, format, ear);
}

zt_status zt_video_join_put(zt_video_join *w, AVPacket *packet, const zt_video_ear *ear) {
    packet->stream_index = w->stream->index;
    packet->duration = 1; /* without it the last picture has none */
    packet->pos = -1;
    av_packet_rescale_ts(packet, av_inv_q(w->rate), w->stream->time_base);
    AV_TRY(ear, av_interleaved_write_frame(w->container, packet));
    w->frame_count++;
    if (!w->sound) return ZT_OK;
    return zt_video_sound_write(w->sound, w->frame_count, av_inv_q(w->rate), ear);
}

zt_status zt_video_join_finish(zt_video_join *w, const zt_video_ear *ear) {
    if (w->sound) ZT_TRY(zt_video_sound_finish(w->sound, ear));
    AV_TRY(ear, av_write_trailer(w->container));
    AV_TRY(ear, avio_closep(&w->container->pb));
    return ZT_OK;
}

void zt_video_join_close(zt_video_join *w) {
    zt_video_sound_close(&w->sound);
    if (w->container) avio_closep(&w->container->pb);
    avformat_free_context(w->container);
    *w = (zt_video_join){0};
}

/* The film opens with the first piece, which says what the encoder says as this file does. */
static zt_status open_like(zt_video_join *w, const char *path, const zt_video_choice *choice,
                           const zt_output_format *format, const AVCodecParameters *of,
                           const zt_piece_reader *reader, const zt_video_ear *ear) {
    AVCodecParameters *parameters = avcodec_parameters_alloc();
    if (!parameters) return ZT_EMEMORY;
    int error = avcodec_parameters_copy(parameters, of);
    if (error >= 0) error = zt_piece_describe_as(parameters, reader->stream->codecpar);
    zt_status status = error < 0 ? zt_libav_refuse(ear, error)
                                 : zt_video_join_open(w, path, choice, format, parameters, ear);
    avcodec_parameters_free(&parameters);
    return status;
}

/* A packet is decoded when it is its turn, and all that much too early that none is late. */
static zt_status add_packets(zt_video_join *w, zt_hash *checksum, zt_piece_reader *reader,
                             int64_t delay, const zt_video_ear *ear) {
    for (;;) {
        int error = zt_piece_next(reader);
        if (error == AVERROR_EOF) return ZT_OK;
        AV_TRY(ear, error);
        AVPacket *packet = reader->packet;
        packet->pts += reader->first;
        packet->dts = w->frame_count - delay;
        *checksum = zt_packet_checksum(*checksum, packet, packet->pts);
        ZT_TRY(zt_video_join_put(w, packet, ear));
    }
}

zt_status zt_video_join_pieces(zt_hash *checksum, const char *path,
                               const zt_video_choice *choice, const zt_output_format *format,
                               const AVCodecParameters *of, const zt_video_part *part,
                               const zt_video_piece *const *pieces, int64_t count,
                               const zt_video_ear *ear) {
    zt_video_join join = {0};
    zt_status status = ZT_OK;
    int64_t delay = 0;
    *checksum = (zt_hash){0};
    for (int64_t i = 0; i < count; i++)
        if (pieces[i]->delay > delay) delay = pieces[i]->delay;
    for (int64_t i = 0; i < count && status == ZT_OK; i++) {
        zt_piece_reader reader;
        int error = zt_video_part_read(&reader, part, pieces[i]);
        if (error < 0) status = zt_libav_refuse(ear, error);
        if (status == ZT_OK && i == 0)
            status = open_like(&join, path, choice, format, of, &reader, ear);
        if (status == ZT_OK) status = add_packets(&join, checksum, &reader, delay, ear);
        zt_piece_end(&reader);
    }
    if (status == ZT_OK) status = zt_video_join_finish(&join, ear);
    zt_video_join_close(&join);
    return status;
}
