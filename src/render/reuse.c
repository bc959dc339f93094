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

static void free_picture(zt_reuse *r) {
    free(r->pixels);
    free(r->footprints);
    free(r->touched);
    r->pixels = NULL;
    r->footprints = NULL;
    r->touched = NULL;
    r->width = r->height = 0;
}

void zt_reuse_close(zt_reuse **slot) {
    zt_reuse *r = *slot;
    if (!r) return;
    free_picture(r);
    zt_arena_free(&r->arenas[0]);
    zt_arena_free(&r->arenas[1]);
    free(r);
    *slot = NULL;
}

static zt_status make_room(zt_reuse *r, const zt_frame *f) {
    int width = f->image->width, height = f->image->height;
    if (r->width == width && r->height == height) return ZT_OK;
    size_t pixels = (size_t)width * (size_t)height, tiles = (size_t)f->tile_count;
    free_picture(r);
    r->pixels = calloc(4 * pixels, sizeof *r->pixels);
    r->footprints = calloc(tiles * ZT_REUSE_PARTS, sizeof *r->footprints);
    r->touched = calloc(tiles, sizeof *r->touched);
    if (!r->pixels || !r->footprints || !r->touched) {
        free_picture(r);
        return ZT_EMEMORY;
    }
    r->width = width;
    r->height = height;
    return ZT_OK;
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
    zt_reuse *reuse;
    const zt_differences *differences;
    int tile_count;
} asking;

enum { TILES = 64 }; /* of a task */

static void ask_task(void *user, int task, int worker) {
    (void)worker;
    const asking *a = user;
    int end = min_int((task + 1) * TILES, a->tile_count);
    for (int tile = task * TILES; tile < end; tile++) {
        const zt_footprint *parts = zt_reuse_footprint(a->reuse, tile, 0);
        bool touched = false;
        for (int i = 0; i < ZT_REUSE_PARTS && !touched; i++)
            touched = zt_footprint_touched(&parts[i], a->differences);
        a->reuse->touched[tile] = touched;
    }
}

/* Whether all samples' times or places in the lens have changed. */
static bool other_rays(const zt_render_job *job, bool same_numbers) {
    return !same_numbers && (zt_lens_has_aperture(job->lens) || zt_lens_moves(job->lens));
}

static zt_status find_touched(zt_frame *f, const zt_outline *before, const zt_outline *now,
                              zt_arena *arena) {
    zt_reuse *r = f->job->reuse;
    bool same_numbers = r->frame_key == f->job->frame_key;
    zt_differences differences;
    ZT_TRY(zt_differences_find(&differences, before, now, same_numbers, arena));
    if (differences.all || other_rays(f->job, same_numbers)) return ZT_OK;
    asking a = {r, &differences, f->tile_count};
    zt_pool_run(f->pool, (f->tile_count + TILES - 1) / TILES, ask_task, &a);
    f->copies = true;
    return ZT_OK;
}

zt_status zt_reuse_begin(zt_frame *f) {
    zt_reuse *r = f->job->reuse;
    f->keeps = f->copies = false;
    if (!r) return ZT_OK;
    zt_hash view = f->job->view;
    bool still = zt_hash_equal(view, r->view);
    r->view = view;
    if (!still) {
        r->whole = false;
        r->fruitless = r->rest = 0;
        return ZT_OK;
    }
    if (r->rest > 0) {
        r->rest--;
        return ZT_OK;
    }
    ZT_TRY(make_room(r, f));
    int now = 1 - r->last;
    zt_arena_reset(&r->arenas[now]);
    ZT_TRY(zt_outline_make(&r->outlines[now], f->job->scene, &r->arenas[now]));
    if (r->whole)
        ZT_TRY(find_touched(f, &r->outlines[r->last], &r->outlines[now], &r->arenas[now]));
    f->keeps = true;
    f->tries = r->whole;
    r->whole = false; /* until it is done */
    r->last = now;
    r->frame_key = f->job->frame_key;
    return ZT_OK;
}

static int64_t count_copied(const zt_frame *f) {
    int64_t copied = 0;
    for (int i = 0; f->copies && i < f->tile_count; i++) copied += !f->job->reuse->touched[i];
    return copied;
}

void zt_reuse_end(zt_frame *f, bool done) {
    zt_reuse *r = f->job->reuse;
    if (!f->keeps) return;
    r->whole = done;
    if (!f->tries) return;
    f->tiles_copied = done ? count_copied(f) : 0;
    bool worth = f->tiles_copied * WORTH >= f->tile_count;
    r->fruitless = worth ? 0 : r->fruitless + 1;
    if (r->tireless || r->fruitless < FRUITLESS_MAX) return;
    r->rest = 1 << min_int(r->fruitless, REST_MAX);
    r->whole = false;
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

void zt_reuse_copy(zt_frame *f, int left, int top, int width, int height) {
    for (int y = top; y < top + height; y++) {
        size_t at = 4 * ((size_t)y * (size_t)f->image->width + (size_t)left);
        stream(f->image->pixels + at, f->job->reuse->pixels + at, width);
    }
}

void zt_reuse_keep(zt_frame *f, int left, int top, int width, int height) {
    for (int y = top; y < top + height; y++) {
        size_t at = 4 * ((size_t)y * (size_t)f->image->width + (size_t)left);
        memcpy(f->job->reuse->pixels + at, f->image->pixels + at,
               4 * (size_t)width * sizeof(float));
    }
}
