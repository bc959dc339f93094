/* Shows that freezing writes what is keyed, and nothing else, into a scene of the frame's own.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "keyframe/animation.h"
#include "keys.h"

static const double pi = 3.14159265358979323846;

static const zt_listener deaf;

/* One object of each shape in the order of the owners, and a second one that must stay as it
 * is. */
enum { SHAPES = ZT_OWNER_GROUP - ZT_OWNER_PLANE + 1, OBJECTS = 2 * SHAPES };
enum { LIGHTS = 4, MATERIALS = 3, OTHER_SPHERE = SHAPES + 1 };
static const zt_mesh meshes[2] = {{.triangle_count = 70000}, {.triangle_count = 12}};

static zt_animation *create(void) {
    zt_animation *animation = calloc(1, sizeof *animation);
    assert_non_null(animation);
    zt_arena *arena = &animation->arena;
    zt_scene *rest = &animation->rest;
    *rest = (zt_scene){.meshes = meshes,
                       .materials = ZT_PUSH(arena, zt_material, MATERIALS),
                       .lights = ZT_PUSH(arena, zt_light, LIGHTS),
                       .objects = ZT_PUSH(arena, zt_object, OBJECTS),
                       .mesh_count = 2,
                       .material_count = MATERIALS,
                       .light_count = LIGHTS,
                       .object_count = OBJECTS,
                       .reflection_depth = 7};
    zt_property_rest(rest, ZT_OWNER_CAMERA, 0);
    for (int i = 0; i < MATERIALS; i++) zt_property_rest(rest, ZT_OWNER_MATERIAL, i);
    for (int i = 0; i < LIGHTS; i++)
        zt_property_rest(rest, i % 2 ? ZT_OWNER_POINT : ZT_OWNER_AMBIENT, i);
    for (int i = 0; i < OBJECTS; i++) {
        zt_object *object = &rest->objects[i];
        zt_property_rest(rest, (zt_owner)(ZT_OWNER_PLANE + i % SHAPES), i);
        if (object->shape == ZT_SHAPE_MESH) object->mesh = i / SHAPES;
        if (object->shape == ZT_SHAPE_TORUS) object->torus.radius = 2;
    }
    return animation;
}

/* Moves one property from `begin` in each channel at 1 s to `end` at 3 s. */
static void add_track(zt_animation *animation, zt_owner owner, const char *name, int index,
                      double begin, double end) {
    zt_arena *arena = &animation->arena;
    const double times[] = {1, 3};
    double values[2 * ZT_VALUE_WIDTH_MAX];
    const zt_property *property = zt_property_find(owner, name);
    assert_non_null(property);
    int width = zt_value_width(property->kind);
    for (int c = 0; c < width; c++) values[c] = begin, values[width + c] = end;
    zt_track *tracks = ZT_PUSH(arena, zt_track, animation->track_count + 1);
    if (animation->track_count)
        memcpy(tracks, animation->tracks, (size_t)animation->track_count * sizeof *tracks);
    zt_track *track = &tracks[animation->track_count++];
    *track = (zt_track){.property = property, .index = index, .name = name};
    assert_int_equal(
        curve_through(&track->curve, arena, ZT_CURVE_LINEAR, property->kind, 2, times, values),
        ZT_OK);
    animation->tracks = tracks;
}

static void assert_reads(const zt_scene *scene, zt_owner owner, const char *name, int index,
                         double expected) {
    double value[ZT_VALUE_WIDTH_MAX];
    const zt_property *property = zt_property_find(owner, name);
    zt_property_get(value, property, scene, index);
    for (int c = 0; c < zt_value_width(property->kind); c++)
        if (value[c] != expected) fail_msg("%s is %g, not %g", name, value[c], expected);
}

/* Where a thing's fields are in a scene, told by the scene's own structs. */
static int first_of(zt_owner owner) {
    if (owner >= ZT_OWNER_PLANE) return (int)(owner - ZT_OWNER_PLANE);
    return owner >= ZT_OWNER_POINT ? 1 : 0;
}

static int bytes_that_differ(const void *a, const void *b, size_t size, size_t from,
                             size_t to) {
    int count = 0;
    for (size_t i = 0; i < size; i++)
        if ((i < from || i >= to) && ((const char *)a)[i] != ((const char *)b)[i]) count++;
    return count;
}

/* Bytes of the frozen arrays and camera that differ from the scene at rest outside of the one
 * property that moves. */
static int strays(const zt_scene *scene, const zt_scene *rest, const zt_property *p,
                  int index) {
    size_t size =
        p->kind == ZT_VALUE_SWITCH ? sizeof(bool) : 8 * (size_t)zt_value_width(p->kind);
    size_t from[4] = {0}, to[4] = {0};
    int array = p->owner == ZT_OWNER_CAMERA     ? 0
                : p->owner == ZT_OWNER_MATERIAL ? 1
                : p->owner < ZT_OWNER_PLANE     ? 2
                                                : 3;
    static const size_t element[4] = {0, sizeof(zt_material), sizeof(zt_light),
                                      sizeof(zt_object)};
    from[array] = element[array] * (size_t)index + p->offset;
    to[array] = from[array] + size;
    return bytes_that_differ(&scene->camera, &rest->camera, offsetof(zt_camera, aimed), from[0],
                             to[0]) +
           bytes_that_differ(scene->materials, rest->materials, MATERIALS * element[1], from[1],
                             to[1]) +
           bytes_that_differ(scene->lights, rest->lights, LIGHTS * element[2], from[2], to[2]) +
           bytes_that_differ(scene->objects, rest->objects, OBJECTS * element[3], from[3],
                             to[3]);
}

