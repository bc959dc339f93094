/* Shows that expressions and constraints of a description drive what they say they do: with the
 * units and names of the description, in an order that nobody has to think of, with the same
 * bits however frames are asked for; and that what cannot be is told at its place. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>
#include <zoetrope/explain.h>

#include "base/pool.h"
#include "descriptions.h"
#include "patience.h"

static const double pi = 3.14159265358979323846;

/* The animation's scene at a time, in the arena. */
static zt_scene frozen(const zt_animation *animation, double time_s, zt_arena *arena) {
    zt_scene scene;
    zt_arena_reset(arena);
    assert_int_equal(zt_animation_freeze(&scene, animation, time_s, arena, (zt_listener){0}),
                     ZT_OK);
    return scene;
}

static void assert_near(double found, double expected) {
    if (!(fabs(found - expected) <= 1e-14 * fmax(1, fabs(expected))))
        fail_msg("%.17g is not %.17g", found, expected);
}

static void assert_vec(vec3 found, double x, double y, double z) {
    assert_near(found.x, x);
    assert_near(found.y, y);
    assert_near(found.z, z);
}

#define FILM "zoetrope: 1\nfilm: { duration: 4 s, rate: 30000/1001 }\n"

/* ---- expressions ----------------------------------------------------------------------------
 */

/* Each kind of value has the numbers that it is written with: angles and rotations in degrees,
 * one number for a whole scale or color, true or false for a switch; t, frame, fps and duration
 * are the film's, and frames are whole at their times. */
static void expressions(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        FILM
        "variables: { big: 1.5, tall: $big, name: \"3\" }\n"
        "camera: { position: \"= {t, 2*t, -t}\", fov: \"= 40 + 10*t\", roll: \"=-camera.fov\","
        " rotation: \"= {0, 90*t, 0}\" }\n"
        "materials: { clay: { color: \"= 0.25\", reflectivity: \"= big/3\" } }\n"
        "lights:\n"
        "  - point: { name: key light, position: \"= camera.position + {0, tall, 0}\","
        " shadows: \"= t < 1\" }\n"
        "  - point: { position: [0, 0, 0], intensity: \"= frame\","
        " shadows: \"= not prop('key light.shadows')\" }\n"
        "objects:\n"
        "  - group: { name: box, scale: \"= 1 + t\", rotation: \"= {90, 0, 0}\", objects: [] "
        "}\n"
        "  - sphere: { center: \"= {box.rotation.x, box.rotation.w, camera.fov}\","
        " radius: \"= fps + duration\", material: clay }\n");
    zt_arena arena = {0};
    for (int frame = 0; frame < 119; frame += 7) {
        double t = frame * 1001 / 30000.;
        zt_scene s = frozen(animation, t, &arena);
        double radian = pi / 180;
        assert_vec(s.camera.position, t, 2 * t, -t);
        assert_near(s.camera.fov, (40 + 10 * t) * radian);
        assert_near(s.camera.roll, -(40 + 10 * t) * radian);
        assert_near(s.camera.rotation.w, cos(45 * t * radian));
        assert_near(s.camera.rotation.y, sin(45 * t * radian));
        assert_vec(s.materials[0].color, 0.25, 0.25, 0.25);
        assert_near(s.materials[0].reflectivity, 0.5);
        assert_vec(s.lights[0].position, t, 2 * t + 1.5, -t);
        assert_int_equal(s.lights[0].shadows, t < 1);
        assert_int_equal(s.lights[1].shadows, t >= 1);
        assert_true(s.lights[1].intensity == frame);
        assert_vec(s.objects[0].placement.scale, 1 + t, 1 + t, 1 + t);
        assert_vec(s.objects[1].sphere.center, sqrt(0.5), sqrt(0.5), 40 + 10 * t);
        assert_near(s.objects[1].sphere.radius, 30000 / 1001. + 120 * 1001 / 30000.);
    }
    assert_vec(animation->rest.lights[0].position, 0, 1.5, 0); /* at rest: as at time 0 */
    assert_string_equal(zt_animation_movement(animation, 0).name, "camera.position");
    assert_string_equal(zt_animation_movement(animation, 0).driver, "expression");
    assert_int_equal(zt_animation_movement(animation, 0).key_count, 0);
    zt_arena_free(&arena);
    zt_animation_free(&animation);
}

