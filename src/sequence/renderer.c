/* One frame: freeze, prepare, render. */
#include "sequence/renderer.h"

#include <inttypes.h>
#include <stdlib.h>

#include "base/clock.h"
#include "base/diag.h"
#include "base/hash.h"
#include "base/module.h"
#include "base/usage.h"
#include "keyframe/animation.h"
#include "render/guides.h"
#include "sequence/keepsakes.h"
#include "sequence/pacing.h"
#include "sequence/reuse_check.h"
#include "sequence/shutter.h"

enum { THREADS_MAX = 1024, SAMPLES_MAX = 65536 };

static zt_status check_settings(const zt_render_settings *s) {
    bool both_or_neither = (s->width == 0) == (s->height == 0);
    bool sides = s->width >= 0 && s->height >= 0 && s->width <= ZT_IMAGE_SIDE_MAX &&
                 s->height <= ZT_IMAGE_SIDE_MAX;
    bool counts = s->samples >= 0 && s->samples <= SAMPLES_MAX && s->threads >= 0 &&
                  s->threads <= THREADS_MAX;
    return both_or_neither && sides && counts ? ZT_OK : ZT_EARGUMENT;
}

static zt_status open_parts(zt_renderer *r, int thread_count) {
    const zt_scene *rest = &r->animation->rest;
    ZT_TRY(zt_pool_open(&r->pool, thread_count));
    ZT_TRY(
        zt_meshes_open(&r->meshes, rest->meshes, rest->mesh_count, thread_count, r->listener));
    bool *stays = ZT_PUSH(&r->run, bool, (size_t)rest->object_count);
    if (!stays) return ZT_EMEMORY;
    zt_animation_stays(stays, r->animation);
    r->stays = stays;
    return zt_render_work_push(&r->work, &r->run, thread_count);
}

static bool has_meshes(const zt_scene *rest) {
    bool has = false;
    for (int32_t i = 0; i < rest->object_count; i++)
        has |= rest->objects[i].shape == ZT_SHAPE_MESH;
    return has;
}

/* What the film will need, and this program was built without, is told before all else. */
static zt_status check_built(const zt_animation *animation, zt_listener listener) {
    bool good =
        !has_meshes(&animation->rest) || zt_module_is_built("embree", "a mesh", listener);
    return good ? ZT_OK : ZT_EUNSUPPORTED;
}

/* What renders, what opens an output and what writes may each have something to say. */
static void tell_in_turn(void *user, const zt_message *message) {
    zt_renderer *r = user;
    mtx_lock(&r->telling);
    r->caller.tell(r->caller.user, message);
    mtx_unlock(&r->telling);
}

zt_status zt_renderer_open(zt_renderer **out, const zt_animation *animation,
                           const zt_render_settings *settings, zt_listener listener) {
    *out = NULL;
    ZT_TRY(check_settings(settings));
    ZT_TRY(check_built(animation, listener));
    zt_renderer *r = calloc(1, sizeof *r);
    if (!r) return ZT_EMEMORY;
    if (mtx_init(&r->telling, mtx_plain) != thrd_success) {
        free(r);
        return ZT_EMEMORY;
    }
    const zt_film *film = &animation->film;
    r->animation = animation;
    r->caller = listener;
    if (listener.tell) r->listener = (zt_listener){tell_in_turn, r};
    r->precision = settings->precision;
    r->aovs = film->aovs | settings->aovs;
    r->sampling = film->sampling;
    if (settings->samples) {
        r->sampling.min = r->sampling.max = settings->samples;
        r->sampling.error = 0;
        r->sampling.edges = false;
    }
    r->format = (zt_output_format){.width = settings->width ? settings->width : film->width,
                                   .height = settings->height ? settings->height : film->height,
                                   .rate = film->rate,
                                   .view = film->view,
                                   .color = film->color,
                                   .aovs = r->aovs,
                                   .transparent = film->transparent};
    r->checks_reuse = settings->check_reuse;
    zt_status status =
        open_parts(r, settings->threads ? settings->threads : zt_pool_core_count());
    if (status == ZT_OK && !settings->no_reuse)
        status = zt_reuse_open(&r->reuse, settings->check_reuse);
    if (status != ZT_OK) zt_renderer_close(&r);
    *out = r;
    return status;
}

