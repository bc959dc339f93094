/* Shows what shapes, patterns and meshes are where a description does not say, that models give
 * what their objects ask for and no more, and where the things of each shape are. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"

static const zt_listener deaf;

static void assert_vec(vec3 found, double x, double y, double z) {
    if (vec3_max_abs(vec3_sub(found, (vec3){x, y, z})) <= 1e-12) return;
    fail_msg("(%.17g, %.17g, %.17g) is not (%g, %g, %g)", found.x, found.y, found.z, x, y, z);
}

/* The scene of a moment, in an arena. */
static zt_scene scene_at(const zt_animation *animation, zt_arena *arena, double time_s) {
    zt_scene scene;
    assert_int_equal(zt_animation_freeze(&scene, animation, time_s, arena, deaf), ZT_OK);
    return scene;
}

static void shapes_at_rest(void **state) {
    (void)state;
    zt_animation *animation =
        animation_of(HEAD "objects:\n"
                          "  - disk: { center: [1, 2, 3], normal: [0, 0, 2], radius: 4 }\n"
                          "  - box: { center: [1, 2, 3], size: 2 }\n"
                          "  - cylinder: { from: [1, 2, 3], to: [4, 5, 6], radius: 7 }\n"
                          "  - cone: { from: [1, 2, 3], to: [4, 5, 6], radius: 7 }\n"
                          "  - torus: { center: [1, 2, 3], radius: 4, tube_radius: 5 }\n"
                          "  - capsule: { from: [1, 2, 3], to: [4, 5, 6], radius: 7 }\n");
    static const zt_shape shapes[] = {ZT_SHAPE_DISK, ZT_SHAPE_BOX,   ZT_SHAPE_CYLINDER,
                                      ZT_SHAPE_CONE, ZT_SHAPE_TORUS, ZT_SHAPE_CAPSULE};
    const zt_scene *rest = &animation->rest;
    assert_int_equal(rest->object_count, 6);
    for (int i = 0; i < 6; i++) {
        const zt_object *object = &rest->objects[i];
        assert_int_equal(object->shape, shapes[i]);
        assert_int_equal(object->parent, -1);
        assert_int_equal(object->mesh, -1);
        assert_int_equal(object->material, 0); /* white */
        assert_false(object->smooth || object->vertex_colors);
        assert_vec(object->tube.from, 1, 2, 3); /* or the center: all begin with it */
    }
    assert_vec(rest->objects[0].disk.normal, 0, 0, 2);
    assert_vec(rest->objects[1].box.size, 2, 2, 2);
    assert_true(rest->objects[1].box.rotation.w == 1);
    assert_vec(rest->objects[2].tube.to, 4, 5, 6);
    assert_true(rest->objects[3].tube.radius == 7 && rest->objects[3].tube.end_radius == 0);
    assert_vec(rest->objects[4].torus.axis, 0, 1, 0);
    assert_true(rest->objects[4].torus.tube_radius == 5); /* as written; freezing keeps it */
    assert_true(rest->objects[5].tube.radius == 7);
    zt_animation_free(&animation);
}

