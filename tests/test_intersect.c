/* Intersections against closed forms in long double, edges and ties, and meshes against their
 * own triangles. */
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

typedef long double exact;

typedef struct exact3 {
    exact x, y, z;
} exact3;

static exact3 exact_of(real3 v) { return (exact3){v.x, v.y, v.z}; }
static exact exact_dot(exact3 a, exact3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static exact3 exact_sub(exact3 a, exact3 b) {
    return (exact3){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* A ray of floats, unit as far as floats go. */
typedef struct ray {
    real3 o, d;
} ray;

static ray ray_from(vec3 o, vec3 d) {
    return (ray){{(real)o.x, (real)o.y, (real)o.z}, {(real)d.x, (real)d.y, (real)d.z}};
}

static real meet(const zt_primitive *p, ray r) {
    switch (p->kind) {
    case ZT_PRIMITIVE_PLANE:
        return zt_plane_distance(p, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z);
    case ZT_PRIMITIVE_SPHERE:
        return zt_sphere_distance(p, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z);
    case ZT_PRIMITIVE_ELLIPSOID:
        return zt_ellipsoid_distance(p, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z);
    case ZT_PRIMITIVE_TRIANGLE:
        return zt_triangle_distance(p, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z);
    case ZT_PRIMITIVE_MESH:
        break;
    }
    return NAN;
}

static bool hits(const zt_primitive *p, ray r) { return meet(p, r) < REAL_INFINITY; }

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
        zt_primitive p = {
            .kind = ZT_PRIMITIVE_SPHERE,
            .sphere = {{(real)center.x, (real)center.y, (real)center.z}, (real)radius}};
        ray r = ray_from((vec3){0, 0, 0}, test_direction(&seed));
        exact condition, wanted = sphere_exact(&condition, p.sphere.center, p.sphere.radius, r);
        real got = meet(&p, r);
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
    assert_true(worst < 8 * 0x1p-24L);
}

/* A ray in the equator's plane passes above the pole's height or below it: a < radius decides.
 */
static void test_sphere_limb(void **state) {
    (void)state;
    zt_primitive p = {.kind = ZT_PRIMITIVE_SPHERE, .sphere = {{0, 0, -4}, 1}};
    assert_true(hits(&p, (ray){{0, 0.999999f, 0}, {0, 0, -1}}));
    assert_false(hits(&p, (ray){{0, 1.000001f, 0}, {0, 0, -1}}));
    assert_false(hits(&p, (ray){{0, 1, 0}, {0, 0, -1}}));
    assert_float_equal(meet(&p, (ray){{0, 0, 0}, {0, 0, -1}}), 3, 0);
    assert_float_equal(meet(&p, (ray){{0, 0, -4}, {0, 0, -1}}), 1, 0);
    assert_false(hits(&p, (ray){{0, 0, 0}, {0, 0, 1}})); /* behind */
}

static void test_plane(void **state) {
    (void)state;
    uint64_t seed = 2;
    exact worst = 0;
    for (int i = 0; i < 100000; i++) {
        vec3 n = test_direction(&seed);
        zt_primitive p = {
            .kind = ZT_PRIMITIVE_PLANE,
            .plane = {{(real)n.x, (real)n.y, (real)n.z}, (real)test_between(&seed, -5, 5)}};
        ray r = ray_from((vec3){0, 0, 0}, test_direction(&seed));
        exact down = exact_dot(exact_of(p.plane.normal), exact_of(r.d));
        if (fabsl(down) < 1e-3L) continue;
        exact wanted = p.plane.distance / down;
        real got = meet(&p, r);
        assert_true((got < REAL_INFINITY) == (wanted > 0));
        if (wanted > 0) worst = fmaxl(worst, fabsl(got - wanted) / wanted * fabsl(down));
    }
    printf("plane: worst relative error / condition %.2Lg\n", worst);
    assert_true(worst < 8 * 0x1p-24L);
    zt_primitive p = {.kind = ZT_PRIMITIVE_PLANE, .plane = {{0, 1, 0}, -1}};
    assert_false(hits(&p, (ray){{0, 0, 0}, {1, 0, 0}}));  /* along it */
    assert_false(hits(&p, (ray){{0, -1, 0}, {1, 0, 0}})); /* within it */
}

/* A sphere stretched by its group equals the closed form in the stretched space. */
static void test_ellipsoid(void **state) {
    (void)state;
    uint64_t seed = 3;
    int hit_count = 0;
    zt_meshes *none;
    assert_int_equal(zt_meshes_open(&none, NULL, 0, (zt_listener){0}), ZT_OK);
    for (int i = 0; i < 20000; i++) {
        test_scene s;
        scene_begin(&s);
        scene_material(&s, (vec3){1, 1, 1}, 0);
        zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
        quat turn = quat_axis_angle(test_direction(&seed), test_between(&seed, 0, 6));
        group->placement =
            (zt_placement){vec3_scale(test_direction(&seed), 6),
                           turn,
                           {test_between(&seed, .2, 4), test_between(&seed, .2, 4),
                            test_between(&seed, -4, -.2)}};
        scene_sphere(&s, (vec3){.1, .2, .3}, 1.5, 0);
        s.objects[1].parent = 0;
        zt_arena arena = {0};
        zt_tracer tracer;
        assert_int_equal(zt_tracer_prepare(&tracer, &s.scene, none, &arena), ZT_OK);
        assert_int_equal(tracer.primitive_count, 1);
        zt_primitive ellipsoid = tracer.primitives[0];
        assert_int_equal(ellipsoid.kind, ZT_PRIMITIVE_ELLIPSOID);
        zt_arena_free(&arena);

        /* The reference solves in the group's own space, reached by undoing each step. */
        const zt_placement *g = &group->placement;
        xform back = xform_place((vec3){0, 0, 0}, quat_conjugate(g->rotation), (vec3){1, 1, 1});
        vec3 o = vec3_scale(g->position, -1);
        vec3 d = vec3_normalize(vec3_add(g->position, vec3_scale(test_direction(&seed), 4)));
        vec3 lo = xform_vector(&back, o), ld = xform_vector(&back, d);
        vec3 f = {lo.x / g->scale.x - .1, lo.y / g->scale.y - .2, lo.z / g->scale.z - .3};
        vec3 e = {ld.x / g->scale.x, ld.y / g->scale.y, ld.z / g->scale.z};
        double a = vec3_dot(e, e), b = vec3_dot(e, f), c = vec3_dot(f, f) - 1.5 * 1.5;
        double root = b * b - a * c;
        if (fabs(root) < 1e-2 * b * b) continue;
        double near = root > 0 ? (-b - sqrt(root)) / a : -1;
        double far = root > 0 ? (-b + sqrt(root)) / a : -1;
        double wanted = near > 0 ? near : far;
        real got = meet(&ellipsoid, ray_from((vec3){0, 0, 0}, d));
        assert_true((got < REAL_INFINITY) == (wanted > 0));
        if (wanted > 0) {
            hit_count++;
            assert_float_equal(got, wanted, 1e-4 * (wanted + .1));
        }
    }
    zt_meshes_close(&none);
    assert_true(hit_count > 2000);
}

static zt_primitive triangle_of(vec3 a, vec3 b, vec3 c) {
    vec3 v[3] = {a, b, c};
    zt_primitive p = {.kind = ZT_PRIMITIVE_TRIANGLE};
    for (int i = 0; i < 3; i++)
        p.triangle.vertices[i] = (real3){(real)v[i].x, (real)v[i].y, (real)v[i].z};
    return p;
}

/* Inside or outside by the signs of volumes, the distance by the plane: in long double. */
static void test_triangle(void **state) {
    (void)state;
    uint64_t seed = 4;
    int hit_count = 0, beyond_diagonal = 0;
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
        if (fabsl(determinant) < 1e-2L) continue;
        exact beta = exact_dot(o, q) / determinant;
        exact3 w = {o.y * e1.z - o.z * e1.y, o.z * e1.x - o.x * e1.z, o.x * e1.y - o.y * e1.x};
        exact gamma = exact_dot(d, w) / determinant, t = exact_dot(e2, w) / determinant;
        exact margin = fminl(fminl(beta, gamma), 1 - beta - gamma);
        if (fabsl(margin) < 1e-5L || fabsl(t) < 1e-3L) continue;
        beyond_diagonal += beta > 0 && beta < 1 && gamma > 0 && gamma < 1 && beta + gamma > 1;
        assert_true(hits(&p, r) == (margin > 0 && t > 0));
        if (margin > 0 && t > 0) {
            hit_count++;
            assert_float_equal(meet(&p, r), (double)t, 1e-4 * (1 + (double)t));
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

static int32_t all_rays[ZT_BATCH]; /* 0, 1, 2 ... */

/* A turned, stretched and moved cube of triangles, met from everywhere: never missed from
 * within, and where the six planes of the cube say. */
static void test_mesh(void **state) {
    (void)state;
    uint64_t seed = 6;
    zt_meshes *meshes;
    assert_int_equal(zt_meshes_open(&meshes, &cube, 1, (zt_listener){0}), ZT_OK);
    for (int round = 0; round < 300; round++) {
        test_scene s;
        scene_begin(&s);
        scene_material(&s, (vec3){1, 1, 1}, 0);
        zt_object *object = scene_object(&s, ZT_SHAPE_MESH, 0);
        object->mesh = 0;
        bool inside = round % 2;
        object->placement = (zt_placement){vec3_scale(test_direction(&seed), inside ? .3 : 7),
                                           quat_axis_angle(test_direction(&seed), round),
                                           {1, test_between(&seed, .5, 3), -2}};
        s.scene.meshes = &cube;
        s.scene.mesh_count = 1;
        zt_arena arena = {0};
        zt_tracer tracer;
        assert_int_equal(zt_tracer_prepare(&tracer, &s.scene, meshes, &arena), ZT_OK);
        assert_ptr_equal(tracer.meshes, meshes);
        zt_batch rays = {.count = 100};
        for (int i = 0; i < rays.count; i++) {
            vec3 d = test_direction(&seed);
            rays.dx[i] = (real)d.x, rays.dy[i] = (real)d.y, rays.dz[i] = (real)d.z;
            rays.t[i] = REAL_INFINITY, rays.hit[i] = -1;
        }
        zt_meshes_intersect(meshes, &rays, all_rays, rays.count);
        const zt_placement *p = &object->placement;
        xform back = xform_place((vec3){0, 0, 0}, quat_conjugate(p->rotation), (vec3){1, 1, 1});
        vec3 o = xform_vector(&back, vec3_scale(p->position, -1));
        o = (vec3){o.x / p->scale.x, o.y / p->scale.y, o.z / p->scale.z};
        for (int i = 0; i < rays.count; i++) {
            vec3 d = xform_vector(&back, (vec3){rays.dx[i], rays.dy[i], rays.dz[i]});
            d = (vec3){d.x / p->scale.x, d.y / p->scale.y, d.z / p->scale.z};
            double enter = -INFINITY, leave = INFINITY;
            const double *oo = &o.x, *dd = &d.x;
            for (int axis = 0; axis < 3; axis++) {
                double t0 = (-1 - oo[axis]) / dd[axis], t1 = (1 - oo[axis]) / dd[axis];
                enter = fmax(enter, fmin(t0, t1));
                leave = fmin(leave, fmax(t0, t1));
            }
            if (fabs(leave - enter) < 1e-3) continue; /* along an edge */
            bool wanted = leave > enter && leave > 0;
            assert_int_equal(rays.hit[i], wanted ? 0 : -1);
            if (wanted) assert_float_equal(rays.t[i], enter > 0 ? enter : leave, 1e-5 * leave);
        }
        zt_arena_free(&arena);
    }
    zt_meshes_close(&meshes);
}

/* A triangle of a mesh and a triangle by itself in the same place: the object with the lower
 * index is hit, whichever kind it is. */
static void test_ties(void **state) {
    (void)state;
    zt_meshes *meshes;
    assert_int_equal(zt_meshes_open(&meshes, &cube, 1, (zt_listener){0}), ZT_OK);
    for (int mesh_first = 0; mesh_first < 2; mesh_first++) {
        zt_arena arena = {0};
        test_scene s;
        scene_begin(&s);
        scene_material(&s, (vec3){1, 1, 1}, 0);
        for (int i = 0; i < 2; i++) {
            if (i == !mesh_first) {
                zt_object *object = scene_object(&s, ZT_SHAPE_MESH, 0);
                object->mesh = 0;
                object->placement.position.z = -5;
            } else
                scene_plane(&s, (vec3){0, 0, 1}, -4, 0); /* where the cube's near face is */
        }
        zt_tracer tracer;
        assert_int_equal(zt_tracer_prepare(&tracer, &s.scene, meshes, &arena), ZT_OK);
        zt_batch rays = {.count = 1, .dx = {.1f}, .dz = {-1}, .t = {4}, .hit = {!!mesh_first}};
        zt_meshes_intersect(meshes, &rays, all_rays, rays.count);
        assert_int_equal(rays.hit[0], 0);
        zt_arena_free(&arena);
    }
    zt_meshes_close(&meshes);
}

/* A cloud of small triangles along a bow, far from its own origin. */
enum { SOUP = 600 };
static float soup_positions[SOUP * 9 + 1];
static uint32_t soup_triangles[SOUP * 3];

static zt_mesh make_soup(uint64_t *seed) {
    zt_mesh mesh = {.origin = {1000, -2000, 500},
                    .positions = soup_positions,
                    .triangles = soup_triangles,
                    .vertex_count = SOUP * 3,
                    .triangle_count = SOUP,
                    .low = {INFINITY, INFINITY, INFINITY},
                    .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (int i = 0; i < SOUP * 3; i++) {
        double along = 4.0 * (i / 3) / SOUP;
        vec3 p = vec3_add((vec3){2 * cos(along), 2 * sin(along), along / 2},
                          vec3_scale(test_direction(seed), .2));
        soup_positions[3 * i] = (float)p.x;
        soup_positions[3 * i + 1] = (float)p.y;
        soup_positions[3 * i + 2] = (float)p.z;
        soup_triangles[i] = (uint32_t)i;
        mesh.low = vec3_min(mesh.low, vec3_add(mesh.origin, p));
        mesh.high = vec3_max(mesh.high, vec3_add(mesh.origin, p));
    }
    return mesh;
}

/* The nearest hit by asking each primitive for each ray, and Embree for all of them. */
static void intersect_all(zt_batch *rays, const zt_tracer *tracer) {
    for (int i = 0; i < rays->count; i++) {
        ray r = {{rays->ox[i], rays->oy[i], rays->oz[i]},
                 {rays->dx[i], rays->dy[i], rays->dz[i]}};
        rays->t[i] = REAL_INFINITY, rays->hit[i] = -1;
        for (int32_t p = 0; p < tracer->primitive_count; p++) {
            if (tracer->primitives[p].kind == ZT_PRIMITIVE_MESH) continue;
            real t = meet(&tracer->primitives[p], r);
            if (t < rays->t[i]) rays->t[i] = t, rays->hit[i] = p;
        }
    }
    zt_meshes_intersect(tracer->meshes, rays, all_rays, rays->count);
}

/* Bundles that are passed by, rays that a hull turns away: the bits are those of asking all.
 * Narrow bundles and scattered ones, from near and far, among things of all sizes, with few
 * meshes and with more than have hulls of their own. */
static void test_passing_by(void **state) {
    (void)state;
    uint64_t seed = 7;
    zt_mesh soup = make_soup(&seed);
    zt_meshes *meshes;
    assert_int_equal(zt_meshes_open(&meshes, &soup, 1, (zt_listener){0}), ZT_OK);
    int hit_count = 0, mesh_hit_count = 0, miss_count = 0;
    for (int round = 0; round < 400; round++) {
        static test_scene s;
        scene_begin(&s);
        scene_material(&s, (vec3){1, 1, 1}, 0);
        s.scene.meshes = &soup;
        s.scene.mesh_count = 1;
        int placed = round % 8 == 0 ? 40 : 1 + round % 5;
        for (int i = 0; i < placed; i++) {
            zt_object *object = scene_object(&s, ZT_SHAPE_MESH, 0);
            object->mesh = 0;
            double scale = exp(test_between(&seed, -1, 1));
            quat turn = quat_axis_angle(test_direction(&seed), test_between(&seed, 0, 6));
            object->placement = (zt_placement){{0, 0, 0}, turn, {scale, scale, -scale}};
            /* So that the model's middle comes to somewhere near. */
            xform place = xform_place((vec3){0, 0, 0}, turn, object->placement.scale);
            object->placement.position = vec3_sub(vec3_scale(test_direction(&seed), 6),
                                                  xform_point(&place, soup.origin));
        }
        for (int i = 0; i < 12; i++)
            scene_sphere(&s, vec3_scale(test_direction(&seed), test_between(&seed, 1, 12)),
                         exp(test_between(&seed, -3, 1)), 0);
        scene_triangle(&s, vec3_scale(test_direction(&seed), 5),
                       vec3_scale(test_direction(&seed), 5),
                       vec3_scale(test_direction(&seed), 5), 0);
        scene_plane(&s, test_direction(&seed), -9, 0);
        s.scene.camera.position = vec3_scale(test_direction(&seed), round % 3 ? 1 : 30);
        zt_arena arena = {0};
        zt_tracer tracer;
        assert_int_equal(zt_tracer_prepare(&tracer, &s.scene, meshes, &arena), ZT_OK);
        for (int batch = 0; batch < 20; batch++) {
            static zt_batch rays, wanted;
            rays.count = 1 + (int)(test_random(&seed) * ZT_BATCH);
            vec3 from = vec3_scale(test_direction(&seed), batch % 4 ? 0 : 8);
            vec3 along = test_direction(&seed);
            double spread = batch % 3 ? .03 : 2;
            for (int i = 0; i < rays.count; i++) {
                vec3 d =
                    vec3_normalize(vec3_add(along, vec3_scale(test_direction(&seed), spread)));
                if (batch % 7 == 0) d = (vec3){0, 0, i % 2 ? 1 : -1}; /* along an axis */
                rays.ox[i] = (real)from.x, rays.oy[i] = (real)from.y, rays.oz[i] = (real)from.z;
                rays.dx[i] = (real)d.x, rays.dy[i] = (real)d.y, rays.dz[i] = (real)d.z;
            }
            wanted = rays;
            intersect_all(&wanted, &tracer);
            ZT_ISA_NAME(zt_intersect)(&rays, &tracer);
            for (int i = 0; i < rays.count; i++) {
                assert_int_equal(rays.hit[i], wanted.hit[i]);
                assert_true(rays.t[i] == wanted.t[i]);
                miss_count += rays.hit[i] < 0;
                hit_count += rays.hit[i] >= 0;
                mesh_hit_count += rays.hit[i] >= 0 &&
                                  tracer.primitives[rays.hit[i]].kind == ZT_PRIMITIVE_MESH;
            }
            /* As shadow rays, looking half as far, and as far as a little beyond. */
            real share = batch % 2 ? .5f : 1.0001f;
            for (int i = 0; i < rays.count; i++) {
                rays.t[i] = wanted.hit[i] < 0 ? 5 : wanted.t[i] * share;
                rays.hit[i] = -1;
            }
            ZT_ISA_NAME(zt_occlude)(&rays, &tracer);
            for (int i = 0; i < rays.count; i++)
                assert_int_equal(rays.hit[i] >= 0, wanted.hit[i] >= 0 && share > 1);
        }
        zt_arena_free(&arena);
    }
    printf("passing by: %d hits, %d of them on meshes, %d misses\n", hit_count, mesh_hit_count,
           miss_count);
    assert_true(mesh_hit_count > 10000 && miss_count > 10000);
    zt_meshes_close(&meshes);
}

int main(void) {
    for (int i = 0; i < ZT_BATCH; i++) all_rays[i] = i;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),     cmocka_unit_test(test_sphere_limb),
        cmocka_unit_test(test_plane),      cmocka_unit_test(test_ellipsoid),
        cmocka_unit_test(test_triangle),   cmocka_unit_test(test_triangle_edges),
        cmocka_unit_test(test_mesh),       cmocka_unit_test(test_ties),
        cmocka_unit_test(test_passing_by),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
