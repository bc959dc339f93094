/* Light and mirrors. */
#include "cases.h"

/* A few objects, and lights as far from their surfaces as asked for: near, far, on (0), or
 * inside of the balls around them (below 0). */
static void make_lights(stage *s, draw *d, double distance) {
    for (int i = 0; i < 4; i++)
        stage_object(s, d, (zt_shape)draw_below(d, ZT_SHAPE_MESH), stage_within(d, 4),
                     draw_between(d, .3, 1), .2);
    stage_mesh_object(s, stage_ball_mesh(s, 1, 4, 6, false), stage_within(d, 4));
    /* Where rays from objects' surfaces begin, lights stand: rays are given up again. */
    if (distance < 0)
        stage_shoot(s, d, STAGE_FROM_INSIDE, 0, 4);
    else if (distance < 1)
        stage_shoot(s, d, distance > 0 ? STAGE_FROM_OFF : STAGE_FROM_ON, distance, 4);
    int count = s->ray_count;
    s->ray_count = 0;
    for (int i = 0; i < (count ? count : 4); i++)
        scene_point_light(&s->s,
                          count ? s->origins[i] : vec3_scale(stage_direction(d), distance),
                          count ? 9 : distance * distance);
    stage_shoot(s, d, STAGE_FROM_ASIDE, 4, s->ray_limit);
}

/* Two parallel mirrors, any flat things; rays go to and fro. */
static void make_mirrors(stage *s, draw *d, double extreme) {
    (void)extreme;
    static const zt_shape shapes[] = {ZT_SHAPE_PLANE, ZT_SHAPE_DISK, ZT_SHAPE_BOX,
                                      ZT_SHAPE_TRIANGLE};
    zt_shape shape = shapes[draw_below(d, 4)];
    vec3 x = stage_direction(d), n = stage_across(d, x), y = vec3_cross(n, x);
    vec3 at = stage_within(d, 10);
    for (int side = -1; side <= 1; side += 2) {
        zt_object *o = scene_object(&s->s, shape, 0);
        vec3 place = vec3_add(at, vec3_scale(n, side));
        if (shape == ZT_SHAPE_PLANE) o->plane = (zt_plane){n, vec3_dot(n, place)};
        if (shape == ZT_SHAPE_DISK) o->disk = (zt_disk){place, n, 20};
        if (shape == ZT_SHAPE_BOX)
            o->box =
                (zt_block){vec3_add(at, (vec3){0, 2 * side, 0}), {40, 2, 40}, {1, 0, 0, 0}};
        for (int i = 0; shape == ZT_SHAPE_TRIANGLE && i < 3; i++)
            o->triangle.vertices[i] =
                vec3_add(place, vec3_add(vec3_scale(x, 40 * cos(2.0944 * i)),
                                         vec3_scale(y, 40 * sin(2.0944 * i))));
    }
    if (shape == ZT_SHAPE_BOX) n = (vec3){0, 1, 0};
    s->s.scene.reflection_depth = 1000;
    scene_point_light(&s->s, at, 1);
    for (int i = 0; i < s->ray_limit; i++)
        stage_ray(s, vec3_add(at, vec3_scale(n, draw_between(d, -.9, .9))),
                  vec3_add(n, stage_within(d, .005)));
}

/* A coarse mesh with a ball's normals, from without: what is lit must look like a ball's. */
static void make_terminator(stage *s, draw *d, double extreme) {
    (void)extreme;
    int32_t ball = stage_ball_mesh(s, 1, 4 + draw_below(d, 8), 5 + draw_below(d, 12), true);
    zt_object *object = stage_mesh_object(s, ball, stage_within(d, 3));
    object->smooth = true;
    object->placement.rotation = draw_rotation(d);
    for (int i = 0; i < 4; i++)
        scene_point_light(&s->s,
                          vec3_add(object->placement.position,
                                   vec3_scale(stage_direction(d), draw_magnitude(d, 3, 1e3))),
                          9);
    stage_shoot(s, d, STAGE_FROM_ASIDE, draw_magnitude(d, 3, 30), s->ray_limit);
}

const extreme_case cases_lights[] = {
    {"lights at 1e-6", make_lights, 1e-6, 12, 64, 1, 0},
    {"lights at 1e9", make_lights, 1e9, 12, 64, 1, 0},
    {"lights on surfaces", make_lights, 0, 12, 64, 1, 0},
    {"lights inside", make_lights, -1, 12, 64, 1, 0},
    {"smooth terminator", make_terminator, 0, 8, 128, 0, 0},
    {"mirrors 1000 deep", make_mirrors, 0, 4, 2, 1000, 0},
    {0},
};
