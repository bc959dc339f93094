#include "sequence/shutter.h"

#include <float.h>
#include <math.h>

#include "sequence/kinks.h"

enum {
    TESTS = 3, /* within an interval */
    /* Within the first one, and moments next to keys: more where a scene is small. */
    LOOKS_LEAST = 4,
    LOOKS_MOST = 64,
    FIRST_TESTS_MOST = 16,
    LOOKS_WORK = 80 * 1000, /* objects and tracks */
    /* Intervals that are still to be looked at: what may be halved 12 times, from each of the
     * first ones. */
    PENDING_MAX = LOOKS_MOST + 64
};

/* All moments of an opening take no more memory. */
#define MEMORY_MAX (512.0 * 1024 * 1024)

/* What is off its way for no longer than this share of the opening cannot be seen: it is while
 * something else changes at once. */
#define LOST_MOST (1.0 / 64)

/* What never leaves its place by more than this share of what is allowed is still. */
#define STILL (1.0 / 64)

typedef struct opening {
    const zt_animation *animation;
    zt_arena *arena;
    zt_listener listener;
    int64_t frame;
    zt_chords chords;
    int32_t *splits;  /* for each part, how often it asked */
    zt_glance *spare; /* a list of looks to use again */
    const zt_glance *first;
    bool moves;
    zt_glance *pending[PENDING_MAX]; /* moments still to come, the next one last */
    int pending_count;
    zt_glance *moments[ZT_TIME_CELLS + 1];
    bool steps[ZT_TIME_CELLS + 1]; /* of the way from each moment to the next one: it is one, */
    zt_gap gaps[ZT_TIME_CELLS + 1]; /* and what is off it */
    int32_t moment_count, moments_most;
    bool refused;      /* something asked for more moments than there may be; then */
    double widest;     /* only intervals that are wider than this are halved, so that all of the
                          opening has its share of what there may be; else 0 */
    double step_share; /* of the largest step, */
    const zt_glance *step_from, *step_to; /* which is between these */
} opening;

double zt_shutter_time(const zt_animation *animation, int64_t frame, double cell) {
    const zt_film *film = &animation->film;
    const zt_shutter *shutter = &film->shutter;
    double share = shutter->open + cell / ZT_TIME_CELLS * (shutter->close - shutter->open);
    return zt_rate_time(film->rate, frame) + share * film->rate.den / film->rate.num;
}

static zt_status look_again(zt_glance *look, opening *o, double cell) {
    look->cell = cell;
    return zt_glance_at(look, &o->chords, zt_shutter_time(o->animation, o->frame, cell),
                        o->listener);
}

static zt_status look_at(zt_glance **out, opening *o, double cell) {
    zt_glance *look = o->spare;
    if (look)
        o->spare = look->next;
    else
        look = zt_glance_push(&o->chords, o->arena);
    if (!look) return ZT_EMEMORY;
    *out = look;
    ZT_TRY(look_again(look, o, cell));
    if (!o->moves)
        o->moves = zt_chords_gap(&o->chords, o->first, o->first, look, 0).share > STILL;
    return ZT_OK;
}

static void give_back(opening *o, zt_glance *look) {
    look->next = o->spare;
    o->spare = look;
}

/* Where in an interval it is tested, as shares: first in the middle, then at multiples of the
 * golden section, which no period has. */
static double test_place(int test) {
    const double golden = 0.38196601125010515;
    return test == 0 ? 0.5 : test * golden - floor(test * golden);
}

/* Tests the interval between two moments: `split` becomes the first look that is off its way,
 * or NULL. */
