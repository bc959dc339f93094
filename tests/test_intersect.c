/* Intersections against closed forms in long double, edges and ties, and meshes against their
 * own planes. Compiled once for each precision. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#define ZT_ISA base
#include "scenes.h"
#include "tracer/intersect.h"
#include "tracer/prepare.h"

typedef long double exact;

typedef struct exact3 {
    exact x, y, z;
} exact3;

static exact3 exact_of(real3 v) { return (exact3){v.x, v.y, v.z}; }
static exact3 exact_vec(vec3 v) { return (exact3){v.x, v.y, v.z}; }
static exact exact_dot(exact3 a, exact3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static exact3 exact_sub(exact3 a, exact3 b) {
    return (exact3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static real3 real_vec(vec3 v) { return (real3){(real)v.x, (real)v.y, (real)v.z}; }

/* Unit as far as roundings go. */
typedef struct ray {
    real3 o, d;
} ray;

static ray ray_from(vec3 o, vec3 d) { return (ray){real_vec(o), real_vec(d)}; }

static real meet(const zt_primitive *p, ray r, int32_t leaving) {
#define MEET(kind) zt_##kind##_distance(p, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, leaving, 0)
    switch (p->kind) {
    case ZT_PRIMITIVE_PLANE:
        return MEET(plane);
    case ZT_PRIMITIVE_SPHERE:
        return MEET(sphere);
    case ZT_PRIMITIVE_TRIANGLE:
        return MEET(triangle);
    case ZT_PRIMITIVE_BALL:
        return MEET(ball);
    default:
        fail();
        return 0;
    }
}

static bool hits(const zt_primitive *p, ray r) { return meet(p, r, 0) < REAL_INFINITY; }

/* The nearest positive root for a sphere, or infinity; *condition is how much the distance
 * reacts to changes of the ray: large for grazing ones. */
static exact sphere_exact(exact *condition, real3 center, real radius, ray r) {
    exact3 f = exact_sub(exact_of(r.o), exact_of(center)), d = exact_of(r.d);
    exact a = exact_dot(d, d), b = -exact_dot(f, d) / a;
    exact3 l = {f.x + b * d.x, f.y + b * d.y, f.z + b * d.z};
    exact inside = (exact)radius * radius - exact_dot(l, l);
    if (inside <= 0) {
        *condition = INFINITY;
        return INFINITY;
    }
    exact half = sqrtl(inside / a);
    exact t = b - half > 0 ? b - half : b + half;
    *condition = (fabsl(b) + radius) / half * (fabsl(b) + radius) / fabsl(t);
    return t > 0 ? t : INFINITY;
}

static zt_primitive sphere_of(vec3 center, double radius) {
    return (zt_primitive){.kind = ZT_PRIMITIVE_SPHERE,
                          .sphere = {real_vec(center), (real)radius}};
}

/* Spheres from outside and inside: a hit where there is one, at a distance whose error is a few
 * roundings times the condition. */
static void test_sphere(void **state) {
    (void)state;
    uint64_t seed = 1;
    int hit_count = 0, inside_count = 0;
    exact worst = 0;
    for (int i = 0; i < 200000; i++) {
        double radius = exp(test_between(&seed, -4, 4));
        vec3 center = vec3_scale(test_direction(&seed), test_between(&seed, 0, 3 * radius));
        zt_primitive p = sphere_of(center, radius);
        ray r = ray_from((vec3){0, 0, 0}, test_direction(&seed));
        exact condition, wanted = sphere_exact(&condition, p.sphere.center, p.sphere.radius, r);
        real got = meet(&p, r, 0);
        if (condition > 1e4L) continue; /* too close to tangent for either to say */
        assert_true((got < REAL_INFINITY) == (wanted < (exact)INFINITY));
        if (!(got < REAL_INFINITY)) continue;
        hit_count++;
        inside_count += vec3_length(center) < radius;
        exact error = fabsl(got - wanted) / wanted / condition;
        if (error > worst) worst = error;
    }
    printf("sphere: %d hits, %d from inside, worst relative error / condition %.2Lg\n",
           hit_count, inside_count, worst);
    assert_true(hit_count > 50000 && inside_count > 10000);
    assert_true(worst < 8 * (exact)REAL_ROUNDING);
}

