/* Shows that orbits, paths, offsets and looks give the values of their closed forms, from where
 * things are in groups that move, and that tracks are evaluated each after what it reads. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "keyframe/order.h"
#include "keyframe/rotation.h"
#include "keys.h"

static const double pi = 3.14159265358979323846;
static const zt_listener deaf;

/* A sphere in the world, and a sphere and a mesh in a group within a group; a light. */
enum { SUN, OUTER, INNER, PLANET, SHIP, OBJECTS };
enum { TRACKS_MAX = 16 };

typedef struct stage {
    zt_animation *animation;
    zt_track tracks[TRACKS_MAX];
    zt_arena frame;
    zt_scene scene;
} stage;

static void open_stage(stage *s) {
    static const zt_owner owners[OBJECTS] = {ZT_OWNER_SPHERE, ZT_OWNER_GROUP, ZT_OWNER_GROUP,
                                             ZT_OWNER_SPHERE, ZT_OWNER_MESH};
    static const int32_t parents[OBJECTS] = {-1, -1, OUTER, INNER, INNER};
    *s = (stage){.animation = calloc(1, sizeof *s->animation)};
    zt_animation *a = s->animation;
    assert_non_null(a);
    a->film = (zt_film){.rate = {24, 1}, .frame_count = 240};
    a->rest.objects = ZT_PUSH(&a->arena, zt_object, OBJECTS);
    a->rest.lights = ZT_PUSH(&a->arena, zt_light, 1);
    a->rest.object_count = OBJECTS;
    a->rest.light_count = 1;
    for (int i = 0; i < OBJECTS; i++) {
        zt_property_rest(&a->rest, owners[i], i);
        a->rest.objects[i].parent = parents[i];
    }
    zt_property_rest(&a->rest, ZT_OWNER_POINT, 0);
    zt_property_rest(&a->rest, ZT_OWNER_CAMERA, 0);
    a->tracks = s->tracks;
}

static void close_stage(stage *s) {
    zt_arena_free(&s->frame);
    zt_animation_free(&s->animation);
}

static zt_reference of(zt_owner owner, const char *name, int32_t index) {
    const zt_property *property = zt_property_find(owner, name);
    assert_non_null(property);
    return (zt_reference){property, index};
}

/* A new track of a property; its kind and the rest are the caller's. */
static zt_track *drive(stage *s, zt_owner owner, const char *name, int32_t index,
                       zt_track_kind kind) {
    zt_reference driven = of(owner, name, index);
    zt_track *track = &s->tracks[s->animation->track_count++];
    assert_true(s->animation->track_count <= TRACKS_MAX);
    *track =
        (zt_track){.property = driven.property, .index = index, .name = name, .kind = kind};
    return track;
}

/* Turns a group around its y axis, once in 8 seconds. */
static void spin(stage *s, int32_t group) {
    zt_track *track = drive(s, ZT_OWNER_GROUP, "rotation", group, ZT_TRACK_CURVE);
    const double turns[2][3] = {{0, 0, 0}, {0, 2 * pi, 0}};
    const zt_key keys[] = {key(0, turns[0], ZT_CURVE_LINEAR), key(8, turns[1], ZT_CURVE_HOLD)};
    track->curve =
        curve_of(&s->animation->arena, &(zt_curve_spec){.value_kind = ZT_VALUE_ROTATION,
                                                        .space = ZT_SPACE_TURNS,
                                                        .key_count = 2,
                                                        .keys = keys,
                                                        .after = ZT_END_LOOP});
}

static void no_cycle(void *user, const zt_animation *animation, const int32_t *tracks,
                     int32_t count) {
    (void)user, (void)animation, (void)tracks;
    fail_msg("a cycle of %d", count);
}

static void sort(stage *s) {
    assert_int_equal(zt_animation_sort(s->animation, (zt_cycle_listener){no_cycle, NULL}),
                     ZT_OK);
}

static const zt_scene *at(stage *s, double time_s) {
    zt_arena_reset(&s->frame);
    assert_int_equal(zt_animation_freeze(&s->scene, s->animation, time_s, &s->frame, deaf),
                     ZT_OK);
    return &s->scene;
}

static void assert_vec(vec3 found, vec3 expected, double tolerance) {
    if (vec3_max_abs(vec3_sub(found, expected)) <= tolerance) return;
    fail_msg("(%.17g, %.17g, %.17g) is not (%.17g, %.17g, %.17g)", found.x, found.y, found.z,
             expected.x, expected.y, expected.z);
}

