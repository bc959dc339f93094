/* Shows that what is explained is so: values in the units of the description, velocities
 * against closed forms, keys and parameters, times and names as a person writes them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <zoetrope/explain.h>

#include "small_film.h"
#include "told.h"

static const double pi = 3.14159265358979323846;
static const zt_listener deaf;

static zt_explanation explained(const zt_animation *film, const char *name, double time_s) {
    zt_subject subject;
    zt_explanation e;
    assert_int_equal(zt_subject_find(&subject, film, name, deaf), ZT_OK);
    assert_string_equal(subject.name, name);
    assert_int_equal(zt_subject_explain(&e, &subject, time_s, deaf), ZT_OK);
    return e;
}

/* A Hermite curve that is t^3: value and velocity at any time, exactly, with its keys. */
static void a_cubic(void **state) {
    (void)state;
    zt_animation *film = small_film(100, (zt_rate){24, 1});
    const double values[] = {-1, 0, 8}, slopes[] = {3, 0, 12};
    zt_key keys[3];
    for (int k = 0; k < 3; k++) {
        keys[k] = key(k - 1 + (k == 2), &values[k], ZT_CURVE_HERMITE);
        keys[k].before = keys[k].after = &slopes[k];
    }
    add_keys(film, "lamp.intensity", (zt_curve_spec){.key_count = 3, .keys = keys});
    const double times[] = {-0.75, 0, 0.25, 1, 1.875};
    for (int i = 0; i < 5; i++) {
        double t = times[i];
        zt_explanation e = explained(film, "lamp.intensity", t);
        assert_near(e.value[0], t * t * t, 1e-14);
        assert_near(e.velocity[0], 3 * t * t, 1e-13);
        assert_true(e.velocity_exact);
        assert_int_equal(e.velocity_count, 1);
        assert_int_equal(e.key_before, t < 0 ? 0 : 1);
        assert_int_equal(e.key_after, t < 0 ? 1 : 2);
        assert_true(e.u == (t < 0 ? t + 1 : t / 2) && e.s == e.u);
        assert_null(e.end);
    }
    zt_animation_free(&film);
}

/* A Bezier curve whose time is 3 s^2 - 2 s^3: the parameter is solved for, and the velocity is
 * that of the value by the time, not by the parameter. */
static void a_bezier(void **state) {
    (void)state;
    zt_animation *film = small_film(100, (zt_rate){24, 1});
    const double values[] = {0, 4}, out = 2, in = -1;
    zt_key keys[2] = {key(0, &values[0], ZT_CURVE_BEZIER), key(2, &values[1], ZT_CURVE_BEZIER)};
    keys[0].after = &out, keys[0].after_s = 0;
    keys[1].before = &in, keys[1].before_s = 0;
    add_keys(film, "lamp.intensity", (zt_curve_spec){.key_count = 2, .keys = keys});
    for (double s = 0.125; s < 1; s += 0.125) {
        double u = s * s * (3 - 2 * s), du = 6 * s * (1 - s), r = 1 - s;
        double value = 3 * r * r * s * 2 + 3 * r * s * s * 3 + s * s * s * 4;
        double slope = 3 * (r * r * 2 + 2 * r * s * (3 - 2) + s * s * (4 - 3));
        zt_explanation e = explained(film, "lamp.intensity", 2 * u);
        assert_near(e.u, u, 1e-15);
        assert_near(e.s, s, 1e-14);
        assert_near(e.value[0], value, 1e-13);
        assert_near(e.velocity[0], slope / (2 * du), 1e-12);
        assert_true(e.velocity_exact);
    }
    zt_animation_free(&film);
}

/* An undamped spring of one swing a second: a cosine around the new rest. */
static void a_spring(void **state) {
    (void)state;
    zt_animation *film = small_film(100, (zt_rate){24, 1});
    const double values[] = {1, 3};
    zt_key keys[2] = {key(0, &values[0], 0), key(1, &values[1], 0)};
    zt_spring spring = zt_spring_make(2 * pi, 0);
    add_keys(film, "lamp.intensity",
             (zt_curve_spec){.key_count = 2, .keys = keys, .spring = &spring});
    for (int i = 0; i < 40; i++) {
        double t = 1 + i * 0.0775;
        zt_explanation e = explained(film, "lamp.intensity", t);
        assert_near(e.value[0], 3 - 2 * cos(2 * pi * (t - 1)), 1e-12);
        assert_near(e.velocity[0], 4 * pi * sin(2 * pi * (t - 1)), 1e-10);
        assert_true(e.velocity_exact);
        assert_null(e.end); /* it swings on */
        assert_int_equal(e.key_before, 1);
    }
    assert_near(explained(film, "lamp.intensity", 0.5).velocity[0], 0, 0);
    zt_animation_free(&film);
}

