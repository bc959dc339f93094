/* The pixels of tiles, and the frame as a whole. */
#include "render/render.h"

#include <string.h>
#if defined __SSE__
#include <xmmintrin.h>
#endif

#include "base/diag.h"
#include "render/edges.h"
#include "render/pixels.h"
#include "render/refine.h"
#include "render/reuse.h"
#include "render/work.h"
#include "tracer/isa.h"

/* The pixels of a tile: columns x .. x + width - 1, rows y .. y + height - 1. */
typedef struct tile {
    int x, y, width, height;
} tile;

/* The pixels of a tile in blocks of 4 x 4, row by row, and these in the order of Morton's
 * curve, so that each run of 16 or 64 pixels is a square, and rays that travel in one packet
 * are close together in both directions. */
static void order_pixels(zt_render_work *work) {
    for (int i = 0; i < ZT_BATCH; i++) {
        int block = i / 16, within = i % 16;
        work->column[i] = 4 * ((block & 1) | (block >> 1 & 2)) + within % 4;
        work->row[i] = 4 * ((block >> 1 & 1) | (block >> 2 & 2)) + within / 4;
    }
}

zt_status zt_render_work_push(zt_render_work **out, zt_arena *arena, int thread_count) {
    zt_render_work *work = ZT_PUSH(arena, zt_render_work, 1);
    if (!work) return ZT_EMEMORY;
    order_pixels(work);
    work->threads = ZT_PUSH(arena, zt_render_thread, (size_t)thread_count);
    if (!work->threads) return ZT_EMEMORY;
    for (int i = 0; i < thread_count; i++) {
        work->threads[i].kernel = zt_arena_push(arena, zt_kernel_work_size());
        if (!work->threads[i].kernel) return ZT_EMEMORY;
    }
    *out = work;
    return ZT_OK;
}

void zt_render_work_close(zt_render_work *work) {
    if (!work) return;
    zt_canvas_close(&work->canvas);
    zt_arena_free(&work->arena);
}

/* Lists pixels first … first + most - 1 of a tile; those beyond the edge of the picture are
 * left out. */
static int list_pixels(zt_render_thread *own, const zt_frame *f, tile area, int first,
                       int most) {
    const zt_render_work *work = f->work;
    const zt_render_job *job = f->job;
    int32_t *restrict column = own->column, *restrict row = own->row;
    int count = most;
    if (area.width == TILE_SIDE && area.height == TILE_SIDE) {
        for (int i = 0; i < most; i++) {
            column[i] = area.x + work->column[first + i];
            row[i] = area.y + work->row[first + i];
        }
    } else {
        count = 0;
        for (int i = first; i < first + most; i++) {
            column[count] = area.x + work->column[i];
            row[count] = area.y + work->row[i];
            count += work->column[i] < area.width && work->row[i] < area.height;
        }
    }
    bool keys = job->sampling.max > 1 || job->scene->moves || job->scene->random ||
                zt_lens_has_aperture(job->lens) || zt_lens_moves(job->lens);
    if (keys && !f->at_edges) zt_samples_key(&own->places, job, column, row, count);
    return count;
}

/* All samples of some pixels, as many of each in a batch as there is room for. */
static bool sum_samples(zt_frame *f, zt_render_thread *own, int count) {
    const zt_render_job *job = f->job;
    int samples = job->sampling.max, together = ZT_BATCH / count;
    int bare = 0; /* samples of which it is known that they are black and finite */
    memset(&own->sum, 0, offsetof(zt_radiance, path));
    memset(own->taken, 0, sizeof own->taken);
    if (job->transparent) memset(own->sum.a, 0, sizeof own->sum.a);
    for (int done = 0; done < samples; done += together) {
        if (job->stopped && job->stopped(job->user)) return false;
        int now = min_int(together, samples - done);
        for (int k = 0; k < now; k++)
            zt_samples_take(&own->places, &own->rays, job, own->column, own->row, k * count,
                            count, done + k);
        bool met = zt_frame_trace(f, own, count, now);
        for (int k = 0; met && k < now; k++)
            own->count.left_out += zt_pixels_add(&own->sum, own->taken, &own->light, k * count,
                                                 count, job->transparent);
        bare += met ? 0 : now;
    }
    for (int i = 0; bare > 0 && i < count; i++) own->taken[i] += bare;
    zt_pixels_average(&own->sum, own->taken, count, job->transparent);
    return true;
}

