#include "render/reuse.h"

#include <stdlib.h>
#include <string.h>
#if defined __SSE__
#include <xmmintrin.h>
#endif

#include "base/diag.h"

/* One tile in so many must be copied for it to be worth it; twice in a row it may not be. Then
 * it rests, each time four times as long. */
enum { WORTH = 8, FRUITLESS_MAX = 2, REST_MAX = 6 };

zt_status zt_reuse_open(zt_reuse **out, bool tireless) {
    *out = calloc(1, sizeof **out);
    if (!*out) return ZT_EMEMORY;
    (*out)->tireless = tireless;
    for (int i = 0; i < ZT_REUSE_LOCKS; i++) atomic_flag_clear(&(*out)->locks[i]);
    return ZT_OK;
}

void zt_reuse_close(zt_reuse **slot) {
    zt_reuse *r = *slot;
    if (!r) return;
    zt_picture_close(&r->last);
    zt_arena_free(&r->spare);
    free(r->from);
    free(r->still);
    free(r->stamps);
    free(r);
    *slot = NULL;
}

const char *zt_reuse_hindrance(const zt_render_job *job) {
    if (!zt_render_is_even(job) && !zt_render_is_at_edges(job) && job->sampling.mean_max > 0)
        return "all pixels share so many samples: no tiles are copied from the frame before";
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
    uint8_t *from, *still;
    const zt_picture *picture;
    const zt_differences *differences;
    int tile_count;
    zt_tile_source source; /* of tiles that are not touched */
} asking;

enum { TILES = 64 }; /* of a task */

/* Which parts of a tile are not touched. Of most tiles none is, which is asked at once. */
static unsigned still_parts(const zt_footprint *parts, const zt_differences *differences) {
    zt_footprint all = parts[0];
    for (int i = 1; i < ZT_PICTURE_PARTS; i++) zt_footprint_join(&all, &parts[i]);
    if (!zt_footprint_touched(&all, differences)) return ZT_REUSE_ALL;
    unsigned still = 0;
    for (int i = 0; i < ZT_PICTURE_PARTS; i++)
        still |= (unsigned)!zt_footprint_touched(&parts[i], differences) << i;
    return still;
}

