/* What a batch of rays cannot meet: bounds of its origins and directions against bounds of a
 * primitive (Boulos, Wald and Shirley, "Geometric and arithmetic culling methods for entire ray
 * packets", 2006). Exact: what is left out is not met by any ray, roundings included. */
#ifndef ZT_TRACER_BUNDLE_H
#define ZT_TRACER_BUNDLE_H

#include <string.h>

#include "tracer/primitives.h"
#include "tracer/ray.h"

/* Rays from within a box: in directions of a range, or all to somewhere in a box and no
 * further; then `directions` is the range of the whole way. */
typedef struct zt_bundle {
    zt_box origins, directions;
    bool has_target;
    zt_box target;
    int32_t source;       /* the one on whose surface all rays begin, or -1 */
    int32_t passed_count; /* so many of what is asked one by one are not met, as was found */
} zt_bundle;

/* The bits of a float as an integer, numbered so that the order of the integers is that of the
 * floats: whose least and greatest a compiler finds many at a time without leave to reorder
 * floats. in_order is its own inverse. */
static inline real_bits in_order(real_bits bits) {
    return bits ^ (bits < 0 ? REAL_BITS_MAX : 0);
}

/* The least and the greatest of numbers that come along one by one. */
typedef struct zt_ranging {
    real_bits least, greatest;
} zt_ranging;

#define ZT_RANGING ((zt_ranging){REAL_BITS_MAX, -REAL_BITS_MAX})

static inline void zt_range_add(zt_ranging *range, real value) {
    real_bits bits;
    memcpy(&bits, &value, sizeof bits);
    real_bits number = in_order(bits);
    range->least = number < range->least ? number : range->least;
    range->greatest = number > range->greatest ? number : range->greatest;
}

static inline void zt_range_end(real *low, real *high, const zt_ranging *range) {
    real_bits least = in_order(range->least), greatest = in_order(range->greatest);
    memcpy(low, &least, sizeof *low);
    memcpy(high, &greatest, sizeof *high);
}

static inline zt_box zt_ranges_end(const zt_ranging *x, const zt_ranging *y,
                                   const zt_ranging *z) {
    zt_box box;
    zt_range_end(&box.low.x, &box.high.x, x);
    zt_range_end(&box.low.y, &box.high.y, y);
    zt_range_end(&box.low.z, &box.high.z, z);
    return box;
}

static inline void zt_range(real *low, real *high, const real *values, int count) {
    zt_ranging range = ZT_RANGING;
    for (int i = 0; i < count; i++) zt_range_add(&range, values[i]);
    zt_range_end(low, high, &range);
}

static inline zt_box zt_range3(const real *x, const real *y, const real *z, int count) {
    zt_box box;
    zt_range(&box.low.x, &box.high.x, x, count);
    zt_range(&box.low.y, &box.high.y, y, count);
    zt_range(&box.low.z, &box.high.z, z, count);
    return box;
}

/* The bundle of rays from within a box to points of another one. */
static inline zt_bundle zt_bundle_to(zt_box origins, zt_box target, int32_t source) {
    zt_bundle b = {.origins = origins, .has_target = true, .target = target, .source = source};
    real3 low = target.low, high = target.high;
    b.directions.low =
        (real3){low.x - origins.high.x, low.y - origins.high.y, low.z - origins.high.z};
    b.directions.high =
        (real3){high.x - origins.low.x, high.y - origins.low.y, high.z - origins.low.z};
    return b;
}

/* Of the second of two numbers that is none, the first one is left. */
static inline double least_of(double a, double b) { return b < a ? b : a; }
static inline double most_of(double a, double b) { return b > a ? b : a; }

/* Narrows the distances enter … leave to those at which some ray of a bundle may be between the
 * two sides of a box across one axis, by interval arithmetic: `near` and `far` are how long the
 * way there is at least and at most, `slow` and `fast` the share of it that a step goes. What
 * is no number narrows nothing. */
static inline void zt_narrow(double *enter, double *leave, double near, double far, double slow,
                             double fast) {
    if (near > 0) *enter = most_of(*enter, fast <= 0 ? INFINITY : near / fast);
    if (far < 0) *enter = most_of(*enter, slow >= 0 ? INFINITY : far / slow);
    if (slow > 0) *leave = least_of(*leave, far / slow);
    if (fast < 0) *leave = least_of(*leave, near / fast);
}

