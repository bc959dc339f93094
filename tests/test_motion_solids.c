/* A solid that moves while the shutter is open, by itself and in groups that do: at each time
 * it is met as the one that stands still where straight ways between the moments bring it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "moving.h"

static xform mix_xform(const xform *a, const xform *b, double s) {
    return (xform){mix3(a->x, b->x, s), mix3(a->y, b->y, s), mix3(a->z, b->z, s),
                   mix3(a->shift, b->shift, s)};
}

/* The space in which a solid is canonical, if `world` is that of its numbers. */
static xform solid_place(const zt_object *o, const xform *world) {
    xform own = xform_identity();
    vec3 axis = {0, 0, 0};
    double wide = 1, length = 1;
    if (o->shape == ZT_SHAPE_BOX) {
        own = xform_place(o->box.center, o->box.rotation, o->box.size);
        return xform_mul(world, &own);
    }
    if (o->shape == ZT_SHAPE_SPHERE) {
        double r = o->sphere.radius;
        own = xform_place(o->sphere.center, (quat){1, 0, 0, 0}, (vec3){r, r, r});
        return xform_mul(world, &own);
    }
    if (o->shape == ZT_SHAPE_DISK) {
        axis = o->disk.normal, own.shift = o->disk.center, wide = length = o->disk.radius;
    } else if (o->shape == ZT_SHAPE_TORUS) {
        axis = o->torus.axis, own.shift = o->torus.center;
    } else {
        axis = vec3_sub(o->tube.to, o->tube.from), own.shift = o->tube.from;
        if (o->shape != ZT_SHAPE_CAPSULE) length = vec3_length(axis);
        if (o->shape == ZT_SHAPE_CYLINDER) wide = o->tube.radius;
    }
    vec3 z = vec3_normalize(axis), other = fabs(z.x) < .5 ? (vec3){1, 0, 0} : (vec3){0, 1, 0};
    vec3 x = vec3_normalize(vec3_cross(other, z));
    own.x = vec3_scale(x, wide);
    own.y = vec3_scale(vec3_cross(z, x), wide);
    own.z = vec3_scale(z, length);
    return xform_mul(world, &own);
}

/* The solid in that space: with sizes that are between those of two moments. */
static void canonical(zt_object *out, const zt_object *a, const zt_object *b, double s) {
    double r = mix(a->tube.radius, b->tube.radius, s);
    switch (a->shape) {
    case ZT_SHAPE_BOX:
        out->box = (zt_block){{0, 0, 0}, {1, 1, 1}, {1, 0, 0, 0}};
        break;
    case ZT_SHAPE_SPHERE:
        out->sphere = (zt_sphere){{0, 0, 0}, 1};
        break;
    case ZT_SHAPE_DISK:
        out->disk = (zt_disk){{0, 0, 0}, {0, 0, 1}, 1};
        break;
    case ZT_SHAPE_TORUS:
        out->torus = (zt_torus){{0, 0, 0},
                                {0, 0, 1},
                                mix(a->torus.radius, b->torus.radius, s),
                                mix(a->torus.tube_radius, b->torus.tube_radius, s)};
        break;
    case ZT_SHAPE_CYLINDER:
        out->tube = (zt_tube){{0, 0, 0}, {0, 0, 1}, 1, 1};
        break;
    case ZT_SHAPE_CONE:
        out->tube =
            (zt_tube){{0, 0, 0}, {0, 0, 1}, r, mix(a->tube.end_radius, b->tube.end_radius, s)};
        break;
    default:
        out->tube.from = (vec3){0, 0, 0};
        out->tube.to = (vec3){0, 0,
                              mix(vec3_length(vec3_sub(a->tube.to, a->tube.from)),
                                  vec3_length(vec3_sub(b->tube.to, b->tube.from)), s)};
        out->tube.radius = r;
    }
}

/* Its numbers, with sizes and the place changed by what a moment says; axes stay. */
static void set_solid(zt_object *o, uint64_t seed, double amount) {
    vec3 at = vec3_add((vec3){0, 0, 0}, vec3_scale(test_direction(&seed), amount));
    vec3 axis = test_direction(&seed);
    double size = 1 + amount * test_between(&seed, -.5, .5);
    double other = .3 + amount * test_between(&seed, -.2, .5);
    double length = 1.5 * (1 + amount * test_between(&seed, 0, .3));
    vec3 end = vec3_add(at, vec3_scale(axis, length));
    switch (o->shape) {
    case ZT_SHAPE_SPHERE:
        o->sphere = (zt_sphere){at, size};
        break;
    case ZT_SHAPE_DISK:
        o->disk = (zt_disk){at, axis, size};
        break;
    case ZT_SHAPE_BOX:
        o->box = (zt_block){at, {size, other, 1}, quat_axis_angle(axis, 1 + amount)};
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CAPSULE:
        o->tube = (zt_tube){at, end, size / 2, 0};
        break;
    case ZT_SHAPE_CONE:
        o->tube = (zt_tube){at, end, size, other};
        break;
    case ZT_SHAPE_TORUS:
        o->torus = (zt_torus){at, axis, size, other};
        break;
    default:
        break;
    }
}

static int compared, missed_both;

/* A ray through something near a point is met where the still one, asked by the ray in the
 * space of its own, says; rays that graze it aside. */