void zt_renderer_close(zt_renderer **slot) {
    zt_renderer *r = *slot;
    if (!r) return;
    zt_pool_close(&r->pool);
    zt_meshes_close(&r->meshes);
    zt_render_work_close(r->work);
    zt_reuse_close(&r->reuse);
    zt_arena_free(&r->run);
    zt_arena_free(&r->frame);
    zt_pacing_free(&r->pacing);
    mtx_destroy(&r->telling);
    free(r);
    *slot = NULL;
}

zt_output_format zt_renderer_format(const zt_renderer *r) { return r->format; }

/* What decides a picture's rays. At edges, where they go on is decided anew in each one. */
static zt_hash view_of(const zt_renderer *r, const zt_taking *t) {
    const zt_sampling *s = &r->sampling;
    const bool at_edges = zt_render_is_at_edges(&t->job);
    const zt_hash cameras = zt_shutter_view(&t->exposure);
    const double numbers[] = {r->format.width,
                              r->format.height,
                              r->animation->film.transparent,
                              at_edges ? zt_render_first_samples(&t->job) : s->min,
                              s->max,
                              at_edges ? 0 : s->error,
                              at_edges ? 0 : s->mean_max,
                              s->edges,
                              s->filter,
                              s->filter_width,
                              s->seed,
                              s->seed_fixed};
    const zt_hash parts[] = {cameras, zt_hash_bytes(numbers, sizeof numbers)};
    return zt_hash_bytes(parts, sizeof parts);
}

zt_status zt_renderer_start(zt_renderer *r) {
    const zt_scene *rest = &r->animation->rest;
    int32_t bounded = 0;
    for (int32_t i = 0; i < rest->object_count; i++) {
        const zt_shape shape = rest->objects[i].shape;
        bounded += shape != ZT_SHAPE_PLANE && shape != ZT_SHAPE_GROUP;
    }
    bool crowd =
        bounded > ZT_SINGLE_MAX && zt_module_is_built("embree", NULL, (zt_listener){0});
    return crowd || has_meshes(rest) ? zt_meshes_start(r->meshes) : ZT_OK;
}

zt_status zt_renderer_prepare(zt_taking *t, zt_renderer *r, int64_t frame) {
    double begun_s = zt_clock_s();
    zt_arena_reset(&r->frame);
    ZT_TRY(zt_shutter_expose(&t->exposure, &t->division, r->animation, frame, r->format.height,
                             &r->frame, r->listener));
    t->exposure.stays = r->stays;
    double frozen_s = zt_clock_s();
    ZT_TRY(
        zt_tracer_prepare(&t->ready, &t->exposure, r->precision,
                          zt_lens_finest_pixel(&t->exposure, r->format.width, r->format.height),
                          r->meshes, &r->frame));
    ZT_TRY(
        zt_lens_prepare(&t->lens, &t->exposure, r->format.width, r->format.height, &r->frame));
    t->job = (zt_render_job){.scene = &t->ready,
                             .lens = t->lens,
                             .sampling = r->sampling,
                             .transparent = r->animation->film.transparent};
    ZT_TRY(zt_warp_prepare(&t->job.warp, &r->sampling, &r->frame));
    if (r->sampling.edges)
        ZT_TRY(zt_thin_prepare(&t->job.thin, &t->exposure, r->format.width, r->format.height,
                               &r->frame));
    zt_shutter_keys(&t->job.place_key, &t->job.frame_key, &t->exposure, &r->sampling);
    t->job.view = view_of(r, t);
    r->cost =
        (zt_frame_cost){.freeze_s = frozen_s - begun_s, .prepare_s = zt_clock_s() - frozen_s};
    return ZT_OK;
}

zt_status zt_renderer_choices(zt_frame_choices *choices, zt_renderer *r, int64_t frame) {
    zt_taking t;
    ZT_TRY(zt_renderer_prepare(&t, r, frame));
    zt_renderer_say(choices, r, &t.ready, &t.exposure, &t.division);
    return ZT_OK;
}

/* The camera in the middle of the opening. */
static zt_status find_matrices(zt_renderer *r, const zt_taking *t, int64_t frame) {
    zt_camera camera = t->exposure.moments[0].camera;
    if (t->exposure.moment_count > 1) {
        zt_scene middle;
        ZT_TRY(zt_shutter_middle(&middle, r->animation, frame, &r->frame, r->listener));
        camera = middle.camera;
    }
    zt_camera_matrices(r->world_to_camera, r->world_to_ndc, &camera,
                       (double)r->format.width / r->format.height);
    return ZT_OK;
}