/* A ray in the equator's plane passes above the pole's height or below it: a < radius decides.
 */
static void test_sphere_limb(void **state) {
    (void)state;
    zt_primitive p = sphere_of((vec3){0, 0, -4}, 1);
    assert_true(hits(&p, ray_from((vec3){0, 0.999999, 0}, (vec3){0, 0, -1})));
    assert_false(hits(&p, ray_from((vec3){0, 1.000001, 0}, (vec3){0, 0, -1})));
    assert_false(hits(&p, ray_from((vec3){0, 1, 0}, (vec3){0, 0, -1})));
    assert_true(meet(&p, ray_from((vec3){0, 0, 0}, (vec3){0, 0, -1}), 0) == 3);
    assert_true(meet(&p, ray_from((vec3){0, 0, -4}, (vec3){0, 0, -1}), 0) == 1);
    assert_false(hits(&p, ray_from((vec3){0, 0, 0}, (vec3){0, 0, 1}))); /* behind */
}

/* A ray that leaves a sphere, give or take the roundings of where it begins, never meets it
 * again outside, and inside the length of the chord away, however short. */
static void test_sphere_left(void **state) {
    (void)state;
    uint64_t seed = 9;
    for (int i = 0; i < 100000; i++) {
        double radius = exp(test_between(&seed, -4, 4));
        vec3 center = vec3_scale(test_direction(&seed), test_between(&seed, 0, 3 * radius));
        vec3 normal = test_direction(&seed), d = test_direction(&seed);
        zt_primitive p = sphere_of(center, radius);
        ray r = ray_from(vec3_add(center, vec3_scale(normal, radius)), d);
        assert_true(meet(&p, r, 1) == REAL_INFINITY);
        if (vec3_dot(normal, d) > 0) r.d = (real3){-r.d.x, -r.d.y, -r.d.z};
        exact chord = 2 * radius * fabsl((exact)vec3_dot(normal, d));
        exact reach = vec3_max_abs(center) + radius;
        real got = meet(&p, r, -1);
        assert_true(got > 0 && got < REAL_INFINITY);
        assert_true(fabsl(got - chord) < 16 * (exact)REAL_ROUNDING * reach);
    }
}

static void test_plane(void **state) {
    (void)state;
    uint64_t seed = 2;
    exact worst = 0;
    for (int i = 0; i < 100000; i++) {
        zt_primitive p = {
            .kind = ZT_PRIMITIVE_PLANE,
            .plane = {real_vec(test_direction(&seed)), (real)test_between(&seed, -5, 5)}};
        ray r = ray_from((vec3){0, 0, 0}, test_direction(&seed));
        exact down = exact_dot(exact_of(p.plane.normal), exact_of(r.d));
        if (fabsl(down) < 1e-3L) continue;
        exact wanted = p.plane.distance / down;
        real got = meet(&p, r, 0);
        assert_true((got < REAL_INFINITY) == (wanted > 0));
        if (wanted > 0) worst = fmaxl(worst, fabsl(got - wanted) / wanted * fabsl(down));
    }
    printf("plane: worst relative error / condition %.2Lg\n", worst);
    assert_true(worst < 8 * (exact)REAL_ROUNDING);
    zt_primitive p = {.kind = ZT_PRIMITIVE_PLANE, .plane = {{0, 1, 0}, -1}};
    ray above = ray_from((vec3){0, -.5, 0}, (vec3){0, -1, 0});
    assert_false(hits(&p, ray_from((vec3){0, 0, 0}, (vec3){1, 0, 0})));  /* along it */
    assert_false(hits(&p, ray_from((vec3){0, -1, 0}, (vec3){1, 0, 0}))); /* within it */
    assert_true(meet(&p, above, 0) == (real).5);
    assert_true(meet(&p, above, 1) == REAL_INFINITY); /* as if it began on it */
}

