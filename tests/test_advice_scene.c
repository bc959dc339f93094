/* Shows that lights and shapes which are probably not meant so are told, with the thing, its
 * place and when; and that what is usual is not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include <cmocka.h>

#include <zoetrope/explain.h>

#include "descriptions.h"

#define FILM                                                                                   \
    "zoetrope: 1\nfilm: { duration: 48, rate: 24 }\n"                                          \
    "camera: { position: [0, 0, 20], look_at: [0, 0, 0] }\n"

/* What is told of a description besides what reading it tells, which is nothing. */
static void assert_advice(const char *text, const char *expected) {
    static told t;
    static char whole[8192];
    zt_animation *animation;
    snprintf(whole, sizeof whole, FILM "%s", text);
    if (read_told(&t, &animation, whole) != ZT_OK || *t.lines)
        fail_msg("%s of\n%s", t.lines, whole);
    assert_int_equal(zt_animation_advise(animation, told_to(&t)), ZT_OK);
    if (strcmp(t.lines, expected) != 0)
        fail_msg("%s\ntold is\n%sinstead of\n%s", text, t.lines, expected);
    assert_int_equal(t.foreign_count, 0);
    zt_animation_free(&animation);
}

/* One lamp and one object, in lines 4 and 5. */
static void assert_lamp(const char *lamp, const char *object, const char *expected) {
    char text[2048];
    snprintf(text, sizeof text, "lights: [ point: { name: lamp, %s } ]\nobjects: [ %s ]\n",
             lamp, object);
    assert_advice(text, expected);
}

/* A cube with corners at -1 and 1, its faces as quads. */
static void write_cube(void) {
    static const char ply[] =
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
        "property float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
        "-1 -1 -1 1 -1 -1 -1 1 -1 1 1 -1 -1 -1 1 1 -1 1 -1 1 1 1 1 1\n"
        "4 0 2 3 1 4 4 5 7 6 4 0 1 5 4 4 2 6 7 3 4 0 4 6 2 4 1 3 7 5\n";
    write_bytes("cube.ply", ply, sizeof ply - 1);
}

#define INSIDE(lamp, object)                                                                   \
    "4:11: warning: " lamp " is inside of " object                                             \
    ": none of its light gets out; \"shadows: false\" lets it\n"
#define ON(lamp, object)                                                                       \
    "4:11: warning: " lamp " is on the surface of " object                                     \
    ": its light, which falls off with the distance, is cut there\n"

/* Each solid shuts its lamp in, in groups and meshes as well. */
static void lamps_inside(void **state) {
    (void)state;
    write_cube();
    static const struct {
        const char *object, *expected;
    } cases[] = {
        {"sphere: { center: [0, 0, 0], radius: 1 }", INSIDE("lamp", "sphere 1 at frame 0")},
        {"box: { name: crate, center: [0, 1, 0], size: [1, 1.5, 3] }",
         INSIDE("lamp", "crate at frame 0")},
        {"cylinder: { from: [-2, 0, 0], to: [2, 1, 0], radius: 1 }",
         INSIDE("lamp", "cylinder 1 at frame 0")},
        {"cone: { from: [-2, 0, 0], to: [2, 1, 0], radius: 2 }",
         INSIDE("lamp", "cone 1 at frame 0")},
        {"capsule: { from: [0, 0, 0], to: [2, 1, 0], radius: 2 }",
         INSIDE("lamp", "capsule 1 at frame 0")},
        {"torus: { center: [2, 0.5, 0], radius: 2, tube_radius: 0.75 }",
         INSIDE("lamp", "torus 1 at frame 0")},
        {"mesh: { file: cube.ply, scale: [1, 0.6, 1] }", INSIDE("lamp", "mesh 1 at frame 0")},
        {"group: { position: [5, 0, 0], scale: 2, objects: [ sphere: { center: [-2.5, 0, 0], "
         "radius: 1 } ] }",
         INSIDE("lamp", "sphere 1 at frame 0")},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_lamp("position: [0, 0.5, 0]", cases[i].object, cases[i].expected);
        assert_lamp("position: [0, 0.5, 0], shadows: false", cases[i].object, "");
        assert_lamp("position: [0, 10, 0]", cases[i].object, "");
    }
    assert_lamp("position: [0, 0, 0]", /* what a scale of 0 hides shuts nothing in */
                "group: { scale: [1, 0, 1], objects: [ box: { center: [0, 0, 0], size: 1 } ] }",
                "");
    assert_lamp("position: { curve: linear, keys: { 0: [0, 0, 0], 48: [48, 0, 0] } }",
                "sphere: { center: [12, 0, 0], radius: 2.1 }",
                INSIDE("lamp", "sphere 1 from frame 10 to frame 14"));
}