/* What an expression gives beyond its property's range is kept in it, and what reads it sees
 * that value. */
static void expressions_in_range(void **state) {
    (void)state;
    zt_animation *animation =
        animation_of(FILM "camera: {}\nobjects:\n"
                          "  - sphere: { name: b, center: \"= {a.radius, 0, 0}\", radius: 1 }\n"
                          "  - sphere: { name: a, center: [0, 0, 0], radius: \"= 1 - t\" }\n");
    zt_arena arena = {0};
    assert_vec(frozen(animation, 0.25, &arena).objects[0].sphere.center, 0.75, 0, 0);
    assert_vec(frozen(animation, 3, &arena).objects[0].sphere.center, 0, 0, 0);
    zt_arena_free(&arena);
    zt_animation_free(&animation);
}

/* The velocity of an expression is that just after the moment: it may jump there, or have no
 * value before. */
static void velocity_of_expressions(void **state) {
    (void)state;
    const struct {
        const char *name;
        double time_s, velocity;
    } cases[] = {{"a.radius", 0, 3}, {"b.radius", 1, 2}, {"b.radius", 2, 2}};
    zt_animation *animation = animation_of(
        FILM "camera: {}\nobjects:\n"
             "  - sphere: { name: a, center: [0, 0, 0], radius: \"= 3*t + 0*sqrt(t)\" }\n"
             "  - sphere: { name: b, center: [0, 0, 0], radius: \"= floor(t) + 2*t\" }\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_subject subject;
        zt_explanation e;
        assert_int_equal(zt_subject_find(&subject, animation, cases[i].name, (zt_listener){0}),
                         ZT_OK);
        assert_int_equal(zt_subject_explain(&e, &subject, cases[i].time_s, (zt_listener){0}),
                         ZT_OK);
        assert_false(e.velocity_exact);
        assert_true(fabs(e.velocity[0] - cases[i].velocity) < 1e-6);
    }
    zt_animation_free(&animation);
}

/* A thousand expressions, each of which needs the next one in the text, end in one that keys
 * drive. */
static void long_chain(void **state) {
    (void)state;
    enum { LINKS = 1000 };
    static char text[LINKS * 80 + 1000];
    int length = snprintf(text, sizeof text, FILM "camera: {}\nlights:\n");
    for (int i = 0; i < LINKS; i++)
        length += snprintf(text + length, sizeof text - (size_t)length,
                           "  - ambient: { name: l%d, intensity: \"= l%d.intensity + 1\" }\n",
                           i, i + 1);
    snprintf(
        text + length, sizeof text - (size_t)length,
        "  - ambient: { name: l%d, intensity: { curve: linear, keys: { 0 s: 0, 4 s: 4 } } }\n",
        LINKS);
    zt_animation *animation = animation_of(text);
    zt_arena arena = {0};
    assert_true(frozen(animation, 0.5, &arena).lights[0].intensity == LINKS + 0.5);
    assert_string_equal(zt_animation_movement(animation, 7).name, "l7.intensity");
    zt_arena_free(&arena);
    zt_animation_free(&animation);
}

/* Each animation has expressions of its own: one goes, the other stays as it was. */
static void two_animations(void **state) {
    (void)state;
    zt_animation *one = animation_of("zoetrope: 1\nfilm: { duration: 1 s }\n"
                                     "camera: { fov: \"= 10*duration\" }\n");
    zt_animation *two = animation_of("zoetrope: 1\nfilm: { duration: 3 s }\n"
                                     "camera: { fov: \"= 10*duration\" }\n");
    zt_arena arena = {0};
    assert_near(frozen(one, 0, &arena).camera.fov, 10 * pi / 180);
    zt_animation_free(&one);
    assert_near(frozen(two, 0, &arena).camera.fov, 30 * pi / 180);
    zt_animation_free(&two);
    zt_arena_free(&arena);
}

