/* A manifest: what the frames of a film were rendered with, so that they can be rendered again
 * with the same bits, whatever chose that the first time. */
#ifndef ZOETROPE_MANIFEST_H
#define ZOETROPE_MANIFEST_H

#include <stdint.h>

#include <zoetrope/renderer.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct zt_manifest zt_manifest;

/* Reads the file that zt_manifest_write made: JSON, of which a part looks like
 *
 *   {
 *     "zoetrope": 1,
 *     "description": "film.yaml",
 *     "size": [1280, 720],
 *     "precision": "auto",
 *     "frames": [
 *       {"frame": 0, "samples": 48},
 *       {"frame": 1, "min": 4, "max": 256, "error": 0.00213, "mean_max": 30}
 *     ]
 *   }
 *
 * Samples are those of each pixel; with `min`, `max` and `error` they are taken as a
 * description's are, and no more than `mean_max` on average. ZT_EFILE, told at its place, for a
 * file that cannot be read or is no such thing. The caller frees the manifest. */
zt_status zt_manifest_read(zt_manifest **manifest, const char *path, zt_listener listener);

/* Writes it at once: nobody sees half a file. `description` is the name of what was rendered.
 */
zt_status zt_manifest_write(const zt_manifest *manifest, const char *path,
                            const char *description, zt_listener listener);
void zt_manifest_free(zt_manifest **manifest);

/* The first and the last frame that it has. */
void zt_manifest_range(int64_t *first, int64_t *last, const zt_manifest *manifest);

/* Sets those settings that are open (zero) to what the manifest says. */
void zt_manifest_settings(zt_render_settings *settings, const zt_manifest *manifest);

/* Has a renderer take for each frame the samples that the manifest says; it must outlive the
 * renderer's frames. A frame that it has not is refused, told, with ZT_EARGUMENT. */
void zt_renderer_follow(zt_renderer *renderer, const zt_manifest *manifest);

/* How long rendering may take, seconds; 0: any time. */
typedef struct zt_budget {
    double frame_s; /* each frame */
    double film_s;  /* all frames together, and finding out how long they take */
} zt_budget;

/* Allots samples to frames first .. last, both included, that are rendered next and in order. A
 * few of them, spread over the range, are rendered with few samples to find out how long they
 * take and how noisy they are, in about a tenth of the time at most; of adaptive sampling, in
 * up to three tenths of a frame's. With a budget for the film all frames end with about the
 * same error; with one for each frame all take about as long. Of adaptive sampling, it is the
 * error that is chosen. How fast frames really are is taken into account, little by little, for
 * those to come. What is chosen, and where the time is too short or more than can be used, is
 * told. ZT_EARGUMENT where not one of the two is positive; otherwise fails as rendering does.
 */
zt_status zt_renderer_budget(zt_renderer *renderer, int64_t first, int64_t last,
                             const zt_budget *budget, const zt_watcher *watcher);

/* What the frames rendered so far with a budget took; NULL where there is none. The renderer's
 * own. */
const zt_manifest *zt_renderer_manifest(const zt_renderer *renderer);

#ifdef __cplusplus
}
#endif
#endif
