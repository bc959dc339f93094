#include "cli/findings.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double asked_for[ZT_ADVICE_COUNT] = {0.02, 0.01, 0.005, 0.002, 0.001, 0.0005};

/* What is recommended first, where it can be had, and where it is more than the first rung
 * gives anyway: then the least that is not. */
static const double usual = 0.005;

static int count_even(const zt_ladder *ladder) {
    int count = 0;
    while (count < ladder->rung_count && ladder->rungs[count].kind == ZT_RUNG_SAMPLES &&
           !ladder->rungs[count].other_precision && ladder->rungs[count].reference == 0)
        count++;
    return count;
}

enum { FITTED_MAX = 64 };

/* Where the error bends, of counts that are powers of two: those between are spread less well,
 * and each of them would be a bend. */
static int find_knee(const zt_findings *f) {
    double time[FITTED_MAX] = {0}, error[FITTED_MAX] = {0};
    int rungs[FITTED_MAX] = {0}, count = 0;
    for (int i = f->first_fitted; i < f->first_fitted + f->fitted_count; i++) {
        const zt_rung *rung = &f->ladder->rungs[i];
        if ((rung->sampling.max & (rung->sampling.max - 1)) != 0) continue;
        time[count] = rung->frame_s;
        error[count] = rung->error.rmse;
        rungs[count++] = i;
    }
    int knee = zt_ladder_knee(time, error, count);
    return knee < 0 ? -1 : rungs[knee];
}

/* A single sample is in the middle of its pixel and no random one; and what is near the
 * reference's own error is not known well enough. */
static void fit(zt_findings *f) {
    double time[FITTED_MAX] = {0}, samples[FITTED_MAX] = {0}, error[FITTED_MAX] = {0};
    const zt_rung *rungs = f->ladder->rungs;
    f->first_fitted = f->even_count > 1 ? 1 : 0;
    for (int i = f->first_fitted; i < f->even_count && f->fitted_count < FITTED_MAX; i++) {
        if (!zt_ladder_knows(f->ladder, &rungs[i]) || !(rungs[i].error.rmse > 0)) break;
        time[f->fitted_count] = rungs[i].frame_s;
        samples[f->fitted_count] = rungs[i].sampling.max;
        error[f->fitted_count++] = rungs[i].error.rmse;
    }
    f->slope_time = zt_ladder_slope(time, error, f->fitted_count);
    f->slope_samples = zt_ladder_slope(samples, error, f->fitted_count);
    f->knee = find_knee(f);
}

zt_findings zt_findings_of(const zt_ladder *ladder, const zt_animation *animation) {
    zt_findings f = {
        .ladder = ladder, .animation = animation, .even_count = count_even(ladder), .best = -1};
    fit(&f);
    for (int i = 0; i < ZT_ADVICE_COUNT; i++) {
        f.advice[i] = (zt_advice){asked_for[i], zt_ladder_choose(ladder, asked_for[i])};
        bool more = f.best < 0 || asked_for[i] >= usual || f.advice[f.best].rung == 0;
        if (f.advice[i].rung >= 0 && more) f.best = i;
    }
    return f;
}

double zt_findings_film_s(const zt_findings *findings, const zt_rung *rung) {
    return rung->frame_s * (double)zt_animation_film(findings->animation)->frame_count;
}

/* ---- words ---------------------------------------------------------------------------------
 */

zt_words zt_words_of_rung(const zt_rung *rung) {
    zt_words w;
    const zt_sampling *s = &rung->sampling;
    size_t size = sizeof w.text;
    if (rung->kind == ZT_RUNG_ADAPTIVE)
        snprintf(w.text, size, "adaptive, error %g", s->error);
    else if (rung->kind == ZT_RUNG_EDGES)
        snprintf(w.text, size, "edges, error %g", s->error);
    else
        snprintf(w.text, size, "%d sample%s", s->max, s->max == 1 ? "" : "s");
    size_t used = strlen(w.text);
    if (rung->other_precision)
        snprintf(w.text + used, size - used, ", %s precision",
                 zt_precision_name(rung->precision));
    if (rung->reference > 0)
        snprintf(w.text + used, size - used, ", %s filter", zt_filter_name(s->filter));
    return w;
}

zt_words zt_words_of_setting(const zt_rung *rung) {
    zt_words w;
    const zt_sampling *s = &rung->sampling;
    if (rung->kind == ZT_RUNG_SAMPLES)
        snprintf(w.text, sizeof w.text, "samples: %d", s->max);
    else
        snprintf(w.text, sizeof w.text, "%ssamples: { min: %d, max: %d, error: %g }",
                 rung->kind == ZT_RUNG_EDGES ? "quality: edges, " : "", s->min, s->max,
                 s->error);
    return w;
}

/* Two digits, or all of whole numbers. */
static zt_words quantity(double number, const char *unit) {
    zt_words w;
    snprintf(w.text, sizeof w.text, number < 9.95 ? "%.2g %s" : "%.0f %s", number, unit);
    return w;
}

zt_words zt_words_of_time(double s) {
    if (s < 0.000995) return quantity(1e6 * s, "µs");
    if (s < 0.9995) return quantity(1e3 * s, "ms");
    if (s < 99.5) return quantity(s, "s");
    return s < 5970 ? quantity(s / 60, "min") : quantity(s / 3600, "h");
}

zt_words zt_words_of_bytes(double bytes) { return quantity(bytes / 1e6, "MB"); }

zt_words zt_words_of_error(const zt_findings *findings, const zt_rung *rung) {
    zt_words w;
    bool known = zt_ladder_knows(findings->ladder, rung);
    snprintf(w.text, sizeof w.text, "%s%.2g", known ? "" : "≤ ", rung->error.rmse);
    return w;
}
