#include "tracer/footprint.h"

#include <math.h>

#include "base/diag.h"
#include "tracer/bundle.h"
#include "tracer/pairing.h"

/* Where more things moved than this, those that follow each other in the scene share a box. */
enum { PLACES_MAX = 32 };

/* How many times more room than an intersection's roundings need there is: for what lies within
 * roundings of a ray's end, and for the way from there to where further rays begin. */
#define ROOM 8

void zt_footprint_join(zt_footprint *all, const zt_footprint *f) {
    for (int i = 0; i < ZT_FOOTPRINT_STEPS && f->steps[i].there; i++) {
        zt_footstep *to = &all->steps[i];
        const zt_footstep *from = &f->steps[i];
        zt_hold_box(&to->origins, &from->origins, !to->there);
        zt_hold_box(&to->directions, &from->directions, !to->there);
        if (from->ends) zt_hold_box(&to->points, &from->points, !to->ends);
        to->there = true;
        to->ends |= from->ends;
        to->leaves |= from->leaves;
    }
    all->met |= f->met;
    all->faced |= f->faced;
    all->lit |= f->lit;
    all->doubtful |= f->doubtful;
    all->restless |= f->restless;
}

static zt_sides sides_of(const zt_bvh_box *box) {
    zt_sides s = {.size = 0};
    for (int i = 0; i < 3; i++) {
        s.low[i] = (double)box->low[i];
        s.high[i] = (double)box->high[i];
        s.size = most_of(s.size, most_of(fabs(s.low[i]), fabs(s.high[i])));
    }
    return s;
}

/* ---- what differs ---------------------------------------------------------------------------
 */

static zt_bvh_box around(const zt_bvh_box *a, const zt_bvh_box *b) {
    zt_bvh_box all;
    for (int i = 0; i < 3; i++) {
        all.low[i] = fminf(a->low[i], b->low[i]);
        all.high[i] = fmaxf(a->high[i], b->high[i]);
    }
    return all;
}

static bool overlap(const zt_bvh_box *a, const zt_bvh_box *b) {
    bool meet = true;
    for (int i = 0; i < 3; i++) meet &= a->low[i] <= b->high[i] && b->low[i] <= a->high[i];
    return meet;
}

/* That something was, or is, there. */
static void add_place(zt_differences *d, const zt_outline_thing *thing, bool now) {
    bool bounded = !thing->unbounded;
    for (int i = 0; i < 3; i++) bounded &= thing->box.low[i] <= thing->box.high[i];
    d->all |= !bounded;
    d->stretch = fmaxf(d->stretch, thing->stretch);
    d->places[d->place_count++] = (zt_difference_place){thing->box, now, thing->round};
}

/* One of the two may be NULL, where a thing comes or goes. */
static void add_thing(zt_differences *d, const zt_outline_thing *before,
                      const zt_outline_thing *now, bool same_numbers) {
    bool drawn = !same_numbers && ((before && before->moves) || (now && now->moves));
    bool moved = !before || !now || !zt_hash_equal(before->shape, now->shape) || drawn;
    if (!moved && zt_hash_equal(before->looks, now->looks)) return;
    if (before) d->things |= zt_footprint_bit(before->shape);
    if (!moved) return;
    if (before) add_place(d, before, false);
    if (now) add_place(d, now, true);
    if (!before || !now || !overlap(&before->box, &now->box) || now->round) return;
    d->place_count--;
    d->places[d->place_count - 1] =
        (zt_difference_place){around(&before->box, &now->box), true, false};
}

static zt_pairing_list list_of(const zt_hash *first, size_t stride, int32_t count) {
    return (zt_pairing_list){.first = first, .stride = stride, .count = count};
}

static zt_status add_things(zt_differences *d, const zt_outline *before, const zt_outline *now,
                            bool same_numbers, zt_arena *arena) {
    const zt_outline_thing *was = before->things, *is = now->things;
    zt_pairing p = {.before = list_of(&was->shape, sizeof *was, before->thing_count),
                    .now = list_of(&is->shape, sizeof *is, now->thing_count)};
    int32_t i, k;
    ZT_TRY(zt_pairing_begin(&p, arena));
    while (zt_pairing_next(&i, &k, &p))
        add_thing(d, i < 0 ? NULL : &was[i], k < 0 ? NULL : &is[k], same_numbers);
    return ZT_OK;
}

