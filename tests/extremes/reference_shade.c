/* The light along a ray in the model of src/tracer/classic.h, patterns left out. */
#include "reference.h"

static real cut(real x) { return x > 0 ? real_min(x, 1) : 0; }

/* What the point lights give a point of a surface whose normal is n, facing the eye. */
static void add_lights(real light[3], const ref_scene *ref, ref_hit hit, real3 point, real3 n,
                       const vec3 *color) {
    const real own[3] = {color->x, color->y, color->z};
    for (int32_t i = 0; i < ref->scene->light_count; i++) {
        const zt_light *l = &ref->scene->lights[i];
        const real power[3] = {(real)l->color.x * l->intensity, (real)l->color.y * l->intensity,
                               (real)l->color.z * l->intensity};
        if (l->kind == ZT_LIGHT_AMBIENT) {
            for (int k = 0; k < 3; k++) light[k] += power[k] * own[k];
            continue;
        }
        real3 way = real3_sub(ref->lights[i], point);
        real square = real3_dot(way, way), toward = real3_dot(way, n);
        ref_ray shadow = {point, way, hit.object, hit.part};
        ref_hit blocker;
        bool dark = !(toward > 0);
        for (int32_t k = 0; l->shadows && k < ref->scene->object_count && !dark; k++)
            dark = ref_first(&blocker, &ref->primitives[k], &shadow, 0, 1);
        if (dark) continue;
        real fade = toward / (square * REAL(sqrt)(square));
        for (int k = 0; k < 3; k++) light[k] += cut(power[k] * fade * own[k]);
    }
}

void ref_trace(real light[3], const ref_scene *ref, const ref_ray *ray) {
    ref_ray at = *ray;
    real weight = 1;
    light[0] = light[1] = light[2] = 0;
    for (int32_t depth = 0; depth <= ref->scene->reflection_depth && weight > 0; depth++) {
        ref_hit hit = ref_nearest(ref, &at);
        if (hit.object < 0) return;
        const ref_primitive *p = &ref->primitives[hit.object];
        const zt_material *m = &ref->scene->materials[ref->scene->objects[hit.object].material];
        real3 point = real3_along(at.o, hit.t, at.d), d = real3_unit(at.d);
        real3 n = ref_nearest_face(p, hit.part, point).normal;
        if (real3_dot(n, d) > 0) n = real3_scale(n, -1);
        real here[3] = {0, 0, 0};
        add_lights(here, ref, hit, point, n, &m->color);
        for (int k = 0; k < 3; k++) light[k] += weight * here[k];
        weight *= m->reflectivity;
        at = (ref_ray){point, real3_along(d, -2 * real3_dot(d, n), n), hit.object, hit.part};
    }
}