static zt_status test(zt_glance **split, zt_gap *gap, opening *o, const zt_glance *a,
                      const zt_glance *b, int tests) {
    double wide = b->cell - a->cell, before = -1;
    *split = NULL;
    *gap = (zt_gap){0, -1};
    for (int i = 0; i < tests; i++) {
        double cell = a->cell + rint(test_place(i) * wide);
        if (cell == before || cell <= a->cell || cell >= b->cell) continue;
        before = cell;
        zt_glance *look;
        ZT_TRY(look_at(&look, o, cell));
        zt_gap here = zt_chords_gap(&o->chords, a, b, look, (cell - a->cell) / wide);
        if (here.share > gap->share) *gap = here;
        if (here.share > 1) {
            *split = look;
            return ZT_OK;
        }
        give_back(o, look);
    }
    return ZT_OK;
}

/* Between neighboring multiples: what is off its way there goes too fast, or changes at once;
 * then it is as at one end or as at the other. */
static zt_status test_narrow(bool *step, zt_gap *gap, opening *o, const zt_glance *a,
                             const zt_glance *b) {
    zt_gap left = {0, -1};
    *gap = left;
    for (int i = 1; i <= TESTS; i++) {
        double at = test_place(i);
        zt_glance *look;
        ZT_TRY(look_at(&look, o, a->cell + at));
        zt_gap here = zt_chords_gap(&o->chords, a, b, look, at);
        zt_gap as_a = zt_chords_gap(&o->chords, a, a, look, 0);
        zt_gap as_b = zt_chords_gap(&o->chords, b, b, look, 0);
        give_back(o, look);
        if (here.share > gap->share) *gap = here;
        if (as_b.share < as_a.share) as_a = as_b;
        if (as_a.share > left.share) left = as_a;
    }
    *step = gap->share > 1 && left.share < gap->share;
    if (!*step) return ZT_OK;
    if (gap->share > o->step_share) {
        o->step_share = gap->share;
        o->step_from = a;
        o->step_to = b;
    }
    *gap = left;
    return ZT_OK;
}

/* The next moment is taken, or another one before it is. */
static zt_status advance(opening *o) {
    zt_glance *a = o->moments[o->moment_count - 1], *b = o->pending[o->pending_count - 1];
    bool narrow = b->cell - a->cell <= 1, step = false;
    zt_glance *split = NULL;
    zt_gap gap;
    if (narrow)
        ZT_TRY(test_narrow(&step, &gap, o, a, b));
    else
        ZT_TRY(test(&split, &gap, o, a, b, TESTS));
    bool room = o->moment_count + o->pending_count < o->moments_most;
    if (split && room && b->cell - a->cell > o->widest) {
        double middle = a->cell + rint((b->cell - a->cell) / 2);
        if (o->widest > 0 && split->cell != middle) ZT_TRY(look_again(split, o, middle));
        o->splits[gap.part]++;
        o->pending[o->pending_count++] = split;
        return ZT_OK;
    }
    if (split) give_back(o, split);
    if (split && !room) o->refused = true;
    o->steps[o->moment_count - 1] = step;
    o->gaps[o->moment_count - 1] = gap;
    o->moments[o->moment_count++] = b;
    o->pending_count--;
    return ZT_OK;
}

/* The first intervals: the whole opening, divided by keys that fall into it. */
static zt_status begin(opening *o) {
    const zt_animation *animation = o->animation;
    int work = animation->rest.object_count + animation->track_count + 1;
    int looks = LOOKS_WORK / work, cells[LOOKS_MOST];
    looks = looks < LOOKS_LEAST ? LOOKS_LEAST : looks > LOOKS_MOST ? LOOKS_MOST : looks;
    zt_glance *last, *split;
    zt_gap gap;
    o->moments[o->moment_count++] = (zt_glance *)o->first;
    ZT_TRY(look_at(&last, o, ZT_TIME_CELLS));
    o->pending[o->pending_count++] = last;
    int count = zt_kinks(cells, looks, animation, zt_shutter_time(animation, o->frame, 0),
                         zt_shutter_time(animation, o->frame, ZT_TIME_CELLS));
    while (count-- > 0) ZT_TRY(look_at(&o->pending[o->pending_count++], o, cells[count]));
    if (o->pending_count > 1) return ZT_OK;
    int tests = looks < FIRST_TESTS_MOST ? looks : FIRST_TESTS_MOST;
    ZT_TRY(test(&split, &gap, o, o->first, last, tests));
    if (!split) return ZT_OK;
    o->splits[gap.part]++;
    o->pending[o->pending_count++] = split;
    return ZT_OK;
}