/* Undoes a placement, step by step. */
static exact3 undo(const zt_placement *g, exact3 v, bool is_point) {
    if (is_point) v = exact_sub(v, exact_vec(g->position));
    quat q = g->rotation;
    exact n = sqrtl((exact)q.w * q.w + (exact)q.x * q.x + (exact)q.y * q.y + (exact)q.z * q.z);
    exact w = q.w / n, x = -q.x / n, y = -q.y / n, z = -q.z / n;
    exact3 u = {2 * (y * v.z - z * v.y), 2 * (z * v.x - x * v.z), 2 * (x * v.y - y * v.x)};
    exact3 c = {y * u.z - z * u.y, z * u.x - x * u.z, x * u.y - y * u.x};
    return (exact3){(v.x + w * u.x + c.x) / g->scale.x, (v.y + w * u.y + c.y) / g->scale.y,
                    (v.z + w * u.z + c.z) / g->scale.z};
}

static zt_placement random_placement(uint64_t *seed, double far) {
    vec3 scale = {test_between(seed, .2, 4), test_between(seed, .2, 4),
                  test_between(seed, -4, -.2)};
    return (zt_placement){vec3_scale(test_direction(seed), far),
                          quat_axis_angle(test_direction(seed), test_between(seed, 0, 6)),
                          scale};
}

/* Makes a scene ready as it is when nothing chooses a precision. */
static const zt_tracer *prepare(const zt_scene *scene, zt_meshes *meshes, zt_arena *arena) {
    zt_tracer *tracer;
    zt_extents extents;
    zt_exposure exposure = zt_exposure_of(scene);
    zt_needs needs;
    assert_int_equal(zt_needs_find(&needs, &exposure, false, arena), ZT_OK);
    assert_int_equal(
        ZT_REAL_NAME(zt_prepare)(&tracer, &extents, &exposure, &needs, false, meshes, arena),
        ZT_OK);
    assert_int_equal(ZT_REAL_NAME(zt_prepare_search)(tracer, meshes, arena), ZT_OK);
    return tracer;
}

/* A sphere sheared by two groups equals the closed form in the space of its own numbers. */
static void test_sheared_sphere(void **state) {
    (void)state;
    uint64_t seed = 3;
    int hit_count = 0;
    exact worst = 0;
    zt_meshes *none;
    assert_int_equal(zt_meshes_open(&none, NULL, 0, 1, (zt_listener){0}), ZT_OK);
    for (int i = 0; i < 20000; i++) {
        static test_scene s;
        scene_begin(&s);
        scene_material(&s, (vec3){1, 1, 1}, 0);
        zt_placement outer = random_placement(&seed, 6), inner = random_placement(&seed, .5);
        scene_object(&s, ZT_SHAPE_GROUP, -1)->placement = outer;
        zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
        group->placement = inner;
        group->parent = 0;
        scene_sphere(&s, (vec3){.1, .2, .3}, 1.5, 0);
        s.objects[2].parent = 1;
        zt_arena arena = {0};
        const zt_tracer *tracer = prepare(&s.scene, none, &arena);
        assert_int_equal(tracer->primitive_count, 1);
        zt_primitive ball = tracer->primitives[0];
        assert_int_equal(ball.kind, ZT_PRIMITIVE_BALL);
        zt_arena_free(&arena);

        vec3 toward = vec3_add(outer.position, vec3_scale(test_direction(&seed), 8));
        ray r = ray_from((vec3){0, 0, 0}, vec3_normalize(toward));
        exact3 o = undo(&inner, undo(&outer, exact_of(r.o), true), true);
        exact3 e = undo(&inner, undo(&outer, exact_of(r.d), false), false);
        exact3 f = exact_sub(o, (exact3){.1, .2, .3});
        exact a = exact_dot(e, e), b = exact_dot(e, f), c = exact_dot(f, f) - 1.5L * 1.5L;
        exact root = b * b - a * c;
        if (fabsl(root) < 1e-2L * b * b) continue; /* grazing */
        exact near = root > 0 ? (-b - sqrtl(root)) / a : -1;
        exact far = root > 0 ? (-b + sqrtl(root)) / a : -1;
        exact wanted = near > 0 ? near : far;
        if (fabsl(near) < .1L || fabsl(far) < .1L) continue; /* begins on it, nearly */
        real got = meet(&ball, r, 0);
        assert_true((got < REAL_INFINITY) == (wanted > 0));
        if (!(wanted > 0)) continue;
        hit_count++;
        worst = fmaxl(worst, fabsl(got - wanted) / (wanted + 1) / ball.stretch);
    }
    zt_meshes_close(&none);
    printf("sheared sphere: %d hits, worst relative error / stretch %.2Lg\n", hit_count, worst);
    assert_true(hit_count > 2000);
    assert_true(worst < 256 * (exact)REAL_ROUNDING);
}

