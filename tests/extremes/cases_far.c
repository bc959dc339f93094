/* Far away, huge and tiny. */
#include "cases.h"

static zt_shape any_shape(draw *d) { return (zt_shape)draw_below(d, ZT_SHAPE_MESH); }

/* A room of all shapes around the camera, all of it moved, in groups or not. */
static void make_moved(stage *s, draw *d, double distance) {
    vec3 base = vec3_scale(stage_direction(d), distance);
    bool grouped = draw_below(d, 2);
    s->s.scene.camera.position = base;
    int32_t group = -1;
    vec3 middle = base;
    if (grouped) {
        int32_t outer = stage_group(s, -1, base, draw_rotation(d), (vec3){2, 2, 2});
        group = stage_group(s, outer, stage_within(d, 1), draw_rotation(d), (vec3){1, .7, 1});
        middle = (vec3){0, 0, 0};
    }
    for (int i = 0; i < 8; i++) {
        zt_shape shape = any_shape(d);
        vec3 at = vec3_add(middle, vec3_scale(stage_direction(d), draw_between(d, 2, 8)));
        stage_object(s, d, shape, at, draw_between(d, .2, 1), .1)->parent = group;
    }
    for (int i = 0; i < 2; i++)
        scene_point_light(&s->s, vec3_add(base, stage_within(d, 10)), 9);
    stage_shoot(s, d, STAGE_FROM_EYE, 0, s->ray_limit / 2);
    stage_shoot(s, d, STAGE_FROM_ASIDE, 3, s->ray_limit);
}

/* Objects of about one unit as far away as asked for, through a narrow fov. */
static void make_orbit(stage *s, draw *d, double distance) {
    vec3 at = vec3_scale(stage_direction(d), distance);
    for (int i = 0; i < 5; i++)
        stage_object(s, d, (zt_shape)(1 + draw_below(d, ZT_SHAPE_MESH - 1)),
                     vec3_add(at, stage_within(d, 1)), draw_between(d, .1, 1), .1);
    scene_point_light(&s->s, vec3_add(at, stage_within(d, 4)), 9);
    scene_point_light(&s->s, (vec3){0, 0, 0}, 9 * distance * distance);
    s->s.scene.camera.aimed = true;
    s->s.scene.camera.look_at = at;
    s->s.scene.camera.fov = 3 / distance;
    stage_shoot(s, d, STAGE_FROM_EYE, 0, s->ray_limit);
}

/* A ball to stand on, the eye one unit above it. */
static void make_ground(stage *s, draw *d, double radius) {
    scene_sphere(&s->s, (vec3){0, -radius - 1, 0}, radius, 0);
    scene_point_light(&s->s, (vec3){3, 5, 1}, 9);
    scene_point_light(&s->s, (vec3){0, radius, 0}, radius * radius);
    stage_object(s, d, ZT_SHAPE_BOX, (vec3){1, -.5, -3}, .5, .5);
    double horizon = -sqrt(2 / radius); /* how steep the way to it is */
    for (int i = 0; i < s->ray_limit; i++) {
        double steep = horizon * (i % 2 ? 1 + stage_sign(d) * draw_magnitude(d, 1e-12, 1)
                                        : draw_magnitude(d, 1, -1 / horizon));
        vec3 level = stage_across(d, (vec3){0, 1, 0});
        stage_ray(s, (vec3){0, 0, 0}, (vec3){level.x, steep, level.z});
    }
}

/* A ball of 1e-6 seen from 1e-4, alone or in front of a ground of the given radius. */
static void make_tiny(stage *s, draw *d, double radius) {
    vec3 at = vec3_scale(stage_direction(d), 1e-4);
    scene_sphere(&s->s, at, 1e-6, 0);
    if (radius > 0) scene_sphere(&s->s, (vec3){0, -radius - 1, 0}, radius, 0);
    scene_point_light(&s->s, (vec3){3, 5, 1}, 9);
    scene_point_light(&s->s, (vec3){0, 0, 0}, 1e-8);
    for (int i = 0; i < s->ray_limit; i++)
        stage_aim(s, (vec3){0, 0, 0}, vec3_add(at, stage_within(d, i % 2 ? 1e-6 : 1e-5)));
}

/* Coins, brims, plates and panes: as thin as that against their width, seen from a thousand. */
static void make_flat(stage *s, draw *d, double thin) {
    vec3 at = vec3_scale(stage_direction(d), 1e3), axis = vec3_scale(stage_direction(d), thin);
    const zt_shape shapes[] = {ZT_SHAPE_CYLINDER, ZT_SHAPE_CONE, ZT_SHAPE_BOX};
    zt_object *o = scene_object(&s->s, shapes[draw_below(d, 3)], 0);
    if (o->shape == ZT_SHAPE_BOX)
        o->box = (zt_block){at, {1, thin, 1}, draw_rotation(d)};
    else
        o->tube = (zt_tube){at, vec3_add(at, axis), draw_between(d, 0.5, 1), draw_below(d, 2)};
    scene_point_light(&s->s, vec3_add(at, vec3_scale(stage_direction(d), 5)), 9);
    stage_shoot(s, d, STAGE_FROM_EYE, 0, s->ray_limit / 2);
    stage_shoot(s, d, STAGE_FROM_ASIDE, 1e3, s->ray_limit / 2);
}

const extreme_case cases_far[] = {
    {"moved 1e7", make_moved, 1e7, 12, 64, 1, 0},
    {"moved 1e9", make_moved, 1e9, 12, 64, 1, 0},
    {"moved 1e12", make_moved, 1e12, 12, 64, 1, 0},
    {"orbit 1e6", make_orbit, 1e6, 12, 64, 1, CASE_DOUBLE},
    {"ground 1e9", make_ground, 1e9, 4, 256, 1, CASE_DOUBLE},
    {"tiny 1e-6", make_tiny, 0, 8, 64, 1, 0},
    {"tiny and ground", make_tiny, 1e9, 8, 64, 1, CASE_DOUBLE},
    {"flat 1e-2, far", make_flat, 1e-2, 24, 64, 1, 0},
    {"flat 1e-4, far", make_flat, 1e-4, 24, 64, 1, 0},
    {"flat 1e-6, far", make_flat, 1e-6, 24, 64, 1, 0},
    {0},
};