static void share_boxes(zt_differences *d) {
    int32_t share = (d->place_count + PLACES_MAX - 1) / PLACES_MAX, kept = 0;
    for (int32_t i = 0; i < d->place_count; i++) {
        zt_difference_place place = d->places[i];
        if (i % share > 0) {
            zt_difference_place *shared = &d->places[kept - 1];
            place.box = around(&shared->box, &place.box);
            place.now |= shared->now;
            place.round = false;
            *shared = place;
        } else {
            d->places[kept++] = place;
        }
    }
    d->place_count = kept;
}

/* One of the two may be NULL. Light that is missing is added as nothing, so that a lamp which
 * goes is one that is dimmed; who sees one that comes, or moves, nobody knows. */
static void add_lamp(zt_differences *d, const zt_outline_lamp *before,
                     const zt_outline_lamp *now, bool same_numbers) {
    if (now && !(before && zt_hash_equal(before->place, now->place))) d->light = true;
    if (!before || d->light) return;
    uint64_t bit = zt_footprint_bit(before->place);
    if (!same_numbers && before->drawn) d->drawn_lamps |= bit;
    if (!now || !zt_hash_equal(before->power, now->power)) d->dimmed_lamps |= bit;
}

static zt_status add_lamps(zt_differences *d, const zt_outline *before, const zt_outline *now,
                           bool same_numbers, zt_arena *arena) {
    const zt_outline_lamp *was = before->lamps, *is = now->lamps;
    zt_pairing p = {.before = list_of(&was->place, sizeof *was, before->lamp_count),
                    .now = list_of(&is->place, sizeof *is, now->lamp_count)};
    int32_t i, k;
    ZT_TRY(zt_pairing_begin(&p, arena));
    while (zt_pairing_next(&i, &k, &p))
        add_lamp(d, i < 0 ? NULL : &was[i], k < 0 ? NULL : &is[k], same_numbers);
    d->light |= !zt_hash_equal(before->ambient, now->ambient) ||
                (!same_numbers && (before->ambient_moves || now->ambient_moves));
    return ZT_OK;
}

zt_status zt_differences_find(zt_differences *d, const zt_outline *before,
                              const zt_outline *now, bool same_numbers, zt_arena *arena) {
    *d = (zt_differences){.now = now, .stretch = 1};
    /* Of rays that were left out, and might count now, nothing is known. */
    d->all = !zt_hash_equal(before->rest, now->rest) || (before->blind && !now->blind) ||
             (before->faint && now->brightest > before->brightest);
    if (d->all) return ZT_OK;
    d->order = !zt_hash_equal(before->order, now->order);
    size_t most = (size_t)before->thing_count + (size_t)now->thing_count;
    d->places = ZT_PUSH(arena, zt_difference_place, most);
    if (!d->places) return ZT_EMEMORY;
    ZT_TRY(add_things(d, before, now, same_numbers, arena));
    share_boxes(d);
    d->lamps = ZT_PUSH(arena, zt_sides, (size_t)now->lamp_count);
    if (!d->lamps) return ZT_EMEMORY;
    for (int32_t i = 0; i < now->lamp_count; i++) d->lamps[i] = sides_of(&now->lamps[i].bounds);
    return add_lamps(d, before, now, same_numbers, arena);
}

/* ---- what that touches ----------------------------------------------------------------------
 */

/* Room for roundings around a box that ways from one box to another one may meet. */
static double room_of(const zt_sides *from, const zt_sides *to, const zt_sides *box,
                      float stretch) {
    return (from->size + to->size + box->size) * (double)stretch *
           (double)(ROOM * BOX_ROUNDINGS * REAL_ROUNDING);
}

/* Narrows the shares of a way, from *low to *high of it, to those where a + share b <= 0; what
 * is no number narrows nothing. */
static void cut(double *low, double *high, double a, double b) {
    double at = -a / b;
    if (b > 0 && at < *high) *high = at;
    if (b < 0 && at > *low) *low = at;
    if (b == 0 && a > 0) *high = -1;
}

/* False only where no straight way from one box to another one meets a third: after a share s
 * of such a way it is in a box between them, so much from the one's sides to the other's. */
static bool passes(const zt_sides *from, const zt_sides *to, const zt_sides *box, double room) {
    double low = 0, high = 1, above[3], below[3], rises[3], falls[3];
    for (int i = 0; i < 3; i++) {
        above[i] = from->low[i] - (box->high[i] + room);
        below[i] = box->low[i] - room - from->high[i];
        rises[i] = to->low[i] - from->low[i];
        falls[i] = from->high[i] - to->high[i];
        if ((above[i] > 0 && above[i] + rises[i] > 0) ||
            (below[i] > 0 && below[i] + falls[i] > 0))
            return false;
    }
    for (int i = 0; i < 3; i++) {
        cut(&low, &high, above[i], rises[i]);
        cut(&low, &high, below[i], falls[i]);
    }
    return !(low > high);
}

