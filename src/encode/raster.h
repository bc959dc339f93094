/* Drawings become pixels. The door to librsvg and cairo, a module that is loaded when a drawing
 * is first written as an image (base/module.h). */
#ifndef ZT_ENCODE_RASTER_H
#define ZT_ENCODE_RASTER_H

#include <stdint.h>

#include "base/module.h"

/* 0xRRGGBB in the low bits of each number, as displays show it; rows from the top. */
typedef struct zt_raster {
    int width, height;
    uint32_t *pixels; /* of the caller to free() */
} zt_raster;

typedef struct zt_raster_door {
    /* On white, `scale` pixels for each unit of the drawing's size. ZT_EFILE where the SVG
     * cannot be read or is too large, told; ZT_EMEMORY. */
    zt_status (*draw)(zt_raster *raster, const char *svg, size_t length, double scale,
                      zt_listener listener);
} zt_raster_door;

#endif
