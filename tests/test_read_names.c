/* Shows that what has a name means the same wherever it is used: variables, shared timings,
 * named keys and what a use changes of them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"

#define FILM "zoetrope: 1\nfilm: { duration: 4 s, rate: 24 }\ncamera: {}\n"

static void assert_curve_at(const zt_curve *curve, double time_s, double expected) {
    double value[ZT_VALUE_WIDTH_MAX];
    zt_curve_eval(value, curve, time_s);
    if (!(fabs(value[0] - expected) <= 1e-13))
        fail_msg("at %g s it is %.17g instead of %.17g", time_s, value[0], expected);
}

/* A variable stands for numbers, texts, lists and mappings, within all of them, for the time of
 * a key, and for further variables; in quotes it is only a text. */
static void variables(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        FILM "variables:\n"
             "  big: 1.5\n"
             "  left: [-2, $big, 0]\n"
             "  start: 12\n"
             "  ways: ease-in-out\n"
             "  clay: { color: [0.5, 0.25, 0], reflectivity: 1 }\n"
             "  same: $clay\n"
             "objects:\n"
             "  - sphere: { name: \"$big\", center: $left, radius: $big, material: $same }\n"
             "  - sphere: { radius: 1, center: { curve: $ways, keys: { $start: $left,\n"
             "      24: { value: [$big, 0, 0] } } } }\n"
             "materials: { $big: {} }\n");
    const zt_object *ball = &animation->rest.objects[0];
    assert_true(ball->sphere.radius == 1.5 && ball->sphere.center.x == -2 &&
                ball->sphere.center.y == 1.5);
    assert_true(animation->rest.materials[ball->material].color.y == 0.25);
    assert_int_equal(animation->track_count, 1);
    const zt_curve *curve = &animation->tracks[0].curve;
    assert_true(curve->times[0] == 0.5);
    assert_string_equal(zt_curve_label(curve), "eased");
    assert_curve_at(curve, 0.5, -2);
    assert_curve_at(curve, 1, 1.5);
    zt_animation_free(&animation);
}

/* Properties of any kind take their times from one list, in any order of it, or from one of
 * their own; what stands beside a value counts as in keys. */
static void timings(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        FILM "timings: { beat: [1 s, 0 s, 50 %] }\n"
             "lights: [ point: { position: [0, 0, 0], intensity: { curve: linear, at: beat,\n"
             "            values: [3, { value: 1, curve: hold }, 5] } } ]\n"
             "objects:\n"
             "  - sphere: { center: { at: beat, values: [[1, 0, 0], [2, 0, 0], [3, 0, 0]] },\n"
             "      radius: { curve: linear, at: [12, 36], values: [1, 2] } }\n");
    assert_int_equal(animation->track_count, 3);
    const zt_track *tracks = animation->tracks;
    for (int i = 0; i < 2; i++) {
        assert_int_equal(tracks[i].curve.key_count, 3);
        assert_true(tracks[i].curve.times[0] == 0 && tracks[i].curve.times[1] == 1 &&
                    tracks[i].curve.times[2] == 2);
        assert_int_equal(tracks[i].key_places[0].line, 4); /* of the timing */
        assert_int_equal(tracks[i].key_places[0].column, 24);
    }
    assert_curve_at(&tracks[0].curve, 0.5, 1);
    assert_curve_at(&tracks[0].curve, 1.5, 4);
    assert_curve_at(&tracks[1].curve, 0, 2);
    assert_curve_at(&tracks[1].curve, 2, 3);
    assert_curve_at(&tracks[2].curve, 1, 1.5);
    zt_animation_free(&animation);
}

/* A use is the keys of that name, later, faster, larger, and with what it says itself. */
static void uses(void **state) {
    (void)state;
    static const char hop[] =
        "curves: { hop: { curve: linear, keys: { 0 s: 1, 1 s: 3, 2 s: 2 } },\n"
        "  slope: { curve: hermite, keys: { 0 s: { value: 0, out: 3 }, 1 s: { value: 1, in: 0 "
        "} "
        "} },\n"
        "  bow: { curve: bezier, keys: { 0 s: { value: 0, out: { time: 0.6 s, value: 1 } }, 1 "
        "s: "
        "{ value: 1, in: { time: -0.6 s, value: 0 } } } } }\n";
    static const struct {
        const char *use;
        double time_s, value;
    } cases[] = {
        {"{ use: hop }", 0.5, 2},
        {"{ use: hop }", 3, 2},
        {"{ use: hop, delay: 0.5 s }", 1, 2},
        {"{ use: hop, delay: -12 }", 1, 2.5},
        {"{ use: hop, speed: 2 }", 0.25, 2},
        {"{ use: hop, delay: 1 s, speed: 0.5 }", 2, 2},
        {"{ use: hop, scale: 2.5 }", 0.5, 5},
        {"{ use: hop, curve: hold }", 0.5, 1},
        {"{ use: hop, after: loop, curve: linear }", 2.5, 2},
        {"{ use: hop, keys: { 0 s: 7 } }", 0.5, 7},
        /* A cubic from 0 to 1 with speed 3 at its begin: 3u - 3u^2 + u^3, twice as fast and
         * large. */
        {"{ use: slope, scale: 2, speed: 2 }", 0.25, 2 * (1.5 - 0.75 + 0.125)},
        {"{ use: bow, scale: 2, speed: 2 }", 0.25, (6 + 6 + 2) / 8.},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 FILM "%sobjects: [ sphere: { center: [0, 0, 0], radius: %s } ]\n", hop,
                 cases[i].use);
        zt_animation *animation = animation_of(text);
        assert_curve_at(&animation->tracks[0].curve, cases[i].time_s, cases[i].value);
        zt_animation_free(&animation);
    }
}

/* Keys of one name move things of different kinds, and stand where they are written. */
static void shared_keys(void **state) {
    (void)state;
    zt_animation *animation =
        animation_of(FILM "curves:\n"
                          "  pulse: { keys: { 0 s: 0.25,\n"
                          "                   1 s: 0.75 } }\n"
                          "objects:\n"
                          "  - sphere: { center: [0, 0, 0], radius: { use: pulse } }\n"
                          "  - group: { scale: { use: pulse }, objects: [] }\n"
                          "materials: { m: { reflectivity: { use: pulse, delay: 1 s } } }\n");
    assert_int_equal(animation->track_count, 3);
    for (int i = 0; i < 3; i++) {
        const zt_track *track = &animation->tracks[i];
        assert_curve_at(&track->curve, track->curve.times[1], 0.75);
        assert_int_equal(track->place.line, i == 0 ? 10 : 7 + i);
        assert_int_equal(track->key_places[1].line, 6);
    }
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(variables),
        cmocka_unit_test(timings),
        cmocka_unit_test(uses),
        cmocka_unit_test(shared_keys),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
