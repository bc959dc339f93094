/* From frame to frame: tiles of which nothing that their rays touched has changed are copied.
 * The same bits as if they were rendered, whatever was rendered before.
 *
 * How it is exact. What the samples of a tile come to is a function of the camera, of where in
 * pixels the samples are (which is keyed by seed and camera), and of what its rays meet. While
 * the camera stands still all numbers are relative to the same place, so that what did not
 * change is the same numbers. What each block of a tile's rays touched is kept as a footprint
 * (tracer/footprint.h), from the frame that was rendered last, and asked about all that differs
 * in the next one; likewise from one of an earlier run, where the caller has it; what concerns
 * all rays at once (the precision, the depth of mirrors, whether things lie on each other) is
 * compared as a whole. Random numbers other than places are keyed by all that the frame holds,
 * so that they change with it: tiles that see lamps with a size, and what moves while the
 * shutter is open, are not copied then, and none are where there is an opening of the lens.
 *
 * Where each pixel takes as many samples, that is all, and a tile that is not touched is
 * copied. Where they are taken in rounds, whether a pixel goes on depends on the ones around as
 * well.
 *
 * Without edges all pixels take a round at the same time, and what one pixel came to is felt a
 * pixel further on with each round but the first. So from tiles that are touched pixels are
 * decided about anew as far as there are such rounds, and to decide about these, as far again;
 * the others' means are copied (render/refine.c). Where a budget bounds the samples of the
 * picture, all depends on all, and nothing is copied.
 *
 * At edges, pixels may join late, and nobody knows how far that goes. All decisions are made
 * again, in the whole picture; but what a pixel's first round came to, its second and so on,
 * follows from its tile's rays, and from what the middles of the pixels around saw: it is kept
 * (render/rounds.h), and looked up where neither is touched. What was seen is told by labels,
 * which things and lamps keep, and of a lamp that is hidden only where it shines: so one that
 * is dimmed touches all that faces it.
 *
 * In both cases footprints grow by all samples that a tile's pixels take, frame by frame, until
 * it is touched. Batches are of one tile each, and of what is not copied; not the same samples
 * as in a picture rendered by itself. That makes no difference but where what is met may depend
 * on the order in which things are asked: where that occurs (a footprint is doubtful), the
 * frame is rendered once more, by itself.
 *
 * A tile that was touched is rendered by quarters, so that of the next frame's only those are
 * that are touched; where it is doubtful, as a whole.
 *
 * What it costs. Taking footprints down takes a hundredth of a frame or two, asking them less;
 * a first frame, and one after the camera moved, take down nothing. Where hardly a tile is
 * copied, it is left for four times as many frames each time. */
#ifndef ZT_RENDER_REUSE_H
#define ZT_RENDER_REUSE_H

#include <stdatomic.h>

#include "render/picture.h"
#include "render/work.h"

/* Parts of a tile: quarters. */
enum {
    ZT_REUSE_ALL = (1 << ZT_PICTURE_PARTS) - 1,
    ZT_REUSE_SIDE = TILE_SIDE / 2,
    ZT_REUSE_PIXELS = ZT_BATCH / ZT_PICTURE_PARTS,
    ZT_REUSE_LOCKS = 64
};

/* Where a tile comes from. */
typedef enum zt_tile_source {
    ZT_TILE_RENDERED,
    ZT_TILE_LAST, /* copied from the frame that was rendered last; */
    ZT_TILE_KEPT  /* from the one that was kept */
} zt_tile_source;

struct zt_reuse {
    bool tireless;
    bool keeps;          /* somebody wants `last` to be whole after each frame */
    zt_picture last;     /* the frame that was rendered last */
    zt_picture *kept;    /* may be like the next one as well; NULL: none. Used up by that */
    uint8_t *from;       /* a zt_tile_source for each tile */
    uint8_t *still;      /* of tiles that are rendered: a bit for each part that need not be */
    uint64_t *stamps;    /* of the tiles of `last` (image/stamps.h): the frame each was new
                            in, where frames are counted from 1 */
    uint64_t serial;     /* of the frame */
    zt_arena spare;      /* the next outline's */
    int fruitless, rest; /* how often too little came of it; how many frames it rests yet */
    int alone;           /* for how many frames nothing is kept yet, after zt_reuse_renounce */
    atomic_flag locks[ZT_REUSE_LOCKS]; /* of the footprints of each so manieth tile */
};

/* Before a picture's tiles: says for each of them whether it is copied, and whether what is
 * rendered is kept. ZT_EMEMORY. */
zt_status zt_reuse_begin(zt_frame *frame);

/* All is rendered once more, as if nothing were kept; nor is it tried soon again. */
void zt_reuse_renounce(zt_frame *frame);

/* After them, `done` or stopped. */
void zt_reuse_end(zt_frame *frame, bool done);

/* Copies a tile into the image, from where it comes, unless that has it already; or from there.
 */
void zt_reuse_copy(zt_frame *frame, int tile, int left, int top, int width, int height);
void zt_reuse_keep(zt_frame *frame, int tile, int left, int top, int width, int height);

/* The same of the parts of a tile that need not be rendered, into the image. To be called
 * before those that are rendered are kept. */
void zt_reuse_copy_parts(zt_frame *frame, int tile, int left, int top);

/* A tile is new in the image, and in what is kept. */
void zt_reuse_stamp(zt_frame *frame, int tile);

/* How far a pixel is from the nearest one that is rendered, along the longer axis; where that
 * is more than `most`, something more. */
int zt_reuse_distance(const zt_frame *frame, int x, int y, int most);

/* Has rays leave a footprint. */
void zt_reuse_watch(zt_rays *rays, zt_footprint *footprint, const zt_frame *frame);

/* Adds the footprint of samples of pixels of a tile, that of such a pixel, from any thread. */
void zt_reuse_note(zt_frame *frame, const zt_footprint *footprint, int column, int row);

static inline zt_footprint *zt_reuse_footprint(const zt_reuse *r, int tile, int first) {
    return &r->last.footprints[tile * ZT_PICTURE_PARTS + first / ZT_REUSE_PIXELS];
}

#endif