/* Where a point of a thing's own space is in the world, by the scene's own composition. */
static vec3 in_world(const zt_scene *scene, int32_t index, vec3 point) {
    xform worlds[OBJECTS];
    zt_scene_worlds(worlds, scene, (vec3){0, 0, 0});
    return xform_point(&worlds[index], point);
}

/* ---- orbits ---------------------------------------------------------------------------------
 */

/* At quarters of its period it is exactly where a compass points, also after a billion rounds;
 * between, on the circle at the angle of its time; a negative period goes the other way. */
static void orbit_in_closed_form(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    zt_track *track = drive(&s, ZT_OWNER_SPHERE, "center", SUN, ZT_TRACK_ORBIT);
    track->orbit =
        (zt_orbit){.around.point = {1, 2, 3}, .radius = 2, .period_s = 4, .axis = {0, 1, 0}};
    sort(&s);
    const vec3 compass[] = {{3, 2, 3}, {1, 2, 1}, {-1, 2, 3}, {1, 2, 5}};
    for (int i = 0; i < 4; i++) {
        assert_vec(at(&s, i)->objects[SUN].sphere.center, compass[i], 0);
        assert_vec(at(&s, 4e9 + i)->objects[SUN].sphere.center, compass[i], 0);
        assert_vec(at(&s, i - 400)->objects[SUN].sphere.center, compass[i], 0);
    }
    for (double t = 0; t < 4; t += 0.0625) {
        double a = 2 * pi * t / 4 + 0.3;
        track->orbit.period_s = 4;
        track->orbit.phase = 0.3;
        vec3 expected = {1 + 2 * cos(a), 2, 3 - 2 * sin(a)};
        assert_vec(at(&s, t)->objects[SUN].sphere.center, expected, 2e-15);
        track->orbit.period_s = -4;
        track->orbit.phase = -0.3;
        expected.z = 6 - expected.z;
        assert_vec(at(&s, t)->objects[SUN].sphere.center, expected, 2e-15);
    }
    close_stage(&s);
}

/* Whatever its axis, an orbit keeps its distance and its plane, turns counterclockwise seen
 * from the axis' tip, and begins as near to x as can be, or at y where the axis is x. */
static void orbit_around_any_axis(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    zt_track *track = drive(&s, ZT_OWNER_POINT, "position", 0, ZT_TRACK_ORBIT);
    sort(&s);
    draw d = {7, 0};
    for (int i = 0; i < 1000; i++) {
        vec3 axis = {draw_between(&d, -1, 1), draw_between(&d, -1, 1), draw_between(&d, -1, 1)};
        if (i < 2) axis = (vec3){i ? 1 : -1, 0, 0};
        axis = vec3_normalize(axis);
        track->orbit = (zt_orbit){.radius = 3, .period_s = 2, .axis = axis};
        vec3 begin = at(&s, 0)->lights[0].position, quarter = at(&s, 0.5)->lights[0].position;
        assert_true(fabs(vec3_length(begin) - 3) < 4e-15);
        assert_true(fabs(vec3_dot(begin, axis)) < 4e-15);
        assert_vec(vec3_cross(axis, begin), quarter, 4e-15);
        if (i < 2)
            assert_vec(begin, (vec3){0, 3, 0}, 0);
        else
            assert_true(begin.x >= 0 &&
                        fabs(vec3_dot(vec3_cross(axis, begin), (vec3){1, 0, 0})) < 4e-15);
    }
    close_stage(&s);
}

/* A light around a planet in a group that turns in a group that turns: both turn by 45 degrees
 * a second around y, so the planet goes round at 90. The groups' tracks stand after the
 * light's, and are evaluated before it. */
