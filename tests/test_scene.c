/* Shows where groups put their members and where cameras look, against hand-made transforms. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "scene/scene.h"

static const double pi = 3.14159265358979323846;

static void assert_vec(vec3 found, vec3 expected) {
    if (vec3_max_abs(vec3_sub(found, expected)) <= 1e-14) return;
    fail_msg("(%.17g, %.17g, %.17g) is not (%.17g, %.17g, %.17g)", found.x, found.y, found.z,
             expected.x, expected.y, expected.z);
}

static void assert_rigid(const xform *m) {
    assert_true(fabs(xform_determinant(m) - 1) < 1e-14);
    assert_true(fabs(vec3_length(m->x) - 1) < 1e-14 && fabs(vec3_length(m->y) - 1) < 1e-14);
    assert_true(fabs(vec3_dot(m->x, m->y)) < 1e-14);
}

static zt_object group(int32_t parent, vec3 position, double angle_z, double scale) {
    return (zt_object){.shape = ZT_SHAPE_GROUP,
                       .parent = parent,
                       .material = -1,
                       .mesh = -1,
                       .placement = {position,
                                     quat_axis_angle((vec3){0, 0, 1}, angle_z),
                                     {scale, scale, scale}}};
}

/* An object's world is that of the groups above it, the innermost first; its own placement, and
 * what stands beside it, do not come in. */
static void groups_within_groups(void **state) {
    (void)state;
    zt_object objects[] = {
        group(-1, (vec3){10, 0, 0}, pi / 2, 1),
        {.shape = ZT_SHAPE_SPHERE, .parent = -1, .mesh = -1, .sphere = {{1, 2, 3}, 4}},
        group(0, (vec3){0, 5, 0}, 0, 2),
        {.shape = ZT_SHAPE_SPHERE, .parent = 2, .mesh = -1, .sphere = {{1, 0, 0}, 1}},
        {.shape = ZT_SHAPE_SPHERE, .parent = 0, .mesh = -1, .sphere = {{1, 0, 0}, 1}},
        group(2, (vec3){7, 7, 7}, 1, 3),
    };
    enum { COUNT = sizeof objects / sizeof *objects };
    zt_scene scene = {.objects = objects, .object_count = COUNT};
    xform worlds[COUNT];
    zt_scene_worlds(worlds, &scene, (vec3){0, 0, 0});
    const vec3 p = {1, 0, 0};
    assert_vec(xform_point(&worlds[0], p), p);
    assert_vec(xform_point(&worlds[1], p), p);
    assert_vec(xform_point(&worlds[2], p), (vec3){10, 1, 0});
    /* Twice as large: (2, 0, 0); moved: (2, 5, 0); turned: (-5, 2, 0); moved: (5, 2, 0). */
    assert_vec(xform_point(&worlds[3], p), (vec3){5, 2, 0});
    assert_vec(xform_point(&worlds[4], p), (vec3){10, 1, 0});
    assert_vec(xform_point(&worlds[5], p), (vec3){5, 2, 0});
}

/* Seen from near by, what stands 1e12 away in groups keeps the digits of its place: adding up
 * in the world first would leave steps of 1e-4. */
static void far_groups_keep_digits(void **state) {
    (void)state;
    zt_object objects[] = {
        group(-1, (vec3){1e12, -1e12, 0}, 0, 1),
        group(0, (vec3){0, 0, 0.1}, pi / 2, 1),
        {.shape = ZT_SHAPE_SPHERE, .parent = 1, .mesh = -1},
        {.shape = ZT_SHAPE_SPHERE, .parent = -1, .mesh = -1},
    };
    enum { COUNT = sizeof objects / sizeof *objects };
    zt_scene scene = {.objects = objects, .object_count = COUNT};
    xform worlds[COUNT];
    zt_scene_worlds(worlds, &scene, (vec3){1e12, -1e12 - 4, 1});
    assert_vec(xform_point(&worlds[2], (vec3){1e-6, 0.2, 0}), (vec3){-0.2, 4 + 1e-6, -0.9});
    assert_vec(xform_point(&worlds[3], (vec3){1e12, -1e12, 0}), (vec3){0, 4, -1});
}

/* Without rotation a camera looks along -z with y up; with one, it turns as any object does. */
static void camera_by_rotation(void **state) {
    (void)state;
    zt_camera camera = {.position = {1, 2, 3}, .rotation = quat_identity()};
    xform m = zt_camera_xform(&camera);
    assert_vec(m.x, (vec3){1, 0, 0});
    assert_vec(m.y, (vec3){0, 1, 0});
    assert_vec(m.z, (vec3){0, 0, 1});
    assert_vec(m.shift, (vec3){1, 2, 3});
    camera.rotation = quat_axis_angle((vec3){0, 1, 0}, pi / 2);
    m = zt_camera_xform(&camera);
    assert_vec(m.z, (vec3){1, 0, 0}); /* the view goes along -x */
    assert_rigid(&m);
}

/* An aimed camera sees its goal in the middle and its up vector upright, whatever their
 * lengths. */
