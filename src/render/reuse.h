/* From frame to frame: tiles of which nothing that their rays touched has changed are copied.
 * The same bits as if they were rendered, whatever was rendered before.
 *
 * How it is exact. In a picture of which each pixel takes as many samples, a tile is a function
 * of the camera, of where in pixels the samples are (which is keyed by seed and camera), and of
 * what its rays meet. While the camera stands still all numbers are relative to the same place,
 * so that what did not change is the same numbers. What each block of a tile's rays touched is
 * kept as a footprint (tracer/footprint.h), from the frame that was rendered last, and asked
 * about all that differs in the next one; what concerns all rays at once (the precision, the
 * depth of mirrors, whether things lie on each other) is compared as a whole. Random numbers
 * other than places are keyed by all that the frame holds, so that they change with it: tiles
 * that see lamps with a size, and what moves while the shutter is open, are not copied then,
 * and none are where there is an opening of the lens.
 *
 * Adaptive samplings go from pixel to pixel as far as what they find leads; their pictures are
 * not copied from.
 *
 * What it costs. Taking footprints down takes a hundredth of a frame or two, asking them less;
 * a first frame, and one after the camera moved, take down nothing. Where hardly a tile is
 * copied, it is left for twice as many frames each time. */
#ifndef ZT_RENDER_REUSE_H
#define ZT_RENDER_REUSE_H

#include "render/work.h"
#include "tracer/footprint.h"

/* What of a tile has a footprint of its own: a quarter, or all of it. */
enum { ZT_REUSE_PARTS = 4 };

struct zt_reuse {
    bool tireless;
    /* Of the last frame that was rendered: its pictures' rays, and the random numbers. */
    zt_hash view;
    uint64_t frame_key;
    bool whole; /* the pixels and footprints of all tiles are there, and belong to it */
    int width, height;
    float *pixels;
    zt_footprint *footprints; /* ZT_REUSE_PARTS for each tile */
    bool *touched;            /* each tile, by what differs now */
    zt_arena arenas[2];
    zt_outline outlines[2];
    int last;            /* which of the two is its */
    int fruitless, rest; /* how often too little came of it; and how many frames it rests yet */
};

/* Before an even picture's tiles: says for each of them whether it is copied, and whether what
 * is rendered is kept. ZT_EMEMORY. */
zt_status zt_reuse_begin(zt_frame *frame);

/* After them, `done` or stopped. */
void zt_reuse_end(zt_frame *frame, bool done);

/* Copies a tile, into the image or from there. */
void zt_reuse_copy(zt_frame *frame, int left, int top, int width, int height);
void zt_reuse_keep(zt_frame *frame, int left, int top, int width, int height);

static inline zt_footprint *zt_reuse_footprint(const zt_reuse *r, int tile, int first) {
    return &r->footprints[tile * ZT_REUSE_PARTS + first / (ZT_BATCH / ZT_REUSE_PARTS)];
}

#endif
