/* How long a test lets something compute: in pieces of work of a fixed size, measured in the
 * same run by processor time, so that it says as much on a slow or busy machine. A piece sorts
 * 100,000 numbers: some 10 ms where this was written. */
#ifndef ZT_TEST_PATIENCE_H
#define ZT_TEST_PATIENCE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include <cmocka.h>

#include "base/random.h"

/* Processor seconds of this process. */
static inline double computed_s(void) { return (double)clock() / CLOCKS_PER_SEC; }

static inline int patience_order(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* What a piece takes, measured once. */
static inline double piece_s(void) {
    enum { NUMBERS = 100000 };
    static uint64_t numbers[NUMBERS];
    static double taken_s;
    if (taken_s > 0) return taken_s;
    double begin_s = computed_s();
    for (uint64_t i = 0; i < NUMBERS; i++) numbers[i] = zt_random_key(i, 0);
    qsort(numbers, NUMBERS, sizeof *numbers, patience_order);
    return taken_s = computed_s() - begin_s;
}

/* Fails where what began at `begin_s` has computed for longer than so many pieces. */
static inline void assert_within(double begin_s, double pieces) {
    double taken_s = computed_s() - begin_s;
    if (taken_s > pieces * piece_s())
        fail_msg("%g s of computing are %g pieces, of %g", taken_s, taken_s / piece_s(),
                 pieces);
}

#endif
