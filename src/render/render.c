#include "render/render.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

#include "base/diag.h"
#include "tracer/isa.h"
#include "tracer/sampler.h"

enum { TILE_SIDE = 16 };
static_assert(TILE_SIDE * TILE_SIDE == ZT_BATCH, "a tile is a batch");

struct zt_render_work {
    int32_t column[ZT_BATCH], row[ZT_BATCH]; /* of each pixel within a tile */
    struct render_thread {
        /* The pixels of a block, and what their samples add up to. */
        alignas(64) int32_t column[ZT_BATCH];
        alignas(64) int32_t row[ZT_BATCH];
        uint32_t place_key[ZT_BATCH],
            key[ZT_BATCH]; /* of where they are sampled, and all else */
        zt_radiance sum;
        alignas(64) int32_t taken[ZT_BATCH]; /* samples in the sum */
        /* A batch: some samples of each pixel, one after the other. */
        float x[ZT_BATCH], y[ZT_BATCH]; /* places in the picture, pixels */
        float u[ZT_BATCH], v[ZT_BATCH]; /* and in the lens */
        zt_rays rays;
        zt_radiance light;
        void *kernel; /* what it works with */
    } * threads;
};

/* One frame under way. */
typedef struct frame {
    zt_image *image;
    const zt_render_job *job;
    const zt_render_work *work;
    int tile_columns, tile_count;
    int run; /* tiles that a thread takes at a time */
    atomic_bool stopped;
    atomic_llong left_out_count;
} frame;

/* The pixels of a tile: columns x .. x + width - 1, rows y .. y + height - 1. */
typedef struct tile {
    int x, y, width, height;
} tile;

static int min_int(int a, int b) { return a < b ? a : b; }

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
    work->threads = ZT_PUSH(arena, struct render_thread, (size_t)thread_count);
    if (!work->threads) return ZT_EMEMORY;
    for (int i = 0; i < thread_count; i++) {
        work->threads[i].kernel = zt_arena_push(arena, zt_kernel_work_size());
        if (!work->threads[i].kernel) return ZT_EMEMORY;
    }
    *out = work;
    return ZT_OK;
}

/* Lists pixels first … first + most - 1 of a tile; those beyond the edge of the picture are
 * left out. */
static int list_pixels(struct render_thread *own, const frame *f, tile area, int first,
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
    bool keys = job->sampling.max > 1 || job->scene->moves || job->scene->random;
    for (int i = 0; keys && i < count; i++) {
        own->place_key[i] = zt_sample_key(job->place_key, column[i], row[i]);
        own->key[i] = zt_sample_key(job->frame_key, column[i], row[i]);
    }
    return count;
}

/* Adds a sample of each pixel, from `first` in the batch on, to the sums; returns how many were
 * not finite. */
ZT_CLONES static int add_samples(zt_radiance *restrict sum, int32_t *restrict taken,
                                 const zt_radiance *restrict light, int first, int count) {
    int left_out = 0;
    for (int i = 0; i < count; i++) {
        float r = light->r[first + i], g = light->g[first + i], b = light->b[first + i];
        /* Infinities and NaN, alone of all numbers, are not 0 when taken from themselves. */
        bool finite = (r - r) + (g - g) + (b - b) == 0;
        sum->r[i] += finite ? r : 0;
        sum->g[i] += finite ? g : 0;
        sum->b[i] += finite ? b : 0;
        taken[i] += finite;
        left_out += !finite;
    }
    return left_out;
}

/* Makes the sums the means. */
ZT_CLONES static void average(zt_radiance *restrict sum, const int32_t *restrict taken,
                              int count) {
    for (int i = 0; i < count; i++) {
        float share = taken[i] ? 1 / (float)taken[i] : 0;
        sum->r[i] *= share;
        sum->g[i] *= share;
        sum->b[i] *= share;
    }
}

/* Writes means to the image, where a whole tile is listed four pixels of a row at a time. */
ZT_CLONES static void fill_pixels(float *restrict pixels, int width,
                                  const zt_radiance *restrict sum,
                                  const int32_t *restrict column, const int32_t *restrict row,
                                  int count, bool whole) {
    enum { RUN = 4 };
    for (int i = 0; whole && i < count; i += RUN) {
        float *to = pixels + 4 * ((size_t)row[i] * (size_t)width + (size_t)column[i]);
        for (int k = 0; k < RUN; k++) {
            to[4 * k] = sum->r[i + k];
            to[4 * k + 1] = sum->g[i + k];
            to[4 * k + 2] = sum->b[i + k];
            to[4 * k + 3] = 1;
        }
    }
    for (int i = 0; !whole && i < count; i++) {
        float *to = pixels + 4 * ((size_t)row[i] * (size_t)width + (size_t)column[i]);
        memcpy(to, (float[4]){sum->r[i], sum->g[i], sum->b[i], 1}, 4 * sizeof(float));
    }
}

