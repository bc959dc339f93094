/* Shows that advice is given where something is amiss, with its place and the worst of it, and
 * is silent otherwise. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <time.h>

#include <cmocka.h>

#include <zoetrope/explain.h>

#include "small_film.h"
#include "told.h"

static const double pi = 3.14159265358979323846;

/* What is told of a film, which is freed. */
static told advice_on(zt_animation *film) {
    told t = {.file = NULL};
    assert_int_equal(zt_animation_advise(film, told_to(&t)), ZT_OK);
    assert_int_equal(t.error_count + t.note_count, 0);
    zt_animation_free(&film);
    return t;
}

static void assert_says(const told *t, const char *words) {
    if (!strstr(t->lines, words)) fail_msg("\"%s\" is not in:\n%s", words, t->lines);
}

static void assert_silent(const told *t) {
    if (*t->lines) fail_msg("told:\n%s", t->lines);
}

/* A radius that dips below zero between two frames that show it positive: a cubic, so the very
 * bottom is known. Its place is that of the key before. */
static void a_dip_between_frames(void **state) {
    (void)state;
    zt_animation *film = small_film(10, (zt_rate){1, 1});
    const double values[] = {1, 1, 1}, slopes[] = {0, -12, 12};
    zt_key keys[3];
    for (int k = 0; k < 3; k++) keys[k] = key(2 + k, &values[k], ZT_CURVE_HERMITE);
    keys[1].after = &slopes[1]; /* down from 3 s, and up again to 4 s: 1 - 12 u (1 - u) */
    keys[2].before = &slopes[2];
    add_keys(film, "ball.radius", (zt_curve_spec){.key_count = 3, .keys = keys});
    told t = advice_on(film);
    assert_int_equal(t.warning_count, 2); /* the keys are equal, see equal_keys */
    assert_says(&t, "12:7: warning: ball.radius reaches -2 at 3.5 s (frame 3.50)");
    assert_says(&t, "it is kept at 0, the least it can be");
}

/* Extremes are met exactly, however short they are: a dip of a millisecond in a long film. */
static void a_short_dip(void **state) {
    (void)state;
    zt_animation *film = small_film(1000 * 1000, (zt_rate){24, 1});
    const double values[] = {1, 1}, down = -4000, up = 4000;
    zt_key keys[2] = {key(1000.2003, &values[0], ZT_CURVE_HERMITE),
                      key(1000.2013, &values[1], ZT_CURVE_HERMITE)};
    keys[0].after = &down, keys[1].before = &up;
    add_keys(film, "ball.radius", (zt_curve_spec){.key_count = 2, .keys = keys});
    told t = advice_on(film);
    assert_int_equal(t.warning_count, 1); /* 1 - 4 u (1 - u) touches 0 and no more */
    assert_null(strstr(t.lines, "reaches"));

    film = small_film(1000 * 1000, (zt_rate){24, 1});
    const double deeper = -4400, higher = 4400;
    keys[0].after = &deeper, keys[1].before = &higher;
    add_keys(film, "ball.radius", (zt_curve_spec){.key_count = 2, .keys = keys});
    t = advice_on(film);
    assert_int_equal(t.warning_count, 2);
    assert_says(&t, "ball.radius reaches -0.1 at");
}

/* A line that goes on beyond what a number can hold is kept at the largest, and told. */
static void overflow(void **state) {
    (void)state;
    zt_animation *film = small_film(100, (zt_rate){1, 1});
    const double values[] = {0, 1e307};
    zt_key keys[2] = {key(0, &values[0], ZT_CURVE_LINEAR), key(1, &values[1], ZT_CURVE_LINEAR)};
    add_keys(film, "ball.radius",
             (zt_curve_spec){.key_count = 2, .keys = keys, .after = ZT_END_LINEAR});
    told t = advice_on(film);
    assert_int_equal(t.warning_count, 2); /* the camera is inside of such a ball, too */
    assert_says(&t, "ball.radius becomes too large for a number at");
    assert_says(&t, "it is kept at 1.798e+308");
}

/* Movement between two equal keys is told once, at the first of them; ways that stand still
 * there are not, nor are keys that differ. */
