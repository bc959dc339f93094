/* Settings: what decides an image's pixels besides what the description says, as a text of one
 * line that goes along with the image, and is read again to render it once more. */
#ifndef ZT_SEQUENCE_SETTINGS_H
#define ZT_SEQUENCE_SETTINGS_H

#include <zoetrope/animation.h>
#include <zoetrope/precision.h>
#include <zoetrope/wish.h>

#include <zoetrope/color.h>
#include <zoetrope/film.h>

#include "base/arena.h"
#include "sequence/renderer.h"

typedef struct zt_settings {
    int width, height;
    zt_sampling sampling;   /* of this frame, whatever chose it */
    zt_precision precision; /* as it was asked for */
    unsigned aovs;          /* bits of zt_aov */
    zt_view view;
    zt_color_wish color; /* that counts instead of the view, if it is wished */
    const char *format;  /* of an image's file, as zt_image_wishes_text() has it; or NULL */
    const zt_override *overrides;
    int override_count;
    const char *arithmetic; /* its version */
} zt_settings;

/* A line of JSON, of letters of ASCII alone, in the arena:
 *
 *   {"zoetrope": 1, "arithmetic": "zoetrope 3 x86-64", "size": [1280, 720], "min": 4,
 *    "max": 64, "error": 0.002, "filter": "gaussian", "filter_width": 2.00, "seed": 0,
 *    "precision": "auto", "view": "srgb", "aovs": ["Z"], "format": "bits=half",
 *    "set": ["lamp.intensity", "40"]}
 *
 * "quality": "edges", "mean_max", "seed_fixed" and "color": [config, display, view], with ""
 * for what is not said, are there where they say something. */
zt_status zt_settings_print(const char **text, const zt_settings *settings, zt_arena *arena);

/* The text of a film as a whole, in the arena: samples are those that frames take where nothing
 * else decides. */
zt_status zt_settings_of_film(const char **text, const zt_renderer *renderer,
                              const zt_film_order *order, zt_arena *arena);

/* The texts of a film's frames, which stay until the arena is freed. Zeroed: none yet. */
typedef struct zt_settings_texts {
    zt_arena arena;
    const char *text; /* of the last frame that was asked for */
    zt_sampling sampling;
} zt_settings_texts;

/* Makes texts->text that of a frame; of frames that take the same samples it is one. */
zt_status zt_settings_of_frame(zt_settings_texts *texts, const zt_renderer *renderer,
                               const zt_film_order *order, int64_t frame);

/* The options of an output that it came from; they end with one without a name, and are in the
 * arena.
 */
zt_status zt_settings_options(const zt_wish **options, const zt_settings *settings,
                              zt_arena *arena);

/* Reads such a text; what it holds is in the arena. `path` is the file that it is from, for
 * messages. ZT_EFILE, told, where it is no such thing. */
zt_status zt_settings_read(zt_settings *settings, const char *text, const char *path,
                           zt_arena *arena, zt_listener listener);

#endif
