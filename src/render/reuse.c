#include "render/reuse.h"

#include <stdlib.h>
#include <string.h>
#if defined __SSE__
#include <xmmintrin.h>
#endif

#include "base/diag.h"

/* One tile in so many must be copied for it to be worth it; twice in a row it may not be. Then
 * it rests, each time twice as long. */
enum { WORTH = 8, FRUITLESS_MAX = 2, REST_MAX = 6 };

zt_status zt_reuse_open(zt_reuse **out, bool tireless) {
    *out = calloc(1, sizeof **out);
    if (!*out) return ZT_EMEMORY;
    (*out)->tireless = tireless;
    return ZT_OK;
}

void zt_picture_close(zt_picture *p) {
    free(p->pixels);
    free(p->footprints);
    zt_arena_free(&p->arena);
    *p = (zt_picture){0};
}

zt_status zt_picture_open(zt_picture *p, int width, int height) {
    if (p->width == width && p->height == height) return ZT_OK;
    zt_picture_close(p);
    p->pixels = calloc(4 * (size_t)width * (size_t)height, sizeof *p->pixels);
    p->footprints =
        calloc((size_t)zt_tile_count(width, height) * ZT_REUSE_PARTS, sizeof *p->footprints);
    if (!p->pixels || !p->footprints) {
        zt_picture_close(p);
        return ZT_EMEMORY;
    }
    p->width = width;
    p->height = height;
    return ZT_OK;
}

void zt_reuse_close(zt_reuse **slot) {
    zt_reuse *r = *slot;
    if (!r) return;
    zt_picture_close(&r->last);
    zt_arena_free(&r->spare);
    free(r->from);
    free(r->stamps);
    free(r);
    *slot = NULL;
}

const char *zt_reuse_hindrance(const zt_render_job *job) {
    if (!zt_render_is_even(job))
        return "samples go where neighbors differ: no tiles are copied from the frame before";
    if (job->sampling.seed_fixed) return NULL;
    if (zt_lens_moves(job->lens))
        return "the camera moves while the shutter is open: no tiles are copied from the frame "
               "before";
    if (zt_lens_has_aperture(job->lens))
        return "each frame looks through other points of the lens: no tiles are copied from "
               "the frame before, but with a fixed seed";
    if (job->scene->random)
        return "each frame looks at other points of lamps with a size: tiles that face them "
               "are not copied from the frame before, but with a fixed seed";
    return NULL;
}

/* ---- what is copied -------------------------------------------------------------------------
 */

typedef struct asking {
    uint8_t *from;
    const zt_picture *picture;
    const zt_differences *differences;
    int tile_count;
    zt_tile_source source; /* of tiles that are not touched */
} asking;

enum { TILES = 64 }; /* of a task */

static void ask_task(void *user, int task, int worker) {
    (void)worker;
    const asking *a = user;
    int end = min_int((task + 1) * TILES, a->tile_count);
    for (int tile = task * TILES; tile < end; tile++) {
        const zt_footprint *parts = &a->picture->footprints[tile * ZT_REUSE_PARTS];
        bool touched = a->from[tile] != ZT_TILE_RENDERED;
        for (int i = 0; i < ZT_REUSE_PARTS && !touched; i++)
            touched = zt_footprint_touched(&parts[i], a->differences);
        if (!touched) a->from[tile] = (uint8_t)a->source;
    }
}

/* Whether all samples' times or places in the lens have changed. */
static bool other_rays(const zt_render_job *job, bool same_numbers) {
    return !same_numbers && (zt_lens_has_aperture(job->lens) || zt_lens_moves(job->lens));
}

/* Has those tiles that come from nowhere else come from a picture, where they can. */
static zt_status ask(zt_frame *f, const zt_picture *picture, zt_tile_source source,
                     const zt_outline *now, zt_arena *arena) {
    bool same_numbers = picture->frame_key == f->job->frame_key;
    zt_differences differences;
    ZT_TRY(zt_differences_find(&differences, &picture->outline, now, same_numbers, arena));
    if (differences.all || other_rays(f->job, same_numbers)) return ZT_OK;
    asking a = {f->job->reuse->from, picture, &differences, f->tile_count, source};
    zt_pool_run(f->pool, (f->tile_count + TILES - 1) / TILES, ask_task, &a);
    f->copies = true;
    return ZT_OK;
}

static zt_status make_room(zt_reuse *r, const zt_frame *f) {
    zt_picture *last = &r->last;
    if (last->width != f->image->width || last->height != f->image->height) {
        uint8_t *from = realloc(r->from, (size_t)f->tile_count);
        uint64_t *stamps = realloc(r->stamps, (size_t)f->tile_count * sizeof *stamps);
        if (from) r->from = from;
        if (stamps) r->stamps = stamps;
        if (!from || !stamps) return ZT_EMEMORY;
    }
    ZT_TRY(zt_picture_open(last, f->image->width, f->image->height));
    memset(r->from, ZT_TILE_RENDERED, (size_t)f->tile_count);
    return ZT_OK;
}

