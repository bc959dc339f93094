/* How a budget of time becomes samples: what frames cost, as a few of them showed, what each
 * one is allotted, and how that follows how long they really take. Knows no clock: it is told
 * the time. */
#ifndef ZT_SEQUENCE_BUDGET_H
#define ZT_SEQUENCE_BUDGET_H

#include <zoetrope/manifest.h>
#include <zoetrope/sampling.h>

/* What a frame costs: fixed_s + unit_s * work seconds. Work is samples a pixel; of adaptive
 * sampling it is error ^ -power, which samples beyond the least grow by. */
typedef struct zt_cost {
    int64_t frame;
    double fixed_s, unit_s;
    double share; /* of work that it asks for to have the same error as others; above 0 */
} zt_cost;

enum { ZT_COSTS_MAX = 9, ZT_PLAN_SAMPLES_MAX = 65536 };

/* Costs of frames between those that were looked at follow from their neighbours. */
typedef struct zt_plan {
    const int64_t *frames; /* rising; each comes in turn */
    int64_t frame_count;   /* at least 1 */
    zt_budget budget;
    zt_sampling sampling;        /* what the description says but for numbers */
    double power;                /* of adaptive sampling */
    zt_cost costs[ZT_COSTS_MAX]; /* by rising frame; cost_count, at least 1 */
    int cost_count;
    double sample_s; /* what a sample in each pixel takes; 0 where that is not known */
    double enough;   /* work beyond which no frame gets better; 0 where that is not known */
    /* Set by zt_plan_begin. */
    double level; /* a film's: work for a share of 1; a frame's: the budget's part
                     that is what the costs count as a second */
    double left_fixed_s, left_unit_s; /* of the frames to come, for a level of 1 */
    double saved_s; /* by rounding to whole samples, to be left so and not spent later */
    double took_s, meant_s; /* frames before, the later the more they count: really, and by
                               their costs */
} zt_plan;

/* Allots, given the time that has passed since the budget began. */
void zt_plan_begin(zt_plan *plan, double passed_s);

/* What a frame takes, as things stand. */
zt_sampling zt_plan_sampling(const zt_plan *plan, int64_t frame);

/* How long it may take with that. */
double zt_plan_seconds(const zt_plan *plan, int64_t frame);

/* The next frame is done. `took_s` is its own time. */
void zt_plan_done(zt_plan *plan, int64_t frame, double took_s, double passed_s);

/* How long all frames take with the least that can be asked of them. */
double zt_plan_least_s(const zt_plan *plan);

#endif
