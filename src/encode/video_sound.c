#include "encode/video_sound.h"

#include <stdlib.h>

#include <libavcodec/avcodec.h>
#include <libavutil/audio_fifo.h>
#include <libswresample/swresample.h>

#include "encode/video_libav.h"

enum { BITS_A_CHANNEL = 96000, CHANNELS_MAX = 2, SAMPLE_RATE = 48000, PIECE = 1024 };

struct zt_video_sound {
    const char *path;
    AVFormatContext *source, *into;
    const zt_container *kind; /* of `into` */
    AVStream *from, *to;
    AVPacket *packet;
    bool ended;   /* nothing more comes from the source */
    bool pending; /* copied: `packet` is read but not yet written */
    int64_t end;  /* of what may sound so far: in time_base of `from` or samples of `encoder` */
    /* Where it is not copied. */
    AVCodecContext *decoder, *encoder;
    SwrContext *converter;
    AVFrame *decoded, *converted;
    AVAudioFifo *samples; /* converted, not yet encoded */
    int64_t sample_count; /* encoded */
};

static zt_status refuse(const zt_video_sound *s, int error, const zt_video_ear *ear) {
    if (error == AVERROR(ENOMEM)) return ZT_EMEMORY;
    return zt_video_refuse(ear, ZT_EFILE, "its sound, %s: %s", s->path, av_err2str(error));
}

/* As AV_TRY; says that it is the sound. */
#define SOUND_TRY(s, ear, call)                                                                \
    do {                                                                                       \
        int sound_try_error = (call);                                                          \
        if (sound_try_error < 0) return refuse(s, sound_try_error, ear);                       \
    } while (0)

static zt_status open_source(zt_video_sound *s, const zt_video_ear *ear) {
    char *url = zt_video_url(s->path);
    if (!url) return ZT_EMEMORY;
    int error = avformat_open_input(&s->source, url, NULL, NULL);
    free(url);
    SOUND_TRY(s, ear, error);
    SOUND_TRY(s, ear, avformat_find_stream_info(s->source, NULL));
    int index = av_find_best_stream(s->source, AVMEDIA_TYPE_AUDIO, -1, -1, NULL, 0);
    SOUND_TRY(s, ear, index);
    s->from = s->source->streams[index];
    for (unsigned i = 0; i < s->source->nb_streams; i++)
        if ((int)i != index) s->source->streams[i]->discard = AVDISCARD_ALL;
    return ZT_OK;
}

static bool is_taken(enum AVCodecID codec, const zt_container *kind) {
    for (const enum AVCodecID *c = kind->takes_sound; *c != AV_CODEC_ID_NONE; c++)
        if (*c == codec) return true;
    return false;
}

static int legal_rate(const AVCodec *codec, int rate) {
    for (const int *r = codec->supported_samplerates; r && *r; r++)
        if (*r == rate) return rate;
    return codec->supported_samplerates ? SAMPLE_RATE : rate;
}

static zt_status open_coders(zt_video_sound *s, const char *name, const zt_video_ear *ear) {
    const AVCodec *from = avcodec_find_decoder(s->from->codecpar->codec_id);
    const AVCodec *to = avcodec_find_encoder_by_name(name);
    if (!from || !to)
        return zt_video_refuse(ear, ZT_EUNSUPPORTED, "this FFmpeg has no %s for its sound, %s",
                               from ? name : "decoder", s->path);
    s->decoder = avcodec_alloc_context3(from);
    s->encoder = avcodec_alloc_context3(to);
    if (!s->decoder || !s->encoder) return ZT_EMEMORY;
    SOUND_TRY(s, ear, avcodec_parameters_to_context(s->decoder, s->from->codecpar));
    SOUND_TRY(s, ear, avcodec_open2(s->decoder, from, NULL));
    int channels = s->decoder->ch_layout.nb_channels;
    av_channel_layout_default(&s->encoder->ch_layout,
                              channels < CHANNELS_MAX ? channels : CHANNELS_MAX);
    s->encoder->sample_fmt = to->sample_fmts[0];
    s->encoder->sample_rate = legal_rate(to, s->decoder->sample_rate);
    s->encoder->time_base = (AVRational){1, s->encoder->sample_rate};
    s->encoder->bit_rate = BITS_A_CHANNEL * s->encoder->ch_layout.nb_channels;
    s->encoder->flags = (int)AV_CODEC_FLAG_BITEXACT;
    if (s->into->oformat->flags & AVFMT_GLOBALHEADER)
        s->encoder->flags |= (int)AV_CODEC_FLAG_GLOBAL_HEADER;
    SOUND_TRY(s, ear, avcodec_open2(s->encoder, to, NULL));
    SOUND_TRY(s, ear, avcodec_parameters_from_context(s->to->codecpar, s->encoder));
    s->to->time_base = s->encoder->time_base;
    return ZT_OK;
}