static void orbit_around_things_in_groups(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    zt_object *objects = s.animation->rest.objects;
    objects[OUTER].placement.position = (vec3){10, 0, 0};
    objects[INNER].placement.scale = (vec3){2, 2, 2};
    objects[PLANET].sphere.center = (vec3){1, 0, 0};
    zt_track *track = drive(&s, ZT_OWNER_POINT, "position", 0, ZT_TRACK_ORBIT);
    track->orbit = (zt_orbit){.around.thing = of(ZT_OWNER_SPHERE, "center", PLANET),
                              .radius = 1,
                              .period_s = 1,
                              .axis = {0, 1, 0}};
    spin(&s, OUTER);
    spin(&s, INNER);
    sort(&s);
    assert_int_equal(s.animation->order[2], 0);
    for (double t = 0; t < 8; t += 0.25) {
        double turn = pi / 2 * t, own = 2 * pi * t;
        vec3 expected = {10 + 2 * cos(turn) + cos(own), 0, -2 * sin(turn) - sin(own)};
        assert_vec(at(&s, t)->lights[0].position, expected, 1e-14);
    }
    close_stage(&s);
}

/* From within a group, an orbit is around the place that a thing in the world has there: back
 * in the world it is where the thing is, whichever way the groups are turned and scaled. Within
 * one group nothing is turned there and back, and no bit is lost. */
static void orbit_from_within_groups(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    zt_object *objects = s.animation->rest.objects;
    objects[OUTER].placement.position = (vec3){10, -3, 7};
    objects[OUTER].placement.scale = (vec3){0.5, 4, -2};
    objects[INNER].placement.rotation = quat_axis_angle((vec3){0.6, 0, 0.8}, 1);
    objects[SUN].sphere.center = (vec3){3, 1, 4};
    zt_track *track = drive(&s, ZT_OWNER_MESH, "position", SHIP, ZT_TRACK_ORBIT);
    track->orbit = (zt_orbit){
        .around.thing = of(ZT_OWNER_SPHERE, "center", SUN), .period_s = 1, .axis = {0, 1, 0}};
    spin(&s, OUTER);
    sort(&s);
    for (double t = 0; t < 8; t += 0.37) {
        const zt_scene *scene = at(&s, t);
        assert_vec(in_world(scene, SHIP, scene->objects[SHIP].placement.position),
                   (vec3){3, 1, 4}, 1e-13);
    }
    objects[PLANET].sphere.center = (vec3){0.1, 0.2, 0.3};
    track->orbit.around.thing = of(ZT_OWNER_SPHERE, "center", PLANET);
    assert_vec(at(&s, 3.3)->objects[SHIP].placement.position, (vec3){0.1, 0.2, 0.3}, 0);
    close_stage(&s);
}

/* In a group without size nobody can be anywhere else, nor be seen: the value stays. */
static void groups_without_size(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    s.animation->rest.objects[OUTER].placement.scale = (vec3){0, 1, 1};
    s.animation->rest.objects[SHIP].placement.position = (vec3){1, 2, 3};
    drive(&s, ZT_OWNER_MESH, "position", SHIP, ZT_TRACK_ORBIT)->orbit =
        (zt_orbit){.around.thing = of(ZT_OWNER_SPHERE, "center", SUN),
                   .radius = 1,
                   .period_s = 1,
                   .axis = {0, 1, 0}};
    zt_track *look = drive(&s, ZT_OWNER_MESH, "rotation", SHIP, ZT_TRACK_LOOK_AT);
    look->look_at = (zt_look_at){.target.thing = of(ZT_OWNER_SPHERE, "center", SUN),
                                 .from = of(ZT_OWNER_MESH, "position", SHIP),
                                 .up = {0, 1, 0}};
    sort(&s);
    const zt_placement *p = &at(&s, 1)->objects[SHIP].placement;
    assert_vec(p->position, (vec3){1, 2, 3}, 0);
    assert_true(p->rotation.w == 1);
    close_stage(&s);
}

/* ---- paths ----------------------------------------------------------------------------------
 */

static zt_path *path_of(stage *s, const vec3 *points, int count, bool closed) {
    zt_path *path = ZT_PUSH(&s->animation->arena, zt_path, 1);
    assert_int_equal(zt_path_through(path, &s->animation->arena, points, count, closed), ZT_OK);
    return path;
}

