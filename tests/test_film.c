/* What samples become: further channels of images, the same bits on any number of threads,
 * samples that are not finite, and how many are taken. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rendering.h"

enum { WIDTH = 50, HEIGHT = 37 };

/* Channels are there once asked for, each with numbers of its own, and hold no more than there
 * is room for. */
static void channels_are_named(void **state) {
    (void)state;
    static const char *const names[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i",
                                        "j", "k", "l", "m", "n", "o", "p", "q", "r",
                                        "s", "t", "u", "v", "w", "x", "y"};
    zt_image *image;
    assert_int_equal(zt_image_create(&image, 3, 2), ZT_OK);
    assert_null(zt_image_channel(image, "a"));
    for (int i = 0; i < ZT_IMAGE_CHANNELS_MAX; i++) {
        assert_int_equal(zt_image_add_channel(image, names[i]), ZT_OK);
        float *values = zt_image_channel(image, names[i]);
        assert_non_null(values);
        for (int k = 0; k < 6; k++) assert_true(values[k] == 0);
        for (int k = 0; k < 6; k++) values[k] = (float)(10 * i + k);
    }
    assert_int_equal(zt_image_add_channel(image, "c"), ZT_OK);
    assert_true(zt_image_channel(image, "c")[5] == 25);
    assert_int_equal(zt_image_add_channel(image, names[ZT_IMAGE_CHANNELS_MAX]), ZT_EARGUMENT);
    assert_int_equal(image->channel_count, ZT_IMAGE_CHANNELS_MAX);
    zt_image_free(&image);
}

/* Balls over a mirror, with a shadow. */
static void balls(test_scene *s) {
    scene_begin(s);
    scene_plane(s, (vec3){0, 1, 0}, -1, scene_material(s, (vec3){0.5, 0.6, 0.7}, 0.4));
    int32_t material = scene_material(s, (vec3){0.9, 0.4, 0.2}, 0);
    for (int i = 0; i < 5; i++)
        scene_sphere(s, (vec3){i - 2.1, 0.3 * i - 0.7, -3 - 0.4 * i}, 0.45, material);
    scene_point_light(s, (vec3){2, 4, 0}, 20);
    scene_ambient(s, white, 0.1);
}

/* Each of the ways to take samples. */
static const zt_sampling ways[] = {
    {.min = 5, .max = 5},
    {.min = 4, .max = 64, .error = 0.01, .seed = 1},
    {.min = 1, .max = 7, .error = 0, .seed = 2},
    {.min = 1, .max = 64, .error = 0.004, .edges = true, .seed = 3},
    {.min = 8, .max = 8, .edges = true, .filter = ZT_FILTER_TENT},
    {.min = 4, .max = 32, .error = 0.01, .filter = ZT_FILTER_MITCHELL},
    {.min = 6, .max = 6, .filter = ZT_FILTER_MITCHELL},
    {.min = 1, .max = 32, .error = 0.01, .edges = true, .filter = ZT_FILTER_BLACKMAN_HARRIS},
};
enum { WAY_COUNT = sizeof ways / sizeof *ways };

static void assert_same(const zt_image *a, const zt_image *b) {
    assert_memory_equal(a->pixels, b->pixels, sizeof(float) * 4 * WIDTH * HEIGHT);
    for (int i = 0; i < a->channel_count; i++)
        assert_memory_equal(a->channels[i].values, zt_image_channel(b, a->channels[i].name),
                            sizeof(float) * WIDTH * HEIGHT);
}

static void threads_change_no_bit(void **state) {
    (void)state;
    test_scene s;
    int64_t left_out;
    balls(&s);
    for (int i = 0; i < WAY_COUNT; i++) {
        zt_image *one = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, ways[i], 1);
        for (int threads = 2; threads <= 5; threads += 3) {
            zt_image *more =
                render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, ways[i], threads);
            assert_same(one, more);
            zt_image_free(&more);
        }
        zt_image_free(&one);
    }
}

