#include "sequence/pilot.h"

#include <math.h>

#include "base/clock.h"
#include "base/diag.h"

/* What of the budget it may take; samples a pixel in it; how many of them even where no two
 * samples differ, so that frames that were not looked at have some. */
#define PILOT_SHARE 0.1
enum { SAMPLES_MAX = 64, SAMPLES_ANYWAY = 64, SMALLER = 4 };

/* How errors fall with samples, and samples grow with errors, where that was not to be seen. */
#define USUAL_SLOPE 0.6
#define USUAL_POWER 1.5

typedef struct pilot {
    zt_plan *plan;
    zt_renderer *renderer;
    zt_watcher watcher;     /* stops, and says nothing */
    zt_image *images[2];    /* of the renderer's size */
    zt_image *small, *tiny; /* of fewer pixels, and of fewer still */
    double many;            /* times more pixels than the small one the others have */
    double left_s;          /* that it may still take */
    double fixed_s, unit_s; /* of a frame: before its first sample, and for each, a pixel */
} pilot;

/* What rendering a frame took: all before its first sample, and the rest. */
typedef struct taken {
    double fixed_s, render_s;
} taken;

static zt_status take(taken *t, pilot *p, int64_t frame, zt_image *image,
                      zt_sampling sampling) {
    zt_renderer *r = p->renderer;
    zt_sampling own = r->sampling;
    zt_output_format format = r->format;
    double begun_s = zt_clock_s();
    r->sampling = sampling;
    r->format.width = image->width;
    r->format.height = image->height;
    zt_status status = zt_renderer_take(r, frame, image, &p->watcher);
    r->sampling = own;
    r->format = format;
    double all_s = zt_clock_s() - begun_s;
    p->left_s -= all_s;
    *t = (taken){all_s - r->cost.render_s, r->cost.render_s};
    return status;
}

/* A first impression, from a picture of fewer pixels: twice, as the first time some things are
 * made that last for the run. */
static zt_status look(pilot *p, int64_t frame) {
    zt_sampling sampling = p->plan->sampling;
    taken t = {0};
    sampling.min = sampling.max = 2;
    sampling.error = 0;
    sampling.edges = false;
    for (int i = 0; i < 2; i++) ZT_TRY(take(&t, p, frame, p->small, sampling));
    p->fixed_s = t.fixed_s;
    p->unit_s = fmax(t.render_s / 2, 1e-9) * p->many;
    return ZT_OK;
}

/* Frame number `index` of `count` that are spread evenly over the film. */
static int64_t spread_frame(const zt_plan *plan, int index, int count) {
    int64_t way = plan->last - plan->first;
    return count == 1 ? plan->first + way / 2 : plan->first + way * index / (count - 1);
}

static int most_frames(const zt_plan *plan) {
    int64_t count = plan->last - plan->first + 1;
    return count < ZT_COSTS_MAX ? (int)count : ZT_COSTS_MAX;
}

/* ---- as many samples in each pixel ----------------------------------------------------------
 */

/* The error of an image, the root mean square of its colors, from two that differ in nothing
 * but their random numbers. */
static double error_of(const zt_image *a, const zt_image *b) {
    size_t count = (size_t)a->width * (size_t)a->height;
    double sum = 0;
    for (size_t i = 0; i < 4 * count; i++) {
        double d = (double)a->pixels[i] - (double)b->pixels[i];
        sum += isfinite(d) ? d * d : 0;
    }
    return sqrt(sum / (2 * 3 * (double)count));
}

/* Renders a frame twice; `*t` is what it takes. */
static zt_status measure(double *error, taken *t, pilot *p, int64_t frame, int samples) {
    taken each;
    for (uint32_t i = 0; i < 2; i++) {
        zt_sampling sampling = p->plan->sampling;
        sampling.min = sampling.max = samples;
        sampling.seed += i * 0x9e3779b9u;
        ZT_TRY(take(&each, p, frame, p->images[i], sampling));
        if (i > 0 && each.render_s > t->render_s) continue; /* something else took its time */
        *t = each;
    }
    *error = error_of(p->images[0], p->images[1]);
    return ZT_OK;
}

