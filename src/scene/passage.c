#include "scene/passage.h"

zt_status zt_passage_prepare(zt_passage *passage, const zt_scene *now, const zt_scene *next,
                             vec3 origin, zt_arena *arena) {
    int32_t count = now->object_count;
    xform *back = ZT_PUSH(arena, xform, (size_t)count + 1),
          *forth = ZT_PUSH(arena, xform, (size_t)count + 1);
    bool *stays = ZT_PUSH(arena, bool, (size_t)count + 1);
    if (!back || !forth || !stays) return ZT_EMEMORY;
    zt_scene_worlds(back, now, origin);
    zt_scene_worlds(forth, next, origin);
    for (int32_t i = 0; i < count; i++) {
        stays[i] = zt_object_stays(&now->objects[i], &next->objects[i]) &&
                   xform_equal(&back[i], &forth[i]);
        back[i] = xform_inverse(&back[i]);
    }
    *passage = (zt_passage){now, next, origin, back, forth, stays};
    return ZT_OK;
}

/* What is round: a way along an axis, none of spheres. */
typedef struct round_thing {
    vec3 from, axis; /* unit, or zero */
    double length;
    double radius, end_radius; /* around the way at its two ends; of a torus: of its circle */
    double tube;               /* of a torus */
} round_thing;

static round_thing round_of(const zt_object *o) {
    vec3 along;
    switch (o->shape) {
    case ZT_SHAPE_PLANE: {
        vec3 n = vec3_normalize(o->plane.normal);
        return (round_thing){.from = vec3_scale(n, o->plane.distance), .axis = n};
    }
    case ZT_SHAPE_SPHERE:
        return (round_thing){.from = o->sphere.center, .radius = o->sphere.radius};
    case ZT_SHAPE_DISK:
        return (round_thing){.from = o->disk.center,
                             .axis = vec3_normalize(o->disk.normal),
                             .radius = o->disk.radius};
    case ZT_SHAPE_TORUS:
        return (round_thing){.from = o->torus.center,
                             .axis = vec3_normalize(o->torus.axis),
                             .radius = o->torus.radius,
                             .tube = fmin(o->torus.tube_radius, o->torus.radius)};
    default: /* a cylinder, cone or capsule */
        along = vec3_sub(o->tube.to, o->tube.from);
        return (round_thing){.from = o->tube.from,
                             .axis = vec3_normalize(along),
                             .length = vec3_length(along),
                             .radius = o->tube.radius,
                             .end_radius = o->shape == ZT_SHAPE_CONE ? o->tube.end_radius
                                                                     : o->tube.radius};
    }
}

/* How many times larger; what has no size stays as it is. */
static double times(double next, double now) { return now > 0 ? next / now : 1; }

/* Turns `v` as the shortest turn does that takes one unit vector to another; those of zero turn
 * nothing. */
static vec3 turn(vec3 v, vec3 from, vec3 to) {
    vec3 axis = vec3_cross(from, to);
    double c = vec3_dot(from, to);
    if (c == 0 && vec3_max_abs(axis) == 0) return v;
    if (1 + c < 1e-12) return vec3_scale(v, -1); /* half a turn, around whatever is across */
    return vec3_add(vec3_add(vec3_scale(v, c), vec3_cross(axis, v)),
                    vec3_scale(axis, vec3_dot(axis, v) / (1 + c)));
}

/* How far along its axis a point of something round goes, and how many times further out. */
static void stretch(double *along, double *out, zt_shape shape, const round_thing *a,
                    const round_thing *b, double radius) {
    double share = a->length > 0 ? *along / a->length : 0, wider = times(b->radius, a->radius);
    switch (shape) {
    case ZT_SHAPE_PLANE:
        break;
    case ZT_SHAPE_TORUS: {
        double tube = times(b->tube, a->tube);
        *along *= tube;
        *out = times(b->radius + (radius - a->radius) * tube, radius);
        break;
    }
    case ZT_SHAPE_CAPSULE: { /* on one of the balls at its ends, or between these */
        double beyond = *along - fmin(fmax(*along, 0), a->length);
        *along = (*along > 0) * fmin(share, 1) * b->length + beyond * wider;
        *out = wider;
        break;
    }
    case ZT_SHAPE_CONE:
        *along = share * b->length;
        *out = times(b->radius + share * (b->end_radius - b->radius),
                     a->radius + share * (a->end_radius - a->radius));
        break;
    default: /* a sphere, disk or cylinder */
        *along = share * b->length;
        *out = wider;
    }
}

static vec3 carry_round(const zt_object *now, const zt_object *next, vec3 point) {
    round_thing a = round_of(now), b = round_of(next);
    vec3 way = vec3_sub(point, a.from);
    double along = vec3_dot(way, a.axis), out = 1;
    vec3 radial = vec3_sub(way, vec3_scale(a.axis, along));
    stretch(&along, &out, now->shape, &a, &b, vec3_length(radial));
    way = vec3_add(vec3_scale(radial, out), vec3_scale(a.axis, along));
    return vec3_add(b.from, turn(way, a.axis, b.axis));
}

static vec3 carry_box(const zt_block *now, const zt_block *next, vec3 point) {
    const vec3 one = {1, 1, 1};
    xform a = xform_place(now->center, now->rotation, one),
          b = xform_place(next->center, next->rotation, one);
    xform back = xform_inverse(&a);
    vec3 p = xform_point(&back, point);
    return xform_point(&b, (vec3){p.x * times(next->size.x, now->size.x),
                                  p.y * times(next->size.y, now->size.y),
                                  p.z * times(next->size.z, now->size.z)});
}

/* By the shares that the corners have in the point. */
static vec3 carry_triangle(const zt_triangle *now, const zt_triangle *next, vec3 point) {
    const vec3 *v = now->vertices, *w = next->vertices;
    vec3 e = vec3_sub(v[1], v[0]), f = vec3_sub(v[2], v[0]), q = vec3_sub(point, v[0]),
         area = vec3_cross(e, f);
    double whole = 1 / vec3_dot(area, area);
    double second = vec3_dot(vec3_cross(q, f), area) * whole,
           third = vec3_dot(vec3_cross(e, q), area) * whole;
    return vec3_add(w[0], vec3_add(vec3_scale(vec3_sub(w[1], w[0]), second),
                                   vec3_scale(vec3_sub(w[2], w[0]), third)));
}

static vec3 carry_mesh(const zt_placement *now, const zt_placement *next, vec3 point) {
    xform a = xform_place(now->position, now->rotation, now->scale),
          b = xform_place(next->position, next->rotation, next->scale);
    xform back = xform_inverse(&a);
    return xform_point(&b, xform_point(&back, point));
}

vec3 zt_passage_carry(const zt_passage *passage, int32_t object, vec3 point) {
    if (passage->stays[object]) return point;
    const zt_object *now = &passage->now->objects[object],
                    *next = &passage->next->objects[object];
    vec3 p = xform_point(&passage->back[object], point);
    switch (now->shape) {
    case ZT_SHAPE_BOX:
        p = carry_box(&now->box, &next->box, p);
        break;
    case ZT_SHAPE_TRIANGLE:
        p = carry_triangle(&now->triangle, &next->triangle, p);
        break;
    case ZT_SHAPE_MESH:
        p = carry_mesh(&now->placement, &next->placement, p);
        break;
    default:
        p = carry_round(now, next, p);
    }
    return xform_point(&passage->forth[object], p);
}
