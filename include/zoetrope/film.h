/* A film: frames of an animation become what a target holds, and what is there already is not
 * rendered again. */
#ifndef ZOETROPE_FILM_H
#define ZOETROPE_FILM_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/frames.h>
#include <zoetrope/manifest.h>
#include <zoetrope/renderer.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What is to be made. */
typedef struct zt_film_order {
    const char *target;              /* as zt_output_open() takes it */
    const zt_output_option *options; /* likewise; NULL: none */
    const zt_frames *frames;  /* in the order in which they are rendered; those that are no
                                 images of their own come in rising order */
    int64_t part, part_count; /* which part of a film these are, where several processes share
                                 the target: each its own, 1 .. part_count; 0, 0: all */
    zt_budget budget;         /* for frames that follow each other; all are rendered then */
    bool overwrites;          /* whatever is there, and whatever is known of it */
    bool forgets; /* the target is not held, and nothing is remembered; overwrites */
    const char *description, *title; /* the description's file, and what the film is called */
    const zt_override *overrides; /* that it was read with, for what images say of themselves */
    int override_count;
} zt_film_order;

/* What became of the frames. */
typedef struct zt_film_result {
    int64_t rendered, held, kept; /* rendered; the same as the one before; there already */
} zt_film_result;

/* Renders what is missing. Of images, holds the target meanwhile, by TARGET.lock, or one
 * part of it: a second process is told who does so, with ZT_EFILE, and nothing changes. What is
 * completed of them is remembered in TARGET.done, so that the same order goes on where it was
 * stopped or failed; movies and checksums are made anew. The progress of `watcher` counts all
 * frames, those that are there already, too. ZT_EFILE also for files that are there but not of
 * this film, unless it overwrites. */
zt_status zt_film_render(zt_film_result *result, zt_renderer *renderer,
                         const zt_film_order *order, const zt_watcher *watcher);

#ifdef __cplusplus
}
#endif
#endif