/* Looks closer, with ever more samples while there are so many seconds. */
static zt_status gauge(pilot *p, int64_t frame, double share_s) {
    for (int samples = 2; samples <= SAMPLES_MAX; samples *= 2) {
        zt_sampling sampling = p->plan->sampling;
        taken t;
        double next_s = p->fixed_s + samples * p->unit_s;
        if (next_s > share_s) return ZT_OK;
        sampling.min = sampling.max = samples;
        ZT_TRY(take(&t, p, frame, p->images[0], sampling));
        share_s -= t.fixed_s + t.render_s;
        p->fixed_s = t.fixed_s;
        p->unit_s = t.render_s / samples;
    }
    return ZT_OK;
}

/* How many samples there is time for in each of so many frames: a power of two, or 0. */
static int samples_for(const pilot *p, int frame_count) {
    int samples = SAMPLES_MAX;
    while (samples >= 2) {
        bool slope = samples >= 8; /* is measured too, with a quarter of them */
        double work = slope ? 2.5 * samples : 2 * samples;
        if (frame_count * (work * p->unit_s + (slope ? 4 : 2) * p->fixed_s) <= p->left_s) break;
        samples /= 2;
    }
    return samples >= 2 ? samples : 0;
}

/* Shares: how much more or less samples than others frames need for the same error. */
static void set_shares(zt_plan *plan, const double *errors, double slope) {
    double mean = 0;
    for (int i = 0; i < plan->cost_count; i++) mean += errors[i] / plan->cost_count;
    for (int i = 0; i < plan->cost_count; i++) {
        double share = mean > 0 ? pow(errors[i] / mean, 1 / slope) : 1;
        plan->costs[i].share = fmin(fmax(share, 1.0 / 16), 16);
    }
}

static zt_status pilot_even(pilot *p) {
    zt_plan *plan = p->plan;
    int count = most_frames(plan), samples;
    ZT_TRY(gauge(p, spread_frame(plan, 0, 1), count > 1 ? p->left_s / 5 : p->left_s));
    samples = count > 1 ? samples_for(p, count) : 0;
    while (samples < 8 && count > 1) samples = samples_for(p, --count);
    plan->cost_count = count;
    double errors[ZT_COSTS_MAX] = {0}, sum = 0, rough_sum = 0;
    for (int i = 0; i < count; i++) {
        double rough;
        taken t = {p->fixed_s, p->unit_s};
        int64_t frame = spread_frame(plan, i, count);
        if (samples >= 8) {
            ZT_TRY(measure(&rough, &t, p, frame, samples / 4));
            rough_sum += rough;
        }
        if (samples) ZT_TRY(measure(&errors[i], &t, p, frame, samples));
        sum += errors[i];
        plan->costs[i] = (zt_cost){frame, t.fixed_s, t.render_s / (samples ? samples : 1), 1};
    }
    double slope = samples >= 8 && sum > 0 ? log2(rough_sum / sum) / 2 : USUAL_SLOPE;
    if (samples) set_shares(plan, errors, fmin(fmax(slope, 0.4), 1));
    if (samples && !(sum > 0)) plan->enough = SAMPLES_ANYWAY;
    return ZT_OK;
}

/* ---- samples by an error --------------------------------------------------------------------
 *
 * How much more time smaller errors take does not follow from larger ones: ever more pixels
 * join in. So it is small pictures that go all the way down to the error that there is time
 * for.
 */

static zt_status measure_adaptive(taken *t, pilot *p, int64_t frame, zt_image *image,
                                  double error) {
    zt_sampling sampling = p->plan->sampling;
    sampling.error = error;
    sampling.max = ZT_PLAN_SAMPLES_MAX;
    return take(t, p, frame, image, sampling);
}