static zt_status open_converter(zt_video_sound *s, const zt_video_ear *ear) {
    AVCodecContext *in = s->decoder, *out = s->encoder;
    SOUND_TRY(s, ear,
              swr_alloc_set_opts2(&s->converter, &out->ch_layout, out->sample_fmt,
                                  out->sample_rate, &in->ch_layout, in->sample_fmt,
                                  in->sample_rate, 0, NULL));
    SOUND_TRY(s, ear, swr_init(s->converter));
    s->samples = av_audio_fifo_alloc(out->sample_fmt, out->ch_layout.nb_channels, PIECE);
    s->decoded = av_frame_alloc();
    s->converted = av_frame_alloc();
    return s->samples && s->decoded && s->converted ? ZT_OK : ZT_EMEMORY;
}

static zt_status open_copy(zt_video_sound *s, const zt_video_ear *ear) {
    SOUND_TRY(s, ear, avcodec_parameters_copy(s->to->codecpar, s->from->codecpar));
    s->to->codecpar->codec_tag = 0; /* the source container's own */
    s->to->time_base = s->from->time_base;
    return ZT_OK;
}

static zt_status open_all(zt_video_sound *s, const zt_container *kind,
                          const zt_video_ear *ear) {
    ZT_TRY(open_source(s, ear));
    s->to = avformat_new_stream(s->into, NULL);
    s->packet = av_packet_alloc();
    if (!s->to || !s->packet) return ZT_EMEMORY;
    if (is_taken(s->from->codecpar->codec_id, kind)) return open_copy(s, ear);
    ZT_TRY(open_coders(s, kind->sound, ear));
    return open_converter(s, ear);
}

zt_status zt_video_sound_open(zt_video_sound **sound, const char *path, AVFormatContext *into,
                              const zt_container *kind, const zt_video_ear *ear) {
    *sound = NULL;
    zt_video_sound *s = calloc(1, sizeof *s);
    if (!s) return ZT_EMEMORY;
    s->path = path;
    s->into = into;
    s->kind = kind;
    zt_status status = open_all(s, kind, ear);
    if (status == ZT_OK)
        *sound = s;
    else
        zt_video_sound_close(&s);
    return status;
}

/* Reads the next packet of the sound; `ended` where there is none. */
static zt_status read_packet(zt_video_sound *s, const zt_video_ear *ear) {
    for (;;) {
        int error = av_read_frame(s->source, s->packet);
        s->ended = error == AVERROR_EOF;
        if (s->ended) return ZT_OK;
        SOUND_TRY(s, ear, error);
        if (s->packet->stream_index == s->from->index) return ZT_OK;
        av_packet_unref(s->packet);
    }
}

static int64_t since_start(const zt_video_sound *s, int64_t time) {
    return s->from->start_time == AV_NOPTS_VALUE ? time : time - s->from->start_time;
}

static zt_status write_packet(zt_video_sound *s, AVRational time_base,
                              const zt_video_ear *ear) {
    s->packet->stream_index = s->to->index;
    s->packet->pos = -1;
    av_packet_rescale_ts(s->packet, time_base, s->to->time_base);
    if (s->kind->ticks_a_second) { /* Matroska's times count what the encoder puts before */
        const AVCodecParameters *p = s->to->codecpar;
        int64_t padding =
            av_rescale_q(p->initial_padding, (AVRational){1, p->sample_rate}, s->to->time_base);
        s->packet->pts += padding;
        s->packet->dts += padding;
    }
    AV_TRY(ear, av_interleaved_write_frame(s->into, s->packet));
    return ZT_OK;
}

/* Cuts the pending packet where the film ends: its time, and of plain samples also its bytes.
 */
static void cut_packet(const zt_video_sound *s, int64_t duration) {
    int block = s->from->codecpar->block_align;
    int rate = s->from->codecpar->sample_rate;
    s->packet->duration = duration;
    if (av_get_exact_bits_per_sample(s->from->codecpar->codec_id) == 0 || block <= 0) return;
    int64_t bytes = block * av_rescale_q(duration, s->from->time_base, (AVRational){1, rate});
    if (bytes < s->packet->size) av_shrink_packet(s->packet, (int)bytes);
}

/* Copies the packets that lie wholly before the end; the last one, `cut`, as far as it does. */
static zt_status copy(zt_video_sound *s, bool cut, const zt_video_ear *ear) {
    for (;;) {
        if (!s->pending && !s->ended) {
            ZT_TRY(read_packet(s, ear));
            s->pending = !s->ended;
            if (s->pending && s->packet->pts != AV_NOPTS_VALUE) {
                s->packet->pts = since_start(s, s->packet->pts);
                s->packet->dts = since_start(s, s->packet->dts);
            }
        }
        if (!s->pending) return ZT_OK;
        int64_t rest = s->end - s->packet->pts;
        if (s->packet->duration > rest) {
            if (!cut || rest <= 0) return ZT_OK;
            cut_packet(s, rest);
        }
        s->pending = false;
        ZT_TRY(write_packet(s, s->from->time_base, ear));
    }
}

/* Takes what the decoder has ready into `samples`; `frame` NULL: what the converter still has.
 */
