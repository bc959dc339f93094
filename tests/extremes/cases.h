/* The cases: scenes that ask for trouble, and rays into them. */
#ifndef ZT_TESTS_CASES_H
#define ZT_TESTS_CASES_H

#include "stage.h"

enum {
    CASE_STRICT = 1, /* surfaces coincide, the first must be hit */
    CASE_CLOSED = 2, /* rays that get through are leaks */
    CASE_DOUBLE = 4  /* --precision auto must choose double */
};

typedef struct extreme_case {
    const char *name;
    void (*make)(stage *s, draw *d, double extreme);
    double extreme;   /* what `make` is given: how far, how thin, which shape */
    int scenes, rays; /* scenes in the short run, rays in each */
    int bounces;      /* mirrored rays that are followed */
    int flags;
} extreme_case;

extern const extreme_case cases_plain[];
extern const extreme_case cases_far[];
extern const extreme_case cases_close[];
extern const extreme_case cases_triangles[];
extern const extreme_case cases_transforms[];
extern const extreme_case cases_lights[];
extern const extreme_case cases_nasty[];
/* Further scenes of the one of these, which were wrong once; ended by -1. */
extern const int cases_nasty_again[];

/* All of the above, each list ended by a case without a name. */
extern const extreme_case *const cases_all[];

#endif
