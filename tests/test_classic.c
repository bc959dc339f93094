/* The classic model against pixels worked out by hand, and what must not change the bits:
 * threads, the width of instructions, shadows that nothing casts. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "rendering.h"

/* The light of the one ray that runs straight along -z. */
static vec3 center_pixel(const zt_scene *scene) {
    zt_image *image = render(scene, 1, 1, 1, 1);
    vec3 pixel = {image->pixels[0], image->pixels[1], image->pixels[2]};
    assert_float_equal(image->pixels[3], 1, 0);
    zt_image_free(&image);
    return pixel;
}

static void assert_light(vec3 got, double r, double g, double b) {
    assert_float_equal(got.x, r, 1e-6);
    assert_float_equal(got.y, g, 1e-6);
    assert_float_equal(got.z, b, 1e-6);
}

/* color * intensity / d^2 * |v.n| * object color: a wall at z = -4, a lamp at (3, 0, 0), so
 * that d = 5 and |v.n| = 4/5. */
static void test_point_light(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, (vec3){.5, .25, 1}, 0);
    scene_plane(&s, (vec3){0, 0, 2}, -4, 0);
    zt_light *lamp = scene_point_light(&s, (vec3){3, 0, 0}, 10);
    lamp->color = (vec3){1, .5, .25};
    double fade = 10.0 / 25 * 4 / 5;
    assert_light(center_pixel(&s.scene), fade * .5, fade * .5 * .25, fade * .25);
    lamp->position.z = -8; /* behind the wall: black */
    assert_light(center_pixel(&s.scene), 0, 0, 0);
    lamp->position.z = -4; /* within its plane: black */
    assert_light(center_pixel(&s.scene), 0, 0, 0);
}

/* Each lamp is cut to 1 by itself, the sum is not; the ambient light knows no distance. */
static void test_cut_and_ambient(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, (vec3){.5, 1, 0}, 0);
    scene_plane(&s, (vec3){0, 0, 1}, -2, 0);
    scene_ambient(&s, (vec3){.2, .4, .8}, .5);
    scene_point_light(&s, (vec3){0, 0, 0}, 1e6);
    scene_point_light(&s, (vec3){0, 0, 0}, 1e6);
    scene_point_light(&s, (vec3){0, 0, 0}, 1);
    assert_light(center_pixel(&s.scene), .1 * .5 + 2 + .125, .2 + 2 + .25, 0);
    s.scene.object_count = 0;
    assert_light(center_pixel(&s.scene), 0, 0, 0); /* nothing hit is black, ambient or not */
}

/* A ball hides the lamp from the point; not when it is beyond the lamp, nor when the lamp casts
 * no shadows. Distances are not those of the unit vector, so a mix-up of units would show. */
static void test_shadow(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, white, 0);
    scene_plane(&s, (vec3){0, 0, 1}, -40, 0);
    zt_light *lamp = scene_point_light(&s, (vec3){0, 30, 0}, 1000);
    scene_sphere(&s, (vec3){0, 15, -20}, 2, 0);
    double lit = 1000.0 / 2500 * 4 / 5;
    assert_light(center_pixel(&s.scene), 0, 0, 0);
    lamp->shadows = false;
    assert_light(center_pixel(&s.scene), lit, lit, lit);
    lamp->shadows = true;
    s.objects[1].sphere.center = (vec3){0, 33, 4}; /* the lamp is in between */
    assert_light(center_pixel(&s.scene), lit, lit, lit);
}

/* reflectivity * what the mirror shows is added; a mirror of the mirror to the power of two; no
 * further than the depth. Between a wall at -1 and a wall at +1 with the eye in the middle each
 * wall shows: its own light, then that of the other. */
static void test_mirrors(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, (vec3){.5, .5, .5}, .5);
    scene_material(&s, (vec3){.1, .2, .3}, .25);
    scene_plane(&s, (vec3){0, 0, 1}, -1, 0);
    scene_plane(&s, (vec3){0, 0, -1}, -1, 1);
    scene_ambient(&s, white, 1);
    const double own[2] = {.5, .2}, share[2] = {.5, .25};
    double sum = 0, weight = 1;
    for (int depth = 0; depth < 12; depth++) {
        sum += weight * own[depth % 2];
        weight *= share[depth % 2];
        s.scene.reflection_depth = depth;
        assert_float_equal(center_pixel(&s.scene).y, sum, 1e-6);
    }
    s.materials[0].reflectivity = s.materials[1].reflectivity = 1;
    s.scene.reflection_depth = 999;
    assert_float_equal(center_pixel(&s.scene).y, 500 * (.5 + .2), 1e-2);
}

