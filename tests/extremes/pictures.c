#include "pictures.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/hash.h"

enum { WIDTH = 16, HEIGHT = 12, PIXELS = WIDTH * HEIGHT };

const extreme_case pictures_case = {"pictures", NULL, 0, 0, 0, 0, 0};

typedef struct picture {
    stage stage;
    zt_arena arena;
    ref_scene ref;
    float pixels[4 * PIXELS], again[4 * PIXELS];
    const char *name;
    run_how how;
} picture;

/* Moves the eye to where a ray of the case begins, looking along it; lights and mirrors become
 * as strong as they may be, now and then. */
static bool make(picture *p, const extreme_case *c, int number) {
    draw d = {zt_random_key(5, (uint64_t)number), 0};
    zt_scene *scene = &p->stage.s.scene;
    stage_begin(&p->stage, c->rays);
    c->make(&p->stage, &d, c->extreme);
    if (p->stage.ray_count == 0) return false;
    int ray = draw_below(&d, p->stage.ray_count);
    zt_camera *eye = &scene->camera;
    eye->position = vec3_add(eye->position, p->stage.origins[ray]);
    /* As a direction it keeps its digits wherever the eye is. */
    vec3 back = vec3_scale(p->stage.directions[ray], -1);
    vec3 axis = vec3_cross((vec3){0, 0, 1}, back);
    eye->rotation = quat_normalize((quat){1 + back.z, axis.x, axis.y, axis.z});
    eye->aimed = false;
    eye->fov = draw_magnitude(&d, .01, 2);
    scene_ambient(&p->stage.s, (vec3){.1, .2, .3}, .5);
    scene->materials[0].reflectivity = draw_below(&d, 2) ? 1 : .25;
    scene->materials[0].color = (vec3){.9, .5, .1};
    scene->reflection_depth = draw_below(&d, 3);
    if (draw_below(&d, 4) == 0 && scene->light_count > 1) scene->lights[0].intensity = 1e30;
    zt_arena_reset(&p->arena);
    return ref_prepare(&p->ref, scene, &p->arena);
}

/* The reference's ray through the middle of a pixel, or off it by a share of the view. */
static ref_ray pixel_ray(const picture *p, int i, double off_x, double off_y) {
    xform axes = zt_camera_xform(&p->stage.s.scene.camera);
    real step = 2 * REAL(tan)((real)p->stage.s.scene.camera.fov / 2) / HEIGHT;
    real x = (i % WIDTH + (real)0.5 - WIDTH / 2) * step;
    real y = (i / WIDTH + (real)0.5 - HEIGHT / 2) * step;
    real3 d = real3_along(real3_scale(real3_of(axes.z), -1), x + off_x, real3_of(axes.x));
    d = real3_along(d, -y + off_y, real3_of(axes.y));
    return (ref_ray){{0, 0, 0}, real3_unit(d), -1, -1};
}

/* Whether a pixel shows what the reference sees there, or between what it sees around: to the
 * sides, or with the eye moved by as little as the numbers of what is seen are sure. */
static bool is_right(const picture *p, int i) {
    static const double sides[11][5] = {
        {0},        {1},          {-1},          {0, 1},          {0, -1},         {0, 0, 1},
        {0, 0, -1}, {0, 0, 0, 1}, {0, 0, 0, -1}, {0, 0, 0, 0, 1}, {0, 0, 0, 0, -1}};
    const double off = 1e-12, wide = 1e-6;
    real low[3], high[3], light[3], scale = 0;
    for (int side = 0; side < 11; side++) {
        const double *by = sides[side];
        ref_ray ray = pixel_ray(p, i, off * by[0], off * by[1]);
        if (side == 5) {
            ref_hit hit = ref_nearest(&p->ref, &ray);
            if (hit.object >= 0) scale = ref_scale(&p->ref.primitives[hit.object], &ray, hit.t);
        }
        ray.o = real3_scale((real3){by[2], by[3], by[4]}, off * scale);
        bool inside = true;
        ref_trace(light, &p->ref, &ray);
        for (int k = 0; k < 3; k++) {
            low[k] = side ? real_min(low[k], light[k]) : light[k];
            high[k] = side ? real_max(high[k], light[k]) : light[k];
            real value = p->pixels[4 * i + k];
            inside &= value >= low[k] - wide * (1 + real_abs(low[k])) &&
                      value <= high[k] + wide * (1 + real_abs(high[k]));
        }
        if (inside) return true;
    }
    return false;
}

static void check(picture *p, tally *t, bool single, int64_t left_out) {
    int smooth = 0;
    const zt_scene *scene = &p->stage.s.scene;
    for (int32_t i = 0; i < scene->object_count; i++) smooth |= scene->objects[i].smooth;
    t->not_finite += left_out;
    for (int i = 0; i < PIXELS; i++) {
        const float *pixel = &p->pixels[4 * i];
        t->rays++;
        t->hits += pixel[0] + pixel[1] + pixel[2] > 0;
        t->not_finite += !isfinite(pixel[0] + pixel[1] + pixel[2]);
        t->false_hits += memcmp(pixel, &p->again[4 * i], 4 * sizeof *pixel) != 0;
        if (smooth || single || p->how == RUN_ANSWERS || is_right(p, i)) continue;
        if (++t->wrong > 3 || p->how != RUN_TOLD) continue;
        ref_ray ray = pixel_ray(p, i, 0, 0);
        real light[3];
        ref_trace(light, &p->ref, &ray);
        printf("  picture of %s: pixel %d is %g %g %g, reference %g %g %g\n", p->name, i,
               (double)pixel[0], (double)pixel[1], (double)pixel[2], (double)light[0],
               (double)light[1], (double)light[2]);
    }
}

static bool render(picture *p, run_result *result, int precision) {
    const zt_scene *scene = &p->stage.s.scene;
    tally *t = &result->tallies[precision];
    probe_precision chosen;
    probe_tracer *tracer = probe_open(scene, (probe_precision)precision, &chosen);
    if (!tracer) return false;
    probe_close(&tracer);
    double begin = zt_clock_s();
    int64_t left_out =
        probe_render(p->pixels, scene, (probe_precision)precision, WIDTH, HEIGHT, 1);
    t->seconds += zt_clock_s() - begin;
    if (left_out < 0 ||
        probe_render(p->again, scene, (probe_precision)precision, WIDTH, HEIGHT, 3) != left_out)
        return false;
    if (precision == PROBE_AUTO) result->chose_single += chosen == PROBE_SINGLE;
    check(p, t, chosen == PROBE_SINGLE, left_out);
    result->digest[precision] = zt_random_key(result->digest[precision],
                                              zt_hash_bytes(p->pixels, sizeof p->pixels).low);
    return true;
}

bool run_pictures(run_result *result, int count, run_how how) {
    static picture p;
    bool ok = true;
    *result = (run_result){.asked = {true, true, true}};
    p.how = how;
    for (int list = 0; cases_all[list]; list++)
        for (const extreme_case *c = cases_all[list]; c->name; c++)
            for (int i = 0; i < count && ok; i++) {
                p.name = c->name;
                if (!make(&p, c, i)) continue;
                for (int k = 0; k < PROBE_PRECISIONS && ok; k++) ok = render(&p, result, k);
                result->scenes++;
            }
    zt_arena_free(&p.arena);
    zt_arena_free(&p.stage.arena);
    return ok;
}
