#include "sequence/pilot.h"

#include <math.h>

#include "base/clock.h"
#include "base/diag.h"
#include "sequence/forecast.h"

/* What of the budget it may take, and of adaptive sampling, of a single frame's; samples a
 * pixel in it; how many of them even where no two samples differ, so that frames that were not
 * looked at have some. */
#define PILOT_SHARE    0.1
#define ADAPTIVE_SHARE 0.3
enum { SAMPLES_MAX = 64, SAMPLES_ANYWAY = 64, SIZES = 3 };

#define USUAL_SLOPE 0.6 /* of errors with samples, where that was not to be seen */

typedef struct pilot {
    zt_plan *plan;
    zt_renderer *renderer;
    zt_watcher watcher;     /* stops, and says nothing */
    zt_image *sizes[SIZES]; /* each with twice the sides of the one before, to the frame's */
    zt_image *other;        /* another one of that size */
    zt_image *image;        /* the one that errors are looked at in */
    double left_s;          /* that it may still take */
    double fixed_s, unit_s; /* of a frame: before its first sample, and for each, a pixel */
} pilot;

/* What rendering a frame took: all before its first sample, and the rest. */
typedef struct taken {
    double fixed_s, render_s;
} taken;

static double pixels_of(const zt_image *image) { return (double)image->width * image->height; }

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
    for (int i = 0; i < 2; i++) ZT_TRY(take(&t, p, frame, p->sizes[0], sampling));
    p->fixed_s = t.fixed_s;
    p->unit_s =
        fmax(t.render_s / 2, 1e-9) * pixels_of(p->sizes[SIZES - 1]) / pixels_of(p->sizes[0]);
    return ZT_OK;
}

/* Frame number `index` of `count` that are spread evenly over the film. */
static int64_t spread_frame(const zt_plan *plan, int index, int count) {
    int64_t last = plan->frame_count - 1;
    return plan->frames[count == 1 ? last / 2 : last * index / (count - 1)];
}

static int most_frames(const zt_plan *plan) {
    return plan->frame_count < ZT_COSTS_MAX ? (int)plan->frame_count : ZT_COSTS_MAX;
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
        ZT_TRY(take(&each, p, frame, i ? p->other : p->sizes[SIZES - 1], sampling));
        if (i > 0 && each.render_s > t->render_s) continue; /* something else took its time */
        *t = each;
    }
    *error = error_of(p->sizes[SIZES - 1], p->other);
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
        ZT_TRY(take(&t, p, frame, p->sizes[SIZES - 1], sampling));
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
    ZT_TRY(look(p, spread_frame(plan, 0, 1)));
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
 * Pictures of ever more pixels, at last the whole one, each with errors as small as there is
 * time for: how many samples any other error asks for follows from what its pixels have taken
 * by then (render/expect.h).
 */

enum { LEAP = 3 * ZT_EXPECT_OCTAVE };

#define SMALL 0.15 /* of the pilot's time, for ever smaller errors of a small picture */
#define TWICE 1.6  /* a picture's least time by its pixels, for two looks at a larger one */

/* Looks at it with an error. */
static zt_status see(zt_forecast *v, pilot *p, int64_t frame, int error) {
    zt_sampling sampling = p->plan->sampling;
    taken t;
    sampling.error = zt_expect_error(error);
    sampling.max = ZT_PLAN_SAMPLES_MAX;
    if (v->sample_s > 0)
        sampling.mean_max = (int)fmin(
            ceil((v->least + fmax(p->left_s, 0) / v->sample_s) / pixels_of(p->image)) + 1,
            ZT_PLAN_SAMPLES_MAX);
    ZT_TRY(take(&t, p, frame, p->image, sampling));
    p->fixed_s = t.fixed_s;
    v->samples = (double)p->renderer->cost.rays.primary;
    v->all_s = t.render_s;
    v->sample_s = v->all_s / v->samples;
    zt_expect(&v->expected, p->renderer->work, ZT_PLAN_SAMPLES_MAX);
    v->error = error;
    v->known = v->known > error ? v->known : error;
    /* It may have been stopped before it got there. */
    while (v->error > 0 && v->expected.further[v->error] > ZT_FORECAST_SEEN * v->samples)
        v->error--;
    return ZT_OK;
}