static zt_primitive triangle_of(vec3 a, vec3 b, vec3 c) {
    return (zt_primitive){.kind = ZT_PRIMITIVE_TRIANGLE,
                          .triangle = {{real_vec(a), real_vec(b), real_vec(c)}}};
}

/* Inside or outside by the signs of volumes, the distance by the plane: in long double. */
static void test_triangle(void **state) {
    (void)state;
    uint64_t seed = 4;
    int hit_count = 0, beyond_diagonal = 0;
    const exact doubt = 256 * (exact)REAL_ROUNDING;
    for (int i = 0; i < 200000; i++) {
        zt_primitive p = triangle_of(vec3_scale(test_direction(&seed), 5),
                                     vec3_scale(test_direction(&seed), 5),
                                     vec3_scale(test_direction(&seed), 5));
        ray r = ray_from((vec3){0, 0, 0}, test_direction(&seed));
        exact3 a = exact_of(p.triangle.vertices[0]);
        exact3 e1 = exact_sub(exact_of(p.triangle.vertices[1]), a);
        exact3 e2 = exact_sub(exact_of(p.triangle.vertices[2]), a);
        exact3 d = exact_of(r.d), o = exact_sub(exact_of(r.o), a);
        exact3 q = {d.y * e2.z - d.z * e2.y, d.z * e2.x - d.x * e2.z, d.x * e2.y - d.y * e2.x};
        exact determinant = exact_dot(e1, q);
        if (fabsl(determinant) < 1) continue;
        exact beta = exact_dot(o, q) / determinant;
        exact3 w = {o.y * e1.z - o.z * e1.y, o.z * e1.x - o.x * e1.z, o.x * e1.y - o.y * e1.x};
        exact gamma = exact_dot(d, w) / determinant, t = exact_dot(e2, w) / determinant;
        exact margin = fminl(fminl(beta, gamma), 1 - beta - gamma);
        if (fabsl(margin) < doubt || fabsl(t) < doubt) continue;
        beyond_diagonal += beta > 0 && beta < 1 && gamma > 0 && gamma < 1 && beta + gamma > 1;
        assert_true(hits(&p, r) == (margin > 0 && t > 0));
        if (margin > 0 && t > 0) {
            hit_count++;
            assert_true(fabsl(meet(&p, r, 0) - t) < doubt * (1 + t));
            assert_true(meet(&p, r, 1) == REAL_INFINITY);
        }
    }
    printf("triangle: %d hits, %d rays with beta + gamma > 1\n", hit_count, beyond_diagonal);
    assert_true(hit_count > 5000 && beyond_diagonal > 500);
}

/* A fan closed around a vertex, aimed at from the origin exactly at its vertex, along its edges
 * and at random: each ray meets exactly one triangle of it. */
