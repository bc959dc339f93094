/* Lenses of cameras that were put together by hand. cmocka.h comes first. */
#ifndef ZT_TESTS_LENSES_H
#define ZT_TESTS_LENSES_H

#include <string.h>

#include "render/lens.h"
#include "scenes.h"

enum { LENS_MOMENTS_MAX = 65 };

/* A camera while the shutter is open, and its lens, freed by lens_end(). */
typedef struct test_lens {
    zt_scene moments[LENS_MOMENTS_MAX];
    double times[LENS_MOMENTS_MAX];
    bool steps[LENS_MOMENTS_MAX];
    zt_exposure exposure;
    zt_arena arena;
    zt_lens *lens;
    int width, height;
} test_lens;

/* As a description's is where it says nothing: in the origin, looking along -z. */
static inline zt_camera lens_camera(zt_lens_kind kind) {
    return (zt_camera){.up = {0, 1, 0},
                       .rotation = {1, 0, 0, 0},
                       .lens = kind,
                       .fov = 0.7,
                       .sensor_height = 24,
                       .height = 2,
                       .focus_distance = 1};
}

/* The lens of `count` cameras, one at each of the times; count 1: of one that stays. */
static inline void lens_begin(test_lens *l, const zt_camera *cameras, const double *times,
                              int count, int width, int height) {
    memset(l, 0, sizeof *l);
    for (int i = 0; i < count; i++) {
        l->moments[i].camera = cameras[i];
        l->times[i] = times ? times[i] : 0;
    }
    l->exposure = (zt_exposure){
        .moments = l->moments, .times = l->times, .steps = l->steps, .moment_count = count};
    l->width = width;
    l->height = height;
    assert_int_equal(zt_lens_prepare(&l->lens, &l->exposure, width, height, &l->arena), ZT_OK);
}

static inline void lens_end(test_lens *l) { zt_arena_free(&l->arena); }

typedef struct test_ray {
    vec3 origin, direction;
} test_ray;

/* The ray through a place of the picture and of the opening at a time. */
static inline test_ray lens_ray(const test_lens *l, double x, double y, double u, double v,
                                double time) {
    static zt_rays rays;
    float at[4] = {(float)x, (float)y, (float)u, (float)v};
    rays.time[0] = (float)time;
    zt_lens_rays(&rays, l->lens, &at[0], &at[1], &at[2], &at[3], 1);
    assert_int_equal(rays.count, 1);
    return (test_ray){{rays.ox[0], rays.oy[0], rays.oz[0]},
                      {rays.dx[0], rays.dy[0], rays.dz[0]}};
}

static inline test_ray lens_middle(const test_lens *l, double x, double y) {
    return lens_ray(l, x, y, 0.5, 0.5, 0);
}

#endif
