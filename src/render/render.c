#include "render/render.h"

#include <assert.h>
#include <stdatomic.h>
#include <string.h>

#include "base/diag.h"
#include "tracer/sampler.h"

enum { TILE_SIDE = 16 };
static_assert(TILE_SIDE * TILE_SIDE == ZT_BATCH, "a tile is a batch");

struct zt_render_work {
    int32_t column[ZT_BATCH], row[ZT_BATCH]; /* of each ray's pixel within a tile */
    struct render_thread {
        int32_t column[ZT_BATCH], row[ZT_BATCH]; /* the pixel of each ray */
        float x[ZT_BATCH], y[ZT_BATCH];          /* its place in the picture, pixels */
        zt_rays rays;
        zt_radiance light, sum;
        int32_t taken[ZT_BATCH]; /* samples in the sum */
        void *kernel; /* what it works with */
    } * threads;
};

/* One frame under way. */
typedef struct frame {
    zt_image *image;
    const zt_render_job *job;
    const zt_render_work *work;
    int tile_columns;
    atomic_bool stopped;
    atomic_llong left_out_count;
} frame;

/* The pixels of a tile: columns x .. x + width - 1, rows y .. y + height - 1. */
typedef struct tile {
    int x, y, width, height;
} tile;

static int min_int(int a, int b) { return a < b ? a : b; }

/* The pixels of a tile in blocks of 4 x 4, so that rays that travel in one packet are close
 * together in both directions. */
static void order_pixels(zt_render_work *work) {
    enum { BLOCK = 4, ACROSS = TILE_SIDE / BLOCK };
    for (int i = 0; i < ZT_BATCH; i++) {
        int block = i / (BLOCK * BLOCK), within = i % (BLOCK * BLOCK);
        work->column[i] = block % ACROSS * BLOCK + within % BLOCK;
        work->row[i] = block / ACROSS * BLOCK + within / BLOCK;
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

/* Lists the pixels of a tile; those beyond the edge of the picture are left out. */
static int list_pixels(struct render_thread *own, const zt_render_work *work, tile area) {
    int32_t *restrict column = own->column, *restrict row = own->row;
    if (area.width == TILE_SIDE && area.height == TILE_SIDE) {
        for (int i = 0; i < ZT_BATCH; i++) {
            column[i] = area.x + work->column[i];
            row[i] = area.y + work->row[i];
        }
        return ZT_BATCH;
    }
    int count = 0;
    for (int i = 0; i < ZT_BATCH; i++) {
        column[count] = area.x + work->column[i];
        row[count] = area.y + work->row[i];
        count += work->column[i] < area.width && work->row[i] < area.height;
    }
    return count;
}

/* Adds a sample of each pixel to the sums; returns how many were not finite. */
static int add_samples(struct render_thread *own, int count) {
    const zt_radiance *light = &own->light;
    int left_out = 0;
    for (int i = 0; i < count; i++) {
        float r = light->r[i], g = light->g[i], b = light->b[i];
        /* Infinities and NaN, alone of all numbers, are not 0 when taken from themselves. */
        bool finite = (r - r) + (g - g) + (b - b) == 0;
        own->sum.r[i] += finite ? r : 0;
        own->sum.g[i] += finite ? g : 0;
        own->sum.b[i] += finite ? b : 0;
        own->taken[i] += finite;
        left_out += !finite;
    }
    return left_out;
}

static void fill_pixels(zt_image *image, struct render_thread *own, int count) {
    zt_radiance *sum = &own->sum;
    for (int i = 0; i < count; i++) {
        float share = own->taken[i] ? 1 / (float)own->taken[i] : 0;
        sum->r[i] *= share;
        sum->g[i] *= share;
        sum->b[i] *= share;
    }
    for (int i = 0; i < count; i++) {
        size_t at = (size_t)own->row[i] * (size_t)image->width + (size_t)own->column[i];
        memcpy(image->pixels + 4 * at, (float[4]){sum->r[i], sum->g[i], sum->b[i], 1},
               4 * sizeof(float));
    }
}

static void render_tile(void *user, int index, int worker) {
    frame *f = user;
    const zt_render_job *job = f->job;
    if (atomic_load_explicit(&f->stopped, memory_order_relaxed)) return;
    int x = index % f->tile_columns * TILE_SIDE, y = index / f->tile_columns * TILE_SIDE;
    tile area = {x, y, min_int(TILE_SIDE, f->image->width - x),
                 min_int(TILE_SIDE, f->image->height - y)};
    struct render_thread *own = &f->work->threads[worker];
    memset(&own->sum, 0, sizeof own->sum);
    memset(own->taken, 0, sizeof own->taken);
    int left_out = 0, count = list_pixels(own, f->work, area);
    for (int sample = 0; sample < job->samples; sample++) {
        if (job->stopped && job->stopped(job->user)) {
            atomic_store_explicit(&f->stopped, true, memory_order_relaxed);
            return;
        }
        zt_sample_pixels(own->x, own->y, own->column, own->row, count, sample, job->samples);
        zt_lens_rays(&own->rays, &job->lens, own->x, own->y, count);
        job->scene->kernel->trace(&own->light, job->scene->tracer, &own->rays, own->kernel);
        left_out += add_samples(own, count);
    }
    fill_pixels(f->image, own, count);
    if (left_out) atomic_fetch_add_explicit(&f->left_out_count, left_out, memory_order_relaxed);
}

zt_status zt_render(zt_image *image, int64_t *left_out_count, const zt_render_job *job,
                    zt_render_work *work, zt_pool *pool) {
    int columns = (image->width + TILE_SIDE - 1) / TILE_SIDE;
    int rows = (image->height + TILE_SIDE - 1) / TILE_SIDE;
    frame f = {.image = image, .job = job, .work = work, .tile_columns = columns};
    zt_pool_run(pool, columns * rows, render_tile, &f);
    *left_out_count = f.left_out_count;
    return f.stopped ? ZT_ESTOPPED : ZT_OK;
}
