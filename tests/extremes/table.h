/* The table of results: aligned for people, as CSV for programs. */
#ifndef ZT_TESTS_TABLE_H
#define ZT_TESTS_TABLE_H

#include <stdio.h>

#include "run.h"

/* Where something cannot hold, measured: what is known and why. */
typedef struct limit {
    const char *name; /* of a case */
    probe_precision precision;
    const char *why;
} limit;
extern const limit limits[];
const limit *limit_find(const char *name, probe_precision precision);

extern const char *const table_precisions[]; /* their names */

void table_begin(FILE *csv);
/* One case, a line for each precision; how many of them do not hold, known limits left out. */
int table_case(FILE *csv, const extreme_case *c, const run_result *result);

#endif
