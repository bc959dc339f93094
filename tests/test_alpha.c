/* Transparent backgrounds: A is how much of each pixel is covered, whatever way samples are
 * taken, and colours are multiplied by it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <zoetrope/film.h>

#include "pictures.h"

enum { WIDTH = 50, HEIGHT = 34 }; /* no whole number of tiles */

static double at(const zt_image *image, int x, int y, int channel) {
    return (double)
        image->pixels[4 * ((size_t)y * (size_t)image->width + (size_t)x) + (size_t)channel];
}

static void assert_same_pixels(const zt_image *a, const zt_image *b) {
    assert_memory_equal(a->pixels, b->pixels, 4 * pixel_count_of(a) * sizeof *a->pixels);
}

static zt_image *small(const char *text, int64_t frame, int threads, zt_precision precision) {
    return picture_of(text, frame,
                      &(zt_render_settings){.width = WIDTH,
                                            .height = HEIGHT,
                                            .threads = threads,
                                            .precision = precision,
                                            .aovs = ZT_AOV_SAMPLES | ZT_AOV_ERROR});
}

/* Opaque where nothing else is said. */
static void description(void **state) {
    (void)state;
    assert_false(film_of_words("").transparent);
    assert_false(film_of_words(", background: opaque").transparent);
    assert_true(film_of_words(", background: transparent").transparent);
}

/* ---- colours that are multiplied ------------------------------------------------------------
 */

/* All things have one color and are lit alike, so that colours are that color times A. A ball
 * passes by, another one stands behind a bar. */
static const char plain[] =
    "zoetrope: 1\n"
    "film: { duration: 24, view: raw%s }\n"
    "camera: { look_at: [0, 0, 0], %s }\n"
    "lights: [ambient: { intensity: 1 }]\n"
    "materials: { clay: { color: [1, 0.5, 0.25] } }\n"
    "objects:\n"
    "  - sphere: { center: { curve: linear, keys: { 0: [-3, 1, 0], 23: [20, 1, 0] } },\n"
    "              radius: 0.7, material: clay }\n"
    "  - sphere: { center: [0.3, -0.2, -1], radius: 1.1, material: clay }\n"
    "  - box: { center: [0, -1, 0.5], size: [9, 0.07, 0.3], material: clay }\n";

static const char *text_of(const char *background, const char *film, const char *camera) {
    static char text[2048], words[256];
    snprintf(words, sizeof words, "%s%s", background, film);
    snprintf(text, sizeof text, plain, words, camera);
    return text;
}

static const char *const films[] = {
    "", ", samples: 9", ", samples: 300", ", samples: 16, filter: gaussian",
    ", samples: 16, shutter: 180 deg", ", samples: { min: 2, max: 32, error: 0.02 }",
    ", samples: { min: 4, max: 16, error: 0.02 }, shutter: 180 deg, filter: tent",
    ", quality: edges", ", quality: edges, filter: blackman-harris",
    ", quality: edges, samples: 8, shutter: 180 deg",
    /* Negative somewhere, from here on. */
    ", samples: 16, filter: mitchell",
    ", samples: { min: 4, max: 64, error: 0.02 }, filter: mitchell",
    ", quality: edges, filter: mitchell"};
enum { FILM_COUNT = sizeof films / sizeof *films, FIRST_SIGNED = 10 };
static const char *const cameras[] = {"position: [0, 0, 6]",
                                      "position: [0, 0, 6], aperture: 0.3, focus_distance: 3",
                                      "position: [0, 0, 6], lens: orthographic, height: 5",
                                      "position: [0, 0, 1.5], lens: equirectangular"};
enum { CAMERA_COUNT = sizeof cameras / sizeof *cameras };

/* Every pixel is its A times the one color; all of 0, 1 and what is between occurs. */
static void assert_multiplied(const zt_image *image, int film) {
    static const double color[3] = {1, 0.5, 0.25};
    int none = 0, all = 0, some = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            double alpha = at(image, x, y, 3);
            for (int c = 0; c < 3; c++)
                if (!(fabs(at(image, x, y, c) - alpha * color[c]) <= 1e-6))
                    fail_msg("%s at %d, %d: %.9g of %.9g", films[film], x, y,
                             at(image, x, y, c), alpha);
            if (film < FIRST_SIGNED) assert_true(alpha >= 0 && alpha <= 1);
            none += alpha == 0;
            all += alpha == 1;
            some += alpha != 0 && alpha != 1;
        }
    }
    assert_true(none > 400 && all > 10);
    assert_true(film == 0 ? some == 0 : some > 50);
}

