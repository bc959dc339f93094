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
    double begun_s = zt_clock_s();
    r->sampling = sampling;
    zt_status status = zt_renderer_take(r, frame, image, &p->watcher);
    r->sampling = own;
    double all_s = zt_clock_s() - begun_s;
    p->left_s -= all_s;
    *t = (taken){all_s - r->cost.render_s, r->cost.render_s};
    return status;
}

/* A first impression, from a picture of fewer pixels: twice, as the first time some things are
 * made that last for the run. */
static zt_status look(pilot *p, int64_t frame) {
    zt_renderer *r = p->renderer;
    zt_output_format own = r->format;
    zt_sampling sampling = r->sampling;
    zt_image *image;
    taken t = {0};
    r->format.width = (own.width + SMALLER - 1) / SMALLER;
    r->format.height = (own.height + SMALLER - 1) / SMALLER;
    sampling.min = sampling.max = 2;
    sampling.error = 0;
    sampling.edges = false;
    zt_status status = zt_image_create(&image, r->format.width, r->format.height);
    for (int i = 0; i < 2 && status == ZT_OK; i++) status = take(&t, p, frame, image, sampling);
    double pixels = (double)own.width * own.height;
    p->fixed_s = t.fixed_s;
    p->unit_s =
        fmax(t.render_s / 2, 1e-9) * pixels / ((double)r->format.width * r->format.height);
    r->format = own;
    zt_image_free(&image);
    return status;
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

/* Renders a frame twice; `*unit_s` is what each sample took. */
static zt_status measure(double *error, taken *t, pilot *p, int64_t frame, int samples) {
    taken each;
    *t = (taken){0};
    for (uint32_t i = 0; i < 2; i++) {
        zt_sampling sampling = p->plan->sampling;
        sampling.min = sampling.max = samples;
        sampling.seed += i * 0x9e3779b9u;
        ZT_TRY(take(&each, p, frame, p->images[i], sampling));
        t->fixed_s += each.fixed_s / 2;
        t->render_s += each.render_s / 2;
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
 */

static zt_status measure_adaptive(taken *t, pilot *p, int64_t frame, double error) {
    zt_sampling sampling = p->plan->sampling;
    sampling.error = error;
    sampling.max = ZT_PLAN_SAMPLES_MAX;
    return take(t, p, frame, p->images[0], sampling);
}

/* Ever smaller errors on one frame, while there is time: which one it came to, and by which
 * power of the error time grows beyond what the least samples take. */
static zt_status descend(pilot *p, double *error, int64_t frame) {
    const double none = 1e-5; /* where nothing asks for more samples, at last */
    taken least, t;
    double share_s = p->left_s / 2, last_error = 1, last_more_s = 0;
    ZT_TRY(measure_adaptive(&least, p, frame, 1));
    p->plan->power = USUAL_POWER;
    *error = 0.05;
    for (;;) {
        ZT_TRY(measure_adaptive(&t, p, frame, *error));
        double more_s = fmax(t.render_s - least.render_s, 0);
        bool clear = last_more_s > 0.1 * least.render_s && more_s > last_more_s;
        if (clear)
            p->plan->power =
                fmin(fmax(log(more_s / last_more_s) / log(last_error / *error), 1), 2.2);
        bool little = more_s < 0.2 * least.render_s;
        if (*error < none && little) p->plan->enough = pow(*error, -p->plan->power);
        double step = little ? 4 : 2;
        double next_s = t.fixed_s + least.render_s + more_s * step * step;
        if (*error < none || p->left_s - next_s < share_s) return ZT_OK;
        last_more_s = more_s;
        last_error = *error;
        *error /= step;
    }
}

static zt_status pilot_adaptive(pilot *p) {
    zt_plan *plan = p->plan;
    double error;
    int64_t middle = spread_frame(plan, 0, 1);
    ZT_TRY(descend(p, &error, middle));
    double before_s = p->left_s;
    int count = 1;
    for (int i = 0; i < count; i++) {
        taken least, t;
        int64_t frame = spread_frame(plan, i, count);
        ZT_TRY(measure_adaptive(&least, p, frame, 1));
        ZT_TRY(measure_adaptive(&t, p, frame, error));
        double more_s = fmax(t.render_s - least.render_s, 1e-3 * least.render_s);
        plan->costs[i] = (zt_cost){frame, least.fixed_s + least.render_s,
                                   more_s * pow(error, plan->power), 1};
        plan->cost_count = i + 1;
        if (i > 0 || count > 1) continue;
        /* How many of these there is time for: these are then looked at. */
        double each_s = before_s - p->left_s;
        count = (int)fmin(fmax(p->left_s / each_s, 1), most_frames(plan));
        if (count > 1) i = -1;
    }
    return ZT_OK;
}

zt_status zt_pilot_run(zt_plan *plan, zt_renderer *r, const zt_watcher *watcher) {
    double frame_count = (double)(plan->last - plan->first + 1);
    double all_s =
        plan->budget.film_s > 0 ? plan->budget.film_s : plan->budget.frame_s * frame_count;
    pilot p = {.plan = plan, .renderer = r, .left_s = PILOT_SHARE * all_s};
    if (watcher) p.watcher = (zt_watcher){NULL, watcher->stopped, watcher->user};
    zt_status status = ZT_OK;
    for (int i = 0; i < 2 && status == ZT_OK; i++)
        status = zt_image_create(&p.images[i], r->format.width, r->format.height);
    if (status == ZT_OK) status = look(&p, spread_frame(plan, 0, 1));
    bool adaptive = plan->sampling.min != plan->sampling.max;
    if (status == ZT_OK) status = adaptive ? pilot_adaptive(&p) : pilot_even(&p);
    zt_image_free(&p.images[0]);
    zt_image_free(&p.images[1]);
    return status;
}
