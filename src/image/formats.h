/* The formats of image files, and what may be wished for of each. */
#ifndef ZT_IMAGE_FORMATS_H
#define ZT_IMAGE_FORMATS_H

#include <stdbool.h>

#include <zoetrope/status.h>
#include <zoetrope/wish.h>

#include "image/color.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How a number is stored: integers of so many bits are developed by the view, floats are linear
 * light as it is. */
typedef enum zt_depth {
    ZT_DEPTH_8,
    ZT_DEPTH_10,
    ZT_DEPTH_12,
    ZT_DEPTH_16,
    ZT_DEPTH_HALF,
    ZT_DEPTH_FLOAT,
    ZT_DEPTH_COUNT
} zt_depth;

typedef struct zt_compression {
    const char *name;         /* OpenImageIO's; NULL after the last */
    int lowest, highest, own; /* its level, and that where none is wished for; 0, 0 without */
} zt_compression;

typedef struct zt_image_format {
    const char *endings[3];          /* with their dots; NULL after the last */
    zt_depth depths[ZT_DEPTH_COUNT]; /* the first is the usual one */
    int depth_count;
    const zt_compression *compressions; /* the first is the usual one; NULL: none to choose */
    const char *of_floats;              /* that of floats, where it is another */
    bool has_tiles, has_alpha;
    bool has_layers; /* further channels, in one part or in several */
} zt_image_format;

/* What is wished for. */
typedef struct zt_image_wishes {
    const zt_image_format *format;
    zt_depth depth;
    const zt_compression *compression; /* NULL where there is none to choose */
    int level;                         /* of the compression; 0 where it has none */
    int tile;                          /* pixels, the side of a tile; 0: rows */
    const zt_color *color;             /* that integers are developed by; NULL: by a view */
    bool parts;                        /* each layer (image/layers.h) is a part of its own */
    const char *layer;                 /* the one that is written, or NULL: all of them */
} zt_image_wishes;

/* The endings of all formats; NULL after the last. */
extern const char *const zt_image_file_endings[];

/* The name of the wishes that are for image files; NULL after the last. */
extern const char *const zt_image_file_options[];

/* What is wished for of a file whose name ends as `name` does, by wishes called "format-option"
 * with values "bits=16", "compression=dwaa:45", "tile=64", "parts=layers". `options` may be
 * NULL, and may hold others. ZT_EUNSUPPORTED, ZT_EARGUMENT after telling what there is instead.
 */
zt_status zt_image_wish(zt_image_wishes *wishes, const char *name, const zt_wish *options,
                        zt_listener listener);

/* All of it as options, "bits=half,compression=zip:4,tile=64", so that it says the same
 * wherever something else is the usual one. Of the caller to free; NULL when out of memory. */
char *zt_image_wishes_text(const zt_image_wishes *wishes);

#ifdef __cplusplus
}
#endif
#endif