static void compare_solid(const stage *st, const stage *still, const xform *place, vec3 origin,
                          vec3 direction, double time, double precise) {
    zt_probe got = probe(st, origin, direction, time);
    xform back = xform_inverse(place);
    vec3 d = xform_vector(&back, direction);
    zt_probe want = probe(still, xform_point(&back, origin), d, 0);
    double scale = vec3_length(d);
    vec3 normal = {vec3_dot(want.normal, back.x), vec3_dot(want.normal, back.y),
                   vec3_dot(want.normal, back.z)};
    normal = vec3_normalize(normal);
    if ((got.object < 0) != (want.object < 0)) {
        /* Only where a hair's breadth to the sides it is otherwise as well. */
        bool hit = false, miss = false;
        for (int i = 0; i < 16; i++) {
            double w = i * .3927;
            vec3 aside = vec3_scale((vec3){cos(w), sin(w), cos(w + 2)}, 100 * precise);
            vec3 e = xform_vector(&back, vec3_add(direction, aside));
            bool met = probe(still, xform_point(&back, origin), e, 0).object >= 0;
            hit |= met, miss |= !met;
        }
        assert_true(hit && miss);
        return;
    }
    if (got.object < 0) {
        missed_both++;
        return;
    }
    double facing = -vec3_dot(normal, direction);
    if (facing < .1) return;
    compared++;
    double off = fabs(got.distance - want.distance / scale) / got.distance;
    double turned = vec3_length(vec3_sub(got.normal, normal));
    if (off > 200 * precise || (turned > 3000 * precise))
        print_message("shape %d: off %g, normal %g, time %g, precise %g\n",
                      (int)moments[0].objects[2].shape, off, turned, time, precise);
    assert_true(off < 200 * precise);
    /* Edges aside, where neighbours of a rounding have other normals. */
    if (turned < 3000 * precise) return;
    int same = 0;
    for (int i = 0; i < 16; i++) {
        double w = i * .3927;
        vec3 aside = vec3_scale((vec3){cos(w), sin(w), cos(w + 2)}, 300 * precise);
        vec3 e = xform_vector(&back, vec3_add(direction, aside));
        zt_probe p = probe(still, xform_point(&back, origin), e, 0);
        same += p.object >= 0 && vec3_length(vec3_sub(p.normal, want.normal)) < 1e-3;
    }
    assert_true(same < 16);
}

static void compare_shape(zt_shape shape, uint64_t seed, int count, zt_precision precision) {
    uint64_t draw = seed;
    for (int m = 0; m < count; m++) {
        test_scene *s = &moments[m];
        double amount = .5 * m / (count - 1);
        begin_moment(s);
        scene_material(s, (vec3){1, 1, 1}, 0);
        put_groups(s, seed + 1, amount, false);
        zt_object *o = scene_object(s, shape, 0);
        o->parent = 1;
        set_solid(o, seed + 2, amount);
        /* Space is relative to the first moment's camera, whatever later ones do. */
        s->scene.camera.position = (vec3){m == 0 ? 3 : 50, 2, 9};
    }
    film f;
    set_film(&f, &draw, count);
    stage st;
    open_stage(&st, &f.exposure, precision);
    assert_true(st.ready.moves);
    double precise = precision == ZT_PRECISION_SINGLE ? 0x1p-22 : 0x1p-48;
    for (int round = 0; round < 12; round++) {
        int m;
        double time = round == 0 ? 0 : round == 1 ? 1 : random_time(&draw);
        double between = find(&f, &m, time);
        xform worlds[2][3], places[2];
        for (int k = 0; k < 2; k++) {
            zt_scene_worlds(worlds[k], &f.scenes[m + k], f.scenes[0].camera.position);
            places[k] = solid_place(&f.scenes[m + k].objects[2], &worlds[k][2]);
        }
        xform place = mix_xform(&places[0], &places[1], between);
        test_scene own;
        begin_moment(&own);
        scene_material(&own, (vec3){1, 1, 1}, 0);
        canonical(scene_object(&own, shape, 0), &f.scenes[m].objects[2],
                  &f.scenes[m + 1].objects[2], between);
        stage still;
        open_still(&still, &own.scene);
        for (int i = 0; i < 60; i++) {
            vec3 origin = vec3_add(place.shift, vec3_scale(test_direction(&draw), 6));
            vec3 aim = xform_point(&place, vec3_scale(test_direction(&draw), .9));
            compare_solid(&st, &still, &place, origin, vec3_normalize(vec3_sub(aim, origin)),
                          time, precise);
        }
        close_stage(&still);
    }
    close_stage(&st);
}

static void test_solids(void **state) {
    (void)state;
    const zt_shape shapes[] = {ZT_SHAPE_SPHERE,   ZT_SHAPE_DISK, ZT_SHAPE_BOX,
                               ZT_SHAPE_CYLINDER, ZT_SHAPE_CONE, ZT_SHAPE_TORUS,
                               ZT_SHAPE_CAPSULE};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        for (int p = 0; p < 2; p++)
            for (uint64_t seed = 0; seed < 6; seed++)
                compare_shape(shapes[i], 100 * seed + i, seed % 2 ? 2 : MOMENTS_MAX,
                              precisions[p]);
    print_message("solids: %d compared, %d missed by both\n", compared, missed_both);
    assert_true(compared > 20000 && missed_both > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solids),
    };
    return cmocka_run_group_tests(tests, make_models, free_models);
}
