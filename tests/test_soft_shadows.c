/* Lamps with a size, and lamps that move, as rays see them: light, shadows, the mean over time.
 *
 * Random numbers are fixed. Were they drawn anew, each comparison with a mean (limit: 3
 * standard errors of 4,096 independent samples) would fail by chance once in 370 times. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tracer/sampler.h"
#include "tracing.h"

enum { SAMPLES = 4096 };

#define PI 3.14159265358979323846

/* ---- rays -----------------------------------------------------------------------------------
 */

/* The mean of many independent samples of one ray at times spread evenly over the opening, and
 * the standard error of it. */
typedef struct mean {
    double value, error;
} mean;

static mean look(const zt_exposure *exposure, vec3 from, vec3 toward) {
    static zt_rays rays;
    static zt_radiance light;
    stage st;
    open_stage(&st, exposure);
    double sum = 0, squares = 0;
    for (int done = 0; done < SAMPLES; done += ZT_BATCH) {
        rays.count = ZT_BATCH;
        for (int i = 0; i < ZT_BATCH; i++) {
            rays.ox[i] = from.x;
            rays.oy[i] = from.y;
            rays.oz[i] = from.z;
            rays.dx[i] = toward.x;
            rays.dy[i] = toward.y;
            rays.dz[i] = toward.z;
            rays.time[i] = ((float)(done + i) + .5f) / SAMPLES;
            rays.key[i] = zt_sample_mix((uint32_t)(done + i) + 77);
            rays.sample[i] = 0;
        }
        st.ready.kernel->trace(&light, st.ready.tracer, &rays, st.work);
        for (int i = 0; i < ZT_BATCH; i++) {
            sum += (double)light.g[i];
            squares += (double)light.g[i] * (double)light.g[i];
        }
    }
    close_stage(&st);
    double value = sum / SAMPLES;
    return (mean){value, sqrt(fmax(squares / SAMPLES - value * value, 0) / SAMPLES)};
}

static mean look_still(const zt_scene *scene, vec3 from, vec3 toward) {
    zt_exposure exposure = zt_exposure_of(scene);
    return look(&exposure, from, toward);
}

static void assert_mean(mean got, double wanted, double off) {
    assert_near(got.value, wanted, 3 * got.error + off);
}

static const vec3 down = {0, -1, 0};
static vec3 above(double x, double z) { return (vec3){x, .5, z}; }

/* ---- light ----------------------------------------------------------------------------------
 */

/* Over a floor: a ball and, on its axis, a disk by their closed forms; a rectangle by Lambert's
 * sum over its edges, here for a corner above the point, four times. */
static void test_closed_forms(void **state) {
    (void)state;
    EACH_PRECISION {
        test_scene s;
        begin_floor(&s);
        zt_light *lamp = scene_point_light(&s, (vec3){1, 2, -1}, 3);
        lamp->radius = .7;
        assert_mean(look_still(&s.scene, above(0, 0), down), 3 * 2 / pow(6, 1.5), 1e-6);
        s.scene.light_count = 0;
        lamp = scene_disk_light(&s, (vec3){0, 1.5, 0}, .8);
        assert_mean(look_still(&s.scene, above(0, 0), down), 1 / (.8 * .8 + 1.5 * 1.5), 1e-6);
        lamp->position.y = .1; /* within its own radius: in all directions */
        lamp->intensity = .3;
        assert_mean(look_still(&s.scene, (vec3){0, .05, 0}, down), .3 / (.8 * .8 + .01), 1e-6);
        s.scene.light_count = 0;
        scene_rectangle_light(&s, (vec3){0, 1, 0}, 2, 1)->intensity = .5;
        double a = 1, b = .5,
               quarter = .5 * (a / hypot(1, a) * atan(b / hypot(1, a)) +
                               b / hypot(1, b) * atan(a / hypot(1, b)));
        assert_mean(look_still(&s.scene, above(0, 0), down), .5 * 4 * quarter / 2, 1e-6);
    }
}

/* An edge between a floor and a lamp hides exactly the part of the lamp that lies beyond it, as
 * seen from the point: the light is that of the rest, by a midpoint rule over it. All the way
 * through the penumbra; in the middle of it, by symmetry, half. */
