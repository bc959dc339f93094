/* Pictures: frames as they were rendered, with what their rays touched. */
#ifndef ZT_RENDER_PICTURE_H
#define ZT_RENDER_PICTURE_H

#include "render/rounds.h"
#include "tracer/footprint.h"

/* What of a tile has a footprint of its own: a quarter, or all of it, which has the first
 * quarter's. */
enum { ZT_PICTURE_PARTS = 4 };

/* All that tiles are copied from. Zeros are closed. */
typedef struct zt_picture {
    zt_hash view;       /* its rays; */
    uint64_t frame_key; /* and its random numbers */
    bool whole;         /* the pixels and footprints of all tiles are there, and belong to it */
    int width, height;
    bool at_edges;            /* pixels are those of the first samples, in the middles; */
    float *pixels;            /* R G B A */
    uint32_t *paths;          /* and there are what these saw, */
    zt_rounds rounds;         /* and what the further ones came to; else they mean nothing */
    zt_footprint *footprints; /* ZT_PICTURE_PARTS for each tile */
    zt_outline outline;
    zt_arena arena; /* the outline's */
} zt_picture;

/* Has it hold pictures of a size; nothing of the one before stays where that is another one. */
zt_status zt_picture_open(zt_picture *picture, int width, int height);
void zt_picture_close(zt_picture *picture); /* leaves zeros */

/* Has an open one hold what there is at edges as well, without any rounds; ZT_EMEMORY. */
zt_status zt_picture_open_edges(zt_picture *picture, bool is_signed);

#endif
