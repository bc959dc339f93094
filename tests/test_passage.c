/* Where points of things go from one frame to the next, and where cameras see them: against
 * the same points worked out from each scene's own numbers. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "scene/passage.h"

static const double pi = 3.14159265358979323846;

enum { PLACES = 64 }; /* of each thing */

static void assert_near(vec3 is, vec3 expected, double off, const char *what, int i) {
    if (!(vec3_max_abs(vec3_sub(is, expected)) <= off))
        fail_msg("%s, %d: %.15g %.15g %.15g, not %.15g %.15g %.15g", what, i, is.x, is.y, is.z,
                 expected.x, expected.y, expected.z);
}

/* ---- points ---------------------------------------------------------------------------------
 */

/* Turned around x: between two such turns the shortest one is around x as well. */
static vec3 tilted(double angle, double x, double y, double z) {
    double c = cos(angle), s = sin(angle);
    return (vec3){x, c * y - s * z, s * y + c * z};
}

/* A thing at some time, and all of its axes turned around x by `tilt`. */
typedef struct form {
    zt_object object;
    double tilt;
} form;

/* Numbers of 0..1, spread. */
static double spread(int i, double step) { return i * step - floor(i * step); }

/* Place number `i` on a thing. */
static vec3 place(const form *f, int i) {
    const zt_object *o = &f->object;
    double turn = 2 * pi * spread(i, 0.618), c = cos(turn), s = sin(turn),
           share = spread(i, 0.414);
    vec3 local = {0, 0, 0}, from = {0, 0, 0};
    switch (o->shape) {
    case ZT_SHAPE_PLANE:
        local = tilted(f->tilt, 9 * c * share, 9 * s * share, o->plane.distance);
        break;
    case ZT_SHAPE_SPHERE:
        from = o->sphere.center;
        local = vec3_scale((vec3){0.6 * c, 0.6 * s, 0.8}, o->sphere.radius);
        break;
    case ZT_SHAPE_TRIANGLE:
        for (int k = 0; k < 3; k++) {
            double part = k == 0 ? share / 2 : k == 1 ? 1 - share : share / 2;
            local = vec3_add(local, vec3_scale(o->triangle.vertices[k], part));
        }
        break;
    case ZT_SHAPE_DISK:
        from = o->disk.center;
        local = tilted(f->tilt, o->disk.radius * share * c, o->disk.radius * share * s, 0);
        break;
    case ZT_SHAPE_BOX: {
        xform own = xform_place(o->box.center, o->box.rotation, o->box.size);
        return xform_point(&own, (vec3){0.5, spread(i, 0.3) - 0.5, spread(i, 0.7) - 0.5});
    }
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE: {
        double end = o->shape == ZT_SHAPE_CONE ? o->tube.end_radius : o->tube.radius,
               wide = o->tube.radius + share * (end - o->tube.radius);
        from = o->tube.from;
        local = tilted(f->tilt, wide * c, wide * s,
                       share * vec3_length(vec3_sub(o->tube.to, o->tube.from)));
        break;
    }
    case ZT_SHAPE_CAPSULE: {
        double length = vec3_length(vec3_sub(o->tube.to, o->tube.from)), r = o->tube.radius;
        from = o->tube.from;
        if (i % 3 == 0)
            local = tilted(f->tilt, r * c, r * s, share * length);
        else if (i % 3 == 1)
            local = tilted(f->tilt, 0.6 * r * c, 0.6 * r * s, -0.8 * r);
        else
            local = tilted(f->tilt, 0.8 * r * c, 0.8 * r * s, length + 0.6 * r);
        break;
    }
    case ZT_SHAPE_TORUS: {
        double around = 2 * pi * share, tube = o->torus.tube_radius,
               out = o->torus.radius + tube * cos(around);
        from = o->torus.center;
        local = tilted(f->tilt, out * c, out * s, tube * sin(around));
        break;
    }
    default: {
        xform own =
            xform_place(o->placement.position, o->placement.rotation, o->placement.scale);
        return xform_point(&own, (vec3){c, s, share});
    }
    }
    return vec3_add(from, local);
}

