/* The reference itself: against closed forms, and against itself where a thing can be said in
 * two ways. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "reference.h"
#include "stage.h"

static stage s;
static zt_arena arena;
static ref_scene ref;

static void prepare(void) {
    zt_arena_reset(&arena);
    assert_true(ref_prepare(&ref, &s.s.scene, &arena));
}

static void assert_near(real got, real expected, double relative) {
    double error = (double)real_abs(got - expected);
    if (!(error <= relative * (double)real_max(1, real_abs(expected))))
        fail_msg("%.20g, not %.20g", (double)got, (double)expected);
}

static ref_hit shoot(vec3 o, vec3 d) {
    ref_ray ray = {real3_of(o), real3_of(d), -1, -1};
    return ref_nearest(&ref, &ray);
}

/* Along an axis of each shape the distance is a number that one can write down. */
static void closed_forms(void **state) {
    (void)state;
    const vec3 x = {1, 0, 0}, z = {0, 0, 1}, zero = {0, 0, 0};
    const struct {
        zt_object object;
        vec3 o, d;
        double t;
        vec3 normal;
    } forms[] = {
        {{ZT_SHAPE_PLANE, .plane = {{0, 0, 2}, 3}}, {1, 2, 7}, {0, 0, -2}, 2, {0, 0, 1}},
        {{ZT_SHAPE_SPHERE, .sphere = {{1, 0, 0}, 2}}, {-5, 0, 0}, x, 4, {-1, 0, 0}},
        {{ZT_SHAPE_SPHERE, .sphere = {{1, 0, 0}, 2}}, {1, 0, 0}, x, 2, {1, 0, 0}},
        {{ZT_SHAPE_TRIANGLE, .triangle = {{{0, 0, 5}, {1, 0, 5}, {0, 1, 5}}}},
         {.25, .25, 1},
         z,
         4,
         {0, 0, 1}},
        {{ZT_SHAPE_DISK, .disk = {{0, 0, 2}, {0, 0, 3}, 1}}, {.5, .5, 0}, z, 2, {0, 0, 1}},
        {{ZT_SHAPE_BOX, .box = {{0, 0, 0}, {2, 4, 6}, {1, 0, 0, 0}}},
         {.5, .5, -9},
         z,
         6,
         {0, 0, -1}},
        {{ZT_SHAPE_CYLINDER, .tube = {zero, {0, 0, 4}, 2, 0}}, {-5, 0, 1}, x, 3, {-1, 0, 0}},
        {{ZT_SHAPE_CYLINDER, .tube = {zero, {0, 0, 4}, 2, 0}},
         {1, 0, 9},
         {0, 0, -1},
         5,
         {0, 0, 1}},
        {{ZT_SHAPE_CONE, .tube = {zero, {0, 0, 4}, 2, 0}}, {-5, 0, 2}, x, 4, {-2, 0, 1}},
        {{ZT_SHAPE_CONE, .tube = {zero, {0, 0, 4}, 1, 3}}, {-5, 0, 2}, x, 3, {-2, 0, -1}},
        {{ZT_SHAPE_CONE, .tube = {zero, {0, 0, 4}, 1, 3}}, {0, 2.5, -5}, z, 8, {0, 2, -1}},
        {{ZT_SHAPE_TORUS, .torus = {zero, {0, 0, 1}, 3, 1}}, {-9, 0, 0}, x, 5, {-1, 0, 0}},
        {{ZT_SHAPE_TORUS, .torus = {zero, {0, 0, 1}, 3, 1}}, zero, x, 2, {-1, 0, 0}},
        {{ZT_SHAPE_TORUS, .torus = {zero, {0, 0, 1}, 3, 1}},
         {3, 0, 7},
         {0, 0, -1},
         6,
         {0, 0, 1}},
        {{ZT_SHAPE_CAPSULE, .tube = {zero, {0, 0, 4}, 1, 0}}, {0, 0, -5}, z, 4, {0, 0, -1}},
        {{ZT_SHAPE_CAPSULE, .tube = {zero, {0, 0, 4}, 1, 0}}, {-5, 0, 3}, x, 4, {-1, 0, 0}},
    };
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        stage_begin(&s, 0);
        zt_object *object = scene_object(&s.s, forms[i].object.shape, 0);
        *object = forms[i].object;
        object->parent = -1;
        prepare();
        ref_hit hit = shoot(forms[i].o, forms[i].d);
        assert_int_equal(hit.object, 0);
        assert_near(hit.t, forms[i].t, 1e-30);
        real3 at = real3_along(real3_of(forms[i].o), hit.t, real3_of(forms[i].d));
        ref_face face = ref_nearest_face(&ref.primitives[0], hit.part, at);
        assert_near(face.distance, 0, 1e-30);
        assert_near(real3_dot(face.normal, real3_unit(real3_of(forms[i].normal))), 1, 1e-30);
    }
}

