#include "encode/video_check.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libavutil/pixdesc.h>

#include "encode/video_piece.h"
#include "encode/video_pixels.h"
#include "encode/video_reader.h"

/* A check under way. */
typedef struct check {
    const zt_video_expected *expected;
    const zt_video_ear *ear;
    zt_video_reader reader;
    zt_hash checksum; /* of the packets so far */
} check;

/* Tells what is wrong and fails. */
#define FAIL(c, ...) zt_video_refuse((c)->ear, ZT_EFILE, "the check found " __VA_ARGS__)

static zt_status refuse_reading(const check *c, int error) {
    return FAIL(c, "that it cannot be read: %s", av_err2str(error));
}

static uint64_t big_endian(const uint8_t *bytes, int count) {
    uint64_t number = 0;
    for (int i = 0; i < count; i++) number = number << 8 | bytes[i];
    return number;
}

/* The boxes of ISO/IEC 14496-12 at the file's top: moov before mdat, so that a film plays while
 * it is still coming. */
static zt_status check_boxes(const check *c, const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) return FAIL(c, "no file");
    uint8_t head[16];
    bool has_moov = false, in_order = false;
    while (fread(head, 1, 8, file) == 8) {
        uint64_t size = big_endian(head, 4);
        if (size == 1 && fread(head + 8, 1, 8, file) == 8) size = big_endian(head + 8, 8) - 8;
        has_moov = has_moov || memcmp(head + 4, "moov", 4) == 0;
        if (memcmp(head + 4, "mdat", 4) == 0) in_order = has_moov;
        if (size < 8 || fseeko(file, (off_t)(size - 8), SEEK_CUR) != 0) break;
    }
    fclose(file);
    return in_order ? ZT_OK : FAIL(c, "moov not before mdat");
}

/* When a frame is shown, in the stream's time base and as exact as the container can say. */
static int64_t time_of(const check *c, int64_t number) {
    AVRational frame = {c->expected->rate.den, c->expected->rate.num};
    int ticks = c->expected->choice->container->ticks_a_second;
    AVRational base = c->reader.stream->time_base;
    if (c->expected->choice->container->has_delays)
        return number * av_rescale_q(1, frame, base);
    if (ticks == 0) return av_rescale_q(number, frame, base);
    AVRational tick = {1, ticks};
    return av_rescale_q(av_rescale_q(number, frame, tick), tick, base);
}

/* Which frame a packet shows; -1 where its time is none's. */
static int64_t number_of(const check *c, int64_t pts) {
    AVRational frame = {c->expected->rate.den, c->expected->rate.num};
    if (pts == AV_NOPTS_VALUE || pts < 0) return -1;
    int64_t number = c->expected->choice->container->has_delays
                         ? pts / av_rescale_q(1, frame, c->reader.stream->time_base)
                         : av_rescale_q(pts, c->reader.stream->time_base, frame);
    return number < c->expected->frame_count && time_of(c, number) == pts ? number : -1;
}

/* Marks the frame of a packet in `seen`, or notes its sound. */
static zt_status note_packet(check *c, uint8_t *seen, int64_t *count, bool *has_sound) {
    const AVPacket *packet = c->reader.packet;
    if (packet->stream_index != c->reader.stream->index) {
        AVRational base = c->reader.container->streams[packet->stream_index]->time_base;
        AVRational frame = {c->expected->rate.den, c->expected->rate.num};
        if (av_compare_ts(packet->pts, base, c->expected->frame_count, frame) >= 0)
            return FAIL(c, "sound beyond the end of the film");
        *has_sound = true;
        return ZT_OK;
    }
    int64_t number = number_of(c, packet->pts);
    if (number < 0)
        return FAIL(c, "a frame at %g s, where the rate has none",
                    (double)packet->pts * av_q2d(c->reader.stream->time_base));
    if (seen[number]) return FAIL(c, "frame %" PRId64 " twice", number);
    seen[number] = 1;
    ++*count;
    c->checksum = zt_packet_checksum(c->checksum, c->reader.packet, number);
    return ZT_OK;
}

