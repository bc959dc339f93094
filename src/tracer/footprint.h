/* Footprints: what the rays of some pixels touched of a scene, so that it can be said for sure
 * that what differs in the next frame changes nothing for them (Jevans, "Object space temporal
 * coherence for ray tracing", 1992; bundles and hulls here where that has voxels, since they
 * are known anyway). Of a still camera alone: space is relative to it.
 *
 * A ray's light follows from the nearest things that it and its mirrored rays meet, how these
 * look, the lamps that they face, and whether something is on the way to those. So a footprint
 * has, for the rays and after each mirror, the box that they begin in, the range of their
 * directions, and the box that they end in; which things they ended on; and which lamps' light
 * was asked for there. Something that was met by none of them and changes, or comes from
 * nowhere, makes no difference where it is outside, before and after, of all that space and of
 * what is between the ends and the lamps. All of it is rounded outwards. */
#ifndef ZT_TRACER_FOOTPRINT_H
#define ZT_TRACER_FOOTPRINT_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/hash.h>
#include <zoetrope/status.h>

#include "base/arena.h"
#include "tracer/bvh.h"

typedef struct zt_ready zt_ready;

/* ---- of rays --------------------------------------------------------------------------------
 */

/* Rays after as many mirrors. */
typedef struct zt_footstep {
    zt_bvh_box origins, directions; /* of all of them; directions are unit */
    zt_bvh_box points;              /* where they end */
    bool there;                     /* there are any */
    bool ends;                      /* some end: then there are points */
    bool leaves;                    /* some end nowhere, or beside the points */
} zt_footstep;

/* The last step holds all mirrors that follow as well. */
enum { ZT_FOOTPRINT_STEPS = 4 };

/* Zeroed: of no rays. Sets of things have the bits of their shapes, those of lamps that of
 * their places: so a thing that stays what it is keeps its bit, whatever comes before it. */
typedef struct zt_footprint {
    zt_footstep steps[ZT_FOOTPRINT_STEPS];
    uint64_t met;        /* things that rays ended on */
    uint64_t faced, lit; /* lamps that such points face; and that reach some of them */
    bool doubtful;       /* what was met may depend on in which order things were asked */
    bool restless;       /* nothing is known: it counts as touched by anything */
} zt_footprint;

/* Grows a box by another one; `first`: it is none yet. */
static inline void zt_hold_box(zt_bvh_box *all, const zt_bvh_box *more, bool first) {
    if (first) *all = *more;
    for (int i = 0; i < 3; i++) {
        all->low[i] = all->low[i] < more->low[i] ? all->low[i] : more->low[i];
        all->high[i] = all->high[i] > more->high[i] ? all->high[i] : more->high[i];
    }
}

/* Grows a footprint by that of further rays. */
void zt_footprint_join(zt_footprint *all, const zt_footprint *more);

static inline uint64_t zt_footprint_bit(zt_hash of) { return UINT64_C(1) << (of.low >> 58); }

/* ---- of scenes ------------------------------------------------------------------------------
 */

/* One thing as rays can tell it: equal hashes, equal hits and looks. */
typedef struct zt_outline_thing {
    bool moves; /* while the shutter is open: what rays tell depends on their times */
    bool unbounded, round; /* round: a ball, as wide as the box */
    zt_bvh_box box;
    float stretch; /* as in zt_primitive */
    zt_hash shape, looks;
} zt_outline_thing;

typedef struct zt_outline_lamp {
    bool drawn; /* what rays tell depends on random numbers */
    bool shadows;
    zt_bvh_box bounds;
    zt_hash place, power;
} zt_outline_lamp;

/* A tracer, told in numbers that depend neither on its precision nor on the run. Lives in an
 * arena. */
typedef struct zt_outline {
    zt_outline_thing *things; /* one for each primitive, */
    zt_outline_lamp *lamps;   /* and for each lamp, in order */
    int32_t thing_count, lamp_count;
    zt_hash ambient, rest; /* rest: all that concerns all rays */
    zt_hash order;         /* which things share a hierarchy, that asks them in its own order */
    bool ambient_moves;
    bool blind; /* mirrored rays were left out, since they meet nothing; */
    bool faint; /* or where they are too faint to count, given how bright points are at most */
    double brightest;
} zt_outline;

/* ZT_EMEMORY. */
zt_status zt_outline_make(zt_outline *outline, const zt_ready *ready, zt_arena *arena);

/* What tells things and lamps of a scene apart, by number: it follows from what of them decides
 * where rays meet them, so that it stays the same whatever comes before them. */
typedef struct zt_labels {
    uint32_t *things, *lamps;
} zt_labels;

/* ZT_EMEMORY. */
zt_status zt_labels_make(zt_labels *labels, const zt_ready *ready, zt_arena *arena);

/* ---- between frames -------------------------------------------------------------------------
 */

/* Space where something that moved was, or is. */
typedef struct zt_difference_place {
    zt_bvh_box box;
    bool now;   /* or only before */
    bool round; /* the ball in the box alone */
} zt_difference_place;

/* A box in double precision, and the largest size of its coordinates. */
typedef struct zt_sides {
    double low[3], high[3], size;
} zt_sides;

/* What differs between two outlines, the second of which must be there as long. Things and
 * lamps that came or went in between, or stand elsewhere in the order, are told apart from
 * those that are the same: these are asked in the same order as before. */
typedef struct zt_differences {
    bool all;        /* nothing can be said of anything */
    bool light;      /* what light there is at any point */
    bool order;      /* hierarchies are of other things */
    uint64_t things; /* that went, moved, or look otherwise */
    uint64_t drawn_lamps, dimmed_lamps;
    zt_difference_place *places;
    int32_t place_count;
    float stretch; /* the largest of what moved */
    const zt_outline *now;
    zt_sides *lamps; /* the bounds of its lamps */
} zt_differences;

/* `same_numbers`: the random numbers of both frames are the same. ZT_EMEMORY. */
zt_status zt_differences_find(zt_differences *differences, const zt_outline *before,
                              const zt_outline *now, bool same_numbers, zt_arena *arena);

/* False only where rays with that footprint in the first scene have the same light in the
 * second, and the same footprint. */
bool zt_footprint_touched(const zt_footprint *footprint, const zt_differences *differences);

#endif
