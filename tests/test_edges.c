/* Edges first: what is refined, what is not, and that thin things are found wherever they fall.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rendering.h"

enum { SIDE = 48, PIXELS = SIDE * SIDE };

static const zt_sampling edges = {
    .min = 1, .max = 256, .error = 0.01, .edges = true, .seed = 4};

static zt_image *picture(const test_scene *s, zt_sampling sampling) {
    int64_t left_out;
    zt_image *image = render_sampled(&left_out, &s->scene, SIDE, SIDE, sampling, 2);
    assert_int_equal(left_out, 0);
    return image;
}

static double root_mean_square(const zt_image *a, const zt_image *b) {
    double sum = 0;
    for (int i = 0; i < 4 * PIXELS; i++) {
        double d = (double)a->pixels[i] - (double)b->pixels[i];
        sum += d * d;
    }
    return sqrt(sum / (3.0 * PIXELS));
}

static void room(test_scene *s) {
    scene_begin(s);
    int32_t mirror = scene_material(s, (vec3){0.5, 0.6, 0.7}, 0.4);
    scene_plane(s, (vec3){0, 1, 0}, -1, mirror);
    scene_plane(s, (vec3){0, 0, 1}, -6, scene_material(s, (vec3){0.4, 0.5, 0.4}, 0));
    scene_sphere(s, (vec3){0.4, -0.3, -3}, 0.7, scene_material(s, (vec3){0.9, 0.4, 0.2}, 0));
    scene_point_light(s, (vec3){2, 4, 0}, 20);
    scene_ambient(s, white, 0.1);
}

/* What is no edge keeps the very bits of one sample a pixel; edges come as near to the truth as
 * asked, for a share of the samples. */
static void edges_alone_are_refined(void **state) {
    (void)state;
    static test_scene s;
    room(&s);
    zt_image *image = picture(&s, edges);
    zt_image *one = picture(&s, (zt_sampling){.min = 1, .max = 1});
    zt_image *truth = picture(&s, (zt_sampling){.min = 4096, .max = 4096, .seed = 8});
    const float *samples = zt_image_channel(image, "samples");
    int refined = 0, off = 0;
    for (int i = 0; i < PIXELS; i++) {
        refined += samples[i] > 1;
        if (samples[i] == 1)
            assert_memory_equal(image->pixels + 4 * i, one->pixels + 4 * i, 4 * sizeof(float));
        for (int k = 0; k < 3; k++)
            off += fabs((double)image->pixels[4 * i + k] - (double)truth->pixels[4 * i + k]) >
                   3 * edges.error;
    }
    assert_in_range(refined, PIXELS / 50, PIXELS / 3);
    assert_true(off <= PIXELS / 200);
    assert_true(root_mean_square(image, truth) < edges.error / 2);
    assert_true(root_mean_square(one, truth) > 4 * root_mean_square(image, truth));
    zt_image_free(&image);
    zt_image_free(&one);
    zt_image_free(&truth);
}

/* A pole thinner than a pixel, from top to bottom, in the middle between the middles of pixels,
 * so that no first sample meets it: each row of the picture has as much of it as there is. */
static void thin_things_are_found_between_pixels(void **state) {
    (void)state;
    static test_scene s;
    const double pixel = 2.0 / SIDE;
    for (int i = 0; i < 4; i++) {
        static const double widths[] = {0.7, 0.3, 0.12, 0.05};
        for (int slanted = 0; slanted < 2; slanted++) {
            double lean = slanted ? 0.25 : 0, x = slanted ? 0 : 6 * pixel;
            scene_begin(&s);
            zt_object *pole = scene_object(&s, ZT_SHAPE_CYLINDER, scene_material(&s, white, 0));
            double across = 1 / sqrt(1 + lean * lean);
            pole->tube = (zt_tube){.from = {x - 3 * lean, -3, -1},
                                   .to = {x + 3 * lean, 3, -1},
                                   .radius = widths[i] / 2 * pixel * across};
            scene_ambient(&s, white, 1);
            zt_image *image = picture(&s, edges);
            zt_image *one = picture(&s, (zt_sampling){.min = 1, .max = 1});
            for (int y = 0; y < SIDE; y++) {
                double sum = 0, first = 0;
                for (int column = 0; column < SIDE; column++) {
                    sum += pixel_at(image, column, y).x;
                    first += pixel_at(one, column, y).x;
                }
                if (!slanted) assert_true(first == 0);
                assert_float_equal(sum, widths[i], 0.4 * widths[i] + 0.02);
            }
            zt_image_free(&image);
            zt_image_free(&one);
        }
    }
}