/* All frames are there, each once and at its own time. */
static zt_status check_times(check *c) {
    uint8_t *seen = calloc((size_t)c->expected->frame_count, 1);
    if (!seen) return ZT_EMEMORY;
    zt_status status = ZT_OK;
    int64_t count = 0;
    bool has_sound = false;
    while (status == ZT_OK) {
        int error = av_read_frame(c->reader.container, c->reader.packet);
        if (error == AVERROR_EOF) break;
        status =
            error < 0 ? refuse_reading(c, error) : note_packet(c, seen, &count, &has_sound);
        av_packet_unref(c->reader.packet);
    }
    free(seen);
    ZT_TRY(status);
    if (count != c->expected->frame_count)
        return FAIL(c, "%" PRId64 " frames instead of %" PRId64, count,
                    c->expected->frame_count);
    if (c->expected->has_sound && !has_sound) return FAIL(c, "no sound");
    zt_hash sent = c->expected->checksum;
    if (zt_hash_is_known(sent) && !zt_hash_equal(sent, c->checksum))
        return FAIL(c, "other packets than were encoded");
    return ZT_OK;
}

/* As near as the times of the first and the last frame allow. */
static bool near_rate(const check *c, AVRational found) {
    const zt_video_expected *e = c->expected;
    double wanted = (double)e->rate.num / e->rate.den;
    int ticks = e->choice->container->ticks_a_second;
    double tolerance =
        1e-3 + (ticks ? 2 * wanted / ((double)ticks * (double)e->frame_count) : 0);
    if (found.num <= 0 || found.den <= 0) return !e->choice->container->has_boxes; /* unknown */
    return fabs(av_q2d(found) / wanted - 1) < tolerance;
}

/* A tag that says nothing is no mistake: some kinds of file cannot hold it. */
static bool tag_differs(unsigned found, unsigned wanted, unsigned unspecified) {
    return found != wanted && found != unspecified;
}

static zt_status check_tags(const check *c, enum AVColorPrimaries primaries,
                            enum AVColorTransferCharacteristic transfer,
                            enum AVColorSpace matrix, enum AVColorRange range,
                            const char *where) {
    const AVFrame *sent = c->expected->like;
    if (tag_differs(primaries, sent->color_primaries, AVCOL_PRI_UNSPECIFIED) ||
        tag_differs(transfer, sent->color_trc, AVCOL_TRC_UNSPECIFIED) ||
        tag_differs(matrix, sent->colorspace, AVCOL_SPC_UNSPECIFIED) ||
        tag_differs(range, sent->color_range, AVCOL_RANGE_UNSPECIFIED))
        return FAIL(c, "in its %s colours tagged %d-%d-%d (range %d) instead of %d-%d-%d (%d)",
                    where, primaries, transfer, matrix, range, sent->color_primaries,
                    sent->color_trc, sent->colorspace, sent->color_range);
    return ZT_OK;
}

static zt_status check_stream(const check *c) {
    const AVStream *stream = c->reader.stream;
    const AVCodecParameters *p = stream->codecpar;
    const zt_video_choice *choice = c->expected->choice;
    const AVFrame *sent = c->expected->like;
    if (p->codec_id != choice->encoder->id)
        return FAIL(c, "%s instead of %s", avcodec_get_name(p->codec_id), choice->codec->title);
    if (choice->container->has_boxes && choice->codec->tag &&
        p->codec_tag != choice->codec->tag)
        return FAIL(c, "the tag %s", av_fourcc2str(p->codec_tag));
    if (p->width != sent->width || p->height != sent->height)
        return FAIL(c, "%dx%d pixels instead of %dx%d", p->width, p->height, sent->width,
                    sent->height);
    if (c->expected->frame_count > 1 && !near_rate(c, stream->avg_frame_rate))
        return FAIL(c, "%d/%d frames a second", stream->avg_frame_rate.num,
                    stream->avg_frame_rate.den);
    return check_tags(c, p->color_primaries, p->color_trc, p->color_space, p->color_range,
                      "container");
}

