/* A movie: images are converted and encoded into a file that grows; when all are there, that
 * becomes the film, is held against what was sent, and only then gets its name. */
#include "encode/video.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "encode/aside.h"
#include "encode/video_check.h"
#include "encode/video_encoder.h"
#include "encode/video_finished.h"
#include "encode/video_growth.h"
#include "encode/video_join.h"
#include "encode/video_pixels.h"
#include "encode/video_store.h"

typedef struct movie {
    zt_video_ear ear;
    zt_video_choice choice, grown; /* of the film, and of the pieces that it grows in */
    zt_output_option *options;     /* a copy, which the choice points into */
    zt_output_format format;
    zt_video_pixels *pixels;
    AVFrame *like;                 /* a frame of the kind that will come, with its tags */
    AVCodecParameters *parameters; /* of the film's packets */
    zt_aside aside;                /* of the film while it is joined */
    zt_video_growth growth;
    zt_video_store store; /* of kinds that have no pieces */
} movie;

/* A frame on its way. */
typedef struct picture {
    AVFrame *frame;
    AVPacket *packet; /* where it was encoded already; else NULL */
    double render_s;
} picture;

static void free_options(movie *m) {
    for (zt_output_option *o = m->options; o && o->name; o++) {
        free((char *)o->name);
        free((char *)o->value);
    }
    free(m->options);
}

/* What later runs can use stays. */
static void movie_free(movie *m, bool keeps_pieces, bool keeps_frames) {
    zt_video_growth_close(&m->growth, keeps_pieces, keeps_frames);
    zt_video_store_close(&m->store);
    zt_aside_drop(&m->aside);
    zt_video_pixels_close(&m->pixels);
    av_frame_free(&m->like);
    avcodec_parameters_free(&m->parameters);
    free_options(m);
    free((char *)m->format.settings);
    free((char *)m->ear.target);
    free(m);
}

/* Options are the caller's only while a movie is opened, and some are asked for later. */
static zt_status copy_options(movie *m, const zt_output_option *options) {
    size_t count = 0;
    while (options && options[count].name) count++;
    m->options = calloc(count + 1, sizeof *m->options);
    if (!m->options) return ZT_EMEMORY;
    for (size_t i = 0; i < count; i++) {
        m->options[i].value = strdup(options[i].value);
        m->options[i].name = strdup(options[i].name);
        if (!m->options[i].name || !m->options[i].value) return ZT_EMEMORY;
    }
    return ZT_OK;
}

/* How frames wait for those films that are made of all at once. */
static zt_status choose_grown(movie *m) {
    m->grown = m->choice;
    const zt_codec_store *stored = m->choice.stored;
    if (!stored) return ZT_OK;
    const zt_video_ear ear = {"pieces.mkv", m->ear.listener};
    zt_output_option options[] = {
        {"codec", stored->codec}, {"pixel-format", stored->pixels}, {NULL, NULL}};
    ZT_TRY(zt_video_choose(&m->grown, &m->format, options, &ear));
    m->grown.options = NULL;
    m->grown.stored = stored;
    return ZT_OK;
}

static zt_status make_like(movie *m) {
    const zt_output_format *f = &m->format;
    ZT_TRY(zt_video_pixels_open(&m->pixels, f, m->grown.pixels, &m->ear));
    return zt_video_pixels_like(&m->like, m->pixels, f->width, f->height, &m->ear);
}

/* What will hold all frames, at a guess: the file that grows, and the film made of it. */
static zt_status check_room(const movie *m) {
    double count = (double)(m->format.frame_count > 0 ? m->format.frame_count : 1);
    double pixels = (double)m->format.width * m->format.height * count;
    double bits = m->choice.codec->bits_a_pixel * pixels;
    if (m->choice.bitrate)
        bits = (double)m->choice.bitrate * count * m->format.rate.den / m->format.rate.num;
    bits += m->choice.stored ? m->grown.codec->bits_a_pixel * pixels : bits;
    return zt_aside_room(&m->aside, bits / 8, m->ear.listener);
}

/* An encoder of the film's, which shows that there is one. */
static zt_status open_encoder(AVCodecContext **encoder, movie *m) {
    const AVOutputFormat *muxer = av_guess_format(m->choice.container->muxer, NULL, NULL);
    AVRational rate = {m->format.rate.num, m->format.rate.den};
    m->parameters = avcodec_parameters_alloc();
    if (!m->parameters) return ZT_EMEMORY;
    ZT_TRY(zt_video_encoder_open(encoder, &m->choice, muxer, m->like, rate, &m->ear));
    AV_TRY(&m->ear, avcodec_parameters_from_context(m->parameters, *encoder));
    return ZT_OK;
}

