/* Renders one frame: on all threads, samples where they are asked for, and what they become. */
#ifndef ZT_RENDER_RENDER_H
#define ZT_RENDER_RENDER_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/image.h>
#include <zoetrope/sampling.h>

#include "base/arena.h"
#include "base/pool.h"
#include "render/filter.h"
#include "render/lens.h"
#include "render/thin.h"
#include "tracer/kernel.h"

/* What each thread works with, and the canvas; made once in a run. Its threads' memory is the
 * arena's; closing gives back the canvas, which only some samplings ask for. */
typedef struct zt_render_work zt_render_work;
zt_status zt_render_work_push(zt_render_work **work, zt_arena *arena, int thread_count);
void zt_render_work_close(zt_render_work *work); /* may be NULL */

/* What is kept of one frame for the next one (render/reuse.h); of a run. `tireless` keeps
 * trying where little comes of it. ZT_EMEMORY. */
typedef struct zt_reuse zt_reuse;
zt_status zt_reuse_open(zt_reuse **reuse, bool tireless);
void zt_reuse_close(zt_reuse **reuse);

typedef struct zt_render_job {
    const zt_ready *scene;
    const zt_lens *lens;
    zt_sampling sampling;
    zt_reuse *reuse;  /* or NULL: nothing is copied; else */
    zt_hash view;     /* says which pictures' samples are the same rays: of the same lens, size,
                         channels, and what of the sampling may make a difference to that */
    bool transparent; /* A is how many samples met something, as colours count; else 1 */
    const zt_warp *warp; /* the sampling's filter made ready */
    const zt_thin
        *thin; /* where edges are looked for; or NULL: thin things are missed by luck */
    /* What random numbers are keyed by: where in their pixels samples are taken, and all else.
     */
    uint64_t place_key, frame_key;
    bool (*stopped)(void *user); /* asked before each tile, from any thread; may be NULL */
    void *user;
} zt_render_job;

/* Whether each pixel takes as many samples, which follow from nothing else. */
static inline bool zt_render_is_even(const zt_render_job *job) {
    const zt_sampling *s = &job->sampling;
    return s->max == 1 || (s->min >= s->max && !s->edges && !zt_warp_is_signed(job->warp));
}

/* Whether light is a mean over more than places in pixels. */
static inline bool zt_render_is_random(const zt_render_job *job) {
    return job->scene->random || job->scene->moves || zt_lens_has_aperture(job->lens) ||
           zt_lens_moves(job->lens);
}

/* Whether further samples are taken at edges alone: of random light, those in the middle of
 * pixels say little. */
static inline bool zt_render_is_at_edges(const zt_render_job *job) {
    return job->sampling.edges && !zt_render_is_even(job) && !zt_render_is_random(job);
}

/* How many samples a pixel takes first, where not all take as many; it then goes on to twice as
 * many each time. */
int zt_render_first_samples(const zt_render_job *job);

/* What keeps tiles of such frames from being copied from one to the next where the camera
 * stands still, as a sentence; NULL: nothing does. */
const char *zt_reuse_hindrance(const zt_render_job *job);

typedef struct zt_render_count {
    int64_t left_out; /* samples that were not finite */
    int64_t samples;
    zt_ray_counts rays;
    int64_t tiles, tiles_copied; /* of which tiles_kept from one that was kept */
    int64_t tiles_kept;
} zt_render_count;

/* Renders into all of `image`, and into its further channels. The same bits for any number of
 * threads. A sample that is not finite is left out of its pixel. ZT_ESTOPPED when asked to
 * stop: then the image is unfinished. ZT_EMEMORY. */
zt_status zt_render(zt_image *image, zt_render_count *count, const zt_render_job *job,
                    zt_render_work *work, zt_pool *pool);

#endif
