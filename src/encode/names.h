/* The names of numbered images: "shots/{layer}.####.exr" with a number, and with a layer. */
#ifndef ZT_ENCODE_NAMES_H
#define ZT_ENCODE_NAMES_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/status.h>

#include "image/layers.h"

/* Zeroed: none. */
typedef struct zt_names {
    char *before,
        *after; /* the target around the place of the number; `after` NULL: no place */
    int digits; /* the least that are written */
    char (*layers)[ZT_LAYER_NAME_MAX]; /* each has its own file; NULL: one has all */
    int count;                         /* of files that a frame has */
} zt_names;

/* Takes a target apart. Where it has a place for it, {layer}, there is a file for colours and
 * one for each layer of `aovs` (zt_aov). ZT_EARGUMENT after telling why not. */
zt_status zt_names_read(zt_names *names, const char *target, unsigned aovs,
                        zt_listener listener);
void zt_names_free(zt_names *names);

/* The path of a frame's file, 0 .. count - 1, of the caller to free; NULL when out of memory.
 * Digits are counted without the sign. */
char *zt_names_path(const zt_names *names, int64_t frame, int file);

/* Which layer that file has; NULL: all. */
const char *zt_names_layer(const zt_names *names, int file);

#endif
