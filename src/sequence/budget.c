#include "sequence/budget.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* By how much more or less a frame may take than the one before for what was found out
 * meanwhile: a step in noise of half of this is not seen. */
#define STEP 1.08

/* What counts of the frames before when the next one is done, and how many frames as meant
 * those are worth that the pilot saw. */
#define MEMORY 0.95
enum { TRUST = 2 };
#define LEAST_ERROR 1e-6

/* How much more than it is allotted a frame may take that is noisier than those that were
 * looked at, as far as samples cost what they do where all pixels take as many. */
#define MOST_TIMES 1.5

static bool is_adaptive(const zt_plan *p) { return p->sampling.min != p->sampling.max; }

static double between(double a, double b, double u) { return a + (b - a) * u; }
static double between_logs(double a, double b, double u) {
    return exp(between(log(a), log(b), u));
}

static zt_cost cost_of(const zt_plan *p, int64_t frame) {
    const zt_cost *b = p->costs, *end = p->costs + p->cost_count - 1;
    while (b < end && b->frame < frame) b++;
    const zt_cost *a = b > p->costs && b->frame > frame ? b - 1 : b;
    double way = (double)(b->frame - a->frame);
    double u = way > 0 ? (double)(frame - a->frame) / way : 0;
    return (zt_cost){frame, between(a->fixed_s, b->fixed_s, u),
                     between_logs(a->unit_s, b->unit_s, u),
                     between_logs(a->share, b->share, u)};
}

/* The work that a frame is allotted, as a real number; none may come out. */
static double work_of(const zt_plan *p, const zt_cost *c) {
    double work = p->budget.film_s > 0
                      ? c->share * p->level
                      : (p->budget.frame_s * p->level - c->fixed_s) / c->unit_s;
    return p->enough > 0 ? fmin(work, p->enough) : work;
}

/* Samples to the nearest whole number; of few, where one more is much, rather less. */
static int samples_for(double work) {
    double nearest = work < 3.5 ? floor(1.15 * work) : floor(work + 0.5);
    return (int)fmin(fmax(nearest, 1), ZT_PLAN_SAMPLES_MAX);
}

/* To three digits, so that it reads well in a manifest. */
static double error_for(double work, double power) {
    double error = work > 0 ? pow(work, -1 / power) : 1;
    char text[32];
    snprintf(text, sizeof text, "%.3g", fmin(fmax(error, LEAST_ERROR), 1));
    return strtod(text, NULL);
}

static double whole_work(const zt_plan *p, double work) {
    if (!is_adaptive(p)) return samples_for(work);
    return pow(error_for(work, p->power), -p->power);
}

/* Where the level should be, as far as can be told now: not so low that it would not come back.
 */
static double best_level(const zt_plan *p, double passed_s) {
    double slow = p->took_s / p->meant_s;
    if (!(p->budget.film_s > 0)) return 1 / slow;
    double left_s = p->budget.film_s - passed_s - p->saved_s;
    return fmax((left_s / slow - p->left_fixed_s) / p->left_unit_s, 0.1);
}

void zt_plan_begin(zt_plan *p, double passed_s) {
    p->left_fixed_s = p->left_unit_s = p->saved_s = 0;
    for (int64_t i = 0; i < p->frame_count; i++) {
        zt_cost c = cost_of(p, p->frames[i]);
        p->left_fixed_s += c.fixed_s;
        p->left_unit_s += c.unit_s * c.share;
    }
    p->took_s = p->meant_s = 1; /* whatever: as fast as was seen */
    p->level = best_level(p, passed_s);
    double meant_s = p->budget.film_s > 0 ? (p->left_fixed_s + p->left_unit_s * p->level) /
                                                (double)p->frame_count
                                          : p->budget.frame_s;
    p->took_s = p->meant_s = TRUST * meant_s;
}

/* Where no further samples are taken, whatever the error. */
static int mean_max_for(const zt_plan *p, int64_t frame) {
    if (!(p->sample_s > 0)) return 0;
    double mean = ceil(MOST_TIMES * zt_plan_seconds(p, frame) / p->sample_s);
    return (int)fmin(fmax(mean, 1), ZT_PLAN_SAMPLES_MAX);
}

zt_sampling zt_plan_sampling(const zt_plan *p, int64_t frame) {
    zt_cost c = cost_of(p, frame);
    zt_sampling sampling = p->sampling;
    if (is_adaptive(p)) {
        sampling.error = error_for(work_of(p, &c), p->power);
        sampling.max = ZT_PLAN_SAMPLES_MAX;
        sampling.mean_max = mean_max_for(p, frame);
    } else {
        sampling.min = sampling.max = samples_for(work_of(p, &c));
    }
    return sampling;
}

double zt_plan_seconds(const zt_plan *p, int64_t frame) {
    zt_cost c = cost_of(p, frame);
    return c.fixed_s + c.unit_s * whole_work(p, work_of(p, &c));
}

void zt_plan_done(zt_plan *p, int64_t frame, double took_s, double passed_s) {
    zt_cost c = cost_of(p, frame);
    double work = work_of(p, &c), slow = p->took_s / p->meant_s;
    /* What rounding saved or cost is not made up for by the frames to come, or else they would
     * go up and down between two whole numbers. */
    p->saved_s += slow * c.unit_s * (work - whole_work(p, work));
    p->took_s = MEMORY * p->took_s + took_s;
    p->meant_s = MEMORY * p->meant_s + zt_plan_seconds(p, frame);
    p->left_fixed_s -= c.fixed_s;
    p->left_unit_s -= c.unit_s * c.share;
    if (frame != p->frames[p->frame_count - 1])
        p->level = fmin(fmax(best_level(p, passed_s), p->level / STEP), p->level * STEP);
}

double zt_plan_least_s(const zt_plan *p) {
    double sum = 0;
    for (int64_t i = 0; i < p->frame_count; i++) {
        zt_cost c = cost_of(p, p->frames[i]);
        sum += c.fixed_s + (is_adaptive(p) ? 0 : c.unit_s);
    }
    return sum;
}
