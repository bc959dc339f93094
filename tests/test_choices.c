/* What is chosen for the frames of a film, and what is said of it: in which precision they are
 * rendered, and at how many moments they are looked at. */
#include <glob.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include <zoetrope/renderer.h>

#include "told.h"

static zt_animation *read_film(const char *path) {
    zt_animation *animation;
    assert_int_equal(zt_animation_read(&animation, path, NULL, 0, (zt_listener){0}), ZT_OK);
    return animation;
}

/* A film of these lines after its head: a frame a second. */
static zt_animation *film_of(const char *lines, int reflections) {
    char path[] = "/tmp/zoetrope-precision-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_true(dprintf(file,
                        "zoetrope: 1\n"
                        "film: { size: [96, 54], rate: 1, duration: 8, reflections: %d }\n"
                        "materials:\n"
                        "  clay: { color: [1, 1, 1] }\n"
                        "  mirror: { color: [1, 1, 1], reflectivity: 0.9 }\n"
                        "%s",
                        reflections, lines) > 0);
    close(file);
    zt_animation *animation = read_film(path);
    unlink(path);
    return animation;
}

/* The same with a camera, and objects; `film` are words of the film. */
static zt_animation *film_with(const char *film, const char *objects) {
    char path[] = "/tmp/zoetrope-choices-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_true(dprintf(file,
                        "zoetrope: 1\n"
                        "film: { size: [96, 54], rate: 1, duration: 8, %s }\n"
                        "camera: { position: [0, 0, 10] }\n"
                        "lights: [ambient: {}]\n"
                        "objects:\n%s",
                        film, objects) > 0);
    close(file);
    zt_animation *animation = read_film(path);
    unlink(path);
    return animation;
}

static zt_renderer *renderer_of(const zt_animation *animation, zt_precision precision,
                                told *heard) {
    zt_renderer *renderer;
    zt_render_settings settings = {.precision = precision, .threads = 1};
    zt_listener listener = heard ? told_to(heard) : (zt_listener){0};
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, listener), ZT_OK);
    return renderer;
}

static zt_frame_choices choice_of(zt_renderer *renderer, int64_t frame) {
    zt_frame_choices choice;
    assert_int_equal(zt_renderer_choices(&choice, renderer, frame), ZT_OK);
    return choice;
}

/* A descent from orbit, until the eye stands on the ground. */
static const char descent[] =
    "camera: { position: { curve: linear, keys: { 0: [0, 2e6, 0], 7: [0, 2, 0] } },\n"
    "          look_at: [0, 0, -1000] }\n"
    "objects:\n"
    "  - sphere: { name: ground, center: [0, -1e6, 0], radius: 1e6, material: clay }\n";

