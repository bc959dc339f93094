/* Each shape alone, seen from a few of its sizes: how exact and how fast a kernel is where
 * nothing is extreme. */
#include "cases.h"

static void light(stage *s, draw *d, vec3 around, double distance) {
    for (int i = 0; i < 2; i++)
        scene_point_light(&s->s, vec3_add(around, vec3_scale(stage_direction(d), distance)), 9);
}

static void make_shape(stage *s, draw *d, double shape) {
    vec3 center = vec3_scale(stage_direction(d), draw_between(d, 3, 10));
    stage_object(s, d, (zt_shape)shape, center, 1, 0.05);
    light(s, d, center, 5);
    stage_shoot(s, d, STAGE_FROM_EYE, 0, s->ray_limit);
}

static void make_ellipsoid(stage *s, draw *d, double extreme) {
    (void)extreme;
    vec3 center = vec3_scale(stage_direction(d), draw_between(d, 3, 10));
    vec3 scale = {draw_between(d, .1, 1), draw_between(d, .1, 1), draw_between(d, .1, 1)};
    int32_t group = stage_group(s, -1, center, draw_rotation(d), scale);
    stage_object(s, d, ZT_SHAPE_SPHERE, (vec3){0, 0, 0}, 1, 1)->parent = group;
    light(s, d, center, 5);
    stage_shoot(s, d, STAGE_FROM_EYE, 0, s->ray_limit);
}

static void make_mesh(stage *s, draw *d, double extreme) {
    (void)extreme;
    vec3 center = vec3_scale(stage_direction(d), draw_between(d, 3, 10));
    stage_mesh_object(s, stage_ball_mesh(s, 1, 12, 18, false), center)->placement.rotation =
        draw_rotation(d);
    light(s, d, center, 5);
    stage_shoot(s, d, STAGE_FROM_EYE, 0, s->ray_limit);
}

const extreme_case cases_plain[] = {
    {"plane", make_shape, ZT_SHAPE_PLANE, 4, 256, 1, 0},
    {"sphere", make_shape, ZT_SHAPE_SPHERE, 4, 256, 1, 0},
    {"ellipsoid", make_ellipsoid, 0, 4, 256, 1, 0},
    {"triangle", make_shape, ZT_SHAPE_TRIANGLE, 4, 256, 1, 0},
    {"disk", make_shape, ZT_SHAPE_DISK, 4, 256, 1, 0},
    {"box", make_shape, ZT_SHAPE_BOX, 4, 256, 1, 0},
    {"cylinder", make_shape, ZT_SHAPE_CYLINDER, 4, 256, 1, 0},
    {"cone", make_shape, ZT_SHAPE_CONE, 4, 256, 1, 0},
    {"torus", make_shape, ZT_SHAPE_TORUS, 4, 256, 2, 0},
    {"capsule", make_shape, ZT_SHAPE_CAPSULE, 4, 256, 1, 0},
    {"mesh", make_mesh, 0, 3, 256, 1, CASE_CLOSED},
    {0},
};