/* Quartics with known roots: simple, double, and close to one another. */
static void quartics(void **state) {
    (void)state;
    const double sets[][4] = {{-2, -1, 1, 2},
                              {-3, 0, 1, 2},
                              {-1, -.5, .75, .75},
                              {-1e-3, -1e-9, 1e-9, 1e-3},
                              {-.5, -.5, .5, .5}};
    for (int i = 0; i < 5; i++) {
        real r[4], roots[4], a = 0, b = 0;
        for (int k = 0; k < 4; k++) r[k] = sets[i][k];
        for (int k = 0; k < 4; k++)
            for (int l = k + 1; l < 4; l++) {
                a += r[k] * r[l];
                for (int m = l + 1; m < 4; m++) b -= r[k] * r[l] * r[m];
            }
        int count = ref_quartic(roots, a, b, r[0] * r[1] * r[2] * r[3], 4);
        for (int k = 0; k < count; k++) {
            double nearest = 1;
            for (int l = 0; l < 4; l++)
                nearest = fmin(nearest, (double)real_abs(roots[k] - r[l]));
            assert_true(nearest < 1e-15);
        }
        if (i == 0 || i == 1 || i == 3) assert_int_equal(count, 4);
    }
    real roots[4];
    assert_int_equal(ref_quartic(roots, 2, 0, 1, 10), 0); /* (s^2 + 1)^2 */
}

/* Any hit, of any shape in any group, lies on the surface; its normal is across the surface:
 * a step along the face leaves it by the square of the step. */
static void hits_lie_on_surfaces(void **state) {
    (void)state;
    draw d = {7, 0};
    int hits = 0;
    for (int round = 0; round < 300; round++) {
        stage_begin(&s, 40);
        vec3 scale = {draw_magnitude(&d, .1, 10), -draw_magnitude(&d, .1, 10), 1};
        int32_t outer = stage_group(&s, -1, stage_within(&d, 2), draw_rotation(&d), scale);
        int32_t group = stage_group(&s, outer, stage_within(&d, 2), draw_rotation(&d), scale);
        zt_shape shape = (zt_shape)(round % ZT_SHAPE_MESH);
        stage_object(&s, &d, shape, stage_within(&d, 2), 1, .1)->parent = group;
        s.s.scene.camera.position = stage_within(&d, 5);
        prepare();
        stage_shoot(&s, &d, STAGE_FROM_ASIDE, 3, 60);
        for (int i = 0; i < s.ray_count; i++) {
            ref_hit hit = shoot(s.origins[i], s.directions[i]);
            if (hit.object < 0) continue;
            real3 at = real3_along(real3_of(s.origins[i]), hit.t, real3_of(s.directions[i]));
            const ref_primitive *p = &ref.primitives[hit.object];
            ref_face face = ref_nearest_face(p, hit.part, at);
            assert_near(face.distance, 0, 1e-25);
            real3 u, v;
            real3_frame(&u, &v, face.normal);
            real step = (real)1e-12;
            ref_face moved = ref_nearest_face(p, hit.part, real3_along(at, step, u));
            if (p->shape != ZT_SHAPE_TRIANGLE && p->shape != ZT_SHAPE_DISK)
                assert_true(moved.distance <= 10 * step * step * (1 + face.bend));
            real turn = real3_length(real3_sub(moved.normal, face.normal));
            assert_true(turn <= (real)1.01 * step * face.bend + 1e-22);
            hits++;
        }
    }
    assert_true(hits > 2000);
}

/* A camera far away changes nothing but what doubles cannot say of the places. */
static void the_camera_is_the_origin(void **state) {
    (void)state;
    stage_begin(&s, 1);
    s.s.scene.camera.position = (vec3){0x1p40, -0x1p40, 0x1p39};
    int32_t group =
        stage_group(&s, -1, s.s.scene.camera.position, quat_identity(), (vec3){2, 2, 2});
    scene_sphere(&s.s, (vec3){0, 0, -3}, 1, 0);
    s.s.objects[1].parent = group;
    prepare();
    assert_near(shoot((vec3){0, 0, 0}, (vec3){0, 0, -1}).t, 4, 1e-33);
}

/* Whether a hit is beyond doubt: straight on it is, at the rim it is not. */
static void doubt(void **state) {
    (void)state;
    stage_begin(&s, 1);
    scene_sphere(&s.s, (vec3){0, 0, -10}, 1, 0);
    prepare();
    bool sure;
    const double aside[] = {0, .99, 1 - 1e-6, 1 + 1e-6, 1.01};
    for (int i = 0; i < 5; i++) {
        ref_ray ray = {{aside[i], 0, 0}, {0, 0, -1}, -1, -1};
        assert_int_equal(ref_blocked(&sure, &ref, &ray, 100, 1e-5, -1), aside[i] < 1);
        assert_int_equal(sure, real_abs(aside[i] - 1) > .001);
    }
    ref_ray leaving = {{0, 0, -9}, {0, 0, 1}, 0, -1}, inward = {{0, 0, -9}, {0, 0, -1}, 0, -1};
    ref_hit hit;
    assert_false(ref_first(&hit, &ref.primitives[0], &leaving, 0, 100));
    assert_true(ref_first(&hit, &ref.primitives[0], &inward, 0, 100));
    assert_near(hit.t, 2, 1e-30);
}

static int end(void **state) {
    (void)state;
    zt_arena_free(&arena);
    zt_arena_free(&s.arena);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms), cmocka_unit_test(quartics),
        cmocka_unit_test(hits_lie_on_surfaces), cmocka_unit_test(the_camera_is_the_origin),
        cmocka_unit_test(doubt)};
    return cmocka_run_group_tests(tests, NULL, end);
}
