/* Shows that what is set from outside counts as if it stood in the text, and that mistakes in
 * it are told where they are. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"

static const char film[] = "zoetrope: 1\n"
                           "film: { duration: 4 s, rate: 24 }\n"
                           "camera: { position: [0, 0, 5] }\n"
                           "variables: { big: 2, all: [1, 1, $big] }\n"
                           "materials: { clay: { color: red } }\n"
                           "lights:\n"
                           "  - ambient: {}\n"
                           "  - point: { name: key.light, position: [0, 0, 0] }\n"
                           "objects:\n"
                           "  - sphere: { name: ball, center: $all, radius: $big }\n"
                           "  - sphere: { center: [0, 0, 0], radius: 1, material: clay }\n"
                           "  - group:\n"
                           "      objects: [ sphere: { center: [0, 0, 0], radius: 1,\n"
                           "                           material: { reflectivity: 1 } } ]\n";

static zt_status read_with(told *t, zt_animation **animation, const zt_override *overrides,
                           int count) {
    write_bytes("film.yaml", film, sizeof film - 1);
    *t = (told){0};
    return zt_animation_read(animation, "film.yaml", overrides, count, told_to(t));
}

static zt_animation *animation_with(const zt_override *overrides, int count) {
    static told t;
    zt_animation *animation;
    if (read_with(&t, &animation, overrides, count) != ZT_OK)
        fail_msg("%s=%s: %s", overrides->name, overrides->value, t.lines);
    assert_string_equal(t.lines, "");
    return animation;
}

/* Whatever has a name: what stands in the text and what does not, constants and keys, of things
 * with a name and without one. */
static void everything(void **state) {
    (void)state;
    const zt_override overrides[] = {
        {"ball.radius", "40"},
        {"sphere 2.center", "[1, 2, 3]"},
        {"sphere 3.radius", "0.5"},
        {"key.light.intensity", "{ curve: linear, keys: { 0 s: 1, 1 s: 2 } }"},
        {"ambient 1.color", "#0f0"},
        {"clay.reflectivity", "0.5"},
        {"material 2.color", "blue"},
        {"camera.fov", "60 deg"},
        {"film.duration", "24"},
        {"film.size", "[64, 36]"},
        {"group 1.scale", "3"},
        {"ball.material", "clay"},
    };
    zt_animation *animation = animation_with(overrides, sizeof overrides / sizeof *overrides);
    const zt_scene *rest = &animation->rest;
    const zt_object *o = rest->objects;
    assert_true(o[0].sphere.radius == 40);
    assert_true(o[1].sphere.center.y == 2);
    assert_true(o[2].placement.scale.z == 3);
    assert_true(o[3].sphere.radius == 0.5);
    assert_true(rest->lights[0].color.x == 0 && rest->lights[0].color.y == 1);
    assert_true(rest->materials[o[0].material].reflectivity == 0.5);
    assert_true(rest->materials[o[0].material].color.x == 1);
    assert_true(rest->materials[o[3].material].color.z == 1);
    assert_true(rest->materials[o[3].material].reflectivity == 1);
    assert_true(fabs(rest->camera.fov - 1.0471975511965976) < 1e-15);
    assert_int_equal(zt_animation_film(animation)->frame_count, 24);
    assert_int_equal(zt_animation_film(animation)->width, 64);
    assert_int_equal(animation->track_count, 1);
    assert_string_equal(animation->tracks[0].name, "key.light.intensity");
    assert_string_equal(animation->tracks[0].place.file, "--set");
    assert_int_equal(animation->tracks[0].place.column, 21);
    assert_memory_equal(animation->tracks[0].key_places[1].source_line, "key.light.intensity={",
                        21);
    assert_int_equal(animation->tracks[0].key_places[1].column, 54);
    zt_animation_free(&animation);
}

/* A variable that is set counts wherever it is used; of two that set the same the last counts;
 * what is set may use variables. */
static void variables(void **state) {
    (void)state;
    const zt_override big = {"$big", "3"};
    zt_animation *animation = animation_with(&big, 1);
    assert_true(animation->rest.objects[0].sphere.radius == 3);
    assert_true(animation->rest.objects[0].sphere.center.z == 3);
    zt_animation_free(&animation);

    const zt_override twice[] = {{"variables.big", "3"},
                                 {"$big", "4"},
                                 {"sphere 2.radius", "$big"},
                                 {"sphere 3.center", "[$big, 0, 0]"}};
    animation = animation_with(twice, 4);
    assert_true(animation->rest.objects[0].sphere.radius == 4);
    assert_true(animation->rest.objects[1].sphere.radius == 4);
    assert_true(animation->rest.objects[3].sphere.center.x == 4);
    zt_animation_free(&animation);
}

/* Each mistake in its words, where it is. */
static void mistakes(void **state) {
    (void)state;
    static const struct {
        zt_override override;
        const char *told;
    } cases[] = {
        {{"ball.radius", "-2"}, "1:13: error: \"radius\" is -2; it must be at least 0\n"},
        {{"ball.radius", "big"}, "1:13: error: \"radius\" must be a number, not \"big\"\n"},
        {{"ball.center", "[0, x, 0]"},
         "1:17: error: \"center\" must be a list of 3 numbers, and this is none\n"},
        {{"ball.radus", "2"},
         "1:1: error: \"ball\" has no \"radus\"; did you mean \"radius\"?\n"},
        {{"bal.radius", "2"}, "1:1: error: nothing is named \"bal\"; did you mean \"ball\"?\n"},
        {{"ball.name", "x"}, "1:1: error: \"ball\" has no \"name\"\n"},
        {{"$bog", "2"}, "1:1: error: \"variables\" has no \"bog\"; did you mean \"big\"?\n"},
        {{"$big", "$all"}, "1:6: error: no variable is named \"all\"\n"},
        {{"ball", "2"},
         "1:1: error: \"ball\" names no property; one is written as lamp.intensity, a variable "
         "as $name\n"},
        {{".radius", "2"},
         "1:1: error: \".radius\" names no property; one is written as lamp.intensity, a "
         "variable as $name\n"},
        {{"ball.", "2"},
         "1:1: error: \"ball.\" names no property; one is written as lamp.intensity, a "
         "variable "
         "as $name\n"},
        {{"", "2"},
         "1:1: error: \"\" names no property; one is written as lamp.intensity, a variable as "
         "$name\n"},
        {{"ball.radius", ""}, "1:1: error: there is no value behind the \"=\"\n"},
        {{"ball.radius", "1\n---\n2"},
         "2:1: error: a second document begins here; a file holds one\n"},
        {{"film.duration", "0 s"},
         "1:15: error: \"duration\" is 0 s; a film has at least one frame\n"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static told t;
        zt_animation *animation;
        zt_status status = read_with(&t, &animation, &cases[i].override, 1);
        assert_string_equal(t.lines, cases[i].told);
        assert_int_equal(status, ZT_EDESCRIPTION);
        assert_null(animation);
    }
}

/* Letters of more than one byte count as one in columns. */
static void columns(void **state) {
    (void)state;
    static told t;
    zt_animation *animation;
    const zt_override override = {"b\xC3\xA4ll.radius", "[1, 2"};
    assert_int_equal(read_with(&t, &animation, &override, 1), ZT_EDESCRIPTION);
    assert_non_null(strstr(t.lines, "1:13: note: while parsing a flow sequence"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything),
        cmocka_unit_test(variables),
        cmocka_unit_test(mistakes),
        cmocka_unit_test(columns),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