/* Number `when` of each kind. */
static form make(zt_shape shape, int when) {
    form f = {.object = {.shape = shape, .parent = -1, .mesh = -1}};
    zt_object *o = &f.object;
    double later = when;
    vec3 center = {1 + later, 2 - 3 * later, -4 + 0.5 * later};
    quat rotation = quat_normalize((quat){1, 0.3 * later, 0.2, -0.5 * later});
    f.tilt = 0.4 + 0.9 * later;
    vec3 axis = tilted(f.tilt, 0, 0, 1);
    switch (shape) {
    case ZT_SHAPE_PLANE:
        o->plane = (zt_plane){vec3_scale(axis, 3), 2 + later};
        break;
    case ZT_SHAPE_SPHERE:
        o->sphere = (zt_sphere){center, 1.5 + later};
        break;
    case ZT_SHAPE_TRIANGLE:
        o->triangle = (zt_triangle){{center, {5, later, 1}, {-2, 3, 4 * later}}};
        break;
    case ZT_SHAPE_DISK:
        o->disk = (zt_disk){center, vec3_scale(axis, 0.2), 2 - later / 2};
        break;
    case ZT_SHAPE_BOX:
        o->box = (zt_block){center, {1, 2 + later, 3 - later}, rotation};
        break;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
    case ZT_SHAPE_CAPSULE:
        o->tube = (zt_tube){center, vec3_add(center, vec3_scale(axis, 3 + later)), 1 + later,
                            shape == ZT_SHAPE_CONE ? 0.5 * later : 0};
        break;
    case ZT_SHAPE_TORUS:
        o->torus = (zt_torus){center, axis, 3 + later, 0.5 + 0.7 * later};
        break;
    default:
        o->placement = (zt_placement){center, rotation, {1, 1 + later, 2}};
    }
    return f;
}

/* A group within a group, both of which move, and a thing in it, or alone. */
static void put_in(zt_object *objects, int when, const form *f, bool grouped) {
    for (int i = 0; i < 2; i++) {
        objects[i] = make(ZT_SHAPE_GROUP, when).object;
        objects[i].parent = i - 1;
        objects[i].material = -1;
    }
    objects[2] = f->object;
    objects[2].parent = grouped ? 1 : -1;
}

/* Each shape, alone and in groups, whatever of it moves and grows. */
static void carried(void **state) {
    (void)state;
    const vec3 origin = {7, -8, 9};
    for (zt_shape shape = 0; shape < ZT_SHAPE_GROUP; shape++) {
        for (int grouped = 0; grouped < 2; grouped++) {
            zt_object objects[2][3] = {0};
            zt_scene scenes[2];
            xform worlds[2][3];
            form forms[2];
            zt_arena arena = {0};
            zt_passage passage;
            for (int when = 0; when < 2; when++) {
                forms[when] = make(shape, when);
                put_in(objects[when], when, &forms[when], grouped);
                scenes[when] = (zt_scene){.objects = objects[when], .object_count = 3};
                zt_scene_worlds(worlds[when], &scenes[when], origin);
            }
            assert_int_equal(
                zt_passage_prepare(&passage, &scenes[0], &scenes[1], origin, &arena), ZT_OK);
            char what[32];
            snprintf(what, sizeof what, "shape %d%s", shape, grouped ? " in groups" : "");
            for (int i = 0; i < PLACES; i++)
                assert_near(zt_passage_carry(&passage, 2,
                                             xform_point(&worlds[0][2], place(&forms[0], i))),
                            xform_point(&worlds[1][2], place(&forms[1], i)), 1e-11, what, i);
            zt_arena_free(&arena);
        }
    }
}

/* What stays where it is keeps all bits of its place, however far away it is; what is turned
 * over, or shrinks to nothing, goes somewhere. */
