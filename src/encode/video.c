/* A movie: H.264 in MP4. The one door to FFmpeg, a module.
 *
 * Same bits: x264 gives the same stream for the same number of threads, so that number is fixed
 * here and does not follow the machine's. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>

#include "base/diag.h"
#include "base/text.h"
#include "encode/aside.h"
#include "encode/video.h"
#include "image/develop.h"

static const char quality[] = "18" /* CRF */;
/* Four threads take a tenth more of the cores than one does. */
enum { THREAD_COUNT = 4, GOP_S = 2, GOP_FRAMES_MAX = 250, TIMESCALE_MIN = 10000 };

typedef struct movie {
    AVFormatContext *container;
    AVCodecContext *encoder;
    AVStream *stream; /* the container's */
    struct SwsContext *converter;
    AVFrame *rgb, *yuv; /* one picture developed, and converted */
    AVPacket *packet;
    int64_t frame_count;
    zt_view view;
    zt_aside aside;
    zt_listener listener;
} movie;

/* What libav last complained of in this thread. It would print it otherwise; there is one
 * callback for the whole process. */
static thread_local char complaint[256];

static void hear_libav(void *context, int level, const char *format, va_list arguments) {
    (void)context;
    if (level > AV_LOG_ERROR) return;
    vsnprintf(complaint, sizeof complaint, format, arguments);
    complaint[strcspn(complaint, "\r\n")] = '\0';
}

static once_flag listening_once = ONCE_FLAG_INIT;
static void listen_to_libav(void) { av_log_set_callback(hear_libav); }

static zt_status refuse(const movie *m, int error) {
    if (error == AVERROR(ENOMEM)) return ZT_EMEMORY;
    zt_tell(m->listener, ZT_ERROR, "cannot write %s: %s%s%s", m->aside.target,
            av_err2str(error), *complaint ? ": " : "", complaint);
    return ZT_EFILE;
}

/* Hands a failure of libav up as a status, after telling it. */
#define AV_TRY(m, call)                                                                        \
    do {                                                                                       \
        int av_try_error = (call);                                                             \
        if (av_try_error < 0) return refuse(m, av_try_error);                                  \
    } while (0)

static int even(int side) { return side < 2 ? 2 : side / 2 * 2; }

/* yuv420p has one colour for each 2x2 pixels. */
static zt_status check_size(const char *target, const zt_output_format *format,
                            zt_listener listener) {
    int width = even(format->width), height = even(format->height);
    if (width == format->width && height == format->height) return ZT_OK;
    zt_tell(listener, ZT_ERROR,
            "cannot write %s: a movie needs an even width and height, and %dx%d is not; "
            "%dx%d would be",
            target, format->width, format->height, width, height);
    return ZT_EARGUMENT;
}

/* What the numbers mean, for decoders: BT.709 primaries and matrix, in 16..235 (240), chroma
 * sited left. The transfer tag is BT.709's in both views, although the sRGB view's numbers are
 * sRGB's (tag 13): nearly all players show the numbers of a 709 film as they are, which on an
 * sRGB display is right, while 13 is so rare in films that some programs take it for unknown.
 * The few that take 709 at its word show the shadows a little lighter, as of all films made on
 * such a display. */
static void tag_frame(AVFrame *frame) {
    frame->color_primaries = AVCOL_PRI_BT709;
    frame->color_trc = AVCOL_TRC_BT709;
    frame->colorspace = AVCOL_SPC_BT709;
    frame->color_range = AVCOL_RANGE_MPEG;
    frame->chroma_location = AVCHROMA_LOC_LEFT;
}

static void tag_encoder(AVCodecContext *encoder, const AVFrame *frame) {
    encoder->color_primaries = frame->color_primaries;
    encoder->color_trc = frame->color_trc;
    encoder->colorspace = frame->colorspace;
    encoder->color_range = frame->color_range;
    encoder->chroma_sample_location = frame->chroma_location;
}

/* The encoder's presets, from the fastest on. */
static const char *const presets[] = {"ultrafast", "superfast", "veryfast", "faster",
                                      "fast",      "medium",    "slow",     "slower",
                                      "veryslow",  "placebo",   NULL};

static zt_status check_preset(const char *target, const char *preset, zt_listener listener) {
    char list[160] = "";
    size_t length = 0;
    for (const char *const *known = presets; *known; known++) {
        if (zt_text_equal(*known, preset)) return ZT_OK;
        length += (size_t)snprintf(list + length, sizeof list - length, " %s", *known);
    }
    zt_tell(listener, ZT_ERROR, "cannot write %s: there is no preset \"%s\"; there are%s",
            target, preset, list);
    return ZT_EARGUMENT;
}