/* What motion is between, where the image asks for it. */
static zt_status prepare_passage(zt_taking *t, zt_renderer *r, const zt_image *image,
                                 int64_t frame) {
    if (!zt_image_channel(image, "motion.x") && !zt_image_channel(image, "motion.y"))
        return ZT_OK;
    zt_scene *scenes = ZT_PUSH(&r->frame, zt_scene, 2);
    if (!scenes) return ZT_EMEMORY;
    for (int i = 0; i < 2; i++)
        ZT_TRY(zt_shutter_middle(&scenes[i], r->animation, frame + i, &r->frame, r->listener));
    return zt_passage_prepare(&t->passage, &scenes[0], &scenes[1],
                              t->exposure.moments[0].camera.position, &r->frame);
}

/* Adds the cost of the last frame to those of all. */
static void add_cost(zt_renderer *r) {
    const zt_frame_cost *cost = &r->cost;
    const zt_ray_counts *rays = &cost->rays;
    zt_stats *s = &r->stats;
    s->frames++;
    s->primary.traced += rays->primary;
    s->primary.avoided += rays->primary_avoided;
    s->shadow.traced += rays->shadow;
    s->shadow.avoided += rays->shadow_avoided;
    s->mirror.traced += rays->mirror;
    s->mirror.avoided += rays->mirror_avoided;
    s->batches += rays->batches;
    s->bare_batches += rays->bare_batches;
    s->flat_batches += rays->flat_batches;
    s->tiles += cost->tiles;
    s->copied_tiles += cost->tiles_copied;
    s->freeze_s += cost->freeze_s;
    s->prepare_s += cost->prepare_s;
    s->render_s += cost->render_s;
}

static zt_status take(zt_renderer *r, int64_t frame, zt_image *image, zt_reuse *reuse,
                      const zt_watcher *watcher) {
    if (image->width != r->format.width || image->height != r->format.height)
        return ZT_EARGUMENT;
    zt_taking t;
    zt_render_count count;
    const double own_s = zt_usage_own_s();
    ZT_TRY(zt_renderer_prepare(&t, r, frame));
    zt_renderer_doubt(r, &t.ready, &t.exposure, &t.division, frame);
    ZT_TRY(find_matrices(r, &t, frame));
    ZT_TRY(prepare_passage(&t, r, image, frame));
    t.job.reuse = reuse;
    if (reuse) zt_keepsakes_offer(r->keepsakes, &t.job, frame);
    t.job.stopped = watcher ? watcher->stopped : NULL;
    t.job.user = watcher ? watcher->user : NULL;
    double begun_s = zt_clock_s();
    ZT_TRY(zt_render(image, &count, &t.job, r->work, r->pool));
    ZT_TRY(zt_guides_render(image, &t.job, &t.exposure, &t.passage, r->work, r->pool));
    ZT_TRY(zt_meshes_status(r->meshes));
    r->cost.render_s = zt_clock_s() - begun_s;
    r->cost.own_s = zt_usage_own_s() - own_s;
    r->cost.left_out_count = count.left_out;
    r->cost.rays = count.rays;
    r->cost.tiles = count.tiles;
    r->cost.tiles_copied = count.tiles_copied;
    add_cost(r);
    if (count.left_out > 0)
        zt_tell(r->listener, ZT_WARNING,
                "frame %" PRId64 ": %" PRId64 " samples were not finite and are left out",
                frame, count.left_out);
    return reuse && r->checks_reuse ? zt_reuse_check(r, &t, frame, image) : ZT_OK;
}

zt_status zt_renderer_take(zt_renderer *r, int64_t frame, zt_image *image,
                           const zt_watcher *watcher) {
    return take(r, frame, image, NULL, watcher);
}

zt_status zt_renderer_frame(zt_renderer *r, int64_t frame, zt_image *image,
                            const zt_watcher *watcher) {
    zt_sampling own = r->sampling, sampling;
    double begun_s = zt_clock_s();
    ZT_TRY(zt_pacing_sampling(&sampling, r, frame));
    r->sampling = sampling;
    zt_status status = take(r, frame, image, r->reuse, watcher);
    r->sampling = own;
    ZT_TRY(status);
    zt_pacing_done(r, frame, zt_clock_s() - begun_s);
    return ZT_OK;
}