/* No pixel takes more samples than allowed, nor fewer than asked for, unless it is no edge. */
static void counts_stay_within_what_is_asked(void **state) {
    (void)state;
    test_scene s;
    int64_t left_out;
    balls(&s);
    for (int i = 0; i < WAY_COUNT; i++) {
        zt_image *image = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, ways[i], 2);
        const float *samples = zt_image_channel(image, "samples"),
                    *error = zt_image_channel(image, "error");
        int most = 0, single = 0;
        for (int k = 0; k < WIDTH * HEIGHT; k++) {
            int count = (int)samples[k];
            bool is_single = ways[i].edges && count == 1;
            assert_true(is_single || (count >= ways[i].min && count <= ways[i].max));
            bool even =
                !ways[i].edges && ways[i].filter == ZT_FILTER_BOX && ways[i].min == ways[i].max;
            assert_true(is_single || even ? error[k] == -1 : error[k] >= 0);
            most = count > most ? count : most;
            single += is_single;
        }
        assert_int_equal(most, ways[i].max); /* there are edges sharp enough for that */
        assert_true(ways[i].edges == (single > 0));
        zt_image_free(&image);
    }
}

/* Two renderings of a film, one after the other with the same memory, are the same as by
 * themselves: nothing of a picture stays for the next one. */
static void nothing_stays_for_the_next_picture(void **state) {
    (void)state;
    test_scene s;
    int64_t left_out;
    balls(&s);
    zt_arena arena = {0};
    zt_meshes *meshes;
    zt_pool *pool;
    zt_render_work *work;
    zt_image *image;
    zt_ready ready;
    zt_lens *lens;
    zt_render_count count;
    zt_exposure exposure = zt_exposure_of(&s.scene);
    assert_int_equal(zt_meshes_open(&meshes, NULL, 0, 2, (zt_listener){0}), ZT_OK);
    assert_int_equal(zt_pool_open(&pool, 2), ZT_OK);
    assert_int_equal(zt_render_work_push(&work, &arena, 2), ZT_OK);
    assert_int_equal(zt_image_create(&image, WIDTH, HEIGHT), ZT_OK);
    assert_int_equal(zt_image_add_channel(image, "samples"), ZT_OK);
    assert_int_equal(zt_image_add_channel(image, "error"), ZT_OK);
    assert_int_equal(zt_tracer_prepare(&ready, &exposure, ZT_PRECISION_AUTO,
                                       zt_lens_pixel(&s.scene.camera, HEIGHT), meshes, &arena),
                     ZT_OK);
    assert_int_equal(zt_lens_prepare(&lens, &exposure, WIDTH, HEIGHT, &arena), ZT_OK);
    for (int round = 0; round < 2 * WAY_COUNT; round++) {
        const zt_sampling *way = &ways[round * 3 % WAY_COUNT];
        zt_render_job job = {.scene = &ready,
                             .lens = lens,
                             .sampling = *way,
                             .place_key = way->seed,
                             .frame_key = way->seed};
        assert_int_equal(zt_warp_prepare(&job.warp, way, &arena), ZT_OK);
        assert_int_equal(zt_thin_prepare(&job.thin, &exposure, WIDTH, HEIGHT, &arena), ZT_OK);
        assert_int_equal(zt_render(image, &count, &job, work, pool), ZT_OK);
        zt_image *alone = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, *way, 1);
        assert_same(image, alone);
        zt_image_free(&alone);
    }
    zt_render_work_close(work);
    zt_pool_close(&pool);
    zt_meshes_close(&meshes);
    zt_arena_free(&arena);
    zt_image_free(&image);
}

/* A lamp so bright that its light is no number leaves half of the picture out, and that is
 * counted; what remains is as bright as it is, and no pixel goes on for ever. */
static void what_is_not_finite_is_left_out(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_plane(&s, (vec3){0, 0, 1}, -1, scene_material(&s, white, 0));
    int32_t broken = scene_material(&s, (vec3){INFINITY, 0, 0}, 0);
    scene_triangle(&s, (vec3){0, -50, -0.9}, (vec3){0, 50, -0.9}, (vec3){90, 0, -0.9}, broken);
    scene_ambient(&s, white, 0.5);
    for (int i = 0; i < WAY_COUNT; i++) {
        int64_t left_out;
        zt_image *image = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, ways[i], 2);
        assert_true(left_out > 0);
        for (int k = 0; k < 4 * WIDTH * HEIGHT; k++) assert_true(isfinite(image->pixels[k]));
        assert_float_equal(pixel_at(image, 3, 3).x, 0.5, 1e-6);
        assert_true(pixel_at(image, WIDTH - 3, 3).x == 0);
        zt_image_free(&image);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(channels_are_named),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(counts_stay_within_what_is_asked),
        cmocka_unit_test(nothing_stays_for_the_next_picture),
        cmocka_unit_test(what_is_not_finite_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