/* Each property of the table moves when it is keyed, all else keeps its bits, and the scene at
 * rest is not touched. */
static void one_property_moves(void **state) {
    (void)state;
    for (int i = 0; i < zt_property_count; i++) {
        const zt_property *p = &zt_properties[i];
        zt_animation *animation = create();
        int index = first_of(p->owner);
        add_track(animation, p->owner, p->name, index, 1, 0.25);
        zt_arena frame = {0};
        zt_scene before, scene;
        assert_int_equal(zt_animation_freeze(&before, animation, 0, &frame, deaf), ZT_OK);
        assert_int_equal(zt_animation_freeze(&scene, animation, 3, &frame, deaf), ZT_OK);
        const zt_scene *rest = &animation->rest;
        assert_ptr_not_equal(scene.objects, rest->objects);
        assert_ptr_not_equal(scene.materials, rest->materials);
        assert_ptr_not_equal(scene.lights, rest->lights);
        assert_ptr_equal(scene.meshes, rest->meshes);
        assert_int_equal(scene.reflection_depth, 7);
        assert_int_equal(scene.object_count + scene.light_count + scene.material_count,
                         OBJECTS + LIGHTS + MATERIALS);
        assert_int_equal(scene.camera.aimed, rest->camera.aimed);
        if (p->kind != ZT_VALUE_ROTATION) {
            assert_reads(&before, p->owner, p->name, index, 1);
            assert_reads(&scene, p->owner, p->name, index,
                         p->kind == ZT_VALUE_SWITCH ? 0 : 0.25);
        } else
            assert_reads(&scene, p->owner, p->name, index, 0.5);
        assert_int_equal(strays(&scene, rest, p, index), 0);
        assert_int_equal(strays(&before, rest, p, index), 0);
        zt_animation *again = create();
        assert_int_equal(strays(rest, &again->rest, p, -100), 0);
        zt_animation_free(&again);
        zt_animation_free(&animation);
        zt_arena_free(&frame);
    }
}

/* Several tracks on several things at once, at a time between keys, in the middle of a film. */
static void many_properties_move(void **state) {
    (void)state;
    zt_animation *animation = create();
    add_track(animation, ZT_OWNER_SPHERE, "center", 1, 0, 8);
    add_track(animation, ZT_OWNER_SPHERE, "radius", OTHER_SPHERE, 2, 4);
    add_track(animation, ZT_OWNER_CAMERA, "fov", 0, 1, 2);
    add_track(animation, ZT_OWNER_POINT, "intensity", 3, 10, 30);
    add_track(animation, ZT_OWNER_MATERIAL, "color", 2, 1, 0);
    zt_arena frame = {0};
    zt_scene scene;
    for (int round = 0; round < 3; round++) {
        zt_arena_reset(&frame);
        assert_int_equal(zt_animation_freeze(&scene, animation, 1.5, &frame, deaf), ZT_OK);
        assert_reads(&scene, ZT_OWNER_SPHERE, "center", 1, 2);
        assert_reads(&scene, ZT_OWNER_SPHERE, "radius", 1, 0);
        assert_reads(&scene, ZT_OWNER_SPHERE, "center", OTHER_SPHERE, 0);
        assert_reads(&scene, ZT_OWNER_SPHERE, "radius", OTHER_SPHERE, 2.5);
        assert_reads(&scene, ZT_OWNER_CAMERA, "fov", 0, 1.25);
        assert_reads(&scene, ZT_OWNER_POINT, "intensity", 1, 1);
        assert_reads(&scene, ZT_OWNER_POINT, "intensity", 3, 15);
        assert_reads(&scene, ZT_OWNER_MATERIAL, "color", 2, 0.75);
        assert_reads(&scene, ZT_OWNER_MATERIAL, "color", 1, 1);
    }
    zt_animation_free(&animation);
    zt_arena_free(&frame);
}

/* A value that a curve carries out of its property's range stops there: no negative radius, no
 * mirror that gives more than it gets, no opening beyond half a turn. */
