/* Renders the rungs of a ladder, and measures. */
#include "sequence/ladder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <zoetrope/output.h>

#include "base/clock.h"
#include "base/diag.h"
#include "base/usage.h"
#include "sequence/renderer.h"
#include "sequence/shutter.h"

enum { SAMPLES_DEFAULT = 64, SAMPLES_MAX = 4096, PILOT_SAMPLES = 4, RUNS_MAX = 5 };

/* A frame that takes less is rendered several times, and the median counts. */
static const double long_enough_s = 0.4;

/* The two halves of a reference have seeds of their own. */
static const uint32_t half_seeds[2] = {0x9e3779b9, 0x7f4a7c15};

/* A ladder under way. */
typedef struct climb {
    zt_ladder *ladder;
    const zt_ladder_settings *settings;
    const zt_animation *animation;
    const zt_watcher *watcher;
    zt_listener listener;
    zt_renderer *renderer;
    zt_sampling film;       /* what the film asks for */
    zt_precision precision; /* what was asked for */
    /* Of two neighbouring frames. */
    zt_image *references[2], *images[2], *half;
    int64_t done, total; /* frames times samples */
    char directory[32];  /* for files that are written; "" while there is none */
} climb;

/* What a run of a frame took. */
typedef struct cost {
    zt_frame_cost frame;
    double frame_s, cpu_s;
} cost;

/* ---- one frame -----------------------------------------------------------------------------
 */

static zt_status render(climb *c, zt_image *image, int64_t frame) {
    const zt_watcher only_stops = {.stopped = c->watcher ? c->watcher->stopped : NULL,
                                   .user = c->watcher ? c->watcher->user : NULL};
    return zt_renderer_frame(c->renderer, frame, image, &only_stops);
}

static void tell_progress(climb *c, int samples, int64_t frame) {
    c->done += samples;
    if (c->watcher && c->watcher->progress)
        c->watcher->progress(c->watcher->user, c->done, c->total, frame);
}

static zt_status run_once(cost *k, climb *c, zt_image *image, int64_t frame) {
    double begun_s = zt_clock_s(), cpu_s = zt_usage_cpu_s();
    ZT_TRY(render(c, image, frame));
    *k = (cost){c->renderer->cost, zt_clock_s() - begun_s, zt_usage_cpu_s() - cpu_s};
    return ZT_OK;
}

static int by_time(const void *a, const void *b) {
    double x = ((const cost *)a)->frame_s, y = ((const cost *)b)->frame_s;
    return (x > y) - (x < y);
}

/* Renders a frame, a short one several times; what it took is the median. */
static zt_status measure(cost *median, climb *c, zt_image *image, int64_t frame) {
    cost runs[RUNS_MAX] = {0};
    int count = 0;
    for (double all_s = 0; count < RUNS_MAX && (all_s < long_enough_s || count % 2 == 0);
         count++) {
        ZT_TRY(run_once(&runs[count], c, image, frame));
        all_s += runs[count].frame_s;
    }
    qsort(runs, (size_t)count, sizeof *runs, by_time);
    *median = runs[count / 2];
    return ZT_OK;
}

/* Writes an image to a file that goes away again. */
static zt_status measure_writing(double *seconds, climb *c, const zt_image *image) {
    if (!*c->directory) {
        strcpy(c->directory, "/tmp/zoetrope-XXXXXX");
        if (!mkdtemp(c->directory)) {
            *c->directory = '\0';
            zt_tell(c->listener, ZT_ERROR, "no directory can be made in /tmp");
            return ZT_EFILE;
        }
    }
    char path[sizeof c->directory + 16];
    snprintf(path, sizeof path, "%s/frame.png", c->directory);
    zt_output_format format = zt_renderer_format(c->renderer);
    format.frame_count = 1;
    zt_output *output;
    double begun_s = zt_clock_s();
    zt_status status = zt_output_open(&output, path, &format, NULL, c->listener);
    if (status != ZT_OK) return status;
    status = zt_output_write(output, image, 0);
    zt_status closed = zt_output_close(&output);
    *seconds = zt_clock_s() - begun_s;
    unlink(path);
    return status == ZT_OK ? closed : status;
}

