/* When a frame is rendered in double precision: each reason has a scene that asks for it, and
 * one just beside it that does not. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "scenes.h"
#include "tracer/kernel.h"

static const double pi = 3.14159265358979323846;
enum { HEIGHT = 540 };

static test_scene s;

/* Wide open (90 degrees), and a material that mirrors nothing. */
static void begin(void) {
    scene_begin(&s);
    scene_material(&s, (vec3){1, 1, 1}, 0);
}

static zt_ready ready_for(zt_precision precision) {
    zt_meshes *meshes;
    zt_arena arena = {0};
    zt_ready ready;
    zt_pixel pixel = {.angle = 2 * tan(s.scene.camera.fov / 2) / HEIGHT};
    zt_exposure exposure = zt_exposure_of(&s.scene);
    assert_int_equal(
        zt_meshes_open(&meshes, s.scene.meshes, s.scene.mesh_count, 1, (zt_listener){0}),
        ZT_OK);
    assert_int_equal(zt_tracer_prepare(&ready, &exposure, precision, pixel, meshes, &arena),
                     ZT_OK);
    zt_arena_free(&arena); /* what is looked at below is not in it */
    zt_meshes_close(&meshes);
    return ready;
}

static zt_accuracy judged(void) {
    zt_ready ready = ready_for(ZT_PRECISION_AUTO);
    bool fine = ready.accuracy.reason == ZT_ACCURACY_FINE;
    assert_int_equal(ready.precision, fine ? ZT_PRECISION_SINGLE : ZT_PRECISION_DOUBLE);
    return ready.accuracy;
}

static void assert_fine(void) { assert_int_equal(judged().reason, ZT_ACCURACY_FINE); }

/* The camera above a ground that is a sphere; other things stand on it. */
static void sphere_ground(double radius, double above) {
    begin();
    scene_sphere(&s, (vec3){0, 0, -3}, .5, 0);
    scene_sphere(&s, (vec3){0, -radius - above, 0}, radius, 0);
}

static void near_what_is_large(void **state) {
    (void)state;
    sphere_ground(1000, 2);
    zt_accuracy a = judged();
    assert_int_equal(a.reason, ZT_ACCURACY_NEAR);
    assert_int_equal(a.object, 1);
    assert_float_equal(a.distance, 2, 1e-9);
    assert_float_equal(a.number, 2002, 1e-9);
    assert_true(a.wrong > a.seen);
    sphere_ground(1000, 20);
    assert_fine();
    sphere_ground(100, 2);
    assert_fine();
    sphere_ground(1e9, 1.7);
    assert_int_equal(judged().reason, ZT_ACCURACY_NEAR);
}

/* A plane goes through the camera's neighborhood however far it reaches: its only number is how
 * far away it is. */
static void near_a_plane(void **state) {
    (void)state;
    begin();
    scene_plane(&s, (vec3){0, 1, 0}, -1e-6, 0);
    assert_fine();
}

static void in_a_narrow_view(void **state) {
    (void)state;
    begin();
    scene_sphere(&s, (vec3){0, 0, -1e6}, 1, 0);
    s.scene.camera.fov = 1 * pi / 180;
    assert_fine();
    s.scene.camera.fov = .1 * pi / 180;
    zt_accuracy a = judged();
    assert_int_equal(a.reason, ZT_ACCURACY_NARROW);
    assert_int_equal(a.object, 0);
    assert_float_equal(a.distance, 1e6 - 1, 1);
}

static void near_a_lamp(void **state) {
    (void)state;
    const double distances[] = {1e-4, 1e-2};
    for (int i = 0; i < 2; i++) {
        begin();
        scene_plane(&s, (vec3){0, 0, 1}, -10, 0);
        scene_ambient(&s, (vec3){1, 1, 1}, 1);
        scene_point_light(&s, (vec3){3, 3, -5}, 1);
        scene_point_light(&s, (vec3){1, 1, -10 + distances[i]}, 1);
        zt_accuracy a = judged();
        if (i > 0) {
            assert_int_equal(a.reason, ZT_ACCURACY_FINE);
            continue;
        }
        assert_int_equal(a.reason, ZT_ACCURACY_LAMP);
        assert_int_equal(a.object, 0);
        assert_int_equal(a.other, 2);
        assert_float_equal(a.distance, 1e-4, 1e-12);
    }
}

/* Two walls, which may look into opposite directions; and two shells. What lies exactly on each
 * other is told apart by its index in either precision. */
