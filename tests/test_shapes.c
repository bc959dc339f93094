/* Pictures of solids: outline and shading against distances written down once more, rooms
 * without leaks, and surfaces that lie on each other; in both precisions. */
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
#include "rendering.h"

enum { SIZE = 96 };

/* ---- how far away a solid is: the usual signed distances (Quilez, "Distance functions") -----
 */

/* Of the point (r, h), as seen across and along an axis, to a trapezoid from h = 0, where it is
 * `a` wide, to h = length, where it is `b`. */
static double trapezoid_distance(double r, double h, double a, double b, double length) {
    double cap_r = fmax(r - (h < length / 2 ? a : b), 0),
           cap_h = fabs(h - length / 2) - length / 2;
    double share = ((a - r) * (a - b) + h * length) / ((a - b) * (a - b) + length * length);
    share = fmin(fmax(share, 0), 1);
    double side_r = r - a + (a - b) * share, side_h = h - length * share;
    bool inside = cap_h < 0 && (side_r < 0);
    double square = fmin(cap_r * cap_r + cap_h * cap_h, side_r * side_r + side_h * side_h);
    return inside ? -sqrt(square) : sqrt(square);
}

static double solid_distance(const zt_object *o, vec3 p) {
    switch (o->shape) {
    case ZT_SHAPE_SPHERE:
        return vec3_length(vec3_sub(p, o->sphere.center)) - o->sphere.radius;
    case ZT_SHAPE_BOX: {
        xform place = xform_place(o->box.center, o->box.rotation, (vec3){1, 1, 1});
        xform back = xform_inverse(&place);
        vec3 q = xform_point(&back, p), size = o->box.size;
        q = (vec3){fabs(q.x) - size.x / 2, fabs(q.y) - size.y / 2, fabs(q.z) - size.z / 2};
        return vec3_length(vec3_max(q, (vec3){0, 0, 0})) + fmin(fmax(q.x, fmax(q.y, q.z)), 0);
    }
    case ZT_SHAPE_TORUS:
    case ZT_SHAPE_DISK: {
        bool torus = o->shape == ZT_SHAPE_TORUS;
        vec3 axis = vec3_normalize(torus ? o->torus.axis : o->disk.normal);
        vec3 q = vec3_sub(p, torus ? o->torus.center : o->disk.center);
        double h = vec3_dot(q, axis), r = vec3_length(vec3_sub(q, vec3_scale(axis, h)));
        return torus ? hypot(r - o->torus.radius, h) - o->torus.tube_radius
                     : hypot(fmax(r - o->disk.radius, 0), h);
    }
    default: {
        vec3 way = vec3_sub(o->tube.to, o->tube.from), axis = vec3_normalize(way);
        vec3 q = vec3_sub(p, o->tube.from);
        double length = vec3_length(way), h = vec3_dot(q, axis);
        double r = vec3_length(vec3_sub(q, vec3_scale(axis, h)));
        if (o->shape == ZT_SHAPE_CAPSULE)
            return hypot(r, h - fmin(fmax(h, 0), length)) - o->tube.radius;
        bool cone = o->shape == ZT_SHAPE_CONE;
        return trapezoid_distance(r, h, o->tube.radius,
                                  cone ? o->tube.end_radius : o->tube.radius, length);
    }
    }
}

/* The same of an object in a group; how much shorter lengths may become there, `shortest`,
 * makes it at most the distance. */
typedef struct placed_solid {
    const zt_object *object;
    xform back;
    double shortest;
} placed_solid;

static double distance_to(const placed_solid *s, vec3 p) {
    return s->shortest * solid_distance(s->object, xform_point(&s->back, p));
}

/* The first point of a ray from the origin that is within 1e-9 of a solid, stepping by its
 * distance; false where there is none. The least distance on the way tells how near a miss is.
 */
