/* What groups do to their members: stretch, mirror, shear, and all but flatten. */
#include "cases.h"

static vec3 any_scale(draw *d, double most) {
    return (vec3){stage_sign(d) * draw_magnitude(d, 1 / most, most),
                  stage_sign(d) * draw_magnitude(d, 1 / most, most),
                  stage_sign(d) * draw_magnitude(d, 1 / most, most)};
}

static void fill(stage *s, draw *d, int32_t group, int count) {
    for (int i = 0; i < count; i++) {
        zt_shape shape = (zt_shape)draw_below(d, ZT_SHAPE_MESH + 1);
        if (shape == ZT_SHAPE_MESH)
            stage_mesh_object(s, 0, stage_within(d, 1))->parent = group;
        else
            stage_object(s, d, shape, stage_within(d, 1), draw_between(d, .2, 1), .2)->parent =
                group;
    }
    scene_point_light(&s->s, stage_within(d, 10), 9);
    stage_shoot(s, d, STAGE_FROM_ASIDE, draw_magnitude(d, 1.5, 10), s->ray_limit / 2);
    stage_shoot(s, d, STAGE_FROM_INSIDE, 0, s->ray_limit);
}

/* Alike in all directions, by any factor up to that. */
static void make_scaled(stage *s, draw *d, double most) {
    double scale = stage_sign(d) * draw_magnitude(d, 1 / most, most);
    stage_ball_mesh(s, 1, 4, 6, false);
    fill(s, d,
         stage_group(s, -1, stage_within(d, 3), draw_rotation(d), (vec3){scale, scale, scale}),
         3);
}

/* Along three axes by different factors, mirrored or not. */
static void make_stretched(stage *s, draw *d, double most) {
    stage_ball_mesh(s, 1, 4, 6, false);
    fill(s, d, stage_group(s, -1, stage_within(d, 3), draw_rotation(d), any_scale(d, most)), 3);
}

/* Groups in groups, turned and stretched by turns: what comes of it is sheared. */
static void make_sheared(stage *s, draw *d, double most) {
    int32_t group = -1;
    stage_ball_mesh(s, 1, 4, 6, false);
    for (int i = 0; i < 3; i++)
        group = stage_group(s, group, stage_within(d, 2), draw_rotation(d),
                            any_scale(d, cbrt(most)));
    fill(s, d, group, 3);
}

/* Planes alone, which reach far beyond where groups in groups leave their numbers small. */
static void make_askew_planes(stage *s, draw *d, double most) {
    int32_t group = -1;
    for (int i = 0; i < 2; i++)
        group = stage_group(s, group, stage_within(d, 2), draw_rotation(d), any_scale(d, most));
    for (int i = 0; i < 3; i++)
        stage_object(s, d, ZT_SHAPE_PLANE, stage_within(d, 1), 1, .2)->parent = group;
    stage_shoot(s, d, STAGE_FROM_ASIDE, draw_magnitude(d, 1.5, 10), s->ray_limit / 2);
    stage_shoot(s, d, STAGE_FROM_EYE, 0, s->ray_limit);
}

/* Flattened along one axis to that share, which a further group turns askew. */
static void make_singular(stage *s, draw *d, double share) {
    stage_ball_mesh(s, 1, 4, 6, false);
    int32_t outer =
        stage_group(s, -1, stage_within(d, 3), draw_rotation(d), (vec3){1, share, 1});
    fill(s, d, stage_group(s, outer, (vec3){0, 0, 0}, draw_rotation(d), (vec3){1, .5, 2}), 3);
}

const extreme_case cases_transforms[] = {
    {"scaled 1e6", make_scaled, 1e6, 16, 64, 1, 0},
    {"stretched 1e2", make_stretched, 1e2, 16, 64, 1, 0},
    {"stretched 1e4", make_stretched, 1e4, 16, 64, 1, 0},
    {"stretched 1e6", make_stretched, 1e6, 16, 64, 1, 0},
    {"sheared 1e2", make_sheared, 1e2, 16, 64, 1, 0},
    {"sheared 1e4", make_sheared, 1e4, 16, 64, 1, 0},
    {"sheared 1e6", make_sheared, 1e6, 16, 64, 1, 0},
    {"planes 1e6", make_askew_planes, 1e3, 16, 64, 1, 0},
    {"flattened 1e-3", make_singular, 1e-3, 12, 64, 1, 0},
    {"flattened 1e-6", make_singular, 1e-6, 12, 64, 1, 0},
    {"flattened 1e-12", make_singular, 1e-12, 12, 64, 1, 0},
    {0},
};
