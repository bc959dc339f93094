/* Rooms full of things that move while the shutter is open: at each time they look as they
 * would standing still where straight ways between the moments bring them, in hits, mirrors,
 * shadows and colours. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "moving.h"

/* Things that a still scene can be made of at each time: planes, spheres and triangles in a
 * group that turns and grows, solids and meshes that only go somewhere. Colors change, patterns
 * go with what they are on. */
enum { ROOM_GROUPED = 24, ROOM_ALONE = 16 };

static void put_alone(test_scene *s, uint64_t *seed, double amount) {
    const zt_shape shapes[] = {ZT_SHAPE_BOX,   ZT_SHAPE_CYLINDER, ZT_SHAPE_CONE,
                               ZT_SHAPE_TORUS, ZT_SHAPE_CAPSULE,  ZT_SHAPE_DISK,
                               ZT_SHAPE_MESH};
    zt_object *o =
        scene_object(s, shapes[(int)(test_random(seed) * 7)], (int32_t)(test_random(seed) * 4));
    vec3 at = vec3_scale(test_direction(seed), test_between(seed, 2, 5)),
         axis = test_direction(seed);
    at = vec3_add(at, vec3_scale(test_direction(seed), 3 * amount));
    double size = test_between(seed, .2, 1);
    if (o->shape == ZT_SHAPE_BOX)
        o->box = (zt_block){at, {size, .5, 2 * size}, quat_axis_angle(axis, 1)};
    else if (o->shape == ZT_SHAPE_DISK)
        o->disk = (zt_disk){at, axis, size};
    else if (o->shape == ZT_SHAPE_TORUS)
        o->torus = (zt_torus){at, axis, size, .3 * size};
    else if (o->shape == ZT_SHAPE_MESH)
        o->placement = (zt_placement){at, quat_axis_angle(axis, 1), {size, .5, size}};
    else
        o->tube = (zt_tube){at, vec3_add(at, axis), size / 2, size / 4};
    o->mesh = o->shape == ZT_SHAPE_MESH ? (int32_t)(test_random(seed) * 2) : -1;
}

static void make_room(test_scene *s, uint64_t seed, double amount, int alone) {
    begin_moment(s);
    for (int i = 0; i < 4; i++) {
        vec3 a = {test_random(&seed), test_random(&seed), test_random(&seed)};
        vec3 b = {test_random(&seed), test_random(&seed), test_random(&seed)};
        scene_material(s, i % 2 ? mix3(a, b, amount) : a, i == 1 ? .2 + .5 * amount : .3);
        zt_material *m = &s->materials[i];
        m->pattern = i < 2 ? ZT_PATTERN_NONE : ZT_PATTERN_CHECKER + i % 2;
        m->other_color = mix3(b, a, amount);
        m->pattern_size = .4;
        m->pattern_direction = (vec3){1, 2, 3};
    }
    uint64_t own = seed;
    put_groups(s, seed, amount, true);
    for (int i = 0; i < ROOM_GROUPED; i++) {
        zt_shape shape = i == 0       ? ZT_SHAPE_PLANE
                         : i % 2 == 0 ? ZT_SHAPE_TRIANGLE
                                      : ZT_SHAPE_SPHERE;
        zt_object *o = scene_object(s, shape, i % 2); /* patterns of these would turn */
        o->parent = 1;
        vec3 at = vec3_scale(test_direction(&own), test_between(&own, 1, 4));
        if (shape == ZT_SHAPE_PLANE) o->plane = (zt_plane){test_direction(&own), 6};
        if (shape == ZT_SHAPE_SPHERE)
            o->sphere = (zt_sphere){at, (.1 + test_random(&own)) * (1 - .3 * amount)};
        for (int k = 0; k < 3 && shape == ZT_SHAPE_TRIANGLE; k++)
            o->triangle.vertices[k] = vec3_add(at, test_direction(&own));
    }
    for (int i = 0; i < alone; i++) put_alone(s, &own, amount);
    scene_ambient(s, (vec3){1, 1, 1}, .2);
    scene_point_light(s, (vec3){1, 7, 2}, 20);
    scene_point_light(s, (vec3){-5, -2, 6}, 20);
    s->scene.camera.position = (vec3){0, 0, 9};
}

