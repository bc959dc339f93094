/* Pairs what two lists have in common, in order, so that of two frames' things those are told
 * apart that came, went, or stand elsewhere among the others. */
#ifndef ZT_TRACER_PAIRING_H
#define ZT_TRACER_PAIRING_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <zoetrope/hash.h>
#include <zoetrope/status.h>

#include "base/arena.h"

/* Hashes: the first one, and how many bytes it is from each to the next. */
typedef struct zt_pairing_list {
    const void *first;
    size_t stride;
    int32_t count;
    int32_t next, end; /* of what is not the same in both, at the begin and at the end */
    int32_t *table;    /* of these the last place of each hash; -1: none */
    uint32_t mask;
} zt_pairing_list;

typedef struct zt_pairing {
    zt_pairing_list before, now;
} zt_pairing;

/* Both lists without what is not yet known of them. ZT_EMEMORY. */
zt_status zt_pairing_begin(zt_pairing *pairing, zt_arena *arena);

/* The next of both lists, or of one of them alone, the other one being -1; each list in its
 * order. Two that come together are equal, or neither of them is anywhere else in the other
 * list. False behind the last. */
bool zt_pairing_next(int32_t *before, int32_t *now, zt_pairing *pairing);

#endif