/* Easings have no formula here: the difference is near to the derivative, and never looks
 * across a key; a staircase stands still. */
static void eased(void **state) {
    (void)state;
    zt_animation *film = small_film(100, (zt_rate){24, 1});
    const double values[] = {0, 1, 0, 5};
    zt_ease quad = {.kind = ZT_EASE_QUAD, .way = ZT_EASE_IN};
    zt_ease steps = {.kind = ZT_EASE_STEPS, .step_count = 4, .jump = ZT_EASE_JUMP_END};
    zt_key keys[4];
    for (int k = 0; k < 4; k++) keys[k] = key(k, &values[k], ZT_CURVE_LINEAR);
    keys[0].ease = keys[1].ease = &quad;
    keys[2].ease = &steps;
    add_keys(film, "lamp.intensity", (zt_curve_spec){.key_count = 4, .keys = keys});
    const double times[] = {0, 1e-6, 0.5, 0.999999, 1, 1.000001, 1.5, 1.75};
    for (int i = 0; i < 8; i++) {
        double t = times[i], u = t - floor(t);
        zt_explanation e = explained(film, "lamp.intensity", t);
        assert_false(e.velocity_exact);
        assert_near(e.velocity[0], (t < 1 ? 2 : -2) * u, 1e-7);
        assert_near(e.s, u * u, 1e-15);
    }
    assert_near(explained(film, "lamp.intensity", 2.3).velocity[0], 0, 0);
    zt_subject subject;
    zt_subject_find(&subject, film, "lamp.intensity", deaf);
    assert_string_equal(zt_subject_key_at(&subject, 0).ease, "quad-in");
    assert_string_equal(zt_subject_key_at(&subject, 2).ease, "steps(4, jump-end)");
    assert_string_equal(zt_subject_key_at(&subject, 2).way, "linear");
    assert_null(zt_subject_key_at(&subject, 3).way);
    zt_animation_free(&film);
}

/* Rotations turn as fast as they must around their axis, with a formula where the speed is
 * constant; their words are the angles that made them. */
static void rotations(void **state) {
    (void)state;
    zt_animation *film = small_film(100, (zt_rate){24, 1});
    quat q[3] = {quat_euler_xyz((vec3){0.3, 0.2, -0.4})};
    q[1] = quat_mul(quat_axis_angle((vec3){0, 0, 1}, pi / 3), q[0]); /* around the fixed z */
    q[2] = quat_mul(quat_axis_angle((vec3){0, 0, 1}, pi / 3), q[1]);
    const double times[] = {0, 2, 4};
    add_simple(film, "group.rotation", ZT_CURVE_LINEAR, 3, times, (double *)q);
    zt_explanation e = explained(film, "group.rotation", 0.7);
    assert_true(e.velocity_exact);
    assert_int_equal(e.velocity_count, 3);
    assert_string_equal(e.velocity_channels[2], "z");
    assert_near(e.velocity[0], 0, 1e-12);
    assert_near(e.velocity[1], 0, 1e-12);
    assert_near(e.velocity[2], 30, 1e-11);
    zt_subject subject;
    assert_int_equal(zt_subject_find(&subject, film, "group.rotation", deaf), ZT_OK);
    assert_int_equal(subject.channel_count, 4);
    assert_string_equal(subject.channels[0], "w");
    double x, y, z;
    zt_subject_words words = zt_subject_in_words(&subject, (double *)q);
    assert_int_equal(sscanf(words.text, "[%lf, %lf, %lf] deg", &x, &y, &z), 3);
    assert_near(x, 0.3 * 180 / pi, 1e-4);
    assert_near(y, 0.2 * 180 / pi, 1e-4);
    assert_near(z, -0.4 * 180 / pi, 1e-4);
    /* Where y is a right angle, other angles may stand for the same rotation. */
    quat edge = quat_euler_xyz((vec3){0.5, pi / 2, 0.1}), back;
    words = zt_subject_in_words(&subject, (double *)&edge);
    assert_int_equal(sscanf(words.text, "[%lf, %lf, %lf] deg", &x, &y, &z), 3);
    back = quat_euler_xyz((vec3){x * pi / 180, y * pi / 180, z * pi / 180});
    assert_near(fabs(quat_dot(edge, back)), 1, 1e-9);
    zt_animation_free(&film);

    film = small_film(100, (zt_rate){24, 1});
    add_simple(film, "group.rotation", ZT_CURVE_SMOOTH, 3, times, (double *)q);
    e = explained(film, "group.rotation", 2);
    assert_false(e.velocity_exact);
    assert_near(e.velocity[0], 0, 1e-4);
    assert_near(e.velocity[2], 30, 1e-4); /* both steps are of the same speed */
    zt_animation_free(&film);
}