static void test_penumbra(void **state) {
    (void)state;
    EACH_PRECISION {
        for (int kind = 0; kind < 3; kind++) {
            for (int step = 0; step <= 8; step++) {
                double edge = .2 * (step - 4) / 3.9;
                test_scene s;
                begin_floor(&s);
                zt_light *lamp;
                if (kind == 0) {
                    lamp = scene_point_light(&s, (vec3){0, 2, 0}, 2);
                    lamp->radius = .4;
                } else if (kind == 1) {
                    lamp = scene_disk_light(&s, (vec3){0, 2, 0}, .4);
                } else {
                    lamp = scene_rectangle_light(&s, (vec3){0, 2, 0}, .8, .5);
                }
                lamp->intensity = 2;
                mean whole = look_still(&s.scene, above(0, 0), down);
                /* Half of a plane at half of the height hides x < 2 edge of the lamp. */
                scene_triangle(&s, (vec3){edge, 1, -90}, (vec3){edge, 1, 90}, (vec3){-90, 1, 0},
                               0);
                mean got = look_still(&s.scene, above(0, 0), down);
                if (step == 4) assert_mean(got, whole.value / 2, 3 * whole.error);
                long double sum = 0;
                enum { GRID = 500 };
                for (int i = 0; i < GRID; i++)
                    for (int k = 0; k < GRID; k++) {
                        long double u = (i + .5L) / GRID, v = (k + .5L) / GRID, x, y = 2, z;
                        long double there, weight = 1;
                        long double r = .4L * sqrtl(u), angle = 2 * PI * v;
                        x = kind == 2 ? .4L * (2 * u - 1) : r * cosl(angle);
                        z = kind == 2 ? .25L * (2 * v - 1) : r * sinl(angle);
                        if (kind == 0) { /* over its lower half, by its height */
                            long double depth = u, across = sqrtl(1 - depth * depth);
                            x = .4L * across * cosl(angle);
                            z = .4L * across * sinl(angle);
                            y = 2 - .4L * depth;
                            there = -(x * across * cosl(angle) + z * across * sinl(angle)) +
                                    y * depth;
                            weight = 2;
                        } else {
                            there = y;
                        }
                        long double d2 = x * x + y * y + z * z;
                        if (there < 0 || x / y * 1 < edge) continue;
                        sum += weight * 2 * y * there / (d2 * d2);
                    }
                assert_mean(got, (double)(sum / (GRID * GRID)), 2e-3);
            }
        }
    }
}

/* Lamps that shrink to a point give the picture of a point light, shadows, mirrors and all: no
 * pixel is further off than the size. */
static void test_shrinking(void **state) {
    (void)state;
    EACH_PRECISION {
        test_scene s;
        begin_floor(&s);
        s.materials[0].reflectivity = .4;
        scene_sphere(&s, (vec3){0, .6, -4}, .5, 0);
        s.scene.camera.position = (vec3){0, 1, 0};
        zt_light *lamp = scene_point_light(&s, (vec3){1, 3, -2}, 6);
        zt_image *point = render(&s.scene, 48, 32, 1, 1);
        for (double size = .1; size > 1e-12; size /= 10) {
            lamp->radius = size;
            zt_image *ball = render(&s.scene, 48, 32, 1, 1);
            int different = 0;
            for (int i = 0; i < 48 * 32 * 4; i++)
                different +=
                    fabsf(ball->pixels[i] - point->pixels[i]) > (float)(4 * size) + 1e-6f;
            /* Only those where the edge of the shadow is. */
            assert_true(different <= 3 * (int)(40 * size + (size > 1e-3 ? 20 : 0)));
            zt_image_free(&ball);
        }
        zt_image_free(&point);
    }
}

/* A lamp may lie on a ceiling, and fill a ball to its surface: they do not hide it. */
static void test_skin(void **state) {
    (void)state;
    EACH_PRECISION {
        test_scene s;
        begin_floor(&s);
        zt_light *lamp = scene_rectangle_light(&s, (vec3){.3, 2.2, -.4}, 1, .6);
        mean free = look_still(&s.scene, above(0, 0), down);
        mean aside = look_still(&s.scene, above(9, 7), down);
        scene_plane(&s, (vec3){0, 1, 0}, 2.2, 0);
        assert_near(look_still(&s.scene, above(0, 0), down).value, free.value, 0);
        assert_near(look_still(&s.scene, above(9, 7), down).value, aside.value, 0);
        s.scene.object_count = 1;
        lamp->kind = ZT_LIGHT_POINT;
        lamp->radius = .31;
        free = look_still(&s.scene, above(0, 0), down);
        scene_sphere(&s, lamp->position, .31, 0);
        assert_near(look_still(&s.scene, above(0, 0), down).value, free.value, 0);
        /* And it shines in the lamp's light: intensity / r^2, here cut to 1. */
        assert_near(look_still(&s.scene, (vec3){0, 2.2, 5}, (vec3){.06, 0, -1.08}).value, 1,
                    1e-6);
    }
}

/* ---- time -----------------------------------------------------------------------------------
 */

/* Two moments of a floor with a lamp each. */
static zt_exposure expose(zt_scene moments[2], const test_scene *a, const test_scene *b,
                          bool *steps) {
    static const double times[] = {0, 1};
    moments[0] = a->scene;
    moments[1] = b->scene;
    return (zt_exposure){.moments = moments, .times = times, .steps = steps, .moment_count = 2};
}