/* With all ways to take samples, lenses and precisions, on any number of threads. */
static void multiplied(void **state) {
    (void)state;
    for (int f = 0; f < FILM_COUNT; f++) {
        for (int c = 0; c < CAMERA_COUNT; c++) {
            const char *text = text_of(", background: transparent", films[f], cameras[c]);
            zt_precision precision = c % 2 ? ZT_PRECISION_DOUBLE : ZT_PRECISION_SINGLE;
            zt_image *one = small(text, 3, 1, precision), *three = small(text, 3, 3, precision);
            assert_true(one->transparent);
            assert_multiplied(one, f);
            assert_same_pixels(one, three);
            zt_image_free(&one);
            zt_image_free(&three);
        }
    }
}

/* The same bits from all widths of instructions. */
static void widths(void **state) {
    (void)state;
    static const char *const names[] = {"base", "avx2", "avx512"};
    for (int f = 1; f < FILM_COUNT; f += 3) {
        const char *text = text_of(", background: transparent", films[f], *cameras);
        setenv("ZOETROPE_ISA", "scalar", 1);
        zt_image *scalar = small(text, 3, 2, ZT_PRECISION_AUTO);
        for (int i = 0; i < 3; i++) {
            setenv("ZOETROPE_ISA", names[i], 1);
            zt_image *wide = small(text, 3, 2, ZT_PRECISION_AUTO);
            assert_same_pixels(scalar, wide);
            zt_image_free(&wide);
        }
        zt_image_free(&scalar);
    }
    unsetenv("ZOETROPE_ISA");
}

/* Of an opaque film A is 1 everywhere. Where as many samples are taken, colours have the same
 * bits, for nothing is black. */
static void opaque(void **state) {
    (void)state;
    for (int f = 0; f < FILM_COUNT; f++) {
        zt_image *solid = small(text_of("", films[f], *cameras), 3, 2, ZT_PRECISION_AUTO);
        zt_image *clear = small(text_of(", background: transparent", films[f], *cameras), 3, 2,
                                ZT_PRECISION_AUTO);
        bool even = f < 5;
        assert_false(solid->transparent);
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                assert_true(at(solid, x, y, 3) == 1);
                for (int c = 0; c < 3 && even; c++)
                    assert_true(at(solid, x, y, c) == at(clear, x, y, c));
            }
        }
        zt_image_free(&solid);
        zt_image_free(&clear);
    }
}

/* ---- how much is covered --------------------------------------------------------------------
 */

/* The length of an interval that lies between two numbers. */
static double within(double from, double to, double first, double last) {
    return fmax(fmin(to, last) - fmax(from, first), 0);
}

/* A box, seen straight on, whose edges are at these pixels: each pixel's part of it, and of the
 * time that it is there while it moves on by `shift` pixels to the right. */
static double box_part(int x, int y, double shift) {
    enum { TIMES = 1000 };
    double width = 0;
    for (int i = 0; i < TIMES; i++) {
        double moved = shift * (i + 0.5) / TIMES;
        width += within(x, x + 1, 10.3 + moved, 30.9 + moved) / TIMES;
    }
    return width * within(y, y + 1, 7.25, 19.6);
}

static const char *box_text(const char *film, const char *color, double shift) {
    static char text[1024];
    snprintf(text, sizeof text,
             "zoetrope: 1\n"
             "film: { duration: 24, %s }\n"
             "camera: { lens: orthographic, height: %d, position: [%d, %d, 9],\n"
             "          rotation: [0, 0, 0] }\n"
             "lights: [ambient: { intensity: 1 }]\n"
             "objects:\n"
             "  - box: { size: [20.6, 12.35, 1], material: { color: %s }, center: {\n"
             "      curve: linear, keys: { 0: [20.6, 20.575, 0], 10: [%g, 20.575, 0] } } }",
             film, HEIGHT, WIDTH / 2, HEIGHT / 2, color, 20.6 + 20 * shift);
    return text;
}

/* Only A tells of a black box. */
static void against_closed_form(void **state) {
    (void)state;
    const char *const film[] = {"background: transparent, samples: 4096",
                                "background: transparent, samples: 4096, shutter: 180 deg"};
    for (int moves = 0; moves < 2; moves++) {
        zt_image *image = small(box_text(film[moves], "black", 4), 0, 2, ZT_PRECISION_AUTO);
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                double part = box_part(x, y, 4 * moves), alpha = at(image, x, y, 3);
                /* Three standard errors of independent samples, where time counts. */
                if (!(fabs(alpha - part) <= (moves ? 0.024 : 0.004)))
                    fail_msg("%d, %d: %.9g, not %.9g", x, y, alpha, part);
                assert_true(at(image, x, y, 0) == 0);
            }
        }
        zt_image_free(&image);
    }
}