/* Looks with ever smaller errors, in so many seconds, as far as the frame has time for; and
 * learns from each. */
static zt_status descend(zt_forecast *v, pilot *p, int64_t frame, double left_s,
                         double most_s) {
    for (;;) {
        const zt_forecast old = *v, whole = zt_forecast_larger(v, v->many);
        int error = zt_forecast_error(v, 0.7 * (left_s - p->fixed_s)),
            most = zt_forecast_error(&whole, most_s);
        if (error > most) error = most;
        bool far = error >= v->known + LEAP;
        if (far) error = v->known + LEAP;
        double worth_s = v->all_s + 0.5 * (v->all_s - zt_forecast_least_s(v));
        if (error <= v->error || (!far && zt_forecast_seconds(v, error) < worth_s))
            return ZT_OK;
        ZT_TRY(see(v, p, frame, error));
        left_s -= p->fixed_s + v->all_s;
        if (v->error <= old.error) return ZT_OK;
        zt_forecast_learn(v, &old);
    }
}

/* A picture of more pixels, first with about a third of the time. */
static zt_status see_larger(zt_forecast *v, pilot *p, int64_t frame, int size, double left_s,
                            double most_s) {
    const double small_s = zt_forecast_least_s(v),
                 many = pixels_of(p->sizes[size]) / pixels_of(p->image);
    *v = zt_forecast_larger(v, many);
    p->image = p->sizes[size];
    const zt_forecast whole = zt_forecast_larger(v, v->many);
    double first_s = fmax(left_s / 3, fmin(1.5 * zt_forecast_least_s(v), 0.6 * left_s));
    int error = zt_forecast_error(v, first_s), most = zt_forecast_error(&whole, most_s / 2);
    ZT_TRY(see(v, p, frame, error < most ? error : most));
    ZT_TRY(descend(v, p, frame, left_s - p->fixed_s - v->all_s, most_s));
    v->growth = fmin(fmax(log(zt_forecast_least_s(v) / small_s) / log(many), 0.5), 1);
    return ZT_OK;
}

/* Of the frame in the middle, a small picture and then the largest that there is time for
 * twice; ends with what is expected of the whole one. */
static zt_status see_sizes(zt_forecast *v, pilot *p, int64_t frame, double keep_s,
                           double most_s) {
    for (int i = 0; i < 2; i++) ZT_TRY(see(v, p, frame, 0));
    v->least = v->samples;
    ZT_TRY(descend(v, p, frame, SMALL * (p->left_s - keep_s), most_s));
    double left_s = p->left_s - keep_s;
    int size = SIZES - 1;
    while (size > 0 && TWICE * zt_forecast_least_s(v) * pixels_of(p->sizes[size]) >
                           left_s * pixels_of(p->image))
        size--;
    if (size > 0)
        ZT_TRY(see_larger(v, p, frame, size, left_s, most_s));
    else
        ZT_TRY(descend(v, p, frame, left_s, most_s));
    *v = zt_forecast_larger(v, v->many);
    return ZT_OK;
}

/* What a small picture takes with the least samples, and with an error beyond that. */
static zt_status see_small(double *least_s, double *more_s, pilot *p, int64_t frame,
                           double error) {
    zt_sampling sampling = p->plan->sampling;
    taken least, all;
    sampling.max = ZT_PLAN_SAMPLES_MAX;
    for (int i = 0; i < 2; i++) {
        sampling.error = i ? error : 1;
        ZT_TRY(take(i ? &all : &least, p, frame, p->sizes[0], sampling));
    }
    *least_s = fmin(least.render_s, all.render_s);
    *more_s = fmax(all.render_s - *least_s, ZT_FORECAST_SEEN * *least_s);
    return ZT_OK;
}

