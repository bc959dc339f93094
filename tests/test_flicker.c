/* Films do not flicker: what is noise in one frame is no more than that from one frame to the
 * next, and what is smaller than a pixel shines evenly while it crosses pixels. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <zoetrope/renderer.h>

#include "descriptions.h"

enum { WIDTH = 64, HEIGHT = 36, PIXELS = WIDTH * HEIGHT };

static zt_image *take(const char *text, int64_t frame) {
    zt_animation *animation = animation_of(text);
    zt_renderer *renderer;
    zt_image *image;
    assert_int_equal(
        zt_renderer_open(&renderer, animation, &(zt_render_settings){0}, (zt_listener){0}),
        ZT_OK);
    assert_int_equal(zt_image_create(&image, WIDTH, HEIGHT), ZT_OK);
    assert_int_equal(zt_renderer_frame(renderer, frame, image, NULL), ZT_OK);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
    return image;
}

/* The root of the mean square of what two pictures differ by. */
static double apart(const zt_image *a, const zt_image *b) {
    double sum = 0;
    for (int i = 0; i < 4 * PIXELS; i++) {
        double off = (double)a->pixels[i] - (double)b->pixels[i];
        sum += off * off;
    }
    return sqrt(sum / (3 * PIXELS)); /* the fourth channel is the same */
}

/* Balls in the soft light of lamps with a size; a lamp that shines nowhere to be seen moves, so
 * that all frames have noise of their own. */
#define STILL                                                                                  \
    "zoetrope: 1\n"                                                                            \
    "film: { size: [64, 36], duration: 4, view: raw, %s }\n"                                   \
    "camera: { position: [0, 2, 6], look_at: [0, 0.6, 0] }\n"                                  \
    "lights:\n"                                                                                \
    "  - ambient: { intensity: 0.1 }\n"                                                        \
    "  - point: { position: [2, 4, 2], radius: 0.8, intensity: 12 }\n"                         \
    "  - point: { position: { keys: { 0: [0, -9, 0], 4: [0, -5, 0] } }, intensity: 1 }\n"      \
    "objects:\n"                                                                               \
    "  - plane: { normal: [0, 1, 0] }\n"                                                       \
    "  - sphere: { center: [-1, 0.7, 0], radius: 0.7, material: { reflectivity: 0.3 } }\n"     \
    "  - box: { center: [1, 0.5, 0], size: 1 }\n"

/* Of a scene that holds still, adaptive sampling leaves a difference from frame to frame that
 * is no larger than what two independent pictures with its error would have. */
static void still_scene(void **state) {
    (void)state;
    char text[2048];
    snprintf(text, sizeof text, STILL, "samples: 2048, seed: 77");
    zt_image *reference = take(text, 0);
    snprintf(text, sizeof text, STILL, "samples: { min: 8, max: 128, error: 0.01 }");
    zt_image *frames[3];
    for (int i = 0; i < 3; i++) frames[i] = take(text, i);
    for (int i = 0; i < 2; i++) {
        double spatial = hypot(apart(frames[i], reference), apart(frames[i + 1], reference));
        double temporal = apart(frames[i], frames[i + 1]);
        assert_true(temporal > 0); /* noise changes */
        assert_true(temporal < 1.05 * spatial);
    }
    for (int i = 0; i < 3; i++) zt_image_free(&frames[i]);
    zt_image_free(&reference);
}

/* Where nothing at all changes, nothing does. */
static void held_frames(void **state) {
    (void)state;
    char text[2048];
    snprintf(text, sizeof text, STILL, "samples: { min: 8, max: 128, error: 0.01 }");
    zt_image *held[2] = {take(text, 4), take(text, 9)};
    assert_memory_equal(held[0]->pixels, held[1]->pixels, 4 * PIXELS * sizeof *held[0]->pixels);
    for (int i = 0; i < 2; i++) zt_image_free(&held[i]);
}

/* A ball half a pixel wide, a hundred times as bright as white, that takes 24 frames to cross
 * some three pixels. */
#define HIGHLIGHT                                                                              \
    "zoetrope: 1\n"                                                                            \
    "film: { size: [64, 36], duration: 24, view: raw, %s }\n"                                  \
    "camera: { position: [0, 0, 10], rotation: [0, 0, 0], fov: 40 deg }\n"                     \
    "lights: [ambient: { intensity: 100 }]\n"                                                  \
    "objects:\n"                                                                               \
    "  - sphere: { radius: 0.05, center: { curve: linear, keys: { 0: [0.03, 0.07, 0], "        \
    "24: [0.55, 0.31, 0] } } }\n"

/* The darkest frame's light as a share of the brightest one's. */
static double steadiness(const char *sampling) {
    char text[2048];
    double least = INFINITY, most = 0;
    snprintf(text, sizeof text, HIGHLIGHT, sampling);
    for (int frame = 0; frame < 24; frame++) {
        zt_image *image = take(text, frame);
        double sum = 0;
        for (int i = 0; i < PIXELS; i++) sum += (double)image->pixels[4 * i];
        least = fmin(least, sum);
        most = fmax(most, sum);
        zt_image_free(&image);
    }
    return least / most;
}

/* One sample a pixel makes it blink; what else is offered does not. */
static void highlight(void **state) {
    (void)state;
    static const struct {
        const char *sampling;
        double least;
    } ways[] = {
        {"samples: 256", 0.8},
        {"samples: 256, filter: gaussian", 0.7},
        {"samples: 256, filter: blackman-harris", 0.7},
        {"samples: { min: 16, max: 256, error: 0.01 }", 0.8},
        {"quality: edges", 0.6},
        {"samples: 256, shutter: 180 deg", 0.8},
    };
    assert_true(steadiness("samples: 1") < 0.1);
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        double steady = steadiness(ways[i].sampling);
        if (!(steady >= ways[i].least)) fail_msg("%s: %.3f", ways[i].sampling, steady);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(still_scene),
                                       cmocka_unit_test(held_frames),
                                       cmocka_unit_test(highlight)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
