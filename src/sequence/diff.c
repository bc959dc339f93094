/* Two films side by side, frame by frame. */
#include <zoetrope/diff.h>

#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "sequence/pairs.h"
#include "sequence/renderer.h"
#include "sequence/shutter.h"

/* What the film as a whole says. */
enum {
    FILM_SIZE,
    FILM_RATE,
    FILM_SAMPLES,
    FILM_QUALITY,
    FILM_FILTER,
    FILM_SEED,
    FILM_SHUTTER,
    FILM_REFLECTIONS,
    FILM_BACKGROUND,
    FILM_AOVS,
    FILM_PRECISION,
    FILM_COUNT
};

static const char *const film_names[FILM_COUNT] = {
    "film.size",       "film.rate", "film.samples", "film.quality",
    "film.filter",     "film.seed", "film.shutter", "film.reflections",
    "film.background", "film.aovs", "precision"};

/* Spans with room for more. */
typedef struct growing {
    zt_frame_spans spans;
    int64_t room;
} growing;

/* Two films being compared. */
typedef struct comparing {
    zt_renderer *older, *newer;
    zt_diff *diff;
    growing changed;
    zt_pairs pairs;
    uint32_t *ways;  /* of each pair, in the frame that is looked at */
    int32_t *causes; /* of each pair's ways, and then of the film's: which cause it is, or -1 */
    growing *spans;  /* of each cause */
    int64_t room;    /* for causes */
    uint32_t film;   /* a bit for each of what the film as a whole says */
    zt_arena frame;  /* scenes of one frame */
} comparing;

typedef struct zt_diff_memory {
    zt_diff diff; /* comes first: it is what others see */
    zt_arena arena;
} zt_diff_memory;

/* Adds a frame behind the others. */
static zt_status add_frame(growing *g, int64_t frame) {
    zt_frame_spans *s = &g->spans;
    if (s->count > 0 && s->all[s->count - 1].last >= frame - 1) {
        s->all[s->count - 1].last = frame;
        return ZT_OK;
    }
    if (s->count == g->room) {
        int64_t room = g->room ? 2 * g->room : 4;
        zt_frame_span *all = reallocarray(s->all, (size_t)room, sizeof *all);
        if (!all) return ZT_EMEMORY;
        s->all = all;
        g->room = room;
    }
    s->all[s->count++] = (zt_frame_span){frame, frame};
    return ZT_OK;
}

/* ---- because of what -----------------------------------------------------------------------
 */

static uint32_t compare_sampling(const zt_sampling *a, const zt_sampling *b) {
    uint32_t ways = 0;
    if (a->min != b->min || a->max != b->max || a->error != b->error)
        ways |= 1U << FILM_SAMPLES;
    if (a->edges != b->edges) ways |= 1U << FILM_QUALITY;
    if (a->filter != b->filter || a->filter_width != b->filter_width) ways |= 1U << FILM_FILTER;
    if (a->seed != b->seed || a->seed_fixed != b->seed_fixed) ways |= 1U << FILM_SEED;
    return ways;
}

static uint32_t compare_films(const zt_renderer *a, const zt_renderer *b) {
    const zt_film *was = &a->animation->film, *is = &b->animation->film;
    uint32_t ways = compare_sampling(&a->sampling, &b->sampling);
    if (a->format.width != b->format.width || a->format.height != b->format.height)
        ways |= 1U << FILM_SIZE;
    if ((int64_t)was->rate.num * is->rate.den != (int64_t)is->rate.num * was->rate.den)
        ways |= 1U << FILM_RATE;
    if (was->shutter.open != is->shutter.open || was->shutter.close != is->shutter.close ||
        was->shutter.error != is->shutter.error)
        ways |= 1U << FILM_SHUTTER;
    if (a->animation->rest.reflection_depth != b->animation->rest.reflection_depth)
        ways |= 1U << FILM_REFLECTIONS;
    if (was->transparent != is->transparent) ways |= 1U << FILM_BACKGROUND;
    if (a->aovs != b->aovs) ways |= 1U << FILM_AOVS;
    if (a->precision != b->precision) ways |= 1U << FILM_PRECISION;
    return ways;
}

/* Compares both films at each moment of a renderer's exposure: at one time, so that nothing is
 * said to differ because another shutter, or rate, meets it at another time. */