static void out_of_range(void **state) {
    (void)state;
    static const struct {
        zt_owner owner;
        const char *name;
        int index;
        double low, high; /* in the scene's units */
    } cases[] = {{ZT_OWNER_SPHERE, "radius", 1, 0, INFINITY},
                 {ZT_OWNER_MATERIAL, "reflectivity", 0, 0, 1},
                 {ZT_OWNER_MATERIAL, "color", 1, 0, INFINITY},
                 {ZT_OWNER_CAMERA, "fov", 0, 1e-6 * pi / 180, 179.9 * pi / 180},
                 {ZT_OWNER_PLANE, "distance", 0, -INFINITY, INFINITY}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_animation *animation = create();
        zt_arena frame = {0};
        const double values[2][3] = {{0.25, 0.25, 0.25}, {0.5, 0.5, 0.5}};
        const zt_key keys[] = {{.time_s = 0, .value = values[0], .kind = ZT_CURVE_LINEAR},
                               {.time_s = 1, .value = values[1], .kind = ZT_CURVE_LINEAR}};
        zt_track *track = ZT_PUSH(&animation->arena, zt_track, 1);
        *track = (zt_track){.property = zt_property_find(cases[i].owner, cases[i].name),
                            .index = cases[i].index};
        zt_curve_spec spec = {.value_kind = track->property->kind,
                              .key_count = 2,
                              .keys = keys,
                              .before = ZT_END_LINEAR,
                              .after = ZT_END_LINEAR};
        assert_int_equal(zt_curve_from_keys(&track->curve, &animation->arena, &spec), ZT_OK);
        animation->tracks = track;
        animation->track_count = 1;
        for (double t = -40; t <= 40; t += 8) {
            zt_scene scene;
            zt_arena_reset(&frame);
            assert_int_equal(zt_animation_freeze(&scene, animation, t, &frame, deaf), ZT_OK);
            assert_reads(&scene, cases[i].owner, cases[i].name, cases[i].index,
                         fmin(fmax(0.25 + 0.25 * t, cases[i].low), cases[i].high));
        }
        zt_animation_free(&animation);
        zt_arena_free(&frame);
    }
}

/* A torus's tube is at most as wide as the hole, at each moment, whichever of the two moves. */
static void torus_tube(void **state) {
    (void)state;
    zt_animation *animation = create();
    const int torus = first_of(ZT_OWNER_TORUS);
    zt_arena frame = {0};
    zt_scene scene;
    add_track(animation, ZT_OWNER_TORUS, "tube_radius", torus, 1, 5);
    add_track(animation, ZT_OWNER_TORUS, "radius", torus, 4, 0);
    for (double t = 1; t <= 3; t += 0.25) {
        assert_int_equal(zt_animation_freeze(&scene, animation, t, &frame, deaf), ZT_OK);
        double tube = 1 + 2 * (t - 1), radius = 4 - 2 * (t - 1);
        assert_true(scene.objects[torus].torus.tube_radius == fmin(tube, radius));
        assert_true(scene.objects[torus].torus.radius == radius);
    }
    zt_animation_free(&animation);
    zt_arena_free(&frame);
}

/* A scene of nothing at all freezes. */
static void nothing(void **state) {
    (void)state;
    zt_animation animation = {.film = {.frame_count = 1}};
    zt_arena frame = {0};
    zt_scene scene;
    assert_int_equal(zt_animation_freeze(&scene, &animation, 0, &frame, deaf), ZT_OK);
    assert_int_equal(scene.object_count, 0);
    zt_arena_free(&frame);
}

/* The summary counts what there is, each use of a mesh; movements name their curves and keys.
 */
static void summary(void **state) {
    (void)state;
    zt_animation *animation = create();
    animation->film.frame_count = 96;
    add_track(animation, ZT_OWNER_SPHERE, "center", 1, 0, 8);
    add_track(animation, ZT_OWNER_POINT, "shadows", 1, 0, 1);
    animation->rest.objects[0].shape = ZT_SHAPE_MESH;
    animation->rest.objects[0].mesh = 1;
    zt_contents contents = zt_animation_contents(animation);
    assert_int_equal(contents.plane_count, 1);
    assert_int_equal(contents.sphere_count, 2);
    assert_int_equal(contents.triangle_count, 2);
    assert_int_equal(contents.group_count, 2);
    assert_int_equal(contents.disk_count + contents.box_count, 2 + 2);
    assert_int_equal(contents.cylinder_count + contents.cone_count, 2 + 2);
    assert_int_equal(contents.torus_count + contents.capsule_count, 2 + 2);
    assert_int_equal(contents.mesh_count, 3);
    assert_int_equal(contents.mesh_triangle_count, 70000 + 12 + 12);
    assert_int_equal(contents.ambient_light_count, 2);
    assert_int_equal(contents.point_light_count, 2);
    assert_int_equal(contents.material_count, MATERIALS);
    assert_int_equal(contents.track_count, 2);
    assert_int_equal(zt_animation_film(animation)->frame_count, 96);
    zt_movement center = zt_animation_movement(animation, 0);
    assert_string_equal(center.name, "center");
    assert_string_equal(center.driver, "linear");
    assert_int_equal(center.key_count, 2);
    assert_true(center.first_s == 1 && center.last_s == 3);
    assert_string_equal(zt_animation_movement(animation, 1).driver, "hold");
    zt_animation_free(&animation);
    assert_null(animation);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_property_moves),
        cmocka_unit_test(many_properties_move),
        cmocka_unit_test(out_of_range),
        cmocka_unit_test(torus_tube),
        cmocka_unit_test(nothing),
        cmocka_unit_test(summary),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
