/* Hits: of what is flat, of one primitive, of the scene; and which of them are beyond doubt. */
#include "reference.h"

/* Whether the line of a ray may meet a ball and does so before `to`; in double precision with
 * a wide margin, since nearly all that is asked about is not met. */
static bool may_meet(vec3 around, double reach, vec3 o, vec3 d, double to) {
    vec3 f = vec3_sub(around, o);
    double dd = vec3_dot(d, d), along = vec3_dot(f, d) / dd;
    vec3 across = vec3_sub(f, vec3_scale(d, along));
    double margin = reach + 1e-12 * (vec3_length(f) + vec3_length(o));
    if (!(margin < 1e100)) return true; /* endless, or about to overflow */
    return vec3_dot(across, across) <= 1.000001 * margin * margin &&
           along >= -margin / sqrt(dd) && along - margin / sqrt(dd) <= to;
}

/* Moller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997; edges and
 * corners belong to it. */
static bool triangle_crossing(real *t, const ref_triangle *triangle, const ref_ray *ray) {
    real3 e = real3_sub(triangle->v[1], triangle->v[0]);
    real3 f = real3_sub(triangle->v[2], triangle->v[0]);
    real3 s = real3_sub(ray->o, triangle->v[0]), n = real3_cross(e, f);
    real determinant = -real3_dot(ray->d, n);
    if (determinant == 0) return false;
    real3 q = real3_cross(s, ray->d);
    real u = real3_dot(f, q) / determinant, v = -real3_dot(e, q) / determinant;
    *t = real3_dot(s, n) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1;
}

static bool triangles_first(ref_hit *hit, const ref_primitive *p, const ref_ray *ray, real from,
                            real to) {
    vec3 o = real3_round(ray->o), d = real3_round(ray->d);
    bool leaves = ray->source_object == p->object, found = false;
    for (int32_t i = 0; i < p->triangle_count; i++) {
        const ref_triangle *triangle = &p->triangles[i];
        real t;
        if (leaves && (p->shape == ZT_SHAPE_TRIANGLE || ray->source_part == i)) continue;
        if (!may_meet(triangle->around, triangle->reach, o, d, (double)to)) continue;
        if (!triangle_crossing(&t, triangle, ray) || !(t > from && t < to)) continue;
        *hit = (ref_hit){p->object, p->shape == ZT_SHAPE_MESH ? i : -1, t};
        to = t;
        found = true;
    }
    return found;
}

static bool plane_first(real *t, const ref_primitive *p, const ref_ray *ray, real from,
                        real to) {
    real along = real3_dot(p->normal, ray->d);
    if (along == 0 || ray->source_object == p->object) return false;
    *t = (p->level - real3_dot(p->normal, ray->o)) / along;
    return *t > from && *t < to;
}

bool ref_first(ref_hit *hit, const ref_primitive *p, const ref_ray *ray, real from, real to) {
    if (!p->present) return false;
    if (p->shape != ZT_SHAPE_PLANE &&
        !may_meet(p->around, p->reach, real3_round(ray->o), real3_round(ray->d), (double)to))
        return false;
    if (p->triangle_count > 0) return triangles_first(hit, p, ray, from, to);
    *hit = (ref_hit){p->object, -1, 0};
    return p->shape == ZT_SHAPE_PLANE ? plane_first(&hit->t, p, ray, from, to)
                                      : ref_solid_first(&hit->t, p, ray, from, to);
}

ref_hit ref_nearest(const ref_scene *ref, const ref_ray *ray) {
    ref_hit nearest = {-1, -1, (real)INFINITY}, hit;
    for (int32_t i = 0; i < ref->scene->object_count; i++)
        if (ref_first(&hit, &ref->primitives[i], ray, 0, nearest.t)) nearest = hit;
    return nearest;
}

/* Ways to move a ray: to six sides, forth and back; by all of the tolerance, and by
 * less and less of it: what is thinner than that may be met in between only. */
enum { MOVES = 8, SHARES = 8 };

static real3 move(int way, real3 d) {
    real3 x, y, z = real3_unit(d);
    if (way > 5) return real3_scale(z, way == 6 ? 1 : -1);
    real3_frame(&x, &y, z);
    static const double sides[6][2] = {{1, 0},  {.5, .866},   {-.5, .866},
                                       {-1, 0}, {-.5, -.866}, {.5, -.866}};
    return real3_add(real3_scale(x, sides[way][0]), real3_scale(y, sides[way][1]));
}

/* Whether anything is met by a ray that is moved to a side: by `step`, or, where that is 0, for
 * each thing by as much as its own numbers allow. */
static bool moved_blocked(const ref_scene *ref, const ref_ray *ray, real to, real tolerance,
                          int32_t only, real3 side, real step) {
    for (int32_t i = 0; i < ref->scene->object_count; i++) {
        const ref_primitive *p = &ref->primitives[i];
        ref_hit hit;
        if (!p->present || (only >= 0 && only != i)) continue;
        /* How far away matters to how exact: that of the hit, or of the object. */
        real far = ref_first(&hit, p, ray, 0, to) ? hit.t : 0;
        if (far == 0 && isfinite(p->reach))
            far = real3_length(real3_sub(real3_of(p->around), ray->o)) / real3_length(ray->d);
        ref_ray moved = *ray;
        real own = tolerance * ref_scale(p, ray, far) + p->grain;
        moved.o = real3_along(ray->o, step > 0 ? step : own, side);
        if (ref_first(&hit, p, &moved, 0, to)) return true;
    }
    return false;
}

bool ref_blocked(bool *sure, const ref_scene *ref, const ref_ray *ray, real to, real tolerance,
                 int32_t only) {
    bool blocked = moved_blocked(ref, ray, to, tolerance, only, (real3){0, 0, 0}, 0);
    real whole = tolerance * (real3_length(ray->o) + to * real3_length(ray->d));
    *sure = true;
    for (int i = 0; i < SHARES && *sure; i++)
        for (int way = 0; way < MOVES && *sure; way++) {
            real share = (real)1 / (1 << i);
            real3 side = real3_scale(move(way, ray->d), share);
            *sure = moved_blocked(ref, ray, to, tolerance, only, side, 0) == blocked;
            if (*sure && isfinite((double)to)) /* and all alike, by what the ray's allow */
                *sure = moved_blocked(ref, ray, to, tolerance, only, side, whole) == blocked;
        }
    return blocked;
}
