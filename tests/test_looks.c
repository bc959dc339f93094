/* What surfaces look like: patterns, colors and smooth normals of meshes, against closed forms,
 * in both precisions. */
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

static const vec3 red = {1, 0, 0}, green = {0, 1, 0};

/* Red cells and green ones, seen by their own color alone. */
static zt_material *scene_pattern(test_scene *s, zt_pattern pattern, double size) {
    zt_material *m = &s->materials[scene_material(s, red, 0)];
    m->pattern = pattern;
    m->other_color = green;
    m->pattern_size = size;
    m->pattern_direction = (vec3){1, 0, 0};
    scene_ambient(s, white, 1);
    return m;
}

/* Which cell a point is in; -1 where it lies on a border, give or take `room` cells. */
static int cell_of(const zt_material *m, vec3 p, double room) {
    double places[3] = {p.x, p.y, p.z};
    int count = 3, sum = 0;
    if (m->pattern == ZT_PATTERN_STRIPES) {
        places[0] = vec3_dot(p, vec3_normalize(m->pattern_direction));
        count = 1;
    }
    for (int i = 0; i < count; i++) {
        double place = places[i] / m->pattern_size;
        if (fabs(place - round(place)) < room) return -1;
        sum += (int)fmod(floor(place), 2) & 1;
    }
    return sum & 1;
}

/* The cell that the surface at p belongs to: a little below it. -1 near a border across it. */
static int cell_below(const zt_material *m, vec3 p, vec3 normal) {
    int deep = cell_of(m, vec3_sub(p, vec3_scale(normal, m->pattern_size * 5e-3)), 3e-3);
    int near = cell_of(m, vec3_sub(p, vec3_scale(normal, m->pattern_size * 5e-4)), 1e-5);
    return near == deep ? deep : -1;
}

/* Where a plane is met in the space that `place` takes to the world; false behind the eye, and
 * towards the horizon, where roundings decide. */
static bool meet_plane(vec3 *at, const zt_scene *scene, vec3 normal, double distance,
                       const xform *place, vec3 ray) {
    xform back = xform_inverse(place);
    vec3 o = xform_point(&back, scene->camera.position), d = xform_vector(&back, ray);
    double t = (distance - vec3_dot(normal, o)) / vec3_dot(normal, d);
    *at = vec3_add(o, vec3_scale(d, t));
    return t > 0 && t < 40;
}

/* All pixels of a picture of one plane, which is object number `index`, show the cells that
 * they should, and each cell one color; both colors are seen, if `both`. */
static void assert_cells(const test_scene *s, int index, const xform *place, bool both) {
    const zt_object *plane = &s->objects[index];
    const zt_material *m = &s->materials[plane->material];
    vec3 normal = vec3_normalize(plane->plane.normal);
    for (precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE; precision++) {
        zt_image *image = render(&s->scene, SIZE, SIZE, 1, 2);
        int seen[2] = {0, 0};
        for (int i = 0; i < SIZE * SIZE; i++) {
            vec3 ray = pixel_ray(&s->scene, SIZE, SIZE, i % SIZE, i / SIZE), at;
            vec3 got = pixel_at(image, i % SIZE, i / SIZE);
            if (!meet_plane(&at, &s->scene, normal, plane->plane.distance, place, ray))
                continue;
            int cell = cell_below(m, at, normal);
            if (cell < 0) continue;
            seen[cell]++;
            vec3 wanted = cell ? green : red;
            if (got.x != wanted.x || got.y != wanted.y || got.z != 0)
                fail_msg("precision %d: pixel %d %d: %g %g %g in cell %d at %.9g %.9g %.9g",
                         (int)precision, i % SIZE, i / SIZE, got.x, got.y, got.z, cell, at.x,
                         at.y, at.z);
        }
        assert_true(seen[0] + seen[1] > SIZE * SIZE / 3);
        assert_true(!both || (seen[0] > SIZE * SIZE / 9 && seen[1] > SIZE * SIZE / 9));
        zt_image_free(&image);
    }
    precision = ZT_PRECISION_AUTO;
}

