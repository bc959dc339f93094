/* Triangles: thin, flat, tiny, huge, and closed where they share edges and corners. */
#include "cases.h"

static vec3 mix(vec3 a, vec3 b, double t) {
    return vec3_add(vec3_scale(a, 1 - t), vec3_scale(b, t));
}

/* Needles: a long side, and a third corner off it by that share of its length. */
static void make_slivers(stage *s, draw *d, double aspect) {
    for (int i = 0; i < 4; i++) {
        vec3 a = stage_within(d, 3), way = stage_direction(d);
        vec3 b = vec3_add(a, vec3_scale(way, draw_magnitude(d, .1, 10)));
        double height = vec3_length(vec3_sub(b, a)) / aspect;
        vec3 c = vec3_add(mix(a, b, draw_unit(d)), vec3_scale(stage_across(d, way), height));
        scene_triangle(&s->s, a, b, c, 0);
        for (int k = 0; k < s->ray_limit / 4; k++) {
            double u = sqrt(draw_unit(d)), v = draw_unit(d);
            vec3 to = vec3_add(vec3_scale(a, 1 - u), vec3_scale(mix(b, c, v), u));
            stage_aim(s, vec3_add(to, stage_within(d, 5)), to);
        }
    }
    scene_point_light(&s->s, stage_within(d, 10), 9);
}

/* Nothing to hit: corners in a line or on one another; an honest triangle behind. */
static void make_flat(stage *s, draw *d, double extreme) {
    (void)extreme;
    vec3 a = stage_within(d, 1), b = vec3_add(a, (vec3){.25, .5, 1});
    scene_triangle(&s->s, a, b, mix(a, b, .5), 0);
    scene_triangle(&s->s, a, a, b, 0);
    scene_triangle(&s->s, a, a, a, 0);
    scene_triangle(&s->s, a, b, b, 0);
    scene_triangle(&s->s, (vec3){-9, -9, -3}, (vec3){9, -9, -3}, (vec3){0, 9, -3}, 0);
    uint32_t corners[] = {0, 1, 2, 0, 0, 1, 3, 4, 5};
    vec3 at[] = {a, b, mix(a, b, .5), {-9, -9, -4}, {9, -9, -4}, {0, 9, -4}};
    stage_mesh_object(s, stage_mesh(s, at, 6, corners, 3), (vec3){0, 0, 0});
    scene_point_light(&s->s, (vec3){1, 2, 3}, 9);
    for (int i = 0; i < s->ray_limit; i++)
        stage_aim(s, vec3_add(a, (vec3){draw_unit(d), draw_unit(d), 4}),
                  mix(a, b, draw_unit(d)));
}

/* Edges of that length; all else to scale, so that nothing but the magnitude is unusual. */
static void make_scaled(stage *s, draw *d, double size) {
    for (int i = 0; i < 4; i++) {
        vec3 v[3], at = stage_within(d, 4 * size);
        for (int k = 0; k < 3; k++) v[k] = vec3_add(at, stage_within(d, size));
        scene_triangle(&s->s, v[0], v[1], v[2], 0);
    }
    scene_point_light(&s->s, stage_within(d, 10 * size), size * size);
    stage_shoot(s, d, STAGE_FROM_ASIDE, draw_between(d, 2, 6), s->ray_limit);
}

/* Two triangles with an edge in common, as objects; rays at that edge, which must hit one. */
static void make_edge(stage *s, draw *d, double extreme) {
    (void)extreme;
    vec3 a = stage_within(d, 3), b = stage_within(d, 3), way = vec3_normalize(vec3_sub(b, a));
    vec3 x = stage_across(d, way), y = vec3_cross(way, x);
    double bend = draw_between(d, -1, 1); /* rays come from the side where both are seen */
    scene_triangle(&s->s, a, b, vec3_add(a, vec3_add(x, vec3_scale(y, bend))), 0);
    scene_triangle(&s->s, b, a, vec3_add(b, vec3_add(vec3_scale(x, -1), vec3_scale(y, bend))),
                   0);
    scene_point_light(&s->s, stage_within(d, 10), 9);
    for (int i = 0; i < s->ray_limit; i++) {
        vec3 to = mix(a, b, draw_between(d, .01, .99));
        vec3 from = vec3_add(vec3_scale(y, stage_sign(d) * draw_between(d, 1, 5)),
                             vec3_scale(way, draw_between(d, -1, 1)));
        stage_aim(s, vec3_add(to, vec3_add(from, vec3_scale(x, draw_between(d, -.3, .3)))), to);
    }
}

