/* Pictures of the cases' scenes: finite, the same on any number of threads, and the light that
 * the reference sees. */
#ifndef ZT_TESTS_PICTURES_H
#define ZT_TESTS_PICTURES_H

#include "run.h"

/* In its tallies rays are pixels; `wrong` are those that show another light than the reference
 * sees anywhere near (in double precision: what single cannot tell apart may look different);
 * `false_hits` those that differ with the number of threads. */
extern const extreme_case pictures_case;

/* One picture of each of `count` scenes of each case. False where the tracer fails. */
bool run_pictures(run_result *result, int count, run_how how);

#endif