static void test_triangle_edges(void **state) {
    (void)state;
    enum { BLADES = 7 };
    uint64_t seed = 5;
    for (int round = 0; round < 3000; round++) {
        vec3 tip = {0, 0, -4}, rim[BLADES];
        if (round % 2)
            tip = (vec3){test_between(&seed, -.2, .2), test_between(&seed, -.2, .2), -3};
        for (int i = 0; i < BLADES; i++) {
            double angle = 6.283185307179586 * i / BLADES;
            rim[i] = (vec3){cos(angle), sin(angle), -4 + test_between(&seed, -.3, .3)};
        }
        zt_primitive fan[BLADES];
        for (int i = 0; i < BLADES; i++) {
            vec3 a = rim[i], b = rim[(i + 1) % BLADES];
            fan[i] = round % 3 ? triangle_of(tip, a, b) : triangle_of(b, tip, a);
        }
        for (int shot = 0; shot < 3 * BLADES + 1; shot++) {
            vec3 at = shot % 3 ? rim[shot % BLADES] : tip;
            double along = shot % 3 == 1 ? 0.5 : test_between(&seed, 0, .9);
            at = vec3_add(tip, vec3_scale(vec3_sub(at, tip), along));
            ray r = ray_from((vec3){0, 0, 0}, at); /* not unit: it need not be for this */
            int count = 0;
            for (int i = 0; i < BLADES; i++) count += hits(&fan[i], r);
            assert_int_equal(count, 1);
        }
    }
    /* Axis-aligned, so that edge tests come out exactly zero: a 2 x 2 square cut twice. */
    vec3 c[9];
    for (int i = 0; i < 9; i++) c[i] = (vec3){i % 3 - 1, i / 3 - 1, -2};
    for (int x = -4; x <= 4; x++)
        for (int y = -4; y <= 4; y++) {
            ray r = ray_from((vec3){0, 0, 0}, (vec3){x / 4.0 * .98, y / 4.0 * .98, -2});
            if (x % 4 == 0 && y % 4 == 0 && (x == 4 || x == -4 || y == 4 || y == -4)) continue;
            int count = 0;
            for (int i = 0; i < 4; i++) {
                int k = i % 2 + 3 * (i / 2);
                zt_primitive low = triangle_of(c[k], c[k + 1], c[k + 3]);
                zt_primitive high = triangle_of(c[k + 4], c[k + 3], c[k + 1]);
                count += hits(&low, r) + hits(&high, r);
            }
            assert_int_equal(count, 1);
        }
}

static const float cube_positions[8 * 3 + 1] = {-1, -1, -1, 1, -1, -1, -1, 1, -1, 1, 1, -1,
                                                -1, -1, 1,  1, -1, 1,  -1, 1, 1,  1, 1, 1};
static const uint32_t cube_triangles[12 * 3] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6,
                                                0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7,
                                                0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
static const zt_mesh cube = {.positions = cube_positions,
                             .triangles = cube_triangles,
                             .vertex_count = 8,
                             .triangle_count = 12,
                             .low = {-1, -1, -1},
                             .high = {1, 1, 1}};

static zt_origins from;
static zt_batch rays = {.from = &from};

static void set_ray(int i, vec3 o, vec3 d) {
    from.x[i] = (real)o.x, from.y[i] = (real)o.y, from.z[i] = (real)o.z;
    from.near[i] = (real)vec3_max_abs(o) * TIE;
    from.source[i] = -1;
    rays.dx[i] = (real)d.x, rays.dy[i] = (real)d.y, rays.dz[i] = (real)d.z;
}

static void intersect(const zt_tracer *tracer) {
    zt_bundle bundle = {.origins = zt_range3(from.x, from.y, from.z, rays.count),
                        .directions = zt_range3(rays.dx, rays.dy, rays.dz, rays.count),
                        .source = -1};
    ZT_KERNEL_NAME(zt_intersect)(&rays, &bundle, tracer);
}

/* A turned, stretched, sheared and moved cube of triangles, met from everywhere: never missed
 * from within, and where the six planes of the cube say. */
