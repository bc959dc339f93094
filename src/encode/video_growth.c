#include "encode/video_growth.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/text.h"
#include "encode/video_encoder.h"
#include "encode/video_finished.h"
#include "encode/video_older.h"

enum { GOPS_A_PIECE = 2 };

/* A frame that took longer is kept until its piece is complete: that costs a millisecond or a
 * few. */
#define SPOOLED_S 0.02

static zt_hash mix(zt_hash before, const void *bytes, size_t size) {
    const zt_hash both[] = {before, zt_hash_bytes(bytes, size)};
    return zt_hash_bytes(both, sizeof both);
}

static zt_hash mix_text(zt_hash before, const char *text) {
    return text ? mix(before, text, strlen(text)) : mix(before, &text, sizeof text);
}

/* All that decides how the numbers of an image become packets: the choice with each option of
 * the encoder's, the format, what encodes, and the head, which has what the encoder says. */
static void find_manner(zt_video_growth *g, const zt_output_format *format,
                        const char *conversion) {
    const zt_video_choice *c = g->choice;
    const int64_t numbers[] = {(int64_t)c->bitrate, format->width,    format->height,
                               format->rate.num,    format->rate.den, format->view,
                               g->piece_frames,     c->pixels,        avcodec_version(),
                               avutil_version(),    c->thread_count,  g->like->color_trc};
    zt_hash m = mix(mix_text((zt_hash){0}, c->encoder->name), numbers, sizeof numbers);
    m = mix_text(mix_text(mix_text(m, conversion), c->crf), c->preset);
    for (const zt_codec_setting *s = c->codec->settings; s->name; s++)
        m = mix_text(mix_text(m, s->name), s->value);
    for (const zt_output_option *o = c->options; o && o->name; o++)
        if (zt_text_equal(o->name, "encoder-option")) m = mix_text(m, o->value);
    g->manner = mix(m, g->part.head, (size_t)g->part.head_size);
}

static zt_hash frame_key(const zt_video_growth *g, int64_t position) {
    if (!g->plan || position >= g->plan->count || !zt_hash_is_known(g->plan->keys[position]))
        return (zt_hash){0};
    return mix(g->manner, &g->plan->keys[position], sizeof(zt_hash));
}

static zt_hash key_of(const zt_video_growth *g, int64_t first, int64_t count) {
    zt_hash all = mix(g->manner, &count, sizeof count);
    for (int64_t i = first; i < first + count; i++) {
        zt_hash key = frame_key(g, i);
        if (!zt_hash_is_known(key)) return key;
        all = mix(all, &key, sizeof key);
    }
    return all;
}

/* How many frames piece `index` has, when all come. */
static int64_t frames_of(const zt_video_growth *g, int64_t index) {
    if (!g->plan) return g->piece_frames;
    int64_t rest = g->plan->count - index * g->piece_frames;
    return rest < g->piece_frames ? rest : g->piece_frames;
}

static zt_status set_piece(zt_video_growth *g, int64_t index, int64_t piece) {
    for (; g->piece_count <= index; g->piece_count++) {
        if (g->piece_count == g->capacity) {
            int64_t more = g->capacity ? 2 * g->capacity : 64;
            int64_t *pieces = reallocarray(g->pieces, (size_t)more, sizeof *pieces);
            if (!pieces) return ZT_EMEMORY;
            g->pieces = pieces;
            g->capacity = more;
        }
        g->pieces[g->piece_count] = -1;
    }
    g->pieces[index] = piece;
    return ZT_OK;
}

/* The pieces that the file has of this film. */
static zt_status find_pieces(zt_video_growth *g) {
    for (int64_t i = 0; i * g->piece_frames < g->plan->count; i++) {
        int64_t first = i * g->piece_frames, count = frames_of(g, i);
        zt_hash key = key_of(g, first, count);
        ZT_TRY(set_piece(g, i, zt_video_part_find(&g->part, first, count, key)));
    }
    return ZT_OK;
}

