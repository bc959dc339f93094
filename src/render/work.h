/* A frame under way: what its threads work with, and what they share. */
#ifndef ZT_RENDER_WORK_H
#define ZT_RENDER_WORK_H

#include <assert.h>
#include <stdatomic.h>

#include "image/stamps.h"
#include "render/canvas.h"
#include "render/render.h"
#include "render/samples.h"
#include "tracer/footprint.h"

/* A tile is a batch. */
enum { TILE_SIDE = 16 };
static_assert(TILE_SIDE * TILE_SIDE == ZT_BATCH, "a tile is a batch");
static_assert(TILE_SIDE == (int)ZT_STAMP_SIDE, "a tile has a stamp");

/* What one thread works with; its contents mean nothing between calls, but for the count, which
 * is the frame's. */
typedef struct zt_render_thread {
    /* The pixels of a block, and what their samples add up to. */
    alignas(64) int32_t column[ZT_BATCH];
    alignas(64) int32_t row[ZT_BATCH];
    zt_radiance sum;
    alignas(64) int32_t taken[ZT_BATCH]; /* samples in the sum */
    zt_places places;
    zt_rays rays;
    zt_radiance light;
    zt_canvas_sums sums;
    void *kernel; /* what it works with */
    bool bare; /* the last rays met nothing; or there were none before in this run of tiles */
    zt_render_count count;
} zt_render_thread;

struct zt_render_work {
    int32_t column[ZT_BATCH], row[ZT_BATCH]; /* of each pixel within a tile */
    zt_render_thread *threads;
    zt_canvas canvas;
    zt_arena arena; /* of one picture after the other */
};

typedef struct zt_frame {
    zt_image *image;
    const zt_render_job *job;
    zt_render_work *work;
    zt_pool *pool;
    int tile_columns, tile_count;
    uint64_t serial; /* its new tiles' stamp; 0: nothing is known of them */
    int run;         /* tiles that a thread takes at a time */
    bool even;       /* as many samples in each pixel, which follow from nothing else; */
    /* Of at_edges: a plane of what the middles of pixels saw, and what they tell things by. */
    uint32_t *paths;
    zt_labels labels;
    zt_trace *trace; /* the kernel without what this frame does not ask for */
    bool costly;     /* rays look into hierarchies, and cost more than what else batches do */
    bool at_edges; /* or first one sample in the middle of each pixel, then more at edges alone
                    */
    /* Of the job's reuse: it takes down what is rendered; could copy; does so. */
    bool keeps, tries, copies;
    struct zt_rounds *rounds; /* where they are kept, else NULL */
    atomic_bool doubtful;     /* samples of pixels may depend on which share their batch */
    int64_t tiles_copied, tiles_kept; /* the latter are among the former */
    atomic_bool stopped;
} zt_frame;

static inline int zt_tile_columns(int width) { return (width + TILE_SIDE - 1) / TILE_SIDE; }
static inline int zt_tile_count(int width, int height) {
    return zt_tile_columns(width) * zt_tile_columns(height);
}

static inline int min_int(int a, int b) { return a < b ? a : b; }
static inline int max_int(int a, int b) { return a > b ? a : b; }

/* Traces `now` samples of each of `count` pixels, of which places and light lie one sample of
 * all pixels after the other. Where rays cost much, or have few others nearby, the samples of
 * each pixel travel side by side (render/trace.c). Returns false where no ray met anything: all
 * light is 0. */
bool zt_frame_trace(zt_frame *f, zt_render_thread *own, int count, int now);

/* Whether somebody asked to stop. */
static inline bool zt_frame_stopped(zt_frame *f) {
    if (atomic_load_explicit(&f->stopped, memory_order_relaxed)) return true;
    if (!f->job->stopped || !f->job->stopped(f->job->user)) return false;
    atomic_store_explicit(&f->stopped, true, memory_order_relaxed);
    return true;
}

/* Infinities and NaN, alone of all numbers, are not 0 when taken from themselves. */
static inline bool zt_finite3(float r, float g, float b) {
    return (r - r) + (g - g) + (b - b) == 0;
}

#endif