/* An expression that has no value at a frame in the middle of the film, which reading does not
 * try, stops that frame and no other; all that fail there are told at their places. */
static void no_value_at_a_frame(void **state) {
    (void)state;
    zt_animation *animation =
        animation_of("zoetrope: 1\nfilm: { duration: 4 s }\n"
                     "camera: { fov: \"= 40 + 1/(t - 1)\", roll: \"= 1\" }\n"
                     "lights: [ ambient: { name: dim, color: \"= 2 +\\\n"
                     "  sqrt(abs(t - 1) - 0.01)\" } ]\n");
    static told t = {.file = "film.yaml"};
    zt_arena arena = {0};
    zt_scene scene;
    assert_int_equal(zt_animation_freeze(&scene, animation, 1, &arena, told_to(&t)),
                     ZT_EDESCRIPTION);
    assert_string_equal(
        t.lines, "3:19: error: \"camera.fov\" has no value at 1 s: the result is not finite\n"
                 "4:40: error: \"dim.color\" has no value at 1 s: the result is not finite\n");
    assert_int_equal(t.foreign_count, 0);
    frozen(animation, 1.25, &arena);
    zt_arena_free(&arena);
    zt_animation_free(&animation);
}

/* ---- constraints ----------------------------------------------------------------------------
 */

/* Each constraint as it is written, with all that may be left out left out, and then not. */
static void constraints(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        FILM
        "camera: { position: { orbit: { around: [0, 1, 0], radius: 5, period: 4 s } },"
        " look_at: moon, roll: 10 deg }\n"
        "curves: { way: { curve: linear, keys: { 0 s: [0, 0, 0], 9 s: [8, 0, 0] } } }\n"
        "lights:\n"
        "  - point: { name: lamp, position: { offset: { from: moon.center, by: [0, 2, 0] } },"
        " intensity: { offset: { from: ball.radius } } }\n"
        "objects:\n"
        "  - sphere: { name: ball, center: { follow: { path: [[0, 0, 0], [4, 0, 0]] } },"
        " radius: 0.5 }\n"
        "  - sphere: { name: moon, radius: 0.1, center: { orbit: { around: ball, radius: 2,"
        " axis: [0, 0, 3], period: -2 s, phase: 90 deg } } }\n"
        "  - group: { name: car, objects: [], position: { follow: { use: way, from: 1 s, to:"
        " 50 %, orient: true, ease: quad-in, bank: 10 deg, up: [0, 0, 2] } } }\n"
        "  - group: { name: eye, objects: [], rotation: { look_at: [5, 0, 0], roll: 90 } }\n"
        "  - group: { name: ear, objects: [], rotation: { offset: { from: eye.rotation, by:"
        " [0, 180, 0] } } }\n");
    const char *drivers[] = {"orbit", "look_at", "offset", "offset",  "follow",
                             "orbit", "follow",  "follow", "look_at", "offset"};
    assert_int_equal(animation->track_count, 10);
    for (int i = 0; i < 10; i++)
        assert_string_equal(zt_animation_movement(animation, i).driver, drivers[i]);
    zt_movement car = zt_animation_movement(animation, 7);
    double end = 120 * 1001 / 30000.;
    assert_string_equal(car.name, "car.rotation");
    assert_true(car.first_s == 1 && car.last_s == end / 2);
    zt_arena arena = {0};
    assert_true(animation->rest.camera.aimed);
    for (double t = 0; t < 4; t += 0.3) {
        zt_scene s = frozen(animation, t, &arena);
        double x = 4 * t / end, a = pi / 2 - pi * t;
        double u = fmin(fmax((t - 1) / (end / 2 - 1), 0), 1);
        vec3 moon = {x + 2 * cos(a), 2 * sin(a), 0};
        assert_vec(s.camera.position, 5 * cos(pi / 2 * t), 1, -5 * sin(pi / 2 * t));
        assert_near(s.camera.roll, 10 * pi / 180);
        assert_vec(s.objects[0].sphere.center, x, 0, 0);
        assert_vec(s.objects[1].sphere.center, moon.x, moon.y, moon.z);
        assert_vec(s.camera.look_at, moon.x, moon.y, moon.z);
        assert_vec(s.lights[0].position, moon.x, moon.y + 2, moon.z);
        assert_near(s.lights[0].intensity, 0.5);
        assert_vec(s.objects[2].placement.position, 8 * u * u, 0, 0);
        xform m =
            xform_place((vec3){0, 0, 0}, s.objects[2].placement.rotation, (vec3){1, 1, 1});
        assert_vec(m.z, -1, 0, 0);
        assert_vec(m.y, 0, 0, 1);
        m = xform_place((vec3){0, 0, 0}, s.objects[3].placement.rotation, (vec3){1, 1, 1});
        assert_vec(m.z, -1, 0, 0);
        assert_vec(m.y, 0, 0, -1); /* its left: rolled by a right angle */
        m = xform_place((vec3){0, 0, 0}, s.objects[4].placement.rotation, (vec3){1, 1, 1});
        assert_vec(m.z, 1, 0, 0);
    }
    zt_arena_free(&arena);
    zt_animation_free(&animation);
}