/* What records say of the finished film, as far as it is still missing. */
static bool wish(const zt_video_growth *g, zt_video_wished *wished) {
    bool some = false;
    for (int64_t i = 0; i < g->plan->record_count; i++) {
        const zt_output_record *r = &g->plan->records[i];
        int64_t index = r->first / g->piece_frames;
        if (r->kind != ZT_RECORD_PIECE || r->first < 0 || r->first % g->piece_frames != 0 ||
            index >= g->piece_count || g->pieces[index] >= 0)
            continue;
        int64_t count = frames_of(g, index);
        zt_hash key = key_of(g, r->first, count);
        if (r->count != count || !zt_hash_is_known(key) || !zt_hash_equal(key, r->key))
            continue;
        wished[index] = (zt_video_wished){count, key, r->checksum, r->render_s};
        some = true;
    }
    return some;
}

static zt_status take_older(zt_video_growth *g, const char *target) {
    if (g->choice->stored || g->plan->record_count < 1) return ZT_OK;
    zt_video_wished *wished = calloc((size_t)g->piece_count, sizeof *wished);
    if (!wished) return ZT_EMEMORY;
    if (wish(g, wished))
        zt_video_take_older(&g->part, target, wished, g->piece_count, g->piece_frames,
                            g->parameters);
    free(wished);
    return find_pieces(g);
}

/* Which frames need not come: those of pieces that are there, and those that wait. Of others
 * that wait nobody needs to know. */
static zt_status find_kept(zt_video_growth *g) {
    g->kept = calloc((size_t)g->plan->count, sizeof *g->kept);
    if (!g->kept) return ZT_EMEMORY;
    for (int64_t i = 0; i < g->plan->count; i++)
        g->kept[i] = g->untouched || g->pieces[i / g->piece_frames] >= 0;
    zt_video_spool *s = &g->spool;
    int64_t count = 0;
    for (int64_t i = 0; i < s->count; i++) {
        int64_t at = s->frames[i].position;
        if (at >= g->plan->count || g->kept[at]) continue;
        zt_hash key = frame_key(g, at);
        if (zt_video_spool_find(s, at, key) != &s->frames[i]) continue;
        g->kept[at] = true;
        s->frames[count++] = s->frames[i];
    }
    s->count = count;
    return ZT_OK;
}

static zt_status follow_plan(zt_video_growth *g, const char *target, zt_hash said) {
    bool keeps = !g->plan->overwrites;
    zt_hash all = key_of(g, 0, g->plan->count);
    if (zt_hash_is_known(all)) g->film_key = mix(all, &said, sizeof said);
    ZT_TRY(find_pieces(g));
    g->untouched = keeps && zt_video_finished_is(target, g->film_key, g->plan);
    if (keeps && !g->untouched) ZT_TRY(take_older(g, target));
    return find_kept(g);
}

static zt_status open_encoder(zt_video_growth *g) {
    const AVOutputFormat *muxer = av_guess_format("matroska", NULL, NULL);
    return zt_video_encoder_open(&g->encoder, g->choice, muxer, g->like, g->rate, g->ear);
}

/* The tag of MP4 is none of Matroska's. */
static zt_status find_parameters(zt_video_growth *g) {
    g->parameters = avcodec_parameters_alloc();
    g->packet = av_packet_alloc();
    if (!g->parameters || !g->packet) return ZT_EMEMORY;
    AV_TRY(g->ear, avcodec_parameters_from_context(g->parameters, g->encoder));
    if (g->parameters->codec_tag == g->choice->codec->tag) g->parameters->codec_tag = 0;
    return ZT_OK;
}

static zt_status open_spool(zt_video_growth *g, bool keeps) {
    char *path = zt_text_print("%s.frames", g->aside.path);
    if (!path) return ZT_EMEMORY;
    zt_status status = zt_video_spool_open(&g->spool, path, g->like, keeps, g->ear);
    free(path);
    return status;
}