/* Where and when sample number `sample` of each pixel is, from `first` in the batch on. A
 * single one is in the middle. */
static void take_samples(struct render_thread *own, const zt_render_job *job, int first,
                         int count, int sample) {
    float *x = own->x + first, *y = own->y + first, unused[ZT_BATCH];
    bool single = job->sampling.max == 1;
    if (!single)
        zt_sample_points(x, y, own->place_key, ZT_DIMENSION_PIXEL, (uint32_t)sample, count);
    for (int i = 0; i < count; i++) {
        x[i] = (float)own->column[i] + (single ? 0.5f : x[i]);
        y[i] = (float)own->row[i] + (single ? 0.5f : y[i]);
    }
    if (zt_lens_has_aperture(job->lens))
        zt_sample_points(own->u + first, own->v + first, own->key, ZT_DIMENSION_LENS,
                         (uint32_t)sample, count);
    if (job->scene->moves || zt_lens_moves(job->lens))
        zt_sample_points(own->rays.time + first, unused, own->key, ZT_DIMENSION_TIME,
                         (uint32_t)sample, count);
    for (int i = 0; job->scene->random && i < count; i++) {
        own->rays.key[first + i] = own->key[i];
        own->rays.sample[first + i] = (uint32_t)sample;
    }
}

/* All samples of some pixels of a tile, as many of each in a batch as there is room for. */
static bool render_block(frame *f, struct render_thread *own, tile area, int first, int most) {
    const zt_render_job *job = f->job;
    int left_out = 0, count = list_pixels(own, f, area, first, most);
    if (count == 0) return true;
    memset(&own->sum, 0, sizeof own->sum);
    memset(own->taken, 0, sizeof own->taken);
    int together = ZT_BATCH / count;
    for (int done = 0; done < job->sampling.max; done += together) {
        if (job->stopped && job->stopped(job->user)) return false;
        int now = min_int(together, job->sampling.max - done);
        for (int k = 0; k < now; k++) take_samples(own, job, k * count, count, done + k);
        zt_lens_rays(&own->rays, job->lens, own->x, own->y, own->u, own->v, now * count);
        job->scene->kernel->trace(&own->light, job->scene->tracer, &own->rays, own->kernel);
        for (int k = 0; k < now; k++)
            left_out += add_samples(&own->sum, own->taken, &own->light, k * count, count);
    }
    average(&own->sum, own->taken, count);
    fill_pixels(f->image->pixels, f->image->width, &own->sum, own->column, own->row, count,
                count == most);
    if (left_out) atomic_fetch_add_explicit(&f->left_out_count, left_out, memory_order_relaxed);
    return true;
}

/* How many pixels share a batch: the more samples each takes, the fewer, so that the rays of a
 * batch stay close together. Blocks of a tile are squares of these many pixels. */
static int block_size(int samples) { return samples >= 16 ? 16 : samples >= 4 ? 64 : ZT_BATCH; }

static bool render_tile(frame *f, int index, int worker) {
    int x = index % f->tile_columns * TILE_SIDE, y = index / f->tile_columns * TILE_SIDE;
    tile area = {x, y, min_int(TILE_SIDE, f->image->width - x),
                 min_int(TILE_SIDE, f->image->height - y)};
    int most = block_size(f->job->sampling.max);
    for (int first = 0; first < ZT_BATCH; first += most)
        if (!render_block(f, &f->work->threads[worker], area, first, most)) return false;
    return true;
}

static void render_run(void *user, int index, int worker) {
    frame *f = user;
    int end = min_int((index + 1) * f->run, f->tile_count);
    for (int tile = index * f->run; tile < end; tile++) {
        if (atomic_load_explicit(&f->stopped, memory_order_relaxed)) return;
        if (!render_tile(f, tile, worker))
            atomic_store_explicit(&f->stopped, true, memory_order_relaxed);
    }
}

/* How many tiles side by side a thread takes at a time: two that write next to each other slow
 * each other down, so as many as leave enough to share out to the end. */
static int run_length(int tile_count, int thread_count) {
    enum { RUN_MAX = 16, RUNS = 32 };
    int length = tile_count / (thread_count * RUNS);
    return length < 1 ? 1 : min_int(length, RUN_MAX);
}

zt_status zt_render(zt_image *image, int64_t *left_out_count, const zt_render_job *job,
                    zt_render_work *work, zt_pool *pool) {
    int columns = (image->width + TILE_SIDE - 1) / TILE_SIDE;
    int rows = (image->height + TILE_SIDE - 1) / TILE_SIDE;
    frame f = {.image = image,
               .job = job,
               .work = work,
               .tile_columns = columns,
               .tile_count = columns * rows,
               .run = run_length(columns * rows, zt_pool_thread_count(pool))};
    zt_pool_run(pool, (f.tile_count + f.run - 1) / f.run, render_run, &f);
    *left_out_count = f.left_out_count;
    return f.stopped ? ZT_ESTOPPED : ZT_OK;
}
