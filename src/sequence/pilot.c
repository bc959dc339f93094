#include "sequence/pilot.h"

#include <math.h>

#include "base/clock.h"
#include "base/diag.h"

/* What of the budget it may take, and of adaptive sampling, of a single frame's; samples a
 * pixel in it; how many of them even where no two samples differ, so that frames that were not
 * looked at have some. */
#define PILOT_SHARE    0.1
#define ADAPTIVE_SHARE 0.3
enum { SAMPLES_MAX = 64, SAMPLES_ANYWAY = 64, SMALLER = 4 };

/* How errors fall with samples, and samples grow with errors, where that was not to be seen. */
#define USUAL_SLOPE 0.6
#define USUAL_POWER 1.65
#define STEEPEST    2.0 /* errors of random samples fall no slower */

typedef struct pilot {
    zt_plan *plan;
    zt_renderer *renderer;
    zt_watcher watcher;     /* stops, and says nothing */
    zt_image *images[2];    /* of the renderer's size */
    zt_image *small;        /* of fewer pixels */
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
 * join in; nor from small pictures, of which edges are a larger part. So it is the whole
 * picture that goes down, as far as there is time; a small one says where it can begin.
 */

static zt_status measure_adaptive(taken *t, pilot *p, int64_t frame, zt_image *image,
                                  double error) {
    zt_sampling sampling = p->plan->sampling;
    sampling.error = error;
    sampling.max = ZT_PLAN_SAMPLES_MAX;
    return take(t, p, frame, image, sampling);
}

#define SEEN 0.05 /* of the least, what its time may be off by */

/* What a picture takes with the least samples, and with an error beyond that. */
typedef struct view {
    zt_image *image;
    double least_s, error, more_s;
} view;

static zt_status see_least(view *v, pilot *p, int64_t frame) {
    taken t;
    v->least_s = INFINITY;
    for (int i = 0; i < (v->image == p->small ? 2 : 1); i++) {
        ZT_TRY(measure_adaptive(&t, p, frame, v->image, 1));
        v->least_s = fmin(v->least_s, t.render_s);
    }
    return ZT_OK;
}

static zt_status see_more(view *v, pilot *p, int64_t frame, double error) {
    taken t;
    ZT_TRY(measure_adaptive(&t, p, frame, v->image, error));
    v->error = error;
    v->least_s = fmin(v->least_s, t.render_s);
    v->more_s = fmax(t.render_s - v->least_s, SEEN * v->least_s);
    return ZT_OK;
}

/* The smallest error of a small picture that takes no more than so long beyond the least, or
 * with which nothing asks for more samples. */
static zt_status descend_small(view *small, pilot *p, int64_t frame, double most_s) {
    const double none = 1e-5;
    double step = 4;
    ZT_TRY(see_more(small, p, frame, 0.1));
    while (small->more_s < most_s) {
        bool little = small->more_s < 0.2 * small->least_s;
        view next = *small;
        if (small->error < none) {
            p->plan->enough = little ? 1 / small->error : 0;
            return ZT_OK;
        }
        if (!little) step = 2;
        ZT_TRY(see_more(&next, p, frame, small->error / step));
        if (next.more_s <= most_s)
            *small = next;
        else if (step > 2)
            step = 2;
        else
            return ZT_OK;
    }
    return ZT_OK;
}

/* Goes down to the error that fills the time of a frame, or the pilot's but for `keep_s`; sets
 * the plan's power, by which time grows at the last error. */
static zt_status descend(view *whole, pilot *p, int64_t frame, double frame_s, double keep_s) {
    double error = whole->error;
    for (bool first = true;; first = false) {
        view next = *whole;
        ZT_TRY(see_more(&next, p, frame, error));
        if (!first && whole->more_s > 2 * SEEN * whole->least_s) {
            double power = log(next.more_s / whole->more_s) / log(whole->error / error);
            p->plan->power = (USUAL_POWER + fmin(fmax(power, 1), STEEPEST)) / 2;
        }
        *whole = next;
        double room_s = fmin(p->left_s - keep_s, frame_s) - p->fixed_s - whole->least_s;
        if (p->plan->enough > 0 || room_s < 1.5 * whole->more_s) return ZT_OK;
        error /= pow(fmin(room_s / whole->more_s, 32), 1 / STEEPEST);
    }
}

/* The other frames are as many times the middle one as their small pictures are. */
static zt_status see_others(pilot *p, view *small, int64_t middle, double error) {
    zt_plan *plan = p->plan;
    zt_cost cost = plan->costs[0];
    ZT_TRY(see_more(small, p, middle, error));
    double each_s = 2 * p->fixed_s + 2 * small->least_s + small->more_s;
    int count = (int)fmin(p->left_s / each_s, most_frames(plan));
    for (int i = 0; i < count && count > 1; i++) {
        view other = *small;
        int64_t frame = spread_frame(plan, i, count);
        ZT_TRY(see_least(&other, p, frame));
        ZT_TRY(see_more(&other, p, frame, error));
        plan->costs[i] = (zt_cost){frame, cost.fixed_s * other.least_s / small->least_s,
                                   cost.unit_s * other.more_s / small->more_s, 1};
        plan->cost_count = count;
    }
    return ZT_OK;
}

static zt_status pilot_adaptive(pilot *p, double frame_s) {
    zt_plan *plan = p->plan;
    bool few = most_frames(plan) < ZT_COSTS_MAX; /* have too little time to be compared */
    int64_t middle = spread_frame(plan, 0, 1);
    view small = {.image = p->small}, whole = {.image = p->images[0]};
    /* Between edges alone and areas alone. */
    double times = 0.7 * p->many, keep_s = few ? 0 : p->left_s / 4;
    plan->sample_s = p->unit_s;
    ZT_TRY(see_least(&small, p, middle));
    whole.least_s = p->many * small.least_s;
    if (3 * (p->fixed_s + whole.least_s) < p->left_s) ZT_TRY(see_least(&whole, p, middle));
    double room_s = fmin(p->left_s - keep_s, frame_s) - p->fixed_s - whole.least_s;
    bool fits = room_s > 0.3 * whole.least_s;
    /* Two pictures, or one alone where the least samples take most of the time. */
    double part = room_s > 2 * whole.least_s ? 6 : 1;
    double most_s = fits ? room_s / part : frame_s - p->fixed_s - whole.least_s;
    ZT_TRY(descend_small(&small, p, middle, most_s / times));
    plan->power = USUAL_POWER;
    whole.error = small.error;
    whole.more_s = times * small.more_s;
    if (fits) ZT_TRY(descend(&whole, p, middle, frame_s, keep_s));
    if (plan->enough > 0) plan->enough = pow(plan->enough, plan->power);
    plan->cost_count = 1;
    plan->costs[0] = (zt_cost){middle, p->fixed_s + whole.least_s,
                               whole.more_s * pow(whole.error, plan->power), 1};
    return few ? ZT_OK : see_others(p, &small, middle, whole.error);
}

static zt_status make_images(pilot *p, const zt_output_format *format) {
    int width = (format->width + SMALLER - 1) / SMALLER,
        height = (format->height + SMALLER - 1) / SMALLER;
    p->many = (double)format->width * format->height / ((double)width * height);
    ZT_TRY(zt_image_create(&p->small, width, height));
    ZT_TRY(zt_image_create(&p->images[0], format->width, format->height));
    return zt_image_create(&p->images[1], format->width, format->height);
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
    if (status == ZT_OK) status = look(&p, spread_frame(plan, 0, 1));
    if (status == ZT_OK)
        status = adaptive ? pilot_adaptive(&p, all_s / frame_count) : pilot_even(&p);
    zt_image_free(&p.small);
    zt_image_free(&p.images[0]);
    zt_image_free(&p.images[1]);
    return status;
}
