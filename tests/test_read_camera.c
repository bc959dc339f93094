/* Cameras as they are written: lenses of every kind, focus by number, by point and by name,
 * keyed or not; what of it says nothing is doubted, and so is a focus that cannot be. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <zoetrope/explain.h>

#include "descriptions.h"

#define FILM "zoetrope: 1\nfilm: { duration: 4 s, samples: 16 }\n"

static const double pi = 3.14159265358979323846;

static void assert_near(double a, double b) {
    if (!(fabs(a - b) <= 1e-12 * fmax(1, fabs(b)))) fail_msg("%.17g is not %.17g", a, b);
}

static zt_camera camera_at(const zt_animation *animation, double time_s) {
    zt_arena arena = {0};
    zt_scene scene;
    assert_int_equal(zt_animation_freeze(&scene, animation, time_s, &arena, (zt_listener){0}),
                     ZT_OK);
    zt_arena_free(&arena);
    return scene.camera;
}

/* The camera of a description, at a time; nothing is told but that the film will be black. */
static zt_camera camera_of(const char *text, double time_s) {
    static told t;
    zt_animation *animation;
    if (read_told(&t, &animation, text) != ZT_OK || t.warning_count != 1)
        fail_msg("%s in\n%s", t.lines, text);
    zt_camera camera = camera_at(animation, time_s);
    zt_animation_free(&animation);
    return camera;
}

static void kinds(void **state) {
    (void)state;
    zt_camera c = camera_of(FILM "camera: { position: [0, 0, 5] }\n", 0);
    assert_int_equal(c.lens, ZT_LENS_PERSPECTIVE);
    assert_near(zt_camera_half_height(&c), tan(20 * pi / 180));
    assert_near(zt_camera_opening(&c), 0);
    c = camera_of(FILM "camera: { lens: perspective, focal_length: 50, sensor_height: 18 }\n",
                  0);
    assert_near(zt_camera_half_height(&c), 0.18);
    c = camera_of(FILM "camera: { sensor_height: 18mm, focal_length: { curve: linear, keys: { "
                       "0 s: 50 mm, 2 s: 100 } } }\n",
                  1);
    assert_near(zt_camera_half_height(&c), 0.12);
    c = camera_of(FILM "camera: { lens: orthographic, height: 5 }\n", 0);
    assert_int_equal(c.lens, ZT_LENS_ORTHOGRAPHIC);
    assert_near(zt_camera_half_height(&c), 2.5);
    c = camera_of(FILM "camera: { lens: equirectangular, rotation: [0, 90, 0] }\n", 0);
    assert_int_equal(c.lens, ZT_LENS_EQUIRECTANGULAR);
    assert_near(zt_camera_opening(&c), 0);
}

/* A unit is a metre to an f-number: 50 mm at f/2 is 25 mm wide. With fov alone the focal length
 * is the one that belongs to it on the sensor. */
static void openings(void **state) {
    (void)state;
    zt_camera c = camera_of(FILM "camera: { aperture: 0.3, focus_distance: 4, blades: 5,\n"
                                 "  blade_rotation: 90 deg }\n",
                            0);
    assert_near(zt_camera_opening(&c), 0.3);
    assert_near(zt_camera_focus(&c), 4);
    assert_int_equal(c.blades, 5);
    assert_near(c.blade_rotation, pi / 2);
    c = camera_of(FILM "camera: { focal_length: 50, f_number: 2, focus_distance: 4 }\n", 0);
    assert_near(zt_camera_opening(&c), 0.0125);
    c = camera_of(
        FILM "camera: { fov: 90 deg, sensor_height: 40, f_number: 4, focus_distance: 1 }\n", 0);
    assert_near(zt_camera_focal_length(&c), 20);
    assert_near(zt_camera_opening(&c), 0.0025);
    c = camera_of(FILM "camera: { lens: orthographic, aperture: 0.5, focus_distance: 3 }\n", 0);
    assert_near(zt_camera_opening(&c), 0.5);
}

/* All numbers of a lens may move: a pull of the focus, a zoom by focal length, an opening that
 * closes, blades that turn. */