static zt_status compare_at(comparing *c, int64_t frame, const zt_exposure *moments,
                            const zt_renderer *of) {
    zt_scene was, is;
    for (int32_t i = 0; i < moments->moment_count; i++) {
        double cell = moments->moment_count > 1 ? moments->times[i] * ZT_TIME_CELLS : 0,
               time_s = zt_shutter_time(of->animation, frame, cell);
        ZT_TRY(zt_animation_freeze(&was, c->older->animation, time_s, &c->frame,
                                   c->older->listener));
        ZT_TRY(zt_animation_freeze(&is, c->newer->animation, time_s, &c->frame,
                                   c->newer->listener));
        zt_pairs_compare(c->ways, &c->pairs, &was, &is);
    }
    return ZT_OK;
}

static zt_status expose(zt_exposure *exposure, zt_renderer *r, int64_t frame, zt_arena *arena) {
    zt_division division;
    return zt_shutter_expose(exposure, &division, r->animation, frame, r->format.height, arena,
                             r->listener);
}

/* A frame that changes is one of those of a cause, which is a new one if need be. */
static zt_status blame(comparing *c, int64_t frame, int32_t slot, const char *name) {
    zt_diff *d = c->diff;
    if (!name) return ZT_EMEMORY;
    if (c->causes[slot] < 0) {
        if (d->cause_count == c->room) {
            int64_t room = c->room ? 2 * c->room : 16;
            growing *spans = reallocarray(c->spans, (size_t)room, sizeof *spans);
            if (spans) c->spans = spans;
            zt_diff_cause *causes = reallocarray(d->causes, (size_t)room, sizeof *causes);
            if (causes) d->causes = causes;
            if (!spans || !causes) return ZT_EMEMORY;
            c->room = room;
        }
        c->causes[slot] = (int32_t)d->cause_count;
        c->spans[d->cause_count] = (growing){0};
        d->causes[d->cause_count++] = (zt_diff_cause){.name = name};
    }
    return add_frame(&c->spans[c->causes[slot]], frame);
}

static const char *name_of(comparing *c, int32_t pair, int way) {
    int32_t cause = c->causes[pair * ZT_WAY_COUNT + way];
    zt_arena *arena = &((zt_diff_memory *)c->diff)->arena;
    return cause < 0 ? zt_pairs_name(&c->pairs, pair, way, arena) : c->diff->causes[cause].name;
}

/* That things are in another order matters where they lie on each other; it is said where
 * nothing else is to say. */
static zt_status blame_all(comparing *c, int64_t frame) {
    const int32_t film = c->pairs.count * ZT_WAY_COUNT;
    uint32_t any = c->film, order = UINT32_C(1) << ZT_WAY_ORDER;
    for (int32_t i = 0; i < c->pairs.count; i++) any |= c->ways[i] & ~order;
    for (int way = 0; way < FILM_COUNT; way++)
        if (c->film >> way & 1) ZT_TRY(blame(c, frame, film + way, film_names[way]));
    for (int32_t i = 0; i < c->pairs.count; i++) {
        uint32_t ways = any ? c->ways[i] & ~order : c->ways[i];
        for (int way = 0; ways >> way && way < ZT_WAY_COUNT; way++)
            if (ways >> way & 1)
                ZT_TRY(blame(c, frame, i * ZT_WAY_COUNT + way, name_of(c, i, way)));
    }
    return ZT_OK;
}

static zt_status find_causes(comparing *c, int64_t frame) {
    zt_exposure was, is;
    zt_arena_reset(&c->frame);
    memset(c->ways, 0, (size_t)c->pairs.count * sizeof *c->ways);
    ZT_TRY(expose(&was, c->older, frame, &c->frame));
    ZT_TRY(expose(&is, c->newer, frame, &c->frame));
    ZT_TRY(compare_at(c, frame, &was, c->older));
    ZT_TRY(compare_at(c, frame, &is, c->newer));
    return blame_all(c, frame);
}

/* ---- frames --------------------------------------------------------------------------------
 */