/* All of a pattern's numbers may move; its kind is a word, also one that --set says. */
static void patterns(void **state) {
    (void)state;
    static const char text[] =
        HEAD "materials:\n"
             "  plain: {}\n"
             "  floor: { color: white, pattern: checker, other_color: [0.5, 0.25, 0] }\n"
             "  wall:\n"
             "    pattern: stripes\n"
             "    other_color: { curve: linear, keys: { 0 s: [0, 0, 0], 1 s: [1, 0.5, 0] } }\n"
             "    pattern_size: \"= 2 + t\"\n"
             "    pattern_direction: { orbit: { around: [0, 0, 0], radius: 1, period: 1 s } }\n"
             "objects: [ plane: { normal: [0, 1, 0], material: floor } ]\n";
    zt_animation *animation = animation_of(text);
    zt_arena arena = {0};
    zt_scene scene = scene_at(animation, &arena, 0.5);
    assert_int_equal(scene.materials[0].pattern, ZT_PATTERN_NONE);
    assert_int_equal(scene.materials[1].pattern, ZT_PATTERN_CHECKER);
    assert_vec(scene.materials[1].other_color, 0.5, 0.25, 0);
    assert_true(scene.materials[1].pattern_size == 1);
    assert_int_equal(scene.materials[2].pattern, ZT_PATTERN_STRIPES);
    assert_vec(scene.materials[2].color, 1, 1, 1);
    assert_vec(scene.materials[2].other_color, 0.5, 0.25, 0);
    assert_true(scene.materials[2].pattern_size == 2.5);
    assert_vec(scene.materials[2].pattern_direction, -1, 0, 0);
    zt_animation_free(&animation);
    zt_arena_free(&arena);
    const zt_override overrides[] = {{"floor.pattern", "stripes"}, {"floor.pattern_size", "3"}};
    assert_int_equal(zt_animation_read(&animation, "film.yaml", overrides, 2, deaf), ZT_OK);
    assert_int_equal(animation->rest.materials[1].pattern, ZT_PATTERN_STRIPES);
    assert_true(animation->rest.materials[1].pattern_size == 3);
    assert_vec(animation->rest.materials[1].pattern_direction, 1, 0, 0);
    zt_animation_free(&animation);
}

/* What has no effect is told. */
static void idle_keys(void **state) {
    (void)state;
    static told t;
    zt_animation *animation;
    static const char text[] =
        HEAD "lights: [ ambient: {} ]\nmaterials:\n"
             "  one: { other_color: black, pattern_size: 2, pattern_direction: [0, 1, 0] }\n"
             "  two: { pattern: none, pattern_size: 2 }\n"
             "  three: { pattern: checker, pattern_direction: [0, 1, 0], pattern_size: 2 }\n"
             "  four: { pattern: stripes, pattern_direction: [0, 1, 0], pattern_size: 2 }\n"
             "objects: [ plane: { normal: [0, 1, 0] } ]\n";
    assert_int_equal(read_told(&t, &animation, text), ZT_OK);
    assert_string_equal(
        t.lines,
        "6:23: warning: \"other_color\" does nothing without \"pattern: checker\"\n"
        "6:44: warning: \"pattern_size\" does nothing without \"pattern: checker\"\n"
        "6:66: warning: \"pattern_direction\" does nothing without \"pattern: stripes\"\n"
        "7:39: warning: \"pattern_size\" does nothing without \"pattern: checker\"\n"
        "8:49: warning: \"pattern_direction\" does nothing without \"pattern: stripes\"\n");
    zt_animation_free(&animation);
}

/* ---- meshes ---------------------------------------------------------------------------------
 */

/* A triangle whose normals lean, in colors. */
static void write_rich_model(const char *path) {
    static const char ply[] =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n"
        "0 0 0 0 3 4 255 0 0\n1 0 0 0 3 4 0 255 0\n0 1 0 0 3 4 0 0 255\n3 0 1 2\n";
    write_bytes(path, ply, sizeof ply - 1);
}

/* Reads meshes, one a line, and tells what became of them. */
static zt_animation *meshes_of(const char *objects) {
    static char text[2048];
    write_model("poor.ply");
    write_rich_model("rich.ply");
    snprintf(text, sizeof text, HEAD "lights: [ ambient: {} ]\nobjects:\n%s", objects);
    return animation_of(text);
}

/* Smooth where the file says how, unless an object says otherwise; colors on demand. What no
 * object of a file wants is not kept. */