static void twins(void **state) {
    (void)state;
    const struct {
        double gap;
        zt_accuracy_reason reason;
    } cases[] = {{0, ZT_ACCURACY_FINE}, {1e-6, ZT_ACCURACY_TWIN}, {1e-4, ZT_ACCURACY_FINE}};
    for (int i = 0; i < 3; i++)
        for (int shape = 0; shape < 3; shape++) {
            double gap = cases[i].gap;
            begin();
            scene_plane(&s, (vec3){1, 0, 0}, -7, 0);
            if (shape == 2) {
                scene_sphere(&s, (vec3){0, 0, -5}, 1, 0);
                scene_sphere(&s, (vec3){0, 0, -5}, 1 + gap, 0);
            } else {
                double side = shape == 0 ? 1 : -1;
                scene_plane(&s, (vec3){0, 0, 1}, -5, 0);
                scene_plane(&s, (vec3){0, 0, side}, side * (-5 - gap), 0);
            }
            zt_accuracy a = judged();
            assert_int_equal(a.reason, cases[i].reason);
            if (a.reason != ZT_ACCURACY_TWIN) continue;
            assert_int_equal(a.object + a.other, 1 + 2);
            assert_float_equal(a.distance, 1e-6, 1e-8);
        }
}

/* What stands on the floor, or nearly. Of a mesh only the bounds are known: nothing may be
 * there.
 */
static void standing(void **state) {
    (void)state;
    static const float positions[] = {0, 0, 0, 1, 2, 0, 0, 2, 1, 0};
    static const uint32_t triangle[] = {0, 1, 2};
    static const zt_mesh mesh = {.positions = positions,
                                 .triangles = triangle,
                                 .vertex_count = 3,
                                 .triangle_count = 1,
                                 .high = {1, 2, 1}};
    const double lifts[] = {0, 1e-6, 1e-3};
    for (int i = 0; i < 3; i++)
        for (int kind = 0; kind < 3; kind++) {
            double low = lifts[i] - 1;
            begin();
            scene_plane(&s, (vec3){0, 1, 0}, -1, 0);
            if (kind == 0) {
                zt_object *o = scene_object(&s, ZT_SHAPE_BOX, 0);
                o->box = (zt_block){{0, low + .5, -5}, {2, 1, 2}, {1, 0, 0, 0}};
            } else if (kind == 1) {
                zt_object *o = scene_object(&s, ZT_SHAPE_CYLINDER, 0);
                o->tube = (zt_tube){{0, low, -5}, {0, low + 1, -5}, 1, 0};
            } else {
                zt_object *o = scene_object(&s, ZT_SHAPE_MESH, 0);
                o->mesh = 0;
                o->placement.position = (vec3){0, low, -5};
                s.scene.meshes = &mesh;
                s.scene.mesh_count = 1;
            }
            bool twin = i == 1 && kind < 2;
            assert_int_equal(judged().reason, twin ? ZT_ACCURACY_TWIN : ZT_ACCURACY_FINE);
        }
}

static void out_of_range(void **state) {
    (void)state;
    const double distances[] = {1e14, 1e16}, radii[] = {1e-14, 1e-16};
    for (int i = 0; i < 2; i++) {
        zt_accuracy_reason reason = i ? ZT_ACCURACY_RANGE : ZT_ACCURACY_FINE;
        begin();
        scene_plane(&s, (vec3){0, 0, 1}, -distances[i], 0);
        zt_accuracy a = judged();
        assert_int_equal(a.reason, reason);
        if (i) assert_true(a.number == 1e16);
        begin();
        scene_sphere(&s, (vec3){0, 0, -5}, radii[i], 0);
        a = judged();
        assert_int_equal(a.reason, reason);
        if (i) assert_true(a.number == 1e-16);
    }
}

static void stretched(void **state) {
    (void)state;
    const double flat[] = {.05, 1e-7};
    for (int i = 0; i < 2; i++) {
        begin();
        zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
        group->placement = (zt_placement){{0, 0, -5}, {1, 0, 0, 0}, {1, flat[i], 1}};
        scene_sphere(&s, (vec3){0, 0, 0}, 1, 0);
        s.objects[1].parent = 0;
        zt_accuracy a = judged();
        assert_int_equal(a.reason, i ? ZT_ACCURACY_STRETCH : ZT_ACCURACY_FINE);
        if (!i) continue;
        assert_int_equal(a.object, 1);
        assert_float_equal(a.number, 1e7, 1);
    }
}

/* A fiftieth flat, a cube's axes stand askew where it is turned within its group: roundings
 * grow by 25 on the way to its own space and back. Where it is not turned they do not. */
