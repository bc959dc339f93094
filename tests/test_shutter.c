/* The shutter: an exposure has as many moments as what moves asks for. What is between them is
 * held against the true motion at each 1/4096 of the opening, in pixels of the picture. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/clock.h"
#include "descriptions.h"
#include "sequence/shutter.h"

enum { WIDTH = 640, HEIGHT = 360, POINTS_MAX = 64 };

static const zt_listener deaf;

/* A film of 24 frames a second, 640 x 360, with these lines after its camera and its light. */
static zt_animation *film_with(const char *shutter, const char *camera, const char *lines) {
    static char text[16 * 1024];
    snprintf(text, sizeof text,
             "zoetrope: 1\n"
             "film: { size: [640, 360], rate: 24, duration: 10 s, shutter: %s }\n"
             "camera: { %s }\n"
             "lights:\n"
             "  - ambient: { intensity: 0.2 }\n"
             "%s",
             shutter, camera, lines);
    return animation_of(text);
}

static const char still_camera[] = "position: [0, 1, 6], look_at: [0, 1, 0], fov: 40 deg";

typedef struct shot {
    zt_arena arena;
    zt_exposure exposure;
    zt_division division;
    uint64_t place_key, frame_key;
} shot;

static shot shoot_with(const zt_animation *film, int64_t frame, zt_sampling sampling) {
    shot s = {.arena = {0}};
    assert_int_equal(
        zt_shutter_expose(&s.exposure, &s.division, film, frame, HEIGHT, &s.arena, deaf),
        ZT_OK);
    const zt_exposure *e = &s.exposure;
    assert_true(e->moment_count >= 1 && e->moment_count <= ZT_TIME_CELLS + 1);
    assert_int_equal(e->moment_count, s.division.moment_count);
    for (int32_t i = 0; e->moment_count > 1 && i < e->moment_count; i++) {
        assert_true(e->times[i] * ZT_TIME_CELLS == floor(e->times[i] * ZT_TIME_CELLS));
        assert_true(i == 0 ? e->times[i] == 0 : e->times[i] > e->times[i - 1]);
    }
    if (e->moment_count > 1) assert_true(e->times[e->moment_count - 1] == 1);
    zt_shutter_keys(&s.place_key, &s.frame_key, e, &sampling);
    return s;
}

static shot shoot(const zt_animation *film, int64_t frame) {
    return shoot_with(film, frame, (zt_sampling){.min = 1, .max = 1});
}

/* ---- what there is to be seen ---------------------------------------------------------------
 */

/* A camera as a frame of axes: the picture spans -1 .. 1 in height. */
typedef struct eye {
    vec3 position, right, up, ahead;
} eye;

typedef struct sight {
    eye eye;
    vec3 points[POINTS_MAX];
    int count;
} sight;

static void add_point(sight *s, vec3 p) {
    assert_true(s->count < POINTS_MAX);
    s->points[s->count++] = p;
}

/* Points of a scene's objects, in the world; of its camera, what the lens makes of it. */
static sight see(const zt_scene *scene) {
    sight s = {.count = 0};
    xform axes = zt_camera_xform(&scene->camera);
    double half = tan(scene->camera.fov / 2);
    s.eye = (eye){axes.shift, vec3_scale(axes.x, half), vec3_scale(axes.y, half),
                  vec3_scale(axes.z, -1)};
    xform worlds[16];
    assert_true(scene->object_count <= 16);
    zt_scene_worlds(worlds, scene, (vec3){0, 0, 0});
    for (int32_t i = 0; i < scene->object_count; i++) {
        const zt_object *o = &scene->objects[i];
        if (o->shape == ZT_SHAPE_SPHERE)
            for (int k = 0; k < 6; k++) {
                double r = k % 2 ? o->sphere.radius : -o->sphere.radius;
                vec3 way = {k / 2 == 0 ? r : 0, k / 2 == 1 ? r : 0, k / 2 == 2 ? r : 0};
                add_point(&s, xform_point(&worlds[i], vec3_add(o->sphere.center, way)));
            }
        if (o->shape != ZT_SHAPE_BOX) continue;
        xform own = xform_place(o->box.center, o->box.rotation, vec3_scale(o->box.size, 0.5));
        xform place = xform_mul(&worlds[i], &own);
        for (int k = 0; k < 8; k++) {
            vec3 corner = {k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1};
            add_point(&s, xform_point(&place, corner));
        }
    }
    return s;
}

