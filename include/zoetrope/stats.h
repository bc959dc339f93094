/* What frames need, what is left out of them, and what that saves. */
#ifndef ZOETROPE_STATS_H
#define ZOETROPE_STATS_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/renderer.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Rays of one kind: those that were traced; and those that were not, of all that there are
 * where each sample is one, from each point one goes to each lamp, and a mirrored one goes on
 * from it as often as the description allows. */
typedef struct zt_ray_stats {
    int64_t traced, avoided;
} zt_ray_stats;

/* Of all frames that a renderer has rendered so far. */
typedef struct zt_stats {
    int64_t frames;
    zt_ray_stats primary, shadow, mirror;
    /* Rays travel up to 256 together, those of a tile if it takes one sample a pixel: how many
     * such batches there were, how many of them met nothing, and how many one flat thing alone
     * that nothing shadows and that mirrors nothing. */
    int64_t batches, bare_batches, flat_batches;
    int64_t tiles, copied_tiles; /* copied from the frame before, or from before an edit */
    int64_t found, found_tiles,
        found_copied;                  /* frames of which an earlier run's was there; their
                                          tiles, and how many of those were copied */
    int64_t keepsakes, keepsake_bytes; /* that are there for later edits */
    double freeze_s, prepare_s, render_s;
} zt_stats;

zt_stats zt_renderer_stats(const zt_renderer *renderer);

/* Libraries that are loaded when they are first needed; `what` they are needed for. */
typedef struct zt_library {
    const char *name, *what;
    bool built;  /* or left out when the program was */
    bool loaded; /* in this process */
} zt_library;

enum { ZT_LIBRARY_COUNT = 5 };
void zt_libraries(zt_library libraries[ZT_LIBRARY_COUNT]);

/* Says in sentences, one after the other, what a frame needs, and what is left out of it and
 * why. Fails as rendering does. */
zt_status zt_renderer_needs(zt_renderer *renderer, int64_t frame,
                            void (*say)(void *user, const char *sentence), void *user);

/* How many meshes no ray came near in what was rendered so far, so that they were not built:
 * said in a sentence for each, where there is someone to say it to. */
int32_t zt_renderer_unmet(const zt_renderer *renderer,
                          void (*say)(void *user, const char *sentence), void *user);

#ifdef __cplusplus
}
#endif
#endif
