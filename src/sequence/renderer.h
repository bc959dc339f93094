/* The renderer: where the two wings meet. It owns what lives for the run. */
#ifndef ZT_SEQUENCE_RENDERER_H
#define ZT_SEQUENCE_RENDERER_H

#include <threads.h>

#include <zoetrope/renderer.h>
#include <zoetrope/stats.h>

#include "base/arena.h"
#include "base/pool.h"
#include "render/render.h"
#include "scene/passage.h"
#include "sequence/shutter.h"
#include "tracer/meshes.h"

/* What a frame took: seconds of wall time for each stage, and how much there was to do. */
typedef struct zt_frame_cost {
    double freeze_s, prepare_s, render_s;
    double own_s; /* that the calling thread computed in all of them (base/usage.h) */
    zt_ray_counts rays;
    int64_t left_out_count; /* samples that were not finite */
    int64_t tiles, tiles_copied;
} zt_frame_cost;

typedef struct zt_pacing zt_pacing;       /* sequence/pacing.h */
typedef struct zt_keepsakes zt_keepsakes; /* sequence/keepsakes.h */

struct zt_renderer {
    const zt_animation *animation;
    zt_output_format format;
    zt_sampling sampling;
    zt_precision precision;
    unsigned aovs;     /* bits of zt_aov: the description's, and those that were asked for */
    const bool *stays; /* as in zt_exposure */
    zt_hash held;      /* of what all meshes hold; zero until it is asked for */
    zt_listener caller, listener; /* who listens, and what tells them one thing at a time; */
    mtx_t telling;                /* held meanwhile */
    zt_pool *pool;
    zt_meshes *meshes;
    zt_arena run, frame; /* memory for the whole run, and for one frame after the other */
    zt_render_work *work;
    zt_reuse *reuse;         /* of the frame before; NULL: nothing is copied */
    zt_keepsakes *keepsakes; /* of earlier runs; NULL: none */
    bool checks_reuse;
    zt_stats stats;     /* of all frames */
    zt_frame_cost cost; /* of the last frame; and its camera's, as zt_image_info has them */
    double world_to_camera[16], world_to_ndc[16];
    const struct zt_manifest
        *followed;       /* whose samples frames take; NULL: none's. Not its own */
    zt_pacing *pacing;   /* of a budget; NULL: none */
    bool told_precision; /* that the precision is not enough */
    bool told_motion;    /* that something moves too fast */
};

/* A frame on its way: what the scene is meanwhile, the same ready for rays, the lens, and how
 * all that is rendered. It points into itself, so it stays where it is; the rest is in the
 * frame's memory. */
typedef struct zt_taking {
    zt_exposure exposure;
    zt_division division;
    zt_ready ready;
    zt_lens *lens;
    zt_passage passage; /* to the next frame, where motion is asked for */
    zt_render_job job;
} zt_taking;

/* Its version, which becomes another one whenever the same scene comes out with other pixels,
 * and the machine's architecture. */
extern const char zt_arithmetic[];

/* Has start whatever frames of the film will need for sure: Embree, where there is a mesh or a
 * crowd. Else it starts when it is first needed. Fails, and tells it, where that cannot be. */
zt_status zt_renderer_start(zt_renderer *renderer);

/* All that comes before rendering. */
zt_status zt_renderer_prepare(zt_taking *taking, zt_renderer *renderer, int64_t frame);

/* Renders a frame with the renderer's sampling, whatever else says how many samples it takes,
 * and copies nothing. */
zt_status zt_renderer_take(zt_renderer *renderer, int64_t frame, zt_image *image,
                           const zt_watcher *watcher);

/* Says what was chosen for a frame that is ready, and why. */
void zt_renderer_say(zt_frame_choices *choices, const zt_renderer *renderer,
                     const zt_ready *ready, const zt_exposure *exposure,
                     const zt_division *division);

/* Warns, the first time only, where single precision was asked for and is not enough; and where
 * something moves faster than an exposure can follow. */
void zt_renderer_doubt(zt_renderer *renderer, const zt_ready *ready,
                       const zt_exposure *exposure, const zt_division *division, int64_t frame);

#endif