/* Samples that go on where it is worth it take the same of a black box as they do of a white
 * one in an opaque film, and come to the same; where their places do not depend on colors. */
static void worth_it(void **state) {
    (void)state;
    static const char *const ways[] = {
        "seed: fixed, samples: { min: 4, max: 256, error: 0.01 }",
        "seed: fixed, samples: { min: 4, max: 256, error: 0.01 }, shutter: 180 deg",
        "seed: fixed, samples: { min: 8, max: 128, error: 0.02 }, filter: mitchell",
        "seed: fixed, quality: edges, samples: { max: 256, error: 0.01 }",
        "seed: fixed, quality: edges, samples: { max: 256, error: 0.01 }, filter: gaussian",
        "seed: fixed, quality: edges, shutter: 180 deg"};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        char film[256];
        int fine = 0;
        snprintf(film, sizeof film, "background: transparent, %s", ways[i]);
        zt_image *black = small(box_text(film, "black", 4), 0, 2, ZT_PRECISION_AUTO),
                 *white = small(box_text(ways[i], "white", 4), 0, 2, ZT_PRECISION_AUTO);
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++)
                if (at(black, x, y, 3) != at(white, x, y, 0))
                    fail_msg("%s at %d, %d: %.9g, not %.9g", ways[i], x, y, at(black, x, y, 3),
                             at(white, x, y, 0));
        for (int c = 0; c < 2; c++)
            assert_memory_equal(black->channels[c].values, white->channels[c].values,
                                pixel_count_of(black) * sizeof(float));
        for (size_t p = 0; p < pixel_count_of(black); p++)
            fine += black->channels[0].values[p] > 30;
        assert_true(fine > 30 && fine < WIDTH * HEIGHT / 2);
        zt_image_free(&black);
        zt_image_free(&white);
    }
}

/* A mirror that reflects nothing is there, and so is the back of a thing; what it shows is not
 * there where the mirror is not. */
static void mirrors(void **state) {
    (void)state;
    static const char text[] =
        "zoetrope: 1\n"
        "film: { duration: 1, background: transparent }\n"
        "camera: { lens: orthographic, height: 6, position: [0, 0, 9], rotation: [0, 0, 0] }\n"
        "lights: [ambient: {}]\n"
        "objects:\n"
        "  - sphere: { center: [-2, 0, 0], radius: 1,\n"
        "              material: { color: black, reflectivity: 1 } }\n"
        "  - disk: { center: [2, 0, 0], normal: [0, 0, -1], radius: 1,\n"
        "            material: { color: black, reflectivity: 1 } }\n"
        "  - sphere: { center: [2, 0, 20], radius: 0.5, material: { color: white } }\n";
    zt_image *image = small(text, 0, 2, ZT_PRECISION_AUTO);
    int covered = 0, lit = 0;
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            double step = 6.0 / HEIGHT, up = (HEIGHT / 2.0 - y - 0.5) * step,
                   right = (x + 0.5 - WIDTH / 2.0) * step;
            double away = fmin(hypot(right + 2, up), hypot(right - 2, up));
            if (fabs(away - 1) < 1e-3) continue;
            assert_true(at(image, x, y, 3) == (away < 1));
            covered += away < 1;
            lit += at(image, x, y, 0) > 0;
        }
    }
    assert_true(covered > 150 && lit > 20 && lit < covered / 4);
    zt_image_free(&image);
}

/* ---- films ----------------------------------------------------------------------------------
 */

static void make(const char *text, const char *target, zt_budget budget) {
    zt_animation *animation = animation_of(text);
    zt_renderer *renderer;
    zt_film_result result;
    heard h;
    int64_t numbers[] = {0, 1, 2};
    const zt_frames frames = {.numbers = numbers, .count = 3};
    const zt_render_settings settings = {.width = WIDTH, .height = HEIGHT, .threads = 2};
    const zt_film_order order = {
        .target = target, .frames = &frames, .budget = budget, .overwrites = true};
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, listener_of(&h)), ZT_OK);
    if (zt_film_render(&result, renderer, &order, NULL) != ZT_OK) fail_msg("%s", h.text);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

