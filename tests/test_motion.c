/* What moves while the shutter is open: at each time it is met as something that stands still
 * where straight ways between the moments bring it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "meshes.h"
#include "scenes.h"
#include "tracer/kernel.h"

/* ---- exposures ------------------------------------------------------------------------------
 */

/* A cube, and a smooth ball. */
static zt_mesh models[2];

enum { MOMENTS_MAX = 9 };
static test_scene moments[MOMENTS_MAX];

static void begin_moment(test_scene *s) {
    scene_begin(s);
    s->scene.meshes = models;
    s->scene.mesh_count = 2;
}

typedef struct film {
    zt_scene scenes[MOMENTS_MAX];
    double times[MOMENTS_MAX];
    bool steps[MOMENTS_MAX];
    zt_exposure exposure;
} film;

/* Unevenly spread moments of `moments`. */
static void set_film(film *f, uint64_t *seed, int count) {
    for (int m = 0; m < count; m++) {
        f->scenes[m] = moments[m].scene;
        f->times[m] = m == 0 ? 0
                      : m == count - 1
                          ? 1
                          : floor(4000.0 * m / count + 90 * test_random(seed)) / 4096;
        f->steps[m] = false;
    }
    f->exposure = (zt_exposure){
        .moments = f->scenes, .times = f->times, .steps = f->steps, .moment_count = count};
}

/* Where a time is. */
static double find(const film *f, int *moment, double time) {
    int m = 0;
    while (m + 2 < f->exposure.moment_count && f->times[m + 1] <= time) m++;
    *moment = m;
    return (time - f->times[m]) / (f->times[m + 1] - f->times[m]);
}

static double mix(double a, double b, double s) { return (1 - s) * a + s * b; }
static vec3 mix3(vec3 a, vec3 b, double s) {
    return (vec3){mix(a.x, b.x, s), mix(a.y, b.y, s), mix(a.z, b.z, s)};
}
static xform mix_xform(const xform *a, const xform *b, double s) {
    return (xform){mix3(a->x, b->x, s), mix3(a->y, b->y, s), mix3(a->z, b->z, s),
                   mix3(a->shift, b->shift, s)};
}

/* ---- stages ---------------------------------------------------------------------------------
 */

typedef struct stage {
    zt_arena arena;
    zt_meshes *meshes;
    zt_ready ready;
    void *work;
} stage;

static void open_stage(stage *st, const zt_exposure *exposure, zt_precision precision) {
    const zt_scene *scene = exposure->moments;
    *st = (stage){0};
    assert_int_equal(
        zt_meshes_open(&st->meshes, scene->meshes, scene->mesh_count, 1, (zt_listener){0}),
        ZT_OK);
    zt_pixel pixel = {.angle = .01};
    assert_int_equal(
        zt_tracer_prepare(&st->ready, exposure, precision, pixel, st->meshes, &st->arena),
        ZT_OK);
    st->work = aligned_alloc(64, (zt_kernel_work_size() + 63) / 64 * 64);
    assert_non_null(st->work);
}

static void close_stage(stage *st) {
    free(st->work);
    zt_meshes_close(&st->meshes);
    zt_arena_free(&st->arena);
}

static void open_still(stage *st, const zt_scene *scene) {
    zt_exposure exposure = zt_exposure_of(scene);
    open_stage(st, &exposure, ZT_PRECISION_DOUBLE);
    assert_false(st->ready.moves);
}

static zt_probe probe(const stage *st, vec3 origin, vec3 direction, double time) {
    zt_probe p = {.origin = origin, .direction = direction, .time = time, .source = -1};
    st->ready.kernel->probe(st->ready.tracer, &p, 1, st->work);
    return p;
}

static const zt_precision precisions[] = {ZT_PRECISION_SINGLE, ZT_PRECISION_DOUBLE};

/* Numbers a time that single precision has exactly, as rays carry it. */
static double random_time(uint64_t *seed) { return floor(test_random(seed) * 65536) / 65536; }

/* ---- solids ---------------------------------------------------------------------------------
 */

static quat turn_by(uint64_t *seed, double angle) {
    return quat_axis_angle(test_direction(seed), angle);
}

/* A group within a group, that turn, stretch and carry along what is in them; the same seed
 * for all moments, and more of it at later ones. */
static void put_groups(test_scene *s, uint64_t seed, double amount, bool alike) {
    for (int g = 0; g < 2; g++) {
        zt_object *group = scene_object(s, ZT_SHAPE_GROUP, -1);
        group->parent = g - 1;
        zt_placement *p = &group->placement;
        p->position =
            vec3_add(test_direction(&seed), vec3_scale(test_direction(&seed), 1.5 * amount));
        quat first = turn_by(&seed, test_between(&seed, 0, 6));
        p->rotation = quat_mul(quat_axis_angle(test_direction(&seed), amount), first);
        double grow = 1 + .5 * amount * test_random(&seed);
        p->scale = (vec3){grow * exp(test_between(&seed, -.5, .5)),
                          exp(test_between(&seed, -.5, .5)), -1};
        if (alike) p->scale = (vec3){grow, grow, grow};
    }
}

/* The space in which a solid is canonical, if `world` is that of its numbers. */
static xform solid_place(const zt_object *o, const xform *world) {
    xform own = xform_identity();
    vec3 axis = {0, 0, 0};
    double wide = 1, length = 1;
    if (o->shape == ZT_SHAPE_MESH) {
        const zt_placement *p = &o->placement;
        own = xform_place(p->position, p->rotation, p->scale);
        return xform_mul(world, &own);
    }
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
    case ZT_SHAPE_MESH:
        *out = *a;
        out->parent = -1;
        out->placement = (zt_placement){{0, 0, 0}, {1, 0, 0, 0}, {1, 1, 1}};
        break;
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
    case ZT_SHAPE_MESH:
        o->mesh = (int32_t)(seed / 100 & 1);
        o->smooth = models[o->mesh].normals != NULL;
        o->placement = (zt_placement){at, quat_axis_angle(axis, 1 + amount), {size, other, 1}};
        break;
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

/* ---- rooms ----------------------------------------------------------------------------------
 */

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

/* ---- light ----------------------------------------------------------------------------------
 */

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

/* ---- corners of it --------------------------------------------------------------------------
 */

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
    models[0] = cube_mesh();
    ball_mesh ball = make_ball(3);
    models[1] = ball.mesh;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solids), cmocka_unit_test(test_rooms),
        cmocka_unit_test(test_light),  cmocka_unit_test(test_bits),
        cmocka_unit_test(test_still),  cmocka_unit_test(test_from_nothing),
        cmocka_unit_test(test_steps),  cmocka_unit_test(test_turning_axis),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    free_ball(&ball);
    return failed;
}