/* Looks down at a floor at an angle. */
static void look_down(test_scene *s, vec3 at) {
    s->scene.camera.position = vec3_add(at, (vec3){.3, 3.2, 2.1});
    s->scene.camera.look_at = vec3_add(at, (vec3){.1, 0, -.4});
    s->scene.camera.aimed = true;
}

/* Planes on a border of cells and between two, in whichever way their normals point: no cell
 * has a speckle, and each has the size and the place that it should. */
static void test_checker(void **state) {
    (void)state;
    const xform here = xform_identity();
    const vec3 normals[] = {{0, 1, 0}, {0, -2, 0}, {0, 1, .2}, {.3, 1, -.2}};
    for (int i = 0; i < 16; i++) {
        test_scene s;
        scene_begin(&s);
        look_down(&s, (vec3){0, 0, 0});
        scene_pattern(&s, ZT_PATTERN_CHECKER, i % 3 == 0 ? .25 : 1);
        scene_plane(&s, normals[i % 4], i < 4 ? 0 : i < 8 ? .375 : i < 12 ? -.5 : -1, 0);
        assert_cells(&s, 0, &here, true);
    }
}

/* Stripes lie across their direction; along a plane they are one color. */
static void test_stripes(void **state) {
    (void)state;
    const xform here = xform_identity();
    const vec3 directions[] = {{1, 0, 0}, {0, 0, -3}, {1, 2, .5}, {-.2, .1, .1}, {0, 1, 0}};
    for (int i = 0; i < 5; i++) {
        test_scene s;
        scene_begin(&s);
        look_down(&s, (vec3){0, 0, 0});
        scene_pattern(&s, ZT_PATTERN_STRIPES, .3)->pattern_direction = directions[i];
        scene_plane(&s, (vec3){0, 1, 0}, 0, 0);
        assert_cells(&s, 0, &here, i < 4);
    }
}

/* The group that a plane is in takes its pattern along: moved, turned, of another size. */
static void test_pattern_moves(void **state) {
    (void)state;
    for (int i = 0; i < 8; i++) {
        test_scene s;
        scene_begin(&s);
        look_down(&s, (vec3){0, 0, 0});
        zt_object *group = scene_object(&s, ZT_SHAPE_GROUP, -1);
        group->placement =
            (zt_placement){{.1 * i, 0, -.37},
                           quat_axis_angle(vec3_normalize((vec3){.1 * (i % 2), 1, .05}), i),
                           i < 4 ? (vec3){1, 1, 1} : (vec3){2, .5, 1}};
        xform place = xform_place(group->placement.position, group->placement.rotation,
                                  group->placement.scale);
        scene_pattern(&s, i % 2 ? ZT_PATTERN_STRIPES : ZT_PATTERN_CHECKER, .7);
        scene_plane(&s, (vec3){0, 1, 0}, 0, 0);
        s.objects[1].parent = 0;
        assert_cells(&s, 1, &place, true);
    }
}

/* Ten million units away, the camera with it, cells are still where they should be. */
static void test_pattern_far_away(void **state) {
    (void)state;
    const vec3 far_off = {1e7, 0, -1e7 - .5};
    const xform here = xform_identity();
    for (int i = 0; i < 4; i++) {
        test_scene s;
        scene_begin(&s);
        look_down(&s, far_off);
        scene_pattern(&s, i % 2 ? ZT_PATTERN_STRIPES : ZT_PATTERN_CHECKER, i < 2 ? 1 : .3);
        scene_plane(&s, (vec3){0, 1, 0}, 0, 0);
        assert_cells(&s, 0, &here, true);
    }
}

/* ---- things that carry their patterns -------------------------------------------------------
 */

/* Where a ray meets the cube from -1 to 1 that `place` takes to the world, and the normal
 * there, in its own space. Between faces, nothing is said. */