/* The room as it stands at a time between two moments, the first one's camera left in the
 * origin. */
static void mix_room(test_scene *out, const film *f, double time) {
    int m;
    double s = find(f, &m, time);
    const zt_scene *a = &f->scenes[m], *b = &f->scenes[m + 1];
    static xform from[SCENE_OBJECTS_MAX], to[SCENE_OBJECTS_MAX];
    zt_scene_worlds(from, a, (vec3){0, 0, 0});
    zt_scene_worlds(to, b, (vec3){0, 0, 0});
    begin_moment(out);
    out->scene.camera.position = f->scenes[0].camera.position;
    for (int i = 0; i < a->material_count; i++) {
        scene_material(out, mix3(a->materials[i].color, b->materials[i].color, s),
                       mix(a->materials[i].reflectivity, b->materials[i].reflectivity, s));
        out->materials[i].pattern = a->materials[i].pattern;
        out->materials[i].other_color =
            mix3(a->materials[i].other_color, b->materials[i].other_color, s);
        out->materials[i].pattern_size = a->materials[i].pattern_size;
        out->materials[i].pattern_direction = a->materials[i].pattern_direction;
    }
    for (int i = 0; i < a->light_count; i++) out->lights[i] = a->lights[i];
    out->scene.light_count = a->light_count;
    for (int i = 0; i < a->object_count; i++) {
        const zt_object *p = &a->objects[i], *q = &b->objects[i];
        zt_object *o = scene_object(out, p->shape, p->material);
        *o = *p;
        o->parent = -1;
        if (p->shape == ZT_SHAPE_SPHERE) {
            o->sphere.center = mix3(xform_point(&from[i], p->sphere.center),
                                    xform_point(&to[i], q->sphere.center), s);
            o->sphere.radius = mix(p->sphere.radius * vec3_length(from[i].x),
                                   q->sphere.radius * vec3_length(to[i].x), s);
        } else if (p->shape == ZT_SHAPE_TRIANGLE) {
            for (int k = 0; k < 3; k++)
                o->triangle.vertices[k] = mix3(xform_point(&from[i], p->triangle.vertices[k]),
                                               xform_point(&to[i], q->triangle.vertices[k]), s);
        } else if (p->shape == ZT_SHAPE_PLANE) {
            /* The planes' equations as seen from the camera. */
            vec3 eye = a->camera.position, n[2];
            double d[2];
            for (int k = 0; k < 2; k++) {
                const xform *w = k ? &to[i] : &from[i];
                const zt_plane *own = k ? &q->plane : &p->plane;
                n[k] = vec3_normalize(xform_vector(w, own->normal));
                vec3 on = vec3_scale(vec3_normalize(own->normal), own->distance);
                d[k] = vec3_dot(n[k], vec3_sub(xform_point(w, on), eye));
            }
            vec3 normal = mix3(n[0], n[1], s);
            o->plane.normal = normal;
            o->plane.distance =
                (mix(d[0], d[1], s) + vec3_dot(normal, eye)) / vec3_length(normal);
        } else if (p->shape == ZT_SHAPE_MESH) {
            o->placement.position = mix3(p->placement.position, q->placement.position, s);
        } else if (p->shape == ZT_SHAPE_BOX) {
            o->box.center = mix3(p->box.center, q->box.center, s);
        } else if (p->shape == ZT_SHAPE_DISK) {
            o->disk.center = mix3(p->disk.center, q->disk.center, s);
        } else if (p->shape == ZT_SHAPE_TORUS) {
            o->torus.center = mix3(p->torus.center, q->torus.center, s);
        } else if (p->shape != ZT_SHAPE_GROUP) {
            o->tube.from = mix3(p->tube.from, q->tube.from, s);
            o->tube.to = mix3(p->tube.to, q->tube.to, s);
        }
    }
}

static void make_film(film *f, uint64_t seed, int count, int alone) {
    for (int m = 0; m < count; m++) make_room(&moments[m], seed, .6 * m / (count - 1), alone);
    set_film(f, &seed, count);
}

