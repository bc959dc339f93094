/* Rendering an image again by what its file says it is of, and comparing. */
#ifndef ZOETROPE_REPRODUCE_H
#define ZOETROPE_REPRODUCE_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/animation.h>
#include <zoetrope/color.h>
#include <zoetrope/image.h>
#include <zoetrope/renderer.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A file that was rendered. */
typedef struct zt_origin {
    const char *path;             /* the caller's */
    zt_image *image;              /* as it is stored; what it is of is known */
    const zt_override *overrides; /* that its description was read with */
    int override_count;
    struct zt_origin_memory *memory; /* where the library keeps the rest */
} zt_origin;

/* Reads an OpenEXR, PNG or TIFF file that zt_film_render() made; `path` must outlive the
 * origin. ZT_EFILE, told, where it cannot be read or does not say how it was rendered. The
 * caller frees it. */
zt_status zt_origin_read(zt_origin **origin, const char *path, zt_listener listener);
void zt_origin_free(zt_origin **origin);

/* How a movie of images that were read shows them, and what it says of its settings: as the
 * film does that they are of. */
typedef struct zt_look {
    zt_view
        view; /* raw where the images are for a display already; srgb where they say nothing */
    zt_color_wish color;
    const char *settings; /* those of the image, but for what is of its file and channels; or
                             NULL */
} zt_look;

/* `view` counts instead of the images' own where it is not NULL. ZT_EMEMORY. The caller frees
 * it. */
zt_status zt_look_find(zt_look **look, const zt_image *image, const zt_view *view);
void zt_look_free(zt_look **look);

/* A number of a pixel that is not as it was. */
typedef struct zt_deviation {
    int column, row;
    const char *channel; /* "R", "Z" */
    double was, is;      /* as they are stored: of integers, 0..1 */
} zt_deviation;

enum { ZT_DEVIATIONS_MAX = 5 };

/* How an image that was rendered again compares with the one of the file. */
typedef struct zt_reproduction {
    int64_t pixel_count, different_count;  /* all pixels; those that are not the same bits */
    zt_deviation first[ZT_DEVIATIONS_MAX]; /* the first number of the first ones */
    int first_count;
    zt_deviation largest; /* of all, where they differ; what is no number is larger than all */
    bool same_arithmetic; /* the program computes as the one did that made the file */
    bool same_key;        /* what is rendered is the same: description, settings, arithmetic */
} zt_reproduction;

/* Renders the origin's frame of an animation, which was read from its description with its
 * overrides, by its settings, writes it as the file was and reads that again. `threads` as in
 * zt_render_settings. Fails as rendering does; ZT_EFILE, told, where the file's size or
 * channels are not those that it was rendered with. The texts of deviations are the origin's.
 */
zt_status zt_reproduce(zt_reproduction *reproduction, const zt_origin *origin,
                       const zt_animation *animation, int threads, const zt_watcher *watcher,
                       zt_listener listener);

#ifdef __cplusplus
}
#endif
#endif