static bool meet_cube(vec3 *at, vec3 *normal, vec3 origin, const xform *place, vec3 ray) {
    xform back = xform_inverse(place);
    vec3 o = xform_point(&back, origin), d = xform_vector(&back, ray);
    const double os[3] = {o.x, o.y, o.z}, ds[3] = {d.x, d.y, d.z};
    double in = -INFINITY, out = INFINITY, n[3] = {0, 0, 0};
    int axis = 0;
    for (int i = 0; i < 3; i++) {
        double a = (-1 - os[i]) / ds[i], b = (1 - os[i]) / ds[i];
        if (fmin(a, b) > in) in = fmin(a, b), axis = i;
        out = fmin(out, fmax(a, b));
    }
    *at = vec3_add(o, vec3_scale(d, in));
    n[axis] = ds[axis] > 0 ? -1 : 1;
    *normal = (vec3){n[0], n[1], n[2]};
    return in > 0 && in < out;
}

/* A box and a mesh of the same cube, turned, moved and far away, whose faces lie on borders of
 * cells: each shows, a little below its faces, the cells of its own space. */
static void test_carried(void **state) {
    (void)state;
    for (int i = 0; i < 12; i++) {
        bool is_mesh = i % 2;
        vec3 around = i < 8 ? (vec3){0, 0, 0} : (vec3){1e7, -1e7, 3e6};
        test_scene s;
        scene_begin(&s);
        zt_mesh mesh = cube_mesh();
        s.scene.meshes = &mesh;
        s.scene.mesh_count = 1;
        s.scene.camera.fov = .7;
        s.scene.camera.position = around;
        vec3 position = vec3_add(around, (vec3){.2, -.1, -7});
        quat rotation = quat_axis_angle(vec3_normalize((vec3){1, .4 * i, .3}), .5 + i);
        zt_material *m = scene_pattern(&s, i % 4 < 2 ? ZT_PATTERN_CHECKER : ZT_PATTERN_STRIPES,
                                       i < 4 ? 1 : .5);
        zt_object *o = scene_object(&s, is_mesh ? ZT_SHAPE_MESH : ZT_SHAPE_BOX, 0);
        if (is_mesh) {
            o->mesh = 0;
            o->placement = (zt_placement){position, rotation, {1, 1, 1}};
        } else {
            o->box = (zt_block){position, {2, 2, 2}, rotation};
        }
        xform place = xform_place(position, rotation, (vec3){1, 1, 1});
        for (precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE; precision++) {
            zt_image *image = render(&s.scene, SIZE, SIZE, 1, 2);
            int seen[2] = {0, 0};
            for (int k = 0; k < SIZE * SIZE; k++) {
                vec3 at, n, got = pixel_at(image, k % SIZE, k / SIZE);
                vec3 ray = pixel_ray(&s.scene, SIZE, SIZE, k % SIZE, k / SIZE);
                if (!meet_cube(&at, &n, around, &place, ray)) continue;
                int cell = cell_below(m, at, n);
                if (cell < 0) continue;
                seen[cell]++;
                vec3 wanted = cell ? green : red;
                if (got.x != wanted.x || got.y != wanted.y || got.z != 0)
                    fail_msg("%d: pixel %d %d: %g %g %g in cell %d at %.9g %.9g %.9g", i,
                             k % SIZE, k / SIZE, got.x, got.y, got.z, cell, at.x, at.y, at.z);
            }
            assert_true(seen[0] > SIZE * SIZE / 40 && seen[1] > SIZE * SIZE / 40);
            zt_image_free(&image);
        }
        precision = ZT_PRECISION_AUTO;
    }
}

/* ---- vertex colors --------------------------------------------------------------------------
 */

/* One triangle, placed so that its sides are not alike: colors go from corner to corner in
 * straight lines, times the material's; or are not asked for. */