/* From inside a sphere with a lamp in its middle: the normal faces the eye. */
static void test_inside(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, white, 0);
    scene_sphere(&s, (vec3){0, 0, -1}, 3, 0);
    scene_point_light(&s, (vec3){0, 0, -1}, 4.5);
    assert_light(center_pixel(&s.scene), .5, .5, .5);
}

/* A group moves, turns and scales its members; a group in a group does so twice. */
static void test_groups(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, (vec3){.5, .5, .5}, 0);
    scene_object(&s, ZT_SHAPE_GROUP, -1)->placement = (zt_placement){
        {0, 0, -6}, quat_axis_angle((vec3){0, 1, 0}, 1.57079632679489661923), {2, 2, 2}};
    zt_object *inner = scene_object(&s, ZT_SHAPE_GROUP, -1);
    inner->parent = 0;
    inner->placement.position = (vec3){1, 0, 0}; /* turned: 2 further along -z */
    scene_sphere(&s, (vec3){0, 0, 0}, 1.5, 0);
    s.objects[2].parent = 1; /* at z = -8, radius 3: its near side at -5 */
    scene_point_light(&s, (vec3){0, 0, 0}, 12.5);
    assert_light(center_pixel(&s.scene), .25, .25, .25);
}

/* A room like the documents': three planes, two of them mirrors, spheres, two lamps. */
static void make_room(test_scene *s) {
    scene_begin(s);
    s->scene.camera = (zt_camera){.position = {1, 2, 7},
                                  .look_at = {0, 1, 0},
                                  .up = {0, 1, 0},
                                  .rotation = {1, 0, 0, 0},
                                  .aimed = true,
                                  .fov = .8};
    scene_material(s, (vec3){.8, .8, .75}, .3);
    scene_material(s, (vec3){.8, .3, .2}, .2);
    scene_material(s, (vec3){.3, .5, .8}, 0);
    scene_plane(s, (vec3){0, 1, 0}, 0, 0);
    scene_plane(s, (vec3){1, 0, 0}, -4, 0);
    scene_plane(s, (vec3){0, 0, 1}, -4, 2);
    for (int i = 0; i < 12; i++)
        scene_sphere(s, (vec3){i % 4 - 1.5, .5 + i / 4, i % 3 - 1}, .45, i % 3);
    scene_triangle(s, (vec3){-3, .1, -2}, (vec3){3, .2, -2}, (vec3){0, 4, -3}, 1);
    scene_object(s, ZT_SHAPE_GROUP, -1)->placement.scale = (vec3){1, 2, .5};
    scene_sphere(s, (vec3){2.5, .5, 2}, .5, 1);
    s->objects[s->scene.object_count - 1].parent = s->scene.object_count - 2;
    scene_ambient(s, white, .2);
    scene_point_light(s, (vec3){2, 5, 4}, 12);
    scene_point_light(s, (vec3){-3, 4, 1}, 8)->color = (vec3){1, .5, .3};
}

static void assert_same_bits(const zt_image *a, const zt_image *b) {
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    assert_memory_equal(a->pixels, b->pixels,
                        (size_t)a->width * (size_t)a->height * 4 * sizeof(float));
}

/* One thread and four, one sample and many, sizes that no tile divides. */
static void test_threads(void **state) {
    (void)state;
    test_scene s;
    make_room(&s);
    for (int samples = 1; samples <= 5; samples += 4) {
        zt_image *one = render(&s.scene, 131, 77, samples, 1);
        zt_image *four = render(&s.scene, 131, 77, samples, 4);
        assert_same_bits(one, four);
        zt_image_free(&one);
        zt_image_free(&four);
    }
}

/* All widths of instructions give the same bits, in either precision. */
static void test_isa(void **state) {
    (void)state;
    test_scene s;
    make_room(&s);
    for (precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE; precision++) {
        setenv("ZOETROPE_ISA", "scalar", 1);
        zt_image *wanted = render(&s.scene, 160, 120, 2, 2);
        const char *const names[] = {"base", "avx2", "avx512"};
        for (int i = 0; i < 3; i++) {
            setenv("ZOETROPE_ISA", names[i], 1);
            zt_image *got = render(&s.scene, 160, 120, 2, 2);
            assert_same_bits(wanted, got);
            zt_image_free(&got);
        }
        zt_image_free(&wanted);
    }
    precision = ZT_PRECISION_AUTO;
    unsetenv("ZOETROPE_ISA");
}

/* Convex things cast no shadow on the side that is lit: shadows on or off, the same bits. Any
 * point that hid the lamp from itself would show, near, far, large and small. */