enum { STEPS_MAX = 40 };

/* Ever smaller errors of one frame. Of a small picture: what the least samples take, and what
 * each error takes beyond that. Of the whole one: what the least samples take, and how many
 * times more it takes beyond that: where it is edges that ask for samples, there are not as
 * many times more as there are pixels. */
typedef struct descent {
    double error[STEPS_MAX], more_s[STEPS_MAX], least_s;
    int count;
    double tiny_least_s; /* of an even smaller picture, which shows how many times more it is */
    double whole_least_s, times;
} descent;

static zt_status measure_small(double *least_s, pilot *p, int64_t frame, zt_image *image) {
    taken t;
    *least_s = INFINITY;
    for (int i = 0; i < 2; i++) {
        ZT_TRY(measure_adaptive(&t, p, frame, image, 1));
        *least_s = fmin(*least_s, t.render_s);
    }
    return ZT_OK;
}

static zt_status measure_least(descent *d, pilot *p, int64_t frame) {
    taken t;
    ZT_TRY(measure_small(&d->tiny_least_s, p, frame, p->tiny));
    ZT_TRY(measure_small(&d->least_s, p, frame, p->small));
    d->whole_least_s = p->many * d->least_s;
    d->times = p->many;
    if (p->left_s < 1.5 * (p->fixed_s + d->whole_least_s)) return ZT_OK;
    ZT_TRY(measure_adaptive(&t, p, frame, p->images[0], 1));
    d->whole_least_s = t.render_s;
    d->times = fmin(fmax(t.render_s / d->least_s, SMALLER), p->many);
    return ZT_OK;
}

/* As much more as the small picture took than the tiny one, the whole takes again, and again.
 */
static zt_status see_times(descent *d, pilot *p, int64_t frame) {
    taken t;
    double more_s = d->more_s[d->count - 1];
    ZT_TRY(measure_adaptive(&t, p, frame, p->tiny, d->error[d->count - 1]));
    double tiny_more_s = t.render_s - d->tiny_least_s;
    if (tiny_more_s < 0.5 * d->tiny_least_s) return ZT_OK;
    double rise = fmin(fmax(more_s / tiny_more_s, 2), 4);
    d->times = fmin(rise * SMALLER, p->many);
    return ZT_OK;
}

/* Goes down to the error that fills the time of a frame, or while there is time. */
static zt_status descend(descent *d, pilot *p, int64_t frame, double frame_s) {
    const double none = 1e-5; /* where nothing asks for more samples, at last */
    double error = 0.05, keep_s;
    taken t;
    ZT_TRY(measure_least(d, p, frame));
    for (keep_s = p->left_s / 4;;) {
        ZT_TRY(measure_adaptive(&t, p, frame, p->small, error));
        double more_s = fmax(t.render_s - d->least_s, 1e-3 * d->least_s);
        d->error[d->count] = error;
        d->more_s[d->count++] = more_s;
        ZT_TRY(see_times(d, p, frame));
        bool little = more_s < 0.2 * d->least_s;
        bool full = t.fixed_s + d->whole_least_s + d->times * more_s > frame_s;
        double next_s = 2 * t.fixed_s + d->least_s + 5 * more_s;
        if (full || d->count == STEPS_MAX || p->left_s - next_s < keep_s) return ZT_OK;
        if (error < none && little) p->plan->enough = 1 / error;
        if (error < none) return ZT_OK;
        error /= little ? 4 : 2;
    }
}

/* By which power of the error time grows at the last one. */
static double power_of(const descent *d) {
    int last = d->count - 1;
    if (last == 0 || d->more_s[last - 1] < 0.1 * d->least_s) return USUAL_POWER;
    double rise = log(d->more_s[last] / d->more_s[last - 1]);
    return fmin(fmax(rise / log(d->error[last - 1] / d->error[last]), 1), 4);
}

