/* A manifest: what the frames of a film were rendered with, so that they can be rendered again
 * with the same bits, whatever chose that the first time. */
#ifndef ZOETROPE_MANIFEST_H
#define ZOETROPE_MANIFEST_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/frames.h>
#include <zoetrope/hash.h>
#include <zoetrope/renderer.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct zt_manifest zt_manifest;

/* Reads a file such as zt_film_render() keeps beside a target: lines of JSON, the first of them
 *
 *   {"zoetrope": 1, "description": "film.yaml", "size": [1280, 720], "precision": "auto",
 *    "written": "codec=h265"}
 *
 * and then one for each thing that was completed, the later ones counting:
 *
 *   {"frame": 0, "samples": 48, "film_s": 1200, "key": "...", "tiles": "...", "time": 0.31,
 *    "file": "film.0000.png", "bytes": 81234, "checksum": "...", "record": "..."}
 *   {"frame": 1, "min": 4, "max": 256, "error": 0.00213, "mean_max": 30, ...}
 *   {"piece": 0, "count": 48, "bytes": 1234567, "checksum": "...", "record": "...",
 * "time": 9.1}
 *
 * Samples, where a budget of time chose them, are those of each pixel; with `min`, `max` and
 * `error` they are taken as a description's are, and no more than `mean_max` on average. `key`
 * is the content key, `tiles` a checksum of all the numbers of the image, tile by tile,
 * `checksum` that of its file; `record` says what decided the bytes. A last line that was cut
 * short says nothing. ZT_EFILE, told at its place, for a file that cannot be read, is no such
 * thing, or has no frames. The caller frees the manifest. */
zt_status zt_manifest_read(zt_manifest **manifest, const char *path, zt_listener listener);
void zt_manifest_free(zt_manifest **manifest);

/* How long a frame took to render when that was last done, seconds; negative: not known. */
double zt_manifest_time(const zt_manifest *manifest, int64_t frame);

/* The content key that a frame had then; false: not known. */
bool zt_manifest_key(zt_hash *key, const zt_manifest *manifest, int64_t frame);

/* The first and the last frame that it has. */
void zt_manifest_range(int64_t *first, int64_t *last, const zt_manifest *manifest);

/* Sets those settings that are open (zero) to what the manifest says. */
void zt_manifest_settings(zt_render_settings *settings, const zt_manifest *manifest);

/* Has a renderer take for each frame the samples that the manifest says, if any; it must
 * outlive the renderer's frames. A frame that it has not is refused, told, with ZT_EARGUMENT.
 */
void zt_renderer_follow(zt_renderer *renderer, const zt_manifest *manifest);

/* How long rendering may take, seconds; 0: any time. */
typedef struct zt_budget {
    double frame_s; /* each frame */
    double film_s;  /* all frames together, and finding out how long they take */
} zt_budget;

/* Allots samples to frames, in rising order, that are rendered next, one after the other. A few
 * of them, spread over the list, are rendered with few samples to find out
 * how long they take and how noisy they are, in about a tenth of the time at most; of adaptive
 * sampling, in up to three tenths of a frame's. With a budget for the film all frames end with
 * about the same error; with one for each frame all take about as long. Of adaptive sampling,
 * it is the error that is chosen. How fast frames really are is taken into account, little by
 * little, for those to come. What is chosen, and where the time is too short or more than can
 * be used, is told. ZT_EARGUMENT where not one of the two is positive; otherwise fails as
 * rendering does.
 */
zt_status zt_renderer_budget(zt_renderer *renderer, const zt_frames *frames,
                             const zt_budget *budget, const zt_watcher *watcher);

#ifdef __cplusplus
}
#endif
#endif