/* ---- references ----------------------------------------------------------------------------
 */

/* Makes `image` the mean of itself and the other half; returns how far they were apart. */
static double join_halves(zt_image *image, const zt_image *half) {
    double apart = zt_compare_rmse(image, half);
    size_t count = 4 * (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; i++)
        image->pixels[i] = 0.5f * (image->pixels[i] + half->pixels[i]);
    return apart;
}

/* Renders the references of `count` frames; adds up what they took and the square of their
 * error. */
static zt_status make_references(climb *c, zt_ladder_reference *reference,
                                 const zt_sampling *sampling, const int64_t *frames,
                                 int count) {
    c->renderer->precision = ZT_PRECISION_DOUBLE;
    c->renderer->sampling = *sampling;
    zt_sampling *now = &c->renderer->sampling;
    now->min = now->max = reference->samples / 2;
    now->error = 0;
    now->edges = false;
    for (int f = 0; f < count; f++) {
        double begun_s = zt_clock_s();
        for (int h = 0; h < 2; h++) {
            now->seed = sampling->seed ^ half_seeds[h];
            ZT_TRY(render(c, h == 0 ? c->references[f] : c->half, frames[f]));
            tell_progress(c, now->max, frames[f]);
        }
        reference->frame_s += zt_clock_s() - begun_s;
        double apart = join_halves(c->references[f], c->half);
        reference->error += apart * apart / 4;
    }
    return ZT_OK;
}

/* ---- rungs ---------------------------------------------------------------------------------
 */

static void add_cost(zt_rung *rung, const cost *k, double write_s, double pixels) {
    rung->stages.freeze_s += k->frame.freeze_s;
    rung->stages.prepare_s += k->frame.prepare_s;
    rung->stages.render_s += k->frame.render_s;
    rung->stages.write_s += write_s;
    rung->frame_s += k->frame_s;
    rung->cpu_s += k->cpu_s;
    rung->primary_rays += (double)k->frame.rays.primary;
    rung->shadow_rays += (double)k->frame.rays.shadow;
    rung->mirror_rays += (double)k->frame.rays.mirror;
    rung->shadow_rays_avoided += (double)k->frame.rays.shadow_avoided;
    rung->mirror_rays_avoided += (double)k->frame.rays.mirror_avoided;
    rung->batches += (double)k->frame.rays.batches;
    rung->short_batches += (double)(k->frame.rays.bare_batches + k->frame.rays.flat_batches);
    rung->samples += (double)k->frame.rays.primary / pixels;
    rung->peak_bytes = fmax(rung->peak_bytes, (double)zt_usage_peak());
    rung->left_out += (double)k->frame.left_out_count;
}

static void add_error(zt_rung *rung, const zt_difference *d) {
    zt_difference *sum = &rung->error;
    sum->rmse += d->rmse * d->rmse;
    sum->relative_mse += d->relative_mse;
    sum->p999 += d->p999;
    sum->not_finite += d->not_finite;
    sum->psnr_db += d->psnr_db;
    sum->ssim += d->ssim;
    sum->flip += d->flip;
}

static zt_status climb_rung(climb *c, zt_rung *rung, const int64_t *frames, int count,
                            bool show) {
    zt_output_format format = zt_renderer_format(c->renderer);
    c->renderer->precision = rung->other_precision ? rung->precision : c->precision;
    c->renderer->sampling = rung->sampling;
    for (int f = 0; f < count; f++) {
        cost k;
        double write_s;
        zt_difference difference;
        zt_usage_forget_peak();
        ZT_TRY(measure(&k, c, c->images[f], frames[f]));
        ZT_TRY(measure_writing(&write_s, c, c->images[f]));
        add_cost(rung, &k, write_s, (double)format.width * format.height);
        ZT_TRY(zt_compare(&difference, c->images[f], c->references[f], format.view));
        add_error(rung, &difference);
        tell_progress(c, rung->sampling.max, frames[f]);
    }
    if (count == 2) {
        double flicker =
            zt_compare_flicker(c->images[0], c->references[0], c->images[1], c->references[1]);
        rung->flicker += flicker * flicker;
    }
    if (show && c->settings->show)
        c->settings->show(c->settings->user, rung, c->images[0], c->references[0]);
    return ZT_OK;
}

