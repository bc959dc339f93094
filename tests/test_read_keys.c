/* Shows that each way to write movement means what it says: kinds of curves, easings, ends,
 * springs, spaces, rotations and times, compared with their closed forms. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"

static const double pi = 3.14159265358979323846;

#define FILM "zoetrope: 1\nfilm: { duration: 4 s, rate: 24 }\ncamera: {}\n"

/* What a property of a thing is worth at a time, when `written` stands there. */
static void value_at(double *value, const char *owner, const char *property, const char *more,
                     const char *written, double time_s) {
    char text[4096];
    snprintf(text, sizeof text, FILM "%s: [ %s: { %s: %s%s } ]\n",
             strcmp(owner, "ambient") == 0 ? "lights" : "objects", owner, property, written,
             more);
    zt_animation *animation = animation_of(text);
    assert_int_equal(animation->track_count, 1);
    zt_curve_eval(value, &animation->tracks[0].curve, time_s);
    zt_animation_free(&animation);
}

static void radius_at(double *value, const char *written, double time_s) {
    value_at(value, "sphere", "radius", ", center: [0, 0, 0]", written, time_s);
}

static void rotation_at(double value[4], const char *written, double time_s) {
    value_at(value, "group", "rotation", ", objects: []", written, time_s);
}

static void assert_near(const double *value, const double *expected, int count,
                        const char *text) {
    for (int i = 0; i < count; i++)
        if (!(fabs(value[i] - expected[i]) <= 1e-13))
            fail_msg("%s: number %d is %.17g instead of %.17g", text, i, value[i], expected[i]);
}

/* A cubic through p and q with derivatives v and w by its parameter. */
static double hermite(double p, double v, double q, double w, double u) {
    return (2 * u * u * u - 3 * u * u + 1) * p + (u * u * u - 2 * u * u + u) * v +
           (3 * u * u - 2 * u * u * u) * q + (u * u * u - u * u) * w;
}

typedef struct example {
    const char *text;
    double time_s, value;
} example;

static void all_near(const example *examples, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double value;
        radius_at(&value, examples[i].text, examples[i].time_s);
        assert_near(&value, &examples[i].value, 1, examples[i].text);
    }
}

/* ---- kinds ----------------------------------------------------------------------------------
 */

/* Words of curves, for all keys and for one: each against the formula that it names. */
static void kinds(void **state) {
    (void)state;
    const example examples[] = {
        {"{ curve: hold, keys: { 0 s: 1, 1 s: 2 } }", 0.99, 1},
        {"{ curve: linear, keys: { 0 s: 1, 1 s: 2 } }", 0.25, 1.25},
        {"{ curve: smooth, keys: { 0 s: 1, 1 s: 2 } }", 0.25, 1.15625},
        {"{ keys: { 0 s: 1, 1 s: 2 } }", 0.25, 1.15625},
        {"{ curve: hold, keys: { 0 s: { value: 1, curve: linear }, 1 s: 3, 2 s: 1 } }", 0.5, 2},
        {"{ curve: hold, keys: { 0 s: { value: 1, curve: linear }, 1 s: 3, 2 s: 1 } }", 1.5, 3},
        /* Uniform Catmull-Rom, which tcb is without extras, in the middle of a way. */
        {"{ curve: tcb, keys: { 0 s: 1, 1 s: 2, 2 s: 5, 3 s: 3 } }", 1.5,
         (-1 + 9 * 2 + 9 * 5 - 3) / 16.},
        {"{ curve: tcb, keys: { 0 s: 1, 1 s: { value: 2, tension: 1 }, 2 s: { value: 5, "
         "tension: 1 }, 3 s: 3 } }",
         1.5, 3.5},
    };
    all_near(examples, sizeof examples / sizeof *examples);
}

/* Kochanek and Bartels' tangents, with all three numbers. */
static void tcb(void **state) {
    (void)state;
    const double t = 0.25, c = -0.5, b = 0.75, p[] = {1, 2, 5, 3};
    double leave = (1 - t) * (1 + c) * (1 + b) / 2 * (p[1] - p[0]) +
                   (1 - t) * (1 - c) * (1 - b) / 2 * (p[2] - p[1]);
    double arrive = (p[3] - p[1]) / 2; /* of a key without extras */
    const example examples[] = {
        {"{ curve: tcb, keys: { 0 s: 1, 1 s: { value: 2, tension: 0.25, continuity: -0.5, "
         "bias: 0.75 }, 2 s: 5, 3 s: 3 } }",
         1.3, hermite(2, leave, 5, arrive, 0.3)}};
    all_near(examples, 1);
}