/* A name means the thing that is somewhere, also where a material is called the same; things
 * without a name have their kind and number. */
static void names(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        FILM "camera: { look_at: ball, fov: \"= 30 + prop('sphere 2.radius')\" }\n"
             "materials: { ball: { reflectivity: 0.5 } }\n"
             "lights: [ ambient: { intensity: \"= ball.reflectivity + ball.radius\" } ]\n"
             "objects:\n"
             "  - sphere: { name: ball, center: [1, 2, 3], radius: 4 }\n"
             "  - sphere: { center: [0, 0, 0], radius: { offset: { from: ball.radius, by: 1 } "
             "} }\n");
    zt_arena arena = {0};
    zt_scene s = frozen(animation, 0, &arena);
    assert_vec(s.camera.look_at, 1, 2, 3);
    assert_near(s.camera.fov, 35 * pi / 180);
    assert_near(s.lights[0].intensity, 4.5);
    zt_arena_free(&arena);
    zt_animation_free(&animation);
}

/* ---- the same bits --------------------------------------------------------------------------
 */

enum { FRAMES = 97, THREADS = 4 };

typedef struct film {
    const zt_animation *animation;
    zt_camera cameras[FRAMES];
    zt_object objects[FRAMES][8];
    zt_light lights[FRAMES][3];
    int first, step; /* the order in which frames are asked for; step and FRAMES are coprime */
    int frozen_count;
} film;

static void freeze_all(void *user, int task, int worker) {
    (void)worker;
    film *f = (film *)user + task;
    zt_arena arena = {0};
    for (int i = 0; i < FRAMES; i++) {
        int frame = (f->first + i * f->step) % FRAMES;
        zt_scene s;
        zt_arena_reset(&arena);
        if (zt_animation_freeze(&s, f->animation, frame / 24., &arena, (zt_listener){0}) !=
            ZT_OK)
            continue;
        f->frozen_count++;
        memcpy(&f->cameras[frame], &s.camera, sizeof s.camera);
        memcpy(f->objects[frame], s.objects, (size_t)s.object_count * sizeof *s.objects);
        memcpy(f->lights[frame], s.lights, (size_t)s.light_count * sizeof *s.lights);
    }
    zt_arena_free(&arena);
}

static bool same(const film *a, const film *b) {
    return memcmp(a->cameras, b->cameras, sizeof a->cameras) == 0 &&
           memcmp(a->objects, b->objects, sizeof a->objects) == 0 &&
           memcmp(a->lights, b->lights, sizeof a->lights) == 0;
}

/* Forwards, backwards, in leaps, and by four threads at once: all kinds of tracks, depending on
 * one another, have the same bits in every frame. */
