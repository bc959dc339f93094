/* Lights become lamps: what each is at the moments of the exposure, relative to the camera of
 * the first. All is computed in double precision and rounded once, at the end. Compiled once
 * for each precision. */
#include <math.h>

#include "tracer/prepare.h"
#include "tracer/shapes.h"

static zt_lamp_pose pose_of(const zt_light *light, vec3 eye) {
    xform axes = xform_place(light->position, light->rotation, (vec3){1, 1, 1});
    bool flat = light->kind == ZT_LIGHT_RECTANGLE;
    return (zt_lamp_pose){.position = to_real3(vec3_sub(light->position, eye)),
                          .power = to_real3(vec3_scale(light->color, light->intensity)),
                          .x = to_real3(axes.x),
                          .y = to_real3(axes.y),
                          .z = to_real3(axes.z),
                          .a = (real)(flat ? light->width / 2 : light->radius),
                          .b = (real)(flat ? light->height / 2 : 0),
                          .shadows = light->shadows};
}

/* Grows the box to hold a lamp at a moment, however it is turned; but for a point, which it is
 * all of, by more than the roundings of places on it. */
static void hold(zt_box *box, const zt_light *light, vec3 eye) {
    vec3 at = vec3_sub(light->position, eye);
    double reach = zt_light_reach(light),
           largest = fmax(fabs(at.x), fmax(fabs(at.y), fabs(at.z)));
    real room =
        reach > 0 ? (real)(reach + (reach + largest) * (double)(32 * REAL_ROUNDING)) : 0;
    real3 p = to_real3(at);
    box->low = (real3){real_min(box->low.x, p.x - room), real_min(box->low.y, p.y - room),
                       real_min(box->low.z, p.z - room)};
    box->high = (real3){real_max(box->high.x, p.x + room), real_max(box->high.y, p.y + room),
                        real_max(box->high.z, p.z + room)};
}

static bool same3(vec3 a, vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

static bool same_light(const zt_light *a, const zt_light *b) {
    quat p = a->rotation, q = b->rotation;
    return same3(a->position, b->position) && same3(a->color, b->color) &&
           a->intensity == b->intensity && a->shadows == b->shadows && a->radius == b->radius &&
           a->width == b->width && a->height == b->height && p.w == q.w && p.x == q.x &&
           p.y == q.y && p.z == q.z;
}

/* Makes light number i a lamp; `poses` is room for one at each moment. */
static zt_lamp lamp_of(const zt_exposure *exposure, const zt_needs *needs, int32_t i,
                       zt_lamp_pose *poses) {
    static const zt_lamp_kind kinds[] = {[ZT_LIGHT_POINT] = ZT_LAMP_BALL,
                                         [ZT_LIGHT_DISK] = ZT_LAMP_DISK,
                                         [ZT_LIGHT_RECTANGLE] = ZT_LAMP_RECTANGLE};
    const zt_scene *moments = exposure->moments;
    const zt_light *first = &moments->lights[i];
    const vec3 eye = moments->camera.position;
    const real3 none = {REAL_INFINITY, REAL_INFINITY, REAL_INFINITY};
    zt_lamp lamp = {.kind = kinds[first->kind],
                    .light = i,
                    .shines = needs->shines[i],
                    .poses = poses,
                    .bounds = {none, {-none.x, -none.y, -none.z}}};
    for (int32_t m = 0; m < exposure->moment_count; m++) {
        const zt_light *light = &moments[m].lights[i];
        poses[m] = pose_of(light, eye);
        hold(&lamp.bounds, light, eye);
        lamp.moves |= !same_light(light, first);
        lamp.has_size |= zt_light_reach(light) > 0;
        lamp.shadows |= light->shadows;
    }
    if (lamp.kind == ZT_LAMP_BALL && !lamp.has_size) lamp.kind = ZT_LAMP_POINT;
    return lamp;
}

/* The sum of the ambient lights at each moment. */
static zt_status prepare_ambient(zt_tracer *tracer, const zt_exposure *exposure,
                                 zt_arena *arena) {
    real3 *sums = ZT_PUSH(arena, real3, (size_t)exposure->moment_count);
    if (!sums) return ZT_EMEMORY;
    vec3 first = {0, 0, 0};
    bool moves = false;
    for (int32_t m = 0; m < exposure->moment_count; m++) {
        const zt_scene *scene = &exposure->moments[m];
        vec3 sum = {0, 0, 0};
        for (int32_t i = 0; i < scene->light_count; i++) {
            const zt_light *light = &scene->lights[i];
            if (light->kind == ZT_LIGHT_AMBIENT)
                sum = vec3_add(sum, vec3_scale(light->color, light->intensity));
        }
        sums[m] = to_real3(sum);
        first = m == 0 ? sum : first;
        moves |= !same3(sum, first);
    }
    tracer->ambient = sums[0];
    tracer->ambients = moves ? sums : NULL;
    return ZT_OK;
}

zt_status ZT_REAL_NAME(zt_prepare_lamps)(zt_tracer *tracer, const zt_exposure *exposure,
                                         const zt_needs *needs, zt_arena *arena) {
    const zt_scene *scene = exposure->moments;
    size_t count = (size_t)scene->light_count, moment_count = (size_t)exposure->moment_count;
    zt_lamp *lamps = ZT_PUSH(arena, zt_lamp, count);
    zt_lamp_pose *poses = ZT_PUSH(arena, zt_lamp_pose, count * moment_count);
    if (!lamps || !poses) return ZT_EMEMORY;
    for (int32_t i = 0; i < scene->light_count; i++)
        if (scene->lights[i].kind != ZT_LIGHT_AMBIENT)
            lamps[tracer->lamp_count++] =
                lamp_of(exposure, needs, i, poses + (size_t)i * moment_count);
    tracer->lamps = lamps;
    return prepare_ambient(tracer, exposure, arena);
}