/* Tangents are values a second, whatever the length of the way; none means zero. */
static void hermites(void **state) {
    (void)state;
    const example examples[] = {
        {"{ curve: hermite, keys: { 0 s: { value: 1, out: 4 }, 2 s: { value: 2, in: -1 } } }",
         0.5, hermite(1, 8, 2, -2, 0.25)},
        {"{ curve: hermite, keys: { 0 s: 1, 2 s: { value: 2, in: -1, out: 100 } } }", 0.5,
         hermite(1, 0, 2, -2, 0.25)},
        {"{ keys: { 0 s: { value: 1, curve: hermite, out: 4 }, 1 s: { value: 2, in: 1, curve: "
         "linear }, 2 s: 4 } }",
         0.5, hermite(1, 4, 2, 1, 0.5)},
    };
    all_near(examples, sizeof examples / sizeof *examples);
    double value[3];
    value_at(value, "sphere", "center", ", radius: 1",
             "{ curve: hermite, keys: { 0 s: { value: [0, 0, 0], out: [1, 2, 3] }, 2 s: [1, 0, "
             "0] } }",
             1);
    assert_near(value,
                (double[]){hermite(0, 2, 1, 0, 0.5), hermite(0, 4, 0, 0, 0.5),
                           hermite(0, 6, 0, 0, 0.5)},
                3, "vector");
}

/* Handles are offsets in time and value; at s = 1/2 a cubic Bezier curve is the mean of its
 * points, weighted 1 3 3 1, in time as in value. */
static void beziers(void **state) {
    (void)state;
    const char *const text =
        "{ curve: bezier, keys: { 1 s: { value: 2, out: { time: 0.4 s, value: 1 } }, "
        "3 s: { value: 6, in: { time: -1200 ms, value: 0.5 } } } }";
    const example examples[] = {
        {text, 1 + 2 * (3 * 0.2 + 3 * 0.4 + 1) / 8, (2 + 3 * 3 + 3 * 6.5 + 6) / 8},
        /* Handles of a third of the time, and no value: as smooth. */
        {"{ curve: bezier, keys: { 0 s: 1, 1 s: 2 } }", 0.25, 1.15625},
        {"{ curve: bezier, keys: { 0 s: { value: 1, out: { time: 24 } }, 3 s: 2 } }", 1.5, 1.5},
    };
    all_near(examples, sizeof examples / sizeof *examples);
}

/* Points of a square, as far from each other in space as in time: the centripetal curve is the
 * uniform one. */
static void catmull_rom(void **state) {
    (void)state;
    double value[3];
    value_at(value, "sphere", "center", ", radius: 1",
             "{ curve: catmull-rom, keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0], 2 s: [1, 1, 0], "
             "3 s: [0, 1, 0] } }",
             1.5);
    assert_near(value, (double[]){1.125, 0.5, 0}, 3, "square");
}

/* Easings spread a straight way over its time. */
static void easings(void **state) {
    (void)state;
    const example examples[] = {
        {"{ curve: ease-in-out, keys: { 0 s: 0, 1 s: 1 } }", 0.5, 0.5},
        {"{ curve: \"cubic-bezier(0, 0, 1, 1)\", keys: { 0 s: 0, 1 s: 1 } }", 0.3, 0.3},
        {"{ curve: steps(4), keys: { 0 s: 0, 1 s: 1 } }", 0.3, 0.25},
        {"{ curve: 'steps(4, start)', keys: { 0 s: 0, 1 s: 1 } }", 0.3, 0.5},
        {"{ curve: quad-in, keys: { 0 s: 1, 2 s: 3 } }", 0.6, 1 + 2 * 0.09},
        {"{ curve: sine-out, keys: { 0 s: 0, 1 s: 1 } }", 0.5, sqrt(0.5)},
        {"{ curve: bounce-out, keys: { 0 s: 0, 1 s: 1 } }", 0.2, 7.5625 * 0.04},
        {"{ curve: \"linear(0, 0.8 25%, 1)\", keys: { 0 s: 0, 1 s: 1 } }", 0.25, 0.8},
        {"{ keys: { 0 s: { value: 0, curve: cubic-in }, 1 s: { value: 1, curve: cubic-out }, 2 "
         "s: 2 } }",
         1.5, 2 - 0.125},
    };
    all_near(examples, sizeof examples / sizeof *examples);
}