/* Along a line whose points stand unevenly, the place is proportional to the time. */
static void follow_a_line(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    const vec3 points[] = {
        {0, 0, 0}, {0.1, 0.2, -0.2}, {4, 8, -8}, {4.5, 9, -9}, {10, 20, -20}};
    zt_track *track = drive(&s, ZT_OWNER_SPHERE, "center", SUN, ZT_TRACK_FOLLOW);
    track->follow = (zt_follow){.path = path_of(&s, points, 5, false), .from_s = 1, .to_s = 3};
    sort(&s);
    for (double t = 0; t <= 4; t += 0.015625) {
        double u = fmin(fmax((t - 1) / 2, 0), 1);
        assert_vec(at(&s, t)->objects[SUN].sphere.center, (vec3){10 * u, 20 * u, -20 * u},
                   20 * 1e-12);
    }
    zt_ease ease = {.kind = ZT_EASE_QUAD, .way = ZT_EASE_IN};
    track->follow.ease = &ease;
    assert_vec(at(&s, 2)->objects[SUN].sphere.center, (vec3){2.5, 5, -5}, 20 * 1e-12);
    close_stage(&s);
}

/* Round bends and narrow ones, the speed is the path's length in its time to 1e-9: measured
 * over a short time, in which the chord is shorter than the arc by no more than that. */
static void follow_at_constant_speed(void **state) {
    (void)state;
    const vec3 points[] = {{0, 0, 0},  {3, 0, 1},  {4, 2, 0},  {4, 2.2, 0.1},
                           {-2, 3, 5}, {-2, 3, 6}, {-2, 0, 6}, {1, 1, 1}};
    for (int closed = 0; closed < 2; closed++) {
        stage s;
        open_stage(&s);
        zt_track *track = drive(&s, ZT_OWNER_SPHERE, "center", SUN, ZT_TRACK_FOLLOW);
        zt_path *path = path_of(&s, points, 8, closed);
        track->follow = (zt_follow){.path = path, .from_s = 0, .to_s = 10};
        sort(&s);
        const double h = 2e-6;
        double speed = path->length / 10;
        for (double t = 0.01; t < 9.99; t += 0.0101) {
            vec3 a = at(&s, t - h)->objects[SUN].sphere.center;
            vec3 b = at(&s, t + h)->objects[SUN].sphere.center;
            double measured = vec3_length(vec3_sub(b, a)) / (2 * h);
            if (!(fabs(measured - speed) <= 1e-9 * speed))
                fail_msg("%.12g instead of %.12g at %g s", measured, speed, t);
        }
        close_stage(&s);
    }
}

/* What is oriented looks where it goes, upright on straight ways; on a path to the left it
 * leans to the left, on one to the right as far to the right. */
static void follow_and_lean(void **state) {
    (void)state;
    enum { POINTS = 60 };
    vec3 points[POINTS];
    for (int mirror = -1; mirror <= 1; mirror += 2) {
        for (int i = 0; i < POINTS; i++) /* counterclockwise from above: to the left */
            points[i] = (vec3){cos(2 * pi * i / POINTS), 0, -mirror * sin(2 * pi * i / POINTS)};
        stage s;
        open_stage(&s);
        zt_track *place = drive(&s, ZT_OWNER_MESH, "position", SHIP, ZT_TRACK_FOLLOW);
        place->follow = (zt_follow){
            .path = path_of(&s, points, POINTS, true), .from_s = 0, .to_s = 4, .up = {0, 1, 0}};
        zt_track *turn = drive(&s, ZT_OWNER_MESH, "rotation", SHIP, ZT_TRACK_FOLLOW);
        turn->follow = place->follow;
        turn->follow.bank = 0.5;
        sort(&s);
        for (double t = 0; t < 4; t += 0.1) {
            double a = pi / 2 * t, lean = 0.5;
            vec3 ahead = {-sin(a), 0, -mirror * cos(a)}, left = {-cos(a), 0, mirror * sin(a)};
            left = vec3_scale(left, mirror);
            vec3 up = vec3_add(vec3_scale((vec3){0, 1, 0}, cos(lean)),
                               vec3_scale(left, mirror * sin(lean)));
            xform m = xform_place((vec3){0, 0, 0}, at(&s, t)->objects[SHIP].placement.rotation,
                                  (vec3){1, 1, 1});
            /* The path is nearly a circle: a spline through many of its points. */
            assert_vec(vec3_scale(m.z, -1), ahead, 1e-3);
            assert_vec(m.y, up, 5e-3);
        }
        close_stage(&s);
    }
}

/* ---- offsets and looks ----------------------------------------------------------------------
 */

/* The other property's value of the same moment, and something added; rotations turn around
 * their own axes. One offset may be from another that stands further down. */
