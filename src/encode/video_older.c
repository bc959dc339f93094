#include "encode/video_older.h"

#include <stdlib.h>
#include <string.h>

typedef struct older {
    zt_video_part *part;
    const zt_video_wished *wished;
    int64_t wished_count, piece_frames;
    AVFormatContext *container;
    AVStream *stream;
    AVPacket *packet;
    AVCodecParameters *parameters; /* of the packets in the file */
    int64_t index;                 /* of the piece under way; -1: none */
    int64_t count;                 /* of its packets so far */
} older;

static int open_file(older *o, const char *path) {
    char *url = zt_video_url(path);
    if (!url) return AVERROR(ENOMEM);
    o->container = avformat_alloc_context();
    if (o->container) o->container->flags |= AVFMT_FLAG_NOPARSE;
    int error =
        o->container ? avformat_open_input(&o->container, url, NULL, NULL) : AVERROR(ENOMEM);
    free(url);
    if (error < 0) return error;
    int index = av_find_best_stream(o->container, AVMEDIA_TYPE_VIDEO, -1, -1, NULL, 0);
    if (index < 0) return index;
    o->stream = o->container->streams[index];
    o->packet = av_packet_alloc();
    return o->packet ? 0 : AVERROR(ENOMEM);
}

/* The encoder's, but as this kind of file says what the encoder says of itself. */
static int take_parameters(older *o, const AVCodecParameters *of) {
    const AVCodecParameters *found = o->stream->codecpar;
    if (found->codec_id != of->codec_id || found->width != of->width ||
        found->height != of->height)
        return AVERROR_INVALIDDATA;
    o->parameters = avcodec_parameters_alloc();
    if (!o->parameters) return AVERROR(ENOMEM);
    int error = avcodec_parameters_copy(o->parameters, of);
    return error < 0 ? error : zt_piece_describe_as(o->parameters, found);
}

/* The last piece is kept where it is the one that was wished for. */
static zt_status finish(older *o) {
    if (o->index < 0) return ZT_OK;
    const zt_video_wished *wish = &o->wished[o->index];
    o->index = -1;
    if (o->count != wish->count) {
        zt_video_part_abandon(o->part);
        return ZT_OK;
    }
    ZT_TRY(zt_video_part_finish(o->part, o->count, wish->key, wish->render_s));
    zt_hash found = o->part->pieces[o->part->count - 1].checksum;
    if (!zt_hash_equal(found, wish->checksum)) zt_video_part_take_back(o->part);
    return ZT_OK;
}

static bool is_wished(const older *o, int64_t index) {
    return index >= 0 && index < o->wished_count && zt_hash_is_known(o->wished[index].checksum);
}

static zt_status take_packet(older *o) {
    AVRational frame = av_inv_q(o->part->rate);
    if (o->packet->pts == AV_NOPTS_VALUE) o->packet->pts = o->packet->dts;
    if (o->packet->pts == AV_NOPTS_VALUE) return ZT_OK;
    int64_t number = av_rescale_q(o->packet->pts, o->stream->time_base, frame);
    int64_t index = number < 0 ? -1 : number / o->piece_frames;
    if (index != o->index) {
        ZT_TRY(finish(o));
        if (!is_wished(o, index)) return ZT_OK;
        ZT_TRY(zt_video_part_begin(o->part, o->parameters, index * o->piece_frames));
        o->index = index;
        o->count = 0;
    }
    if (o->count++ >= o->wished[index].count) return ZT_OK;
    o->packet->pts = number - index * o->piece_frames;
    return zt_video_part_put(o->part, o->packet);
}

static zt_status take_all(older *o) {
    zt_status status = ZT_OK;
    while (status == ZT_OK && av_read_frame(o->container, o->packet) >= 0) {
        if (o->packet->stream_index == o->stream->index) status = take_packet(o);
        av_packet_unref(o->packet);
    }
    return status == ZT_OK ? finish(o) : status;
}

void zt_video_take_older(zt_video_part *part, const char *path, const zt_video_wished *wished,
                         int64_t wished_count, int64_t piece_frames,
                         const AVCodecParameters *parameters) {
    const zt_video_ear deaf = {path, {0}}, *ear = part->ear;
    older o = {.part = part,
               .wished = wished,
               .wished_count = wished_count,
               .piece_frames = piece_frames,
               .index = -1};
    part->ear = &deaf;
    if (open_file(&o, path) >= 0 && take_parameters(&o, parameters) >= 0) (void)take_all(&o);
    zt_video_part_abandon(part);
    part->ear = ear;
    avcodec_parameters_free(&o.parameters);
    av_packet_free(&o.packet);
    avformat_close_input(&o.container);
}