/* All rungs on `count` neighbouring frames. */
static zt_status climb_frames(climb *c, const int64_t *frames, int count, bool first) {
    zt_ladder *ladder = c->ladder;
    for (int ref = 0; ref < ladder->reference_count; ref++) {
        zt_sampling sampling = c->film;
        sampling.filter = ladder->references[ref].filter;
        if (ref > 0) sampling.filter_width = 0;
        ZT_TRY(make_references(c, &ladder->references[ref], &sampling, frames, count));
        for (int i = 0; i < ladder->rung_count; i++)
            if (ladder->rungs[i].reference == ref)
                ZT_TRY(climb_rung(c, &ladder->rungs[i], frames, count, first));
    }
    return ZT_OK;
}

/* ---- the ladder ----------------------------------------------------------------------------
 */

/* Sums become means, of `frames` frames and `pairs` pairs of neighbours. */
static void average(zt_ladder *ladder, int pairs) {
    double frames = ladder->frame_count;
    for (int i = 0; i < ladder->reference_count; i++) {
        ladder->references[i].error = sqrt(ladder->references[i].error / frames);
        ladder->references[i].frame_s /= frames;
    }
    for (int i = 0; i < ladder->rung_count; i++) {
        zt_rung *rung = &ladder->rungs[i];
        double *means[] = {&rung->stages.freeze_s,
                           &rung->stages.prepare_s,
                           &rung->stages.render_s,
                           &rung->stages.write_s,
                           &rung->frame_s,
                           &rung->cpu_s,
                           &rung->primary_rays,
                           &rung->shadow_rays,
                           &rung->mirror_rays,
                           &rung->shadow_rays_avoided,
                           &rung->mirror_rays_avoided,
                           &rung->batches,
                           &rung->short_batches,
                           &rung->samples,
                           &rung->left_out,
                           &rung->error.rmse,
                           &rung->error.relative_mse,
                           &rung->error.p999,
                           &rung->error.not_finite,
                           &rung->error.psnr_db,
                           &rung->error.ssim,
                           &rung->error.flip};
        for (size_t k = 0; k < sizeof means / sizeof *means; k++) *means[k] /= frames;
        rung->error.rmse = sqrt(rung->error.rmse);
        rung->flicker = pairs > 0 ? sqrt(rung->flicker / pairs) : NAN;
    }
}

/* The frame, and the next one; of the last of the film, the one before. */
static int neighbours(int64_t frames[2], int64_t frame, int64_t frame_count) {
    frames[0] = frame;
    frames[1] = frame + 1 < frame_count ? frame + 1 : frame - 1;
    return frame_count > 1 ? 2 : 1;
}

/* How many samples the largest rung takes; renders and writes a frame, which also warms up. */
static zt_status choose_samples(climb *c) {
    int samples = c->settings->render.samples ? c->settings->render.samples : SAMPLES_DEFAULT;
    cost k;
    c->renderer->sampling.min = c->renderer->sampling.max = PILOT_SAMPLES;
    c->renderer->sampling.error = 0;
    c->renderer->sampling.edges = false;
    double write_s;
    ZT_TRY(run_once(&k, c, c->images[0], c->settings->frames[0]));
    ZT_TRY(measure_writing(&write_s, c, c->images[0]));
    double limit_s = c->settings->frame_limit_s;
    if (limit_s > 0) {
        ZT_TRY(measure(&k, c, c->images[0], c->settings->frames[0]));
        double once_s = k.frame_s - k.frame.render_s;
        double most = PILOT_SAMPLES * (limit_s - once_s) / k.frame.render_s;
        samples = most < samples ? (int)fmax(most, 1) : samples;
    }
    c->ladder->samples = samples;
    return ZT_OK;
}

