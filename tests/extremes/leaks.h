/* Rays at the very edges and corners of closed meshes, as many as asked for: what is right is
 * known without a reference. None gets through; none, mirrored, hits the same mesh twice. */
#ifndef ZT_TESTS_LEAKS_H
#define ZT_TESTS_LEAKS_H

#include "run.h"

extern const extreme_case leaks_case;

/* False where the tracer could not be opened. */
bool run_leaks(run_result *result, int64_t rays, run_how how);

#endif
