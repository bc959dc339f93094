/* What is left out within a frame changes no bit: of a few hundred random scenes the pictures
 * are those of doing everything; and what a scene needs is what it says. A number given to the
 * program draws other scenes. */
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
#include "scene/needs.h"

static uint64_t seed = 7;

/* ---- random scenes -------------------------------------------------------------------------
 */

enum { WIDTH = 48, HEIGHT = 40, SCENES = 200, MOMENTS = 2 };

static bool chance(double share) { return test_random(&seed) < share; }

static vec3 somewhere(double reach) {
    return (vec3){test_between(&seed, -reach, reach), test_between(&seed, -reach, reach),
                  test_between(&seed, -reach, reach)};
}

static quat any_rotation(void) {
    return quat_axis_angle(test_direction(&seed), test_between(&seed, -3, 3));
}

static void add_materials(test_scene *s, bool mirrors) {
    static const double few[] = {0, 0, 1e-4, 0.02, 0.3, 0.9};
    for (int i = 0; i < 6; i++) {
        vec3 color = {test_random(&seed), test_random(&seed), chance(.3) ? 0 : 1};
        int32_t m = scene_material(s, color, mirrors ? few[(int)(6 * test_random(&seed))] : 0);
        if (!chance(.3)) continue;
        s->materials[m].pattern = ZT_PATTERN_CHECKER;
        s->materials[m].pattern_size = .7;
    }
}

static void add_object(test_scene *s) {
    static const zt_shape shapes[] = {ZT_SHAPE_BOX,  ZT_SHAPE_BOX,      ZT_SHAPE_SPHERE,
                                      ZT_SHAPE_DISK, ZT_SHAPE_TRIANGLE, ZT_SHAPE_CYLINDER,
                                      ZT_SHAPE_BOX,  ZT_SHAPE_SPHERE,   ZT_SHAPE_TORUS};
    zt_shape shape = shapes[(int)(9 * test_random(&seed))];
    zt_object *o = scene_object(s, shape, (int32_t)(6 * test_random(&seed)));
    vec3 at = somewhere(6);
    switch (shape) {
    case ZT_SHAPE_BOX: /* walls, some of them along the axes */
        o->box = (zt_block){at,
                            {test_between(&seed, .1, 6), test_between(&seed, .1, 6),
                             test_between(&seed, .05, 1)},
                            chance(.5) ? (quat){1, 0, 0, 0} : any_rotation()};
        break;
    case ZT_SHAPE_SPHERE:
        o->sphere = (zt_sphere){at, test_between(&seed, .1, 3)};
        break;
    case ZT_SHAPE_DISK:
        o->disk = (zt_disk){at, test_direction(&seed), test_between(&seed, .2, 3)};
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++) o->triangle.vertices[i] = vec3_add(at, somewhere(3));
        break;
    case ZT_SHAPE_TORUS:
        o->torus = (zt_torus){at, test_direction(&seed), 1, .3};
        break;
    default:
        o->tube = (zt_tube){at, vec3_add(at, somewhere(2)), .6, .6};
        break;
    }
}

static void add_light(test_scene *s, bool sized) {
    vec3 at = chance(.1) ? somewhere(300) : somewhere(7);
    zt_light *light = scene_point_light(s, at, chance(.15) ? 0 : test_between(&seed, .2, 20));
    light->shadows = chance(.9);
    if (chance(.2)) light->color = (vec3){0, 0, chance(.5)};
    if (!sized || chance(.4)) return;
    light->rotation = any_rotation();
    light->radius = test_between(&seed, .01, .6);
    light->width = light->height = light->radius;
    light->kind = chance(.3) ? ZT_LIGHT_RECTANGLE : chance(.5) ? ZT_LIGHT_DISK : ZT_LIGHT_POINT;
}

static void random_scene(test_scene *s) {
    scene_begin(s);
    add_materials(s, chance(.6));
    if (chance(.8)) scene_plane(s, (vec3){0, 1, 0}, -3, 0);
    if (chance(.5)) scene_plane(s, test_direction(&seed), test_between(&seed, -6, -2), 1);
    if (chance(.3)) scene_plane(s, (vec3){1, 0, 0}, test_between(&seed, 1, 5), 2);
    int objects = (int)test_between(&seed, 0, chance(.1) ? 60 : 12);
    for (int i = 0; i < objects; i++) add_object(s);
    if (chance(.6)) scene_ambient(s, (vec3){.2, .3, .1}, test_random(&seed));
    bool sized = chance(.4);
    int lights = (int)test_between(&seed, 1, chance(.3) ? 60 : 12);
    for (int i = 0; i < lights; i++) add_light(s, sized);
    s->scene.camera.position = somewhere(5);
    s->scene.camera.rotation = any_rotation();
    s->scene.reflection_depth = (int32_t)test_between(&seed, 0, 12);
}

