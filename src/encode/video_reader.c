#include "encode/video_reader.h"

#include <stdbool.h>
#include <stdlib.h>

#include "encode/video_libav.h"

static int open_file(zt_video_reader *r, const char *path) {
    char *url = zt_video_url(path);
    if (!url) return AVERROR(ENOMEM);
    int error = avformat_open_input(&r->container, url, NULL, NULL);
    free(url);
    return error;
}

/* Where their number is known. */
static bool has_few_frames(const AVStream *stream) {
    return stream->nb_frames > 0 && stream->nb_frames < 8;
}

static int open_decoder(zt_video_reader *r, const char *name) {
    const AVCodecParameters *parameters = r->stream->codecpar;
    const AVCodec *codec =
        name ? avcodec_find_decoder_by_name(name) : avcodec_find_decoder(parameters->codec_id);
    if (!codec) return AVERROR_DECODER_NOT_FOUND;
    r->decoder = avcodec_alloc_context3(codec);
    r->packet = av_packet_alloc();
    r->frame = av_frame_alloc();
    if (!r->decoder || !r->packet || !r->frame) return AVERROR(ENOMEM);
    int error = avcodec_parameters_to_context(r->decoder, parameters);
    if (error < 0) return error;
    r->decoder->err_recognition = AV_EF_EXPLODE | AV_EF_CRCCHECK;
    r->decoder->pkt_timebase = r->stream->time_base;
    /* One a core, but where they would take more than they give: what is decoded does not
     * depend on it. */
    r->decoder->thread_count = has_few_frames(r->stream) ? 1 : 0;
    return avcodec_open2(r->decoder, codec, NULL);
}

int zt_video_reader_open(zt_video_reader *r, const char *path, const char *decoder) {
    *r = (zt_video_reader){0};
    int error = open_file(r, path);
    if (error >= 0) error = avformat_find_stream_info(r->container, NULL);
    if (error < 0) return error;
    int index = av_find_best_stream(r->container, AVMEDIA_TYPE_VIDEO, -1, -1, NULL, 0);
    if (index < 0) return index;
    r->stream = r->container->streams[index];
    return open_decoder(r, decoder);
}

static bool is_wanted(const zt_video_reader *r) {
    return !r->wants || r->packet->pts == AV_NOPTS_VALUE || r->wants(r->user, r->packet->pts);
}

int zt_video_reader_next(zt_video_reader *r) {
    for (;;) {
        int error = avcodec_receive_frame(r->decoder, r->frame);
        if (error != AVERROR(EAGAIN)) return error;
        error = av_read_frame(r->container, r->packet);
        if (error < 0 && error != AVERROR_EOF) return error;
        bool ours = error < 0 || r->packet->stream_index == r->stream->index;
        r->decoder->skip_frame = is_wanted(r) ? AVDISCARD_DEFAULT : AVDISCARD_NONREF;
        if (ours) error = avcodec_send_packet(r->decoder, error < 0 ? NULL : r->packet);
        av_packet_unref(r->packet);
        if (ours && error < 0) return error;
    }
}

bool zt_video_reader_seek(zt_video_reader *r, int64_t pts) {
    int error = av_seek_frame(r->container, r->stream->index, pts, AVSEEK_FLAG_BACKWARD);
    if (error >= 0) avcodec_flush_buffers(r->decoder);
    return error >= 0;
}

void zt_video_reader_close(zt_video_reader *r) {
    avcodec_free_context(&r->decoder);
    avformat_close_input(&r->container);
    av_packet_free(&r->packet);
    av_frame_free(&r->frame);
    *r = (zt_video_reader){0};
}