/* Whether the way from one moment to another passes the one between them, which ends the
 * intervals `first` and `second`: nothing is off it by more than it was off its own way, and
 * what the one between is off. */
static bool passes(zt_gap *gap, const opening *o, int32_t first, int32_t second) {
    if (o->steps[first] || o->steps[second]) return false;
    const zt_glance *a = o->moments[first], *b = o->moments[second],
                    *c = o->moments[second + 1];
    zt_gap own =
        o->gaps[first].share > o->gaps[second].share ? o->gaps[first] : o->gaps[second];
    *gap = zt_chords_gap(&o->chords, a, c, b, (b->cell - a->cell) / (c->cell - a->cell));
    if (own.share > gap->share) gap->part = own.part;
    gap->share += own.share;
    return gap->share <= 1;
}

/* Leaves out moments that are passed anyway. */
static void thin_out(opening *o) {
    int32_t kept = 0;
    for (int32_t i = 1; i < o->moment_count; i++) {
        zt_gap gap;
        if (i < o->moment_count - 1 && passes(&gap, o, kept, i)) {
            o->gaps[kept] = gap;
            continue;
        }
        kept++;
        o->moments[kept] = o->moments[i];
        o->steps[kept] = o->steps[i];
        o->gaps[kept] = o->gaps[i];
    }
    o->moment_count = kept + 1;
}

static zt_status bisect(opening *o) {
    ZT_TRY(begin(o));
    while (o->pending_count > 0) ZT_TRY(advance(o));
    return ZT_OK;
}

static zt_status divide(opening *o) {
    double size = (double)zt_chords_glance_size(&o->chords);
    o->moments_most = ZT_TIME_CELLS + 1;
    if (MEMORY_MAX / size < o->moments_most) o->moments_most = (int32_t)(MEMORY_MAX / size);
    o->splits = ZT_PUSH(o->arena, int32_t, (size_t)o->chords.part_count);
    if (!o->splits) return ZT_EMEMORY;
    ZT_TRY(bisect(o));
    if (o->refused) {
        while (o->moment_count > 1) give_back(o, o->moments[--o->moment_count]);
        o->moment_count = 0;
        o->step_share = 0;
        o->widest = 2.0 * ZT_TIME_CELLS / o->moments_most;
        ZT_TRY(bisect(o));
    }
    thin_out(o);
    return ZT_OK;
}

/* ---- what comes of it -----------------------------------------------------------------------
 */

static zt_status write_exposure(zt_exposure *exposure, const opening *o) {
    size_t count = (size_t)o->moment_count;
    zt_scene *moments = ZT_PUSH(o->arena, zt_scene, count);
    double *times = ZT_PUSH(o->arena, double, count);
    bool *steps = ZT_PUSH(o->arena, bool, count);
    if (!moments || !times || !steps) return ZT_EMEMORY;
    for (size_t i = 0; i < count; i++) {
        moments[i] = o->moments[i]->scene;
        times[i] = o->moments[i]->cell / ZT_TIME_CELLS;
        steps[i] = o->steps[i];
    }
    *exposure = (zt_exposure){
        .moments = moments, .times = times, .steps = steps, .moment_count = o->moment_count};
    return ZT_OK;
}

