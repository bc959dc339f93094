/* Aims rays at what stands on a stage, by asking the reference where its surfaces are. */
#include "reference.h"
#include "stage.h"

/* A point of an object's surface, by a ray from without or within. */
static bool find_surface(real3 *point, real3 *normal, const ref_primitive *p, draw *d) {
    for (int attempt = 0; attempt < 20; attempt++) {
        bool endless = !isfinite(p->reach);
        vec3 around = endless ? real3_round(real3_scale(p->normal, p->level)) : p->around;
        double reach = endless ? 10 : p->reach;
        vec3 from = vec3_add(around, vec3_scale(stage_direction(d), 2 * reach));
        vec3 to = vec3_add(around, stage_within(d, 0.9 * reach));
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
    double reach = isfinite(p->reach) ? p->reach : 10;
    vec3 around = p->around, from = {0, 0, 0}, to;
    if (!isfinite(p->reach)) around = real3_round(real3_scale(p->normal, p->level));
    to = vec3_add(around, stage_within(d, 1.05 * reach));
    real3 point, normal;
    vec3 n, q, along;
    if (way == STAGE_FROM_ASIDE)
        from = vec3_add(around, vec3_scale(stage_direction(d), distance * reach));
    if (way == STAGE_FROM_INSIDE) from = vec3_add(around, stage_within(d, reach));
    if (way == STAGE_FROM_INSIDE || way == STAGE_FROM_ON || way == STAGE_FROM_OFF)
        to = vec3_add(from, stage_direction(d));
    if (way == STAGE_TANGENT || way == STAGE_FROM_ON || way == STAGE_FROM_OFF) {
        if (!find_surface(&point, &normal, p, d)) return;
        n = real3_round(normal), q = real3_round(point), along = stage_across(d, n);
        double lift = 0;
        if (way == STAGE_TANGENT) lift = stage_sign(d) * draw_magnitude(d, 1e-17, 1e-2);
        if (way == STAGE_FROM_OFF) lift = stage_sign(d) * distance;
        from = vec3_add(q, vec3_scale(n, lift * reach));
        to = vec3_add(from, stage_direction(d));
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