/* A lamp with a size is shut in where all of it is inside; a ball that fills what it is in, or
 * sticks out of it, is not; and on a surface it has distances enough. */
static void lamps_with_sizes(void **state) {
    (void)state;
    static const char *const ball = "sphere: { center: [0, 0, 0], radius: 1 }";
    assert_lamp("position: [0, 0, 0], radius: 0.9", ball,
                INSIDE("lamp", "sphere 1 at frame 0"));
    assert_lamp("position: [0, 0, 0], radius: 1", ball, "");
    assert_lamp("position: [0, 0.5, 0], radius: 0.6", ball, "");
    assert_lamp("position: [0, 1, 0], radius: 0.1", ball, "");
    assert_lamp("position: [0, 1, 0], radius: 1e-9", ball, ON("lamp", "sphere 1 at frame 0"));
    static const char *const lights[] = {
        "disk_light: { name: lamp, radius: 0.8, position: [0, 0, 0] }",
        "rectangle_light: { name: lamp, width: 0.8, height: 0.1, position: [0, 0, 0] }",
        "disk_light: { name: lamp, radius: 2, position: [0, 0, 0] }",
        "rectangle_light: { name: lamp, width: 2.5, height: 0.1, position: [0, 0, 0] }"};
    for (int i = 0; i < 4; i++) {
        char text[512];
        snprintf(text, sizeof text, "lights: [ %s ]\nobjects: [ %s ]\n", lights[i], ball);
        assert_advice(text, i < 2 ? INSIDE("lamp", "sphere 1 at frame 0") : "");
    }
}

/* A room: what the camera is in as well is no place where light is shut in. */
static void lamps_in_rooms(void **state) {
    (void)state;
    assert_lamp("position: [0, 0, 0]", "box: { name: room, center: [0, 0, 0], size: 100 }",
                "3:9: warning: the camera is inside of room at frame 0\n");
}