static void offsets(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    drive(&s, ZT_OWNER_POINT, "position", 0, ZT_TRACK_OFFSET)->offset =
        (zt_offset){of(ZT_OWNER_MESH, "position", SHIP), {0, 1, 0}};
    drive(&s, ZT_OWNER_MESH, "position", SHIP, ZT_TRACK_OFFSET)->offset =
        (zt_offset){of(ZT_OWNER_SPHERE, "center", SUN), {0.5, 0, 0}};
    drive(&s, ZT_OWNER_SPHERE, "center", SUN, ZT_TRACK_ORBIT)->orbit =
        (zt_orbit){.radius = 2, .period_s = 4, .axis = {0, 1, 0}};
    drive(&s, ZT_OWNER_MESH, "rotation", SHIP, ZT_TRACK_OFFSET)->offset =
        (zt_offset){of(ZT_OWNER_GROUP, "rotation", INNER), {sqrt(0.5), 0, 0, sqrt(0.5)}};
    drive(&s, ZT_OWNER_POINT, "shadows", 0, ZT_TRACK_OFFSET)->offset =
        (zt_offset){of(ZT_OWNER_POINT, "shadows", 0), {0}};
    s.animation->track_count--; /* of itself: that is for the sorting to tell */
    spin(&s, INNER);
    sort(&s);
    const zt_scene *scene = at(&s, 1);
    assert_vec(scene->objects[SUN].sphere.center, (vec3){0, 0, -2}, 0);
    assert_vec(scene->lights[0].position, (vec3){0.5, 1, -2}, 0);
    scene = at(&s, 2); /* the group has turned by a right angle, x now being -z */
    quat q = scene->objects[SHIP].placement.rotation;
    xform m = xform_place((vec3){0, 0, 0}, q, (vec3){1, 1, 1});
    assert_vec(xform_vector(&m, (vec3){1, 0, 0}), (vec3){0, 1, 0}, 1e-15);
    assert_vec(xform_vector(&m, (vec3){0, 1, 0}), (vec3){0, 0, 1}, 1e-15);
    close_stage(&s);
}

/* A ship in a turning group sees the sun, which moves in the world, straight ahead at all
 * times, and a camera has the planet, which moves in the groups, in the middle of its picture.
 */
static void looks(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    zt_object *objects = s.animation->rest.objects;
    objects[OUTER].placement.position = (vec3){3, 4, 5};
    objects[INNER].placement.scale = (vec3){2, 0.5, 1};
    objects[PLANET].sphere.center = (vec3){1, 2, 0};
    objects[SHIP].placement.position = (vec3){-1, 0.5, 2};
    s.animation->rest.camera.aimed = true;
    drive(&s, ZT_OWNER_MESH, "rotation", SHIP, ZT_TRACK_LOOK_AT)->look_at =
        (zt_look_at){.target.thing = of(ZT_OWNER_SPHERE, "center", SUN),
                     .from = of(ZT_OWNER_MESH, "position", SHIP),
                     .up = {0, 1, 0}};
    drive(&s, ZT_OWNER_CAMERA, "look_at", 0, ZT_TRACK_LOOK_AT)->look_at =
        (zt_look_at){.target.thing = of(ZT_OWNER_SPHERE, "center", PLANET)};
    drive(&s, ZT_OWNER_SPHERE, "center", SUN, ZT_TRACK_ORBIT)->orbit =
        (zt_orbit){.radius = 9, .period_s = 3, .axis = {0, 0, 1}};
    spin(&s, OUTER);
    spin(&s, INNER);
    sort(&s);
    for (double t = 0; t < 9; t += 0.31) {
        const zt_scene *scene = at(&s, t);
        const zt_placement *ship = &scene->objects[SHIP].placement;
        xform m = xform_place(ship->position, ship->rotation, (vec3){1, 1, 1});
        vec3 here = in_world(scene, SHIP, ship->position);
        vec3 ahead = in_world(scene, SHIP, xform_point(&m, (vec3){0, 0, -1}));
        assert_vec(vec3_normalize(vec3_sub(ahead, here)),
                   vec3_normalize(vec3_sub(scene->objects[SUN].sphere.center, here)), 1e-13);
        assert_true(m.y.y >= 0);
        assert_vec(scene->camera.look_at, in_world(scene, PLANET, (vec3){1, 2, 0}), 1e-13);
        vec3 middle = vec3_scale(zt_camera_xform(&scene->camera).z, -1);
        assert_vec(middle,
                   vec3_normalize(vec3_sub(scene->camera.look_at, scene->camera.position)),
                   1e-15);
    }
    close_stage(&s);
}