/* What is rendered is not as the last frame that was. */
static zt_status compare_frame(comparing *c, int64_t frame, zt_hash *last) {
    zt_diff *d = c->diff;
    zt_hash was = {0}, is;
    ZT_TRY(zt_renderer_key(&is, c->newer, frame));
    bool both = frame < d->older_count;
    if (both) ZT_TRY(zt_renderer_key(&was, c->older, frame));
    if (both && zt_hash_equal(was, is)) return ZT_OK;
    if (!zt_hash_equal(is, *last)) d->frames[d->frame_count++] = frame;
    *last = is;
    if (!both) return ZT_OK;
    d->changed_count++;
    ZT_TRY(add_frame(&c->changed, frame));
    return find_causes(c, frame);
}

static zt_status compare_frames(comparing *c, const zt_watcher *watcher) {
    zt_diff *d = c->diff;
    zt_hash last = {0};
    for (int64_t frame = 0; frame < d->newer_count; frame++) {
        if (watcher && watcher->stopped && watcher->stopped(watcher->user)) return ZT_ESTOPPED;
        ZT_TRY(compare_frame(c, frame, &last));
        if (watcher && watcher->progress)
            watcher->progress(watcher->user, frame + 1, d->newer_count, frame);
    }
    return ZT_OK;
}

static zt_status prepare(comparing *c) {
    const zt_animation *older = c->older->animation, *newer = c->newer->animation;
    zt_arena *arena = &((zt_diff_memory *)c->diff)->arena;
    ZT_TRY(zt_pairs_make(&c->pairs, older, newer, arena));
    size_t slots = (size_t)c->pairs.count * ZT_WAY_COUNT + FILM_COUNT;
    c->ways = ZT_PUSH(arena, uint32_t, (size_t)c->pairs.count);
    c->causes = ZT_PUSH(arena, int32_t, slots);
    c->diff->frames = calloc((size_t)c->diff->newer_count, sizeof *c->diff->frames);
    if (!c->ways || !c->causes || !c->diff->frames) return ZT_EMEMORY;
    for (size_t i = 0; i < slots; i++) c->causes[i] = -1;
    c->film = compare_films(c->older, c->newer);
    c->diff->resettled = c->film & (1U << FILM_SIZE | 1U << FILM_SAMPLES | 1U << FILM_QUALITY |
                                    1U << FILM_SHUTTER | 1U << FILM_PRECISION);
    return ZT_OK;
}

/* Those of the same frames stand together. */
static int by_frames(const void *pa, const void *pb) {
    const zt_diff_cause *a = pa, *b = pb;
    for (int64_t i = 0; i < a->spans.count && i < b->spans.count; i++) {
        zt_frame_span one = a->spans.all[i], other = b->spans.all[i];
        if (one.first != other.first) return one.first < other.first ? -1 : 1;
        if (one.last != other.last) return one.last < other.last ? -1 : 1;
    }
    if (a->spans.count != b->spans.count) return a->spans.count < b->spans.count ? -1 : 1;
    return strcmp(a->name, b->name);
}

zt_status zt_diff_find(zt_diff **out, zt_renderer *older, zt_renderer *newer,
                       const zt_watcher *watcher) {
    zt_diff_memory *memory = calloc(1, sizeof *memory);
    *out = NULL;
    if (!memory) return ZT_EMEMORY;
    zt_diff *d = &memory->diff;
    comparing c = {.older = older, .newer = newer, .diff = d};
    d->older_count = older->animation->film.frame_count;
    d->newer_count = newer->animation->film.frame_count;
    zt_status status = prepare(&c);
    if (status == ZT_OK) status = compare_frames(&c, watcher);
    d->changed = c.changed.spans;
    for (int64_t i = 0; i < d->cause_count; i++) d->causes[i].spans = c.spans[i].spans;
    if (status == ZT_OK && d->cause_count > 0)
        qsort(d->causes, (size_t)d->cause_count, sizeof *d->causes, by_frames);
    free(c.spans);
    zt_arena_free(&c.frame);
    *out = d;
    if (status != ZT_OK) zt_diff_free(out);
    return status;
}

void zt_diff_free(zt_diff **slot) {
    if (!*slot) return;
    zt_diff *d = *slot;
    for (int64_t i = 0; i < d->cause_count; i++) free(d->causes[i].spans.all);
    free(d->causes);
    free(d->changed.all);
    free(d->frames);
    zt_arena_free(&((zt_diff_memory *)d)->arena);
    free(d);
    *slot = NULL;
}