static bool march(vec3 *at, double *nearest, const placed_solid *s, vec3 ray) {
    *nearest = INFINITY;
    for (double t = 0; t < 30;) {
        *at = vec3_scale(ray, t);
        double d = distance_to(s, *at);
        *nearest = fmin(*nearest, d);
        if (d < 1e-9) return true;
        t += d;
    }
    return false;
}

/* The gradient; not unit near an edge, where it means nothing. */
static vec3 gradient(const placed_solid *s, vec3 p) {
    const double e = 1e-5;
    return (vec3){(distance_to(s, (vec3){p.x + e, p.y, p.z}) -
                   distance_to(s, (vec3){p.x - e, p.y, p.z})) /
                      (2 * e),
                  (distance_to(s, (vec3){p.x, p.y + e, p.z}) -
                   distance_to(s, (vec3){p.x, p.y - e, p.z})) /
                      (2 * e),
                  (distance_to(s, (vec3){p.x, p.y, p.z + e}) -
                   distance_to(s, (vec3){p.x, p.y, p.z - e})) /
                      (2 * e)};
}

/* ---- solids --------------------------------------------------------------------------------
 */

enum { SOLID_COUNT = 10 };

/* A solid of each kind, some of them in more than one form, around (0, 0, -6). */
static void make_solid(zt_object *o, int which) {
    const vec3 center = {.3, -.2, -6}, from = {-1.1, -.9, -5.2}, to = {1.2, .7, -6.9};
    switch (which) {
    case 0:
        o->shape = ZT_SHAPE_BOX;
        o->box = (zt_block){center, {2.5, 1.2, 1.7}, quat_axis_angle((vec3){.6, .8, 0}, 1)};
        break;
    case 1:
        o->shape = ZT_SHAPE_CYLINDER;
        o->tube = (zt_tube){from, to, .8, 0};
        break;
    case 2:
        o->shape = ZT_SHAPE_CONE;
        o->tube = (zt_tube){from, to, 1.1, 0};
        break;
    case 3:
        o->shape = ZT_SHAPE_CONE;
        o->tube = (zt_tube){from, to, .3, 1.2};
        break;
    case 4:
        o->shape = ZT_SHAPE_CAPSULE;
        o->tube = (zt_tube){from, to, .7, 0};
        break;
    case 5:
        o->shape = ZT_SHAPE_CAPSULE; /* a ball */
        o->tube = (zt_tube){center, center, 1.3, 0};
        break;
    case 6:
        o->shape = ZT_SHAPE_TORUS;
        o->torus = (zt_torus){center, {.2, 1, .9}, 1.4, .45};
        break;
    case 7:
        o->shape = ZT_SHAPE_TORUS; /* without a hole */
        o->torus = (zt_torus){center, {.5, 1, .3}, .8, .8};
        break;
    case 8:
        o->shape = ZT_SHAPE_SPHERE;
        o->sphere = (zt_sphere){center, 1.2};
        break;
    default:
        o->shape = ZT_SHAPE_DISK;
        o->disk = (zt_disk){center, {.4, -3, 2}, 1.5};
        break;
    }
}

/* Every pixel of every solid, as it is and in a group that turns and stretches: black beside
 * it, and lit by ambient light and a lamp as the closed form has it. Within 2e-3 of an outline
 * and of edges, nothing is asked. */