static void ask_task(void *user, int task, int worker) {
    (void)worker;
    const asking *a = user;
    int end = min_int((task + 1) * TILES, a->tile_count);
    for (int tile = task * TILES; tile < end; tile++) {
        const zt_footprint *parts = &a->picture->footprints[tile * ZT_PICTURE_PARTS];
        if (a->from[tile] != ZT_TILE_RENDERED) continue;
        unsigned still = still_parts(parts, a->differences);
        if (still == ZT_REUSE_ALL) a->from[tile] = (uint8_t)a->source;
        bool by_parts = a->source == ZT_TILE_LAST && parts[ZT_PICTURE_PARTS - 1].steps->there;
        if (by_parts) a->still[tile] = (uint8_t)still;
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
    if (f->at_edges) differences.drawn_lamps |= differences.dimmed_lamps;
    zt_reuse *r = f->job->reuse;
    asking a = {r->from, r->still, picture, &differences, f->tile_count, source};
    zt_pool_run(f->pool, (f->tile_count + TILES - 1) / TILES, ask_task, &a);
    f->copies = true;
    return ZT_OK;
}

static void forget_sources(const zt_frame *f) {
    memset(f->job->reuse->from, ZT_TILE_RENDERED, (size_t)f->tile_count);
    memset(f->job->reuse->still, 0, (size_t)f->tile_count);
}

static int64_t count_from(const zt_frame *f, zt_tile_source source) {
    int64_t count = 0;
    for (int i = 0; f->copies && i < f->tile_count; i++)
        count += f->job->reuse->from[i] == (uint8_t)source;
    return count;
}

static zt_status make_room(zt_reuse *r, const zt_frame *f) {
    zt_picture *last = &r->last;
    if (last->width != f->image->width || last->height != f->image->height) {
        uint8_t *from = realloc(r->from, (size_t)f->tile_count);
        uint8_t *still = realloc(r->still, (size_t)f->tile_count);
        uint64_t *stamps = realloc(r->stamps, (size_t)f->tile_count * sizeof *stamps);
        if (from) r->from = from;
        if (still) r->still = still;
        if (stamps) r->stamps = stamps;
        if (!from || !still || !stamps) {
            zt_picture_close(last); /* which has that many tiles no more */
            return ZT_EMEMORY;
        }
    }
    ZT_TRY(zt_picture_open(last, f->image->width, f->image->height));
    forget_sources(f);
    return ZT_OK;
}

/* The picture that was kept, where it is of the same rays. */
static zt_picture *kept_of(const zt_reuse *r, const zt_frame *f) {
    zt_picture *kept = r->kept;
    bool fits =
        kept && kept->whole && kept->at_edges == f->at_edges &&
        (!f->at_edges || (kept->rounds.negative != NULL) == zt_warp_is_signed(f->job->warp)) &&
        zt_hash_equal(kept->view, f->job->view) && kept->width == f->image->width &&
        kept->height == f->image->height;
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

/* Where samples are shared out over the picture, nothing is copied; nor where it is asked how
 * many there were. */
static bool may_keep(const zt_frame *f) {
    return f->even || f->at_edges ||
           (f->job->sampling.mean_max == 0 && !zt_image_channel(f->image, "samples") &&
            !zt_image_channel(f->image, "error"));
}

/* The rounds of pixels in tiles that are rendered, and beside them, where what is strange may
 * be known there now. */
static void forget_rounds(const zt_frame *f, zt_picture *p) {
    zt_rounds_reserve(&p->rounds, 0);
    for (int tile = 0; tile < f->tile_count; tile++) {
        if (f->job->reuse->from[tile] != ZT_TILE_RENDERED) continue;
        int left = tile % f->tile_columns * TILE_SIDE, top = tile / f->tile_columns * TILE_SIDE;
        for (int y = max_int(top - 1, 0); y <= min_int(top + TILE_SIDE, p->height - 1); y++)
            for (int x = max_int(left - 1, 0); x <= min_int(left + TILE_SIDE, p->width - 1);
                 x++)
                zt_rounds_forget(&p->rounds, x, y);
    }
}

/* What there is at edges goes on from the picture that tiles are copied from. */
static zt_status open_edges(zt_frame *f, zt_picture *last, zt_picture *kept) {
    if (kept) {
        const zt_picture before = *last;
        last->rounds = kept->rounds;
        last->paths = kept->paths;
        kept->rounds = before.rounds;
        kept->paths = before.paths;
        kept->whole = false;
    }
    if (f->copies)
        forget_rounds(f, last);
    else
        ZT_TRY(zt_picture_open_edges(last, zt_warp_is_signed(f->job->warp)));
    f->paths = last->paths;
    f->rounds = &last->rounds;
    return ZT_OK;
}

/* What goes from pixel to pixel must not do so from one picture to another: so where it may,
 * *kept becomes NULL where more tiles can come from the last frame, which else is not tried. */
static zt_status ask_both(zt_frame *f, zt_picture **kept, const zt_outline *now) {
    zt_reuse *r = f->job->reuse;
    if (f->tries) ZT_TRY(ask(f, &r->last, ZT_TILE_LAST, now, &r->spare));
    if (!*kept) return ZT_OK;
    const int64_t from_last = count_from(f, ZT_TILE_LAST);
    if (!f->even) forget_sources(f);
    ZT_TRY(ask(f, *kept, ZT_TILE_KEPT, now, &r->spare));
    if (f->even) return ZT_OK;
    f->tries = count_from(f, ZT_TILE_KEPT) < from_last;
    if (!f->tries) return ZT_OK;
    *kept = NULL;
    forget_sources(f);
    return ask(f, &r->last, ZT_TILE_LAST, now, &r->spare);
}

zt_status zt_reuse_begin(zt_frame *f) {
    zt_reuse *r = f->job->reuse;
    f->rounds = NULL;
    f->keeps = f->copies = f->tries = false;
    if (!r) return ZT_OK;
    zt_outline now;
    zt_picture *last = &r->last;
    zt_picture *kept = kept_of(r, f);
    bool alone = !f->even && r->alone > 0;
    if (alone) r->alone--;
    if (alone || !may_keep(f)) {
        last->whole = false;
        return ZT_OK;
    }
    bool asks_last = may_ask_last(r, f->job->view);
    bool whole = last->whole && last->at_edges == f->at_edges;
    bool takes = asks_last || kept || r->keeps;
    if (takes) ZT_TRY(make_room(r, f));
    last->view = f->job->view;
    last->whole = false; /* until it is done */
    if (!takes) return ZT_OK;
    zt_arena_reset(&r->spare);
    ZT_TRY(zt_outline_make(&now, f->job->scene, &r->spare));
    f->tries = asks_last && whole;
    ZT_TRY(ask_both(f, &kept, &now));
    last->at_edges = f->at_edges;
    if (f->at_edges) ZT_TRY(open_edges(f, last, kept));
    zt_arena before = last->arena;
    last->arena = r->spare;
    r->spare = before;
    last->outline = now;
    last->frame_key = f->job->frame_key;
    f->keeps = true;
    return ZT_OK;
}

void zt_reuse_renounce(zt_frame *f) {
    zt_reuse *r = f->job->reuse;
    f->keeps = f->copies = false;
    f->doubtful = false;
    f->rounds = NULL;
    if (!r->tireless) r->alone = 1 << REST_MAX;
    for (int i = 0; i < zt_pool_thread_count(f->pool); i++) {
        zt_render_count *count = &f->work->threads[i].count;
        count->left_out = count->rays.primary_avoided = 0;
    }
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
    r->rest = 1 << min_int(2 * (r->fruitless - 1), REST_MAX);
}

/* ---- where pixels take as many samples as they ask for --------------------------------------
 */

static int gap(int at, int first) {
    return at < first ? first - at : max_int(at - (first + TILE_SIDE - 1), 0);
}

int zt_reuse_distance(const zt_frame *f, int x, int y, int most) {
    const uint8_t *from = f->job->reuse->from;
    int nearest = most + 1, rows = f->tile_count / f->tile_columns;
    if (from[y / TILE_SIDE * f->tile_columns + x / TILE_SIDE] == ZT_TILE_RENDERED) return 0;
    for (int row = max_int((y - most) / TILE_SIDE, 0);
         row <= min_int((y + most) / TILE_SIDE, rows - 1); row++)
        for (int column = max_int((x - most) / TILE_SIDE, 0);
             column <= min_int((x + most) / TILE_SIDE, f->tile_columns - 1); column++)
            if (from[row * f->tile_columns + column] == ZT_TILE_RENDERED)
                nearest = min_int(nearest,
                                  max_int(gap(x, column * TILE_SIDE), gap(y, row * TILE_SIDE)));
    return nearest;
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
        memcpy(zt_reuse_footprint(r, tile, 0), &from->footprints[tile * ZT_PICTURE_PARTS],
               ZT_PICTURE_PARTS * sizeof *from->footprints);
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

void zt_reuse_copy_parts(zt_frame *f, int tile, int left, int top) {
    const zt_reuse *r = f->job->reuse;
    const uint64_t *stamps = f->image->stamps;
    if (stamps && stamps[tile] == r->stamps[tile]) return;
    for (int y = 0; y < TILE_SIDE; y++)
        for (int half = 0; half < 2; half++) {
            if (!(r->still[tile] >> (y / ZT_REUSE_SIDE * 2 + half) & 1)) continue;
            size_t at = place_of(f, left + half * ZT_REUSE_SIDE, top + y);
            stream(f->image->pixels + at, r->last.pixels + at, ZT_REUSE_SIDE);
        }
}

void zt_reuse_stamp(zt_frame *f, int tile) {
    f->job->reuse->stamps[tile] = f->serial;
    if (f->image->stamps) f->image->stamps[tile] = f->serial;
}

/* Whether a tile came out as it was in the last frame. */
static bool came_out_same(const zt_frame *f, int left, int top, int width, int height) {
    bool same = f->tries && f->even;
    for (int y = top; y < top + height && same; y++) {
        size_t at = place_of(f, left, y);
        same = memcmp(f->job->reuse->last.pixels + at, f->image->pixels + at,
                      4 * (size_t)width * sizeof(float)) == 0;
    }
    return same;
}

void zt_reuse_keep(zt_frame *f, int tile, int left, int top, int width, int height) {
    if (came_out_same(f, left, top, width, height)) {
        if (f->image->stamps) f->image->stamps[tile] = f->job->reuse->stamps[tile];
        return;
    }
    zt_reuse_stamp(f, tile);
    for (int y = top; y < top + height; y++) {
        size_t at = place_of(f, left, y);
        memcpy(f->job->reuse->last.pixels + at, f->image->pixels + at,
               4 * (size_t)width * sizeof(float));
    }
}