/* One sample of some pixels, in their middle. */
static bool take_middles(zt_frame *f, zt_render_thread *own, int count) {
    const zt_render_job *job = f->job;
    if (job->stopped && job->stopped(job->user)) return false;
    zt_samples_take(&own->places, &own->rays, job, own->column, own->row, 0, count,
                    ZT_SAMPLE_MIDDLE);
    zt_frame_trace(f, own, count, 1);
    own->count.left_out += zt_pixels_settle(&own->light, count, job->transparent);
    return true;
}

/* Some pixels of a tile. */
static bool render_block(zt_frame *f, zt_render_thread *own, tile area, int first, int most) {
    const zt_render_job *job = f->job;
    const bool single = f->at_edges || job->sampling.max == 1;
    int count = list_pixels(own, f, area, first, most);
    if (count == 0) return true;
    own->rays.labels = f->at_edges ? &f->labels : NULL;
    own->rays.wants_cover = job->transparent;
    if (!(single ? take_middles : sum_samples)(f, own, count)) return false;
    zt_pixels_fill(f->image->pixels, f->image->width, single ? &own->light : &own->sum,
                   own->column, own->row, count,
                   count == most && !f->keeps); /* what is kept is read again */
    if (f->at_edges)
        zt_pixels_fill_paths(f->paths, f->image->width, own->light.path, own->column, own->row,
                             count, count == most);
    return true;
}

/* How many pixels share a batch: the more samples each takes, the fewer, so that the rays of a
 * batch stay close together. Blocks of a tile are squares of these many pixels. */
static int block_size(int samples) { return samples >= 16 ? 16 : samples >= 4 ? 64 : ZT_BATCH; }

/* The pixels from `first` to `end` of a tile, and what their rays touch. */
static bool render_blocks(zt_frame *f, zt_render_thread *own, tile area, int index, int first,
                          int end, int most) {
    bool done = true;
    for (; first < end && done; first += most) {
        int64_t left_out = own->count.left_out;
        if (f->keeps)
            zt_reuse_watch(&own->rays, zt_reuse_footprint(f->job->reuse, index, first), f);
        done = render_block(f, own, area, first, most);
        /* What is left out is told in each frame. */
        if (f->keeps && own->count.left_out > left_out) own->rays.footprint->restless = true;
    }
    own->rays.footprint = NULL;
    return done;
}

/* Whether tiles that were touched are rendered by quarters: where batches are no larger anyway,
 * or rays cost more than batches do. */
static bool has_parts(const zt_frame *f, tile area) {
    return f->copies && f->even && area.width == TILE_SIDE && area.height == TILE_SIDE &&
           (f->costly || block_size(f->job->sampling.max) <= ZT_REUSE_PIXELS);
}

/* A tile of which parts may be copied: sets `rendered` where that is all it takes. */
static bool render_parts(bool *rendered, zt_frame *f, zt_render_thread *own, tile area,
                         int index) {
    zt_reuse *r = f->job->reuse;
    zt_footprint *footprints = zt_reuse_footprint(r, index, 0);
    int size = block_size(f->job->sampling.max), most = min_int(size, ZT_REUSE_PIXELS);
    const int64_t left_out = own->count.left_out;
    int64_t avoided = 0;
    bool doubtful = false;
    zt_reuse_copy_parts(f, index, area.x, area.y);
    for (int part = 0; part < ZT_PICTURE_PARTS; part++) {
        if (!(r->still[index] >> part & 1)) {
            footprints[part] = (zt_footprint){0};
            int first = part * ZT_REUSE_PIXELS;
            if (!render_blocks(f, own, area, index, first, first + ZT_REUSE_PIXELS, most))
                return false;
            zt_reuse_keep(f, index, area.x + part % 2 * ZT_REUSE_SIDE,
                          area.y + part / 2 * ZT_REUSE_SIDE, ZT_REUSE_SIDE, ZT_REUSE_SIDE);
        } else {
            avoided += (int64_t)ZT_REUSE_PIXELS * f->job->sampling.max;
        }
        doubtful |= footprints[part].doubtful;
    }
    /* Then it may make a difference which rays share a batch. */
    *rendered = size == most || !doubtful;
    if (*rendered)
        own->count.rays.primary_avoided += avoided;
    else
        own->count.left_out = left_out;
    return true;
}