static zt_status make_frame(movie *m, AVFrame **frame, const zt_output_format *format,
                            enum AVPixelFormat pixels) {
    *frame = av_frame_alloc();
    if (!*frame) return ZT_EMEMORY;
    (*frame)->width = format->width;
    (*frame)->height = format->height;
    (*frame)->format = pixels;
    AV_TRY(m, av_frame_get_buffer(*frame, 0));
    return ZT_OK;
}

/* From full-range R'G'B' to BT.709 limited range, rounded and with chroma from all pixels. */
static zt_status make_converter(movie *m) {
    m->converter = sws_alloc_context();
    if (!m->converter) return ZT_EMEMORY;
    const struct {
        const char *name;
        int64_t value;
    } options[] = {
        {"srcw", m->rgb->width},
        {"srch", m->rgb->height},
        {"src_format", m->rgb->format},
        {"src_range", 1},
        {"dstw", m->yuv->width},
        {"dsth", m->yuv->height},
        {"dst_format", m->yuv->format},
        {"dst_range", 0},
        {"dst_h_chr_pos", 0},   /* left in its pair of pixels, */
        {"dst_v_chr_pos", 128}, /* in the middle between its rows */
        {"sws_flags", SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP | SWS_BITEXACT},
    };
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        AV_TRY(m, av_opt_set_int(m->converter, options[i].name, options[i].value, 0));
    AV_TRY(m, sws_init_context(m->converter, NULL, NULL));
    const int *bt709 = sws_getCoefficients(SWS_CS_ITU709);
    AV_TRY(m, sws_setColorspaceDetails(m->converter, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16));
    return ZT_OK;
}

/* A key picture every two seconds, and no picture refers beyond it: films can be cut there. */
static int gop_frames(AVRational rate) {
    int64_t frames = (int64_t)GOP_S * rate.num / rate.den;
    return frames < 1 ? 1 : frames > GOP_FRAMES_MAX ? GOP_FRAMES_MAX : (int)frames;
}

static zt_status open_encoder(movie *m, AVRational rate, const zt_video_settings *settings) {
    const AVCodec *codec = avcodec_find_encoder_by_name("libx264");
    if (!codec) {
        zt_tell(m->listener, ZT_ERROR, "cannot write %s: this FFmpeg has no libx264",
                m->aside.target);
        return ZT_EUNSUPPORTED;
    }
    AVCodecContext *encoder = m->encoder = avcodec_alloc_context3(codec);
    if (!encoder) return ZT_EMEMORY;
    encoder->width = m->yuv->width;
    encoder->height = m->yuv->height;
    encoder->pix_fmt = m->yuv->format;
    encoder->sample_aspect_ratio = (AVRational){1, 1};
    encoder->framerate = rate;
    encoder->time_base = av_inv_q(rate);
    encoder->gop_size = gop_frames(rate);
    encoder->thread_count = THREAD_COUNT;
    encoder->flags = (int)(AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_GLOBAL_HEADER);
    tag_encoder(encoder, m->yuv);
    AV_TRY(m, av_opt_set(encoder->priv_data, "preset", settings->preset, 0));
    AV_TRY(m, av_opt_set(encoder->priv_data, "crf", quality, 0));
    AV_TRY(m, av_opt_set(encoder->priv_data, "x264-params", "force-cfr=1", 0));
    AV_TRY(m, avcodec_open2(encoder, codec, NULL));
    return ZT_OK;
}

/* Writes the head of the file. The movie counts in the same fractions of a second as its
 * pictures: with FFmpeg's milliseconds the film would end up to one too late. */
static zt_status open_container(movie *m, AVRational rate) {
    char *url = zt_text_print("file:%s", m->aside.path); /* never taken for a protocol */
    if (!url) return ZT_EMEMORY;
    int error = avformat_alloc_output_context2(&m->container, NULL, "mp4", url);
    if (error >= 0) error = avio_open(&m->container->pb, url, AVIO_FLAG_WRITE);
    free(url);
    AV_TRY(m, error);
    AVStream *stream = m->stream = avformat_new_stream(m->container, NULL);
    if (!stream) return ZT_EMEMORY;
    AV_TRY(m, avcodec_parameters_from_context(stream->codecpar, m->encoder));
    stream->time_base = m->encoder->time_base;
    stream->avg_frame_rate = stream->r_frame_rate = rate;
    int64_t timescale = rate.num;
    while (timescale < TIMESCALE_MIN) timescale *= 2;
    AVDictionary *options = NULL;
    error = av_dict_set(&options, "movflags", "+faststart", 0);
    if (error >= 0) error = av_dict_set_int(&options, "video_track_timescale", timescale, 0);
    if (error >= 0) error = av_dict_set_int(&options, "movie_timescale", timescale, 0);
    if (error >= 0) error = avformat_write_header(m->container, &options);
    av_dict_free(&options);
    AV_TRY(m, error);
    return ZT_OK;
}