static void equal_keys(void **state) {
    (void)state;
    const double times[] = {0, 1, 2, 3}, moves[] = {0, 2, 2, 0}, rests[] = {2, 2, 2, 2};
    zt_animation *film = small_film(72, (zt_rate){24, 1});
    add_simple(film, "ball.radius", ZT_CURVE_TCB, 4, times, moves);
    told t = advice_on(film);
    assert_int_equal(t.warning_count, 1);
    assert_says(&t, "ball.radius moves between this key and the next, which are equal");
    const struct {
        zt_curve_kind kind;
        const double *values;
    } silent[] = {{ZT_CURVE_SMOOTH, moves},
                  {ZT_CURVE_LINEAR, moves},
                  {ZT_CURVE_HOLD, moves},
                  {ZT_CURVE_TCB, rests},
                  {ZT_CURVE_TCB, times}};
    for (size_t i = 0; i < sizeof silent / sizeof *silent; i++) {
        film = small_film(72, (zt_rate){24, 1});
        add_simple(film, "ball.radius", silent[i].kind, 4, times, silent[i].values);
        t = advice_on(film);
        assert_silent(&t);
    }
}

/* Upper bounds, in degrees; springs and eases that overshoot. */
static void overshoot(void **state) {
    (void)state;
    zt_animation *film = small_film(72, (zt_rate){24, 1});
    const double times[] = {0, 1, 2}, fov[] = {60 * pi / 180, 178 * pi / 180, 60 * pi / 180};
    add_simple(film, "camera.fov", ZT_CURVE_CATMULL_ROM, 3, times, fov);
    const double share[] = {0, 1};
    zt_key keys[2] = {key(0, &share[0], ZT_CURVE_LINEAR), key(1, &share[1], ZT_CURVE_LINEAR)};
    zt_spring spring = zt_spring_make(10, 0.2);
    add_keys(film, "clay.reflectivity",
             (zt_curve_spec){.key_count = 2, .keys = keys, .spring = &spring});
    zt_ease back = {.kind = ZT_EASE_BACK, .way = ZT_EASE_IN, .overshoot = 1.70158};
    keys[0].ease = &back;
    add_keys(film, "ball.radius", (zt_curve_spec){.key_count = 2, .keys = keys});
    told t = advice_on(film);
    assert_int_equal(t.warning_count, 2);
    assert_says(&t, "clay.reflectivity reaches 1.52"); /* 1 + exp(-pi 0.2 / sqrt(1 - 0.04)) */
    assert_says(&t, "it is kept at 1, the most it can be");
    assert_says(&t,
                "ball.radius reaches -0.09999 at"); /* a tenth, but for where it is looked at */

    film = small_film(72, (zt_rate){24, 1});
    const double wide = 175 * pi / 180;
    const double slope = 200 * pi / 180, none = 0;
    zt_key steep[2] = {key(0, &wide, ZT_CURVE_HERMITE), key(1, &wide, ZT_CURVE_HERMITE)};
    steep[0].after = &slope, steep[1].before = &none;
    add_keys(film, "camera.fov", (zt_curve_spec){.key_count = 2, .keys = steep});
    t = advice_on(film);
    /* 175 + 200 u (1 - u)^2 is highest at a third */
    assert_says(&t, "camera.fov reaches 204.6 deg at frame 8");
    assert_says(&t, "it is kept at 179.9 deg, the most it can be");
}

/* What stays in its range is not spoken of: smooth curves between sound keys never leave it,
 * nor do values that may be anything. */
static void silence(void **state) {
    (void)state;
    zt_animation *film = small_film(72, (zt_rate){24, 1});
    const double times[] = {0, 0.1, 2}, radius[] = {1, 0, 5},
                 place[] = {-1e6, 0, 0, 1e6, 0, 0, 0, 9, 0};
    add_simple(film, "ball.radius", ZT_CURVE_SMOOTH, 3, times, radius);
    add_simple(film, "lamp.position", ZT_CURVE_CATMULL_ROM, 3, times, place);
    told t = advice_on(film);
    assert_silent(&t);
    t = advice_on(small_film(1, (zt_rate){24, 1}));
    assert_silent(&t);
}

/* The camera passes over what it looks at: between two frames it looks straight along its up.
 */
