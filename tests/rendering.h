/* Pictures of scenes that were put together by hand. */
#ifndef ZT_TESTS_RENDERING_H
#define ZT_TESTS_RENDERING_H

#include "render/expect.h"
#include "scenes.h"

static const vec3 white = {1, 1, 1};

/* Which of them all of the following render in. */
static zt_precision precision = ZT_PRECISION_AUTO;

/* Where they leave what smaller errors would take; NULL: nowhere. */
static zt_expected *expected = NULL;

/* Renders an exposure to an image that the caller frees, with the channels "samples" and
 * "error". The random numbers are the sampling's seed's. */
static inline zt_image *render_exposure(zt_render_count *count, const zt_exposure *exposure,
                                        int width, int height, zt_sampling sampling,
                                        int threads) {
    const zt_scene *scene = exposure->moments;
    zt_arena arena = {0};
    zt_meshes *meshes;
    zt_pool *pool;
    zt_render_work *work;
    zt_image *image;
    zt_ready ready;
    zt_lens *lens;
    assert_int_equal(
        zt_meshes_open(&meshes, scene->meshes, scene->mesh_count, threads, (zt_listener){0}),
        ZT_OK);
    assert_int_equal(zt_pool_open(&pool, threads), ZT_OK);
    assert_int_equal(zt_render_work_push(&work, &arena, threads), ZT_OK);
    assert_int_equal(zt_image_create(&image, width, height), ZT_OK);
    assert_int_equal(zt_image_add_channel(image, "samples"), ZT_OK);
    assert_int_equal(zt_image_add_channel(image, "error"), ZT_OK);
    assert_int_equal(zt_tracer_prepare(&ready, exposure, precision,
                                       zt_lens_pixel(&scene->camera, height), meshes, &arena),
                     ZT_OK);
    assert_int_equal(zt_lens_prepare(&lens, exposure, width, height, &arena), ZT_OK);
    zt_render_job job = {.scene = &ready,
                         .lens = lens,
                         .sampling = sampling,
                         .place_key = sampling.seed,
                         .frame_key = sampling.seed};
    assert_int_equal(zt_warp_prepare(&job.warp, &sampling, &arena), ZT_OK);
    assert_int_equal(zt_thin_prepare(&job.thin, exposure, width, height, &arena), ZT_OK);
    assert_int_equal(zt_render(image, count, &job, work, pool), ZT_OK);
    if (expected) zt_expect(expected, work, sampling.max);
    zt_render_work_close(work);
    zt_pool_close(&pool);
    zt_meshes_close(&meshes);
    zt_arena_free(&arena);
    return image;
}

/* The same of a scene at one moment; *left_out samples were not finite. */
static inline zt_image *render_sampled(int64_t *left_out, const zt_scene *scene, int width,
                                       int height, zt_sampling sampling, int threads) {
    zt_exposure exposure = zt_exposure_of(scene);
    zt_render_count count;
    zt_image *image = render_exposure(&count, &exposure, width, height, sampling, threads);
    *left_out = count.left_out;
    return image;
}

/* So many samples in each pixel. */
static inline zt_image *render_leaving_out(int64_t *left_out, const zt_scene *scene, int width,
                                           int height, int samples, int threads) {
    zt_sampling even = {.min = samples, .max = samples};
    return render_sampled(left_out, scene, width, height, even, threads);
}

static inline zt_image *render(const zt_scene *scene, int width, int height, int samples,
                               int threads) {
    int64_t left_out;
    zt_image *image = render_leaving_out(&left_out, scene, width, height, samples, threads);
    assert_int_equal(left_out, 0);
    return image;
}

/* Where the ray through the middle of pixel (x, y) runs, for pixels of the lens. */
static inline vec3 pixel_ray(const zt_scene *scene, int width, int height, int x, int y) {
    xform axes = zt_camera_xform(&scene->camera);
    double half = tan(scene->camera.fov / 2);
    double right = (2 * x + 1 - width) * half / height,
           up = (height - 2 * y - 1) * half / height;
    return vec3_normalize(
        vec3_sub(vec3_add(vec3_scale(axes.x, right), vec3_scale(axes.y, up)), axes.z));
}

static inline vec3 pixel_at(const zt_image *image, int x, int y) {
    const float *p = image->pixels + 4 * ((size_t)y * (size_t)image->width + (size_t)x);
    return (vec3){(double)p[0], (double)p[1], (double)p[2]};
}

#endif
