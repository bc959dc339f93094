/* Adaptive sampling: estimates of errors against errors, and pictures against their targets.
 *
 * The numbers are fixed, so that a test which passes always does. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rendering.h"

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT, SEEDS = 24 };

/* Edges of all directions and contrasts, mirrored ones and shadows, and a fine pattern. */
static void things(test_scene *s) {
    scene_begin(s);
    int32_t floor = scene_material(s, (vec3){0.8, 0.8, 0.7}, 0.3);
    s->materials[floor].pattern = ZT_PATTERN_CHECKER;
    s->materials[floor].pattern_size = 0.7;
    scene_plane(s, (vec3){0, 1, 0}, -1, floor);
    scene_plane(s, (vec3){0, 0, 1}, -9, scene_material(s, (vec3){0.2, 0.3, 0.4}, 0));
    int32_t bright = scene_material(s, (vec3){0.9, 0.5, 0.2}, 0);
    int32_t dark = scene_material(s, (vec3){0.25, 0.3, 0.4}, 0);
    for (int i = 0; i < 6; i++)
        scene_sphere(s, (vec3){1.1 * i - 2.7, 0.3 * i - 0.7, -3.3 - 0.5 * i}, 0.5,
                     i % 2 ? bright : dark);
    scene_triangle(s, (vec3){-2, -1, -2.5}, (vec3){-0.5, 1.8, -4}, (vec3){-1.7, 2, -3}, dark);
    scene_point_light(s, (vec3){2, 5, 1}, 25);
    scene_ambient(s, white, 0.15);
}

/* And light that is a mean over a lamp as well. */
static void soft_things(test_scene *s) {
    things(s);
    s->lights[0].radius = 0.8;
}

/* The true standard error of each pixel, the root of the mean square of its errors over all
 * seeds, against the root of the mean of the squared estimates. */
static void compare(const test_scene *s, zt_sampling sampling, const zt_image *reference,
                    double least, double factor, double low_share, double high_share) {
    static double truth[PIXELS], estimate[PIXELS];
    int64_t left_out;
    memset(truth, 0, sizeof truth);
    memset(estimate, 0, sizeof estimate);
    for (int seed = 0; seed < SEEDS; seed++) {
        sampling.seed = 1000 + (uint32_t)seed;
        zt_image *image = render_sampled(&left_out, &s->scene, WIDTH, HEIGHT, sampling, 2);
        const float *error = zt_image_channel(image, "error");
        for (int i = 0; i < PIXELS; i++) {
            for (int k = 0; k < 3; k++) {
                double d =
                    (double)image->pixels[4 * i + k] - (double)reference->pixels[4 * i + k];
                truth[i] += d * d / 3 / SEEDS;
            }
            estimate[i] += (double)error[i] * (double)error[i] / SEEDS;
        }
        zt_image_free(&image);
    }
    double all_truth = 0, all_estimate = 0;
    int counted = 0, low = 0, high = 0;
    for (int i = 0; i < PIXELS; i++) {
        all_truth += truth[i];
        all_estimate += estimate[i];
        double t = sqrt(truth[i]), e = sqrt(estimate[i]);
        if (t < least && e < least) continue; /* too little to be of interest */
        counted++;
        low += e * factor < t;
        high += t >= least && e > t * factor;
    }
    double ratio = sqrt(all_estimate / all_truth);
    print_message("%d pixels: estimated %.3f of the error; too low %.2f %%, too high %.2f %%\n",
                  counted, ratio, 100.0 * low / counted, 100.0 * high / counted);
    assert_true(counted > 200);
    assert_true(ratio > 0.8 && ratio < 1.6);
    assert_true(low <= low_share * counted);
    assert_true(high <= high_share * counted);
}

/* Of the pixels whose error or estimate is above 0.002, the estimate is too low by more than a
 * factor of 2.5 in at most 5 %, being those that stop when they are lucky; and of those whose
 * error is, too high by as much in at most 10 %: what is next to an edge counts as part of it.
 */
static void estimates_are_errors(void **state) {
    (void)state;
    static test_scene s;
    int64_t left_out;
    for (int soft = 0; soft < 2; soft++) {
        soft ? soft_things(&s) : things(&s);
        zt_sampling much = {.min = 4096, .max = 4096, .seed = 5};
        zt_image *reference = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, much, 2);
        const zt_sampling samplings[] = {
            {.min = 4, .max = 256, .error = 0.02},
            {.min = 4, .max = 1024, .error = 0.006},
        };
        for (int i = 0; i < 2; i++) compare(&s, samplings[i], reference, 0.002, 2.5, 0.05, 0.1);
        zt_image_free(&reference);
    }
}

/* A bound on the mean holds however small the error asked for; each pixel has its first samples
 * all the same, where edges are looked for as well, and the bits do not depend on threads. */