/* Where along the rays of a bundle, which have no target, a thing may be met: no ray does so
 * nearer than `near`, and all have by `far`, give or take a few roundings. */
typedef struct zt_depths {
    double near, far;
} zt_depths;

/* False only where no ray of a bundle meets a box, which is grown by more than the roundings of
 * an intersection with what is within. */
static inline bool zt_bundle_meets_at(zt_depths *at, const zt_bundle *b, const zt_box *box,
                                      real stretch) {
    const zt_box *o = &b->origins, *d = &b->directions;
    real size = zt_box_size(o) + zt_box_size(box);
    double room = (double)(size * (BOX_ROUNDINGS * REAL_ROUNDING) * stretch);
    /* The target's own roundings are of the kind that `room` is for as well. */
    double enter = 0, leave = b->has_target ? 1 + 0x1p-10 : INFINITY;
    zt_narrow(&enter, &leave, (double)box->low.x - (double)o->high.x - room,
              (double)box->high.x - (double)o->low.x + room, (double)d->low.x,
              (double)d->high.x);
    zt_narrow(&enter, &leave, (double)box->low.y - (double)o->high.y - room,
              (double)box->high.y - (double)o->low.y + room, (double)d->low.y,
              (double)d->high.y);
    zt_narrow(&enter, &leave, (double)box->low.z - (double)o->high.z - room,
              (double)box->high.z - (double)o->low.z + room, (double)d->low.z,
              (double)d->high.z);
    *at = (zt_depths){enter, INFINITY};
    return !(enter > leave * (1 + 0x1p-20));
}

static inline bool zt_bundle_meets(const zt_bundle *b, const zt_box *box, real stretch) {
    zt_depths unused;
    return zt_bundle_meets_at(&unused, b, box, stretch);
}

/* The least and the greatest of n . v for v in a box. */
static inline void zt_span(double *low, double *high, real3 n, const zt_box *box) {
    double x0 = (double)n.x * (double)box->low.x, x1 = (double)n.x * (double)box->high.x;
    double y0 = (double)n.y * (double)box->low.y, y1 = (double)n.y * (double)box->high.y;
    double z0 = (double)n.z * (double)box->low.z, z1 = (double)n.z * (double)box->high.z;
    *low = least_of(x0, x1) + least_of(y0, y1) + least_of(z0, z1);
    *high = most_of(x0, x1) + most_of(y0, y1) + most_of(z0, z1);
}

/* False only where no ray of a bundle meets a plane: all begin on one side of it, and run away
 * from it or to points on the same side. */
static inline bool zt_bundle_meets_plane(zt_depths *at, const zt_bundle *b, real3 n,
                                         real distance) {
    double low, high, slow, fast;
    *at = (zt_depths){0, INFINITY};
    zt_span(&low, &high, n, &b->origins);
    double room = (double)((zt_box_size(&b->origins) + real_abs(distance)) *
                           (BOX_ROUNDINGS * REAL_ROUNDING));
    bool below = high<(double)distance - room, above = low>(double) distance + room;
    if (!below && !above) return true;
    if (b->has_target) {
        zt_span(&slow, &fast, n, &b->target);
        room += (double)(zt_box_size(&b->target) * (BOX_ROUNDINGS * REAL_ROUNDING));
        return below ? !(fast < (double)distance - room) : !(slow > (double)distance + room);
    }
    zt_span(&slow, &fast, n, &b->directions);
    const double still = (double)(BOX_ROUNDINGS * REAL_ROUNDING);
    /* How far off it the rays begin, and how fast they come nearer. */
    double least = (below ? (double)distance - high : low - (double)distance) - room;
    double most = (below ? (double)distance - low : high - (double)distance) + room;
    double slowest = (below ? slow : -fast) - still, fastest = (below ? fast : -slow) + still;
    if (fastest > 0) at->near = least / fastest;
    if (slowest > 0) at->far = most / slowest;
    return !(fastest < 0);
}

#endif
