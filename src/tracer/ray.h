/* Rays travel in batches: structures of arrays that loops can take many lanes at a time of. */
#ifndef ZT_TRACER_RAY_H
#define ZT_TRACER_RAY_H

#include <stdalign.h>
#include <stdint.h>

#include "tracer/kernel.h"
#include "tracer/real.h"

/* Values of zt_batch.close: one more was met that near; and so that what the nearest is might
 * depend on the order. */
enum { CLOSE_ONE = 1, CLOSE_SEVERAL = 2 };

/* A batch is a multiple of any number of lanes. */
enum { ZT_BATCH_LANES = 16 };

/* Where rays begin. `source` says on whose surface: -1 for none, else twice the index of the
 * primitive, and one more where the ray goes on inside of it. `near` is the distance within
 * which roundings decide what lies before the ray and what behind: a shadow ray passes what it
 * meets there, as where two walls join, and is inside of what is closed and begins there.
 * `moment` and `between` say when: so far, 0 to 1, on the way from that moment of the exposure
 * to the next; they mean something where the tracer moves.
 */
typedef struct zt_origins {
    alignas(64) real x[ZT_BATCH];
    alignas(64) real y[ZT_BATCH];
    alignas(64) real z[ZT_BATCH];
    alignas(64) real near[ZT_BATCH];
    alignas(64) int32_t source[ZT_BATCH];
    alignas(64) int32_t moment[ZT_BATCH];
    alignas(64) real between[ZT_BATCH];
} zt_origins;

/* Rays o + t d with unit directions, and what they hit. Entries from `count` up to the next
 * multiple of ZT_BATCH_LANES are there for the loops to run over, and mean nothing. */
typedef struct zt_batch {
    zt_origins *from;
    alignas(64) real dx[ZT_BATCH];
    alignas(64) real dy[ZT_BATCH];
    alignas(64) real dz[ZT_BATCH];
    alignas(64) real t[ZT_BATCH]; /* hits count in (0, t); then the distance of the nearest */
    alignas(64) int32_t hit[ZT_BATCH];  /* the index of the primitive, or -1 */
    alignas(64) int32_t part[ZT_BATCH]; /* of a mesh: which triangle */
    /* Of rays that ask many things in any order: whether others were about as near as the
     * nearest. */
    alignas(64) int32_t close[ZT_BATCH];
    int count;
} zt_batch;

static inline int zt_batch_padded(int count) {
    return (count + ZT_BATCH_LANES - 1) / ZT_BATCH_LANES * ZT_BATCH_LANES;
}

/* 0, or how a ray with a source leaves the surface of primitive number `index`. */
static inline int32_t zt_leaving(int32_t source, int32_t index) {
    int32_t how = (source & 1) ? -1 : 1;
    return (source >> 1) == index ? how : 0;
}

/* What roundings can tell apart, as a share of the largest number around. */
#define TIE (16 * REAL_ROUNDING)

/* Of two distances, whether they are so near to each other that a third one between them might
 * be as near as roundings can tell to both, give or take `near`. */
static inline int32_t zt_is_close(real a, real b, real tie, real near) {
    return real_abs(a - b) <= 4 * (tie * real_min(a, b) + near);
}

/* What was close becomes CLOSE_ONE, then CLOSE_SEVERAL. */
static inline int32_t zt_closer(int32_t close, int32_t is_close) {
    return close | is_close | (close & is_close) << 1;
}

#endif