/* The track whose value changes most between two moments, for its size. */
static int32_t track_between(const zt_animation *animation, const zt_scene *a,
                             const zt_scene *b) {
    double most = 0;
    int32_t found = -1;
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        double x[ZT_VALUE_WIDTH_MAX], y[ZT_VALUE_WIDTH_MAX], off = 0, size = 0;
        zt_property_get(x, track->property, a, track->index);
        zt_property_get(y, track->property, b, track->index);
        for (int c = 0; c < zt_value_width(track->property->kind); c++) {
            off = fmax(off, fabs(y[c] - x[c]));
            size = fmax(size, fmax(fabs(x[c]), fabs(y[c])));
        }
        if (!(off > most * size)) continue;
        most = off / size;
        found = i;
    }
    return found;
}

/* What is off most. What is off by more than is allowed counts if it is so for long enough. */
static zt_gap worst_gap(const opening *o) {
    zt_gap worst = {0, -1}, beyond = {0, -1};
    double cells = 0;
    for (int32_t i = 0; i < o->moment_count - 1; i++) {
        zt_gap *most = o->gaps[i].share > 1 ? &beyond : &worst;
        if (o->gaps[i].share > most->share) *most = o->gaps[i];
        if (most == &beyond) cells += o->moments[i + 1]->cell - o->moments[i]->cell;
    }
    return cells > LOST_MOST * ZT_TIME_CELLS ? beyond : worst;
}

static void write_division(zt_division *division, const opening *o) {
    const zt_chords *chords = &o->chords;
    int32_t most = -1;
    for (int32_t i = 0; i < chords->part_count; i++)
        if (o->splits[i] > (most < 0 ? 0 : o->splits[most])) most = i;
    division->moment_count = o->moment_count;
    division->asked = most >= 0;
    if (most >= 0) division->most = zt_chords_thing(chords, most);
    zt_gap worst = worst_gap(o);
    division->off = worst.share;
    if (worst.part >= 0) division->worst = zt_chords_thing(chords, worst.part);
    for (int32_t i = 0; i < o->moment_count - 1; i++) division->step_count += o->steps[i];
    if (division->step_count > 0)
        division->stepping =
            track_between(o->animation, &o->step_from->scene, &o->step_to->scene);
}

zt_status zt_shutter_middle(zt_scene *scene, const zt_animation *animation, int64_t frame,
                            zt_arena *arena, zt_listener listener) {
    const zt_shutter *shutter = &animation->film.shutter;
    double cell = shutter->close > shutter->open ? ZT_TIME_CELLS / 2 : 0;
    return zt_animation_freeze(scene, animation, zt_shutter_time(animation, frame, cell), arena,
                               listener);
}

static zt_status expose_moment(zt_exposure *exposure, const zt_animation *animation,
                               double time_s, zt_arena *arena, zt_listener listener) {
    zt_scene *scene = ZT_PUSH(arena, zt_scene, 1);
    if (!scene) return ZT_EMEMORY;
    *exposure = zt_exposure_of(scene);
    return zt_animation_freeze(scene, animation, time_s, arena, listener);
}

zt_status zt_shutter_expose(zt_exposure *exposure, zt_division *division,
                            const zt_animation *animation, int64_t frame, int height,
                            zt_arena *arena, zt_listener listener) {
    const zt_shutter *shutter = &animation->film.shutter;
    double open_s = zt_shutter_time(animation, frame, 0);
    *division = (zt_division){.moment_count = 1, .stepping = -1};
    if (shutter->close <= shutter->open || animation->track_count == 0)
        return expose_moment(exposure, animation, open_s, arena, listener);
    opening *o = ZT_PUSH(arena, opening, 1);
    zt_glance *first;
    if (!o) return ZT_EMEMORY;
    *o =
        (opening){.animation = animation, .arena = arena, .listener = listener, .frame = frame};
    ZT_TRY(zt_chords_open(&o->chords, &first, animation, open_s, height, arena, listener));
    o->first = first;
    ZT_TRY(divide(o));
    if (o->moves) {
        write_division(division, o);
        return write_exposure(exposure, o);
    }
    *exposure = zt_exposure_of(&first->scene);
    return ZT_OK;
}