/* The other frames are as many times the middle one as their small pictures are. */
static zt_status see_others(pilot *p, int64_t middle, double error) {
    zt_plan *plan = p->plan;
    zt_cost cost = plan->costs[0];
    double small_s, small_more_s, least_s, more_s;
    ZT_TRY(see_small(&small_s, &small_more_s, p, middle, error));
    double each_s = 2 * p->fixed_s + 2 * small_s + small_more_s;
    int count = (int)fmin(p->left_s / each_s, most_frames(plan));
    for (int i = 0; i < count && count > 1; i++) {
        int64_t frame = spread_frame(plan, i, count);
        ZT_TRY(see_small(&least_s, &more_s, p, frame, error));
        plan->costs[i] = (zt_cost){frame, cost.fixed_s * least_s / small_s,
                                   cost.unit_s * more_s / small_more_s, 1};
        plan->cost_count = count;
    }
    return ZT_OK;
}

static zt_status pilot_adaptive(pilot *p, double frame_s) {
    zt_plan *plan = p->plan;
    bool few = most_frames(plan) < ZT_COSTS_MAX; /* have too little time to be compared */
    int64_t middle = spread_frame(plan, 0, 1);
    double pixels = pixels_of(p->sizes[SIZES - 1]);
    zt_forecast v = {.growth = 1, .times = 1};
    p->image = p->sizes[0];
    v.many = pixels / pixels_of(p->image);
    ZT_TRY(see_sizes(&v, p, middle, few ? 0 : p->left_s / 4, frame_s - p->fixed_s));
    const double least_s = zt_forecast_least_s(&v);
    int error = zt_forecast_error(&v, frame_s - p->fixed_s);
    while (error < ZT_FORECAST_LAST &&
           zt_forecast_seconds(&v, error) < (1 + ZT_FORECAST_SEEN) * least_s)
        error++;
    double more_s = fmax(zt_forecast_seconds(&v, error) - least_s, ZT_FORECAST_SEEN * least_s);
    /* By half an octave to both sides. */
    int to = error + ZT_EXPECT_OCTAVE / 2, from = to - ZT_EXPECT_OCTAVE;
    double to_s =
               zt_forecast_seconds(&v, to < ZT_FORECAST_LAST ? to : ZT_FORECAST_LAST) - least_s,
           from_s = zt_forecast_seconds(&v, from > 0 ? from : 0) - least_s;
    plan->power = from_s > 0 ? fmin(fmax(log2(to_s / from_s), 0.5), 2) : 2;
    double work = pow(zt_expect_error(error), -plan->power);
    if (v.error == ZT_FORECAST_LAST && v.samples < (1 + ZT_FORECAST_SEEN) * v.least)
        plan->enough = work;
    plan->sample_s = pixels * v.sample_s;
    plan->cost_count = 1;
    plan->costs[0] = (zt_cost){middle, p->fixed_s + least_s, more_s / work, 1};
    return few ? ZT_OK : see_others(p, middle, zt_expect_error(error));
}

/* Each with twice the sides of the one before. */
static zt_status make_images(pilot *p, const zt_output_format *format) {
    for (int i = 0; i < SIZES; i++) {
        int less = 1 << (SIZES - 1 - i);
        ZT_TRY(zt_image_create(&p->sizes[i], (format->width + less - 1) / less,
                               (format->height + less - 1) / less));
    }
    return zt_image_create(&p->other, format->width, format->height);
}

zt_status zt_pilot_run(zt_plan *plan, zt_renderer *r, const zt_watcher *watcher) {
    double frame_count = (double)plan->frame_count;
    double all_s =
        plan->budget.film_s > 0 ? plan->budget.film_s : plan->budget.frame_s * frame_count;
    pilot p = {.plan = plan, .renderer = r, .left_s = PILOT_SHARE * all_s};
    bool adaptive = plan->sampling.min != plan->sampling.max;
    if (adaptive) p.left_s = fmax(p.left_s, ADAPTIVE_SHARE * all_s / frame_count);
    if (watcher) p.watcher = (zt_watcher){NULL, watcher->stopped, watcher->user};
    zt_status status = make_images(&p, &r->format);
    if (status == ZT_OK)
        status = adaptive ? pilot_adaptive(&p, all_s / frame_count) : pilot_even(&p);
    for (int i = 0; i < SIZES; i++) zt_image_free(&p.sizes[i]);
    zt_image_free(&p.other);
    return status;
}
