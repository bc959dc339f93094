/* Along surfaces, on them, between them. */
#include "cases.h"

static zt_shape any_solid(draw *d) { return (zt_shape)(1 + draw_below(d, ZT_SHAPE_MESH - 1)); }

static void make_tangent(stage *s, draw *d, double extreme) {
    (void)extreme;
    stage_object(s, d, any_solid(d), stage_within(d, 3), 1, .1);
    stage_object(s, d, any_solid(d), stage_within(d, 3), 1, .1);
    scene_point_light(&s->s, stage_within(d, 10), 9);
    stage_shoot(s, d, STAGE_TANGENT, 0, s->ray_limit);
}

/* Rays that begin on a surface, that far off it (in sizes of the object), or inside. */
static void make_origins(stage *s, draw *d, double off) {
    for (int i = 0; i < 3; i++)
        stage_object(s, d, (zt_shape)draw_below(d, ZT_SHAPE_MESH), stage_within(d, 3), 1, .1);
    scene_point_light(&s->s, stage_within(d, 10), 9);
    stage_way way = off < 0 ? STAGE_FROM_INSIDE : off > 0 ? STAGE_FROM_OFF : STAGE_FROM_ON;
    stage_shoot(s, d, way, off, s->ray_limit);
}

/* Shells around one another, each larger than the last one by that share. */
static void make_shells(stage *s, draw *d, double apart) {
    vec3 center = stage_within(d, 5);
    zt_shape shape = (zt_shape[]){ZT_SHAPE_SPHERE, ZT_SHAPE_SPHERE, ZT_SHAPE_CAPSULE,
                                  ZT_SHAPE_TORUS, ZT_SHAPE_CYLINDER}[draw_below(d, 5)];
    zt_object first = *stage_object(s, d, shape, center, 1, .2);
    for (int i = 1; i < 4; i++) {
        zt_object *shell = scene_object(&s->s, shape, 0);
        double grow = 1 + i * apart;
        *shell = first;
        if (shape == ZT_SHAPE_SPHERE) shell->sphere.radius *= grow;
        if (shape == ZT_SHAPE_TORUS) shell->torus.tube_radius *= grow;
        if (shape == ZT_SHAPE_CAPSULE || shape == ZT_SHAPE_CYLINDER) shell->tube.radius *= grow;
    }
    scene_point_light(&s->s, vec3_add(center, stage_within(d, 8)), 9);
    scene_point_light(&s->s, center, 9);
    stage_shoot(s, d, STAGE_FROM_ASIDE, draw_magnitude(d, 1.2, 20), s->ray_limit / 2);
    stage_shoot(s, d, STAGE_FROM_INSIDE, 0, s->ray_limit);
}

/* Flat things that rays run along at that angle. */
static void make_flat(stage *s, draw *d, double angle) {
    static const zt_shape shapes[] = {ZT_SHAPE_PLANE, ZT_SHAPE_PLANE, ZT_SHAPE_DISK,
                                      ZT_SHAPE_TRIANGLE};
    vec3 x = stage_direction(d), n = stage_across(d, x), y = vec3_cross(n, x);
    zt_shape shape = shapes[draw_below(d, 4)];
    zt_object *object = scene_object(&s->s, shape, 0);
    double size = shape == ZT_SHAPE_PLANE ? 1e6 : draw_magnitude(d, 1, 1e6);
    if (shape == ZT_SHAPE_PLANE) object->plane = (zt_plane){n, draw_between(d, -1, 1)};
    vec3 center = vec3_scale(n, object->plane.distance);
    if (shape == ZT_SHAPE_DISK) object->disk = (zt_disk){center = stage_within(d, 1), n, size};
    if (shape == ZT_SHAPE_TRIANGLE)
        for (int i = 0; i < 3; i++) {
            double a = 2.0944 * i, c = size * cos(a), b = size * sin(a);
            object->triangle.vertices[i] = vec3_add(vec3_scale(x, c), vec3_scale(y, b));
            center = (vec3){0, 0, 0};
        }
    scene_point_light(&s->s, vec3_add(center, vec3_scale(n, .5)), 9);
    for (int i = 0; i < s->ray_limit; i++) {
        double a = draw_between(d, 0, 6.2832), slope = angle * draw_magnitude(d, .1, 10);
        vec3 along = vec3_add(vec3_scale(x, cos(a)), vec3_scale(y, sin(a)));
        double back = size * draw_magnitude(d, 1e-3, .5), side = stage_sign(d);
        vec3 to = vec3_add(center, vec3_scale(along, size * draw_between(d, -.3, .3)));
        vec3 from = vec3_sub(to, vec3_scale(along, back));
        from = vec3_add(from, vec3_scale(n, side * back * slope));
        stage_ray(s, from, vec3_sub(along, vec3_scale(n, side * slope)));
    }
}

/* Surfaces in the same place: copies of objects, at any place in the order. */
static void make_coincident(stage *s, draw *d, double extreme) {
    (void)extreme;
    zt_object kinds[3];
    for (int i = 0; i < 3; i++)
        kinds[i] = *stage_object(s, d, (zt_shape)draw_below(d, ZT_SHAPE_MESH),
                                 stage_within(d, 2), 1, .2);
    int32_t mesh = stage_ball_mesh(s, 1, 4, 6, false);
    zt_object placed = *stage_mesh_object(s, mesh, stage_within(d, 2));
    for (int i = 0; i < 5; i++) {
        int which = draw_below(d, 4);
        *scene_object(&s->s, ZT_SHAPE_SPHERE, 0) = which == 3 ? placed : kinds[which];
    }
    scene_point_light(&s->s, stage_within(d, 10), 9);
    stage_shoot(s, d, STAGE_FROM_ASIDE, 4, s->ray_limit);
}

const extreme_case cases_close[] = {
    {"tangent", make_tangent, 0, 16, 64, 1, 0},
    {"origin inside", make_origins, -1, 12, 64, 1, 0},
    {"origin on", make_origins, 0, 12, 64, 1, 0},
    {"origin 1e-9 off", make_origins, 1e-9, 12, 64, 1, 0},
    {"shells 1e-7", make_shells, 1e-7, 6, 64, 1, CASE_DOUBLE},
    {"flat at 1e-8 rad", make_flat, 1e-8, 24, 64, 1, 0},
    {"coincident", make_coincident, 0, 12, 64, 1, CASE_STRICT},
    {0},
};
