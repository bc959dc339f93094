/* Checksums of images: a hash of those of all tiles, so that of an image only tiles that are
 * new need be read (image/stamps.h). */
#ifndef ZT_SEQUENCE_SUMS_H
#define ZT_SEQUENCE_SUMS_H

#include <zoetrope/image.h>

/* What the tiles of images of one run added up to; for any thread. */
typedef struct zt_sums zt_sums;
zt_status zt_sums_open(zt_sums **sums);
void zt_sums_close(zt_sums **sums);

/* How many tiles were not added up again; once none is being added up any more. */
int64_t zt_sums_spared(const zt_sums *sums);

/* A checksum of all numbers of an image, further channels too. `sums` may be NULL: nothing of
 * it is known. ZT_EMEMORY. */
zt_status zt_sums_of(zt_hash *checksum, zt_sums *sums, const zt_image *image);

#endif
