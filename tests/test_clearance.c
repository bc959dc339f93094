/* Shows how far points are from the surface of each shape, by distances known from elsewhere.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/random.h"
#include "scene/clearance.h"

static const double pi = 3.14159265358979323846;

static zt_object plane(vec3 normal, double distance) {
    return (zt_object){.shape = ZT_SHAPE_PLANE, .plane = {normal, distance}};
}
static zt_object tube(zt_shape shape, vec3 from, vec3 to, double radius, double end_radius) {
    return (zt_object){.shape = shape, .tube = {from, to, radius, end_radius}};
}
static zt_object disk(vec3 center, vec3 normal, double radius) {
    return (zt_object){.shape = ZT_SHAPE_DISK, .disk = {center, normal, radius}};
}
static zt_object box(vec3 center, vec3 size, quat rotation) {
    return (zt_object){.shape = ZT_SHAPE_BOX, .box = {center, size, rotation}};
}
static zt_object torus(vec3 center, vec3 axis, double radius, double tube_radius) {
    return (zt_object){.shape = ZT_SHAPE_TORUS, .torus = {center, axis, radius, tube_radius}};
}
static zt_object sphere(vec3 center, double radius) {
    return (zt_object){.shape = ZT_SHAPE_SPHERE, .sphere = {center, radius}};
}

/* Before faces, edges and corners, at them, and within. */
static void known_distances(void **state) {
    (void)state;
    const vec3 o = {0, 0, 0}, x = {1, 0, 0}, y = {0, 1, 0}, up = {0, 5, 0};
    const quat eighth = quat_axis_angle(y, pi / 4);
    const zt_object triangle = {.shape = ZT_SHAPE_TRIANGLE,
                                .triangle.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}}};
    const zt_object cylinder = tube(ZT_SHAPE_CYLINDER, (vec3){1, 0, 0}, (vec3){1, 4, 0}, 1, 9);
    const zt_object cone = tube(ZT_SHAPE_CONE, o, (vec3){0, 4, 0}, 3, 0);
    const zt_object capsule = tube(ZT_SHAPE_CAPSULE, o, (vec3){0, 4, 0}, 1, 9);
    const struct {
        zt_object object;
        vec3 point;
        double expected;
    } cases[] = {
        {plane(up, 2), {7, 3, -1}, 1},
        {plane(up, 2), {7, -3, -1}, 5},
        {sphere(x, 2), {1, 0, 5}, 3},
        {sphere(x, 2), {1, 0.5, 0}, -1.5},
        {triangle, {1, 1, 2}, 2},
        {triangle, {-3, -4, 0}, 5},      /* a corner */
        {triangle, {2, -1, 1}, sqrt(2)}, /* an edge */
        {triangle, {4.5, 3.5, 0}, 3.1},
        {triangle, {5, 0, 0}, 1},
        {triangle, {0, 5, 0}, 2},
        {disk(x, up, 2), {2, -3, 0}, 3},
        {disk(x, up, 2), {6, 4, 0}, 5},
        {disk(x, up, 2), {1, 0, 1}, 0},
        {box(x, (vec3){2, 4, 6}, quat_identity()), {1, 0, 0}, -1},
        {box(x, (vec3){2, 4, 6}, quat_identity()), {1.25, 1.5, -2.9}, -0.1},
        {box(x, (vec3){2, 4, 6}, quat_identity()), {3, 4, 5}, sqrt(1 + 4 + 4)},
        {box(x, (vec3){2, 4, 6}, quat_identity()), {-4, 0, 0}, 4},
        {box(o, (vec3){2, 2, 2}, eighth), {2, 0, 0}, 2 - sqrt(2)},
        {box(o, (vec3){2, 2, 4}, eighth), {3, 0, 3}, 3 * sqrt(2) - 2},
        {cylinder, {1, 2, 0.25}, -0.75},
        {cylinder, {1, 3.5, 0.25}, -0.5},
        {cylinder, {4, 2, 0}, 2},
        {cylinder, {1, -3, 0}, 3},
        {cylinder, {1, 8, 4}, 5},
        {cone, {0, 5, 0}, 1},
        {cone, {3, 4, 0}, 2.4}, /* the side is 5 long; the point is 12/5 away from it */
        {cone, {0, 1, 0}, -1},  /* the floor is nearer than the side, which is 1.8 away */
        {cone, {0, 2, 0}, -1.2},
        {cone, {5, 0, 0}, 2},
        {cone, {0, -2, 0}, 2},
        {tube(ZT_SHAPE_CONE, o, (vec3){0, 4, 0}, 1, 1), {3, 2, 0}, 2},
        {capsule, {0, 2, 0}, -1},
        {capsule, {3, 3, 0}, 2},
        {capsule, {3, 8, 0}, 4},
        {tube(ZT_SHAPE_CAPSULE, x, x, 1, 0), {1, 0, 4}, 3},
        {torus(o, up, 3, 1), {0, 0, 0}, 2},
        {torus(o, up, 3, 1), {0, 0, 3.25}, -0.75},
        {torus(o, up, 3, 1), {0, 4, 6}, 4},
        {torus(x, x, 3, 1), {1, 0, 7}, 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double found = zt_clearance(&cases[i].object, cases[i].point);
        if (!(fabs(found - cases[i].expected) < 1e-14))
            fail_msg("case %zu: %.17g, not %.17g", i, found, cases[i].expected);
    }
}