static void keyed(void **state) {
    (void)state;
    static const char zoom[] =
        FILM "camera:\n"
             "  focus_distance: { curve: linear, keys: { 0 s: 2, 4 s: 10 } }\n"
             "  focal_length: { curve: linear, keys: { 0 s: 20, 4 s: 60 } }\n"
             "  f_number: { curve: linear, keys: { 0 s: 1, 4 s: 5 } }\n"
             "  sensor_height: { curve: linear, keys: { 0 s: 10, 4 s: 20 } }\n"
             "  blades: 6\n"
             "  blade_rotation: { curve: linear, keys: { 0 s: 0, 4 s: 40 deg } }\n";
    static const char flat[] =
        FILM "camera:\n"
             "  lens: orthographic\n"
             "  height: { curve: linear, keys: { 0 s: 2, 4 s: 10 } }\n"
             "  aperture: \"= 0.1 * t\"\n"
             "  focus_on: { curve: linear, keys: { 0 s: [0, 0, -2], 4 s: [9, 9, -10] } }\n";
    zt_camera c = camera_of(zoom, 1);
    assert_near(zt_camera_focus(&c), 4);
    assert_near(zt_camera_half_height(&c), 12.5 / 60);
    assert_near(zt_camera_opening(&c), 0.0075);
    assert_near(c.blade_rotation, 10 * pi / 180);
    c = camera_of(flat, 2);
    assert_near(zt_camera_half_height(&c), 3);
    assert_near(zt_camera_opening(&c), 0.2);
    assert_near(zt_camera_focus(&c), 6);
}

/* The name of a thing is its place, in its groups, wherever both go; of what is beside the view
 * it is how far ahead that counts. */
static void focus_by_name(void **state) {
    (void)state;
    const char text[] =
        FILM "camera:\n"
             "  position: [0, 0, 10]\n"
             "  aperture: 0.1\n"
             "  focus_on: the ball\n"
             "objects:\n"
             "  - group:\n"
             "      position: { curve: linear, keys: { 0 s: [0, 0, 0], 4 s: [4, 0, 4] } }\n"
             "      objects: [ sphere: { name: the ball, center: [5, 1, 2], radius: 1 } ]\n";
    zt_animation *animation = animation_of(text);
    for (int i = 0; i <= 4; i++) {
        zt_camera c = camera_at(animation, i);
        assert_near(c.focus_on.x, 5 + i);
        assert_near(zt_camera_focus(&c), 8 - i);
    }
    zt_animation_free(&animation);
    zt_camera c =
        camera_of(FILM "camera: { position: [0, 0, 10], look_at: post, focus_on: post,\n"
                       "  f_number: 1 }\n"
                       "objects: [ cylinder: { name: post, from: [1, 0, 0], to: [1, 2, 0],\n"
                       "  radius: 0.1 } ]\n",
                  0);
    assert_near(zt_camera_focus(&c), sqrt(102)); /* the middle between the ends */
}

/* What says nothing of the lens that there is, or without another key, is doubted at its place;
 * what is told is nothing else. */
static void doubts(void **state) {
    (void)state;
    static const struct {
        const char *camera, *told;
    } cases[] = {
        {"fov: 30, focal_length: 35",
         "3:16: warning: \"fov\" says nothing beside \"focal_length\"\n"},
        {"fov: 30, focal_length: 0", ""},
        {"height: 3", "3:19: warning: \"height\" says nothing of a perspective lens\n"},
        {"sensor_height: 24", "3:26: warning: \"sensor_height\" says nothing without "
                              "\"focal_length\" or \"f_number\"\n"},
        {"lens: orthographic, fov: 40, f_number: 2",
         "3:36: warning: \"fov\" says nothing of an orthographic lens\n"
         "3:50: warning: \"f_number\" says nothing of an orthographic lens\n"},
        {"lens: equirectangular, aperture: 1, focus_on: [1, 2, 3], blades: 6",
         "3:44: warning: \"aperture\" says nothing of an equirectangular lens\n"
         "3:57: warning: \"focus_on\" says nothing of an equirectangular lens\n"
         "3:76: warning: \"blades\" says nothing of an equirectangular lens\n"},
        {"focus_distance: 3, blades: 5",
         "3:27: warning: \"focus_distance\" says nothing without \"aperture\" or \"f_number\"\n"
         "3:38: warning: \"blades\" says nothing without \"aperture\" or \"f_number\"\n"},
        {"aperture: 0.1, focus_distance: 1, blade_rotation: 3",
         "3:61: warning: \"blade_rotation\" says nothing without \"blades\"\n"},
        {"aperture: 0.1",
         "3:21: warning: \"focus_distance\" or \"focus_on\" is missing: what is "
         "sharp is 1 ahead\n"},
        {"aperture: 0", ""}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        static told t;
        zt_animation *animation;
        snprintf(text, sizeof text,
                 FILM "camera: { %s }\nlights: [ ambient: { intensity: 1 } ]\n"
                      "objects: [ plane: { normal: [0, 1, 0] } ]\n",
                 cases[i].camera);
        assert_int_equal(read_told(&t, &animation, text), ZT_OK);
        assert_string_equal(t.lines, cases[i].told);
        zt_animation_free(&animation);
    }
}