static void along_up(void **state) {
    (void)state;
    const double times[] = {0, 2};
    for (int i = 0; i < 4; i++) {
        zt_animation *film = small_film(48, (zt_rate){24, 1});
        /* 0: straight over it; 1: passing at some distance; 2: the same, turned from below;
         * 3: a jump to the other side, which is a cut */
        double aside = i == 1 ? 2 : 0, height = i == 2 ? -4 : 4;
        double values[] = {-5.1, height, aside, 5, height, aside};
        add_simple(film, "camera.position", i == 3 ? ZT_CURVE_HOLD : ZT_CURVE_LINEAR, 2, times,
                   values);
        told t = advice_on(film);
        if (i == 1 || i == 3) {
            assert_silent(&t);
            continue;
        }
        assert_int_equal(t.warning_count, 1);
        assert_says(&t, "10:5: warning: the camera looks along its up vector at ");
        assert_says(&t, "(frame 24.");
    }
    zt_animation *film = small_film(48, (zt_rate){24, 1});
    film->rest.camera.look_at = film->rest.camera.position;
    told t = advice_on(film);
    assert_says(&t, "the camera looks at the very point where it is, at frame 0");
    film = small_film(48, (zt_rate){24, 1});
    film->rest.camera.look_at = film->rest.camera.position;
    film->rest.camera.aimed = false; /* it goes by its rotation */
    t = advice_on(film);
    assert_silent(&t);
}

/* Spheres with the camera inside, in groups that are moved, turned and squeezed as well; which
 * one, and from when to when. */
static void inside(void **state) {
    (void)state;
    const double times[] = {0, 4}, ways[] = {0, 0, 20, 0, 0, -20};
    zt_animation *film = small_film(97, (zt_rate){24, 1});
    add_simple(film, "camera.position", ZT_CURVE_LINEAR, 2, times, ways); /* 10 a second */
    film->rest.camera.up = (vec3){1, 0, 0};
    film->rest.camera.look_at = (vec3){0, 100, 0};
    film->rest.objects[BALL].sphere = (zt_sphere){{0, 0, 0}, 4.9};
    film->rest.objects[GROUP].placement =
        (zt_placement){{0, 0, -12.5}, quat_axis_angle((vec3){0, 1, 0}, pi / 2), {0.5, 1, 1}};
    film->rest.objects[INNER].sphere = (zt_sphere){{0, 0, 0}, 5}; /* 2.5 along the world's z */
    told t = advice_on(film);
    assert_int_equal(t.warning_count, 2);
    assert_says(&t, "10:5: warning: the camera is inside of ball from ");
    assert_says(&t, "ball from 1.51042 s (frame 36.25) to 2.48958 s (frame 59.75)");
    assert_says(&t, "inner ball from 3.01042 s (frame 72.25) to 3.48958 s (frame 83.75)");

    film = small_film(97, (zt_rate){24, 1}); /* at rest, and outside; a group without a size */
    film->rest.objects[BALL].sphere = (zt_sphere){{0, 0, 0}, 9.999};
    film->rest.objects[INNER].sphere = (zt_sphere){{0, 0, 0}, 1e9};
    film->rest.objects[GROUP].placement.scale = (vec3){0, 0, 0};
    t = advice_on(film);
    assert_silent(&t);

    film = small_film(97, (zt_rate){24, 1}); /* at rest, and inside */
    film->rest.objects[BALL].sphere = (zt_sphere){film->rest.camera.position, 1};
    t = advice_on(film);
    assert_int_equal(t.warning_count, 1);
    assert_says(&t, "the camera is inside of ball at frame 0");
}

/* A film of a hundred thousand spheres and of a hundred million frames is looked at in a second
 * or so, not in hours. */
static void bounded(void **state) {
    (void)state;
    zt_animation *film = small_film(100 * 1000 * 1000, (zt_rate){24, 1});
    enum { MANY = 100 * 1000 };
    film->rest.objects = ZT_PUSH(&film->arena, zt_object, MANY);
    film->rest.object_count = MANY;
    for (int i = 0; i < MANY; i++) zt_property_rest(&film->rest, ZT_OWNER_SPHERE, i);
    const double times[] = {0, 4e6}, values[] = {1, 2};
    add_simple(film, "lamp.intensity", ZT_CURVE_LINEAR, 2, times, values);
    clock_t begin = clock();
    told t = advice_on(film);
    assert_silent(&t);
    assert_true((double)(clock() - begin) / CLOCKS_PER_SEC < 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_dip_between_frames),
        cmocka_unit_test(a_short_dip),
        cmocka_unit_test(overflow),
        cmocka_unit_test(equal_keys),
        cmocka_unit_test(overshoot),
        cmocka_unit_test(silence),
        cmocka_unit_test(along_up),
        cmocka_unit_test(inside),
        cmocka_unit_test(bounded),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