static void extremes(void **state) {
    (void)state;
    zt_object objects[2][3] = {0};
    zt_scene scenes[2];
    for (int when = 0; when < 2; when++) {
        form still = make(ZT_SHAPE_TORUS, 0);
        put_in(objects[when], 0, &still, true);
        objects[when][0].placement.position.x = 1e9;
        scenes[when] = (zt_scene){.objects = objects[when], .object_count = 3};
    }
    zt_arena arena = {0};
    zt_passage passage;
    const vec3 origin = {1e9, 0.1, 0.2}, point = {1.0 / 3, 1.0 / 7, -1e-9};
    assert_int_equal(zt_passage_prepare(&passage, &scenes[0], &scenes[1], origin, &arena),
                     ZT_OK);
    vec3 same = zt_passage_carry(&passage, 2, point);
    assert_memory_equal(&same, &point, sizeof same);
    objects[0][2] = objects[1][2] =
        (zt_object){.shape = ZT_SHAPE_DISK, .parent = -1, .disk = {{0, 0, 0}, {0, 0, 1}, 2}};
    objects[1][2].disk.normal.z = -1;
    assert_int_equal(
        zt_passage_prepare(&passage, &scenes[0], &scenes[1], (vec3){0, 0, 0}, &arena), ZT_OK);
    vec3 over = zt_passage_carry(&passage, 2, (vec3){1, 0.5, 0});
    assert_true(fabs(hypot(over.x, over.y) - hypot(1, 0.5)) < 1e-12 && fabs(over.z) < 1e-12);
    objects[1][2].disk = (zt_disk){{3, 4, 5}, {0, 0, 1}, 0};
    assert_int_equal(
        zt_passage_prepare(&passage, &scenes[0], &scenes[1], (vec3){0, 0, 0}, &arena), ZT_OK);
    assert_near(zt_passage_carry(&passage, 2, (vec3){1, 0.5, 0}), (vec3){3, 4, 5}, 1e-12,
                "nothing", 0);
    zt_arena_free(&arena);
}

/* Only numbers that say where a thing is move it: not how light falls on it, nor what memory
 * holds between its fields and behind those of its shape. */
static void alike(void **state) {
    (void)state;
    const zt_shape shapes[] = {ZT_SHAPE_SPHERE, ZT_SHAPE_MESH};
    const vec3 none = {0, 0, 0}, point = {1.0 / 3, 1.0 / 7, -1e-9};
    for (int i = 0; i < 2; i++) {
        const zt_object thing = make(shapes[i], 0).object;
        zt_object objects[2];
        zt_scene scenes[2];
        for (int when = 0; when < 2; when++) {
            zt_object *o = &objects[when];
            memset(o, when ? 0xff : 0, sizeof *o);
            o->shape = thing.shape;
            o->parent = o->material = o->mesh = -1;
            o->smooth = o->vertex_colors = when;
            if (thing.shape == ZT_SHAPE_SPHERE)
                o->sphere = thing.sphere;
            else
                o->placement = thing.placement;
            scenes[when] = (zt_scene){.objects = o, .object_count = 1};
        }
        zt_arena arena = {0};
        zt_passage passage;
        assert_int_equal(zt_passage_prepare(&passage, &scenes[0], &scenes[1], none, &arena),
                         ZT_OK);
        vec3 same = zt_passage_carry(&passage, 0, point);
        assert_memory_equal(&same, &point, sizeof same);
        zt_arena_free(&arena);
    }
}

/* ---- cameras --------------------------------------------------------------------------------
 */

static const zt_camera cameras[] = {
    {.position = {1, 2, 3}, .rotation = {1, 0, 0, 0}, .fov = 0.8},
    {.position = {1, 2, 3}, .look_at = {-4, 0, 1}, .up = {0, 1, 0}, .aimed = true, .fov = 2},
    {.position = {-50, 9, 3},
     .look_at = {-4, 0, 1},
     .up = {0, 0, 1},
     .aimed = true,
     .roll = 0.3,
     .focal_length = 50,
     .sensor_height = 24},
    {.position = {1, 2, 3},
     .look_at = {-4, 0, 1},
     .up = {0, 1, 0},
     .aimed = true,
     .roll = -2,
     .lens = ZT_LENS_ORTHOGRAPHIC,
     .height = 7},
    {.position = {1, 2, 3},
     .look_at = {-4, 0, 1},
     .up = {0, 1, 0},
     .aimed = true,
     .roll = 1,
     .lens = ZT_LENS_EQUIRECTANGULAR}};