static void means_are_bounded(void **state) {
    (void)state;
    static test_scene s;
    int64_t left_out;
    things(&s);
    for (int edges = 0; edges < 2; edges++) {
        zt_sampling sampling = {
            .min = 4, .max = 65536, .error = 1e-5, .mean_max = 20, .edges = edges};
        double mean = 0;
        zt_image *image = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, sampling, 2);
        zt_image *other = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, sampling, 1);
        const float *samples = zt_image_channel(image, "samples");
        for (int i = 0; i < PIXELS; i++) {
            mean += (double)samples[i] / PIXELS;
            assert_true(samples[i] >= (edges ? 1 : 4));
        }
        assert_true(mean > 6 && mean <= 20);
        assert_memory_equal(image->pixels, other->pixels, 4 * PIXELS * sizeof *image->pixels);
        zt_image_free(&image);
        zt_image_free(&other);
    }
}

/* What a picture would take with errors that are smaller by two to eight times is known from
 * its pixels, to within a half. */
static void expectations_come_true(void **state) {
    (void)state;
    static test_scene s;
    things(&s);
    const zt_exposure exposure = zt_exposure_of(&s.scene);
    for (int edges = 0; edges < 2; edges++) {
        const int begin = 4 * ZT_EXPECT_OCTAVE;
        zt_sampling sampling = {
            .min = 4, .max = 65536, .error = zt_expect_error(begin), .edges = edges};
        static zt_expected first;
        zt_render_count before, after;
        expected = &first;
        zt_image *image = render_exposure(&before, &exposure, WIDTH, HEIGHT, sampling, 2);
        expected = NULL;
        zt_image_free(&image);
        assert_true(first.further[begin] < 0.05 * (double)before.samples);
        for (int octave = 1; octave <= 3; octave++) {
            int i = begin + octave * ZT_EXPECT_OCTAVE;
            sampling.error = zt_expect_error(i);
            image = render_exposure(&after, &exposure, WIDTH, HEIGHT, sampling, 2);
            zt_image_free(&image);
            double further = (double)(after.samples - before.samples);
            if (getenv("ZT_TEST_PRINTS"))
                print_message("edges %d, %d octaves: %g expected, %g taken\n", edges, octave,
                              first.further[i], further);
            assert_true(first.further[i] > further / 1.5 && first.further[i] < further * 1.5);
        }
    }
}

/* A target is met: by nearly all pixels, each within 2.5 times of it, and by the picture. */
static void targets_are_met(void **state) {
    (void)state;
    static test_scene s;
    int64_t left_out;
    things(&s);
    zt_sampling much = {.min = 4096, .max = 4096, .seed = 5};
    zt_image *reference = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, much, 2);
    double last = 0;
    for (int i = 0; i < 3; i++) {
        static const double targets[] = {0.03, 0.01, 0.003};
        zt_sampling sampling = {.min = 4, .max = 4096, .error = targets[i], .seed = 77};
        zt_image *image = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, sampling, 2);
        const float *taken = zt_image_channel(image, "samples");
        double square = 0, samples = 0;
        int off = 0;
        for (int p = 0; p < PIXELS; p++) {
            double own = 0;
            for (int k = 0; k < 3; k++) {
                double d =
                    (double)image->pixels[4 * p + k] - (double)reference->pixels[4 * p + k];
                own += d * d / 3;
            }
            square += own;
            samples += (double)taken[p];
            off += sqrt(own) > 2.5 * targets[i];
        }
        print_message("target %g: %.5f with %.1f samples a pixel, off by more: %d\n",
                      targets[i], sqrt(square / PIXELS), samples / PIXELS, off);
        assert_true(sqrt(square / PIXELS) < targets[i]);
        assert_true(off <= PIXELS / 100);
        assert_true(samples > last);
        last = samples;
        zt_image_free(&image);
    }
    zt_image_free(&reference);
}

/* The same edge within a tile and where tiles meet takes the same samples, about: a tile is
 * nothing to a pixel. An edge that goes up along column 16 + 0.3 or 24 + 0.3. */
static void tiles_have_no_borders(void **state) {
    (void)state;
    static test_scene s;
    int64_t left_out;
    double sums[2];
    for (int i = 0; i < 2; i++) {
        double x = (16 + 8 * i + 0.3 - WIDTH / 2.0) * 2 / HEIGHT;
        scene_begin(&s);
        scene_triangle(&s, (vec3){x - 0.4, -90, -1}, (vec3){x + 0.4, 90, -1},
                       (vec3){200, 0, -1}, scene_material(&s, white, 0));
        scene_ambient(&s, white, 1);
        zt_sampling sampling = {.min = 4, .max = 4096, .error = 0.004, .seed = 9};
        zt_image *image = render_sampled(&left_out, &s.scene, WIDTH, HEIGHT, sampling, 2);
        const float *taken = zt_image_channel(image, "samples");
        sums[i] = 0;
        for (int p = 0; p < PIXELS; p++) sums[i] += (double)taken[p] - 4;
        zt_image_free(&image);
    }
    assert_true(sums[0] > 48 * 60);
    assert_true(fabs(sums[0] / sums[1] - 1) < 0.1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(estimates_are_errors),   cmocka_unit_test(means_are_bounded),
        cmocka_unit_test(expectations_come_true), cmocka_unit_test(targets_are_met),
        cmocka_unit_test(tiles_have_no_borders),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