static void test_no_self_shadow(void **state) {
    (void)state;
    for (int round = 0; round < 24; round++) {
        double size = pow(10, round % 8 - 3), away = round < 12 ? 3 : 30;
        test_scene s;
        scene_begin(&s);
        scene_material(&s, white, 0);
        vec3 at = {.1 * size, .2 * size, -away * size};
        s.scene.camera.fov = round < 12 ? 1.0 : .12;
        if (round % 3 == 0) scene_sphere(&s, at, size, 0);
        if (round % 3 == 1)
            scene_plane(&s, (vec3){.3, .8, .4}, vec3_dot(at, (vec3){.3, .8, .4}), 0);
        if (round % 3 == 2) {
            scene_object(&s, ZT_SHAPE_GROUP, -1)->placement.scale = (vec3){1, 2, .5};
            scene_sphere(&s, (vec3){at.x, at.y, 2 * at.z}, size, 0);
            s.objects[1].parent = 0;
        }
        zt_light *lamp = scene_point_light(&s, (vec3){away * size, 5 * away * size, 0}, 0);
        lamp->intensity = 30 * away * away * size * size;
        zt_image *with = render(&s.scene, 150, 150, 1, 2);
        lamp->shadows = false;
        zt_image *without = render(&s.scene, 150, 150, 1, 2);
        assert_same_bits(with, without);
        double sum = 0;
        for (int i = 0; i < 150 * 150; i++) sum += with->pixels[4 * i];
        assert_true(sum > 300); /* there is something to see */
        zt_image_free(&with);
        zt_image_free(&without);
    }
}

/* Many samples of a half-covered picture come to its half, and each sample lies in its pixel.
 */
static void test_samples(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, white, 0);
    scene_ambient(&s, white, 1);
    /* An edge through the middle of a pixel of 5 x 5, slanted: area 1/2 by symmetry. */
    scene_triangle(&s, (vec3){-9, -1, -5}, (vec3){9, 1, -5}, (vec3){9, -90, -5}, 0);
    scene_triangle(&s, (vec3){-9, -1, -5}, (vec3){9, -90, -5}, (vec3){-9, -90, -5}, 0);
    zt_image *image = render(&s.scene, 5, 5, 1024, 2);
    assert_float_equal(image->pixels[4 * (2 * 5 + 2)], .5, 2e-3);
    assert_float_equal(image->pixels[0], 0, 0);
    assert_float_equal(image->pixels[4 * 24], 1, 1e-6);
    zt_image_free(&image);
}

/* Light without bound: what is not finite is left out and counted, and no pixel shows it. */
static void test_not_finite(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, (vec3){1e30, 1e30, 1e30}, 0);
    scene_plane(&s, (vec3){0, 1, 0}, -1, 0); /* the lower half of the picture */
    scene_ambient(&s, white, 1e30);
    int64_t left_out;
    zt_image *image = render_leaving_out(&left_out, &s.scene, 20, 20, 3, 2);
    assert_int_equal(left_out, 20 * 20 / 2 * 3);
    for (int i = 0; i < 20 * 20; i++) {
        assert_float_equal(image->pixels[4 * i], 0, 0);
        assert_float_equal(image->pixels[4 * i + 3], 1, 0);
    }
    zt_image_free(&image);
}

/* The picture is the right way round: a ball up to the right is up to the right. */
static void test_orientation(void **state) {
    (void)state;
    test_scene s;
    scene_begin(&s);
    scene_material(&s, white, 0);
    scene_ambient(&s, white, 1);
    scene_sphere(&s, (vec3){1, .5, -2}, .2, 0); /* at 3/4 of the width and 3/8 of the height */
    zt_image *image = render(&s.scene, 64, 64, 1, 1);
    for (int y = 0; y < 64; y++)
        for (int x = 0; x < 64; x++) {
            double dx = x + .5 - 48, dy = y + .5 - 24, distance = sqrt(dx * dx + dy * dy);
            if (distance < 2.5) assert_float_equal(image->pixels[4 * (64 * y + x)], 1, 0);
            if (distance > 4.5) assert_float_equal(image->pixels[4 * (64 * y + x)], 0, 0);
        }
    zt_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_point_light),    cmocka_unit_test(test_cut_and_ambient),
        cmocka_unit_test(test_shadow),         cmocka_unit_test(test_mirrors),
        cmocka_unit_test(test_inside),         cmocka_unit_test(test_groups),
        cmocka_unit_test(test_threads),        cmocka_unit_test(test_isa),
        cmocka_unit_test(test_no_self_shadow), cmocka_unit_test(test_samples),
        cmocka_unit_test(test_not_finite),     cmocka_unit_test(test_orientation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
