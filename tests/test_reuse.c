/* Tiles that are copied from the frame before: the same bits as rendering, whatever changes in
 * between, in whatever order frames come; and copied where nothing can have changed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "reel.h"
#include "tracer/footprint.h"

static const vec3 white = {1, 1, 1}, red = {1, 0.1, 0.1};

/* A floor and a wall at its end, a lamp above; things come on it. */
static void room(test_scene *s) {
    scene_begin(s);
    int32_t grey = scene_material(s, (vec3){0.5, 0.5, 0.5}, 0);
    scene_plane(s, (vec3){0, 1, 0}, -1, grey);
    scene_plane(s, (vec3){0, 0, 1}, -8, grey);
    scene_ambient(s, white, 0.1);
    scene_point_light(s, (vec3){0, 6, -2}, 20);
}

/* The second frame shows for the first time what can be copied in the third. */
static void warm_up(reel *r, const zt_scene *scene) {
    assert_int_equal(reel_show(r, scene), 0);
    assert_int_equal(reel_show(r, scene), 0);
}

/* A change is seen, and yet most of the picture is copied. */
static void shows_little(reel *r, const zt_scene *scene, int least, int most) {
    static float before[4 * REEL_WIDTH * REEL_HEIGHT];
    memcpy(before, r->image->pixels, sizeof before);
    int64_t copied = reel_show(r, scene);
    assert_memory_not_equal(before, r->image->pixels, sizeof before);
    if (copied < least || copied > most)
        fail_msg("%d tiles are copied, not %d to %d", (int)copied, least, most);
}

/* Nothing changes: all is copied, from the third frame on. */
static void what_holds_still_is_copied(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    room(&s);
    scene_sphere(&s, (vec3){0, 0, -4}, 1, 0);
    reel_open(&r, NULL, 0);
    warm_up(&r, &s.scene);
    assert_int_equal(reel_show(&r, &s.scene), REEL_TILES);
    assert_int_equal(reel_show(&r, &s.scene), REEL_TILES);
    reel_close(&r);
}

/* A small ball moves at the right: it and its shadow are rendered, the left is copied. */
static void what_moves_is_rendered(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    room(&s);
    scene_sphere(&s, (vec3){3, -0.7, -5}, 0.3, 0);
    reel_open(&r, NULL, 0);
    warm_up(&r, &s.scene);
    for (int i = 0; i < 8; i++) {
        s.objects[2].sphere.center.y += 0.1;
        shows_little(&r, &s.scene, 13, 19);
    }
    reel_close(&r);
}

/* Something that is nowhere in the picture, and its shadow is: only shadow rays meet it. */
static void shadows_fall_from_outside(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    room(&s);
    scene_sphere(&s, (vec3){2, 5.2, -3}, 0.2, 0);
    reel_open(&r, NULL, 0);
    warm_up(&r, &s.scene);
    for (int i = 0; i < 8; i++) {
        s.objects[2].sphere.center.x -= 0.15;
        shows_little(&r, &s.scene, 4, 19);
    }
    reel_close(&r);
}

/* What appears behind the camera is seen in a mirror, and there alone. */
static void mirrors_show_what_is_behind(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    room(&s);
    int32_t mirror = scene_material(&s, white, 0.8);
    scene_object(&s, ZT_SHAPE_DISK, mirror)->disk = (zt_disk){{-2, 0.5, -5}, {0, 0, 1}, 1};
    scene_sphere(&s, (vec3){-5.2, 1.3, 3}, 0, 0); /* nothing yet */
    s.lights[1].shadows = false;
    reel_open(&r, NULL, 0);
    warm_up(&r, &s.scene);
    for (int i = 0; i < 4; i++) {
        s.objects[3].sphere.radius += 0.5;
        shows_little(&r, &s.scene, 10, 19);
    }
    reel_close(&r);
}

/* A lamp in a box of its own: only where its light gets out of it something changes. Another
 * one shines everywhere. */