static void what_meshes_show(void **state) {
    (void)state;
    static const struct {
        const char *objects;
        bool smooth, colored, normals, colors;
    } cases[] = {
        {"  - mesh: { file: rich.ply }\n", true, false, true, false},
        {"  - mesh: { file: rich.ply, smooth: no }\n", false, false, false, false},
        {"  - mesh: { file: rich.ply, smooth: yes, vertex_colors: yes }\n", true, true, true,
         true},
        {"  - mesh: { file: rich.ply, smooth: no, vertex_colors: no }\n", false, false, false,
         false},
        {"  - mesh: { file: rich.ply, smooth: no, vertex_colors: true }\n", false, true, false,
         true},
        {"  - mesh: { file: rich.ply, smooth: { keys: { 0 s: no, 0.5 s: yes } } }\n", false,
         false, true, false},
        {"  - mesh: { file: rich.ply, vertex_colors: \"= t > 0.5\" }\n", true, false, true,
         true},
        {"  - mesh: { file: poor.ply }\n", false, false, false, false},
        {"  - mesh: { file: poor.ply, smooth: yes }\n", true, false, true, false},
        {"  - mesh: { file: poor.ply, smooth: no }\n", false, false, false, false},
        {"  - mesh: { file: poor.ply, smooth: \"= t > 0.5\" }\n", false, false, true, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_animation *animation = meshes_of(cases[i].objects);
        const zt_object *object = &animation->rest.objects[0];
        const zt_mesh *mesh = &animation->rest.meshes[object->mesh];
        if (object->smooth != cases[i].smooth || object->vertex_colors != cases[i].colored ||
            !mesh->normals == cases[i].normals || !mesh->colors == cases[i].colors)
            fail_msg("%s: %d %d %d %d", cases[i].objects, object->smooth, object->vertex_colors,
                     mesh->normals != NULL, mesh->colors != NULL);
        zt_animation_free(&animation);
    }
}

/* Objects share a file's model, each with its own way to show it; a file that is smoothed for
 * one of them is not smooth for those that leave it to the file. */
static void models_are_shared(void **state) {
    (void)state;
    zt_animation *animation = meshes_of("  - mesh: { file: rich.ply, smooth: no }\n"
                                        "  - mesh: { file: poor.ply }\n"
                                        "  - group:\n"
                                        "      objects:\n"
                                        "        - mesh: { file: rich.ply }\n"
                                        "        - mesh: { file: poor.ply, smooth: yes }\n"
                                        "  - mesh: { file: rich.ply, vertex_colors: yes }\n");
    const zt_scene *rest = &animation->rest;
    static const int models[] = {0, 1, -1, 0, 1, 0};
    static const bool smooth[] = {false, false, false, true, true, true};
    assert_int_equal(rest->mesh_count, 2);
    for (int i = 0; i < 6; i++) {
        assert_int_equal(rest->objects[i].mesh, models[i]);
        assert_int_equal(rest->objects[i].smooth, smooth[i]);
        assert_int_equal(rest->objects[i].vertex_colors, i == 5);
    }
    const float *n = rest->meshes[0].normals, *up = rest->meshes[1].normals;
    assert_true(n[0] == 0 && n[1] == 0.6f && n[2] == 0.8f);
    assert_true(up[0] == 0 && up[1] == 0 && up[2] == 1);
    assert_non_null(rest->meshes[0].colors);
    assert_null(rest->meshes[1].colors);
    assert_true(rest->meshes[0].colors[4] == 1);
    zt_animation_free(&animation);
}

/* Colors that are not there are told where they are asked for. */
static void absent_colors(void **state) {
    (void)state;
    static told t;
    zt_animation *animation;
    write_model("poor.ply");
    assert_int_equal(read_told(&t, &animation,
                               HEAD "lights: [ ambient: {} ]\nobjects:\n"
                                    "  - mesh: { file: poor.ply, vertex_colors: no }\n"
                                    "  - mesh: { file: poor.ply, vertex_colors: yes }\n"),
                     ZT_OK);
    assert_string_equal(t.lines, "7:44: warning: the model gives its vertices no colors\n");
    zt_animation_free(&animation);
}

/* ---- places ---------------------------------------------------------------------------------
 */

/* Each thing is at its center, or in the middle of its way, wherever that moves: also where the
 * far end is driven by what comes later. */
static void places_by_name(void **state) {
    (void)state;
    static const struct {
        const char *thing;
        double at0[3], at1[3];
    } cases[] = {
        {"disk: { name: it, center: { curve: linear, keys: { 0 s: [1, 0, 0], 1 s: [3, 0, 0] } "
         "}, "
         "normal: [0, 1, 0], radius: 1 }",
         {1, 0, 0},
         {3, 0, 0}},
        {"box: { name: it, center: [1, 2, 3], size: 4 }", {1, 2, 3}, {1, 2, 3}},
        {"torus: { name: it, center: [1, 2, 3], radius: 4, tube_radius: 1 }",
         {1, 2, 3},
         {1, 2, 3}},
        {"cylinder: { name: it, from: [1, 2, 3], to: [3, 6, 3], radius: 1 }",
         {2, 4, 3},
         {2, 4, 3}},
        {"cone: { name: it, from: { curve: linear, keys: { 0 s: [0, 0, 0], 1 s: [0, 2, 0] } }, "
         "to: [0, 8, 0], radius: 1 }",
         {0, 4, 0},
         {0, 5, 0}},
        {"capsule: { name: it, from: [0, 0, 0], to: { offset: { from: later.center, by: [0, 2, "
         "0] } }, radius: 1 }",
         {5, 1, 0},
         {6, 1, 0}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        snprintf(
            text, sizeof text,
            "zoetrope: 1\nfilm: { duration: 4 s }\ncamera: { look_at: it }\nobjects:\n"
            "  - sphere: { name: moon, radius: 1, center: { orbit: { around: it, radius: 2, "
            "period: 4 s } } }\n"
            "  - %s\n"
            "  - sphere: { name: later, radius: 1, center: { curve: linear, keys: { 0 s: "
            "[10, 0, 0], 1 s: [12, 0, 0] } } }\n",
            cases[i].thing);
        zt_animation *animation = animation_of(text);
        zt_arena arena = {0};
        for (int t = 0; t < 2; t++) {
            const double *at = t ? cases[i].at1 : cases[i].at0;
            zt_scene scene = scene_at(animation, &arena, t);
            assert_vec(scene.camera.look_at, at[0], at[1], at[2]);
            vec3 moon = scene.objects[0].sphere.center;
            assert_vec(moon, at[0] + (t ? 0 : 2), at[1], at[2] - (t ? 2 : 0));
        }
        zt_animation_free(&animation);
        zt_arena_free(&arena);
    }
}

/* A box turns to look at things, and ahead on its path. */
static void boxes_turn(void **state) {
    (void)state;
    zt_animation *animation = animation_of(
        "zoetrope: 1\nfilm: { duration: 4 s }\ncamera: {}\nobjects:\n"
        "  - box: { name: eye, center: [0, 0, 0], size: 1, rotation: { look_at: cart } }\n"
        "  - box: { name: cart, size: [1, 1, 2], center: { follow: { path: [[4, 0, 0], [8, 0, "
        "0]], orient: true } } }\n");
    zt_arena arena = {0};
    zt_scene scene = scene_at(animation, &arena, 1);
    for (int i = 0; i < 2; i++) {
        xform m = xform_place((vec3){0, 0, 0}, scene.objects[i].box.rotation, (vec3){1, 1, 1});
        assert_vec(m.z, -1, 0, 0);
        assert_vec(m.y, 0, 1, 0);
    }
    assert_vec(scene.objects[1].box.center, 5, 0, 0);
    zt_animation_free(&animation);
    zt_arena_free(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_at_rest),    cmocka_unit_test(patterns),
        cmocka_unit_test(idle_keys),         cmocka_unit_test(what_meshes_show),
        cmocka_unit_test(models_are_shared), cmocka_unit_test(absent_colors),
        cmocka_unit_test(places_by_name),    cmocka_unit_test(boxes_turn),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