/* Looks at the whole picture with the smallest error that there is time for. */
static zt_status compare(descent *d, pilot *p, int64_t frame) {
    taken t;
    int i = d->count - 1;
    while (i >= 0 && p->fixed_s + d->whole_least_s + d->times * d->more_s[i] > p->left_s / 2)
        i--;
    if (i < 0 || d->times * d->more_s[i] < 0.3 * d->whole_least_s) return ZT_OK;
    ZT_TRY(measure_adaptive(&t, p, frame, p->images[0], d->error[i]));
    d->times = fmin(fmax((t.render_s - d->whole_least_s) / d->more_s[i], 1), p->many);
    return ZT_OK;
}

static zt_status pilot_adaptive(pilot *p, double frame_s) {
    zt_plan *plan = p->plan;
    descent d = {.count = 0};
    taken t, least;
    int64_t middle = spread_frame(plan, 0, 1);
    ZT_TRY(descend(&d, p, middle, frame_s));
    ZT_TRY(compare(&d, p, middle));
    plan->power = power_of(&d);
    if (plan->enough > 0) plan->enough = pow(plan->enough, plan->power);
    double error = d.error[d.count - 1], scale = pow(error, plan->power);
    plan->cost_count = 1;
    plan->costs[0] = (zt_cost){middle, p->fixed_s + d.whole_least_s,
                               d.times * d.more_s[d.count - 1] * scale, 1};
    double each_s = 2 * p->fixed_s + 2 * d.least_s + d.more_s[d.count - 1];
    int count = (int)fmin(p->left_s / each_s, most_frames(plan));
    for (int i = 0; i < count && count > 1; i++) {
        int64_t frame = spread_frame(plan, i, count);
        ZT_TRY(measure_adaptive(&least, p, frame, p->small, 1));
        ZT_TRY(measure_adaptive(&t, p, frame, p->small, error));
        double more_s = fmax(t.render_s - least.render_s, 1e-3 * least.render_s);
        plan->costs[i] =
            (zt_cost){frame, t.fixed_s + least.render_s * d.whole_least_s / d.least_s,
                      d.times * more_s * scale, 1};
        plan->cost_count = count;
    }
    return ZT_OK;
}

static zt_status make_images(pilot *p, const zt_output_format *format) {
    int width = (format->width + SMALLER - 1) / SMALLER,
        height = (format->height + SMALLER - 1) / SMALLER;
    p->many = (double)format->width * format->height / ((double)width * height);
    ZT_TRY(zt_image_create(&p->small, width, height));
    ZT_TRY(zt_image_create(&p->tiny, (width + 1) / 2, (height + 1) / 2));
    ZT_TRY(zt_image_create(&p->images[0], format->width, format->height));
    return zt_image_create(&p->images[1], format->width, format->height);
}

zt_status zt_pilot_run(zt_plan *plan, zt_renderer *r, const zt_watcher *watcher) {
    double frame_count = (double)(plan->last - plan->first + 1);
    double all_s =
        plan->budget.film_s > 0 ? plan->budget.film_s : plan->budget.frame_s * frame_count;
    pilot p = {.plan = plan, .renderer = r, .left_s = PILOT_SHARE * all_s};
    if (watcher) p.watcher = (zt_watcher){NULL, watcher->stopped, watcher->user};
    zt_status status = make_images(&p, &r->format);
    if (status == ZT_OK) status = look(&p, spread_frame(plan, 0, 1));
    bool adaptive = plan->sampling.min != plan->sampling.max;
    if (status == ZT_OK)
        status = adaptive ? pilot_adaptive(&p, all_s / frame_count) : pilot_even(&p);
    zt_image_free(&p.small);
    zt_image_free(&p.tiny);
    zt_image_free(&p.images[0]);
    zt_image_free(&p.images[1]);
    return status;
}