zt_status zt_video_growth_open(zt_video_growth *g, const char *target,
                               const zt_video_choice *choice, const zt_output_format *format,
                               AVFrame *like, AVCodecContext *encoder,
                               const zt_video_growth_words *words, const zt_video_ear *ear) {
    *g = (zt_video_growth){.ear = ear,
                           .encoder = encoder,
                           .choice = choice,
                           .plan = format->plan,
                           .like = like,
                           .part.file = -1,
                           .spool.file = -1};
    av_reduce(&g->rate.num, &g->rate.den, format->rate.num, format->rate.den, INT32_MAX);
    g->piece_frames = GOPS_A_PIECE * (int64_t)zt_video_gop_frames(g->rate);
    bool keeps = g->plan && !g->plan->overwrites;
    if (!g->encoder) ZT_TRY(open_encoder(g));
    ZT_TRY(zt_video_alone_open(&g->alone, choice, g->encoder, like));
    ZT_TRY(find_parameters(g));
    ZT_TRY(zt_aside_open(&g->aside, target, ear->listener));
    ZT_TRY(zt_video_part_open(&g->part, g->aside.path, g->parameters, g->rate, keeps, ear));
    find_manner(g, format, words->conversion);
    ZT_TRY(open_spool(g, keeps));
    return g->plan ? follow_plan(g, target, words->said) : ZT_OK;
}

/* Keeps the first frame, the newest one, and, so that it need not be known how many come, the
 * newest whose number is a power of two; of those that are encoded now. */
static zt_status keep_sample(zt_video_growth *g, const AVFrame *frame) {
    int64_t number = g->next;
    bool first = !g->samples[0].frame;
    const bool wanted[ZT_VIDEO_SAMPLE_COUNT] = {first, !first && (number & (number - 1)) == 0,
                                                !first};
    for (int i = 0; i < ZT_VIDEO_SAMPLE_COUNT; i++) {
        if (!wanted[i]) continue;
        av_frame_free(&g->samples[i].frame);
        g->samples[i].number = number;
        g->samples[i].frame = av_frame_clone(frame);
        if (!g->samples[i].frame) return ZT_EMEMORY;
    }
    return ZT_OK;
}

static zt_status put_packet(void *user, AVPacket *packet) {
    zt_video_growth *g = user;
    return zt_video_part_put(&g->part, packet);
}

static zt_status encode(zt_video_growth *g, const AVFrame *frame) {
    return zt_video_encode(g->encoder, frame, g->packet, put_packet, g, g->ear);
}

static zt_status tell_piece(const zt_video_growth *g) {
    const zt_video_piece *p = &g->part.pieces[g->part.count - 1];
    if (!g->plan || !g->plan->completed || !zt_hash_is_known(p->key)) return ZT_OK;
    const zt_output_record record = {.kind = ZT_RECORD_PIECE,
                                     .first = p->first,
                                     .count = p->count,
                                     .key = p->key,
                                     .bytes = p->end,
                                     .checksum = p->checksum,
                                     .render_s = p->render_s};
    return g->plan->completed(g->plan->user, &record);
}

static zt_status begin_piece(zt_video_growth *g) {
    if (!g->encoder) ZT_TRY(open_encoder(g));
    AVCodecParameters *now = avcodec_parameters_alloc();
    if (!now) return ZT_EMEMORY;
    int error = avcodec_parameters_from_context(now, g->encoder);
    now->codec_tag = g->parameters->codec_tag;
    zt_status status = error < 0 ? zt_libav_refuse(g->ear, error)
                                 : zt_video_part_begin(&g->part, now, g->next);
    avcodec_parameters_free(&now);
    g->render_s = 0;
    return status;
}

/* Only a whole piece is known by its key. */
static zt_status finish_piece(zt_video_growth *g) {
    int64_t first = g->next - g->in_piece, index = first / g->piece_frames;
    bool whole = g->in_piece == frames_of(g, index);
    zt_hash key = whole ? key_of(g, first, g->in_piece) : (zt_hash){0};
    if (!g->alone) {
        ZT_TRY(encode(g, NULL));
        zt_video_encoder_close(&g->encoder, NULL);
    }
    ZT_TRY(zt_video_part_finish(&g->part, g->in_piece, key, g->render_s));
    ZT_TRY(set_piece(g, index, g->part.count - 1));
    g->in_piece = 0;
    ZT_TRY(tell_piece(g));
    return whole ? zt_video_spool_pass(&g->spool, g->next) : ZT_OK;
}