static void lamps_change_what_they_light(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    room(&s);
    /* A tunnel, open towards the camera, and a lamp in it. */
    for (int i = 0; i < 3; i++)
        scene_object(&s, ZT_SHAPE_BOX, 0)->box =
            (zt_block){{i == 0   ? -4.5
                        : i == 1 ? -2.5
                                 : -3.5,
                        i == 2 ? 1 : 0, -7},
                       {i == 2 ? 2.2 : 0.2, i == 2 ? 0.2 : 2, 3},
                       {1, 0, 0, 0}};
    scene_point_light(&s, (vec3){-3.5, 0.5, -7.5}, 3);
    reel_open(&r, NULL, 0);
    warm_up(&r, &s.scene);
    s.lights[2].color = red;
    shows_little(&r, &s.scene, 3, 19);
    s.lights[2].intensity = 0;
    shows_little(&r, &s.scene, 3, 19);
    s.lights[2].intensity = 1; /* where it is dark nobody knows what it will light */
    reel_show(&r, &s.scene);
    s.lights[1].intensity = 10;
    shows_little(&r, &s.scene, 0, 1);
    s.lights[0].intensity = 0.2;
    shows_little(&r, &s.scene, 0, 0);
    reel_close(&r);
}

/* Another colour, pattern or reflectivity changes what shows it. */
static void looks_change_what_shows_them(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    room(&s);
    int32_t own = scene_material(&s, white, 0);
    scene_sphere(&s, (vec3){3, 0, -5}, 0.5, own);
    reel_open(&r, NULL, 0);
    warm_up(&r, &s.scene);
    s.materials[own].color = red;
    shows_little(&r, &s.scene, 14, 19);
    s.materials[own].reflectivity = 0.5;
    shows_little(&r, &s.scene, 14, 19);
    s.materials[own].pattern = ZT_PATTERN_CHECKER;
    s.materials[own].pattern_size = 0.2;
    s.materials[own].other_color = white;
    shows_little(&r, &s.scene, 14, 19);
    s.materials[own].pattern_size = 0.1;
    shows_little(&r, &s.scene, 14, 19);
    reel_close(&r);
}

/* What comes from nothing and goes again, also where the numbers of what follows it change. */
static void things_come_and_go(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    room(&s);
    scene_sphere(&s, (vec3){-3, 0, -5}, 0, 0);
    scene_sphere(&s, (vec3){3, 0, -5}, 0.5, 0);
    reel_open(&r, NULL, 0);
    warm_up(&r, &s.scene);
    for (int i = 0; i < 6; i++) {
        s.objects[2].sphere.radius = i % 2 ? 0 : 0.5;
        shows_little(&r, &s.scene, 8, 19);
    }
    reel_close(&r);
}

/* Many things, faces of which lie on each other, so that the first one counts: one of them
 * moves, and with it the order in which all are asked. */
static void ties_are_settled_as_before(void **state) {
    (void)state;
    static test_scene s;
    uint64_t random = 7;
    reel r;
    room(&s);
    int32_t other = scene_material(&s, red, 0.2);
    for (int i = 0; i < 60; i++) {
        vec3 at = {test_between(&random, -4, 4), -0.75, test_between(&random, -7, -3)};
        scene_object(&s, ZT_SHAPE_BOX, i % 2 ? other : 0)->box =
            (zt_block){at, {0.5 + i % 3, 0.5, 0.5}, {1, 0, 0, 0}};
        if (i % 4 == 0) /* the same once more */
            scene_object(&s, ZT_SHAPE_BOX, other)->box =
                s.objects[s.scene.object_count - 1].box;
        if (i % 5 == 0) scene_sphere(&s, at, 0.4, 0);
    }
    scene_sphere(&s, (vec3){4, 1, -5}, 0.2, other);
    zt_sphere *ball = &s.objects[s.scene.object_count - 1].sphere;
    for (zt_precision precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE;
         precision++) {
        reel_open(&r, NULL, 0);
        r.precision = precision;
        r.sampling.min = r.sampling.max = 4;
        for (int i = 0; i < 12; i++) {
            ball->center.x = 4 - 0.5 * i;
            reel_show(&r, &s.scene);
        }
        assert_true(r.copied > 0);
        reel_close(&r);
    }
}

