/* Ways to move while the shutter is open that are ways of their own: from nothing or to it, at
 * once where a step is, and by an axis that turns. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "moving.h"

/* What grows from nothing, by its own size or its group's, is nothing at first and then as
 * large as it is; likewise what shrinks. */
static void test_from_nothing(void **state) {
    (void)state;
    const zt_shape shapes[] = {ZT_SHAPE_SPHERE,   ZT_SHAPE_DISK,     ZT_SHAPE_BOX,
                               ZT_SHAPE_CYLINDER, ZT_SHAPE_CONE,     ZT_SHAPE_TORUS,
                               ZT_SHAPE_CAPSULE,  ZT_SHAPE_TRIANGLE, ZT_SHAPE_MESH};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (int way = 0; way < 4; way++) {
            zt_shape shape = shapes[i];
            bool group = way & 1, shrinks = way & 2;
            if (!group && (shape == ZT_SHAPE_BOX || shape == ZT_SHAPE_TRIANGLE)) continue;
            uint64_t seed = 1;
            for (int m = 0; m < 2; m++) {
                test_scene *s = &moments[m];
                begin_moment(s);
                scene_material(s, (vec3){1, 1, 1}, 0);
                double size = (m == 0) == shrinks ? 1 : 0, whole = group ? 1 : size;
                zt_object *g = scene_object(s, ZT_SHAPE_GROUP, -1);
                g->placement.position = (vec3){0, 0, -5};
                if (group) g->placement.scale = (vec3){size, size, size};
                zt_object *o = scene_object(s, shape, 0);
                o->parent = 0;
                vec3 none = {0, 0, 0}, z = {0, 0, 1};
                if (shape == ZT_SHAPE_SPHERE) o->sphere = (zt_sphere){none, whole};
                if (shape == ZT_SHAPE_DISK) o->disk = (zt_disk){none, z, whole};
                if (shape == ZT_SHAPE_BOX) o->box = (zt_block){none, {2, 2, 2}, {1, 0, 0, 0}};
                if (shape == ZT_SHAPE_CYLINDER || shape == ZT_SHAPE_CONE ||
                    shape == ZT_SHAPE_CAPSULE)
                    o->tube = (zt_tube){none, z, whole, .5 * whole};
                if (shape == ZT_SHAPE_TORUS)
                    o->torus = (zt_torus){{.8, 0, 0}, z, whole, .4 * whole};
                if (shape == ZT_SHAPE_TRIANGLE)
                    o->triangle = (zt_triangle){{{-2, -2, 0}, {2, -2, 0}, {0, 3, 0}}};
                if (shape == ZT_SHAPE_MESH) {
                    o->mesh = 0;
                    o->placement.scale = (vec3){whole, whole, whole};
                }
            }
            film f;
            set_film(&f, &seed, 2);
            stage st;
            open_stage(&st, &f.exposure, ZT_PRECISION_AUTO);
            assert_true(st.ready.moves);
            for (int k = 0; k <= 64; k++) {
                double time = shrinks ? 1 - k / 64.0 : k / 64.0, size = k / 64.0;
                bool met = probe(&st, (vec3){.2, .1, 0}, (vec3){0, 0, -1}, time).object >= 0;
                if (k == 0) assert_false(met);
                if (k == 64) assert_true(met);
                if (shape == ZT_SHAPE_SPHERE)
                    assert_true(met == (size > sqrt(.05)) || fabs(size - sqrt(.05)) < 1e-3);
            }
            close_stage(&st);
        }
}