/* A little later, some of it somewhere else, or of other brightness. */
static void move(test_scene *to, const test_scene *from) {
    *to = *from;
    to->scene.objects = to->objects;
    to->scene.lights = to->lights;
    to->scene.materials = to->materials;
    for (int32_t i = 0; i < to->scene.object_count; i++) {
        zt_object *o = &to->objects[i];
        if (o->shape == ZT_SHAPE_SPHERE && chance(.3))
            o->sphere.center = vec3_add(o->sphere.center, somewhere(1));
        if (o->shape == ZT_SHAPE_BOX && chance(.3))
            o->box.center = vec3_add(o->box.center, somewhere(1));
    }
    for (int32_t i = 0; i < to->scene.light_count; i++) {
        zt_light *l = &to->lights[i];
        if (chance(.3)) l->position = vec3_add(l->position, somewhere(2));
        if (chance(.2)) l->intensity = chance(.5) ? 0 : 3;
    }
    if (chance(.3)) to->materials[0].reflectivity = test_random(&seed);
}

/* ---- pictures ------------------------------------------------------------------------------
 */

static zt_image *picture(zt_render_count *count, const zt_exposure *exposure,
                         zt_sampling sampling, bool everything) {
    assert_int_equal(setenv("ZOETROPE_EVERYTHING", everything ? "1" : "0", 1), 0);
    return render_exposure(count, exposure, WIDTH, HEIGHT, sampling, 2);
}

static const zt_sampling samplings[] = {
    {.min = 1, .max = 1},
    {.min = 4, .max = 4},
    {.min = 4, .max = 32, .error = 0.01},
    {.min = 1, .max = 32, .error = 0.01, .edges = true},
};

static void same_picture(const zt_exposure *exposure, int scene, zt_ray_counts *sum) {
    zt_sampling sampling = samplings[scene % 4];
    precision = scene % 8 < 4 ? ZT_PRECISION_SINGLE : ZT_PRECISION_DOUBLE;
    zt_render_count own, all;
    zt_image *image = picture(&own, exposure, sampling, false);
    zt_image *whole = picture(&all, exposure, sampling, true);
    size_t size = 4 * sizeof(float) * WIDTH * HEIGHT;
    if (memcmp(image->pixels, whole->pixels, size) != 0)
        print_error("scene %d, with %d lights\n", scene, exposure->moments->light_count);
    assert_memory_equal(image->pixels, whole->pixels, size);
    assert_int_equal(own.samples, all.samples);
    assert_int_equal(own.rays.primary + own.rays.primary_avoided,
                     all.rays.primary + all.rays.primary_avoided);
    assert_true(own.rays.mirror <= all.rays.mirror);
    /* Together there are as many, those of mirrored rays that are not traced left aside. */
    if (own.rays.mirror == all.rays.mirror)
        assert_int_equal(own.rays.shadow + own.rays.shadow_avoided,
                         all.rays.shadow + all.rays.shadow_avoided);
    zt_ray_counts_add(sum, &own.rays);
    sum->shadow_avoided += all.rays.shadow - own.rays.shadow;
    sum->mirror_avoided += all.rays.mirror - own.rays.mirror;
    sum->shadow_avoided -= own.rays.shadow_avoided;
    sum->mirror_avoided -= own.rays.mirror_avoided;
    zt_image_free(&image);
    zt_image_free(&whole);
}

/* What is left out of scenes that stand still changes no bit, and it is not nothing. */
static void test_still(void **state) {
    (void)state;
    static test_scene s;
    zt_ray_counts sum = {0};
    for (int i = 0; i < SCENES; i++) {
        random_scene(&s);
        zt_exposure exposure = zt_exposure_of(&s.scene);
        same_picture(&exposure, i, &sum);
    }
    print_message("%.0f %% of shadow rays and %.2f %% of mirrored ones left out\n",
                  100. * (double)sum.shadow_avoided / (double)(sum.shadow + sum.shadow_avoided),
                  100. * (double)sum.mirror_avoided /
                      (double)(sum.mirror + sum.mirror_avoided));
    assert_true(sum.shadow_avoided * 10 > sum.shadow);
    assert_true(sum.mirror_avoided > 0);
}

/* Nor does it of scenes in which something moves while the shutter is open. */
static void test_moving(void **state) {
    (void)state;
    static test_scene s[MOMENTS];
    zt_scene moments[MOMENTS];
    zt_ray_counts sum = {0};
    for (int i = 0; i < SCENES / 3; i++) {
        random_scene(&s[0]);
        move(&s[1], &s[0]);
        for (int m = 0; m < MOMENTS; m++) moments[m] = s[m].scene;
        zt_exposure exposure = {.moments = moments,
                                .times = (double[]){0, 1},
                                .steps = (bool[]){false, false},
                                .moment_count = MOMENTS};
        same_picture(&exposure, i, &sum);
    }
    assert_true(sum.shadow_avoided > 0);
}

int main(int argc, char **argv) {
    if (argc > 1) seed = strtoull(argv[1], NULL, 10);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_still),
        cmocka_unit_test(test_moving),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