static zt_probe random_probe(uint64_t *seed, double time) {
    vec3 origin = vec3_scale(test_direction(seed), 7);
    vec3 aim = vec3_scale(test_direction(seed), 4);
    return (zt_probe){.origin = vec3_add(origin, (vec3){0, 0, -9}),
                      .direction = vec3_normalize(vec3_sub(aim, origin)),
                      .time = time,
                      .source = -1};
}

/* Rays and the mirrored rays that go on from where they end, at the same time, see what they
 * see in the still room; the lamps shine on the same points. */
static void compare_room(uint64_t seed, int count, int alone, zt_precision precision) {
    static test_scene own;
    film f;
    stage st, still;
    make_film(&f, seed, count, alone);
    open_stage(&st, &f.exposure, precision);
    int hits = 0, others = 0, shadows = 0, mirrored = 0;
    for (int round = 0; round < 6; round++) {
        double time = random_time(&seed);
        mix_room(&own, &f, time);
        open_still(&still, &own.scene);
        for (int i = 0; i < 200; i++) {
            zt_probe p = random_probe(&seed, time), q = p;
            for (int depth = 0; depth < 2; depth++) {
                st.ready.kernel->probe(st.ready.tracer, &p, 1, st.work);
                still.ready.kernel->probe(still.ready.tracer, &q, 1, still.work);
                hits += p.object >= 0;
                mirrored += depth > 0 && p.object >= 0;
                bool same = p.object == q.object;
                if (p.object >= 0 && same) {
                    double least = precision == ZT_PRECISION_SINGLE ? 1e-4 : 1e-11;
                    double room = (1 + q.distance) / -vec3_dot(q.normal, q.direction);
                    same = vec3_length(vec3_sub(p.point, q.point)) < least * room &&
                           vec3_length(vec3_sub(p.normal, q.normal)) < 50 * least;
                    shadows += p.lit != q.lit;
                }
                others += !same;
                if (p.object < 0 || !same) break;
                p = (zt_probe){.origin = p.mirror_origin,
                               .direction = p.mirror_direction,
                               .source = p.mirror_source,
                               .time = time};
                q = (zt_probe){.origin = q.mirror_origin,
                               .direction = q.mirror_direction,
                               .source = q.mirror_source};
            }
        }
        close_stage(&still);
    }
    close_stage(&st);
    /* In single precision a ray or two end on the other side of an edge. */
    bool single = precision == ZT_PRECISION_SINGLE;
    if (others + shadows > (single ? 3 : 0))
        print_message("%d of %d hits (%d mirrored) are others, %d other shadows\n", others,
                      hits, mirrored, shadows);
    assert_true(hits > 400 && mirrored > 50);
    assert_true(others + shadows <= (single ? 3 : 0));
}

static void test_rooms(void **state) {
    (void)state;
    for (int p = 0; p < 2; p++)
        for (uint64_t seed = 0; seed < 4; seed++) {
            compare_room(seed, seed % 2 ? 2 : MOMENTS_MAX, 4, precisions[p]);
            compare_room(seed, seed % 2 ? 2 : MOMENTS_MAX, ROOM_ALONE, precisions[p]);
        }
}

/* A batch of rays from the camera, each at a time of its own, or all at one. */
static void make_rays(zt_rays *rays, uint64_t *seed, double time) {
    rays->count = ZT_BATCH;
    for (int i = 0; i < ZT_BATCH; i++) {
        rays->ox[i] = rays->oy[i] = rays->oz[i] = 0;
        rays->dx[i] = test_between(seed, -.5, .5);
        rays->dy[i] = test_between(seed, -.5, .5);
        rays->dz[i] = -1;
        double own = random_time(seed);
        rays->time[i] = (float)(time < 0 ? own : time);
    }
}

