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
    const zt_output_option *options; /* likewise; NULL: none. A movie that does not begin with
                                        frame 0 has no sound, which is told */
    const zt_frames *frames;  /* in the order in which images of their own are rendered; others,
                                 and all with a budget, come in rising order */
    int64_t part, part_count; /* 1 .. part_count: only this part of the frames, where several
                                 processes share the target; 0, 0: all */
    zt_budget budget;         /* zeros: none */
    int64_t verify;           /* how many frames that are there are rendered again */
    int64_t keep_bytes;       /* that frames which are kept for later edits may take; 0: none
                                 are, and those of earlier runs go */
    bool overwrites;          /* whatever is there, and whatever is known of it */
    bool forgets; /* the target is not held, and nothing is remembered; overwrites */
    const char *description, *title; /* the description's file, and what the film is called */
    const zt_override *overrides; /* that it was read with, for what images say of themselves */
    int override_count;
} zt_film_order;

/* What became of the frames. */
typedef struct zt_film_result {
    int64_t count;                 /* of the frames, or of the part's */
    int64_t rendered, held, kept;  /* rendered; the same as another one; there already */
    int64_t verified;              /* of the latter, rendered again and found to be the same */
    int64_t tiles;                 /* of all images that were sent out; of which so many */
    int64_t unconverted, unsummed; /* were not converted, and not added up, again, since they
                                      were the same as in an image before */
} zt_film_result;

/* Renders what is missing.
 *
 * Holds the target meanwhile, by TARGET.lock, or one part of it: a second process is told who
 * does so, with ZT_EFILE, and nothing changes. What is completed is noted in TARGET.manifest
 * (zt_manifest_read()), so that the same order goes on where it was stopped or failed, whatever
 * ended it. What shows the same as another frame is not rendered twice. Checksums (.hash) are
 * made anew, and neither held nor noted; but what a budget chose is, anew.
 *
 * Frames that took long are kept as they were rendered, in TARGET.keepsakes: when the
 * description has been edited, of a frame that is rendered again only those tiles are that the
 * edit can affect. Not with a budget, and not where the renderer reuses nothing.
 *
 * Parts are divided by what the frames took before, where all of that is known, else evenly;
 * all processes that render parts of the same film come to the same division, which is noted.
 *
 * With a budget, frames that were rendered with it and are there stay, and what they took is
 * taken off its time for the film.
 *
 * Frames to be verified are spread over those that are there; the same ones each time. Where
 * one comes out with other numbers than its file was made of, that is told, the file stays,
 * nothing else is rendered, and it ends with ZT_EFILE.
 *
 * The progress of `watcher` counts all frames of the part, those that are there already, too.
 * ZT_EFILE also for files that are there but not of this film, unless it overwrites. A film
 * that is refused before its first frame leaves nothing behind. */
zt_status zt_film_render(zt_film_result *result, zt_renderer *renderer,
                         const zt_film_order *order, const zt_watcher *watcher);

#ifdef __cplusplus
}
#endif
#endif
