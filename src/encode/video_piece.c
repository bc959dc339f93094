#include "encode/video_piece.h"

#include <errno.h>
#include <stdbool.h>
#include <string.h>
#include <unistd.h>

#include <libavcodec/codec_desc.h>

#include "base/hash.h"

enum { BUFFER = 1 << 16, REORDER_MAX = 32, FRAMES_A_SECOND_MAX = 500 };

/* Matroska counts milliseconds. Of frames that follow each other faster, each has two: the
 * growing film is slow then, and not confused. */
static AVRational frame_time(AVRational rate) {
    AVRational most = {FRAMES_A_SECOND_MAX, 1};
    return av_inv_q(av_cmp_q(rate, most) > 0 ? most : rate);
}

static int write_bytes(void *user, uint8_t *bytes, int size) {
    zt_piece_muxer *p = user;
    for (int done = 0; done < size;) {
        ssize_t now = pwrite(p->file, bytes + done, (size_t)(size - done), p->at);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) return AVERROR(now < 0 ? errno : EIO);
        done += (int)now;
        p->at += now;
    }
    return size;
}

static int add_stream(zt_piece_muxer *p, const AVCodecParameters *parameters) {
    AVStream *stream = avformat_new_stream(p->muxer, NULL);
    if (!stream) return AVERROR(ENOMEM);
    int error = avcodec_parameters_copy(stream->codecpar, parameters);
    stream->avg_frame_rate = stream->r_frame_rate = p->rate;
    stream->time_base = (AVRational){1, 1000};
    stream->sample_aspect_ratio = (AVRational){1, 1};
    return error;
}

/* The head is as long as nobody knows, as of a broadcast. */
static int make_head(zt_piece_muxer *p) {
    AVDictionary *options = NULL;
    int error = avio_open_dyn_buf(&p->muxer->pb);
    if (error < 0) return error;
    error = av_dict_set(&options, "live", "1", 0);
    if (error >= 0) error = avformat_write_header(p->muxer, &options);
    av_dict_free(&options);
    p->head_size = avio_close_dyn_buf(p->muxer->pb, &p->head);
    p->muxer->pb = NULL;
    return error < 0 ? error : p->head ? 0 : AVERROR(ENOMEM);
}

static int open_bytes(AVIOContext **bytes, void *user, bool writes,
                      int (*read)(void *, uint8_t *, int),
                      int (*write)(void *, uint8_t *, int)) {
    uint8_t *buffer = av_malloc(BUFFER);
    *bytes =
        buffer ? avio_alloc_context(buffer, BUFFER, writes, user, read, write, NULL) : NULL;
    if (!*bytes) av_free(buffer);
    return *bytes ? 0 : AVERROR(ENOMEM);
}

static void close_bytes(AVIOContext **bytes) {
    if (*bytes) av_freep(&(*bytes)->buffer);
    avio_context_free(bytes);
}

int zt_piece_begin(zt_piece_muxer *p, const AVCodecParameters *parameters, AVRational rate,
                   int64_t first, int file, int64_t at) {
    *p = (zt_piece_muxer){.rate = rate, .first = first, .file = file, .at = at};
    int error = avformat_alloc_output_context2(&p->muxer, NULL, "matroska", NULL);
    if (error < 0) return error;
    p->muxer->flags |= AVFMT_FLAG_BITEXACT;
    p->muxer->avoid_negative_ts = AVFMT_AVOID_NEG_TS_DISABLED;
    error = add_stream(p, parameters);
    if (error >= 0) error = make_head(p);
    return error < 0 ? error : open_bytes(&p->muxer->pb, p, true, NULL, write_bytes);
}

/* When a packet is decoded must rise, and never be after it is shown. Matroska holds that only
 * of codecs which it has by the ways of AVI, and none of those has pictures in another order.
 */
int zt_piece_put(zt_piece_muxer *p, AVPacket *packet) {
    const AVStream *stream = p->muxer->streams[0];
    const AVCodecDescriptor *codec = avcodec_descriptor_get(stream->codecpar->codec_id);
    int delay = codec && codec->props & AV_CODEC_PROP_REORDER ? REORDER_MAX : 0;
    AVRational time = frame_time(p->rate), base = stream->time_base;
    packet->dts = av_rescale_q(p->first + p->count++ - delay, time, base);
    packet->pts = av_rescale_q(p->first + packet->pts, time, base);
    packet->duration = av_rescale_q(1, time, base);
    packet->stream_index = 0;
    int error = av_write_frame(p->muxer, packet);
    if (error >= 0) avio_flush(p->muxer->pb);
    return error < 0 ? error : p->muxer->pb->error;
}