/* Colors, mirrors and patterns are those of the still room, edges aside. */
static void test_light(void **state) {
    (void)state;
    static test_scene own;
    static zt_rays rays;
    static zt_radiance got, wanted;
    film f;
    stage st, still;
    int black = 0, others = 0;
    for (uint64_t seed = 10; seed < 16; seed++) {
        make_film(&f, seed, seed % 2 ? 2 : MOMENTS_MAX, ROOM_ALONE);
        open_stage(&st, &f.exposure, ZT_PRECISION_DOUBLE);
        for (int round = 0; round < 6; round++) {
            uint64_t draw = seed + 100;
            double time = random_time(&draw);
            mix_room(&own, &f, time);
            open_still(&still, &own.scene);
            make_rays(&rays, &draw, time);
            st.ready.kernel->trace(&got, st.ready.tracer, &rays, st.work);
            still.ready.kernel->trace(&wanted, still.ready.tracer, &rays, still.work);
            for (int i = 0; i < ZT_BATCH; i++) {
                float off = fabsf(got.r[i] - wanted.r[i]) + fabsf(got.g[i] - wanted.g[i]) +
                            fabsf(got.b[i] - wanted.b[i]);
                others += off > 1e-6F;
                black += wanted.r[i] == 0;
            }
            close_stage(&still);
        }
        close_stage(&st);
    }
    assert_true(black < 36 * ZT_BATCH / 3);
    assert_int_equal(others, 0);
}

static void assert_same_light(const zt_radiance *a, const zt_radiance *b, int count) {
    size_t size = (size_t)count * sizeof(float);
    assert_memory_equal(a->r, b->r, size);
    assert_memory_equal(a->g, b->g, size);
    assert_memory_equal(a->b, b->b, size);
}

/* All widths of instructions give the same bits, and a ray sees the same by itself as among
 * others, which pass things by together. */
static void test_bits(void **state) {
    (void)state;
    const char *const names[] = {"scalar", "base", "avx2", "avx512"};
    static zt_rays rays, one;
    static zt_radiance wanted, got;
    film f;
    stage st;
    for (uint64_t seed = 20; seed < 24; seed++)
        for (int p = 0; p < 2; p++) {
            make_film(&f, seed, seed % 2 ? 2 : MOMENTS_MAX, seed < 22 ? 6 : 40);
            uint64_t draw = seed;
            make_rays(&rays, &draw, -1);
            for (int i = 0; i < 4; i++) {
                setenv("ZOETROPE_ISA", names[i], 1);
                open_stage(&st, &f.exposure, precisions[p]);
                st.ready.kernel->trace(i > 0 ? &got : &wanted, st.ready.tracer, &rays, st.work);
                if (i > 0) assert_same_light(&got, &wanted, ZT_BATCH);
                for (int k = 0; i == 2 && k < ZT_BATCH; k++) {
                    one = rays;
                    one.count = 1;
                    one.dx[0] = rays.dx[k], one.dy[0] = rays.dy[k], one.time[0] = rays.time[k];
                    st.ready.kernel->trace(&got, st.ready.tracer, &one, st.work);
                    assert_true(got.r[0] == wanted.r[k] && got.g[0] == wanted.g[k]);
                }
                close_stage(&st);
            }
            unsetenv("ZOETROPE_ISA");
        }
}

/* An exposure in which all moments are the same has nothing that moves, and the bits of one. */
static void test_still(void **state) {
    (void)state;
    static zt_rays rays;
    static zt_radiance wanted, got;
    film f;
    stage st;
    uint64_t seed = 30;
    for (int m = 0; m < 3; m++) make_room(&moments[m], seed, .2, ROOM_ALONE);
    set_film(&f, &seed, 3);
    make_rays(&rays, &seed, -1);
    open_still(&st, f.scenes);
    st.ready.kernel->trace(&wanted, st.ready.tracer, &rays, st.work);
    close_stage(&st);
    open_stage(&st, &f.exposure, ZT_PRECISION_DOUBLE);
    assert_false(st.ready.moves);
    st.ready.kernel->trace(&got, st.ready.tracer, &rays, st.work);
    close_stage(&st);
    assert_same_light(&got, &wanted, ZT_BATCH);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rooms),
        cmocka_unit_test(test_light),
        cmocka_unit_test(test_bits),
        cmocka_unit_test(test_still),
    };
    return cmocka_run_group_tests(tests, make_models, free_models);
}