/* The picture that was kept, where it is of the same rays. */
static const zt_picture *kept_of(const zt_reuse *r, const zt_frame *f) {
    const zt_picture *kept = r->kept;
    bool fits = kept && kept->whole && zt_hash_equal(kept->view, f->job->view) &&
                kept->width == f->image->width && kept->height == f->image->height;
    return fits ? kept : NULL;
}

/* Whether the last frame may be asked: the camera stands still, and it does not rest. */
static bool may_ask_last(zt_reuse *r, zt_hash view) {
    bool still = zt_hash_equal(view, r->last.view);
    if (!still) {
        r->last.whole = false;
        r->fruitless = r->rest = 0;
    } else if (r->rest > 0) {
        r->rest--;
        return false;
    }
    return still;
}

zt_status zt_reuse_begin(zt_frame *f) {
    zt_reuse *r = f->job->reuse;
    f->keeps = f->copies = f->tries = false;
    if (!r) return ZT_OK;
    zt_outline now;
    zt_picture *last = &r->last;
    const zt_picture *kept = kept_of(r, f);
    bool asks_last = may_ask_last(r, f->job->view), whole = last->whole;
    bool takes = asks_last || kept || r->keeps;
    if (takes) ZT_TRY(make_room(r, f));
    last->view = f->job->view;
    last->whole = false; /* until it is done */
    if (!takes) return ZT_OK;
    zt_arena_reset(&r->spare);
    ZT_TRY(zt_outline_make(&now, f->job->scene, &r->spare));
    f->tries = asks_last && whole;
    if (f->tries) ZT_TRY(ask(f, last, ZT_TILE_LAST, &now, &r->spare));
    if (kept) ZT_TRY(ask(f, kept, ZT_TILE_KEPT, &now, &r->spare));
    zt_arena before = last->arena;
    last->arena = r->spare;
    r->spare = before;
    last->outline = now;
    last->frame_key = f->job->frame_key;
    f->keeps = true;
    return ZT_OK;
}

static int64_t count_from(const zt_frame *f, zt_tile_source source) {
    int64_t count = 0;
    for (int i = 0; f->copies && i < f->tile_count; i++)
        count += f->job->reuse->from[i] == (uint8_t)source;
    return count;
}

void zt_reuse_end(zt_frame *f, bool done) {
    zt_reuse *r = f->job->reuse;
    if (!f->keeps) return;
    r->last.whole = done;
    if (!done) return;
    int64_t last = count_from(f, ZT_TILE_LAST);
    f->tiles_kept = count_from(f, ZT_TILE_KEPT);
    f->tiles_copied = last + f->tiles_kept;
    if (!f->tries) return;
    bool worth = last * WORTH >= f->tile_count;
    r->fruitless = worth ? 0 : r->fruitless + 1;
    if (r->tireless || r->fruitless < FRUITLESS_MAX) return;
    r->rest = 1 << min_int(r->fruitless, REST_MAX);
}

/* ---- pixels ---------------------------------------------------------------------------------
 */

/* Pixels, past the caches, as rendered ones are written (render/render.c): both of what is read
 * and of what is written there is more than fits there. */
static void stream(float *to, const float *from, int count) {
#if defined __SSE__
    for (int i = 0; i < count; i++) _mm_stream_ps(to + 4 * i, _mm_loadu_ps(from + 4 * i));
#else
    memcpy(to, from, 4 * (size_t)count * sizeof *to);
#endif
}

static size_t place_of(const zt_frame *f, int left, int y) {
    return 4 * ((size_t)y * (size_t)f->image->width + (size_t)left);
}

void zt_reuse_copy(zt_frame *f, int tile, int left, int top, int width, int height) {
    const zt_reuse *r = f->job->reuse;
    const zt_picture *last = &r->last, *from = last;
    uint64_t *stamps = f->image->stamps;
    if (r->from[tile] == ZT_TILE_KEPT) {
        r->stamps[tile] = f->serial;
        from = r->kept;
        memcpy(zt_reuse_footprint(r, tile, 0), &from->footprints[tile * ZT_REUSE_PARTS],
               ZT_REUSE_PARTS * sizeof *from->footprints);
    }
    if (stamps && stamps[tile] == r->stamps[tile]) return;
    if (stamps) stamps[tile] = r->stamps[tile];
    for (int y = top; y < top + height; y++) {
        size_t at = place_of(f, left, y);
        stream(f->image->pixels + at, from->pixels + at, width);
        if (from != last)
            memcpy(last->pixels + at, from->pixels + at, 4 * (size_t)width * sizeof(float));
    }
}

void zt_reuse_keep(zt_frame *f, int tile, int left, int top, int width, int height) {
    f->job->reuse->stamps[tile] = f->serial;
    for (int y = top; y < top + height; y++) {
        size_t at = place_of(f, left, y);
        memcpy(f->job->reuse->last.pixels + at, f->image->pixels + at,
               4 * (size_t)width * sizeof(float));
    }
}