/* A roll turns counterclockwise seen from behind, as a camera's does; a triangle is looked at
 * in its middle; what is where one is itself leaves the rotation alone. */
static void look_rolled(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    zt_track *track = drive(&s, ZT_OWNER_MESH, "rotation", SHIP, ZT_TRACK_LOOK_AT);
    track->look_at = (zt_look_at){.target.point = {0, 0, -5},
                                  .from = of(ZT_OWNER_MESH, "position", SHIP),
                                  .up = {0, 1, 0},
                                  .roll = pi / 2};
    sort(&s);
    xform m = xform_place((vec3){0, 0, 0}, at(&s, 0)->objects[SHIP].placement.rotation,
                          (vec3){1, 1, 1});
    assert_vec(m.y, (vec3){-1, 0, 0}, 1e-15);
    track->look_at.target.point = (vec3){0, 0, 0};
    track->look_at.roll = 0;
    assert_true(at(&s, 0)->objects[SHIP].placement.rotation.w == 1);
    zt_property_rest(&s.animation->rest, ZT_OWNER_TRIANGLE, SUN);
    vec3 corners[3] = {{3, 0, 0}, {0, 6, 0}, {0, 0, -9}};
    memcpy(s.animation->rest.objects[SUN].triangle.vertices, corners, sizeof corners);
    s.animation->rest.camera.aimed = true;
    drive(&s, ZT_OWNER_CAMERA, "look_at", 0, ZT_TRACK_LOOK_AT)->look_at =
        (zt_look_at){.target.thing = {zt_place_property(ZT_OWNER_TRIANGLE), SUN}};
    sort(&s);
    assert_vec(at(&s, 0)->camera.look_at, (vec3){1, 2, -3}, 1e-15);
    assert_null(zt_place_property(ZT_OWNER_PLANE));
    assert_null(zt_place_property(ZT_OWNER_AMBIENT));
    assert_null(zt_place_property(ZT_OWNER_MATERIAL));
    close_stage(&s);
}

/* Values near the largest double stay finite, whatever is added to them. */
static void giants(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    s.animation->rest.objects[SUN].sphere.center = (vec3){DBL_MAX, -DBL_MAX, 0};
    drive(&s, ZT_OWNER_POINT, "position", 0, ZT_TRACK_OFFSET)->offset =
        (zt_offset){of(ZT_OWNER_SPHERE, "center", SUN), {DBL_MAX, -1e300, 0}};
    drive(&s, ZT_OWNER_CAMERA, "position", 0, ZT_TRACK_ORBIT)->orbit =
        (zt_orbit){.around.thing = of(ZT_OWNER_SPHERE, "center", SUN),
                   .radius = DBL_MAX,
                   .period_s = 5e-324,
                   .axis = {0, 1, 0}};
    drive(&s, ZT_OWNER_MESH, "rotation", SHIP, ZT_TRACK_LOOK_AT)->look_at =
        (zt_look_at){.target.thing = of(ZT_OWNER_SPHERE, "center", SUN),
                     .from = of(ZT_OWNER_MESH, "position", SHIP),
                     .up = {0, 1, 0}};
    s.animation->rest.objects[SHIP].placement.position = (vec3){-DBL_MAX, DBL_MAX, DBL_MAX};
    sort(&s);
    for (double t = -1e300; t <= 1e300; t += 1e299) {
        const zt_scene *scene = at(&s, t);
        assert_true(vec3_max_abs(scene->lights[0].position) <= DBL_MAX);
        assert_true(vec3_max_abs(scene->camera.position) <= DBL_MAX);
        quat q = scene->objects[SHIP].placement.rotation;
        assert_true(fabs(quat_dot(q, q) - 1) < 1e-15);
    }
    close_stage(&s);
}

/* ---- order ----------------------------------------------------------------------------------
 */

typedef struct cycles {
    int count, lengths[8], firsts[8];
} cycles;

static void note_cycle(void *user, const zt_animation *animation, const int32_t *tracks,
                       int32_t count) {
    (void)animation;
    cycles *c = user;
    assert_true(c->count < 8);
    c->lengths[c->count] = count;
    c->firsts[c->count++] = tracks[0];
}

