#include "encode/video_writer.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/text.h"

enum { GOP_S = 2, GOP_FRAMES_MAX = 250, TIMESCALE_MIN = 10000 };

/* A key picture every two seconds, and no picture refers beyond it: films can be cut there. */
static int gop_frames(AVRational rate) {
    int64_t frames = (int64_t)GOP_S * rate.num / rate.den;
    return frames < 1 ? 1 : frames > GOP_FRAMES_MAX ? GOP_FRAMES_MAX : (int)frames;
}

static zt_status open_encoder(zt_video_writer *w, const zt_video_choice *choice,
                              const AVFrame *first, const zt_video_ear *ear) {
    AVCodecContext *encoder = w->encoder = avcodec_alloc_context3(choice->encoder);
    if (!encoder) return ZT_EMEMORY;
    encoder->width = first->width;
    encoder->height = first->height;
    encoder->pix_fmt = choice->codec->palette ? AV_PIX_FMT_PAL8 : choice->pixels;
    encoder->sample_aspect_ratio = (AVRational){1, 1};
    encoder->framerate = w->rate;
    encoder->time_base = av_inv_q(w->rate);
    encoder->gop_size = gop_frames(w->rate);
    encoder->flags = (int)(AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT);
    if (w->container->oformat->flags & AVFMT_GLOBALHEADER)
        encoder->flags |= (int)AV_CODEC_FLAG_GLOBAL_HEADER;
    encoder->color_primaries = first->color_primaries;
    encoder->color_trc = first->color_trc;
    encoder->colorspace = first->colorspace;
    encoder->color_range = first->color_range;
    encoder->chroma_sample_location = first->chroma_location;
    ZT_TRY(zt_video_configure(encoder, choice, ear));
    AV_TRY(ear, avcodec_open2(encoder, choice->encoder, NULL));
    return ZT_OK;
}

/* How the film was made, in words. */
enum { SETTINGS_MAX = 512 };

static void describe(char text[SETTINGS_MAX], const zt_video_choice *choice,
                     const zt_output_format *format) {
    char how[256];
    zt_video_describe(how, sizeof how, choice);
    snprintf(text, SETTINGS_MAX, "Zoetrope: %s, %dx%d, %d/%d frames a second, view %s", how,
             format->width, format->height, format->rate.num, format->rate.den,
             zt_view_name(format->view));
}

/* What the file says of itself, where its kind holds that. */
static zt_status write_metadata(zt_video_writer *w, const zt_video_choice *choice,
                                const zt_output_format *format, const zt_video_ear *ear) {
    char settings[SETTINGS_MAX];
    describe(settings, choice, format);
    const struct {
        const char *name, *value;
    } tags[] = {{"title", zt_wish_value(choice->options, "title")},
                {"comment", zt_wish_value(choice->options, "comment")},
                {"description", settings}};
    for (size_t i = 0; i < sizeof tags / sizeof *tags; i++)
        if (tags[i].value)
            AV_TRY(ear, av_dict_set(&w->container->metadata, tags[i].name, tags[i].value, 0));
    return ZT_OK;
}

/* The movie counts in the same fractions of a second as its pictures: with FFmpeg's
 * milliseconds the film would end up to one too late. */
static int write_header(zt_video_writer *w, const zt_container *kind) {
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

static zt_status open_file(zt_video_writer *w, const char *path, const zt_container *kind,
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

zt_status zt_video_writer_open(zt_video_writer *w, const char *path,
                               const zt_video_choice *choice, const zt_output_format *format,
                               const AVFrame *first, const zt_video_ear *ear) {
    *w = (zt_video_writer){0};
    av_reduce(&w->rate.num, &w->rate.den, format->rate.num, format->rate.den, INT32_MAX);
    ZT_TRY(open_file(w, path, choice->container, ear));
    ZT_TRY(open_encoder(w, choice, first, ear));
    AVStream *stream = w->stream = avformat_new_stream(w->container, NULL);
    w->packet = av_packet_alloc();
    if (!stream || !w->packet) return ZT_EMEMORY;
    AV_TRY(ear, avcodec_parameters_from_context(stream->codecpar, w->encoder));
    stream->codecpar->codec_tag = w->encoder->codec_tag;
    stream->time_base = w->encoder->time_base;
    stream->avg_frame_rate = stream->r_frame_rate = w->rate;
    stream->sample_aspect_ratio = w->encoder->sample_aspect_ratio;
    const char *sound = zt_wish_value(choice->options, "audio");
    if (sound && choice->container->sound)
        ZT_TRY(zt_video_sound_open(&w->sound, sound, w->container, choice->container, ear));
    ZT_TRY(write_metadata(w, choice, format, ear));
    AV_TRY(ear, write_header(w, choice->container));
    /* QuickTime's tag for the software. The head leaves it out; the end writes it. */
    AVDictionary **tags = &w->container->metadata;
    const AVDictionaryEntry *settings = av_dict_get(*tags, "description", NULL, 0);
    if (settings) AV_TRY(ear, av_dict_set(tags, "encoder", settings->value, 0));
    return ZT_OK;
}

/* Gives the encoder a picture, or NULL for the end, and writes what it has ready. */
static zt_status encode(zt_video_writer *w, const AVFrame *frame, const zt_video_ear *ear) {
    AV_TRY(ear, avcodec_send_frame(w->encoder, frame));
    for (;;) {
        int error = avcodec_receive_packet(w->encoder, w->packet);
        if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return ZT_OK;
        AV_TRY(ear, error);
        w->packet->stream_index = w->stream->index;
        w->packet->duration = 1; /* without it the last picture has none */
        av_packet_rescale_ts(w->packet, w->encoder->time_base, w->stream->time_base);
        AV_TRY(ear, av_interleaved_write_frame(w->container, w->packet));
    }
}

zt_status zt_video_writer_put(zt_video_writer *w, AVFrame *frame, const zt_video_ear *ear) {
    frame->pts = w->frame_count++;
    frame->pict_type = AV_PICTURE_TYPE_NONE;
    ZT_TRY(encode(w, frame, ear));
    if (!w->sound) return ZT_OK;
    return zt_video_sound_write(w->sound, w->frame_count, av_inv_q(w->rate), ear);
}

zt_status zt_video_writer_finish(zt_video_writer *w, const zt_video_ear *ear) {
    ZT_TRY(encode(w, NULL, ear));
    if (w->sound) ZT_TRY(zt_video_sound_finish(w->sound, ear));
    AV_TRY(ear, av_write_trailer(w->container));
    AV_TRY(ear, avio_closep(&w->container->pb));
    return ZT_OK;
}

void zt_video_writer_close(zt_video_writer *w) {
    zt_video_sound_close(&w->sound);
    if (w->container) avio_closep(&w->container->pb);
    avformat_free_context(w->container);
    avcodec_free_context(&w->encoder);
    av_packet_free(&w->packet);
    *w = (zt_video_writer){0};
}