static zt_status compare(check *c, const zt_video_sample *sample, double *least) {
    const AVFrame *found = c->reader.frame;
    ZT_TRY(check_tags(c, found->color_primaries, found->color_trc, found->colorspace,
                      found->color_range, "stream"));
    double psnr = zt_video_psnr(found, sample->frame);
    if (psnr < 0)
        return FAIL(c, "frame %" PRId64 " as %dx%d %s instead of %dx%d %s", sample->number,
                    found->width, found->height, av_get_pix_fmt_name(found->format),
                    sample->frame->width, sample->frame->height,
                    av_get_pix_fmt_name(sample->frame->format));
    if (psnr < ZT_VIDEO_PSNR_MIN || (c->expected->choice->codec->lossless && isfinite(psnr)))
        return FAIL(c, "another picture at frame %" PRId64 ": PSNR %.1f dB", sample->number,
                    psnr);
    if (psnr < *least) *least = psnr;
    return ZT_OK;
}

static bool is_sample(const void *user, int64_t pts) {
    const check *c = user;
    bool some = false;
    for (int i = 0; i < ZT_VIDEO_SAMPLE_COUNT; i++)
        some |=
            c->expected->samples[i].frame && time_of(c, c->expected->samples[i].number) == pts;
    return some;
}

/* Compares the picture that came with the samples that are of its time. */
static zt_status compare_found(check *c, bool *seen, double *least) {
    for (int i = 0; i < ZT_VIDEO_SAMPLE_COUNT; i++) {
        const zt_video_sample *sample = &c->expected->samples[i];
        if (seen[i] || !sample->frame ||
            c->reader.frame->best_effort_timestamp != time_of(c, sample->number))
            continue;
        seen[i] = true;
        ZT_TRY(compare(c, sample, least));
    }
    return ZT_OK;
}

/* From the last one on: those before it may be on the way there. */
static zt_status check_samples(check *c, double *least) {
    bool seen[ZT_VIDEO_SAMPLE_COUNT] = {false};
    c->reader.wants = is_sample;
    c->reader.user = c;
    for (int i = ZT_VIDEO_SAMPLE_COUNT - 1; i >= 0; i--) {
        const zt_video_sample *sample = &c->expected->samples[i];
        if (sample->frame && !seen[i])
            zt_video_reader_seek(&c->reader, time_of(c, sample->number));
        while (sample->frame && !seen[i]) {
            int error = zt_video_reader_next(&c->reader);
            if (error == AVERROR_EOF)
                return FAIL(c, "that frame %" PRId64 " does not come out of it",
                            sample->number);
            if (error < 0) return refuse_reading(c, error);
            ZT_TRY(compare_found(c, seen, least));
        }
    }
    return ZT_OK;
}

static zt_status check_all(check *c, const char *path, double *psnr) {
    const zt_video_choice *choice = c->expected->choice;
    bool alpha = av_pix_fmt_desc_get(choice->pixels)->flags & AV_PIX_FMT_FLAG_ALPHA;
    const char *decoder = alpha ? choice->codec->decoder : NULL;
    if (choice->container->has_boxes) ZT_TRY(check_boxes(c, path));
    int error = zt_video_reader_open(&c->reader, path, decoder);
    if (error < 0) return refuse_reading(c, error);
    ZT_TRY(check_stream(c));
    ZT_TRY(check_times(c));
    if (!zt_video_reader_seek(&c->reader, 0)) { /* not all kinds of file can be rewound */
        zt_video_reader_close(&c->reader);
        error = zt_video_reader_open(&c->reader, path, decoder);
        if (error < 0) return refuse_reading(c, error);
    }
    return check_samples(c, psnr);
}

zt_status zt_video_check(double *psnr, const char *path, const zt_video_expected *expected,
                         const zt_video_ear *ear) {
    check c = {.expected = expected, .ear = ear};
    *psnr = (double)INFINITY;
    zt_status status = check_all(&c, path, psnr);
    zt_video_reader_close(&c.reader);
    return status;
}