/* A rail that runs from before the eye to far away, where it is thin, and passes beside it. */
static void a_rail_to_the_horizon_is_found(void **state) {
    (void)state;
    static test_scene s;
    scene_begin(&s);
    zt_object *rail = scene_object(&s, ZT_SHAPE_CYLINDER, scene_material(&s, white, 0));
    rail->tube = (zt_tube){.from = {0.3, -0.5, 2}, .to = {30.3, -2, -400}, .radius = 0.01};
    scene_ambient(&s, white, 1);
    zt_image *image = picture(&s, edges);
    zt_image *truth = picture(&s, (zt_sampling){.min = 4096, .max = 4096, .seed = 8});
    for (int y = 0; y < SIDE; y++) {
        double sum = 0, wanted = 0;
        for (int x = 0; x < SIDE; x++) {
            sum += pixel_at(image, x, y).x;
            wanted += pixel_at(truth, x, y).x;
        }
        assert_float_equal(sum, wanted, 0.15 * wanted + 0.02);
    }
    zt_image_free(&image);
    zt_image_free(&truth);
}

/* Colors alone are edges as well: two patches that differ by less than the error allows are
 * left, and by more are refined. */
static void a_step_in_color_counts_by_its_size(void **state) {
    (void)state;
    static test_scene s;
    for (int i = 0; i < 2; i++) {
        double step = i ? 0.2 : 0.004;
        scene_begin(&s);
        int32_t material = scene_material(&s, (vec3){0.5, 0.5, 0.5}, 0);
        s.materials[material].pattern = ZT_PATTERN_STRIPES;
        s.materials[material].other_color = (vec3){0.5 + step, 0.5, 0.5};
        s.materials[material].pattern_size = 5;
        s.materials[material].pattern_direction = (vec3){1, 0.2, 0};
        scene_plane(&s, (vec3){0, 0, 1}, -1, material);
        scene_ambient(&s, white, 1);
        zt_image *image = picture(&s, edges);
        const float *samples = zt_image_channel(image, "samples");
        int most = 1;
        for (int k = 0; k < PIXELS; k++) most = (int)fmax(most, (double)samples[k]);
        assert_true(i ? most >= 8 : most <= 2);
        zt_image_free(&image);
    }
}

/* A wide filter brings an edge to pixels beside it, and these are refined too. */
static void filters_reach_edges_next_door(void **state) {
    (void)state;
    static test_scene s;
    room(&s);
    for (int filter = ZT_FILTER_TENT; filter < ZT_FILTER_COUNT; filter++) {
        zt_sampling own = edges;
        own.filter = (zt_filter)filter;
        zt_image *image = picture(&s, own);
        zt_sampling much = {.min = 4096, .max = 4096, .seed = 8, .filter = (zt_filter)filter};
        zt_image *truth = picture(&s, much);
        assert_true(root_mean_square(image, truth) < edges.error);
        zt_image_free(&image);
        zt_image_free(&truth);
    }
}

/* Where a lamp has a size, every pixel is a mean: all are sampled. */
static void random_light_is_sampled_everywhere(void **state) {
    (void)state;
    static test_scene s;
    room(&s);
    s.lights[0].radius = 0.5;
    zt_image *image = picture(&s, edges);
    const float *samples = zt_image_channel(image, "samples");
    for (int i = 0; i < PIXELS; i++) assert_true(samples[i] >= 4);
    zt_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_alone_are_refined),
        cmocka_unit_test(thin_things_are_found_between_pixels),
        cmocka_unit_test(a_rail_to_the_horizon_is_found),
        cmocka_unit_test(a_step_in_color_counts_by_its_size),
        cmocka_unit_test(filters_reach_edges_next_door),
        cmocka_unit_test(random_light_is_sampled_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
