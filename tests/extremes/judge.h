/* Holds what the tracer says of a ray against the reference, and keeps the worst. */
#ifndef ZT_TESTS_JUDGE_H
#define ZT_TESTS_JUDGE_H

#include "probe.h"
#include "reference.h"

/* Errors are backward errors: the smallest relative change of the numbers of ray and primitive
 * that makes the answer exact. */
typedef struct tally {
    int64_t rays, hits;
    double hit;         /* worst of distances */
    double point;       /* of points, where further rays begin */
    double lift;        /* of the same on meshes, which are left by a few roundings */
    double normal;      /* of normals */
    double mirror;      /* of mirrored directions, given the normal */
    double forward;     /* worst relative error of the distance over its condition number */
    double relative;    /* worst relative error of the distance, */
    double condition;   /* and the worst condition number */
    int64_t wrong;      /* another surface than the nearest */
    int64_t missed;     /* nothing where there is something */
    int64_t false_hits; /* something where there is nothing, or the surface that a ray leaves */
    int64_t leaks;      /* light that went through a surface, or ways through a closed one */
    int64_t acne;       /* points that nothing shadows, in shadow */
    int64_t ties;       /* answers that the smallest changes within the tolerance make right */
    int64_t beyond;     /* answers with an error beyond the tolerance */
    int64_t not_finite;
    double seconds; /* of the tracer, for all rays with their shadows */
} tally;

typedef struct judge {
    const ref_scene *ref;
    double tolerance; /* the backward error that is allowed; closer things are ties */
    bool strict;      /* of surfaces that coincide the first must be hit */
    bool closed;      /* what is missed is a leak */
    bool lights;      /* whether to look at shadows */
    bool verbose;     /* print what is wrong */
    const char *name; /* of the case, */
    int scene;        /* the scene of it, */
    const char *how;  /* and the precision */
    tally *tally;
} judge;

/* `expected` is the reference's answer for the ray. */
void judge_probe(const judge *j, const ref_ray *ray, ref_hit expected, const probe *answer);

/* Parts of the above: each light, and the normal and the lights of a smooth mesh. */
void judge_lights(const judge *j, const ref_ray *ray, real scale, const probe *answer);
void judge_smooth(const judge *j, const ref_ray *ray, ref_hit expected, const probe *answer);

/* Counts a mistake, and prints it where that is asked for. */
void judge_count(const judge *j, int64_t *counter, const char *what, const ref_ray *ray,
                 ref_hit expected, const probe *answer);

/* Keeps the worst of an error, and counts, as `beyond`, what is more than `most`. */
void judge_error(const judge *j, double *kept, real error, double most, const char *what,
                 const ref_ray *ray, ref_hit expected, const probe *answer);

/* Whether all that must hold does. */
bool tally_holds(const tally *t, double tolerance);

#endif