static void test_vertex_colors(void **state) {
    (void)state;
    static const float positions[] = {-2, -1, 0, 3, -1.5f, -1, 0, 2, .5f, 0};
    static const float colors[] = {1, .2f, 0, .1f, .9f, .3f, 0, .4f, 1};
    static const uint32_t triangles[] = {0, 1, 2};
    const zt_mesh mesh = {.positions = positions,
                          .triangles = triangles,
                          .colors = colors,
                          .vertex_count = 3,
                          .triangle_count = 1,
                          .low = {-2, -1.5, -1},
                          .high = {3, 2, .5}};
    const vec3 tint = {.5, 1, .25};
    test_scene s;
    scene_begin(&s);
    s.scene.meshes = &mesh;
    s.scene.mesh_count = 1;
    scene_material(&s, tint, 0);
    scene_ambient(&s, white, 1);
    zt_object *o = scene_object(&s, ZT_SHAPE_MESH, 0);
    o->mesh = 0;
    o->placement =
        (zt_placement){{.3, 0, -4}, quat_axis_angle((vec3){0, 1, 0}, .4), {1.2, .8, 2}};
    xform place = xform_place(o->placement.position, o->placement.rotation, o->placement.scale);
    vec3 v[3];
    for (int i = 0; i < 3; i++) v[i] = xform_point(&place, zt_mesh_corner(&mesh, 0, i));
    vec3 area = vec3_cross(vec3_sub(v[1], v[0]), vec3_sub(v[2], v[0]));
    for (int colored = 0; colored < 2; colored++)
        for (precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE; precision++) {
            o->vertex_colors = colored;
            zt_image *image = render(&s.scene, SIZE, SIZE, 1, 2);
            int seen = 0;
            for (int k = 0; k < SIZE * SIZE; k++) {
                vec3 ray = pixel_ray(&s.scene, SIZE, SIZE, k % SIZE, k / SIZE);
                vec3 p = vec3_scale(ray, vec3_dot(v[0], area) / vec3_dot(ray, area));
                double wanted[3] = {0, 0, 0}, least = 1;
                for (int i = 0; i < 3; i++) {
                    vec3 a = vec3_sub(v[(i + 1) % 3], p), b = vec3_sub(v[(i + 2) % 3], p);
                    double share = vec3_dot(vec3_cross(a, b), area) / vec3_dot(area, area);
                    for (int c = 0; c < 3; c++)
                        wanted[c] += share * (colored ? (double)colors[3 * i + c] : 1);
                    least = fmin(least, share);
                }
                if (least < 1e-4) continue;
                seen++;
                vec3 got = pixel_at(image, k % SIZE, k / SIZE);
                assert_float_equal(got.x, wanted[0] * tint.x, 4e-6);
                assert_float_equal(got.y, wanted[1] * tint.y, 4e-6);
                assert_float_equal(got.z, wanted[2] * tint.z, 4e-6);
            }
            assert_true(seen > SIZE * SIZE / 20);
            zt_image_free(&image);
        }
    precision = ZT_PRECISION_AUTO;
}

/* ---- smooth normals -------------------------------------------------------------------------
 */

/* A unit sphere of triangles in the origin, turned so that no edge runs along an axis, lit by
 * one lamp. */
static void begin_sphere(test_scene *s, const zt_mesh *mesh, vec3 lamp) {
    scene_begin(s);
    s->scene.camera.position = (vec3){0, 0, 4};
    s->scene.camera.fov = .6;
    s->scene.meshes = mesh;
    s->scene.mesh_count = 1;
    scene_material(s, white, 0);
    zt_object *o = scene_object(s, ZT_SHAPE_MESH, 0);
    o->mesh = 0;
    o->smooth = true;
    o->placement.rotation = quat_axis_angle((vec3){.36, .48, .8}, .7);
    scene_point_light(s, lamp, .8 * vec3_dot(lamp, lamp));
}

/* The light of the true sphere along a ray; -1 where it is not met, or near its outline. */
static double true_light(const test_scene *s, vec3 ray) {
    vec3 eye = s->scene.camera.position, lamp = s->lights[0].position;
    double b = vec3_dot(eye, ray), inside = b * b - vec3_dot(eye, eye) + 1;
    if (inside < .5) return -1; /* cosine of the view, squared */
    vec3 p = vec3_add(eye, vec3_scale(ray, -b - sqrt(inside)));
    vec3 v = vec3_sub(lamp, p);
    double d = vec3_length(v), toward = vec3_dot(p, v) / d;
    return toward > 0 ? fmin(s->lights[0].intensity / (d * d) * toward, 1) : 0;
}

/* The smooth shading of a coarse sphere is nearly that of the sphere, and flat shading is far
 * off: the normals of its corners are the sphere's, and what lies between is off by parallax
 * alone. */
