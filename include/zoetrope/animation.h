/* An animation: a description read and checked. Immutable; any number of threads may read it.
 */
#ifndef ZOETROPE_ANIMATION_H
#define ZOETROPE_ANIMATION_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/color.h>
#include <zoetrope/image.h>
#include <zoetrope/rate.h>
#include <zoetrope/sampling.h>
#include <zoetrope/status.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct zt_animation zt_animation;

/* When the shutter is open: from `open` to `close` after a frame's own time, as shares of the
 * time from one frame to the next; the same where it opens for no time at all. */
typedef struct zt_shutter {
    double open, close;
    double error; /* how far, in pixels, anything may be off its curved way meanwhile */
} zt_shutter;

/* What the description says of the film as a whole. Frames are numbered 0 .. frame_count - 1.
 */
typedef struct zt_film {
    int width, height; /* pixels */
    zt_rate rate;
    int64_t frame_count; /* at least 1 */
    zt_view view;
    zt_color_wish color; /* counts instead of the view; its texts are the animation's own */
    zt_sampling sampling;
    bool transparent; /* A is how much of a pixel is covered; else 1 everywhere */
    zt_shutter shutter;
    const char *audio; /* the path of its sound, or NULL; the animation's own */
    unsigned aovs;     /* bits of zt_aov (zoetrope/aov.h) that images have besides R G B A */
} zt_film;

/* How much there is, for a summary. */
typedef struct zt_contents {
    int plane_count, sphere_count, triangle_count, disk_count, box_count, cylinder_count,
        cone_count, torus_count, capsule_count, mesh_count, group_count;
    int64_t mesh_triangle_count; /* over all mesh objects, each use counted */
    int ambient_light_count, point_light_count, disk_light_count, rectangle_light_count;
    int material_count;
    int track_count; /* properties that move */
} zt_contents;

/* What replaces something in a description: "lamp.intensity" by "40". The name is that of a
 * thing, a dot, and one of its keys; things without a name of their own are called by kind and
 * number ("sphere 2"), and "$big" is a variable. The value is YAML, checked as the text is. */
typedef struct zt_override {
    const char *name, *value;
} zt_override;

/* Reads the description at `path` with all that it refers to. All mistakes are told before
 * giving up. ZT_EDESCRIPTION for mistakes, ZT_EFILE when the file itself cannot be read. The
 * caller frees the animation. `overrides` may be NULL where there are none; of two with the
 * same name the last one counts. */
zt_status zt_animation_read(zt_animation **animation, const char *path,
                            const zt_override *overrides, int override_count,
                            zt_listener listener);
void zt_animation_free(zt_animation **animation);

const zt_film *zt_animation_film(const zt_animation *animation);
zt_contents zt_animation_contents(const zt_animation *animation);

/* What the camera's lens is, in words; "" of a perspective pinhole that is given by its fov. */
typedef struct zt_lens_words {
    char text[160];
} zt_lens_words;
zt_lens_words zt_animation_lens(const zt_animation *animation);

/* One thing that moves, in words. */
typedef struct zt_movement {
    const char *name;   /* "ball.center", "camera.fov"; owned by the animation */
    const char *driver; /* of keys "smooth" or what else their curve is; or else "expression",
                           "follow", "orbit", "offset", "look_at" */
    int key_count;      /* 0 where it has no keys */
    double first_s, last_s; /* seconds: of the first and last key, or of the begin and end of
                               what is followed; else 0 */
} zt_movement;

/* `index` from 0 to track_count - 1, in the order of the description. */
zt_movement zt_animation_movement(const zt_animation *animation, int index);

#ifdef __cplusplus
}
#endif
#endif