/* A lens that is not the plain one is said in words; numbers that move are not. */
static void in_words(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"fov: 30", ""},
        {"focal_length: 35", "focal length 35"},
        {"focal_length: 35, f_number: 1.4, focus_distance: 3, blades: 6",
         "focal length 35, f/1.4, 6 blades"},
        {"aperture: 0.1, focus_distance: 3", "opening 0.1"},
        {"aperture: \"= t\", focus_distance: 3", "an opening that moves"},
        {"lens: orthographic, height: 5", "orthographic, height 5"},
        {"lens: equirectangular", "equirectangular"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text, FILM "camera: { %s }\n", cases[i][0]);
        zt_animation *animation = animation_of(text);
        assert_string_equal(zt_animation_lens(animation).text, cases[i][1]);
        zt_animation_free(&animation);
    }
}

/* ---- advice ---------------------------------------------------------------------------------
 */

#define BALL "objects: [ sphere: { name: ball, center: [0, 0, -9], radius: 1 } ]\n"

static told advice_on(const char *text) {
    static told t;
    zt_animation *animation = animation_of(text);
    t = (told){.file = "film.yaml"};
    assert_int_equal(zt_animation_advise(animation, told_to(&t)), ZT_OK);
    zt_animation_free(&animation);
    return t;
}

/* A focus on what passes behind the camera is told, with when; one that stays ahead is not, nor
 * is a pinhole's, nor is one by distance. */
static void focus_behind(void **state) {
    (void)state;
    told t = advice_on(
        FILM "camera: { aperture: 0.1, position: [0, 0, 0],\n"
             "  focus_on: { curve: linear, keys: { 0 s: [0, 0, -2], 4 s: [0, 0, 2]}} }\n" BALL);
    assert_string_equal(t.lines,
                        "4:13: warning: the camera focuses on a point that is not ahead of "
                        "it from frame 48 to frame 95: nothing is sharp\n");
    t = advice_on(FILM "camera: { aperture: 0.1, focus_on: ball }\n" BALL);
    assert_string_equal(t.lines, "");
    t = advice_on(FILM "camera: { focus_on: [0, 0, 2] }\n" BALL);
    assert_string_equal(t.lines, "");
}

/* An opening and a single sample a pixel: told. */
static void grains(void **state) {
    (void)state;
    told t = advice_on("zoetrope: 1\nfilm: { duration: 4 s }\n"
                       "camera: { f_number: 2, focus_distance: 3 }\n" BALL);
    assert_string_equal(t.lines,
                        "3:9: warning: what is out of focus will be grains: a pixel takes 1 "
                        "sample; \"film\" may say \"samples: 64\"\n");
    t = advice_on("zoetrope: 1\nfilm: { duration: 4 s }\n"
                  "camera: { f_number: 0, focus_distance: 3 }\n" BALL);
    assert_string_equal(t.lines, "");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kinds),         cmocka_unit_test(openings), cmocka_unit_test(keyed),
        cmocka_unit_test(focus_by_name), cmocka_unit_test(doubts),   cmocka_unit_test(in_words),
        cmocka_unit_test(focus_behind),  cmocka_unit_test(grains),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
