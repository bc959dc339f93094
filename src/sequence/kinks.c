#include "sequence/kinks.h"

#include <math.h>
#include <string.h>

#include "scene/exposure.h"

/* A loop that goes round more often than this within the opening is left to bisection. */
enum { ROUNDS_MAX = 64 };

/* A key is looked at where its value is further from the straight way between those at both
 * ends of the opening than this share of how far the curve goes meanwhile. */
#define BEND (1.0 / 16)

/* This share of the opening before a key is just before it. */
#define JUST_BEFORE 1e-6

typedef struct search {
    bool wanted[ZT_TIME_CELLS]; /* 0 is not used */
    double from_s, to_s;
} search;

static bool eval(double *value, const zt_track *track, double time_s) {
    if (track->kind == ZT_TRACK_CURVE)
        zt_curve_eval(value, &track->curve, time_s);
    else if (track->kind == ZT_TRACK_FOLLOW)
        zt_follow_eval(value, &track->follow, (zt_reference){track->property, track->index},
                       time_s);
    else
        return false;
    return true;
}

static void want(search *s, double cell) {
    if (cell >= 1 && cell <= ZT_TIME_CELLS - 1) s->wanted[(int)cell] = true;
}

/* Asks for a look at a time, if it is within the opening and something happens then. */
static void look_at(search *s, const zt_track *track, double time_s) {
    double span = s->to_s - s->from_s, at = (time_s - s->from_s) / span;
    if (!(at > 0 && at < 1)) return;
    double a[ZT_VALUE_WIDTH_MAX], b[ZT_VALUE_WIDTH_MAX], here[ZT_VALUE_WIDTH_MAX],
        before[ZT_VALUE_WIDTH_MAX];
    eval(a, track, s->from_s);
    eval(b, track, s->to_s);
    eval(here, track, time_s);
    eval(before, track, time_s - JUST_BEFORE * span);
    double off = 0, goes = 0, jump = 0;
    for (int c = 0; c < zt_value_width(track->property->kind); c++) {
        off = fmax(off, fabs(here[c] - (a[c] + (b[c] - a[c]) * at)));
        goes = fmax(goes, fmax(fabs(b[c] - a[c]), fabs(here[c] - a[c])));
        jump = fmax(jump, fabs(here[c] - before[c]));
    }
    double cell = at * ZT_TIME_CELLS;
    if (jump > goes / 2) {
        want(s, ceil(cell) - 1);
        want(s, ceil(cell));
    } else if (off > goes * BEND) {
        want(s, rint(cell));
    }
}

static bool goes_round(zt_curve_end end) {
    return end == ZT_END_LOOP || end == ZT_END_PING_PONG || end == ZT_END_LOOP_WITH_OFFSET;
}

/* The keys of the rounds that fall into the opening; round 0 is the keys as they are given. */
static void look_at_keys(search *s, const zt_track *track) {
    const zt_curve *curve = &track->curve;
    double first = curve->times[0], last = curve->times[curve->key_count - 1];
    double period = last - first;
    double round = 0, end = 0;
    if (period > 0) {
        round = floor((s->from_s - first) / period);
        end = floor((s->to_s - first) / period);
    }
    if (!goes_round(curve->before)) round = fmax(round, 0), end = fmax(end, 0);
    if (!goes_round(curve->after)) round = fmin(round, 0), end = fmin(end, 0);
    for (int done = 0; round <= end && done < ROUNDS_MAX; round++, done++) {
        zt_curve_end kind = round < 0 ? curve->before : curve->after;
        bool back = kind == ZT_END_PING_PONG && fmod(round, 2) != 0;
        for (int32_t k = 0; k < curve->key_count; k++) {
            double at = back ? last - curve->times[k] : curve->times[k] - first;
            look_at(s, track, first + round * period + at);
        }
    }
}

int zt_kinks(int *cells, int most, const zt_animation *animation, double from_s, double to_s) {
    search s = {.from_s = from_s, .to_s = to_s};
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        if (track->kind == ZT_TRACK_CURVE) look_at_keys(&s, track);
        if (track->kind != ZT_TRACK_FOLLOW) continue;
        look_at(&s, track, track->follow.from_s);
        look_at(&s, track, track->follow.to_s);
    }
    int all = 0, count = 0;
    for (int cell = 1; cell < ZT_TIME_CELLS; cell++) all += s.wanted[cell];
    for (int cell = 1, seen = 0; cell < ZT_TIME_CELLS; cell++) {
        if (!s.wanted[cell]) continue;
        if (all <= most || seen * most / all != (seen + 1) * most / all) cells[count++] = cell;
        seen++;
    }
    return count;
}