static void askew(void **state) {
    (void)state;
    for (int turned = 0; turned < 2; turned++) {
        begin();
        zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
        group->placement = (zt_placement){{0, 0, -5}, {1, 0, 0, 0}, {1, .02, 1}};
        scene_object(&s, ZT_SHAPE_BOX, 0)->box = (zt_block){
            {0, 0, 0}, {1, 1, 1}, quat_axis_angle((vec3){0, 0, 1}, turned ? pi / 4 : 0)};
        s.objects[1].parent = 0;
        zt_accuracy a = judged();
        assert_int_equal(a.reason, turned ? ZT_ACCURACY_STRETCH : ZT_ACCURACY_FINE);
        assert_int_equal(ready_for(ZT_PRECISION_AUTO).precision,
                         turned ? ZT_PRECISION_DOUBLE : ZT_PRECISION_SINGLE);
    }
}

/* A mesh in a group is stretched as solids are. */
static void stretched_mesh(void **state) {
    (void)state;
    static const float positions[] = {0, 0, 0, 1, 2, 0, 0, 2, 1, 0};
    static const uint32_t triangle[] = {0, 1, 2};
    static const zt_mesh mesh = {.positions = positions,
                                 .triangles = triangle,
                                 .vertex_count = 3,
                                 .triangle_count = 1,
                                 .high = {1, 2, 1}};
    const double flat[] = {.05, 1e-4};
    for (int i = 0; i < 2; i++) {
        begin();
        s.scene.meshes = &mesh;
        s.scene.mesh_count = 1;
        zt_object *o = scene_object(&s, ZT_SHAPE_MESH, 0);
        o->mesh = 0;
        o->placement = (zt_placement){{0, 0, -5}, {1, 0, 0, 0}, {1, flat[i], 1}};
        zt_accuracy a = judged();
        assert_int_equal(a.reason, i ? ZT_ACCURACY_STRETCH : ZT_ACCURACY_FINE);
        if (i) assert_float_equal(a.number, 1e4, 1e-3);
    }
}

/* Grains in the distance, which a pixel does not show, may still be met on their far sides
 * where groups stretch them, and cones anywhere; else they need not be told apart, and a
 * sphere never. */
static void thin(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++)
        for (int kind = 0; kind < 4; kind++)
            for (int stretches = 0; stretches < 2; stretches++) {
                double size = i ? 1e-4 : .05, tube = i ? 2e-5 : .01;
                begin();
                scene_object(&s, ZT_SHAPE_GROUP, -1)->placement = (zt_placement){
                    {0, 0, -50}, {1, 0, 0, 0}, {1, stretches && kind < 2 ? 3 : 1, 1}};
                if (kind == 0)
                    scene_object(&s, ZT_SHAPE_BOX, 0)->box =
                        (zt_block){{0, 0, 0}, {size, size, size}, {1, 0, 0, 0}};
                else if (kind == 1)
                    scene_object(&s, ZT_SHAPE_TORUS, 0)->torus =
                        (zt_torus){{0, 0, 0}, {0, 1, 0}, .1, tube};
                else if (kind == 2)
                    scene_object(&s, ZT_SHAPE_CONE, 0)->tube =
                        (zt_tube){{0, 0, 0}, {0, size, 0}, 10 * size, 0};
                else
                    scene_sphere(&s, (vec3){0, 0, 0}, size, 0);
                s.objects[1].parent = 0;
                zt_accuracy a = judged();
                bool asks = i && (kind == 2 || (kind < 2 && stretches));
                assert_int_equal(a.reason, asks ? ZT_ACCURACY_THIN : ZT_ACCURACY_FINE);
                if (!asks) continue;
                assert_float_equal(a.distance, kind == 1 ? 2 * tube : size, 1e-9);
                assert_int_equal(ready_for(ZT_PRECISION_AUTO).beyond.reason, ZT_ACCURACY_FINE);
            }
}

/* Of double precision as well it is told where it is not enough: on a ground of 10^15, for a
 * member as far from its group's origin, and as far from the world's origin; and for numbers
 * that have no squares. */