static void test_solids(void **state) {
    (void)state;
    for (int round = 0; round < 4 * SOLID_COUNT; round++) {
        int which = round % SOLID_COUNT;
        bool stretched = round >= 2 * SOLID_COUNT;
        precision = round / SOLID_COUNT % 2 ? ZT_PRECISION_SINGLE : ZT_PRECISION_DOUBLE;
        test_scene s;
        scene_begin(&s);
        s.scene.camera.fov = .7;
        scene_material(&s, white, 0);
        scene_ambient(&s, white, .1);
        const vec3 lamp = {-3, 5, 1};
        scene_point_light(&s, lamp, 30)->shadows = false;
        zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
        if (stretched)
            group->placement = (zt_placement){
                {.5, .4, -1}, quat_axis_angle((vec3){0, .6, .8}, .3), {1.2, .6, .9}};
        zt_object *o = scene_object(&s, ZT_SHAPE_SPHERE, 0);
        o->parent = 0;
        make_solid(o, which);
        xform place = xform_place(group->placement.position, group->placement.rotation,
                                  group->placement.scale);
        placed_solid solid = {o, xform_inverse(&place), stretched ? .6 : 1};
        zt_image *image = render(&s.scene, SIZE, SIZE, 1, 2);
        int lit = 0, dark = 0;
        for (int k = 0; k < SIZE * SIZE; k++) {
            vec3 ray = pixel_ray(&s.scene, SIZE, SIZE, k % SIZE, k / SIZE), at;
            double nearest, got = pixel_at(image, k % SIZE, k / SIZE).x;
            if (!march(&at, &nearest, &solid, ray)) {
                if (nearest > 2e-3) assert_float_equal(got, 0, 0);
                continue;
            }
            vec3 normal = gradient(&solid, vec3_sub(at, vec3_scale(ray, 1e-4)));
            vec3 behind = gradient(&solid, vec3_sub(at, vec3_scale(ray, 4e-3)));
            normal = vec3_normalize(normal);
            if (vec3_length(vec3_sub(normal, vec3_normalize(behind))) > .05) continue;
            if (vec3_dot(normal, ray) > -.1) continue;
            vec3 v = vec3_sub(lamp, at);
            double d = vec3_length(v), toward = fmax(vec3_dot(normal, v) / d, 0);
            double wanted = .1 + fmin(30 / (d * d) * toward, 1);
            if (fabs(got - wanted) > 2e-3)
                fail_msg("round %d, solid %d, pixel %d %d: %.6f instead of %.6f", round, which,
                         k % SIZE, k / SIZE, got, wanted);
            lit += toward > 0;
            dark += toward == 0;
        }
        if (lit + dark < SIZE * SIZE / 16) fail_msg("solid %d: %d %d", which, lit, dark);
        zt_image_free(&image);
    }
    precision = ZT_PRECISION_AUTO;
}

/* ---- rooms ---------------------------------------------------------------------------------
 */

/* Within a closed solid whose inside is a mirror, each of ten mirrored rays meets a wall again:
 * all pixels are the same sum, and one that leaked would be darker. Cameras stand in the middle
 * and near a wall, and look along axes and askew. */
static void test_mirrored_rooms(void **state) {
    (void)state;
    for (int round = 0; round < 48; round++) {
        test_scene s;
        scene_begin(&s);
        scene_material(&s, white, .9);
        scene_ambient(&s, white, .1);
        s.scene.reflection_depth = 10;
        zt_object *o = scene_object(&s, ZT_SHAPE_BOX, 0);
        vec3 eye = {0, 0, 0};
        switch (round % 6) {
        case 0:
            o->box = (zt_block){{0, 0, 0}, {4, 3, 5}, {1, 0, 0, 0}};
            break;
        case 1:
            o->box =
                (zt_block){{.1, .2, -.3}, {4, 3, 5}, quat_axis_angle((vec3){.6, 0, .8}, .7)};
            break;
        case 2:
            o->shape = ZT_SHAPE_CYLINDER;
            o->tube = (zt_tube){{0, -1, 0}, {0, 1.5, 0}, 2, 0};
            break;
        case 3:
            o->shape = ZT_SHAPE_CONE;
            o->tube = (zt_tube){{.2, -1, 0}, {-.3, 3, .4}, 2, .5};
            break;
        case 4:
            o->shape = ZT_SHAPE_CAPSULE;
            o->tube = (zt_tube){{-1, 0, 0}, {1, .5, .2}, 1, 0};
            break;
        default:
            o->shape = ZT_SHAPE_TORUS;
            o->torus = (zt_torus){{2, 0, 0}, {0, 1, .3}, 2, .9};
        }
        if (round / 6 % 2) eye.y = .6;
        s.scene.camera.position = eye;
        if (round / 12 % 2)
            s.scene.camera.rotation = quat_axis_angle((vec3){.8, .6, 0}, .1 * round);
        precision = round / 24 ? ZT_PRECISION_SINGLE : ZT_PRECISION_DOUBLE;
        zt_image *image = render(&s.scene, SIZE, SIZE, 1, 2);
        double wanted = 1 - pow(.9, 11);
        for (int k = 0; k < SIZE * SIZE; k++) {
            double got = pixel_at(image, k % SIZE, k / SIZE).x;
            if (fabs(got - wanted) > 1e-5)
                fail_msg("round %d, pixel %d %d: %g instead of %g", round, k % SIZE, k / SIZE,
                         got, wanted);
        }
        zt_image_free(&image);
    }
    precision = ZT_PRECISION_AUTO;
}

