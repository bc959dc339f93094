/* Exposures of what moves while the shutter is open, made ready for rays, and what is between
 * two of their moments. cmocka.h comes first. */
#ifndef ZT_TESTS_MOVING_H
#define ZT_TESTS_MOVING_H

#include <math.h>

#include "meshes.h"
#include "scenes.h"
#include "stage.h"

/* A cube, and a smooth ball. */
static zt_mesh models[2];
static ball_mesh smooth_ball;

/* Setup and teardown of a group. */
static inline int make_models(void **state) {
    (void)state;
    smooth_ball = make_ball(3);
    models[0] = cube_mesh();
    models[1] = smooth_ball.mesh;
    return 0;
}

static inline int free_models(void **state) {
    (void)state;
    free_ball(&smooth_ball);
    return 0;
}

enum { MOMENTS_MAX = 9 };
static test_scene moments[MOMENTS_MAX];

static inline void begin_moment(test_scene *s) {
    scene_begin(s);
    s->scene.meshes = models;
    s->scene.mesh_count = 2;
}

typedef struct film {
    zt_scene scenes[MOMENTS_MAX];
    double times[MOMENTS_MAX];
    bool steps[MOMENTS_MAX];
    zt_exposure exposure;
} film;

/* Unevenly spread moments of `moments`. */
static inline void set_film(film *f, uint64_t *seed, int count) {
    for (int m = 0; m < count; m++) {
        f->scenes[m] = moments[m].scene;
        f->times[m] = m == 0 ? 0
                      : m == count - 1
                          ? 1
                          : floor(4000.0 * m / count + 90 * test_random(seed)) / 4096;
        f->steps[m] = false;
    }
    f->exposure = (zt_exposure){
        .moments = f->scenes, .times = f->times, .steps = f->steps, .moment_count = count};
}

/* Where a time is. */
static inline double find(const film *f, int *moment, double time) {
    int m = 0;
    while (m + 2 < f->exposure.moment_count && f->times[m + 1] <= time) m++;
    *moment = m;
    return (time - f->times[m]) / (f->times[m + 1] - f->times[m]);
}

static inline double mix(double a, double b, double s) { return (1 - s) * a + s * b; }
static inline vec3 mix3(vec3 a, vec3 b, double s) {
    return (vec3){mix(a.x, b.x, s), mix(a.y, b.y, s), mix(a.z, b.z, s)};
}

static inline void open_stage(stage *st, const zt_exposure *exposure, zt_precision precision) {
    open_stage_of(st, exposure, precision, (zt_pixel){.angle = .01});
}

static inline void open_still(stage *st, const zt_scene *scene) {
    zt_exposure exposure = zt_exposure_of(scene);
    open_stage(st, &exposure, ZT_PRECISION_DOUBLE);
    assert_false(st->ready.moves);
}

static inline zt_probe probe(const stage *st, vec3 origin, vec3 direction, double time) {
    zt_probe p = {.origin = origin, .direction = direction, .time = time, .source = -1};
    st->ready.kernel->probe(st->ready.tracer, &p, 1, st->work);
    return p;
}

static const zt_precision precisions[] = {ZT_PRECISION_SINGLE, ZT_PRECISION_DOUBLE};

/* Numbers a time that single precision has exactly, as rays carry it. */
static inline double random_time(uint64_t *seed) {
    return floor(test_random(seed) * 65536) / 65536;
}

static inline quat turn_by(uint64_t *seed, double angle) {
    return quat_axis_angle(test_direction(seed), angle);
}

/* A group within a group, that turn, stretch and carry along what is in them; the same seed
 * for all moments, and more of it at later ones. */
static inline void put_groups(test_scene *s, uint64_t seed, double amount, bool alike) {
    for (int g = 0; g < 2; g++) {
        zt_object *group = scene_object(s, ZT_SHAPE_GROUP, -1);
        group->parent = g - 1;
        zt_placement *p = &group->placement;
        p->position =
            vec3_add(test_direction(&seed), vec3_scale(test_direction(&seed), 1.5 * amount));
        quat first = turn_by(&seed, test_between(&seed, 0, 6));
        p->rotation = quat_mul(quat_axis_angle(test_direction(&seed), amount), first);
        double grow = 1 + .5 * amount * test_random(&seed);
        p->scale = (vec3){grow * exp(test_between(&seed, -.5, .5)),
                          exp(test_between(&seed, -.5, .5)), -1};
        if (alike) p->scale = (vec3){grow, grow, grow};
    }
}

#endif