static zt_status plan(climb *c) {
    zt_ladder *ladder = c->ladder;
    zt_renderer *r = c->renderer;
    zt_frame_choices choices;
    int64_t frame = c->settings->frames[0];
    zt_exposure exposure;
    zt_division division;
    ZT_TRY(choose_samples(c));
    ZT_TRY(zt_renderer_choices(&choices, r, frame));
    memcpy(ladder->precision, choices.precision_text, sizeof ladder->precision);
    memcpy(ladder->motion, choices.motion_text, sizeof ladder->motion);
    zt_arena_reset(&r->frame);
    ZT_TRY(zt_shutter_expose(&exposure, &division, c->animation, frame, ladder->height,
                             &r->frame, c->listener));
    zt_ladder_say_left_out(ladder, &exposure);
    ZT_TRY(zt_ladder_plan(ladder, &c->film, choices.precision,
                          c->precision == ZT_PRECISION_AUTO, c->settings->filters));
    int pair = zt_animation_film(c->animation)->frame_count > 1 ? 2 : 1;
    ladder->frame_count = pair * c->settings->frame_count;
    for (int i = 0; i < ladder->rung_count; i++) c->total += ladder->rungs[i].sampling.max;
    for (int i = 0; i < ladder->reference_count; i++) c->total += ladder->references[i].samples;
    c->total *= ladder->frame_count;
    return ZT_OK;
}

static zt_status climb_all(climb *c) {
    int64_t film_frames = zt_animation_film(c->animation)->frame_count;
    zt_image **images[] = {&c->references[0], &c->references[1], &c->images[0], &c->images[1],
                           &c->half};
    for (size_t i = 0; i < sizeof images / sizeof *images; i++)
        ZT_TRY(zt_image_create(images[i], c->ladder->width, c->ladder->height));
    ZT_TRY(plan(c));
    for (int i = 0; i < c->settings->frame_count; i++) {
        int64_t frames[2];
        int count = neighbours(frames, c->settings->frames[i], film_frames);
        ZT_TRY(climb_frames(c, frames, count, i == 0));
    }
    if (zt_renderer_unmet(c->renderer, NULL, NULL) > 0)
        c->ladder->left_out[c->ladder->left_out_count++] = "meshes that no ray came near";
    average(c->ladder, film_frames > 1 ? c->settings->frame_count : 0);
    return ZT_OK;
}

static zt_status open_and_climb(climb *c) {
    zt_render_settings settings = c->settings->render;
    settings.no_reuse = true; /* what is measured is rendering */
    settings.samples = 0;     /* each rung has its own */
    ZT_TRY(zt_renderer_open(&c->renderer, c->animation, &settings, c->listener));
    zt_output_format format = zt_renderer_format(c->renderer);
    c->ladder->width = format.width;
    c->ladder->height = format.height;
    c->ladder->threads = zt_pool_thread_count(c->renderer->pool);
    c->film = c->renderer->sampling;
    c->precision = c->renderer->precision;
    return climb_all(c);
}

zt_status zt_ladder_climb(zt_ladder **ladder, const zt_animation *animation,
                          const zt_ladder_settings *settings, const zt_watcher *watcher,
                          zt_listener listener) {
    *ladder = NULL;
    if (settings->frame_count < 1 || settings->render.samples > SAMPLES_MAX) {
        zt_tell(listener, ZT_ERROR, "a ladder needs a frame, and has at most %d samples",
                SAMPLES_MAX);
        return ZT_EARGUMENT;
    }
    climb c = {.ladder = calloc(1, sizeof *c.ladder),
               .settings = settings,
               .animation = animation,
               .watcher = watcher,
               .listener = listener};
    if (!c.ladder) return ZT_EMEMORY;
    zt_status status = open_and_climb(&c);
    if (*c.directory) rmdir(c.directory);
    zt_renderer_close(&c.renderer);
    zt_image_free(&c.references[0]);
    zt_image_free(&c.references[1]);
    zt_image_free(&c.images[0]);
    zt_image_free(&c.images[1]);
    zt_image_free(&c.half);
    if (status != ZT_OK) zt_ladder_free(&c.ladder);
    *ladder = c.ladder;
    return status;
}

void zt_ladder_free(zt_ladder **ladder) {
    if (*ladder) free((*ladder)->rungs);
    free(*ladder);
    *ladder = NULL;
}
