/* Which rungs a ladder has, and what follows from what they came to. */
#include "sequence/ladder.h"

#include <math.h>
#include <stdlib.h>

enum { REFERENCE_FACTOR = 16, ADAPTIVE_LEAST = 4, RUNGS_MAX = 256 };

static const double targets[] = {0.05, 0.02, 0.01, 0.005, 0.002};
enum { TARGET_COUNT = sizeof targets / sizeof *targets };

/* Of independent errors the squares add up: above this many times its reference's own error, a
 * tenth of what is measured is the reference's at most. */
static const double known_above = 2.2;

/* ---- the plan ------------------------------------------------------------------------------
 */

static zt_rung *add(zt_ladder *ladder, zt_rung_kind kind, zt_sampling sampling) {
    zt_rung *rung = &ladder->rungs[ladder->rung_count++];
    *rung = (zt_rung){.kind = kind, .sampling = sampling};
    return rung;
}

static zt_sampling even(zt_sampling sampling, int samples) {
    sampling.min = sampling.max = samples;
    sampling.error = 0;
    sampling.edges = false;
    return sampling;
}

/* 1, 2, 3, 4, 6, 8, 12 and so on: half as many again, and a third more, in turn. */
static int next_count(int samples) {
    bool power = (samples & (samples - 1)) == 0;
    return samples == 1 ? 2 : power ? samples / 2 * 3 : samples / 3 * 4;
}

static void add_counts(zt_ladder *ladder, const zt_sampling *film, zt_precision precision) {
    for (int samples = 1; samples <= ladder->samples; samples = next_count(samples))
        add(ladder, ZT_RUNG_SAMPLES, even(*film, samples))->precision = precision;
}

static void add_targets(zt_ladder *ladder, const zt_sampling *film, zt_rung_kind kind,
                        zt_precision precision) {
    zt_sampling sampling = *film;
    sampling.edges = kind == ZT_RUNG_EDGES;
    sampling.min = sampling.edges ? 1 : ADAPTIVE_LEAST;
    sampling.max = ladder->samples;
    for (int i = 0; i < TARGET_COUNT && sampling.max > sampling.min; i++) {
        sampling.error = targets[i];
        add(ladder, kind, sampling)->precision = precision;
    }
}

/* Few counts, to compare by: each fourfold. */
static void add_few_counts(zt_ladder *ladder, zt_sampling sampling, zt_precision precision,
                           int reference) {
    for (int samples = 1; samples <= ladder->samples; samples *= 4) {
        zt_rung *rung = add(ladder, ZT_RUNG_SAMPLES, even(sampling, samples));
        rung->precision = precision;
        rung->reference = reference;
        rung->other_precision = reference == 0;
    }
}

static void add_reference(zt_ladder *ladder, zt_filter filter) {
    ladder->references[ladder->reference_count++] =
        (zt_ladder_reference){.filter = filter, .samples = REFERENCE_FACTOR * ladder->samples};
}

zt_status zt_ladder_plan(zt_ladder *ladder, const zt_sampling *film, zt_precision precision,
                         bool both, bool filters) {
    ladder->rungs = calloc(RUNGS_MAX, sizeof *ladder->rungs);
    if (!ladder->rungs) return ZT_EMEMORY;
    add_reference(ladder, film->filter);
    add_counts(ladder, film, precision);
    add_targets(ladder, film, ZT_RUNG_ADAPTIVE, precision);
    add_targets(ladder, film, ZT_RUNG_EDGES, precision);
    if (both)
        add_few_counts(
            ladder, *film,
            precision == ZT_PRECISION_SINGLE ? ZT_PRECISION_DOUBLE : ZT_PRECISION_SINGLE, 0);
    for (int f = 0; filters && f < ZT_FILTER_COUNT; f++) {
        if ((zt_filter)f == film->filter) continue;
        add_reference(ladder, (zt_filter)f);
        zt_sampling sampling = *film;
        sampling.filter = (zt_filter)f;
        sampling.filter_width = 0;
        add_few_counts(ladder, sampling, precision, ladder->reference_count - 1);
    }
    return ZT_OK;
}

/* ---- what is left out ----------------------------------------------------------------------
 */

static void leave_out(zt_ladder *ladder, bool does, const char *words) {
    if (does) ladder->left_out[ladder->left_out_count++] = words;
}

void zt_ladder_say_left_out(zt_ladder *ladder, const zt_exposure *exposure) {
    const zt_scene *scene = exposure->moments;
    bool mesh = false, mirror = false, pattern = false, shadow = false, wide = false;
    for (int32_t i = 0; i < scene->object_count; i++)
        mesh |= scene->objects[i].shape == ZT_SHAPE_MESH;
    for (int32_t i = 0; i < scene->material_count; i++) {
        mirror |= scene->reflection_depth > 0 && scene->materials[i].reflectivity > 0;
        pattern |= scene->materials[i].pattern != ZT_PATTERN_NONE;
    }
    for (int32_t i = 0; i < scene->light_count; i++) {
        const zt_light *light = &scene->lights[i];
        if (light->kind == ZT_LIGHT_AMBIENT) continue;
        shadow |= light->shadows;
        wide |= light->kind != ZT_LIGHT_POINT || light->radius > 0;
    }
    bool pinhole = scene->camera.aperture <= 0 && scene->camera.f_number <= 0;
    leave_out(ladder, exposure->moment_count == 1,
              "motion: nothing moves while the shutter is open");
    leave_out(ladder, pinhole,
              "random points of the lens: its opening is a pinhole, and all is sharp");
    leave_out(ladder, !wide, "random points of lamps: none of them has a size");
    leave_out(ladder, !shadow, "shadow rays: no lamp casts shadows");
    leave_out(ladder, !mirror, "mirrored rays: nothing reflects");
    leave_out(ladder, !pattern, "patterns: all colors are plain");
    leave_out(ladder, !mesh, "Embree: there are no meshes");
}

/* ---- what follows --------------------------------------------------------------------------
 */

double zt_ladder_slope(const double *x, const double *y, int count) {
    if (count < 2) return NAN;
    double mean_x = 0, mean_y = 0, across = 0, along = 0;
    for (int i = 0; i < count; i++) {
        mean_x += log(x[i]) / count;
        mean_y += log(y[i]) / count;
    }
    for (int i = 0; i < count; i++) {
        double dx = log(x[i]) - mean_x;
        across += dx * (log(y[i]) - mean_y);
        along += dx * dx;
    }
    return across / along;
}

int zt_ladder_knee(const double *x, const double *y, int count) {
    int knee = -1;
    double furthest = 0.1 * log(10);
    for (int i = 1; i < count - 1; i++) {
        double share = log(x[i] / x[0]) / log(x[count - 1] / x[0]);
        double below = log(y[0]) + share * log(y[count - 1] / y[0]) - log(y[i]);
        if (below < furthest) continue;
        furthest = below;
        knee = i;
    }
    return knee;
}

bool zt_ladder_knows(const zt_ladder *ladder, const zt_rung *rung) {
    return rung->error.rmse >= known_above * ladder->references[rung->reference].error;
}

int zt_ladder_choose(const zt_ladder *ladder, double rmse) {
    int best = -1;
    if (rmse < known_above * ladder->references[0].error) return -1;
    for (int i = 0; i < ladder->rung_count; i++) {
        const zt_rung *rung = &ladder->rungs[i];
        if (rung->reference != 0 || rung->other_precision || !(rung->error.rmse <= rmse))
            continue;
        if (best < 0 || rung->frame_s < ladder->rungs[best].frame_s) best = i;
    }
    return best;
}