static zt_status convert(zt_video_sound *s, const AVFrame *frame, const zt_video_ear *ear) {
    AVFrame *out = s->converted;
    av_frame_unref(out);
    out->format = s->encoder->sample_fmt;
    out->sample_rate = s->encoder->sample_rate;
    SOUND_TRY(s, ear, av_channel_layout_copy(&out->ch_layout, &s->encoder->ch_layout));
    out->nb_samples = swr_get_out_samples(s->converter, frame ? frame->nb_samples : 0);
    if (out->nb_samples <= 0) return ZT_OK;
    SOUND_TRY(s, ear, av_frame_get_buffer(out, 0));
    int count = swr_convert(s->converter, out->data, out->nb_samples,
                            frame ? (const uint8_t **)frame->extended_data : NULL,
                            frame ? frame->nb_samples : 0);
    SOUND_TRY(s, ear, count);
    SOUND_TRY(s, ear, av_audio_fifo_write(s->samples, (void **)out->data, count));
    return ZT_OK;
}

/* Decodes until there are `count` samples, or no more. */
static zt_status decode(zt_video_sound *s, int count, const zt_video_ear *ear) {
    while (av_audio_fifo_size(s->samples) < count) {
        int error = avcodec_receive_frame(s->decoder, s->decoded);
        if (error >= 0) {
            ZT_TRY(convert(s, s->decoded, ear));
        } else if (error == AVERROR(EAGAIN)) {
            ZT_TRY(read_packet(s, ear));
            SOUND_TRY(s, ear, avcodec_send_packet(s->decoder, s->ended ? NULL : s->packet));
            av_packet_unref(s->packet);
        } else if (error == AVERROR_EOF) {
            return convert(s, NULL, ear);
        } else {
            return refuse(s, error, ear);
        }
    }
    return ZT_OK;
}

/* Encodes a frame, or NULL for the end, and writes what is ready. */
static zt_status encode(zt_video_sound *s, const AVFrame *frame, const zt_video_ear *ear) {
    SOUND_TRY(s, ear, avcodec_send_frame(s->encoder, frame));
    for (;;) {
        int error = avcodec_receive_packet(s->encoder, s->packet);
        if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return ZT_OK;
        SOUND_TRY(s, ear, error);
        ZT_TRY(write_packet(s, s->encoder->time_base, ear));
    }
}

/* Encodes pieces that lie before the end; the last one, `cut`, as far as it does. */
static zt_status transcode(zt_video_sound *s, bool cut, const zt_video_ear *ear) {
    int size = s->encoder->frame_size > 0 ? s->encoder->frame_size : PIECE;
    for (;;) {
        int64_t rest = s->end - s->sample_count;
        if (rest < size && !cut) return ZT_OK;
        int count = rest < size ? (int)rest : size;
        if (count > 0) ZT_TRY(decode(s, count, ear));
        if (av_audio_fifo_size(s->samples) < count) count = av_audio_fifo_size(s->samples);
        if (count <= 0 || (count < size && !cut)) return ZT_OK; /* the rest when it is cut */
        AVFrame *out = s->converted;
        av_frame_unref(out);
        out->format = s->encoder->sample_fmt;
        out->sample_rate = s->encoder->sample_rate;
        out->nb_samples = count;
        SOUND_TRY(s, ear, av_channel_layout_copy(&out->ch_layout, &s->encoder->ch_layout));
        SOUND_TRY(s, ear, av_frame_get_buffer(out, 0));
        SOUND_TRY(s, ear, av_audio_fifo_read(s->samples, (void **)out->data, count));
        out->pts = s->sample_count;
        s->sample_count += count;
        ZT_TRY(encode(s, out, ear));
    }
}

static zt_status write_sound(zt_video_sound *s, bool cut, const zt_video_ear *ear) {
    return s->encoder ? transcode(s, cut, ear) : copy(s, cut, ear);
}

zt_status zt_video_sound_write(zt_video_sound *s, int64_t count, AVRational duration,
                               const zt_video_ear *ear) {
    AVRational unit = s->encoder ? s->encoder->time_base : s->from->time_base;
    s->end = av_rescale_q_rnd(count, duration, unit, AV_ROUND_DOWN);
    return write_sound(s, false, ear);
}

zt_status zt_video_sound_finish(zt_video_sound *s, const zt_video_ear *ear) {
    ZT_TRY(write_sound(s, true, ear));
    return s->encoder ? encode(s, NULL, ear) : ZT_OK;
}

void zt_video_sound_close(zt_video_sound **sound) {
    zt_video_sound *s = *sound;
    if (!s) return;
    avformat_close_input(&s->source);
    avcodec_free_context(&s->decoder);
    avcodec_free_context(&s->encoder);
    swr_free(&s->converter);
    if (s->samples) av_audio_fifo_free(s->samples);
    av_frame_free(&s->decoded);
    av_frame_free(&s->converted);
    av_packet_free(&s->packet);
    free(s);
    *sound = NULL;
}