/* The order is the tracks' own, but that each comes after what it needs. */
static void order_is_stable(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    drive(&s, ZT_OWNER_POINT, "intensity", 0, ZT_TRACK_FOLLOW);
    drive(&s, ZT_OWNER_POINT, "position", 0, ZT_TRACK_OFFSET)->offset.from =
        of(ZT_OWNER_SPHERE, "center", PLANET);
    drive(&s, ZT_OWNER_POINT, "color", 0, ZT_TRACK_FOLLOW);
    drive(&s, ZT_OWNER_SPHERE, "center", PLANET, ZT_TRACK_OFFSET)->offset.from =
        of(ZT_OWNER_SPHERE, "center", SUN);
    drive(&s, ZT_OWNER_SPHERE, "radius", PLANET, ZT_TRACK_FOLLOW);
    drive(&s, ZT_OWNER_SPHERE, "center", SUN, ZT_TRACK_FOLLOW);
    sort(&s);
    const int32_t expected[] = {0, 5, 3, 1, 2, 4};
    assert_memory_equal(s.animation->order, expected, sizeof expected);
    close_stage(&s);
}

/* Every way of waiting for oneself is found: directly, through others, through the groups that
 * a thing is in, and by looking from a place that depends on the look. */
static void every_cycle_is_told(void **state) {
    (void)state;
    stage s;
    open_stage(&s);
    const zt_reference sun = of(ZT_OWNER_SPHERE, "center", SUN),
                       planet = of(ZT_OWNER_SPHERE, "center", PLANET),
                       ship = of(ZT_OWNER_MESH, "position", SHIP);
    drive(&s, ZT_OWNER_SPHERE, "radius", SUN, ZT_TRACK_OFFSET)->offset.from =
        of(ZT_OWNER_SPHERE, "radius", SUN); /* of itself: 0 */
    drive(&s, ZT_OWNER_SPHERE, "center", SUN, ZT_TRACK_ORBIT)->orbit.around.thing = planet;
    drive(&s, ZT_OWNER_SPHERE, "center", PLANET, ZT_TRACK_ORBIT)->orbit.around.thing = ship;
    drive(&s, ZT_OWNER_MESH, "position", SHIP, ZT_TRACK_OFFSET)->offset.from =
        sun; /* 1, 2, 3 */
    zt_track *group = drive(&s, ZT_OWNER_GROUP, "position", OUTER, ZT_TRACK_ORBIT);
    group->orbit.around.thing = of(ZT_OWNER_MESH, "position", SHIP); /* within it: 4 */
    cycles c = {0};
    assert_int_equal(zt_animation_sort(s.animation, (zt_cycle_listener){note_cycle, &c}),
                     ZT_EDESCRIPTION);
    assert_null(s.animation->order);
    const cycles expected = {3, {1, 3, 1}, {0, 1, 4}};
    assert_memory_equal(&c, &expected, sizeof c);
    close_stage(&s);
    open_stage(&s);
    drive(&s, ZT_OWNER_CAMERA, "rotation", 0, ZT_TRACK_LOOK_AT)->look_at =
        (zt_look_at){.target.thing = sun, .from = of(ZT_OWNER_CAMERA, "position", 0)};
    drive(&s, ZT_OWNER_CAMERA, "position", 0, ZT_TRACK_FORMULA)->formula = (zt_formula){
        .terms = &(zt_term){.reference = of(ZT_OWNER_CAMERA, "rotation", 0)}, .term_count = 1};
    c = (cycles){0};
    assert_int_equal(zt_animation_sort(s.animation, (zt_cycle_listener){note_cycle, &c}),
                     ZT_EDESCRIPTION);
    assert_true(c.count == 1 && c.firsts[0] == 0 && c.lengths[0] == 2);
    close_stage(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orbit_in_closed_form),
        cmocka_unit_test(orbit_around_any_axis),
        cmocka_unit_test(orbit_around_things_in_groups),
        cmocka_unit_test(orbit_from_within_groups),
        cmocka_unit_test(groups_without_size),
        cmocka_unit_test(follow_a_line),
        cmocka_unit_test(follow_at_constant_speed),
        cmocka_unit_test(follow_and_lean),
        cmocka_unit_test(offsets),
        cmocka_unit_test(looks),
        cmocka_unit_test(look_rolled),
        cmocka_unit_test(giants),
        cmocka_unit_test(order_is_stable),
        cmocka_unit_test(every_cycle_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