/* What ends do: the keys that are around, how far beyond, which round; velocities there. */
static void ends(void **state) {
    (void)state;
    const struct {
        zt_curve_end end;
        double time_s, value, velocity, beyond_s, round;
        int before, after;
        const char *says;
    } cases[] = {
        {ZT_END_HOLD, 3.5, 6, 0, 0.5, 0, 1, -1, "hold"},
        {ZT_END_HOLD, 0, 2, 0, -1, 0, -1, 0, "hold"},
        {ZT_END_HOLD, 3, 6, 0, 0, 0, 1, -1, NULL},
        {ZT_END_LINEAR, 4, 8, 2, 1, 0, 1, -1, "linear"},
        {ZT_END_LINEAR, 0, 0, 2, -1, 0, -1, 0, "linear"},
        {ZT_END_LOOP, 4.5, 5, 2, 1.5, 1, 0, 1, "loop"},
        {ZT_END_LOOP, 0.5, 5, 2, -0.5, -1, 0, 1, "loop"},
        {ZT_END_PING_PONG, 4.5, 3, -2, 1.5, 1, 0, 1, "ping-pong"},
        {ZT_END_LOOP_WITH_OFFSET, 5.5, 11, 2, 2.5, 2, 0, 1, "loop-with-offset"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_animation *film = small_film(100, (zt_rate){24, 1});
        const double values[] = {2, 6};
        zt_key keys[2] = {key(1, &values[0], ZT_CURVE_LINEAR),
                          key(3, &values[1], ZT_CURVE_LINEAR)};
        add_keys(
            film, "lamp.intensity",
            (zt_curve_spec){
                .key_count = 2, .keys = keys, .before = cases[i].end, .after = cases[i].end});
        zt_explanation e = explained(film, "lamp.intensity", cases[i].time_s);
        assert_near(e.value[0], cases[i].value, 1e-12);
        assert_near(e.velocity[0], cases[i].velocity, 1e-6);
        assert_near(e.beyond_s, cases[i].beyond_s, 0);
        assert_near(e.round, cases[i].round, 0);
        assert_int_equal(e.key_before, cases[i].before);
        assert_int_equal(e.key_after, cases[i].after);
        if (cases[i].says)
            assert_string_equal(e.end, cases[i].says);
        else
            assert_null(e.end);
        zt_animation_free(&film);
    }
}

/* Angles are degrees, colours have their display colour, what is cut when rendered is said to
 * be, keys know their places, and constants stand still. */
static void units_and_places(void **state) {
    (void)state;
    zt_animation *film = small_film(48, (zt_rate){24, 1});
    const double times[] = {0, 1}, fov[] = {pi / 6, pi / 2}, radius[] = {1, -1};
    const double red[] = {0.57758, 0.09084, 0.04667, 1, 1, 1};
    add_simple(film, "camera.fov", ZT_CURVE_LINEAR, 2, times, fov);
    add_simple(film, "ball.radius", ZT_CURVE_LINEAR, 2, times, radius);
    add_simple(film, "clay.color", ZT_CURVE_LINEAR, 2, times, red);
    zt_explanation e = explained(film, "camera.fov", 0.5);
    assert_near(e.value[0], 60, 1e-12);
    assert_near(e.velocity[0], 60, 1e-12);
    assert_near(e.frame, 12, 0);
    assert_false(e.cut);
    assert_true(explained(film, "ball.radius", 0.75).cut);
    zt_subject subject;
    assert_int_equal(zt_subject_find(&subject, film, "camera.fov", deaf), ZT_OK);
    assert_string_equal(subject.unit, "deg");
    assert_int_equal(subject.key_count, 2);
    assert_int_equal(zt_subject_stands_at(&subject).line, 10);
    zt_subject_key k = zt_subject_key_at(&subject, 1);
    assert_near(k.value[0], 90, 1e-12);
    assert_int_equal(k.place.line, 12);
    assert_string_equal(k.place.file, "film.yaml");
    assert_int_equal(zt_subject_find(&subject, film, "clay.color", deaf), ZT_OK);
    assert_string_equal(zt_subject_in_words(&subject, red).text, "#c8553d");
    assert_string_equal(zt_subject_in_words(&subject, red + 3).text, "#ffffff");

    film->rest.lights[0].position = (vec3){1, 2, 3};
    assert_int_equal(zt_subject_find(&subject, film, "lamp.position", deaf), ZT_OK);
    assert_string_equal(subject.driver, "constant");
    assert_int_equal(zt_subject_stands_at(&subject).line, 4); /* where the lamp is */
    assert_string_equal(zt_subject_stands_at(&subject).file, "small.yaml");
    assert_int_equal(subject.key_count, 0);
    e = explained(film, "lamp.position", 17);
    for (int c = 0; c < 3; c++) assert_true(e.value[c] == c + 1 && e.velocity[c] == 0);
    assert_true(e.velocity_exact);
    zt_animation_free(&film);
}

/* A name that nothing has is told with the nearest that something has, moving or not. */
static void unknown_names(void **state) {
    (void)state;
    zt_animation *film = small_film(48, (zt_rate){24, 1});
    const double times[] = {0, 1}, values[] = {1, 2};
    add_simple(film, "lamp.intensity", ZT_CURVE_LINEAR, 2, times, values);
    const struct {
        const char *name, *told;
    } cases[] = {
        {"lamp.intensty", "did you mean lamp.intensity?"},
        {"bal.center", "did you mean ball.center?"},
        {"inner ball.radus", "did you mean inner ball.radius?"},
        {"lamp.fov", "nothing is called lamp.fov"},
        {"ball", "nothing is called ball"},
        {"", "nothing is called ;"},
        {"ball.", "nothing is called ball."},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        told t = {.file = NULL};
        zt_subject subject;
        assert_int_equal(zt_subject_find(&subject, film, cases[i].name, told_to(&t)),
                         ZT_EARGUMENT);
        assert_int_equal(t.error_count, 1);
        if (!strstr(t.lines, cases[i].told)) fail_msg("%s: %s", cases[i].name, t.lines);
    }
    zt_animation_free(&film);
}

/* Times as a person writes them, exactly where a frame is meant; and what is none. */
static void times(void **state) {
    (void)state;
    const zt_rate tv = {30000, 1001};
    zt_animation *film = small_film(300, tv);
    const struct {
        const char *text;
        double time_s;
    } cases[] = {
        {"37", 37 * 1001 / 30000.0},
        {"0", 0},
        {"-3", -3 * 1001 / 30000.0},
        {"36.5", 36.5 * 1001 / 30000},
        {"1.5s", 1.5},
        {"1.5 s", 1.5},
        {"500ms", 0.5},
        {"00:00:01:12", 42 * 1001 / 30000.0},
        {"01:00:00:29", (3600 * 30 + 29) * 1001 / 30000.0},
        {"25 %", 0.25 * (300 * 1001 / 30000.0)},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double time_s;
        assert_int_equal(zt_subject_time(&time_s, film, cases[i].text, deaf), ZT_OK);
        assert_near(time_s, cases[i].time_s, 1e-15 * fabs(cases[i].time_s));
    }
    const char *wrong[] = {"",    "x",      "1.5 h",       "s",           "1e400",
                           "nan", "1..5 s", "00:00:00:30", "00:60:00:00", "1:2:3",
                           "--3", "3 4",    "0x10",        "1:2:3:4:5"};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        told t = {.file = NULL};
        double time_s;
        if (zt_subject_time(&time_s, film, wrong[i], told_to(&t)) != ZT_EARGUMENT)
            fail_msg("\"%s\" was taken", wrong[i]);
        assert_int_equal(t.error_count, 1);
    }
    zt_animation_free(&film);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cubic),       cmocka_unit_test(a_bezier),
        cmocka_unit_test(a_spring),      cmocka_unit_test(eased),
        cmocka_unit_test(rotations),     cmocka_unit_test(ends),
        cmocka_unit_test(times),         cmocka_unit_test(units_and_places),
        cmocka_unit_test(unknown_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
