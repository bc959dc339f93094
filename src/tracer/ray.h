/* Rays travel in batches: structures of arrays that loops can take many lanes at a time of. */
#ifndef ZT_TRACER_RAY_H
#define ZT_TRACER_RAY_H

#include <stdalign.h>
#include <stdint.h>

#include "tracer/real.h"

/* Rays in a batch, at most: a tile of 16 x 16 pixels. A multiple of any number of lanes. */
enum { ZT_BATCH = 256, ZT_BATCH_LANES = 16 };

/* Rays o + t d with unit directions, and what they hit. Entries from `count` up to the next
 * multiple of ZT_BATCH_LANES are there for the loops to run over, and mean nothing. */
typedef struct zt_batch {
    alignas(64) real ox[ZT_BATCH];
    alignas(64) real oy[ZT_BATCH];
    alignas(64) real oz[ZT_BATCH];
    alignas(64) real dx[ZT_BATCH];
    alignas(64) real dy[ZT_BATCH];
    alignas(64) real dz[ZT_BATCH];
    alignas(64) real t[ZT_BATCH]; /* hits count in (0, t); then the distance of the nearest */
    alignas(64) int32_t hit[ZT_BATCH];  /* the index of the primitive, or -1 */
    alignas(64) int32_t part[ZT_BATCH]; /* of a mesh: which triangle */
    int count;
} zt_batch;

static inline int zt_batch_padded(int count) {
    return (count + ZT_BATCH_LANES - 1) / ZT_BATCH_LANES * ZT_BATCH_LANES;
}

#endif