/* Shows that the film can be made, with its sound, before a frame is. */
static zt_status try_join(movie *m) {
    zt_video_join join;
    zt_status status = zt_video_join_open(&join, m->aside.path, &m->choice, &m->format,
                                          m->parameters, &m->ear);
    zt_video_join_close(&join);
    zt_aside_drop(&m->aside);
    return status;
}

/* Pieces are encoded as the film is, where it has them. */
static zt_status open_growth(movie *m) {
    AVCodecContext *encoder = NULL;
    zt_status status = open_encoder(&encoder, m);
    if (status == ZT_OK) status = try_join(m);
    if (status != ZT_OK || m->choice.stored)
        zt_video_encoder_close(&encoder, m->choice.stored ? NULL : m->like);
    ZT_TRY(status);
    const zt_video_growth_words words = {
        zt_video_pixels_manner(m->pixels),
        zt_video_said(&m->choice, m->format.settings, m->ear.target)};
    return zt_video_growth_open(&m->growth, m->ear.target, &m->grown, &m->format, m->like,
                                encoder, &words, &m->ear);
}

static zt_status open_all(movie *m, const char *target, const zt_output_option *options) {
    const char *settings = m->format.settings;
    m->ear.target = strdup(target);
    m->format.settings = settings ? strdup(settings) : NULL;
    if (!m->ear.target || (settings && !m->format.settings)) return ZT_EMEMORY;
    ZT_TRY(copy_options(m, options));
    zt_video_choice choice;
    ZT_TRY(zt_video_choose(&choice, &m->format, m->options, &m->ear));
    m->choice = choice;
    ZT_TRY(choose_grown(m));
    const zt_container *kind = choice.container;
    if (zt_wish_value(options, "audio") && !kind->sound)
        zt_tell(m->ear.listener, ZT_WARNING, "%s has no sound: %s files hold none", target,
                kind->ending);
    ZT_TRY(zt_aside_open_as(&m->aside, target, ".joined", m->ear.listener));
    ZT_TRY(check_room(m));
    ZT_TRY(make_like(m));
    ZT_TRY(zt_video_store_open(&m->store, &m->choice, m->like, &m->ear));
    return open_growth(m);
}

static zt_status open_movie(void **state, const char *target, const zt_output_format *format,
                            const zt_output_option *options, zt_listener listener) {
    zt_libav_listen();
    movie *m = calloc(1, sizeof *m);
    if (!m) return ZT_EMEMORY;
    m->format = *format;
    m->ear.listener = listener;
    m->growth.part.file = m->growth.spool.file = -1;
    zt_status status = open_all(m, target, options);
    if (status == ZT_OK)
        *state = m;
    else
        movie_free(m, format->plan, format->plan);
    return status;
}

static bool movie_wants(void *state, int64_t position) {
    const movie *m = state;
    return !m->growth.kept[position];
}

static int64_t spared_tiles(void *state) {
    const movie *m = state;
    return zt_video_pixels_spared(m->pixels);
}

static void drop_frame(void *state, void *made) {
    (void)state;
    picture *ready = made;
    av_packet_free(&ready->packet);
    av_frame_free(&ready->frame);
    free(ready);
}

static zt_status make_frame(void **made, void *state, const zt_image *image, int64_t number) {
    (void)number; /* a movie has no gaps and begins at 0, whatever the numbers */
    const movie *m = state;
    zt_libav_listen();
    picture *ready = calloc(1, sizeof *ready);
    if (!ready) return ZT_EMEMORY;
    if (image->info.known) ready->render_s = image->info.render_s;
    zt_video_alone *alone = m->growth.alone;
    zt_status status = zt_video_pixels_convert(&ready->frame, m->pixels, image, &m->ear);
    if (status == ZT_OK && alone)
        status = zt_video_alone_encode(&ready->packet, alone, ready->frame, &m->ear);
    if (status == ZT_OK)
        *made = ready;
    else
        drop_frame(state, ready);
    return status;
}

static zt_status write_frame(void *state, void *made, int64_t number) {
    (void)number;
    movie *m = state;
    const picture *ready = made;
    zt_libav_listen();
    zt_status status =
        zt_video_growth_put(&m->growth, ready->frame, ready->packet, ready->render_s);
    if (status == ZT_OK)
        status = zt_video_store_see(&m->store, ready->frame, m->growth.next - 1);
    drop_frame(state, made);
    return status;
}