/* A moving camera copies nothing; it stands again, and so do pictures. Samples that are no
 * numbers are told of each time. */
static void views_and_what_is_left_out(void **state) {
    (void)state;
    static test_scene s;
    reel r;
    room(&s);
    int32_t broken = scene_material(&s, (vec3){INFINITY, 0, 0}, 0);
    scene_sphere(&s, (vec3){-3, 0, -5}, 0.5, broken);
    reel_open(&r, NULL, 0);
    warm_up(&r, &s.scene);
    assert_in_range(reel_show(&r, &s.scene), 10, REEL_TILES - 1);
    assert_true(r.left_out > 0);
    for (int i = 0; i < 4; i++) {
        s.scene.camera.position.x += 0.01;
        assert_int_equal(reel_show(&r, &s.scene), 0);
    }
    assert_int_equal(reel_show(&r, &s.scene), 0);
    assert_in_range(reel_show(&r, &s.scene), 10, REEL_TILES - 1);
    reel_close(&r);
}

/* Random numbers change with the frame: where they are used nothing is copied, but for a fixed
 * seed. */
static void random_numbers_are_the_frames(void **state) {
    (void)state;
    static test_scene s;
    for (int fixed = 0; fixed < 2; fixed++)
        for (int way = 0; way < 2; way++) {
            reel r;
            room(&s);
            scene_sphere(&s, (vec3){3, 0, -5}, 0.3, 0);
            if (way == 0) s.lights[1].radius = 0.5;
            if (way == 1) {
                s.scene.camera.aperture = 0.05;
                s.scene.camera.focus_distance = 5;
            }
            reel_open(&r, NULL, 0);
            r.sampling.min = r.sampling.max = 4;
            r.sampling.seed_fixed = fixed;
            warm_up(&r, &s.scene);
            assert_int_equal(reel_show(&r, &s.scene), REEL_TILES); /* the same frame again */
            s.objects[2].sphere.center.y += 0.1;
            /* What looks past all things sees no lamp. */
            shows_little(&r, &s.scene, fixed ? 8 : 0, fixed ? 19 : 5);
            reel_close(&r);
        }
}

/* A wall of faint checks, dots before it that are smaller than pixels, and a lid on some:
 * at the edges of tiles that are not touched, it depends on the tile beside which pixels go on.
 */
static void show_dots(uint64_t seed, zt_sampling sampling, int64_t *copied) {
    static test_scene s;
    uint64_t random = seed;
    reel r;
    scene_begin(&s);
    s.scene.camera.lens = ZT_LENS_ORTHOGRAPHIC;
    s.scene.camera.height = REEL_HEIGHT; /* a pixel is one wide */
    int32_t wall = scene_material(&s, (vec3){0.5, 0.5, 0.5}, 0),
            dark = scene_material(&s, red, 0);
    s.materials[wall].pattern = sampling.edges ? ZT_PATTERN_NONE : ZT_PATTERN_CHECKER;
    s.materials[wall].other_color = (vec3){0.53, 0.53, 0.53};
    s.materials[wall].pattern_size = 0.31;
    scene_plane(&s, (vec3){0, 0, 1}, -20, wall);
    scene_ambient(&s, white, 0.5);
    scene_point_light(&s, (vec3){0, 0, 300}, 5e4)->shadows = sampling.edges;
    zt_block *lid = &scene_object(&s, ZT_SHAPE_BOX, dark)->box;
    for (int i = 0; i < 300; i++) {
        vec3 at = {test_between(&random, -40, 40), test_between(&random, -32, 32),
                   sampling.edges ? 5 : -15};
        scene_sphere(&s, at, test_between(&random, 0.1, 0.6), dark);
    }
    reel_open(&r, NULL, 0);
    r.sampling = sampling;
    for (int i = 0; i < 12; i++) {
        double right = -40.2 + 16 * floor(test_between(&random, 1, 5)); /* within a tile */
        *lid = (zt_block){
            {right - 4, test_between(&random, -20, 20), -19.9}, {8, 24, 0.1}, {1, 0, 0, 0}};
        reel_show(&r, &s.scene);
    }
    *copied += r.copied;
    reel_close(&r);
}