/* What differs at the end of an interval that steps changes at once, halfway. */
static void test_steps(void **state) {
    (void)state;
    uint64_t seed = 3;
    for (int m = 0; m < 3; m++) {
        begin_moment(&moments[m]);
        scene_material(&moments[m], (vec3){1, 1, 1}, 0);
        scene_sphere(&moments[m], (vec3){m > 0 ? 3 : 0, m > 1 ? 3 : 0, -8}, 1, 0);
    }
    film f;
    set_film(&f, &seed, 3);
    f.steps[0] = true;
    stage st;
    open_stage(&st, &f.exposure, ZT_PRECISION_SINGLE);
    double half = f.times[1] / 2;
    vec3 first = {0, 0, -8}, next = {3, 0, -8}, last = {3, 3, -8};
    for (int i = -8; i <= 8; i++) {
        double time = half + half * (i + .25) / 9;
        assert_true((probe(&st, (vec3){0, 0, 0}, first, time).object >= 0) == (i < 0));
        assert_true((probe(&st, (vec3){0, 0, 0}, next, time).object >= 0) == (i >= 0));
    }
    assert_true(probe(&st, (vec3){0, 0, 0}, last, 1).object >= 0);
    assert_true(probe(&st, (vec3){0, 0, 0}, (vec3){3, 1.5, -8}, (1 + f.times[1]) / 2).object >=
                0);
    close_stage(&st);
}

/* A tube whose ends are keyed, and whose axis so turns from one moment to the next, is the tube
 * between the ends, to second order of the turn. */
static void test_turning_axis(void **state) {
    (void)state;
    const zt_shape shapes[] = {ZT_SHAPE_CYLINDER, ZT_SHAPE_CONE, ZT_SHAPE_CAPSULE,
                               ZT_SHAPE_DISK, ZT_SHAPE_TORUS};
    uint64_t seed = 4;
    film f;
    stage st, still;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        for (int m = 0; m < 5; m++) {
            test_scene *s = &moments[m];
            begin_moment(s);
            scene_material(s, (vec3){1, 1, 1}, 0);
            zt_object *o = scene_object(s, shapes[i], 0);
            /* Through where another axis becomes the one that is least along it. */
            double w = .78 + .005 * (m - 2);
            vec3 at = {0, 0, -6}, axis = {cos(w), sin(w), .1};
            o->tube = (zt_tube){at, vec3_add(at, axis), .5, .2};
            if (shapes[i] == ZT_SHAPE_DISK) o->disk = (zt_disk){at, {cos(w), .1, sin(w)}, 1};
            if (shapes[i] == ZT_SHAPE_TORUS)
                o->torus = (zt_torus){at, {sin(w), cos(w), .1}, 1, .3};
        }
        set_film(&f, &seed, 5);
        open_stage(&st, &f.exposure, ZT_PRECISION_DOUBLE);
        for (int m = 0; m < 4; m++) {
            double time = (f.times[m] + f.times[m + 1]) / 2;
            test_scene own = moments[m];
            own.scene.objects = own.objects, own.scene.materials = own.materials;
            zt_object *o = &own.objects[0];
            const zt_object *next = &moments[m + 1].objects[0];
            if (shapes[i] == ZT_SHAPE_DISK)
                o->disk.normal = mix3(o->disk.normal, next->disk.normal, .5);
            else if (shapes[i] == ZT_SHAPE_TORUS)
                o->torus.axis = mix3(o->torus.axis, next->torus.axis, .5);
            else
                o->tube.to = mix3(o->tube.to, next->tube.to, .5);
            open_still(&still, &own.scene);
            int met = 0, others = 0;
            for (int k = 0; k < 400; k++) {
                vec3 aim = vec3_add((vec3){0, 0, -6}, vec3_scale(test_direction(&seed), 1.2));
                zt_probe p = probe(&st, (vec3){0, 0, 0}, aim, time);
                zt_probe q = probe(&still, (vec3){0, 0, 0}, aim, 0);
                if (q.object < 0 || fabs(vec3_dot(q.normal, vec3_normalize(aim))) < .3)
                    continue;
                /* An edge is as far off as the rest. */
                bool same = p.object >= 0 && vec3_length(vec3_sub(p.normal, q.normal)) < 1e-3;
                if (same) assert_true(fabs(p.distance - q.distance) < 1e-4);
                met += same;
                others += !same;
            }
            assert_true(met > 25 && others * 10 < met);
            close_stage(&still);
        }
        close_stage(&st);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_from_nothing),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_turning_axis),
    };
    return cmocka_run_group_tests(tests, make_models, free_models);
}