static void test_smooth_shading(void **state) {
    (void)state;
    for (precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE; precision++) {
        ball_mesh ball = make_ball(3);
        test_scene s;
        begin_sphere(&s, &ball.mesh, (vec3){3, 4, 12});
        zt_image *smooth = render(&s.scene, SIZE, SIZE, 1, 2);
        s.objects[0].smooth = false;
        zt_image *flat = render(&s.scene, SIZE, SIZE, 1, 2);
        double worst_smooth = 0, worst_flat = 0;
        for (int k = 0; k < SIZE * SIZE; k++) {
            int x = k % SIZE, y = k / SIZE;
            double wanted = true_light(&s, pixel_ray(&s.scene, SIZE, SIZE, x, y));
            if (wanted < 0) continue;
            worst_smooth = fmax(worst_smooth, fabs(pixel_at(smooth, x, y).x - wanted));
            worst_flat = fmax(worst_flat, fabs(pixel_at(flat, x, y).x - wanted));
        }
        assert_true(worst_smooth < .02);
        assert_true(worst_flat > 5 * worst_smooth);
        zt_image_free(&smooth);
        zt_image_free(&flat);
        free_ball(&ball);
    }
    precision = ZT_PRECISION_AUTO;
}

/* Lit from the side, even a coarse sphere hides no point from the lamp that its normal faces:
 * no shadow falls where there would be light without. Along each row the light fades to nothing
 * and does not return. */
static void test_terminator(void **state) {
    (void)state;
    for (int round = 0; round < 6; round++) {
        precision = round % 2 ? ZT_PRECISION_SINGLE : ZT_PRECISION_DOUBLE;
        ball_mesh ball = make_ball(1 + round / 2);
        test_scene s;
        begin_sphere(&s, &ball.mesh, (vec3){60, 0, 0});
        zt_image *with = render(&s.scene, SIZE, SIZE, 1, 2);
        s.lights[0].shadows = false;
        zt_image *without = render(&s.scene, SIZE, SIZE, 1, 2);
        int lit = 0, dark = 0;
        double rise = 0, lost = 0;
        for (int y = 0; y < SIZE; y++) {
            double before = 1;
            for (int x = SIZE - 1; x >= 0; x--) { /* from the lamp to the dark */
                if (true_light(&s, pixel_ray(&s.scene, SIZE, SIZE, x, y)) < 0) continue;
                double got = pixel_at(with, x, y).x, open = pixel_at(without, x, y).x;
                lost = fmax(lost, open - got);
                rise = fmax(rise, got - before);
                lit += open > .1;
                dark += open == 0;
                before = got;
            }
        }
        assert_true(lost < 1e-3);
        assert_true(rise < .01);
        assert_true(lit > SIZE * SIZE / 20 && dark > SIZE * SIZE / 20);
        zt_image_free(&with);
        zt_image_free(&without);
        free_ball(&ball);
    }
    precision = ZT_PRECISION_AUTO;
}

/* A mesh that has normals and is not to be smooth has the bits of one without. */
static void test_flat_unchanged(void **state) {
    (void)state;
    ball_mesh ball = make_ball(1);
    zt_mesh bare = ball.mesh;
    bare.normals = NULL;
    for (precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE; precision++) {
        test_scene s;
        begin_sphere(&s, &ball.mesh, (vec3){30, 20, 9});
        s.objects[0].smooth = false;
        zt_image *with = render(&s.scene, SIZE, SIZE, 1, 2);
        s.scene.meshes = &bare;
        s.objects[0].smooth = true; /* and one without normals cannot be smooth */
        zt_image *without = render(&s.scene, SIZE, SIZE, 1, 2);
        assert_memory_equal(with->pixels, without->pixels, SIZE * SIZE * 4 * sizeof(float));
        zt_image_free(&with);
        zt_image_free(&without);
    }
    precision = ZT_PRECISION_AUTO;
    free_ball(&ball);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_checker),        cmocka_unit_test(test_stripes),
        cmocka_unit_test(test_pattern_moves),  cmocka_unit_test(test_pattern_far_away),
        cmocka_unit_test(test_carried),        cmocka_unit_test(test_vertex_colors),
        cmocka_unit_test(test_smooth_shading), cmocka_unit_test(test_terminator),
        cmocka_unit_test(test_flat_unchanged),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