static vec3 mix(vec3 a, vec3 b, double t) {
    return vec3_add(vec3_scale(a, 1 - t), vec3_scale(b, t));
}

/* All goes straight on from one sight to another one. */
static sight between(const sight *a, const sight *b, double t) {
    sight s = {.count = a->count};
    s.eye = (eye){mix(a->eye.position, b->eye.position, t), mix(a->eye.right, b->eye.right, t),
                  mix(a->eye.up, b->eye.up, t), mix(a->eye.ahead, b->eye.ahead, t)};
    for (int i = 0; i < s.count; i++) s.points[i] = mix(a->points[i], b->points[i], t);
    return s;
}

/* Where a point is in the picture, in pixels from its middle: of right, up and ahead, any
 * three vectors, by Cramer's rule. */
static void project(double pixel[2], const eye *e, vec3 point) {
    vec3 p = vec3_sub(point, e->position);
    double ahead = vec3_dot(vec3_cross(e->right, e->up), p);
    pixel[0] = vec3_dot(vec3_cross(e->up, e->ahead), p) / ahead * HEIGHT / 2;
    pixel[1] = vec3_dot(vec3_cross(e->ahead, e->right), p) / ahead * HEIGHT / 2;
}

/* How far apart the same points are in the picture, at most. */
static double apart(const sight *a, const sight *b) {
    double most = 0;
    for (int i = 0; i < a->count; i++) {
        double p[2], q[2];
        project(p, &a->eye, a->points[i]);
        project(q, &b->eye, b->points[i]);
        most = fmax(most, hypot(p[0] - q[0], p[1] - q[1]));
    }
    return most;
}

/* What the light wing makes of a time: the moments around it. */
static sight exposed(const zt_exposure *exposure, const sight *moments, double fraction) {
    int32_t i = 0;
    if (exposure->moment_count == 1) return moments[0];
    while (i < exposure->moment_count - 2 && exposure->times[i + 1] <= fraction) i++;
    double t = (fraction - exposure->times[i]) / (exposure->times[i + 1] - exposure->times[i]);
    if (exposure->steps[i]) t = t < 0.5 ? 0 : 1;
    return between(&moments[i], &moments[i + 1], t);
}

/* How far in the picture anything is from where it truly is, at most: at each 1/4096 of the
 * opening, and between them. The worst `left_out` times are left out. */
static double dense_error(const zt_animation *film, int64_t frame, const shot *s,
                          int left_out) {
    const zt_exposure *e = &s->exposure;
    const zt_shutter *shutter = &film->film.shutter;
    sight *moments = calloc((size_t)e->moment_count, sizeof *moments);
    assert_non_null(moments);
    for (int32_t i = 0; i < e->moment_count; i++) moments[i] = see(&e->moments[i]);
    double worst[8] = {0};
    assert_true(left_out < 8);
    zt_arena arena = {0};
    for (int k = 0; k <= 2 * ZT_TIME_CELLS; k++) {
        double fraction = k / (2.0 * ZT_TIME_CELLS);
        double time_s = (double)frame / 24 +
                        (shutter->open + fraction * (shutter->close - shutter->open)) / 24;
        zt_scene scene;
        zt_arena_reset(&arena);
        assert_int_equal(zt_animation_freeze(&scene, film, time_s, &arena, deaf), ZT_OK);
        sight truth = see(&scene), shown = exposed(e, moments, fraction);
        double error = apart(&truth, &shown);
        for (int i = 0; i <= left_out; i++)
            if (error > worst[i]) {
                double next = worst[i];
                worst[i] = error;
                error = next;
            }
    }
    zt_arena_free(&arena);
    free(moments);
    return worst[left_out];
}