/* ---- ends, springs, spaces ------------------------------------------------------------------
 */

static void ends(void **state) {
    (void)state;
    const example examples[] = {
        {"{ curve: linear, keys: { 0 s: 1, 1 s: 3 } }", 3.25, 3},
        {"{ curve: linear, after: hold, keys: { 0 s: 1, 1 s: 3 } }", 3.25, 3},
        {"{ curve: linear, after: linear, keys: { 0 s: 1, 1 s: 3 } }", 3.25, 7.5},
        {"{ curve: linear, after: loop, keys: { 0 s: 1, 1 s: 3 } }", 3.25, 1.5},
        {"{ curve: linear, after: ping-pong, keys: { 0 s: 1, 1 s: 3 } }", 3.25, 2.5},
        {"{ curve: linear, after: loop-with-offset, keys: { 0 s: 1, 1 s: 3 } }", 3.25, 7.5},
        {"{ curve: linear, before: loop, keys: { 0 s: 1, 1 s: 3 } }", -0.25, 2.5},
        {"{ curve: linear, before: linear, after: loop, keys: { 0 s: 1, 1 s: 3 } }", -1, -1},
    };
    all_near(examples, sizeof examples / sizeof *examples);
}

/* Springs of both ways to write them, at rest until the second key calls them away. */
static void springs(void **state) {
    (void)state;
    double t = 0.375, w = 2 * pi * 1.5, z = 0.25, d = w * sqrt(1 - z * z);
    const example examples[] = {
        {"{ spring: { frequency: 1.5, damping_ratio: 0.25 }, keys: { 0 s: 1, 1 s: 3 } }", 0.9,
         1},
        {"{ spring: { frequency: 1.5, damping_ratio: 0.25 }, keys: { 0 s: 1, 1 s: 3 } }", 1 + t,
         3 - 2 * exp(-z * w * t) * (cos(d * t) + z * w / d * sin(d * t))},
        {"{ spring: { stiffness: 16, damping: 8 }, keys: { 0 s: 1, 1 s: 3 } }", 1 + t,
         3 - 2 * (1 + 4 * t) * exp(-4 * t)},
        {"{ spring: { stiffness: 64, damping: 32, mass: 4 }, keys: { 0 s: 1, 1 s: 3 } }", 1 + t,
         3 - 2 * (1 + 4 * t) * exp(-4 * t)},
    };
    all_near(examples, sizeof examples / sizeof *examples);
    w = 2 * pi;
    d = w * sqrt(0.75);
    const example usual = {"{ spring: { frequency: 1 }, keys: { 0 s: 1, 1 s: 3 } }", 1 + t,
                           3 - 2 * exp(-w * t / 2) * (cos(d * t) + w / 2 / d * sin(d * t))};
    all_near(&usual, 1);
}

/* Halfway from black to white is the lightness 1/2, whose light is its cube; otherwise light
 * itself is halved. */
static void oklab(void **state) {
    (void)state;
    double value[3];
    value_at(value, "ambient", "color", "",
             "{ in: oklab, curve: linear, keys: { 0 s: black, 1 s: white } }", 0.5);
    for (int c = 0; c < 3; c++) assert_true(fabs(value[c] - 0.125) < 1e-7);
    value_at(value, "ambient", "color", "",
             "{ curve: linear, keys: { 0 s: black, 1 s: white } }", 0.5);
    assert_near(value, (double[]){0.5, 0.5, 0.5}, 3, "light");
}

/* ---- rotations ------------------------------------------------------------------------------
 */