static zt_status join(movie *m, zt_hash *checksum) {
    const zt_video_growth *g = &m->growth;
    const zt_video_piece **pieces = NULL;
    int64_t count, frame_count = g->next;
    ZT_TRY(zt_video_growth_pieces(&pieces, &count, g));
    zt_status status =
        m->choice.stored
            ? zt_video_store_join(&frame_count, &m->store, m->aside.path, &m->format, &g->part,
                                  pieces, count)
            : zt_video_join_pieces(checksum, m->aside.path, &m->choice, &m->format,
                                   m->parameters, &g->part, pieces, count, &m->ear);
    free(pieces);
    return status;
}

static void tell_checked(const movie *m, double psnr) {
    char rate[32], quality[48] = "the same to the bit";
    const zt_rate *r = &m->format.rate;
    int64_t count = m->growth.next;
    snprintf(rate, sizeof rate, r->den == 1 ? "%d" : "%d/%d", r->num, r->den);
    if (isfinite(psnr)) snprintf(quality, sizeof quality, "PSNR %.1f dB at least", psnr);
    if (!m->growth.samples[0].frame)
        snprintf(quality, sizeof quality, "all as it was encoded before");
    zt_tell(m->ear.listener, ZT_NOTE, "%s: %" PRId64 " frame%s, %s, %s fps, checked: %s",
            m->ear.target, count, count == 1 ? "" : "s", m->choice.codec->title, rate, quality);
}

/* A film that fails the check does not get its name, but hours of work are not thrown away. */
static zt_status check_film(movie *m, zt_hash checksum) {
    zt_video_expected expected = {.choice = &m->choice,
                                  .like = m->like,
                                  .rate = m->format.rate,
                                  .frame_count = m->growth.next,
                                  .has_sound = m->choice.container->sound &&
                                               zt_wish_value(m->options, "audio"),
                                  .checksum = checksum};
    for (int i = 0; i < ZT_VIDEO_SAMPLE_COUNT; i++) expected.samples[i] = m->growth.samples[i];
    double psnr;
    zt_status status = zt_video_check(&psnr, m->aside.path, &expected, &m->ear);
    if (status == ZT_OK) tell_checked(m, psnr);
    if (status == ZT_EFILE) zt_aside_leave(&m->growth.aside, m->ear.listener);
    return status;
}

static bool is_whole(const movie *m) {
    return !m->format.plan || m->growth.next == m->format.plan->count;
}

static zt_status tell_finished(movie *m) {
    const zt_output_plan *plan = m->format.plan;
    zt_hash key = m->growth.film_key;
    if (!plan || !plan->completed || !is_whole(m) || !zt_hash_is_known(key)) return ZT_OK;
    zt_output_record record;
    ZT_TRY(zt_video_finished_record(&record, m->ear.target, key, plan, &m->ear));
    return plan->completed(plan->user, &record);
}

static zt_status complete(movie *m) {
    zt_hash checksum = {0};
    ZT_TRY(zt_aside_open_as(&m->aside, m->ear.target, ".joined", m->ear.listener));
    ZT_TRY(join(m, &checksum));
    ZT_TRY(check_film(m, checksum));
    ZT_TRY(zt_aside_keep(&m->aside, m->ear.listener));
    return tell_finished(m);
}

/* Of a film that was edited, the older one is better than what its new beginning is. */
static zt_status complete_what_came(movie *m) {
    zt_video_growth *g = &m->growth;
    if (g->untouched) {
        zt_tell(m->ear.listener, ZT_NOTE, "%s: nothing has changed", m->ear.target);
        return ZT_OK;
    }
    ZT_TRY(zt_video_growth_end(g));
    if (zt_video_growth_has_more(g)) {
        zt_tell(m->ear.listener, ZT_NOTE, "%s is not made yet: its pieces wait in %s",
                m->ear.target, g->aside.path);
        return ZT_OK;
    }
    return g->next > 0 ? complete(m) : ZT_OK;
}

static zt_status close_movie(void *state, bool keep) {
    zt_libav_listen();
    movie *m = state;
    zt_video_growth *g = &m->growth;
    zt_status status = keep ? complete_what_came(m) : ZT_OK;
    bool planned = m->format.plan, done = keep && status == ZT_OK;
    bool interrupted = planned && !g->untouched && !is_whole(m);
    /* A film that was interrupted has the pieces itself, if it has pieces. */
    bool needs_pieces = m->choice.stored || zt_video_growth_has_more(g) || g->next == 0;
    movie_free(m, done ? interrupted && needs_pieces : planned, done ? interrupted : planned);
    return status;
}

ZT_MODULE_DOOR(zt_video_door, video) = {open_movie, movie_wants,  make_frame, write_frame,
                                        drop_frame, spared_tiles, close_movie};
