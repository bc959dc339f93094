#include "encode/video_encoder.h"

enum { GOP_S = 2, GOP_FRAMES_MAX = 250 };

int zt_video_gop_frames(AVRational rate) {
    int64_t frames = (int64_t)GOP_S * rate.num / rate.den;
    return frames < 1 ? 1 : frames > GOP_FRAMES_MAX ? GOP_FRAMES_MAX : (int)frames;
}

zt_status zt_video_encoder_open(AVCodecContext **out, const zt_video_choice *choice,
                                const AVOutputFormat *muxer, const AVFrame *first,
                                AVRational rate, const zt_video_ear *ear) {
    AVCodecContext *encoder = *out = avcodec_alloc_context3(choice->encoder);
    if (!encoder) return ZT_EMEMORY;
    encoder->width = first->width;
    encoder->height = first->height;
    encoder->pix_fmt = choice->codec->palette ? AV_PIX_FMT_PAL8 : choice->pixels;
    encoder->sample_aspect_ratio = (AVRational){1, 1};
    encoder->framerate = rate;
    encoder->time_base = av_inv_q(rate);
    encoder->gop_size = zt_video_gop_frames(rate);
    /* No picture refers beyond its group: films can be cut there. */
    encoder->flags = (int)(AV_CODEC_FLAG_CLOSED_GOP | AV_CODEC_FLAG_BITEXACT);
    if (muxer->flags & AVFMT_GLOBALHEADER) encoder->flags |= (int)AV_CODEC_FLAG_GLOBAL_HEADER;
    encoder->color_primaries = first->color_primaries;
    encoder->color_trc = first->color_trc;
    encoder->colorspace = first->colorspace;
    encoder->color_range = first->color_range;
    encoder->chroma_sample_location = first->chroma_location;
    ZT_TRY(zt_video_configure(encoder, choice, ear));
    AV_TRY(ear, avcodec_open2(encoder, choice->encoder, NULL));
    return ZT_OK;
}

/* SVT-AV1 waits for ever where it is closed before it has got a frame and its end. */
void zt_video_encoder_close(AVCodecContext **encoder, AVFrame *unused) {
    AVPacket *packet = av_packet_alloc();
    if (*encoder && packet && avcodec_is_open(*encoder)) {
        if (unused) {
            unused->pts = 0;
            (void)avcodec_send_frame(*encoder, unused);
        }
        if (avcodec_send_frame(*encoder, NULL) >= 0)
            while (avcodec_receive_packet(*encoder, packet) >= 0) av_packet_unref(packet);
    }
    av_packet_free(&packet);
    avcodec_free_context(encoder);
}

zt_status zt_video_encode(AVCodecContext *encoder, const AVFrame *frame, AVPacket *packet,
                          zt_video_take take, void *user, const zt_video_ear *ear) {
    AV_TRY(ear, avcodec_send_frame(encoder, frame));
    for (;;) {
        int error = avcodec_receive_packet(encoder, packet);
        if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return ZT_OK;
        AV_TRY(ear, error);
        packet->duration = 1; /* without it the last picture has none */
        zt_status status = take(user, packet);
        av_packet_unref(packet);
        ZT_TRY(status);
    }
}