/* Whether it is known beforehand that no ray of a tile meets anything; asked where there is
 * nothing beside it either. */
static bool is_bare(const zt_frame *f, const zt_render_thread *own, tile area) {
    const zt_ready *scene = f->job->scene;
    vec3 low, high;
    return own->bare && f->even && scene->plain && !f->keeps && !f->job->warp &&
           zt_lens_bounds(&low, &high, f->job->lens, area.x, area.y, area.x + area.width,
                          area.y + area.height) &&
           !scene->kernel->may_meet(scene->tracer, low, high);
}

/* A tile of which that is so: its samples need not be taken. */
static void fill_bare(zt_frame *f, zt_render_thread *own, tile area) {
    const int64_t samples = (int64_t)area.width * area.height * f->job->sampling.max;
    const int64_t batches = (samples + ZT_BATCH - 1) / ZT_BATCH;
    for (int y = area.y; y < area.y + area.height; y++)
        zt_pixels_clear(f->image->pixels +
                            4 * ((size_t)y * (size_t)f->image->width + (size_t)area.x),
                        area.width, f->job->transparent);
    own->count.samples += samples;
    own->count.rays.primary_avoided += samples;
    own->count.rays.batches += batches;
    own->count.rays.bare_batches += batches;
}

static bool render_tile(zt_frame *f, int index, int worker) {
    int x = index % f->tile_columns * TILE_SIDE, y = index / f->tile_columns * TILE_SIDE;
    tile area = {x, y, min_int(TILE_SIDE, f->image->width - x),
                 min_int(TILE_SIDE, f->image->height - y)};
    int most = f->at_edges ? ZT_BATCH : block_size(f->job->sampling.max);
    zt_render_thread *own = &f->work->threads[worker];
    if (f->copies && f->job->reuse->from[index] != ZT_TILE_RENDERED) {
        zt_reuse_copy(f, index, x, y, area.width, area.height);
        if (f->even || f->at_edges)
            own->count.rays.primary_avoided +=
                (int64_t)area.width * area.height * (f->even ? f->job->sampling.max : 1);
        return true;
    }
    bool rendered = false;
    if (has_parts(f, area) && (!render_parts(&rendered, f, own, area, index) || rendered))
        return rendered;
    if (f->keeps)
        memset(zt_reuse_footprint(f->job->reuse, index, 0), 0,
               ZT_PICTURE_PARTS * sizeof(zt_footprint));
    if (f->image->stamps) f->image->stamps[index] = f->serial;
    if (!f->even && !f->at_edges) { /* its samples are taken later */
        zt_reuse_stamp(f, index);
        return true;
    }
    if (is_bare(f, own, area)) {
        fill_bare(f, own, area);
        return true;
    }
    bool done = render_blocks(f, own, area, index, 0, ZT_BATCH, most);
    if (f->keeps && done) zt_reuse_keep(f, index, x, y, area.width, area.height);
    return done;
}

static void render_run(void *user, int index, int worker) {
    zt_frame *f = user;
    int end = min_int((index + 1) * f->run, f->tile_count);
    f->work->threads[worker].bare = true;
    for (int tile = index * f->run; tile < end; tile++) {
        if (atomic_load_explicit(&f->stopped, memory_order_relaxed)) return;
        if (!render_tile(f, tile, worker))
            atomic_store_explicit(&f->stopped, true, memory_order_relaxed);
    }
#if defined __SSE__
    _mm_sfence(); /* others see what went past the caches */
#endif
}

