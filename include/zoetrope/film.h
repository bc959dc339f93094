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
    const zt_frames *frames; /* in the order in which they are rendered; a movie's rise */
    int part, part_count;    /* which part of the film's frames these are, where several
                                processes share the target: each its own; 0, 0: all */
    zt_budget budget;
    int64_t verify_count; /* so many frames that need not be rendered are, to be compared */
    bool overwrites;      /* whatever is there, and whatever a manifest says of it */
    const char *description, *title; /* the description's file, and what the film is called */
    const char *settings;            /* zt_image_info */
} zt_film_order;

/* What became of the frames. */
typedef struct zt_film_result {
    int64_t rendered, held, kept; /* rendered; the same as another one; there already */
    int64_t verified, wrong; /* rendered for comparison; and those that were not the same */
    double rendered_s, idle_share; /* wall time; of the cores' time while there was work */
} zt_film_result;

/* Renders what is missing. Holds the target meanwhile: a second process is told who does so,
 * with ZT_EFILE, and nothing changes. The manifest TARGET.manifest is kept beside it as frames
 * are completed. The progress of `watcher` counts the frames that are rendered or held. When it
 * is stopped or fails, all that was completed is there, and the same order goes on from there.
 * ZT_EFILE also for files that are there but not of this film, unless it overwrites, and where
 * a verified frame is not the same; all of them told. */
zt_status zt_film_render(zt_film_result *result, zt_renderer *renderer,
                         const zt_film_order *order, const zt_watcher *watcher);

#ifdef __cplusplus
}
#endif
#endif