/* A box's middle, and how far it reaches from there. */
typedef struct reach {
    vec3 middle;
    double radius;
} reach;

static reach reach_of(const zt_sides *b) {
    vec3 low = {b->low[0], b->low[1], b->low[2]}, high = {b->high[0], b->high[1], b->high[2]};
    return (reach){vec3_scale(vec3_add(low, high), 0.5), vec3_length(vec3_sub(high, low)) / 2};
}

/* False only where no such way meets the ball in a box. After a share s of the way it is within
 * radius + s grows of p + s v; how much further from there the ball's middle is, is least at
 * one place, since that is convex. */
static bool passes_ball(const zt_sides *from, const zt_sides *to, const zt_sides *box,
                        double room) {
    reach a = reach_of(from), b = reach_of(to), ball = reach_of(box);
    vec3 v = vec3_sub(b.middle, a.middle), p = vec3_sub(a.middle, ball.middle);
    double grows = b.radius - a.radius, length2 = vec3_dot(v, v), along = vec3_dot(p, v);
    double s = grows > 0 ? 1 : 0, rest = length2 - grows * grows;
    if (rest > 0) {
        double aside2 = most_of(vec3_dot(p, p) - along * along / length2, 0);
        s = grows * sqrt(aside2 / (length2 * rest)) - along / length2;
        s = s > 0 ? s < 1 ? s : 1 : 0;
    }
    double distance = vec3_length(vec3_add(p, vec3_scale(v, s)));
    return !(distance > ball.radius / sqrt(3) + a.radius + s * grows + room);
}

/* A place, and what there is to say of it for all ways. */
typedef struct spot {
    const zt_difference_place *place;
    zt_sides sides;
    float stretch;
} spot;

/* Whether such a way may meet a place. */
static bool way_meets(const zt_sides *from, const zt_sides *to, const spot *s) {
    const double room = room_of(from, to, &s->sides, s->stretch);
    return passes(from, to, &s->sides, room) &&
           (!s->place->round || passes_ball(from, to, &s->sides, room));
}

static zt_box box_of(const zt_bvh_box *b) {
    return (zt_box){{b->low[0], b->low[1], b->low[2]}, {b->high[0], b->high[1], b->high[2]}};
}

/* Whether rays of a step may meet a place; `points` are where they end. */
static bool rays_meet(const zt_footstep *step, const zt_sides *points, const spot *s) {
    const zt_sides origins = sides_of(&step->origins);
    if (!step->leaves && !way_meets(&origins, points, s)) return false;
    zt_bundle bundle = {.origins = box_of(&step->origins),
                        .directions = box_of(&step->directions),
                        .source = -1};
    zt_box box = box_of(&s->place->box);
    return zt_bundle_meets(&bundle, &box, ROOM * s->stretch);
}

/* Whether the shadow rays of a step's points may meet a place. */
static bool shadows_meet(const zt_footprint *f, const zt_sides *points, const zt_differences *d,
                         const spot *s) {
    for (int32_t i = 0; i < d->now->lamp_count; i++) {
        const zt_outline_lamp *lamp = &d->now->lamps[i];
        if (lamp->shadows && (f->faced & zt_footprint_bit(lamp->place)) &&
            way_meets(points, &d->lamps[i], s))
            return true;
    }
    return false;
}

static bool place_touches(const zt_footprint *f, const zt_differences *d,
                          const zt_difference_place *place) {
    const spot s = {place, sides_of(&place->box), d->stretch};
    for (int i = 0; i < ZT_FOOTPRINT_STEPS && f->steps[i].there; i++) {
        const zt_footstep *step = &f->steps[i];
        const zt_sides points = sides_of(&step->points);
        if (place->now && rays_meet(step, &points, &s)) return true;
        if (step->ends && shadows_meet(f, &points, d, &s)) return true;
    }
    return false;
}

bool zt_footprint_touched(const zt_footprint *f, const zt_differences *d) {
    if (d->all || f->restless || (d->light && f->steps[0].ends)) return true;
    if ((d->things & f->met) || (d->drawn_lamps & f->faced) || (d->dimmed_lamps & f->lit))
        return true;
    if (f->doubtful && (d->order || d->place_count > 0)) return true;
    for (int32_t i = 0; i < d->place_count; i++)
        if (place_touches(f, d, &d->places[i])) return true;
    return false;
}