/* The turn around an axis of unit length, as a quaternion. */
static void assert_turn(const double q[4], double x, double y, double z, double degrees,
                        const char *text) {
    double half = degrees * pi / 360, s = sin(half),
           expected[] = {cos(half), s * x, s * y, s * z};
    double sign =
        q[0] * expected[0] + q[1] * expected[1] + q[2] * expected[2] + q[3] * expected[3] < 0
            ? -1
            : 1;
    for (int i = 0; i < 4; i++)
        if (!(fabs(sign * q[i] - expected[i]) < 1e-13))
            fail_msg("%s: number %d is %.17g instead of %.17g", text, i, q[i], expected[i]);
}

/* Every way to write a rotation. */
static void rotation_forms(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double x, y, z, degrees;
    } cases[] = {
        {"[0, 90, 0]", 0, 1, 0, 90},
        {"{ axis: [0, 0, 2], angle: -30 }", 0, 0, 1, -30},
        {"{ axis: [0, 0, 2], angle: 0.5 rad }", 0, 0, 1, 28.64788975654116},
        {"{ quaternion: [2, 2, 0, 0] }", 1, 0, 0, 90},
        {"{ euler: [0, 0, 45] }", 0, 0, 1, 45},
        /* Quarters around z and x make a third around a diagonal: x times z is -y, z times x
         * is y. */
        {"{ euler: [90, 0, 90], order: zxy }", 0.5773502691896258, -0.5773502691896258,
         0.5773502691896258, 120},
        {"{ euler: [90, 0, 90], order: xyz }", 0.5773502691896258, 0.5773502691896258,
         0.5773502691896258, 120},
        {"{ direction: [0, 0, -3] }", 1, 0, 0, 0},
        {"{ direction: [-1, 0, 0] }", 0, 1, 0, 90},
        {"{ direction: [0, 5, 0], up: [0, 0, 1] }", 1, 0, 0, 90},
        {"{ direction: [0, 0, -1], up: [-1, 0, 0] }", 0, 0, 1, 90},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        snprintf(text, sizeof text, FILM "objects: [group: { rotation: %s, objects: [] }]\n",
                 cases[i].text);
        zt_animation *animation = animation_of(text);
        assert_int_equal(animation->track_count, 0);
        quat q = animation->rest.objects[0].placement.rotation;
        assert_turn((double[]){q.w, q.x, q.y, q.z}, cases[i].x, cases[i].y, cases[i].z,
                    cases[i].degrees, cases[i].text);
        zt_animation_free(&animation);
    }
}

/* Turns of more than half round around one axis go all the way; "in: turns" says so of others;
 * else the way is the short one. */
static void turns(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double time_s, degrees;
    } cases[] = {
        {"{ curve: linear, keys: { 0 s: { axis: [0, 1, 0], angle: 0 }, 1 s: { axis: [0, 2, 0], "
         "angle: 720 } } }",
         0.125, 90},
        {"{ curve: linear, keys: { 0 s: { axis: [0, 1, 0], angle: 10 }, 1 s: { axis: [0, -2, "
         "0], angle: 350 } } }",
         0.5, -170},
        {"{ curve: linear, keys: { 0 s: { axis: [0, 1, 0], angle: 10 }, 1 s: { axis: [0, 1, "
         "0], angle: 170 } } }",
         0.5, 90},
        {"{ in: turns, curve: linear, keys: { 0 s: [0, 0, 0], 1 s: [0, 720, 0] } }", 0.125, 90},
        {"{ in: turns, curve: linear, keys: { 0 s: { euler: [0, 0, 0] }, 1 s: { axis: [0, 1, "
         "0], angle: 360 } } }",
         0.25, 90},
        {"{ curve: linear, keys: { 0 s: [0, 10, 0], 1 s: [0, 350, 0] } }", 0.5, 0},
        {"{ curve: linear, keys: { 0 s: { value: { axis: [0, 1, 0], angle: 0 } }, 1 s: { "
         "value: "
         "[0, 100, 0] } } }",
         0.5, 50},
        {"{ curve: hermite, in: turns, keys: { 0 s: { value: [0, 0, 0], out: [0, 80, 0] }, 1 "
         "s: "
         "[0, 400, 0] } }",
         0.5, 210},
        {"{ curve: bezier, in: turns, keys: { 0 s: { value: [0, 0, 0], out: { value: [0, 80, "
         "0] "
         "} }, 1 s: { value: [0, 400, 0], in: { value: [0, 0, 0] } } } }",
         0.5, (3 * 80 + 3 * 400 + 400) / 8.},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double q[4];
        rotation_at(q, cases[i].text, cases[i].time_s);
        assert_turn(q, 0, 1, 0, cases[i].degrees, cases[i].text);
    }
}

