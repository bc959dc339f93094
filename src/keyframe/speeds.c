/* All is in multiples of the steps, so that no slope in units a second, which could overflow,
 * is ever formed. */
#include "keyframe/speeds.h"

#include <math.h>
#include <string.h>

#include "base/vec.h"

/* ---- smooth --------------------------------------------------------------------------------
 */

/* The speed at the key as a multiple, in 0..2, of the mean speed of the step on one side.
 * `relation` is the mean speed of the other step in that measure, `weight` this step's share of
 * the time of both. */
static double limited(double relation, double weight) {
    if (!(relation > 0)) return 0;
    double parabola = relation * weight + (1 - weight);
    return 2 * fmin(fmin(1, relation), parabola / 2);
}

void zt_speeds_smooth(zt_speeds *speeds, const zt_steps *steps) {
    double weight = steps->after_s / (steps->before_s + steps->after_s);
    for (int c = 0; c < steps->width; c++) {
        double before = steps->before[c], after = steps->after[c];
        double relation = (before / after) * (steps->after_s / steps->before_s);
        speeds->arrive[c] = before * limited(1 / relation, 1 - weight);
        speeds->leave[c] = after * limited(relation, weight);
    }
}

/* The half turn during the time of the step `after`, which takes `relation` times as long as
 * the step `before`. */
static vec3 limited_turn(vec3 before, vec3 after, double relation) {
    double b = vec3_length(before) * relation, a = vec3_length(after);
    if (!(a > 0) || !(b > 0)) return (vec3){0, 0, 0};
    double weight = relation / (1 + relation);
    vec3 mean = vec3_add(vec3_scale(before, relation * weight), vec3_scale(after, 1 - weight));
    double cosine = vec3_dot(vec3_normalize(before), vec3_normalize(after));
    double speed = fmin(vec3_length(mean), 2 * fmin(a, b)) * (1 + cosine) / 2;
    return vec3_scale(vec3_normalize(mean), fmax(speed, 0));
}

void zt_speeds_smooth_turns(zt_speeds *speeds, const zt_steps *steps) {
    vec3 before = {steps->before[0], steps->before[1], steps->before[2]};
    vec3 after = {steps->after[0], steps->after[1], steps->after[2]};
    /* Limited, so that no product overflows where one step is instantaneous beside the other.
     */
    double relation = fmin(fmax(steps->after_s / steps->before_s, 1e-100), 1e100);
    vec3 arrive = limited_turn(after, before, 1 / relation);
    vec3 leave = limited_turn(before, after, relation);
    memcpy(speeds->arrive, &arrive, sizeof arrive);
    memcpy(speeds->leave, &leave, sizeof leave);
}

/* ---- the others ----------------------------------------------------------------------------
 */

/* A quarter of the length, which cannot overflow. */
static double quarter_length(const double *step, int width) {
    double largest = 0, sum = 0;
    for (int c = 0; c < width; c++) largest = fmax(largest, fabs(step[c]));
    if (!(largest > 0)) return 0;
    for (int c = 0; c < width; c++) sum += (step[c] / largest) * (step[c] / largest);
    return largest / 4 * sqrt(sum);
}

void zt_speeds_catmull_rom(zt_speeds *speeds, const zt_steps *steps) {
    double before = quarter_length(steps->before, steps->width);
    double after = quarter_length(steps->after, steps->width);
    *speeds = (zt_speeds){0};
    if (!(before > 0) || !(after > 0)) return;
    /* With knots apart by the roots of the lengths, the derivative of the parabola through the
     * three keys comes down to this. */
    double knot_before = sqrt(before), knot_after = sqrt(after);
    double weight = knot_before / (knot_before + knot_after);
    for (int c = 0; c < steps->width; c++) {
        double along_before = steps->before[c] / before, along_after = steps->after[c] / after;
        speeds->arrive[c] = (1 - weight) * (steps->before[c] + before * along_after);
        speeds->leave[c] = weight * (after * along_before + steps->after[c]);
    }
}

void zt_speeds_tcb(zt_speeds *speeds, const zt_steps *steps, double tension, double continuity,
                   double bias) {
    double share = steps->after_s / (steps->before_s + steps->after_s);
    double past = (1 - tension) * (1 + bias), next = (1 - tension) * (1 - bias);
    for (int c = 0; c < steps->width; c++) {
        double before = steps->before[c], after = steps->after[c];
        speeds->arrive[c] =
            (1 - share) * (past * (1 - continuity) * before + next * (1 + continuity) * after);
        speeds->leave[c] =
            share * (past * (1 + continuity) * before + next * (1 - continuity) * after);
    }
}