static void camera_by_aim(void **state) {
    (void)state;
    const vec3 ups[] = {{0, 1, 0}, {0, 1e-200, 0}, {0, 1e200, 0}, {0, 3, -2}};
    for (int i = 0; i < 4; i++) {
        zt_camera camera = {
            .position = {5, 0, 5}, .look_at = {5, 0, -1}, .up = ups[i], .aimed = true};
        xform m = zt_camera_xform(&camera);
        assert_vec(m.x, (vec3){1, 0, 0});
        assert_vec(m.y, (vec3){0, 1, 0});
        assert_vec(m.z, (vec3){0, 0, 1});
    }
    zt_camera camera = {
        .position = {4, 3, 2}, .look_at = {-1, 0, 1}, .up = {0, 1, 0}, .aimed = true};
    xform m = zt_camera_xform(&camera);
    assert_rigid(&m);
    assert_vec(m.z, vec3_normalize((vec3){5, 3, 1}));
    assert_true(fabs(m.x.y) < 1e-15 && m.y.y > 0); /* the horizon is level */
}

/* A rolled camera leans to its left: aimed or turned, what was to its upper left stands above.
 * The view itself does not move. */
static void camera_rolled(void **state) {
    (void)state;
    const zt_camera cameras[] = {
        {.position = {5, 0, 5}, .look_at = {5, 0, -1}, .up = {0, 1, 0}, .aimed = true},
        {.position = {5, 0, 5}, .rotation = quat_identity()}};
    for (int i = 0; i < 2; i++) {
        zt_camera camera = cameras[i];
        camera.roll = pi / 6;
        xform m = zt_camera_xform(&camera);
        assert_rigid(&m);
        assert_vec(m.x, (vec3){sqrt(3) / 2, 0.5, 0});
        assert_vec(m.y, (vec3){-0.5, sqrt(3) / 2, 0});
        assert_vec(m.z, (vec3){0, 0, 1});
        assert_vec(m.shift, (vec3){5, 0, 5});
    }
    zt_camera camera = {.rotation = quat_axis_angle((vec3){0, 1, 0}, pi / 2), .roll = pi / 2};
    xform m = zt_camera_xform(&camera); /* looks along -x: its left is z */
    assert_vec(m.y, (vec3){0, 0, 1});
    assert_vec(m.x, (vec3){0, 1, 0});
}

/* Where the aim leaves something open, the axes are still upright on one another and finite. */
static void camera_without_a_way(void **state) {
    (void)state;
    const struct {
        vec3 look_at, up;
    } cases[] = {
        {{0, -9, 0}, {0, 1, 0}}, /* straight down along its own up vector */
        {{0, 9, 0}, {0, 1, 0}},  {{0, 0, 0}, {0, 1, 0}}, /* at itself */
        {{0, 0, -9}, {0, 0, 0}},                         /* no up vector */
        {{0, 0, 0}, {0, 0, 1}},  {{1e300, 1e300, 0}, {1, 1, 1e-300}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_camera camera = {.look_at = cases[i].look_at, .up = cases[i].up, .aimed = true};
        xform m = zt_camera_xform(&camera);
        assert_rigid(&m);
        vec3 back = vec3_normalize(vec3_scale(cases[i].look_at, -1));
        assert_vec(m.z, vec3_max_abs(back) > 0 ? back : (vec3){0, 0, 1});
    }
}

/* Corners come from the origin and the floats together. */
static void mesh_corners(void **state) {
    (void)state;
    const float positions[] = {0, 0, 0, 0.5F, 0, 0, 0, 0.25F, 0, 0, 0, 0.125F};
    const uint32_t triangles[] = {0, 1, 2, 3, 2, 1};
    zt_mesh mesh = {.origin = {1e9, 0, -1},
                    .positions = positions,
                    .triangles = triangles,
                    .vertex_count = 4,
                    .triangle_count = 2};
    assert_vec(zt_mesh_corner(&mesh, 0, 1), (vec3){1e9 + 0.5, 0, -1});
    assert_vec(zt_mesh_corner(&mesh, 1, 0), (vec3){1e9, 0, -0.875});
    assert_vec(zt_mesh_corner(&mesh, 1, 1), (vec3){1e9, 0.25, -1});
}

/* A cube: once around each point within, not around those outside, also close to a side; a
 * third of that where four of the six sides are gone. */
static void test_winding(void **state) {
    (void)state;
    static const float corners[8 * 3 + 1] = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1,
                                             -1, -1, 1,  1, -1, 1,  -1, 1, 1,  1, 1, 1};
    static const uint32_t sides[12 * 3] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6,
                                           0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7,
                                           0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    zt_mesh cube = {.origin = {10, 0, 0},
                    .positions = corners,
                    .triangles = sides,
                    .vertex_count = 8,
                    .triangle_count = 12};
    const vec3 inside[] = {{10, 0, 0}, {10.9999, 0.5, -0.9999}, {9.2, 0.3, 0.1}};
    const vec3 outside[] = {{0, 0, 0}, {11.0001, 0.5, 0}, {10, 0, 1000}, {12, 2, 2}};
    for (int i = 0; i < 3; i++) assert_float_equal(zt_mesh_winding(&cube, inside[i]), 1, 1e-9);
    for (int i = 0; i < 4; i++) assert_float_equal(zt_mesh_winding(&cube, outside[i]), 0, 1e-9);
    cube.triangle_count = 4; /* two opposite sides of six */
    assert_float_equal(zt_mesh_winding(&cube, inside[0]), 2.0 / 6, 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_winding),           cmocka_unit_test(groups_within_groups),
        cmocka_unit_test(far_groups_keep_digits), cmocka_unit_test(camera_by_rotation),
        cmocka_unit_test(camera_by_aim),          cmocka_unit_test(camera_rolled),
        cmocka_unit_test(camera_without_a_way),   cmocka_unit_test(mesh_corners),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
