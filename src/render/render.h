/* Renders one frame: tiles on all threads, samples, and the film that takes their light. */
#ifndef ZT_RENDER_RENDER_H
#define ZT_RENDER_RENDER_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/image.h>
#include <zoetrope/sampling.h>

#include "base/arena.h"
#include "base/pool.h"
#include "render/lens.h"
#include "tracer/kernel.h"

/* What each thread works with; made once in a run. */
typedef struct zt_render_work zt_render_work;
zt_status zt_render_work_push(zt_render_work **work, zt_arena *arena, int thread_count);

typedef struct zt_render_job {
    const zt_ready *scene;
    const zt_lens *lens;
    zt_sampling sampling;
    /* What random numbers are keyed by: where in their pixels samples are taken, and all else.
     */
    uint64_t place_key, frame_key;
    bool (*stopped)(void *user); /* asked before each tile, from any thread; may be NULL */
    void *user;
} zt_render_job;

/* Renders into all of `image`. The same bits for any number of threads. A sample that is not
 * finite is left out of its pixel; `*left_out_count` says how many were. ZT_ESTOPPED when asked
 * to stop: then the image is unfinished. */
zt_status zt_render(zt_image *image, int64_t *left_out_count, const zt_render_job *job,
                    zt_render_work *work, zt_pool *pool);

#endif