static void decisions_go_beyond_tiles(void **state) {
    (void)state;
    int64_t copied = 0;
    for (uint64_t seed = 1; seed <= 4; seed++) {
        show_dots(seed, (zt_sampling){.min = 4, .max = 64, .error = 0.012}, &copied);
        show_dots(seed, (zt_sampling){.min = 1, .max = 16, .error = 0.02, .edges = true},
                  &copied);
    }
    assert_true(copied > 4 * 2 * 12 * REEL_TILES / 8);
}

static float any(uint32_t *state, float least, float most) {
    *state = *state * 1664525 + 1013904223;
    return least + (most - least) * (float)(*state >> 8) / 0x1p24F;
}

static zt_bvh_box any_box(uint32_t *state, float reach, float side) {
    zt_bvh_box box;
    for (int i = 0; i < 3; i++) {
        box.low[i] = any(state, -reach, reach);
        box.high[i] = box.low[i] + any(state, 0, side);
    }
    return box;
}

static vec3 any_point(uint32_t *state, const zt_bvh_box *box) {
    return (vec3){(double)any(state, box->low[0], box->high[0]),
                  (double)any(state, box->low[1], box->high[1]),
                  (double)any(state, box->low[2], box->high[2])};
}

/* How near a straight way comes to a place. */
static double distance_to(vec3 from, vec3 to, vec3 place) {
    vec3 way = vec3_sub(to, from), aside = vec3_sub(place, from);
    double share = vec3_dot(aside, way) / vec3_dot(way, way);
    share = share > 0 ? share < 1 ? share : 1 : 0;
    return vec3_length(vec3_sub(aside, vec3_scale(way, share)));
}

/* A ball is passed by where its box is not; and never where some way meets it. */
static void balls_are_less_than_boxes(void **state) {
    (void)state;
    uint32_t random = 1;
    int passed = 0, passed_as_box = 0;
    for (int i = 0; i < 20000; i++) {
        zt_footprint f = {.steps = {{.there = true, .ends = true}}};
        zt_footstep *step = &f.steps[0];
        step->origins = any_box(&random, 4, 0.3F);
        step->points = any_box(&random, 4, 1);
        for (int k = 0; k < 3; k++) {
            step->directions.low[k] = -1;
            step->directions.high[k] = 1;
        }
        zt_difference_place place = {any_box(&random, 2, 0), true, true};
        float radius = any(&random, 0.1F, 1.5F);
        for (int k = 0; k < 3; k++) place.box.high[k] = place.box.low[k] + 2 * radius;
        vec3 middle = {(double)(place.box.low[0] + radius), (double)(place.box.low[1] + radius),
                       (double)(place.box.low[2] + radius)};
        const zt_outline nothing = {0};
        zt_differences d = {.places = &place, .place_count = 1, .stretch = 1, .now = &nothing};
        bool touched = zt_footprint_touched(&f, &d);
        for (int k = 0; k < 64 && !touched; k++)
            assert_true(distance_to(any_point(&random, &step->origins),
                                    any_point(&random, &step->points),
                                    middle) > (double)radius * (1 - 1e-6));
        passed += !touched;
        place.round = false;
        passed_as_box += !zt_footprint_touched(&f, &d);
    }
    assert_in_range(passed_as_box, 1000, 20000);
    assert_in_range(passed - passed_as_box, 500, 20000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls_are_less_than_boxes),
        cmocka_unit_test(what_holds_still_is_copied),
        cmocka_unit_test(what_moves_is_rendered),
        cmocka_unit_test(shadows_fall_from_outside),
        cmocka_unit_test(mirrors_show_what_is_behind),
        cmocka_unit_test(lamps_change_what_they_light),
        cmocka_unit_test(looks_change_what_shows_them),
        cmocka_unit_test(things_come_and_go),
        cmocka_unit_test(ties_are_settled_as_before),
        cmocka_unit_test(views_and_what_is_left_out),
        cmocka_unit_test(random_numbers_are_the_frames),
        cmocka_unit_test(decisions_go_beyond_tiles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