/* A closed fan: a cone of `count` triangles around its top; rays at the top and the spokes. */
static void make_fan(stage *s, draw *d, double count) {
    int n = (int)count;
    vec3 *at = zt_arena_push(&s->arena, sizeof *at * (size_t)(n + 2));
    uint32_t *corners = zt_arena_push(&s->arena, sizeof *corners * 6 * (size_t)n);
    if (!at || !corners) return;
    at[n] = (vec3){0, .5, 0};
    at[n + 1] = (vec3){0, -.5, 0};
    for (int i = 0; i < n; i++) {
        double a = 2 * 3.14159265358979323846 * i / n;
        uint32_t here = (uint32_t)i, next = (uint32_t)((i + 1) % n);
        uint32_t pair[6] = {here, (uint32_t)n, next, next, (uint32_t)n + 1, here};
        at[i] = (vec3){cos(a), 0, sin(a)};
        for (int k = 0; k < 6; k++) corners[6 * i + k] = pair[k];
    }
    vec3 place = stage_within(d, 3);
    zt_object *fan = stage_mesh_object(s, stage_mesh(s, at, n + 2, corners, 2 * n), place);
    scene_point_light(&s->s, vec3_add(place, stage_within(d, 10)), 9);
    (void)fan;
    for (int i = 0; i < s->ray_limit; i++) {
        vec3 top = at[n], rim = at[draw_below(d, n)];
        vec3 to = i % 2 ? top : mix(top, rim, draw_magnitude(d, 1e-9, 1));
        vec3 from = {draw_between(d, -1, 1), draw_between(d, 2, 4), draw_between(d, -1, 1)};
        stage_aim(s, vec3_add(place, from), vec3_add(place, to));
    }
}

/* A closed ball, placed anyhow; rays at its corners and edges from without and within. */
static void make_closed(stage *s, draw *d, double stretch) {
    int32_t number = stage_ball_mesh(s, 1, 3 + draw_below(d, 6), 3 + draw_below(d, 6), false);
    zt_object *ball = stage_mesh_object(s, number, stage_within(d, 3));
    zt_placement *p = &ball->placement;
    p->rotation = draw_rotation(d);
    p->scale = (vec3){stage_sign(d) * draw_magnitude(d, 1 / stretch, stretch),
                      draw_magnitude(d, 1 / stretch, stretch),
                      draw_magnitude(d, 1 / stretch, stretch)};
    xform place = xform_place(p->position, p->rotation, p->scale);
    const zt_mesh *mesh = &s->meshes[number];
    double reach = vec3_max_abs(p->scale);
    scene_point_light(&s->s, vec3_add(p->position, stage_within(d, 8 * reach)), 9);
    for (int i = 0; i < s->ray_limit; i++) {
        int32_t triangle = draw_below(d, mesh->triangle_count);
        vec3 a = zt_mesh_corner(mesh, triangle, i % 3);
        vec3 b = zt_mesh_corner(mesh, triangle, (i + 1) % 3);
        vec3 to = xform_point(&place, i % 4 ? mix(a, b, draw_unit(d)) : a);
        vec3 from = i % 2 ? xform_point(&place, stage_within(d, .3))
                          : vec3_add(p->position, vec3_scale(stage_direction(d), 5 * reach));
        stage_aim(s, from, to);
    }
}

const extreme_case cases_triangles[] = {
    {"slivers 1e8", make_slivers, 1e8, 12, 64, 1, 0},
    {"slivers 1e4", make_slivers, 1e4, 12, 64, 1, 0},
    {"zero area", make_flat, 0, 4, 64, 1, 0},
    {"edges of 1e-20", make_scaled, 1e-20, 8, 64, 1, 0},
    {"edges of 1e20", make_scaled, 1e20, 8, 64, 1, 0},
    {"shared edge", make_edge, 0, 16, 64, 1, 0},
    {"fan of 1000", make_fan, 1000, 1, 128, 1, CASE_CLOSED},
    {"closed mesh", make_closed, 1, 16, 64, 2, CASE_CLOSED},
    {"closed, stretched", make_closed, 1e3, 16, 64, 2, CASE_CLOSED},
    {0},
};