/* Numbered images: colours without A in files of integers, and with it in those of floats. */
static void files(void **state) {
    (void)state;
    const char *text = text_of(", background: transparent", ", samples: 64", *cameras);
    const char *const targets[] = {"a.#.png", "a.#.tif", "a.#.exr"};
    const char *const images[] = {"a.1.png", "a.1.tif", "a.1.exr"};
    static const double color[3] = {1, 0.5, 0.25};
    for (int f = 0; f < 3; f++) {
        zt_image *image;
        int none = 0, all = 0, some = 0;
        make(text, targets[f], (zt_budget){0});
        assert_int_equal(zt_image_read(&image, images[f], (zt_listener){0}), ZT_OK);
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                double alpha = at(image, x, y, 3);
                /* Integers hold a share that was rounded before; 2^-11 is that of half floats.
                 */
                for (int c = 0; c < 3 && alpha > 0; c++)
                    assert_true(fabs(at(image, x, y, c) - color[c] * (f < 2 ? 1 : alpha)) <
                                (f == 2 ? 0x1p-11 : 0.003));
                none += alpha == 0;
                all += alpha == 1;
                some += alpha > 0 && alpha < 1;
            }
        }
        assert_true(none > 400 && all > 10 && some > 50);
        zt_image_free(&image);
    }
}

/* The A of a picture that is full is in its file, so that all of a film's are alike, and in a
 * movie: byte 25 of a PNG and of an APNG is 6 for RGBA, and 2 for RGB. An image that is read
 * again is still a transparent film's. */
static void full(void **state) {
    (void)state;
    static const char text[] = "zoetrope: 1\n"
                               "film: { duration: 1, background: %s }\n"
                               "camera: { position: [0, 0, 6], look_at: [0, 0, 0] }\n"
                               "objects: [plane: { normal: [0, 0, 1], distance: 0 }]\n";
    for (int transparent = 0; transparent < 2; transparent++) {
        char own[512];
        size_t size;
        snprintf(own, sizeof own, text, transparent ? "transparent" : "opaque");
        make(own, "full.#.png", (zt_budget){0});
        make(own, "full.apng", (zt_budget){0});
        for (int i = 0; i < 2; i++) {
            char *bytes = file_bytes(i ? "full.apng" : "full.0.png", &size);
            assert_true(size > 25);
            assert_int_equal(bytes[25], transparent ? 6 : 2);
            free(bytes);
        }
        zt_image *image;
        assert_int_equal(zt_image_read(&image, "full.0.png", (zt_listener){0}), ZT_OK);
        assert_int_equal(image->transparent, transparent);
        zt_image_free(&image);
    }
}

/* With a budget of time as well. */
static void budget(void **state) {
    (void)state;
    const char *const samples[] = {", samples: 4",
                                   ", samples: { min: 2, max: 32, error: 0.02 }"};
    for (int i = 0; i < 2; i++) {
        zt_image *image;
        make(text_of(", background: transparent", samples[i], *cameras), "b.#.exr",
             (zt_budget){.frame_s = 0.02});
        assert_int_equal(zt_image_read(&image, "b.2.exr", (zt_listener){0}), ZT_OK);
        int none = 0, all = 0;
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                double alpha = at(image, x, y, 3);
                assert_true(fabs(at(image, x, y, 1) - 0.5 * alpha) < 0x1p-11);
                none += alpha == 0;
                all += alpha == 1;
            }
        }
        assert_true(none > 400 && all > 10);
        zt_image_free(&image);
    }
}

static zt_hash key_of(const char *background) {
    zt_animation *animation = animation_of(text_of(background, "", *cameras));
    zt_renderer *renderer;
    zt_hash key;
    assert_int_equal(zt_renderer_open(&renderer, animation, &(zt_render_settings){.threads = 1},
                                      (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(zt_renderer_key(&key, renderer, 3), ZT_OK);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
    return key;
}

/* A background is part of what decides the pixels. */
static void keys(void **state) {
    (void)state;
    zt_hash usual = key_of(""), opaque_key = key_of(", background: opaque"),
            transparent = key_of(", background: transparent");
    assert_memory_equal(&usual, &opaque_key, sizeof usual);
    assert_memory_not_equal(&usual, &transparent, sizeof usual);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(description),
                                       cmocka_unit_test(multiplied),
                                       cmocka_unit_test(widths),
                                       cmocka_unit_test(opaque),
                                       cmocka_unit_test(against_closed_form),
                                       cmocka_unit_test(worth_it),
                                       cmocka_unit_test(mirrors),
                                       cmocka_unit_test(files),
                                       cmocka_unit_test(full),
                                       cmocka_unit_test(budget),
                                       cmocka_unit_test(keys)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
