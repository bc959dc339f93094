#include "sequence/kinks.h"

#include <math.h>
#include <string.h>

#include "scene/exposure.h"

/* A loop that goes round more often than this within the opening is left to bisection. */
enum { ROUNDS_MAX = 64 };

/* A key is looked at where it bends the curve, or where there are several in the opening and
 * its value is off the straight way between those at both ends: by more than this share of how
 * far the curve goes meanwhile. */
#define BEND (1.0 / 16)

/* These shares of the opening before a key, and after it, tell whether it jumps and bends. */
#define JUST_BEFORE 1e-6
#define NEAR        1e-3

typedef struct search {
    bool wanted[ZT_TIME_CELLS]; /* 0 is not used */
    double from_s, to_s;
} search;

/* The value of a curve, or of what follows a path. */
static void eval(double *value, const zt_track *track, double time_s) {
    if (track->kind == ZT_TRACK_CURVE)
        zt_curve_eval(value, &track->curve, time_s);
    else
        zt_follow_eval(value, &track->follow, (zt_reference){track->property, track->index},
                       time_s);
}

static bool is_inside(const search *s, double time_s) {
    return time_s > s->from_s && time_s < s->to_s;
}

static void want(search *s, double cell) {
    if (cell >= 1 && cell <= ZT_TIME_CELLS - 1) s->wanted[(int)cell] = true;
}

/* Asks for looks on both sides of a time that is within the opening, if something happens then.
 */
static void look_at(search *s, const zt_track *track, double time_s, bool alone) {
    enum { FROM, TO, HERE, BEFORE, NEAR_BEFORE, NEAR_AFTER, VALUES };
    const double span = s->to_s - s->from_s, at = (time_s - s->from_s) / span;
    const double times[VALUES] = {
        s->from_s,           s->to_s, time_s, time_s - JUST_BEFORE * span, time_s - NEAR * span,
        time_s + NEAR * span};
    double v[VALUES][ZT_VALUE_WIDTH_MAX];
    for (int i = 0; i < VALUES; i++) eval(v[i], track, times[i]);
    double off = 0, goes = 0, jump = 0, bend = 0;
    for (int c = 0; c < zt_value_width(track->property->kind); c++) {
        double way = v[TO][c] - v[FROM][c], here = v[HERE][c];
        off = fmax(off, fabs(here - (v[FROM][c] + way * at)));
        goes = fmax(goes, fmax(fabs(way), fabs(here - v[FROM][c])));
        jump = fmax(jump, fabs(here - v[BEFORE][c]));
        bend = fmax(bend, fabs(v[NEAR_AFTER][c] - 2 * here + v[NEAR_BEFORE][c]));
    }
    double cell = at * ZT_TIME_CELLS;
    bool jumps = jump > goes / 2;
    if (!jumps && !(bend / (4 * NEAR) > goes * BEND) && (alone || !(off > goes * BEND))) return;
    want(s, jumps ? ceil(cell) - 1 : floor(cell));
    want(s, ceil(cell));
}

static bool goes_round(zt_curve_end end) {
    return end == ZT_END_LOOP || end == ZT_END_PING_PONG || end == ZT_END_LOOP_WITH_OFFSET;
}

/* Goes through the keys that fall into the opening, in all rounds of a loop, of which round 0
 * is the keys as they are given: looks at them, or counts them only. */
static int look_at_keys(search *s, const zt_track *track, bool count_only, bool alone) {
    const zt_curve *curve = &track->curve;
    double first = curve->times[0], last = curve->times[curve->key_count - 1];
    double period = last - first, round = 0, end = 0;
    int found = 0;
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
            double time_s = first + round * period + at;
            if (!is_inside(s, time_s)) continue;
            found++;
            if (!count_only) look_at(s, track, time_s, alone);
        }
    }
    return found;
}

int zt_kinks(int *cells, int most, const zt_animation *animation, double from_s, double to_s) {
    search s = {.from_s = from_s, .to_s = to_s};
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        if (track->kind == ZT_TRACK_CURVE) {
            int found = look_at_keys(&s, track, true, false);
            if (found > 0) look_at_keys(&s, track, false, found == 1);
        }
        if (track->kind != ZT_TRACK_FOLLOW) continue;
        const double ends[] = {track->follow.from_s, track->follow.to_s};
        for (int k = 0; k < 2; k++)
            if (is_inside(&s, ends[k])) look_at(&s, track, ends[k], false);
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