/* A lamp in a room that is convex reaches all of it: no wall, edge or corner shadows itself or
 * another one. */
static void test_lit_rooms(void **state) {
    (void)state;
    for (int round = 0; round < 24; round++) {
        test_scene s;
        scene_begin(&s);
        scene_material(&s, white, 0);
        zt_object *o = scene_object(&s, ZT_SHAPE_BOX, 0);
        if (round % 3 == 0)
            o->box =
                (zt_block){{.1, .2, 0}, {4, 3, 5}, quat_axis_angle((vec3){.6, 0, .8}, round)};
        else if (round % 3 == 1)
            o->shape = ZT_SHAPE_CYLINDER, o->tube = (zt_tube){{.1, -1, 0}, {0, 1.5, 0}, 2, 0};
        else
            o->shape = ZT_SHAPE_CAPSULE, o->tube = (zt_tube){{-1, 0, 0}, {1, .5, .2}, 1, 0};
        s.scene.camera.rotation = quat_axis_angle((vec3){.8, .6, 0}, round);
        precision = round % 2 ? ZT_PRECISION_SINGLE : ZT_PRECISION_DOUBLE;
        scene_point_light(&s, (vec3){.3, .4, .2}, .5);
        zt_image *with = render(&s.scene, SIZE, SIZE, 1, 2);
        s.lights[0].shadows = false;
        zt_image *without = render(&s.scene, SIZE, SIZE, 1, 2);
        assert_memory_equal(with->pixels, without->pixels, SIZE * SIZE * 4 * sizeof(float));
        for (int k = 0; k < SIZE * SIZE; k++) assert_true(with->pixels[4 * k] > 0);
        zt_image_free(&with);
        zt_image_free(&without);
    }
    precision = ZT_PRECISION_AUTO;
}

/* ---- surfaces that lie on each other --------------------------------------------------------
 */

/* One of two things whose upper side is at y = 0. */
static void make_top(zt_object *o, int which) {
    switch (which) {
    case 0:
        o->shape = ZT_SHAPE_PLANE;
        o->plane = (zt_plane){{0, 1, 0}, 0};
        break;
    case 1:
        o->shape = ZT_SHAPE_DISK;
        o->disk = (zt_disk){{0, 0, 0}, {0, -1, 0}, 1.1};
        break;
    case 2:
        o->shape = ZT_SHAPE_BOX;
        o->box = (zt_block){{0, -.35, 0}, {2.6, .7, 2.6}, {1, 0, 0, 0}};
        break;
    case 3:
        o->shape = ZT_SHAPE_CYLINDER;
        o->tube = (zt_tube){{0, -.6, 0}, {0, 0, 0}, 1.2, 0};
        break;
    case 4:
        o->shape = ZT_SHAPE_CONE;
        o->tube = (zt_tube){{0, 0, 0}, {0, -.8, 0}, 1.25, .3};
        break;
    case 5:
        o->shape = ZT_SHAPE_TRIANGLE;
        o->triangle = (zt_triangle){{{-2, 0, -2}, {2, 0, -2}, {0, 0, 3}}};
        break;
    default:
        o->shape = ZT_SHAPE_MESH;
        o->mesh = which - 6;
        o->placement =
            (zt_placement){{0, which == 6 ? 0 : -.4, 0}, {1, 0, 0, 0}, {1.3, .4, 1.3}};
        break;
    }
}