int zt_piece_finish(zt_piece_muxer *p) {
    int error = av_write_frame(p->muxer, NULL); /* ends the cluster */
    if (error >= 0) avio_flush(p->muxer->pb);
    return error < 0 ? error : p->muxer->pb->error;
}

void zt_piece_close(zt_piece_muxer *p) {
    if (p->muxer) close_bytes(&p->muxer->pb);
    avformat_free_context(p->muxer);
    av_free(p->head);
    *p = (zt_piece_muxer){0};
}

static int read_bytes(void *user, uint8_t *bytes, int size) {
    zt_piece_reader *r = user;
    if (r->read < r->head_size) {
        int rest = r->head_size - (int)r->read, count = size < rest ? size : rest;
        memcpy(bytes, r->head + r->read, (size_t)count);
        r->read += count;
        return count;
    }
    int64_t rest = r->end - r->at;
    if (rest <= 0) return AVERROR_EOF;
    ssize_t count = pread(r->file, bytes, (size_t)(size < rest ? size : rest), r->at);
    if (count < 0) return AVERROR(errno);
    r->at += count;
    return count == 0 ? AVERROR_EOF : (int)count;
}

int zt_piece_open(zt_piece_reader *r, const uint8_t *head, int head_size, AVRational rate,
                  int64_t first, int file, int64_t begin, int64_t end) {
    *r = (zt_piece_reader){.rate = rate,
                           .first = first,
                           .head = head,
                           .head_size = head_size,
                           .file = file,
                           .at = begin,
                           .end = end};
    r->packet = av_packet_alloc();
    r->container = avformat_alloc_context();
    if (!r->packet || !r->container) return AVERROR(ENOMEM);
    AVIOContext *bytes;
    int error = open_bytes(&bytes, r, false, read_bytes, NULL);
    if (error < 0) return error;
    r->container->pb = bytes;
    r->container->flags |= AVFMT_FLAG_CUSTOM_IO | AVFMT_FLAG_NOPARSE | AVFMT_FLAG_NOFILLIN;
    error = avformat_open_input(&r->container, NULL, av_find_input_format("matroska"), NULL);
    if (error < 0) { /* which has freed the container */
        close_bytes(&bytes);
        return error;
    }
    if (r->container->nb_streams != 1) return AVERROR_INVALIDDATA;
    r->stream = r->container->streams[0];
    return 0;
}

int zt_piece_next(zt_piece_reader *r) {
    av_packet_unref(r->packet);
    int error = av_read_frame(r->container, r->packet);
    if (error < 0) return error;
    /* Of codecs that Matroska has by the ways of AVI, times are those of decoding. */
    if (r->packet->pts == AV_NOPTS_VALUE) r->packet->pts = r->packet->dts;
    if (r->packet->stream_index != 0 || r->packet->pts == AV_NOPTS_VALUE)
        return AVERROR_INVALIDDATA;
    r->packet->pts =
        av_rescale_q(r->packet->pts, r->stream->time_base, frame_time(r->rate)) - r->first;
    r->packet->dts = AV_NOPTS_VALUE;
    return 0;
}

void zt_piece_end(zt_piece_reader *r) {
    AVIOContext *bytes = r->container ? r->container->pb : NULL;
    avformat_close_input(&r->container);
    close_bytes(&bytes);
    av_packet_free(&r->packet);
    *r = (zt_piece_reader){0};
}

zt_hash zt_packet_checksum(zt_hash before, const AVPacket *packet, int64_t number) {
    size_t size = 0; /* of what alpha there is besides */
    const uint8_t *alpha =
        av_packet_get_side_data(packet, AV_PKT_DATA_MATROSKA_BLOCKADDITIONAL, &size);
    const struct {
        zt_hash before, data, alpha;
        int64_t number;
    } all = {before, zt_hash_bytes(packet->data, (size_t)packet->size),
             zt_hash_bytes(alpha, alpha ? size : 0), number};
    return zt_hash_bytes(&all, sizeof all);
}

int zt_piece_describe_as(AVCodecParameters *parameters, const AVCodecParameters *from) {
    av_freep(&parameters->extradata);
    parameters->extradata_size = 0;
    if (from->extradata_size <= 0) return 0;
    size_t size = (size_t)from->extradata_size;
    parameters->extradata = av_mallocz(size + AV_INPUT_BUFFER_PADDING_SIZE);
    if (!parameters->extradata) return AVERROR(ENOMEM);
    memcpy(parameters->extradata, from->extradata, size);
    parameters->extradata_size = from->extradata_size;
    return 0;
}
