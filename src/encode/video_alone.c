#include "encode/video_alone.h"

#include <stdlib.h>
#include <threads.h>

#include "encode/video_encoder.h"

/* One that is free, in a stack of them. */
typedef struct waiting {
    AVCodecContext *encoder;
    struct waiting *below;
} waiting;

struct zt_video_alone {
    const zt_video_choice *choice;
    const AVFrame *like;
    AVRational rate;
    mtx_t mutex;
    waiting *top;
};

static bool stands_alone(const zt_video_choice *choice, const AVCodecContext *encoder) {
    const AVCodecDescriptor *what = avcodec_descriptor_get(encoder->codec_id);
    bool intra = what->props & AV_CODEC_PROP_INTRA_ONLY;
    return choice->codec->alone && (intra || encoder->gop_size <= 1);
}

zt_status zt_video_alone_open(zt_video_alone **out, const zt_video_choice *choice,
                              const AVCodecContext *encoder, const AVFrame *like) {
    *out = NULL;
    if (!stands_alone(choice, encoder)) return ZT_OK;
    zt_video_alone *a = calloc(1, sizeof *a);
    if (!a) return ZT_EMEMORY;
    *a = (zt_video_alone){.choice = choice, .like = like, .rate = encoder->framerate};
    if (mtx_init(&a->mutex, mtx_plain) != thrd_success) {
        free(a);
        return ZT_EMEMORY;
    }
    *out = a;
    return ZT_OK;
}

/* One that is free, or a new one. */
static zt_status take(waiting **out, zt_video_alone *a, const zt_video_ear *ear) {
    mtx_lock(&a->mutex);
    waiting *w = *out = a->top;
    if (w) a->top = w->below;
    mtx_unlock(&a->mutex);
    if (w) return ZT_OK;
    w = *out = calloc(1, sizeof *w);
    if (!w) return ZT_EMEMORY;
    const AVOutputFormat *muxer = av_guess_format("matroska", NULL, NULL);
    return zt_video_encoder_open(&w->encoder, a->choice, muxer, a->like, a->rate, ear);
}

static void give_back(zt_video_alone *a, waiting *w) {
    mtx_lock(&a->mutex);
    w->below = a->top;
    a->top = w;
    mtx_unlock(&a->mutex);
}

static void drop(waiting *w) {
    if (w) zt_video_encoder_close(&w->encoder, NULL);
    free(w);
}

static zt_status take_packet(void *user, AVPacket *packet) {
    AVPacket **out = user;
    *out = av_packet_clone(packet);
    return *out ? ZT_OK : ZT_EMEMORY;
}

static zt_status encode(AVPacket **packet, waiting *w, const AVFrame *frame,
                        const zt_video_ear *ear) {
    AVPacket *between = av_packet_alloc();
    if (!between) return ZT_EMEMORY;
    zt_status status = zt_video_encode(w->encoder, frame, between, take_packet, packet, ear);
    av_packet_free(&between);
    if (status == ZT_OK && !*packet)
        status = zt_video_refuse(ear, ZT_EFILE, "the encoder holds a picture back");
    return status;
}

/* An encoder that failed is not asked again. */
zt_status zt_video_alone_encode(AVPacket **packet, zt_video_alone *a, const AVFrame *frame,
                                const zt_video_ear *ear) {
    *packet = NULL;
    waiting *w = NULL;
    zt_status status = take(&w, a, ear);
    if (status == ZT_OK) status = encode(packet, w, frame, ear);
    if (status == ZT_OK)
        give_back(a, w);
    else
        drop(w);
    if (status != ZT_OK) av_packet_free(packet);
    return status;
}

void zt_video_alone_close(zt_video_alone **alone) {
    zt_video_alone *a = *alone;
    if (!a) return;
    while (a->top) {
        waiting *w = a->top;
        a->top = w->below;
        drop(w);
    }
    mtx_destroy(&a->mutex);
    free(a);
    *alone = NULL;
}