enum { TOP_COUNT = 8 };

/* Of every pair, in both orders, in a group that turns them so that roundings differ: where
 * both lie, all is the first one's color, as bright with shadows as without. `crowd` adds so
 * many things that they are asked through a hierarchy. Seen from above, and at an angle of 8
 * degrees. */
static void assert_first(int first, int second, bool crowd, double turned, vec3 eye) {
    test_scene s;
    scene_begin(&s);
    scene_material(&s, (vec3){1, 0, 0}, 0);
    scene_material(&s, (vec3){0, 1, 0}, 0);
    const zt_mesh meshes[] = {square_mesh(), cube_mesh()};
    s.scene.meshes = meshes;
    s.scene.mesh_count = 2;
    zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
    group->placement.rotation = quat_axis_angle((vec3){.6, 0, .8}, turned);
    group->placement.position = (vec3){.13, .07, -5.3};
    for (int i = 0; i < 2; i++) {
        zt_object *o = scene_object(&s, ZT_SHAPE_PLANE, i);
        o->parent = 0;
        make_top(o, i == 0 ? first : second);
    }
    for (int i = 0; crowd && i < 40; i++) scene_sphere(&s, (vec3){i - 20, 30, 40}, .3, 1);
    xform place = xform_place(group->placement.position, group->placement.rotation,
                              group->placement.scale);

    s.scene.camera.position = xform_point(&place, eye);
    s.scene.camera.look_at = xform_point(&place, (vec3){0, 0, 0});
    s.scene.camera.aimed = true;
    s.scene.camera.fov = .35;
    scene_ambient(&s, white, .5);
    scene_point_light(&s, xform_point(&place, (vec3){1, 5, -1}), 5);
    zt_image *with = render(&s.scene, SIZE, SIZE, 1, 2);
    s.lights[1].shadows = false;
    zt_image *without = render(&s.scene, SIZE, SIZE, 1, 2);
    xform back = xform_inverse(&place);
    int both = 0;
    for (int k = 0; k < SIZE * SIZE; k++) {
        vec3 ray = pixel_ray(&s.scene, SIZE, SIZE, k % SIZE, k / SIZE);
        vec3 o = xform_point(&back, s.scene.camera.position), d = xform_vector(&back, ray);
        vec3 p = vec3_sub(o, vec3_scale(d, o.y / d.y));
        if (hypot(p.x, p.z) > 1) continue;
        both++;
        vec3 got = pixel_at(with, k % SIZE, k / SIZE);
        if (got.y != 0 || got.x < .55)
            fail_msg("%d on %d, crowd %d, turned %g, precision %d, pixel %d %d: %g %g", first,
                     second, crowd, turned, (int)precision, k % SIZE, k / SIZE, got.x, got.y);
    }
    assert_true(both > SIZE * SIZE / 6);
    assert_memory_equal(with->pixels, without->pixels, SIZE * SIZE * 4 * sizeof(float));
    zt_image_free(&with);
    zt_image_free(&without);
}

static void test_coincident(void **state) {
    (void)state;
    for (precision = ZT_PRECISION_AUTO; precision <= ZT_PRECISION_DOUBLE; precision++)
        for (int first = 0; first < TOP_COUNT; first++)
            for (int second = 0; second < TOP_COUNT; second++)
                for (int round = 0; round < 4; round++)
                    assert_first(first, second, round % 2, round % 3 ? .37 : 0,
                                 round < 2 ? (vec3){.4, 2.9, 2.2} : (vec3){.4, .5, 3.6});
    precision = ZT_PRECISION_AUTO;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solids),
        cmocka_unit_test(test_mirrored_rooms),
        cmocka_unit_test(test_lit_rooms),
        cmocka_unit_test(test_coincident),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