static zt_status put_frame(zt_video_growth *g, AVFrame *frame, AVPacket *packet,
                           double render_s) {
    ZT_TRY(keep_sample(g, frame));
    if (g->in_piece == 0) ZT_TRY(begin_piece(g));
    if (packet) {
        packet->pts = packet->dts = g->in_piece;
        ZT_TRY(put_packet(g, packet));
    } else {
        frame->pts = g->in_piece;
        frame->pict_type = AV_PICTURE_TYPE_NONE;
        ZT_TRY(encode(g, frame));
    }
    g->in_piece++;
    g->next++;
    g->render_s += render_s;
    return g->in_piece == frames_of(g, (g->next - 1) / g->piece_frames) ? finish_piece(g)
                                                                        : ZT_OK;
}

static zt_status put_spooled(zt_video_growth *g, const zt_video_spooled *there) {
    AVFrame *frame = NULL;
    AVPacket *packet = NULL;
    zt_status status = zt_video_spool_get(&frame, &g->spool, there);
    if (status == ZT_OK && g->alone)
        status = zt_video_alone_encode(&packet, g->alone, frame, g->ear);
    if (status == ZT_OK) status = put_frame(g, frame, packet, there->render_s);
    av_packet_free(&packet);
    av_frame_free(&frame);
    return status;
}

/* Goes on to the next frame that has to come. */
static zt_status catch_up(zt_video_growth *g) {
    while (g->plan && g->next < g->plan->count && g->kept[g->next]) {
        int64_t index = g->next / g->piece_frames;
        if (g->pieces[index] >= 0) {
            g->next += frames_of(g, index);
            continue;
        }
        const zt_video_spooled *there =
            zt_video_spool_find(&g->spool, g->next, frame_key(g, g->next));
        ZT_TRY(put_spooled(g, there));
    }
    return ZT_OK;
}

zt_status zt_video_growth_put(zt_video_growth *g, AVFrame *frame, AVPacket *packet,
                              double render_s) {
    ZT_TRY(catch_up(g));
    zt_hash key = frame_key(g, g->next);
    if (zt_hash_is_known(key) && render_s >= SPOOLED_S)
        ZT_TRY(zt_video_spool_put(&g->spool, frame, g->next, key, render_s));
    return put_frame(g, frame, packet, render_s);
}

zt_status zt_video_growth_end(zt_video_growth *g) {
    ZT_TRY(catch_up(g));
    return g->in_piece > 0 ? finish_piece(g) : ZT_OK;
}

zt_status zt_video_growth_pieces(const zt_video_piece ***out, int64_t *count,
                                 const zt_video_growth *g) {
    *count = (g->next + g->piece_frames - 1) / g->piece_frames;
    const zt_video_piece **pieces = *out = calloc((size_t)*count + 1, sizeof *pieces);
    if (!pieces) return ZT_EMEMORY;
    for (int64_t i = 0; i < *count; i++) pieces[i] = &g->part.pieces[g->pieces[i]];
    return ZT_OK;
}

bool zt_video_growth_has_more(const zt_video_growth *g) {
    for (int64_t i = 0; i < g->piece_count; i++)
        if (g->pieces[i] >= 0 && i * g->piece_frames >= g->next) return true;
    return false;
}

void zt_video_growth_close(zt_video_growth *g, bool keeps_pieces, bool keeps_frames) {
    bool some = g->part.count > 0;
    for (int i = 0; i < ZT_VIDEO_SAMPLE_COUNT; i++) av_frame_free(&g->samples[i].frame);
    zt_video_part_abandon(&g->part);
    zt_video_part_close(&g->part);
    zt_video_spool_close(&g->spool, keeps_frames);
    if (!(keeps_pieces && some)) zt_aside_drop(&g->aside);
    zt_aside_forget(&g->aside);
    zt_video_alone_close(&g->alone);
    zt_video_encoder_close(&g->encoder, g->in_piece == 0 ? g->like : NULL);
    avcodec_parameters_free(&g->parameters);
    av_packet_free(&g->packet);
    free(g->pieces);
    free(g->kept);
    *g = (zt_video_growth){.part.file = -1, .spool.file = -1};
}