static void lamps_on_surfaces(void **state) {
    (void)state;
    write_cube();
    static const struct {
        const char *object, *expected;
    } cases[] = {
        {"plane: { normal: [0, 1, 0], distance: 1 }", ON("lamp", "plane 1 at frame 0")},
        {"plane: { normal: [0, 2, 0], distance: 0.9999991 }", ON("lamp", "plane 1 at frame 0")},
        {"plane: { normal: [0, 1, 0], distance: 1.0000011 }", ""},
        {"disk: { center: [0.5, 1, 0], normal: [0, 3, 0], radius: 1 }",
         ON("lamp", "disk 1 at frame 0")},
        {"disk: { center: [0.5, 1, 0], normal: [0, 3, 0], radius: 0.49 }", ""},
        {"triangle: { vertices: [[-1, 1, -1], [2, 1, -1], [0, 1, 3]] }",
         ON("lamp", "triangle 1 at frame 0")},
        {"sphere: { center: [0, 0, 0], radius: 1 }", ON("lamp", "sphere 1 at frame 0")},
        {"sphere: { center: [0, 0, 0], radius: 0.99999 }", ""},
        {"mesh: { file: cube.ply }", ON("lamp", "mesh 1 at frame 0")},
        {"mesh: { file: cube.ply, position: [0, -0.01, 0] }", ""},
        {"group: { scale: 1e6, objects: [ sphere: { center: [0, 0, 0], radius: 1.0001e-6 } ] }",
         INSIDE("lamp", "sphere 1 at frame 0")},
        {"group: { scale: 1e6, objects: [ sphere: { center: [0, 0, 0], radius: 1e-6 } ] }",
         ON("lamp", "sphere 1 at frame 0")},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_lamp("position: [0, 1, 0]", cases[i].object, cases[i].expected);
}

/* Digits are not lost by being far away. */
static void lamps_far_away(void **state) {
    (void)state;
    assert_lamp("position: [1000000000000, 0.5, 0]",
                "group: { position: [1000000000000, 0, 0], objects: [ sphere: { center: [0, 0, "
                "0], radius: 0.5 } ] }",
                ON("lamp", "sphere 1 at frame 0"));
    assert_lamp("position: [1000000000000, 0.5, 0]",
                "group: { position: [1000000000000, 0, 0], objects: [ sphere: { center: [0, 0, "
                "0], radius: 0.50001 } ] }",
                INSIDE("lamp", "sphere 1 at frame 0"));
}

#define LIGHT "lights: [ ambient: {} ]\n"
#define STRETCHED(number, when)                                                                \
    ", with the groups around it, stretches " number                                           \
    " times as much one way as another at " when "; beyond 1e+06, shapes lose their digits\n"

/* The number is that of the whole composition: a shear of two harmless groups counts, what is
 * within is not told again, and what a scale of 0 hides is not told. */
static void transforms(void **state) {
    (void)state;
    write_cube();
    static const struct {
        const char *objects, *expected;
    } cases[] = {
        {"  - group: { scale: [1, 1e-6, 1], objects: [] }\n", ""},
        {"  - group: { scale: 1e-9, objects: [] }\n", ""},
        {"  - group: { scale: [1, 0, 1], objects: [ group: { rotation: [20, 30, 0], objects: "
         "[] } ] }\n",
         ""},
        {"  - group: { scale: [2, 1, -1e-7], objects: [ mesh: { file: cube.ply, scale: [1, 2, "
         "3] } ] }\n",
         "6:5: warning: group 1" STRETCHED("2e+07", "frame 0")},
        {"  - mesh: { name: sheet, file: cube.ply, rotation: [10, 20, 30], scale: [1, 5e-9, 1] "
         "}\n",
         "6:5: warning: sheet" STRETCHED("2e+08", "frame 0")},
        {"  - group: { name: outer, scale: [1, 1e-4, 1], objects: [ group: { name: inner, "
         "scale: "
         "[1, 1e-4, 1], objects: [] } ] }\n",
         "6:59: warning: inner" STRETCHED("1e+08", "frame 0")},
        {"  - group: { scale: [1, 1e-4, 1], objects: [ group: { scale: [1e-4, 1, 1], objects: "
         "[] "
         "} ] }\n",
         ""},
        {"  - group: { name: g, scale: { curve: linear, keys: { 0: 1, 24: [1, 1, 5e-8], 48: 1 "
         "} } "
         ", objects: [] }\n",
         "6:5: warning: g" STRETCHED("2e+07", "frame 24")},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        snprintf(text, sizeof text, LIGHT "objects:\n%s", cases[i].objects);
        assert_advice(text, cases[i].expected);
    }
}

static void tori_and_tubes(void **state) {
    (void)state;
    assert_advice(
        LIGHT
        "objects:\n"
        "  - torus: { center: [0, 0, 0], radius: 1, tube_radius: 2 }\n"
        "  - torus: { center: [5, 0, 0], radius: 1, tube_radius: 1 }\n"
        "  - torus: { center: [5, 0, 0], radius: 1, tube_radius: { curve: linear, keys: { "
        "0: 0.5, 48: 1.5 } } }\n"
        "  - cylinder: { from: [1, 2, 3], to: [1, 2, 3], radius: 1 }\n"
        "  - cylinder: { from: [1, 2, 3], to: [1, 2, 3], radius: 0 }\n"
        "  - cone: { name: hat, from: [9, 0, 0], to: { curve: linear, keys: { 0: [9, 2, 0], "
        "12: [9, 0, 0], 48: [9, 3, 0] } }, radius: 0, end_radius: 2 }\n"
        "  - capsule: { from: [7, 2, 3], to: [7, 2, 3], radius: 1 }\n",
        "6:5: warning: the tube of torus 1 is as wide as its hole, or wider, at frame 0: it is "
        "kept at 1, the radius\n"
        "8:5: warning: the tube of torus 3 is as wide as its hole, or wider, at frame 24: it "
        "is "
        "kept at 1, the radius\n"
        "9:5: warning: cylinder 1 has no length at frame 0: there is nothing to see\n"
        "11:5: warning: hat has no length at frame 12: there is nothing to see\n");
}

/* The camera within each solid, and beside it. */
static void camera_inside(void **state) {
    (void)state;
    static const char *const solids[][2] = {
        {"box 1", "box: { center: [%d, 0, 20], size: 1, rotation: [0, 0, 40] }"},
        {"cylinder 1", "cylinder: { from: [%d, 0, 19], to: [0, 0, 22], radius: 1 }"},
        {"cone 1", "cone: { from: [%d, 0, 19], to: [0, 0, 22], radius: 1 }"},
        {"capsule 1", "capsule: { from: [%d, 0, 20], to: [9, 9, 20], radius: 1 }"},
        {"torus 1",
         "torus: { center: [%d, 3, 20], axis: [0, 0, 1], radius: 3, tube_radius: 0.1 }"},
    };
    for (size_t i = 0; i < sizeof solids / sizeof *solids; i++)
        for (int beside = 0; beside < 2; beside++) {
            char object[256], text[512], expected[128] = "";
            snprintf(object, sizeof object, solids[i][1], beside ? 8 : 0);
            snprintf(text, sizeof text, LIGHT "objects: [ %s ]\n", object);
            if (!beside)
                snprintf(expected, sizeof expected,
                         "3:9: warning: the camera is inside of %s at frame 0\n", solids[i][0]);
            assert_advice(text, expected);
        }
}

/* Many lamps among many things are looked at in seconds, and at most a hundred are told. */
static void bounded(void **state) {
    (void)state;
    enum { MANY = 1000 };
    static told t;
    static char text[200 * MANY];
    size_t size = (size_t)snprintf(text, sizeof text, FILM "lights:\n");
    for (int i = 0; i < MANY; i++)
        size += (size_t)snprintf(
            text + size, sizeof text - size,
            "  - point: { position: [%d, 0, 0], intensity: \"= 1 + t\" }\n", 3 * i);
    size += (size_t)snprintf(text + size, sizeof text - size, "objects:\n");
    for (int i = 0; i < MANY; i++)
        size += (size_t)snprintf(text + size, sizeof text - size,
                                 "  - sphere: { center: [%d, 0, 0], radius: 1 }\n", 3 * i);
    zt_animation *animation;
    assert_int_equal(read_told(&t, &animation, text), ZT_OK);
    clock_t begin = clock();
    assert_int_equal(zt_animation_advise(animation, told_to(&t)), ZT_OK);
    assert_true((double)(clock() - begin) / CLOCKS_PER_SEC < 20);
    assert_int_equal(t.warning_count, 100);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lamps_inside),   cmocka_unit_test(lamps_with_sizes),
        cmocka_unit_test(lamps_in_rooms), cmocka_unit_test(lamps_on_surfaces),
        cmocka_unit_test(lamps_far_away), cmocka_unit_test(transforms),
        cmocka_unit_test(tori_and_tubes), cmocka_unit_test(camera_inside),
        cmocka_unit_test(bounded),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