static void test_mesh(void **state) {
    (void)state;
    uint64_t seed = 6;
    int hit_count = 0;
    zt_meshes *meshes;
    assert_int_equal(zt_meshes_open(&meshes, &cube, 1, 1, (zt_listener){0}), ZT_OK);
    for (int round = 0; round < 300; round++) {
        static test_scene s;
        scene_begin(&s);
        scene_material(&s, (vec3){1, 1, 1}, 0);
        zt_placement outer = random_placement(&seed, round % 2 ? .05 : 7);
        zt_placement inner = random_placement(&seed, .1);
        scene_object(&s, ZT_SHAPE_GROUP, -1)->placement = outer;
        zt_object *object = scene_object(&s, ZT_SHAPE_MESH, 0);
        object->mesh = 0;
        object->parent = 0;
        object->placement = inner;
        s.scene.meshes = &cube;
        s.scene.mesh_count = 1;
        zt_arena arena = {0};
        const zt_tracer *tracer = prepare(&s.scene, meshes, &arena);
        assert_int_equal(tracer->placed_count, 1);
        rays.count = 100;
        for (int i = 0; i < rays.count; i++) set_ray(i, (vec3){0, 0, 0}, test_direction(&seed));
        intersect(tracer);
        exact3 o = undo(&inner, undo(&outer, (exact3){0, 0, 0}, true), true);
        for (int i = 0; i < rays.count; i++) {
            exact3 d = {rays.dx[i], rays.dy[i], rays.dz[i]};
            d = undo(&inner, undo(&outer, d, false), false);
            exact enter = -INFINITY, leave = INFINITY;
            const exact *oo = &o.x, *dd = &d.x;
            for (int axis = 0; axis < 3; axis++) {
                exact t0 = (-1 - oo[axis]) / dd[axis], t1 = (1 - oo[axis]) / dd[axis];
                enter = fmaxl(enter, fminl(t0, t1));
                leave = fminl(leave, fmaxl(t0, t1));
            }
            if (fabsl(leave - enter) < 1e-2L || fabsl(leave) < 1e-2L || fabsl(enter) < 1e-2L)
                continue; /* along an edge, or from the surface */
            bool wanted = leave > enter && leave > 0;
            exact t = enter > 0 ? enter : leave;
            assert_int_equal(rays.hit[i], wanted ? 0 : -1);
            if (wanted)
                assert_true(fabsl(rays.t[i] - t) < 1e4L * (exact)REAL_ROUNDING * (1 + leave));
            hit_count += wanted;
        }
        zt_arena_free(&arena);
    }
    zt_meshes_close(&meshes);
    assert_true(hit_count > 10000);
}

/* Things that lie on each other, though their numbers are rounded along different ways: the
 * object with the lower index is hit, of whatever kind it is, also where there is a crowd. */
static void test_ties(void **state) {
    (void)state;
    uint64_t seed = 8;
    zt_meshes *meshes;
    assert_int_equal(zt_meshes_open(&meshes, &cube, 1, 1, (zt_listener){0}), ZT_OK);
    for (int round = 0; round < 400; round++) {
        static test_scene s;
        scene_begin(&s);
        scene_material(&s, (vec3){1, 1, 1}, 0);
        vec3 n = test_direction(&seed), at = vec3_scale(n, 5);
        vec3 u = vec3_normalize(vec3_cross(n, test_direction(&seed))), v = vec3_cross(n, u);
        int crowd = round & 1 ? 40 : 0, first = round >> 1 & 1, kind = round >> 2 & 1;
        /* Behind what counts, beside nothing. */
        for (int i = 0; i < crowd; i++) scene_sphere(&s, vec3_scale(n, 10 + i), .25, 0);
        for (int i = 0; i < 2; i++) {
            bool given = i == first;
            if (kind == 0 && given) {
                scene_plane(&s, vec3_scale(n, 3), 5, 0);
            } else if (kind == 0) {
                scene_triangle(&s, vec3_add(at, vec3_scale(u, 3)),
                               vec3_add(at, vec3_add(vec3_scale(u, -3), vec3_scale(v, 3))),
                               vec3_add(at, vec3_add(vec3_scale(u, -3), vec3_scale(v, -3))), 0);
            } else if (given) {
                scene_sphere(&s, at, 1.3, 0);
            } else {
                zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
                group->placement.scale = (vec3){.7, .7, .7};
                int32_t parent = s.scene.object_count - 1;
                scene_sphere(&s, vec3_scale(at, 1 / .7), 1.3 / .7, 0);
                s.objects[s.scene.object_count - 1].parent = parent;
            }
        }
        zt_arena arena = {0};
        const zt_tracer *tracer = prepare(&s.scene, meshes, &arena);
        assert_true((tracer->crowd_count > 0) == (crowd > 0));
        assert_true(tracer->tie > 0);
        rays.count = 200;
        for (int i = 0; i < rays.count; i++) {
            vec3 aim = vec3_scale(test_direction(&seed), .8);
            set_ray(i, (vec3){0, 0, 0}, vec3_normalize(vec3_add(at, aim)));
        }
        intersect(tracer);
        for (int i = 0; i < rays.count; i++) assert_int_equal(rays.hit[i], crowd);
        zt_arena_free(&arena);
    }
    zt_meshes_close(&meshes);
}

