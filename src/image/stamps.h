/* Stamps: which tiles of an image are the same as in others, so that what was made of them
 * there is not made again.
 *
 * Of two images of one run, tiles at the same place whose stamps are equal have the same bits
 * in `pixels`; a stamp of 0 says nothing. Further channels are not meant. Who fills an image
 * stamps its tiles, or forgets the stamps. */
#ifndef ZT_IMAGE_STAMPS_H
#define ZT_IMAGE_STAMPS_H

#include <zoetrope/image.h>

enum { ZT_STAMP_SIDE = 16 }; /* pixels of a tile; those at the right and below may have fewer */

/* How many tiles there are side by side, along a side of so many pixels. */
static inline int zt_stamp_tiles(int side) {
    return (side + ZT_STAMP_SIDE - 1) / ZT_STAMP_SIDE;
}

/* Gives an image stamps, all 0: one for each tile, rows from the top. ZT_EMEMORY. */
zt_status zt_image_add_stamps(zt_image *image);

/* Sets them to 0, where there are any. */
void zt_image_forget_stamps(zt_image *image);

#endif