/* ---- curved motion --------------------------------------------------------------------------
 */

#define WHEEL(turn)                                                                            \
    "objects:\n"                                                                               \
    "  - group:\n"                                                                             \
    "      name: wheel\n"                                                                      \
    "      position: [0, 1, 0]\n"                                                              \
    "      rotation: { curve: linear, after: linear, keys: { 0 s: { axis: [0, 0, 1], angle: "  \
    "0 }, 1 s: { axis: [0, 0, 1], angle: " turn " } } }\n"                                     \
    "      objects:\n"                                                                         \
    "        - box: { center: [0, 0, 0], size: [2, 0.1, 0.1], material: {} }\n"                \
    "        - box: { center: [0, 0, 0], size: [0.1, 2, 0.1], material: {} }\n"

static const struct {
    const char *name, *shutter, *camera, *lines;
    int least, most; /* moments */
    double bound;    /* pixels */
    int left_out;    /* of 8193 times */
} motions[] = {
    /* Straight motion has no error, however fast it is: two moments. */
    {"straight", "360 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.5, center: { curve: linear, keys: { 0 s: [-200, 1, 0], "
     "10 s: [200, 1, 0] } }, material: {} }\n",
     2, 2, 1e-6, 0},
    {"wheel, 10 turns a second", "180 deg", still_camera, WHEEL("3600 deg"), 9, 40, 0.25, 0},
    {"propeller, 60 turns a second", "180 deg", still_camera, WHEEL("21600 deg"), 60, 200, 0.25,
     0},
    /* Looks at both ends, in the middle and at the quarters see it stand still. */
    {"propeller, 48 turns a second", "180 deg", still_camera, WHEEL("17280 deg"), 50, 200, 0.25,
     0},
    {"propeller, 48 turns a second, open", "360 deg", still_camera, WHEEL("17280 deg"), 100,
     300, 0.25, 0},
    {"propeller, 384 turns a second", "180 deg", still_camera, WHEEL("138240 deg"), 400, 1600,
     0.25, 0},
    {"orbit", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.2, center: { orbit: { around: [0, 1, 0], radius: 2, "
     "period: 0.5 s } }, material: {} }\n",
     3, 20, 0.25, 0},
    {"accelerating", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.5, center: { curve: ease-in, keys: { 0: [-2, 1, 0], 1: "
     "[2, 1, 0] } }, material: {} }\n",
     3, 24, 0.25, 0},
    {"camera that turns", "180 deg",
     "position: [0, 1, 6], rotation: { curve: linear, keys: { 0 s: [0, 0, 0], 1 s: [0, 90, 0] "
     "} "
     "}, fov: 40 deg",
     "objects:\n  - sphere: { radius: 0.5, center: [0, 1, 0], material: {} }\n", 2, 9, 0.25, 0},
    {"camera that rolls", "180 deg",
     "position: [0, 1, 6], look_at: [0, 1, 0], roll: { curve: linear, keys: { 0 s: 0, 1 s: 720 "
     "} }, fov: 40 deg",
     "objects:\n  - sphere: { radius: 1, center: [0, 1, 0], material: {} }\n", 3, 33, 0.25, 0},
    {"camera that zooms", "180 deg",
     "position: [0, 1, 6], look_at: [0, 1, 0], fov: { curve: linear, keys: { 0: 60, 1: 20 } }",
     "objects:\n  - sphere: { radius: 1, center: [0, 1, 0], material: {} }\n", 3, 20, 0.25, 0},
    {"camera that orbits", "180 deg",
     "position: { orbit: { around: [0, 1, 0], radius: 6, period: 1 s } }, look_at: [0, 1, 0], "
     "fov: 40 deg",
     "objects:\n  - box: { size: 1, center: [0, 1, 0], material: {} }\n", 3, 20, 0.25, 0},
    /* Value noise of 30 hertz has corners in its second derivative only. */
    {"camera that shakes", "180 deg",
     "position: \"= {0.05 * noise(30 * t), 1 + 0.05 * noise(30 * t + 100), 6}\", rotation: [0, "
     "0, "
     "0], fov: 40 deg",
     "objects:\n  - sphere: { radius: 0.5, center: [0, 1, 0], material: {} }\n", 2, 17, 0.25,
     0},
    {"shaking fast", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.5, center: \"= {0.4 * sin(2 * pi * 480 * t), 1, 0}\", "
     "material: {} }\n",
     100, 600, 0.25, 0},
    {"scale to nearly zero", "180 deg", still_camera,
     "objects:\n  - group:\n      position: [0, 1, 0]\n"
     "      rotation: { curve: linear, keys: { 0: [0, 0, 0], 1: [0, 0, 170] } }\n"
     "      scale: { keys: { 0: 1, 0.01 s: 1e-9, 1: 1 } }\n"
     "      objects:\n"
     "        - box: { center: [0, 0, 0], size: 1, material: {} }\n",
     4, 64, 0.3, 0},
    {"radius", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: \"= abs(sin(2 * pi * 24 * t))\", center: [0, 1, 0], "
     "material: {} }\n",
     9, 64, 0.3, 0},
    /* The bounce at 7 ms is a corner of the way, which no halving meets. */
    {"a key inside", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.5, center: { curve: linear, keys: { 0: [-1, 3, 0], "
     "0.007 "
     "s: [0, 0.5, 0], 1: [1, 3, 0] } }, material: {} }\n",
     3, 6, 0.25, 0},
    {"a loop inside", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.5, center: { curve: linear, after: loop, keys: { 0 s: "
     "[-1, "
     "1, 0], 0.003 s: [1, 1, 0], 0.004 s: [-1, 1, 0] } }, material: {} }\n",
     10, 24, 0.3, 0},
    /* What jumps does so within a part; at the time itself it is at either end. */
    {"a jump inside", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.5, center: { curve: hold, keys: { 0: [-1, 1, 0], 0.007 "
     "s: "
     "[1, 1, 0] } }, material: {} }\n",
     4, 4, 1e-6, 1},
    {"steps", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.5, center: { curve: \"steps(3)\", keys: { 0: [-1, 1, "
     "0], "
     "1: [1, 1, 0] } }, material: {} }\n",
     4, 12, 1e-6, 3},
    /* Both ends are alike, and the pulse is over in a fiftieth of the opening. */
    {"a pulse", "180 deg", still_camera,
     "objects:\n  - sphere: { radius: 0.5, center: { curve: linear, keys: { 0: [0, 1, 0], "
     "0.008 s: "
     "[0, 1, 0], 0.0082 s: [1, 1, 0], 0.0084 s: [0, 1, 0], 1: [0, 1, 0] } }, material: {} }\n",
     5, 12, 0.3, 6},
    {"coarse", "{ angle: 180 deg, error: 4 }", still_camera, WHEEL("3600 deg"), 2, 30, 4, 0},
    {"fine", "{ angle: 180 deg, error: 0.02 }", still_camera, WHEEL("3600 deg"), 60, 600, 0.02,
     0},
    {"before and after the frame", "{ angle: 360 deg, phase: -180 deg }", still_camera,
     WHEEL("720 deg"), 3, 20, 0.25, 0},
};

static void curved_motion(void **state) {
    (void)state;
    bool good = true;
    for (size_t i = 0; i < sizeof motions / sizeof *motions; i++) {
        zt_animation *film = film_with(motions[i].shutter, motions[i].camera, motions[i].lines);
        shot s = shoot(film, 0);
        double error = dense_error(film, 0, &s, motions[i].left_out);
        int count = s.exposure.moment_count;
        bool well = count >= motions[i].least && count <= motions[i].most &&
                    error <= motions[i].bound && s.division.off <= 1;
        if (!well || getenv("ZT_TEST_PRINTS"))
            print_message("%s: %d moments, %.3g px off, said to be %.3g px\n", motions[i].name,
                          count, error, s.division.off * film->film.shutter.error);
        good &= well;
        zt_arena_free(&s.arena);
        zt_animation_free(&film);
    }
    assert_true(good);
}

/* ---- what else may change -------------------------------------------------------------------
 */

/* Colors and intensities that curve, held against the true ones, as shares of the largest. */
static void curved_looks(void **state) {
    (void)state;
    zt_animation *film = film_with(
        "180 deg", still_camera,
        "  - point: { name: lamp, position: [0, 5, 0], intensity: { curve: ease-in-out, "
        "keys: { 0: 0, 1: 400 } } }\n"
        "objects:\n"
        "  - sphere: { radius: 1, center: [0, 1, 0], material: { color: { curve: "
        "ease-in, keys: { 0: [0, 0, 0], 1: [0.2, 0.4, 0.8] } }, reflectivity: \"= 0.5 + "
        "0.5 * sin(150 * t)\" } }\n");
    shot s = shoot(film, 0);
    const zt_exposure *e = &s.exposure;
    if (e->moment_count < 5 || e->moment_count > 100) fail_msg("%d moments", e->moment_count);
    double light = 0, color = 0, mirror = 0;
    int32_t m = 0;
    for (int k = 0; k <= ZT_TIME_CELLS; k++) {
        double f = k / (double)ZT_TIME_CELLS;
        while (m < e->moment_count - 2 && e->times[m + 1] <= f) m++;
        double t = (f - e->times[m]) / (e->times[m + 1] - e->times[m]);
        const zt_scene *a = &e->moments[m], *b = &e->moments[m + 1];
        zt_scene scene;
        assert_int_equal(zt_animation_freeze(&scene, film, f / 48, &s.arena, deaf), ZT_OK);
        double power = a->lights[1].intensity * (1 - t) + b->lights[1].intensity * t;
        light = fmax(light, fabs(power - scene.lights[1].intensity));
        vec3 c = mix(a->materials[0].color, b->materials[0].color, t);
        color = fmax(color, vec3_max_abs(vec3_sub(c, scene.materials[0].color)));
        mirror = fmax(mirror,
                      fabs(a->materials[0].reflectivity * (1 - t) +
                           b->materials[0].reflectivity * t - scene.materials[0].reflectivity));
    }
    const zt_scene *last = &e->moments[e->moment_count - 1];
    assert_true(light < 1.05 * ZT_CHORD_SHARE * last->lights[1].intensity);
    assert_true(color < 1.05 * ZT_CHORD_SHARE * last->materials[0].color.z);
    assert_true(mirror < 1.05 * ZT_CHORD_SHARE);
    zt_arena_free(&s.arena);
    zt_animation_free(&film);
}

/* A switch is thrown within one part of the opening, at its time, and is told by its name. */
static void switches(void **state) {
    (void)state;
    zt_animation *film =
        film_with("180 deg", still_camera,
                  "  - point: { name: lamp, position: [0, 5, 0], shadows: { keys: "
                  "{ 0: true, 0.0071 s: false } } }\n");
    shot s = shoot(film, 0);
    const zt_exposure *e = &s.exposure;
    assert_int_equal(s.division.step_count, 1);
    assert_string_equal(film->tracks[s.division.stepping].name, "lamp.shadows");
    int32_t i = 0;
    while (!e->steps[i]) i++;
    assert_true(e->times[i + 1] - e->times[i] == 1.0 / ZT_TIME_CELLS);
    assert_true(e->times[i] <= 0.0071 * 48 && e->times[i + 1] >= 0.0071 * 48);
    for (int32_t k = 0; k < e->moment_count; k++)
        assert_int_equal(e->moments[k].lights[1].shadows, k <= i);
    zt_arena_free(&s.arena);
    s = shoot(film, 1);
    assert_int_equal(s.exposure.moment_count, 1);
    zt_arena_free(&s.arena);
    zt_animation_free(&film);
}

/* ---- what does not move ---------------------------------------------------------------------
 */

static const char one_second[] = "objects:\n"
                                 "  - sphere: { name: ball, radius: 0.5, center: { curve: "
                                 "linear, keys: { 1 s: [0, 1, 0], 2 s: "
                                 "[4, 1, 0] } }, material: {} }\n";

/* One moment: where there are no tracks, where they rest, where the shutter opens for no time,
 * and where things move less than anyone can see. It is that of the opening's begin. */
static void one_moment(void **state) {
    (void)state;
    const struct {
        const char *shutter, *lines;
        int64_t frame;
        double time_s;
    } cases[] = {
        {"180 deg", "objects:\n  - sphere: { radius: 1, center: [0, 0, 0], material: {} }\n", 7,
         7 / 24.0},
        {"180 deg", one_second, 7, 7 / 24.0},
        {"180 deg", one_second, 100, 100 / 24.0},
        {"0 deg", one_second, 37, 37 / 24.0},
        {"{ angle: 0, phase: 90 deg }", one_second, 37, 37.25 / 24},
        {"180 deg",
         "objects:\n  - sphere: { radius: 1, center: \"= {1e-6 * sin(100 * t), 0, 0}\", "
         "material: "
         "{} }\n",
         7, 7 / 24.0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_animation *film = film_with(cases[i].shutter, still_camera, cases[i].lines);
        shot s = shoot(film, cases[i].frame);
        assert_int_equal(s.exposure.moment_count, 1);
        zt_scene scene;
        assert_int_equal(zt_animation_freeze(&scene, film, cases[i].time_s, &s.arena, deaf),
                         ZT_OK);
        vec3 a = scene.objects[0].sphere.center,
             b = s.exposure.moments[0].objects[0].sphere.center;
        assert_true(vec3_max_abs(vec3_sub(a, b)) < 1e-14);
        zt_arena_free(&s.arena);
        zt_animation_free(&film);
    }
}

/* ---- keys of random numbers -----------------------------------------------------------------
 */

/* The same for frames that show the same, another one for each that does not: so of frames
 * anywhere in a film, in any order, with the shutter open or not. */
static void keys(void **state) {
    (void)state;
    const char *shutters[] = {"0 deg", "180 deg"};
    for (int k = 0; k < 2; k++) {
        zt_animation *film = film_with(shutters[k], still_camera, one_second);
        enum { FRAMES = 60 };
        uint64_t frame_keys[FRAMES], place_keys[FRAMES];
        for (int i = 0; i < FRAMES; i++) {
            int frame = i * 37 % FRAMES;
            shot s = shoot(film, frame);
            frame_keys[frame] = s.frame_key;
            place_keys[frame] = s.place_key;
            zt_arena_free(&s.arena);
        }
        for (int i = 0; i < FRAMES; i++)
            for (int j = 0; j < i; j++) {
                /* At rest until frame 24, and from frame 48 on. */
                bool same = (i <= 24 && j <= 24) || (i >= 48 && j >= 48);
                if (k == 1 && (i == 24 || j == 24)) same = false;
                assert_int_equal(frame_keys[i] == frame_keys[j], same);
                assert_true(place_keys[i] == place_keys[j]); /* the camera stands still */
            }
        zt_animation_free(&film);
    }
}

/* Places in pixels are others where the camera is; noise is another one for anything that is
 * different; the seed changes both; and a fixed seed alone decides. */
static void seeds(void **state) {
    (void)state;
    const char *lines[] = {
        "objects:\n  - sphere: { radius: 1, center: [0, 0, 0], material: { color: red } }\n",
        "objects:\n  - sphere: { radius: 1, center: [0, 0, 1e-9], material: { color: red } }\n",
        "objects:\n  - sphere: { radius: 1, center: [0, 0, 0], material: { color: \"#f01\" } "
        "}\n",
        "objects:\n  - box: { size: 1, center: [0, 0, 0], material: { color: red } }\n",
        "objects:\n  - box: { size: 1, center: [0, 0, 0], rotation: [0, 1, 0], material: { "
        "color: "
        "red } }\n",
        "  - point: { position: [0, 5, 0], radius: 0.1 }\n",
        "  - point: { position: [0, 5, 0], shadows: false, radius: 0.1 }\n"};
    enum { CASES = sizeof lines / sizeof *lines };
    const zt_sampling plain = {.min = 1, .max = 1}, other = {.min = 1, .max = 1, .seed = 1},
                      fixed = {.min = 1, .max = 1, .seed_fixed = true};
    shot of[CASES], far = {0};
    for (int i = 0; i < CASES; i++) {
        zt_animation *film = film_with("0 deg", still_camera, lines[i]);
        shot s = of[i] = shoot_with(film, 0, plain);
        shot seeded = shoot_with(film, 0, other), still = shoot_with(film, 0, fixed);
        assert_true(s.frame_key != seeded.frame_key && s.place_key != seeded.place_key);
        if (i == 0) far = still;
        assert_true(still.frame_key == far.frame_key && still.place_key == far.place_key);
        for (int j = 0; j < i; j++) {
            assert_true(of[j].frame_key != s.frame_key);
            assert_true(of[j].place_key == s.place_key);
        }
        zt_arena_free(&seeded.arena);
        zt_arena_free(&still.arena);
        zt_arena_free(&s.arena);
        zt_animation_free(&film);
    }
    zt_animation *film =
        film_with("0 deg", "position: [0, 1, 7], look_at: [0, 1, 0], fov: 40 deg", lines[0]);
    shot s = shoot(film, 0);
    assert_true(s.place_key != of[0].place_key && s.frame_key != of[0].frame_key);
    zt_arena_free(&s.arena);
    zt_animation_free(&film);
}

/* ---- limits ---------------------------------------------------------------------------------
 */

/* Ten thousand balls that fall straight, each by itself, are looked at a few times; so are as
 * many that fly on smooth curves whose keys fall anywhere. */
static void many_things(void **state) {
    (void)state;
    enum { COUNT = 10000 };
    const char *ways[] = {
        "curve: linear, keys: { %.4f s: [0, 9, 0], 2 s: [%d, 0, 0] }",
        "after: loop, keys: { 0 s: [0, 9, 0], %.4f s: [0, 1, %d], 2 s: [0, 9, 0] "
        "}"};
    for (int k = 0; k < 2; k++) {
        char *lines = malloc(COUNT * 160);
        size_t used = 0;
        used += (size_t)sprintf(lines, "objects:\n");
        for (int i = 0; i < COUNT; i++) {
            used += (size_t)sprintf(lines + used, "  - sphere: { radius: 0.1, center: { ");
            used += (size_t)sprintf(lines + used, ways[k], 1e-4 * (1 + i % 9999), i % 10);
            used += (size_t)sprintf(lines + used, " } }\n");
        }
        static char head[] =
            "zoetrope: 1\nfilm: { size: [640, 360], duration: 2 s, shutter: 180 "
            "deg }\ncamera: { position: [0, 4, 60] }\n";
        char *text = malloc(sizeof head + used + 1);
        sprintf(text, "%s%s", head, lines);
        zt_animation *film = animation_of(text);
        zt_arena arena = {0};
        zt_scene scene;
        double begin_s = zt_clock_s();
        for (int i = 0; i < 8; i++)
            assert_int_equal(zt_animation_freeze(&scene, film, 1, &arena, deaf), ZT_OK);
        double freeze_s = (zt_clock_s() - begin_s) / 8;
        zt_arena_free(&arena);
        shot s = shoot(film, 13);
        zt_arena_reset(&s.arena);
        begin_s = zt_clock_s();
        assert_int_equal(
            zt_shutter_expose(&s.exposure, &s.division, film, 12, HEIGHT, &s.arena, deaf),
            ZT_OK);
        double expose_s = zt_clock_s() - begin_s;
        if (getenv("ZT_TEST_PRINTS"))
            print_message("%d moments in %.1f ms, a scene in %.1f ms\n",
                          s.exposure.moment_count, expose_s * 1e3, freeze_s * 1e3);
        assert_true(s.exposure.moment_count <= 12);
        zt_arena_free(&s.arena);
        zt_animation_free(&film);
        free(lines);
        free(text);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curved_motion), cmocka_unit_test(curved_looks),
        cmocka_unit_test(switches),      cmocka_unit_test(one_moment),
        cmocka_unit_test(keys),          cmocka_unit_test(seeds),
        cmocka_unit_test(many_things),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