/* How many tiles side by side a thread takes at a time: two that write next to each other slow
 * each other down, so as many as leave enough to share out to the end. */
static int run_length(int tile_count, int thread_count) {
    enum { RUN_MAX = 16, RUNS = 32 };
    int length = tile_count / (thread_count * RUNS);
    return length < 1 ? 1 : min_int(length, RUN_MAX);
}

static bool render_tiles(zt_frame *f) {
    zt_pool_run(f->pool, (f->tile_count + f->run - 1) / f->run, render_run, f);
    return !f->stopped;
}

/* Of as many samples in each pixel. */
static void fill_channels(zt_image *image, const zt_sampling *sampling) {
    float *samples = zt_image_channel(image, "samples"),
          *error = zt_image_channel(image, "error");
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; samples && i < count; i++) samples[i] = (float)sampling->max;
    for (size_t i = 0; error && i < count; i++) error[i] = -1;
}

/* As many samples in each pixel, or wherever they are wanted. */
static zt_status render_once(zt_frame *f) {
    if (f->even) return render_tiles(f) ? ZT_OK : ZT_ESTOPPED;
    ZT_TRY(zt_canvas_open(&f->work->canvas, f->image->width, f->image->height,
                          zt_warp_is_signed(f->job->warp)));
    if (!f->keeps) f->paths = f->work->canvas.path;
    if (!f->keeps || f->at_edges) zt_image_forget_stamps(f->image);
    if ((f->at_edges || f->keeps) && !render_tiles(f)) return ZT_ESTOPPED;
    if (f->at_edges)
        zt_edges_find(f);
    else
        zt_refine_begin(f);
    ZT_TRY(zt_refine(f));
    if (f->at_edges) zt_image_forget_stamps(f->image); /* those were of the first samples */
    return ZT_OK;
}

static zt_status render_all(zt_frame *f) {
    const zt_render_job *job = f->job;
    f->even = zt_render_is_even(job);
    f->at_edges = zt_render_is_at_edges(job);
    zt_arena_reset(&f->work->arena);
    if (f->at_edges) ZT_TRY(zt_labels_make(&f->labels, job->scene, &f->work->arena));
    if (f->even) fill_channels(f->image, &job->sampling);
    ZT_TRY(zt_reuse_begin(f));
    const zt_kernel *kernel = job->scene->kernel;
    f->trace =
        job->scene->plain && !f->keeps && !f->at_edges ? kernel->trace_plain : kernel->trace;
    zt_status status = render_once(f);
    if (status == ZT_OK && f->doubtful) {
        zt_reuse_renounce(f);
        status = render_once(f);
    }
    zt_reuse_end(f, status == ZT_OK);
    return status;
}

static bool is_costly(const zt_needs *needs) {
    enum { FEW_THINGS = 32 };
    return needs->mesh_count > 0 || needs->object_count > FEW_THINGS;
}

zt_status zt_render(zt_image *image, zt_render_count *count, const zt_render_job *job,
                    zt_render_work *work, zt_pool *pool) {
    int tile_count = zt_tile_count(image->width, image->height);
    int thread_count = zt_pool_thread_count(pool);
    image->transparent = job->transparent;
    zt_frame f = {.image = image,
                  .job = job,
                  .work = work,
                  .pool = pool,
                  .tile_columns = zt_tile_columns(image->width),
                  .tile_count = tile_count,
                  .run = run_length(tile_count, thread_count),
                  .costly = is_costly(&job->scene->needs),
                  .serial = job->reuse ? ++job->reuse->serial : 0};
    for (int i = 0; i < thread_count; i++) work->threads[i].count = (zt_render_count){0};
    zt_status status = render_all(&f);
    *count = (zt_render_count){
        .tiles = f.tile_count, .tiles_copied = f.tiles_copied, .tiles_kept = f.tiles_kept};
    for (int i = 0; i < thread_count; i++) {
        const zt_render_count *own = &work->threads[i].count;
        count->left_out += own->left_out;
        count->samples += own->samples;
        zt_ray_counts_add(&count->rays, &own->rays);
    }
    return status;
}