/* From -4 to 4. */
static double random_number(uint64_t key) {
    return 8 * ((double)(zt_random_mix(key) >> 11) * 0x1p-53) - 4;
}

/* What is true of distances only: they change by no more than the way that one goes, and going
 * by as much as they say, the way that they fall, leads onto the surface. */
static void lead_to_the_surface(void **state) {
    (void)state;
    const vec3 a = {-0.5, 0.25, 0.75}, b = {1, 1.5, -0.25}, n = {1, 2, -0.5};
    const quat turned = quat_normalize((quat){1, 2, -1, 0.5});
    const zt_object objects[] = {
        plane(n, 0.5),
        sphere(a, 1.25),
        {.shape = ZT_SHAPE_TRIANGLE, .triangle.vertices = {a, b, n}},
        disk(a, n, 1.25),
        box(a, (vec3){1, 2, 0.5}, turned),
        tube(ZT_SHAPE_CYLINDER, a, b, 0.75, 0),
        tube(ZT_SHAPE_CONE, a, b, 0.25, 1),
        tube(ZT_SHAPE_CONE, a, b, 1, 0),
        tube(ZT_SHAPE_CAPSULE, a, b, 0.5, 0),
        torus(a, n, 1.25, 0.5),
    };
    const double step = 1e-6;
    for (size_t k = 0; k < sizeof objects / sizeof *objects; k++)
        for (uint32_t i = 0, kinked = 0; i < 2000; i++) {
            const zt_object *object = &objects[k];
            double r[6];
            for (uint32_t c = 0; c < 6; c++)
                r[c] = random_number(zt_random_key(zt_random_key(k, i), c));
            vec3 p = {r[0], r[1], r[2]}, q = {r[3], r[4], r[5]};
            double here = zt_clearance(object, p);
            double change = fabs(here - zt_clearance(object, q));
            assert_true(change <= vec3_length(vec3_sub(p, q)) + 1e-12);
            vec3 slope = {zt_clearance(object, (vec3){p.x + step, p.y, p.z}) - here,
                          zt_clearance(object, (vec3){p.x, p.y + step, p.z}) - here,
                          zt_clearance(object, (vec3){p.x, p.y, p.z + step}) - here};
            slope = vec3_scale(slope, 1 / step);
            /* Where two ways to the surface are as short, it has no slope. */
            if (fabs(vec3_length(slope) - 1) > 1e-4) {
                assert_true(++kinked < 20);
                continue;
            }
            vec3 there = vec3_sub(p, vec3_scale(slope, here));
            if (fabs(zt_clearance(object, there)) > 1e-4)
                fail_msg("object %zu point %u: %g", k, i, zt_clearance(object, there));
        }
}

/* What has no size has no surface. */
static void nothing_there(void **state) {
    (void)state;
    const vec3 o = {0, 0, 0}, y = {0, 1, 0};
    const zt_object objects[] = {
        plane(o, 1),
        sphere(o, 0),
        sphere(o, -1),
        disk(o, o, 1),
        disk(o, y, 0),
        box(o, (vec3){1, 0, 1}, quat_identity()),
        tube(ZT_SHAPE_CYLINDER, y, y, 1, 0),
        tube(ZT_SHAPE_CONE, o, y, 0, 0),
        tube(ZT_SHAPE_CAPSULE, o, y, 0, 0),
        torus(o, o, 1, 0.5),
        torus(o, y, 1, 0),
        {.shape = ZT_SHAPE_GROUP},
    };
    for (size_t i = 0; i < sizeof objects / sizeof *objects; i++)
        assert_true(zt_clearance(&objects[i], (vec3){0.1, 0.2, 0.3}) == INFINITY);
    const zt_object cube = box(o, (vec3){1, 1, 1}, quat_identity());
    assert_true(zt_clearance(&cube, (vec3){NAN, NAN, NAN}) == INFINITY);
    assert_true(zt_clearance(&cube, (vec3){0, -INFINITY, 0}) == INFINITY);
}

/* A mesh is as near as its nearest triangle. */
static void meshes(void **state) {
    (void)state;
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint32_t triangles[] = {0, 1, 2, 0, 3, 1};
    const zt_mesh mesh = {.origin = {10, 0, 0},
                          .positions = positions,
                          .triangles = triangles,
                          .vertex_count = 4,
                          .triangle_count = 2};
    assert_true(zt_mesh_clearance(&mesh, (vec3){10.25, 0.25, -2}) == 2);
    assert_true(zt_mesh_clearance(&mesh, (vec3){10.25, -3, 0.25}) == 3);
    assert_true(zt_mesh_clearance(&mesh, (vec3){11, 0, 0}) == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(known_distances),
        cmocka_unit_test(lead_to_the_surface),
        cmocka_unit_test(nothing_there),
        cmocka_unit_test(meshes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
