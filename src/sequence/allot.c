/* A budget of time becomes a plan, by what a pilot shows, and is told. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/diag.h"
#include "sequence/pacing.h"
#include "sequence/pilot.h"

typedef struct words {
    char text[64];
} words;

static words in_words(double seconds) {
    words w;
    if (seconds < 0.9995) /* what would be 1e+03 */
        snprintf(w.text, sizeof w.text, "%.3g ms", 1000 * seconds);
    else if (seconds < 120)
        snprintf(w.text, sizeof w.text, "%.3g s", seconds);
    else if (seconds < 7200)
        snprintf(w.text, sizeof w.text, "%.3g min", seconds / 60);
    else
        snprintf(w.text, sizeof w.text, "%.3g h", seconds / 3600);
    return w;
}

/* What the frames are allotted: from the least to the most. */
static void say_allotted(const zt_plan *p, zt_listener listener) {
    zt_sampling first = zt_plan_sampling(p, p->frames[0]);
    double low_error = first.error, high_error = first.error, all_s = 0;
    int low = first.max, high = first.max;
    bool adaptive = first.min != first.max;
    for (int64_t i = 0; i < p->frame_count; i++) {
        zt_sampling s = zt_plan_sampling(p, p->frames[i]);
        low = s.max < low ? s.max : low;
        high = s.max > high ? s.max : high;
        low_error = fmin(low_error, s.error);
        high_error = fmax(high_error, s.error);
        all_s += zt_plan_seconds(p, p->frames[i]);
    }
    words time = in_words(all_s);
    if (adaptive && low_error < high_error)
        zt_tell(listener, ZT_NOTE, "errors from %g to %g are allotted, for about %s", low_error,
                high_error, time.text);
    else if (adaptive)
        zt_tell(listener, ZT_NOTE, "an error of %g is allotted, for about %s", low_error,
                time.text);
    else if (low < high)
        zt_tell(listener, ZT_NOTE, "%d to %d samples a pixel are allotted, for about %s", low,
                high, time.text);
    else
        zt_tell(listener, ZT_NOTE, "%d samples a pixel are allotted, for about %s", low,
                time.text);
}

/* What cannot be met, or need not be. */
static void say_doubts(const zt_plan *p, double passed_s, zt_listener listener) {
    double frame_count = (double)p->frame_count;
    bool film = p->budget.film_s > 0;
    double wanted_s = film ? p->budget.film_s : p->budget.frame_s;
    double least_s = film ? passed_s + zt_plan_least_s(p) : zt_plan_least_s(p) / frame_count;
    const char *of = film ? "the film" : "a frame";
    if (least_s > 1.1 * wanted_s)
        zt_tell(listener, ZT_WARNING,
                "%s takes about %s with the least samples, more than the %s that it may", of,
                in_words(least_s).text, in_words(wanted_s).text);
    else if (p->enough > 0)
        zt_tell(listener, ZT_NOTE,
                "no samples of a pixel differ in the frames that were looked at: %s is exact "
                "in less than the %s that it may take",
                of, in_words(wanted_s).text);
}

static zt_status allot(zt_pacing *p, zt_renderer *r, const zt_watcher *watcher) {
    ZT_TRY(zt_pilot_run(&p->plan, r, watcher));
    double passed_s = zt_clock_s() - p->begun_s;
    zt_plan_begin(&p->plan, passed_s);
    say_allotted(&p->plan, r->listener);
    say_doubts(&p->plan, passed_s, r->listener);
    return ZT_OK;
}

zt_status zt_renderer_budget(zt_renderer *r, const zt_frames *frames, const zt_budget *budget,
                             const zt_watcher *watcher) {
    if (frames->count < 1 || (budget->frame_s > 0) == (budget->film_s > 0)) return ZT_EARGUMENT;
    zt_pacing_free(&r->pacing);
    zt_pacing *p = calloc(1, sizeof *p);
    int64_t *numbers = p ? calloc((size_t)frames->count, sizeof *numbers) : NULL;
    if (!numbers) {
        free(p);
        return ZT_EMEMORY;
    }
    p->plan.frames = numbers;
    memcpy(numbers, frames->numbers, (size_t)frames->count * sizeof *numbers);
    p->plan.frame_count = frames->count;
    p->plan.budget = *budget;
    p->plan.sampling = r->sampling;
    p->begun_s = zt_clock_s();
    zt_status status = allot(p, r, watcher);
    if (status == ZT_OK)
        r->pacing = p;
    else
        zt_pacing_free(&p);
    return status;
}