static void movie_free(movie *m) {
    if (m->container) avio_closep(&m->container->pb);
    avformat_free_context(m->container);
    avcodec_free_context(&m->encoder);
    sws_freeContext(m->converter);
    av_frame_free(&m->rgb);
    av_frame_free(&m->yuv);
    av_packet_free(&m->packet);
    zt_aside_drop(&m->aside);
    free(m);
}

static zt_status open_all(movie *m, const char *target, const zt_output_format *format,
                          const zt_video_settings *settings) {
    AVRational rate;
    av_reduce(&rate.num, &rate.den, format->rate.num, format->rate.den, INT32_MAX);
    ZT_TRY(zt_aside_open(&m->aside, target, m->listener));
    ZT_TRY(make_frame(m, &m->rgb, format, AV_PIX_FMT_RGB24));
    ZT_TRY(make_frame(m, &m->yuv, format, AV_PIX_FMT_YUV420P));
    tag_frame(m->yuv);
    ZT_TRY(make_converter(m));
    ZT_TRY(open_encoder(m, rate, settings));
    ZT_TRY(open_container(m, rate));
    m->packet = av_packet_alloc();
    return m->packet ? ZT_OK : ZT_EMEMORY;
}

static zt_status open_movie(void **state, const char *target, const zt_output_format *format,
                            const zt_video_settings *settings, zt_listener listener) {
    ZT_TRY(check_size(target, format, listener));
    ZT_TRY(check_preset(target, settings->preset, listener));
    call_once(&listening_once, listen_to_libav);
    *complaint = '\0';
    movie *m = calloc(1, sizeof *m);
    if (!m) return ZT_EMEMORY;
    m->view = format->view;
    m->listener = listener;
    zt_status status = open_all(m, target, format, settings);
    if (status == ZT_OK)
        *state = m;
    else
        movie_free(m);
    return status;
}

/* Gives the encoder a picture, or NULL for the end, and writes what it has ready. */
static zt_status encode(movie *m, const AVFrame *frame) {
    AV_TRY(m, avcodec_send_frame(m->encoder, frame));
    for (;;) {
        int error = avcodec_receive_packet(m->encoder, m->packet);
        if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return ZT_OK;
        AV_TRY(m, error);
        m->packet->stream_index = m->stream->index;
        m->packet->duration = 1; /* without it the last picture has none */
        av_packet_rescale_ts(m->packet, m->encoder->time_base, m->stream->time_base);
        AV_TRY(m, av_interleaved_write_frame(m->container, m->packet));
    }
}

static zt_status write_movie(void *state, const zt_image *image, int64_t frame) {
    (void)frame; /* a movie has no gaps and begins at 0, whatever the numbers */
    movie *m = state;
    *complaint = '\0';
    zt_develop_rgb8(m->rgb->data[0], (size_t)m->rgb->linesize[0], image, m->view, 0,
                    image->height);
    AV_TRY(m, av_frame_make_writable(m->yuv)); /* a copy, should the encoder still hold it */
    const uint8_t *const *rgb = (const uint8_t *const *)m->rgb->data;
    AV_TRY(m, sws_scale(m->converter, rgb, m->rgb->linesize, 0, image->height, m->yuv->data,
                        m->yuv->linesize));
    m->yuv->pts = m->frame_count++;
    return encode(m, m->yuv);
}

static zt_status complete(movie *m) {
    ZT_TRY(encode(m, NULL));
    AV_TRY(m, av_write_trailer(m->container));
    AV_TRY(m, avio_closep(&m->container->pb));
    return zt_aside_keep(&m->aside, m->listener);
}

static zt_status close_movie(void *state, bool keep) {
    *complaint = '\0';
    zt_status status = keep ? complete(state) : ZT_OK;
    movie_free(state);
    return status;
}

ZT_MODULE_DOOR(zt_video_door, video) = {open_movie, write_movie, close_movie};
