/* Many frames: an animation becomes images, in order, and goes to an output. */
#ifndef ZOETROPE_RENDERER_H
#define ZOETROPE_RENDERER_H

#include <zoetrope/animation.h>
#include <zoetrope/image.h>
#include <zoetrope/output.h>
#include <zoetrope/precision.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct zt_renderer zt_renderer;

/* Zero means: as the description says, or as the machine offers (threads). */
typedef struct zt_render_settings {
    int width, height;      /* pixels; both or neither */
    int samples;            /* a pixel */
    int threads;            /* one a core by default; the images do not depend on it */
    zt_precision precision; /* where single is not enough for a frame, a warning tells, once */
    unsigned aovs;          /* bits of zt_aov, besides those that the description asks for */
    bool no_reuse;          /* nothing is copied from the frame before, which changes no bit */
    bool check_reuse; /* each frame is rendered both ways, and an error where a bit differs */
} zt_render_settings;

/* Is told after each frame of a sequence, and asked often, from any thread, whether to stop. */
typedef struct zt_watcher {
    void (*progress)(void *user, int64_t done_count, int64_t total_count, int64_t frame);
    bool (*stopped)(void *user);
    void *user;
} zt_watcher;

/* `animation` must outlive the renderer. The caller closes it. */
zt_status zt_renderer_open(zt_renderer **renderer, const zt_animation *animation,
                           const zt_render_settings *settings, zt_listener listener);
void zt_renderer_close(zt_renderer **renderer);

/* What an output for this renderer's images has to be told, but for how many come. */
zt_output_format zt_renderer_format(const zt_renderer *renderer);

/* Renders one frame into an image of the renderer's size. Frames outside of the film's range
 * are legal: their curves hold. ZT_ESTOPPED when the watcher (may be NULL) said so. */
zt_status zt_renderer_frame(zt_renderer *renderer, int64_t frame, zt_image *image,
                            const zt_watcher *watcher);

/* The content key of a frame: a hash of all that decides its pixels, which are the frozen
 * scenes of its opening, what its meshes hold, the settings (size, sampling, precision,
 * channels, background), and the version of the arithmetic; so neither names nor comments, nor
 * how the image will be written. Fails as freezing does. */
zt_status zt_renderer_key(zt_hash *key, zt_renderer *renderer, int64_t frame);

/* What is chosen for a frame, and why: in which precision it is rendered, and at how many
 * moments of the shutter's opening it is looked at; between them everything goes straight on.
 */
typedef struct zt_frame_choices {
    zt_precision precision; /* not ZT_PRECISION_AUTO */
    int moment_count;       /* 1 where nothing moves */
    int64_t cause; /* the same for frames of which the same is to say but for numbers */
    char precision_text[320]; /* "double precision: the camera is 0.001 from ground, ..." */
    char motion_text[512];    /* "180 degrees open: 17 moments, because of wheel; ..."; "" where
                                 the shutter opens for no time */
} zt_frame_choices;

/* Finds out without rendering. Fails as rendering does. */
zt_status zt_renderer_choices(zt_frame_choices *choices, zt_renderer *renderer, int64_t frame);

#ifdef __cplusplus
}
#endif
#endif