/* A point light that moves, brightens and changes its color gives the mean over time; where it
 * steps, the mean of both. */
static void test_moving_point(void **state) {
    (void)state;
    EACH_PRECISION {
        test_scene a, b;
        zt_scene moments[2];
        bool steps[2] = {false, false};
        begin_floor(&a);
        begin_floor(&b);
        scene_point_light(&a, (vec3){-1, 1, 0}, 1);
        scene_point_light(&b, (vec3){2, 3, 1}, 4)->color = (vec3){1, .5, 1};
        zt_exposure exposure = expose(moments, &a, &b, steps);
        long double sum = 0;
        for (int i = 0; i < 100000; i++) {
            long double t = (i + .5L) / 100000, x = -1 + 3 * t, y = 1 + 2 * t, z = t;
            sum += (1 + t) * y / powl(x * x + y * y + z * z, 1.5L); /* 4 * .5 at the end */
        }
        assert_near(look(&exposure, above(0, 0), down).value, sum / 100000, 1e-6);
        steps[0] = true;
        assert_near(look(&exposure, above(0, 0), down).value,
                    (1 / pow(2, 1.5) + 2 * 3 / pow(14, 1.5)) / 2, 1e-6);
        b.lights[0].shadows = false; /* and a light hidden for half of the time */
        scene_sphere(&a, (vec3){-.5, .5, 0}, .2, 0);
        scene_sphere(&b, (vec3){-.5, .5, 0}, .2, 0);
        scene_sphere(&a, (vec3){1, 1.5, .5}, .2, 0);
        scene_sphere(&b, (vec3){1, 1.5, .5}, .2, 0);
        exposure = expose(moments, &a, &b, steps);
        assert_near(look(&exposure, above(0, 0), down).value, 2 * 3 / pow(14, 1.5) / 2, 1e-6);
    }
}

/* Ambient light that changes: its mean. */
static void test_moving_ambient(void **state) {
    (void)state;
    test_scene a, b;
    zt_scene moments[2];
    bool steps[2] = {false, false};
    begin_floor(&a);
    begin_floor(&b);
    scene_ambient(&a, white, .2);
    scene_ambient(&b, white, .6);
    zt_exposure exposure = expose(moments, &a, &b, steps);
    EACH_PRECISION assert_near(look(&exposure, above(0, 0), down).value, .4, 1e-6);
}

/* Lamps with a size whose place, size and direction change: the mean of what they give at many
 * moments, each as a scene of its own. */
static void test_moving_sizes(void **state) {
    (void)state;
    EACH_PRECISION {
        for (int kind = 0; kind < 3; kind++) {
            test_scene a, now;
            static test_scene b;
            zt_scene moments[2];
            bool steps[2] = {false, false};
            begin_floor(&a);
            if (kind == 0)
                scene_point_light(&a, (vec3){-1, 1.5, 0}, 1)->radius = .2;
            else if (kind == 1)
                scene_disk_light(&a, (vec3){-1, 1.5, 0}, .2);
            else
                scene_rectangle_light(&a, (vec3){-1, 1.5, 0}, .2, .6);
            b = a;
            b.scene = a.scene;
            b.scene.lights = b.lights;
            b.scene.objects = b.objects;
            b.scene.materials = b.materials;
            zt_light *end = &b.lights[0];
            end->position = (vec3){.7, 1.3, .4};
            end->radius = .6;
            end->width = 1;
            /* Turned by a little, so that the chord and the arc are alike. */
            end->rotation = quat_axis_angle((vec3){1, 0, 0}, -PI / 2 - .1);
            zt_exposure exposure = expose(moments, &a, &b, steps);
            double sum = 0, error = 0;
            enum { TIMES = 16 };
            for (int i = 0; i < TIMES; i++) {
                double t = (i + .5) / TIMES;
                now = a;
                now.scene.lights = now.lights;
                now.lights[0].position =
                    vec3_add(a.lights[0].position,
                             vec3_scale(vec3_sub(end->position, a.lights[0].position), t));
                now.lights[0].radius += t * (end->radius - a.lights[0].radius);
                now.lights[0].width += t * (end->width - a.lights[0].width);
                now.lights[0].rotation = quat_axis_angle((vec3){1, 0, 0}, -PI / 2 - .1 * t);
                mean m = look_still(&now.scene, above(.2, 0), down);
                sum += m.value / TIMES;
                error += m.error * m.error / (TIMES * TIMES);
            }
            mean got = look(&exposure, above(.2, 0), down);
            assert_near(got.value, sum, 3 * hypot(got.error, sqrt(error)) + 1e-3 * sum);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_forms), cmocka_unit_test(test_penumbra),
        cmocka_unit_test(test_shrinking),    cmocka_unit_test(test_skin),
        cmocka_unit_test(test_moving_point), cmocka_unit_test(test_moving_ambient),
        cmocka_unit_test(test_moving_sizes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
