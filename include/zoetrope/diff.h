/* How a film differs from an older one: which frames, because of what, and how long rendering
 * them takes. */
#ifndef ZOETROPE_DIFF_H
#define ZOETROPE_DIFF_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/manifest.h>
#include <zoetrope/renderer.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Frames from `first` to `last`, both included. */
typedef struct zt_frame_span {
    int64_t first, last;
} zt_frame_span;

typedef struct zt_frame_spans {
    zt_frame_span *all; /* rising, with frames between them */
    int64_t count;
} zt_frame_spans;

/* Something that is not as it was, in some of the frames that change. */
typedef struct zt_diff_cause {
    const char *name; /* "ball.center", "film.samples", "lamp (new)" */
    zt_frame_spans spans;
} zt_diff_cause;

/* Of frames that both films have, and of those that are new. */
typedef struct zt_diff {
    int64_t older_count, newer_count; /* how many frames the films have */
    int64_t changed_count;            /* of those that both have */
    zt_frame_spans changed;
    zt_diff_cause *causes; /* by their frames */
    int64_t cause_count;
    bool resettled;  /* pixels cost something else: their number, their samples, the shutter */
    int64_t *frames; /* of the newer film, that change or are new, but for those that show
                        the same as the one before, which are not rendered */
    int64_t frame_count;
} zt_diff;

/* Compares the frames' content keys, and where they differ, all that the scenes of a frame's
 * opening hold. Progress counts the newer film's frames. Fails as freezing does, or with
 * ZT_ESTOPPED. The caller frees it. */
zt_status zt_diff_find(zt_diff **diff, zt_renderer *older, zt_renderer *newer,
                       const zt_watcher *watcher);
void zt_diff_free(zt_diff **diff);

/* How long rendering diff->frames takes. */
typedef struct zt_diff_time {
    double seconds;
    int64_t known_count; /* of the frames: what the manifest knows; 0: none of them */
    int64_t measured[2]; /* else frames that were rendered to find out; */
    int measured_count;  /* so many, */
    int measured_part;   /* at this part of the width and height: 4 is a quarter */
} zt_diff_time;

/* By what a manifest says that the same frames took, where that is of the same size and nothing
 * is resettled; those that it does not know, as long as the others on average. `manifest` may
 * be NULL. Where it tells nothing, renders one or two of the frames, at a quarter of their size
 * where that is not too small to tell. Fails as rendering does. */
zt_status zt_diff_estimate(zt_diff_time *time, const zt_diff *diff, const zt_manifest *manifest,
                           const zt_animation *newer, const zt_render_settings *settings,
                           const zt_watcher *watcher, zt_listener listener);

#ifdef __cplusplus
}
#endif
#endif