/* Each frame has its own; the sentence names what asks for it, with its numbers. */
static void by_frame(void **state) {
    (void)state;
    zt_animation *animation = film_of(descent, 4);
    zt_renderer *renderer = renderer_of(animation, ZT_PRECISION_AUTO, NULL);
    zt_frame_choices far = choice_of(renderer, 0), less = choice_of(renderer, 1),
                     near = choice_of(renderer, 7);
    assert_int_equal(far.precision, ZT_PRECISION_SINGLE);
    assert_string_equal(far.precision_text,
                        "single precision: its roundings stay below what can be seen");
    assert_int_equal(near.precision, ZT_PRECISION_DOUBLE);
    assert_string_equal(near.precision_text,
                        "double precision: the camera is 2 from ground, whose numbers reach "
                        "2e+06; single precision would be off by 1.9, and 0.0034 can be seen");
    assert_true(far.cause == less.cause);
    assert_true(far.cause != near.cause);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

/* Every other reason in its own words. */
static void reasons(void **state) {
    (void)state;
    const struct {
        const char *lines, *text;
        int reflections;
    } cases[] = {
        {"camera: { position: [0, 0, 1e6], fov: 0.01 deg }\n"
         "objects:\n"
         "  - sphere: { name: moon, center: [0, 0, 0], radius: 10, material: clay }\n",
         "double precision: moon is 1e+06 from the camera, in a view so narrow that 0.4 can be "
         "seen; single precision would be off by 0.95",
         4},
        {"camera: { position: [0, 0, 10] }\n"
         "lights:\n"
         "  - ambient: { intensity: 1 }\n"
         "  - point: { name: bulb, position: [0, 0, 0.0001], intensity: 1 }\n"
         "objects:\n"
         "  - plane: { name: wall, normal: [0, 0, 1], material: clay }\n",
         "double precision: bulb is 0.0001 from wall, whose numbers reach 10; single precision "
         "would be off by 9.5e-06",
         4},
        {"camera: { position: [0, 0, 10] }\n"
         "objects:\n"
         "  - plane: { name: wall, normal: [0, 0, 1], material: clay }\n"
         "  - plane: { name: paper, normal: [0, 0, 1], distance: -1e-6, material: clay }\n",
         "are 1e-06 apart and their numbers reach 10; single precision would be off by "
         "9.5e-06",
         4},
        {"camera: { position: [0, 0, 10] }\n"
         "objects:\n"
         "  - sphere: { name: dust, center: [0, 0, 0], radius: 1e-18, material: clay }\n",
         "double precision: of dust a number is 1e-18, whose square single precision cannot "
         "hold",
         4},
        {"camera: { position: [0, 0, 10] }\n"
         "objects:\n"
         "  - group:\n"
         "      scale: [1, 1, 1e-9]\n"
         "      objects:\n"
         "        - sphere: { name: coin, center: [0, 0, 0], radius: 1, material: clay }\n",
         "double precision: coin is stretched 1e+09 times more one way than another", 4},
        {"camera: { position: [0, 0, 50] }\n"
         "objects:\n"
         "  - group:\n"
         "      scale: [1, 3, 1]\n"
         "      objects:\n"
         "        - box: { name: grain, center: [0, 0, 0], size: 1e-4, material: clay }\n",
         "double precision: grain is 0.0001 thin and its numbers reach 50; single precision "
         "would be off by 4.8e-05",
         4},
        {"camera: { position: [1e15, 0, 10] }\n"
         "objects:\n"
         "  - sphere: { name: moon, center: [1e15, 0, 0], radius: 1, material: clay }\n",
         "double precision, though the camera is 9 from moon, whose numbers reach 1e+15; "
         "double "
         "precision would be off by 0.22, and",
         4},
        {"camera: { position: [0, 0, 10] }\n"
         "objects:\n"
         "  - plane: { name: wall, normal: [0, 0, 1], material: mirror }\n",
         "double precision: rays may meet 100 mirrors one after the other", 100},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_animation *animation = film_of(cases[i].lines, cases[i].reflections);
        zt_renderer *renderer = renderer_of(animation, ZT_PRECISION_AUTO, NULL);
        zt_frame_choices choice = choice_of(renderer, 0);
        if (!strstr(choice.precision_text, cases[i].text))
            fail_msg("\"%s\" is not in: %s", cases[i].text, choice.precision_text);
        zt_renderer_close(&renderer);
        zt_animation_free(&animation);
    }
}

/* A warning, once, of the first frame for which single precision is not enough; none where
 * nobody insists on it. */
static void warned_once(void **state) {
    (void)state;
    zt_animation *animation = film_of(descent, 4);
    for (zt_precision p = ZT_PRECISION_AUTO; p <= ZT_PRECISION_DOUBLE; p++) {
        static told heard;
        heard = (told){0};
        zt_renderer *renderer = renderer_of(animation, p, &heard);
        zt_image *image;
        assert_int_equal(zt_image_create(&image, 96, 54), ZT_OK);
        for (int64_t frame = 0; frame < 9; frame++)
            assert_int_equal(zt_renderer_frame(renderer, frame, image, NULL), ZT_OK);
        bool single = p == ZT_PRECISION_SINGLE;
        assert_int_equal(heard.warning_count, single);
        assert_int_equal(heard.error_count, 0);
        if (single)
            assert_non_null(strstr(heard.lines, "warning: frame 7 asks for double precision: "
                                                "the camera is 2 from ground"));
        const char *texts[] = {[ZT_PRECISION_AUTO] = "double precision: the camera",
                               [ZT_PRECISION_SINGLE] =
                                   "single precision, as asked for, though the camera",
                               [ZT_PRECISION_DOUBLE] = "double precision, as asked for"};
        assert_non_null(strstr(choice_of(renderer, 7).precision_text, texts[p]));
        zt_image_free(&image);
        zt_renderer_close(&renderer);
    }
    zt_animation_free(&animation);
}

/* Nor is it left unsaid where double precision is not enough: once, for the film. */
static void warned_beyond(void **state) {
    (void)state;
    zt_animation *animation =
        film_with("shutter: 0", "  - group:\n"
                                "      position: [-1e15, 0, 0]\n"
                                "      objects:\n"
                                "        - sphere: { name: ball, center: [1e15, 0, 0], "
                                "radius: 1, material: {} }\n");
    static told heard;
    heard = (told){0};
    zt_renderer *renderer = renderer_of(animation, ZT_PRECISION_AUTO, &heard);
    zt_image *image;
    assert_int_equal(zt_image_create(&image, 96, 54), ZT_OK);
    for (int64_t frame = 0; frame < 2; frame++)
        assert_int_equal(zt_renderer_frame(renderer, frame, image, NULL), ZT_OK);
    assert_int_equal(heard.warning_count, 1);
    assert_non_null(strstr(heard.lines,
                           "warning: frame 0 asks for more than double precision: "
                           "the camera is 9 from ball, whose numbers reach 1e+15"));
    zt_image_free(&image);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

/* The films that the project shows need nothing but single precision. */
static void ordinary_films(void **state) {
    (void)state;
    glob_t films;
    assert_int_equal(glob(ZT_TEST_SOURCE_DIR "/animations/*.yaml", 0, NULL, &films), 0);
    assert_true(films.gl_pathc > 5);
    for (size_t i = 0; i < films.gl_pathc; i++) {
        zt_animation *animation = read_film(films.gl_pathv[i]);
        zt_renderer *renderer = renderer_of(animation, ZT_PRECISION_AUTO, NULL);
        int64_t count = zt_animation_film(animation)->frame_count;
        for (int64_t frame = 0; frame < count; frame += 5) {
            zt_frame_choices choice = choice_of(renderer, frame);
            if (choice.precision != ZT_PRECISION_SINGLE)
                fail_msg("%s, frame %d: %s", films.gl_pathv[i], (int)frame,
                         choice.precision_text);
        }
        zt_renderer_close(&renderer);
        zt_animation_free(&animation);
    }
    globfree(&films);
}

/* How the shutter's opening is divided, and what for. */
static void moments(void **state) {
    (void)state;
    const struct {
        const char *film, *lines, *text;
        int moment_count; /* 0: many */
    } cases[] = {
        {"shutter: 0", "  - sphere: { center: [0, 0, 0], radius: 1, material: {} }\n", "", 1},
        {"shutter: 180", "  - sphere: { center: [0, 0, 0], radius: 1, material: {} }\n",
         "180 degrees open: nothing moves", 1},
        {"shutter: { angle: 90, phase: -45 }",
         "  - sphere: { center: { curve: linear, keys: { 0: [0, 0, 0], 7: [1, 0, 0] } }, "
         "radius: "
         "1, material: {} }\n",
         "90 degrees open: 2 moments; ", 2},
        {"shutter: 360",
         "  - group:\n      name: wheel\n"
         "      rotation: { curve: linear, in: turns, keys: { 0: [0, 0, 0], 8: [0, 0, 360] } "
         "}\n"
         "      objects:\n"
         "        - box: { center: [1, 0, 0], size: 1, material: {} }\n",
         "360 degrees open: 3 moments, because of wheel; wheel is at most 0.2", 3},
        {"shutter: 360",
         "  - sphere: { center: [0, 0, 0], radius: 1, material: { color: { curve: hold, keys: "
         "{ 0: "
         "red, 0.3 s: blue } } } }\n",
         "360 degrees open: 4 moments; all goes straight on; material 1.color changes at once",
         4},
        {"shutter: 360",
         "  - sphere: { center: [0, 0, 0], radius: 1, material: { reflectivity: \"= 0.5 + 0.5 "
         "* "
         "sin(6 * t)\" } }\n",
         "because of material 1; material 1 is at most 0.1", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_animation *animation = film_with(cases[i].film, cases[i].lines);
        zt_renderer *renderer = renderer_of(animation, ZT_PRECISION_AUTO, NULL);
        zt_frame_choices choice = choice_of(renderer, 0);
        if (cases[i].moment_count > 0)
            assert_int_equal(choice.moment_count, cases[i].moment_count);
        else
            assert_in_range(choice.moment_count, 20, 100);
        if (!strstr(choice.motion_text, cases[i].text) ||
            (!*cases[i].text && *choice.motion_text))
            fail_msg("\"%s\" is not in: %s", cases[i].text, choice.motion_text);
        zt_renderer_close(&renderer);
        zt_animation_free(&animation);
    }
}

/* What is too fast to be followed is told, once, and explained. */
static void too_fast(void **state) {
    (void)state;
    zt_animation *animation = film_with(
        "shutter: 180", "  - sphere: { name: fly, center: \"= {sin(1e5 * t), 0, 0}\", "
                        "radius: 0.1, material: {} }\n");
    static told heard;
    heard = (told){0};
    zt_renderer *renderer = renderer_of(animation, ZT_PRECISION_AUTO, &heard);
    zt_frame_choices choice = choice_of(renderer, 0);
    assert_true(choice.moment_count <= 4097);
    assert_non_null(strstr(choice.motion_text, "because of fly"));
    assert_non_null(strstr(choice.motion_text, "more than can be met"));
    zt_image *image;
    assert_int_equal(zt_image_create(&image, 96, 54), ZT_OK);
    for (int64_t frame = 0; frame < 2; frame++)
        assert_int_equal(zt_renderer_frame(renderer, frame, image, NULL), ZT_OK);
    assert_int_equal(heard.warning_count, 1);
    assert_non_null(strstr(heard.lines, "frame 0 asks for more than its "));
    assert_non_null(strstr(heard.lines, " moments: fly is at most "));
    zt_image_free(&image);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_frame),       cmocka_unit_test(reasons),
        cmocka_unit_test(warned_once),    cmocka_unit_test(warned_beyond),
        cmocka_unit_test(ordinary_films), cmocka_unit_test(moments),
        cmocka_unit_test(too_fast),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