enum { CAMERA_COUNT = sizeof cameras / sizeof *cameras };

/* The point so far ahead at a place of the picture, 0..1 from the left and the top. */
static vec3 ahead(const zt_camera *camera, double aspect, double x, double y, double far) {
    xform axes = zt_camera_xform(camera);
    double right = (x - 0.5) * 2 * aspect, up = (0.5 - y) * 2, along = far;
    if (camera->lens == ZT_LENS_PERSPECTIVE) {
        double tangent = camera->focal_length > 0
                             ? camera->sensor_height / 2 / camera->focal_length
                             : tan(camera->fov / 2);
        right *= tangent * far, up *= tangent * far;
    } else if (camera->lens == ZT_LENS_ORTHOGRAPHIC) {
        right *= camera->height / 2, up *= camera->height / 2;
    } else {
        double longitude = (x - 0.5) * 2 * pi, latitude = (0.5 - y) * pi;
        right = far * cos(latitude) * sin(longitude), up = far * sin(latitude);
        along = far * cos(latitude) * cos(longitude);
    }
    return xform_point(&axes, (vec3){right, up, -along});
}

/* A row times a matrix. */
static void times(double out[4], vec3 p, const double m[16]) {
    for (int k = 0; k < 4; k++)
        out[k] = p.x * m[k] + p.y * m[4 + k] + p.z * m[8 + k] + m[12 + k];
}

static void seen(void **state) {
    (void)state;
    const double aspect = 1.7;
    const vec3 origin = {10, 20, -30};
    for (int c = 0; c < CAMERA_COUNT; c++) {
        const zt_camera *camera = &cameras[c];
        zt_projection projection = zt_camera_projection(camera, origin, aspect);
        xform axes = zt_camera_xform(camera);
        double to_camera[16], to_picture[16];
        zt_camera_matrices(to_camera, to_picture, camera, aspect);
        for (int i = 1; i <= PLACES; i++) {
            double x = spread(i, 0.618), y = spread(i, 0.414), far = 0.1 + i, is_x, is_y;
            vec3 p = ahead(camera, aspect, x, y, far), way = vec3_sub(p, camera->position);
            assert_true(zt_project(&is_x, &is_y, &projection, vec3_sub(p, origin)));
            assert_near((vec3){is_x, is_y, 0}, (vec3){x, y, 0}, 1e-10, "picture", i);
            double out[4];
            times(out, p, to_camera);
            assert_near(
                (vec3){out[0], out[1], out[2]},
                (vec3){vec3_dot(way, axes.x), vec3_dot(way, axes.y), -vec3_dot(way, axes.z)},
                1e-10, "camera", i);
            assert_true(fabs(out[3] - 1) < 1e-12);
            times(out, p, to_picture);
            if (camera->lens == ZT_LENS_EQUIRECTANGULAR)
                for (int k = 0; k < 16; k++) assert_true(to_picture[k] == 0);
            else
                assert_near((vec3){out[0] / out[3], out[1] / out[3], 0}, (vec3){x, y, 0}, 1e-10,
                            "matrix", i);
        }
    }
}

/* Flat pictures do not show what is behind. */
static void behind(void **state) {
    (void)state;
    for (int c = 0; c < CAMERA_COUNT; c++) {
        double x, y;
        zt_projection projection = zt_camera_projection(&cameras[c], (vec3){0, 0, 0}, 2);
        vec3 back = vec3_add(cameras[c].position, zt_camera_xform(&cameras[c]).z);
        bool shown = zt_project(&x, &y, &projection, back);
        assert_true(shown == (cameras[c].lens == ZT_LENS_EQUIRECTANGULAR));
        assert_false(cameras[c].lens != ZT_LENS_ORTHOGRAPHIC &&
                     zt_project(&x, &y, &projection, cameras[c].position));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(carried), cmocka_unit_test(extremes),
                                       cmocka_unit_test(alike), cmocka_unit_test(seen),
                                       cmocka_unit_test(behind)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