/* A solid let into a plane: where a face of it lies in the plane the object with the lower
 * index is hit, however the two are turned. */
static void test_flush(void **state) {
    (void)state;
    const zt_shape shapes[] = {ZT_SHAPE_BOX, ZT_SHAPE_CYLINDER, ZT_SHAPE_CONE, ZT_SHAPE_DISK,
                               ZT_SHAPE_MESH};
    uint64_t seed = 10;
    zt_meshes *meshes;
    assert_int_equal(zt_meshes_open(&meshes, &cube, 1, 1, (zt_listener){0}), ZT_OK);
    for (int round = 0; round < 400; round++) {
        static test_scene s;
        scene_begin(&s);
        s.scene.meshes = &cube;
        s.scene.mesh_count = 1;
        scene_material(&s, (vec3){1, 1, 1}, 0);
        quat turn = quat_axis_angle(test_direction(&seed), test_between(&seed, 0, 6));
        vec3 up = xform_place((vec3){0, 0, 0}, turn, (vec3){1, 1, 1}).y;
        double height = test_between(&seed, -5, -2); /* of the plane, seen from the camera */
        vec3 top = vec3_scale(up, height), low = vec3_scale(up, height - 2);
        for (int i = 0; i < 2; i++) {
            if (i == round % 2) {
                scene_plane(&s, vec3_scale(up, 3), height, 0);
                continue;
            }
            zt_object *o = scene_object(&s, shapes[round / 2 % 5], 0);
            if (o->shape == ZT_SHAPE_BOX)
                o->box = (zt_block){vec3_scale(up, height - 1), {6, 2, 6}, turn};
            else if (o->shape == ZT_SHAPE_MESH) {
                o->mesh = 0;
                o->placement = (zt_placement){vec3_scale(up, height - 3), turn, {3, 3, 3}};
            } else if (o->shape == ZT_SHAPE_DISK)
                o->disk = (zt_disk){top, up, 3};
            else
                o->tube = (zt_tube){low, top, 3, 3.5};
        }
        zt_arena arena = {0};
        const zt_tracer *tracer = prepare(&s.scene, meshes, &arena);
        rays.count = 200;
        for (int i = 0; i < rays.count; i++) {
            vec3 aim = vec3_scale(test_direction(&seed), 1.2);
            set_ray(i, (vec3){0, 0, 0}, vec3_normalize(vec3_add(top, aim)));
        }
        intersect(tracer);
        for (int i = 0; i < rays.count; i++) assert_int_equal(rays.hit[i], 0);
        zt_arena_free(&arena);
    }
    zt_meshes_close(&meshes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),         cmocka_unit_test(test_sphere_limb),
        cmocka_unit_test(test_sphere_left),    cmocka_unit_test(test_plane),
        cmocka_unit_test(test_sheared_sphere), cmocka_unit_test(test_triangle),
        cmocka_unit_test(test_triangle_edges), cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_ties),           cmocka_unit_test(test_flush),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