static void any_order_any_thread(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        "zoetrope: 1\nfilm: { duration: 97 }\n"
        "camera: { position: \"= {9*sin(t), noise(t), 9*cos(t)}\", look_at: moon }\n"
        "lights:\n"
        "  - ambient: { intensity: \"= random(frame)\" }\n"
        "  - point: { name: lamp, position: { offset: { from: car.position, by: [0, 1, 0] } } "
        "}\n"
        "objects:\n"
        "  - group:\n"
        "      rotation: { keys: { 0 s: [0, 0, 0], 1 s: [0, 90, 30], 3 s: [70, 0, 10] } }\n"
        "      objects:\n"
        "        - sphere: { name: ball, center: { keys: { 0 s: [0, 0, 0], 4 s: [1, 2, 3] },\n"
        "                    spring: { frequency: 2 } }, radius: \"= 1 + "
        "length(lamp.position)\" }\n"
        "  - sphere: { name: moon, center: { orbit: { around: ball, radius: 2, period: 1.7 s } "
        "},\n"
        "              radius: 0.2 }\n"
        "  - group: { name: car, objects: [], position: { follow: { closed: true, orient: "
        "true,\n"
        "             path: [[0, 0, 0], [3, 1, 0], [2, 0, 5]], to: 3 s, bank: 30 deg } } }\n"
        "  - group: { objects: [], position: [4, 4, 4], rotation: { look_at: moon } }\n");
    static film films[THREADS + 1];
    const int first[] = {0, FRAMES - 1, 0, 50, 3}, step[] = {1, FRAMES - 1, 31, 1, 45};
    for (int i = 0; i <= THREADS; i++) {
        films[i].animation = animation;
        films[i].first = first[i];
        films[i].step = step[i];
    }
    freeze_all(films, 0, 0);
    zt_pool *pool;
    assert_int_equal(zt_pool_open(&pool, THREADS), ZT_OK);
    zt_pool_run(pool, THREADS, freeze_all, films + 1);
    zt_pool_close(&pool);
    for (int i = 0; i <= THREADS; i++) {
        assert_int_equal(films[i].frozen_count, FRAMES);
        assert_true(same(&films[0], &films[i]));
    }
    zt_animation_free(&animation);
}

/* ---- hostile --------------------------------------------------------------------------------
 */

/* Deep groups, and things in the innermost that look at one another, cost no more than their
 * text is long; nor do many that fail, of which no more than a hundred are told. */
static void many_and_deep(void **state) {
    (void)state;
    enum { DEPTH = 20, MANY = 2000 };
    static char text[MANY * 200];
    int length = snprintf(text, sizeof text, FILM "camera: {}\nobjects: [");
    for (int i = 0; i < DEPTH; i++)
        length += snprintf(text + length, sizeof text - (size_t)length,
                           "group: { name: g%d, position: \"= {t, 0, 0}\", objects: [", i);
    for (int i = 0; i < MANY; i++)
        length += snprintf(text + length, sizeof text - (size_t)length,
                           "sphere: { name: s%d, radius: 1, center: { orbit: { around: g0, "
                           "radius: 1, period: 1 s } } }, ",
                           i);
    for (int i = 0; i < DEPTH; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, "] }");
    snprintf(text + length, sizeof text - (size_t)length, "]\n");
    double begin_s = computed_s();
    zt_animation *animation = animation_of(text);
    zt_animation_free(&animation);
    length = snprintf(text, sizeof text, FILM "camera: {}\nlights:\n");
    for (int i = 0; i < MANY; i++)
        length += snprintf(text + length, sizeof text - (size_t)length,
                           "  - ambient: { intensity: \"= %s\" }\n",
                           i % 2 ? "nothing.here" : "sqrt(-1)");
    static told t;
    assert_int_equal(read_told(&t, &animation, text), ZT_EDESCRIPTION);
    assert_int_equal(t.error_count, 100);
    assert_within(begin_s, 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(expressions),
        cmocka_unit_test(expressions_in_range),
        cmocka_unit_test(velocity_of_expressions),
        cmocka_unit_test(long_chain),
        cmocka_unit_test(two_animations),
        cmocka_unit_test(no_value_at_a_frame),
        cmocka_unit_test(constraints),
        cmocka_unit_test(names),
        cmocka_unit_test(any_order_any_thread),
        cmocka_unit_test(many_and_deep),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