/* glTF's CUBICSPLINE of rotations: quaternions, componentwise, made unit. */
static void hermite_rotations(void **state) {
    (void)state;
    double q[4];
    rotation_at(
        q,
        "{ curve: hermite, keys: { 0 s: { value: { quaternion: [1, 0, 0, 0] }, out: [0, "
        "1, 0, 0] }, 1 s: { value: { quaternion: [0, 1, 0, 0] }, in: [0, 0, 0.5, 0] } } "
        "}",
        0.5);
    double e[] = {hermite(1, 0, 0, 0, 0.5), hermite(0, 1, 1, 0, 0.5),
                  hermite(0, 0, 0, 0.5, 0.5)};
    double length = sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
    assert_near(q, (double[]){e[0] / length, e[1] / length, e[2] / length, 0}, 4, "quaternion");
}

/* ---- times ----------------------------------------------------------------------------------
 */

/* Timecode counts frames, whole ones a second at a broken rate; per cent are of all frames. */
static void times(void **state) {
    (void)state;
    zt_animation *animation =
        animation_of("zoetrope: 1\nfilm: { duration: 00:00:10:00, rate: 30000/1001 }\n"
                     "camera: { fov: { keys: { 0 %: 10, 25%: 20, 00:00:01:00: 30,\n"
                     "                         00:00:02:29: 40, 6 s: 50, 100 %: 60 } } }\n");
    assert_int_equal(zt_animation_film(animation)->frame_count, 300);
    const double expected[] = {0, 30 * 1001 / 30000., 75 * 1001 / 30000., 89 * 1001 / 30000.,
                               6, 300 * 1001 / 30000.};
    const double degrees[] = {10, 30, 20, 40, 50, 60};
    const zt_curve *curve = &animation->tracks[0].curve;
    assert_int_equal(curve->key_count, 6);
    for (int k = 0; k < 6; k++) {
        assert_true(curve->times[k] == expected[k]);
        assert_true(fabs(curve->values[k] * 180 / pi - degrees[k]) < 1e-12);
    }
    zt_animation_free(&animation);
    animation =
        animation_of("zoetrope: 1\nfilm: { duration: 90000, rate: 25 }\n"
                     "camera: { fov: { keys: { 01:00:00:00: 10, 00:59:59:24: 20 } } }\n");
    assert_true(animation->tracks[0].curve.times[1] == 3600);
    assert_true(animation->tracks[0].curve.times[0] == 3600 - 1 / 25.);
    zt_animation_free(&animation);
}

/* ---- places ---------------------------------------------------------------------------------
 */

/* A track knows where its property and its keys stand, with their lines, when the text is long
 * gone. */
static void places(void **state) {
    (void)state;
    zt_animation *animation = animation_of(FILM "objects:\n"
                                                "  - sphere:\n"
                                                "      center: [0, 0, 0]\n"
                                                "      radius:\n"
                                                "        keys:\n"
                                                "          1 s: 3\n"
                                                "          0 s: 2\n");
    const zt_track *track = &animation->tracks[0];
    assert_int_equal(track->place.line, 8);
    assert_int_equal(track->place.column, 9);
    assert_string_equal(track->place.file, "film.yaml");
    assert_int_equal(track->key_places[0].line, 10);
    assert_int_equal(track->key_places[1].line, 9);
    assert_int_equal(track->key_places[1].column, 11);
    assert_int_equal(track->key_places[1].length, 3);
    assert_memory_equal(track->key_places[1].source_line, "          1 s: 3\n", 17);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kinds),       cmocka_unit_test(tcb),
        cmocka_unit_test(hermites),    cmocka_unit_test(beziers),
        cmocka_unit_test(catmull_rom), cmocka_unit_test(easings),
        cmocka_unit_test(ends),        cmocka_unit_test(springs),
        cmocka_unit_test(oklab),       cmocka_unit_test(rotation_forms),
        cmocka_unit_test(turns),       cmocka_unit_test(hermite_rotations),
        cmocka_unit_test(times),       cmocka_unit_test(places),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