static void beyond_double(void **state) {
    (void)state;
    const double sizes[] = {1e10, 1e15};
    for (int i = 0; i < 2; i++)
        for (int kind = 0; kind < 4; kind++) {
            double far = sizes[i];
            sphere_ground(kind == 0 ? far : 10, 2);
            if (kind == 1) {
                begin();
                scene_object(&s, ZT_SHAPE_GROUP, -1)->placement =
                    (zt_placement){{-far, 0, -5}, {1, 0, 0, 0}, {1, 1, 1}};
                scene_sphere(&s, (vec3){far, 0, 0}, 1, 0);
                s.objects[1].parent = 0;
            } else if (kind == 2) {
                s.scene.camera.position.x = far;
                for (int k = 0; k < 2; k++) s.objects[k].sphere.center.x = far;
            } else if (kind == 3) {
                scene_plane(&s, (vec3){0, 0, 1}, -pow(far, 3), 0);
            }
            zt_accuracy a = ready_for(ZT_PRECISION_DOUBLE).beyond;
            assert_int_equal(a.reason, !i          ? ZT_ACCURACY_FINE
                                       : kind == 3 ? ZT_ACCURACY_RANGE
                                                   : ZT_ACCURACY_NEAR);
            if (!i || kind == 3) continue;
            assert_float_equal(a.number / far, kind == 0 ? 2 : 1, .001);
        }
}

static void mirrors(void **state) {
    (void)state;
    const struct {
        double reflectivity;
        int32_t depth;
        zt_accuracy_reason reason;
    } cases[] = {
        {.5, 64, ZT_ACCURACY_FINE}, {.5, 65, ZT_ACCURACY_MIRRORS}, {0, 1000, ZT_ACCURACY_FINE}};
    for (int i = 0; i < 3; i++) {
        begin();
        scene_material(&s, (vec3){1, 1, 1}, cases[i].reflectivity);
        scene_plane(&s, (vec3){0, 0, 1}, -5, 1);
        s.scene.reflection_depth = cases[i].depth;
        assert_int_equal(judged().reason, cases[i].reason);
    }
}

/* Within what is around the camera and its lamp: boxes, also turned and in groups that shear,
 * balls, cylinders. */
static void in_a_room(void **state) {
    (void)state;
    uint64_t seed = 1;
    for (int i = 0; i < 200; i++) {
        begin();
        zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
        quat turn =
            quat_axis_angle(test_direction(&seed), i % 4 ? test_between(&seed, 0, 6) : 0);
        group->placement.scale =
            (vec3){test_between(&seed, .8, 1.2), test_between(&seed, .8, 1.2), 1};
        const zt_shape shapes[] = {ZT_SHAPE_BOX, ZT_SHAPE_SPHERE, ZT_SHAPE_CYLINDER};
        zt_object *room = scene_object(&s, shapes[i % 3], 0);
        room->parent = i % 2 - 1;
        if (i % 3 == 0)
            room->box = (zt_block){{0, 0, 0}, {8, 5, 10}, turn};
        else if (i % 3 == 1)
            room->sphere = (zt_sphere){{0, 0, 0}, 4};
        else
            room->tube = (zt_tube){{0, -2, 0}, {0, 3, 0}, 4, 0};
        s.scene.camera.position = vec3_scale(test_direction(&seed), test_between(&seed, 0, 1));
        scene_point_light(&s, vec3_scale(test_direction(&seed), 1), 1);
        assert_fine();
    }
}

/* The camera's own place does not count: what it sees does. */
static void far_from_the_origin(void **state) {
    (void)state;
    begin();
    s.scene.camera.position = (vec3){1e12, 0, 0};
    scene_sphere(&s, (vec3){1e12, 0, -5}, 1, 0);
    assert_fine();
}

/* One who says which precision gets it, and is told where single is not enough. */
static void asked_for(void **state) {
    (void)state;
    sphere_ground(1e6, 2);
    zt_ready single = ready_for(ZT_PRECISION_SINGLE), twice = ready_for(ZT_PRECISION_DOUBLE);
    assert_int_equal(single.precision, ZT_PRECISION_SINGLE);
    assert_int_equal(single.accuracy.reason, ZT_ACCURACY_NEAR);
    assert_int_equal(twice.precision, ZT_PRECISION_DOUBLE);
    sphere_ground(10, 2);
    assert_int_equal(ready_for(ZT_PRECISION_DOUBLE).precision, ZT_PRECISION_DOUBLE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(near_what_is_large),
        cmocka_unit_test(near_a_plane),
        cmocka_unit_test(in_a_narrow_view),
        cmocka_unit_test(near_a_lamp),
        cmocka_unit_test(twins),
        cmocka_unit_test(standing),
        cmocka_unit_test(out_of_range),
        cmocka_unit_test(stretched),
        cmocka_unit_test(askew),
        cmocka_unit_test(stretched_mesh),
        cmocka_unit_test(thin),
        cmocka_unit_test(beyond_double),
        cmocka_unit_test(mirrors),
        cmocka_unit_test(in_a_room),
        cmocka_unit_test(far_from_the_origin),
        cmocka_unit_test(asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
