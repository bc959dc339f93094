/* Aims rays at what stands on a stage, by asking the reference where its surfaces are. */
#include "reference.h"
#include "stage.h"

static bool is_endless(const ref_primitive *p) { return !isfinite(p->reach); }

/* A point in or about an object: of one that is stretched, as likely anywhere along it. */
static vec3 find_point(const ref_primitive *p, draw *d, double reach) {
    if (p->triangle_count > 0) {
        const ref_triangle *t = &p->triangles[draw_below(d, p->triangle_count)];
        real u = sqrt(draw_unit(d)) * reach, v = draw_unit(d) * reach;
        real3 e = real3_sub(t->v[1], t->v[0]), f = real3_sub(t->v[2], t->v[1]);
        return real3_round(real3_along(real3_along(t->v[0], u, e), u * v, f));
    }
    if (is_endless(p))
        return vec3_add(real3_round(real3_scale(p->normal, p->level)), stage_within(d, 10));
    real3 own = real3_of(stage_within(d, reach * (double)p->round));
    return real3_round(affine_point(&p->place, real3_add(p->middle, own)));
}

/* A point off an object by that many times its size, seen in the world or in its own space. */
static vec3 find_aside(const ref_primitive *p, draw *d, double distance) {
    vec3 way = stage_direction(d);
    if (is_endless(p) || p->triangle_count > 0 || draw_below(d, 2))
        return vec3_add(find_point(p, d, 1),
                        vec3_scale(way, distance * (is_endless(p) ? 10 : p->reach)));
    real3 own = real3_along(p->middle, distance * p->round, real3_of(way));
    return real3_round(affine_point(&p->place, own));
}

/* A point of an object's surface, by a ray from without or within. */
static bool find_surface(real3 *point, real3 *normal, const ref_primitive *p, draw *d) {
    for (int attempt = 0; attempt < 20; attempt++) {
        vec3 from = find_aside(p, d, 2), to = find_point(p, d, 0.9);
        ref_ray ray = {real3_of(from), real3_of(vec3_normalize(vec3_sub(to, from))), -1, -1};
        ref_hit hit;
        if (!ref_first(&hit, p, &ray, 0, (real)INFINITY)) continue;
        *point = real3_along(ray.o, hit.t, ray.d);
        *normal = ref_nearest_face(p, hit.part, *point).normal;
        return true;
    }
    return false;
}

static void shoot(stage *s, draw *d, const ref_primitive *p, stage_way way, double distance) {
    vec3 eye = s->s.scene.camera.position; /* stage_ray wants the scene's space */
    double reach = is_endless(p) ? 10 : p->reach;
    vec3 from = {0, 0, 0}, to = find_point(p, d, 1.05);
    real3 point, normal;
    if (way == STAGE_FROM_ASIDE) from = find_aside(p, d, distance);
    if (way == STAGE_FROM_INSIDE) from = find_point(p, d, 1);
    if (way == STAGE_FROM_INSIDE && draw_below(d, 2)) to = vec3_add(from, stage_direction(d));
    if (way == STAGE_TANGENT || way == STAGE_FROM_ON || way == STAGE_FROM_OFF) {
        if (!find_surface(&point, &normal, p, d)) return;
        vec3 n = real3_round(normal), along = stage_across(d, n);
        double lift = 0;
        if (way == STAGE_TANGENT) lift = stage_sign(d) * draw_magnitude(d, 1e-17, 1e-2);
        if (way == STAGE_FROM_OFF) lift = stage_sign(d) * distance;
        from = vec3_add(real3_round(point), vec3_scale(n, lift * reach));
        if (draw_below(d, 2)) to = vec3_add(from, stage_direction(d));
        if (way == STAGE_TANGENT) {
            double back = draw_magnitude(d, 0.1, 100) * reach;
            from = vec3_sub(from, vec3_scale(along, back));
            to = vec3_add(from, along);
        }
    }
    int count = s->ray_count;
    stage_ray(s, vec3_add(eye, from), vec3_sub(to, from));
    if (s->ray_count > count) s->origins[count] = from; /* as it is, not by way of the eye */
}

/* Any object that there is something to hit of; NULL where there is none. */
static const ref_primitive *any_primitive(const ref_scene *ref, draw *d) {
    int32_t count = ref->scene->object_count, first = draw_below(d, count);
    for (int32_t i = 0; i < count; i++) {
        const ref_primitive *p = &ref->primitives[(first + i) % count];
        if (p->present) return p;
    }
    return NULL;
}

void stage_shoot(stage *s, draw *d, stage_way way, double distance, int count) {
    zt_arena arena = {0};
    ref_scene ref;
    if (s->s.scene.object_count > 0 && ref_prepare(&ref, &s->s.scene, &arena))
        for (int i = 0; i < count; i++) {
            const ref_primitive *p = any_primitive(&ref, d);
            if (p) shoot(s, d, p, way, distance);
        }
    zt_arena_free(&arena);
}
