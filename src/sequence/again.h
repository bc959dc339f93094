/* Images that are asked for more than once: frames with equal content keys. */
#ifndef ZT_SEQUENCE_AGAIN_H
#define ZT_SEQUENCE_AGAIN_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/image.h>

/* Brings frames with equal keys together: each stands behind the first of its kind, which are
 * in the order in which they were. ZT_EMEMORY. */
zt_status zt_again_group(int64_t *frames, zt_hash *keys, int64_t count);

typedef struct zt_again zt_again;

/* Goes over positions, of which those that are wanted are made in turn; keeps images that come
 * again, though not at once, as long as they are few: 64, and 1 GiB. Keys that are zero are
 * equal to none. `keys` and `wanted` outlive it. ZT_EMEMORY. */
zt_status zt_again_open(zt_again **again, const zt_hash *keys, const bool *wanted,
                        int64_t count);

/* An image with the key of a position, to be copied; NULL where none is kept. */
const zt_image *zt_again_find(const zt_again *again, int64_t position);

/* The image of a position has been made: keeps a copy where it comes again, in the place of
 * others that come later; and forgets it where it does not. ZT_EMEMORY. */
zt_status zt_again_keep(zt_again *again, int64_t position, const zt_image *image);

void zt_again_close(zt_again **again);

/* Copies all numbers, and what the image is of, between images with the same channels. */
void zt_again_copy(zt_image *to, const zt_image *from);

#endif
