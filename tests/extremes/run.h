/* Runs cases: builds their scenes, asks the tracer, has its answers judged. */
#ifndef ZT_TESTS_RUN_H
#define ZT_TESTS_RUN_H

#include "cases.h"
#include "judge.h"

/* What is allowed: the smallest relative change that makes an answer exact. */
static inline double run_tolerance(probe_precision chosen) {
    return chosen == PROBE_SINGLE ? 1e-6 : 1e-12;
}

typedef enum run_how {
    RUN_JUDGED,
    RUN_TOLD,   /* the first mistakes of each kind are printed as well */
    RUN_ANSWERS /* not judged: for the digest alone */
} run_how;

enum { RUN_ALL_PRECISIONS = (1 << PROBE_PRECISIONS) - 1 };

typedef struct run_result {
    tally tallies[PROBE_PRECISIONS];
    int64_t chose_single; /* scenes for which auto did */
    int64_t scenes;
    bool asked[PROBE_PRECISIONS];
    uint64_t digest[PROBE_PRECISIONS]; /* of all answers, bit by bit */
} run_result;

/* Scenes from number `first` on, `count` of them, in the precisions of which `precisions` has
 * the bit; where `first` < 0, those of the short run, `count` of them where that is above 0.
 * False where the tracer could not be opened. */
bool run_case(run_result *result, const extreme_case *c, int first, int count,
              unsigned precisions, run_how how);

#endif
