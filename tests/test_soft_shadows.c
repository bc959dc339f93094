/* Lamps with a size, and lamps that move, as rays see them: shadows, the mean over time, what
 * must not change the bits, what must stay finite; and what is told of paths and counted.
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

#include "rendering.h"
#include "tracer/sampler.h"

enum { SAMPLES = 4096 };

#define PI 3.14159265358979323846

/* cmocka's own takes floats. */
#define assert_near(a, b, room) near_or_fail((double)(a), (double)(b), (double)(room), __LINE__)
static void near_or_fail(double a, double b, double room, int line) {
    if (fabs(a - b) <= room) return;
    print_error("line %d: %.17g is not %.17g within %g\n", line, a, b, room);
    fail();
}

/* ---- rays -----------------------------------------------------------------------------------
 */

/* An exposure made ready. */
typedef struct stage {
    zt_arena arena;
    zt_meshes *meshes;
    zt_ready ready;
    void *work;
} stage;

static void open_stage(stage *st, const zt_exposure *exposure) {
    *st = (stage){0};
    const zt_scene *scene = exposure->moments;
    assert_int_equal(
        zt_meshes_open(&st->meshes, scene->meshes, scene->mesh_count, 1, (zt_listener){0}),
        ZT_OK);
    assert_int_equal(zt_tracer_prepare(&st->ready, exposure, precision,
                                       zt_lens_pixel(&scene->camera, 100), st->meshes,
                                       &st->arena),
                     ZT_OK);
    st->work = aligned_alloc(64, (zt_kernel_work_size() + 63) / 64 * 64);
    assert_non_null(st->work);
}

static void close_stage(stage *st) {
    free(st->work);
    zt_meshes_close(&st->meshes);
    zt_arena_free(&st->arena);
}

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

static zt_light *scene_disk_light(test_scene *s, vec3 position, double radius) {
    zt_light *light = scene_point_light(s, position, 1);
    light->kind = ZT_LIGHT_DISK;
    light->radius = radius;
    light->rotation = quat_axis_angle((vec3){1, 0, 0}, -PI / 2); /* down */
    return light;
}

static zt_light *scene_rectangle_light(test_scene *s, vec3 position, double width,
                                       double height) {
    zt_light *light = scene_disk_light(s, position, 0);
    light->kind = ZT_LIGHT_RECTANGLE;
    light->width = width;
    light->height = height;
    return light;
}

/* A floor, seen from above through (x, 0, z). */
static void begin_floor(test_scene *s) {
    scene_begin(s);
    scene_material(s, white, 0);
    scene_plane(s, (vec3){0, 1, 0}, 0, 0);
}

static const vec3 down = {0, -1, 0};
static vec3 above(double x, double z) { return (vec3){x, .5, z}; }

/* All of the following hold in either precision. */
#define EACH_PRECISION                                                                         \
    for (precision = ZT_PRECISION_SINGLE; precision <= ZT_PRECISION_DOUBLE; precision++)

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
    return (zt_exposure){moments, times, steps, 2};
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

/* ---- bits -----------------------------------------------------------------------------------
 */

/* A room with all kinds of lamps, mirrors, and things that hide. */
static void make_room(test_scene *s) {
    begin_floor(s);
    scene_material(s, (vec3){.8, .5, .3}, .5);
    s->scene.camera.position = (vec3){0, 1.5, 5};
    scene_plane(s, (vec3){0, 0, 1}, -3, 1);
    for (int i = 0; i < 5; i++) scene_sphere(s, (vec3){i - 2, .5 + .2 * i, -i % 3}, .45, i % 2);
    scene_ambient(s, white, .1);
    scene_point_light(s, (vec3){-2, 3, 1}, 3);
    scene_point_light(s, (vec3){2, 2.5, 1}, 3)->radius = .4;
    scene_disk_light(s, (vec3){0, 3, -1}, .7)->intensity = 2;
    scene_rectangle_light(s, (vec3){1, 1.2, 0}, 1.5, .1)->intensity = 2;
}

/* All widths of instructions give the same bits, as do all numbers of threads. */
static void test_same_bits(void **state) {
    (void)state;
    test_scene s;
    make_room(&s);
    const char *const names[] = {"scalar", "base", "avx2", "avx512"};
    EACH_PRECISION {
        zt_image *wanted = NULL;
        for (int i = 0; i < 8; i++) {
            setenv("ZOETROPE_ISA", names[i % 4], 1);
            zt_image *got = render(&s.scene, 77, 45, 3, 1 + i / 2);
            if (!wanted) {
                wanted = got;
                continue;
            }
            assert_memory_equal(got->pixels, wanted->pixels, 77 * 45 * 4 * sizeof(float));
            zt_image_free(&got);
        }
        zt_image_free(&wanted);
    }
    unsetenv("ZOETROPE_ISA");
}

/* The same bits, too, of lamps that move, in exposures of two and of three moments. */
static void test_same_bits_moving(void **state) {
    (void)state;
    static test_scene all[3];
    static zt_rays rays;
    static zt_radiance light[4];
    static const double times[] = {0, .25, 1};
    const char *const names[] = {"scalar", "base", "avx2", "avx512"};
    zt_scene moments[3];
    bool steps[3] = {false, false, false};
    uint64_t seed = 3;
    for (int m = 0; m < 3; m++) {
        make_room(&all[m]);
        for (int i = 1; i < all[m].scene.light_count; i++) {
            zt_light *l = &all[m].lights[i];
            l->position = vec3_add(l->position, vec3_scale(test_direction(&seed), .3));
            if (l->radius > 0) l->radius += .1 * m;
            l->rotation = quat_axis_angle(test_direction(&seed), test_between(&seed, 0, .5));
        }
        moments[m] = all[m].scene;
    }
    for (int i = 0; i < ZT_BATCH; i++) {
        vec3 d = {(i % 16 - 8) / 16., (i / 16 - 8) / 16. - .2, -1};
        rays.oz[i] = rays.ox[i] = rays.oy[i] = 0;
        rays.dx[i] = d.x;
        rays.dy[i] = d.y;
        rays.dz[i] = d.z;
        rays.time[i] = (float)test_random(&seed);
        rays.key[i] = (uint32_t)i;
        rays.sample[i] = 5;
    }
    rays.count = ZT_BATCH - 3;
    rays.wants_path = true;
    for (int count = 2; count <= 3; count++) {
        zt_exposure exposure = {moments + (3 - count),
                                count == 3 ? times : (const double[]){0, 1}, steps, count};
        EACH_PRECISION {
            for (int i = 0; i < 4; i++) {
                setenv("ZOETROPE_ISA", names[i], 1);
                stage st;
                open_stage(&st, &exposure);
                assert_true(st.ready.moves && st.ready.random);
                st.ready.kernel->trace(&light[i], st.ready.tracer, &rays, st.work);
                close_stage(&st);
                size_t size = (size_t)rays.count * sizeof(float);
                assert_memory_equal(light[i].r, light[0].r, size);
                assert_memory_equal(light[i].g, light[0].g, size);
                assert_memory_equal(light[i].b, light[0].b, size);
                assert_memory_equal(light[i].path, light[0].path, size);
            }
        }
    }
    unsetenv("ZOETROPE_ISA");
}

/* ---- nasty places ---------------------------------------------------------------------------
 */

/* Lamps on surfaces, in corners, inside of things and around the eye, from 1e-20 to 1e20 large:
 * all light is finite, and none is below nothing or over what is cut. */
static void test_nasty(void **state) {
    (void)state;
    uint64_t seed = 11;
    static zt_rays rays;
    static zt_radiance light;
    EACH_PRECISION {
        for (int round = 0; round < 600; round++) {
            test_scene s;
            begin_floor(&s);
            scene_plane(&s, (vec3){0, 0, 1}, -1, 0);
            scene_sphere(&s, (vec3){0, .5, -.5}, .5, 0);
            s.scene.camera.position = (vec3){.1, 1, 1};
            const vec3 places[] = {{0, 0, 0},  {0, 0, -1},    {0, .5, -.5},  {0, 1, -.5},
                                   {.1, 1, 1}, {0, -1e-9, 0}, {3, 1e-7, -1}, {0, 2, 0}};
            double size = pow(10, round % 41 - 20);
            vec3 at = places[round % 8];
            if (round % 3 == 0) scene_point_light(&s, at, 2)->radius = size;
            if (round % 3 == 1) scene_disk_light(&s, at, size);
            if (round % 3 == 2)
                scene_rectangle_light(&s, at, size, size * pow(10, (int)(round / 3) % 9 - 4));
            if (round % 5 == 0)
                s.lights[0].rotation = quat_axis_angle(test_direction(&seed), 1);
            zt_exposure exposure = zt_exposure_of(&s.scene);
            stage st;
            open_stage(&st, &exposure);
            for (int i = 0; i < ZT_BATCH; i++) {
                vec3 d = i % 2 ? test_direction(&seed)
                               : vec3_sub(at, vec3_add(s.scene.camera.position,
                                                       vec3_scale(test_direction(&seed), .01)));
                rays.dx[i] = d.x;
                rays.dy[i] = d.y;
                rays.dz[i] = d.z;
                rays.key[i] = (uint32_t)i;
            }
            rays.count = ZT_BATCH;
            st.ready.kernel->trace(&light, st.ready.tracer, &rays, st.work);
            for (int i = 0; i < ZT_BATCH; i++)
                assert_true(light.r[i] >= 0 && light.r[i] <= 1 && isfinite(light.r[i]));
            close_stage(&st);
        }
    }
}

/* ---- paths and counts -----------------------------------------------------------------------
 */

/* The paths of rays that run towards (x, y, -1). */
static void trace_paths(zt_radiance *light, const zt_scene *scene, const double (*toward)[2],
                        int count) {
    static zt_rays rays;
    zt_exposure exposure = zt_exposure_of(scene);
    stage st;
    open_stage(&st, &exposure);
    for (int i = 0; i < count; i++) {
        rays.dx[i] = toward[i][0];
        rays.dy[i] = toward[i][1];
        rays.dz[i] = -1;
    }
    rays.count = count;
    rays.wants_path = true;
    st.ready.kernel->trace(light, st.ready.tracer, &rays, st.work);
    close_stage(&st);
}

/* A box before a wall of two colors, half of it a mirror: paths are the same within each thing,
 * face, cell, shadow and mirrored thing, and different between them. */
static void test_paths(void **state) {
    (void)state;
    test_scene s;
    static zt_radiance light;
    scene_begin(&s);
    scene_material(&s, white, 0);
    scene_material(&s, white, 0);
    s.materials[1].pattern = ZT_PATTERN_STRIPES;
    s.materials[1].other_color = (vec3){.2, .3, .4};
    s.materials[1].pattern_size = 4;
    s.materials[1].pattern_direction = (vec3){1, 0, 0};
    scene_plane(&s, (vec3){0, 0, 1}, -8, 1);
    zt_object *box = scene_object(&s, ZT_SHAPE_BOX, 0);
    box->box.center = (vec3){-2, 0, -4};
    box->box.size = (vec3){1, 1, 1};
    box->box.rotation = (quat){1, 0, 0, 0};
    scene_material(&s, white, .5);
    scene_plane(&s, (vec3){0, 1, 0}, -3, 2);
    scene_point_light(&s, (vec3){-2, .2, 0}, 30);
    const double toward[][2] = {
        {.1, .5},   {.12, .51},  /* the wall, a cell */
        {.6, .5},   {.62, .51},  /* the wall, the next cell */
        {-.5, .02}, {-.52, 0},   /* the box, its front */
        {-.37, 0},               /* and its side */
        {-.33, 0},               /* the wall, in the shadow of the box, a cell like ... */
        {-.3, .5},               /* ... this and those of the second row */
        {.1, -.9},  {.12, -.91}, /* the floor, mirroring the wall */
        {.6, -.9},               /* mirroring the next cell of it */
    };
    enum { COUNT = sizeof toward / sizeof toward[0] };
    const int same[COUNT] = {0, 0, 2, 2, 4, 4, 6, 7, 2, 9, 9, 11};
    trace_paths(&light, &s.scene, toward, COUNT);
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < i; k++)
            assert_int_equal(light.path[i] == light.path[k], same[i] == same[k]);
}

/* Rays are counted as they are traced: one for each, those to lamps that something might hide
 * where the surface faces them, and mirrored ones. */
static void test_counts(void **state) {
    (void)state;
    test_scene s;
    static zt_radiance light;
    const double toward[][2] = {{0, -.5}, {.1, -.5}, {0, .5}, {.1, .5}, {.2, .5}};
    scene_begin(&s);
    scene_material(&s, white, .5);
    scene_plane(&s, (vec3){0, 1, 0}, -1, 0); /* below: two rays meet it */
    scene_point_light(&s, (vec3){0, 3, 0}, 1);
    light.counts = (zt_ray_counts){0};
    trace_paths(&light, &s.scene, toward, 5);
    assert_int_equal(light.counts.primary, 5);
    assert_int_equal(light.counts.shadow, 0); /* nothing is in between */
    assert_int_equal(light.counts.mirror, 2);
    scene_sphere(&s, (vec3){50, 1, -2}, 60, 0); /* around all */
    trace_paths(&light, &s.scene, toward, 5);
    assert_int_equal(light.counts.primary, 10);
    assert_true(light.counts.shadow >= 5);
}

/* A probe asks about the very place on a lamp that a ray with its key does. */
static void test_probe(void **state) {
    (void)state;
    test_scene s;
    static zt_rays rays;
    static zt_radiance light;
    begin_floor(&s);
    scene_sphere(&s, (vec3){0, 1, 0}, .3, 0);
    zt_light *lamp = scene_point_light(&s, (vec3){0, 2, 0}, 1);
    lamp->radius = .5;
    zt_exposure exposure = zt_exposure_of(&s.scene);
    stage st;
    open_stage(&st, &exposure);
    int lit = 0;
    for (int i = 0; i < 200; i++) {
        vec3 places[1], from = {.55, .5, 0};
        zt_probe probe = {.origin = from,
                          .direction = down,
                          .source = -1,
                          .key = (uint32_t)i,
                          .sample = 9,
                          .lamp_points = places};
        st.ready.kernel->probe(st.ready.tracer, &probe, 1, st.work);
        rays.ox[0] = from.x;
        rays.oy[0] = from.y;
        rays.oz[0] = from.z;
        rays.dy[0] = -1;
        rays.key[0] = (uint32_t)i;
        rays.sample[0] = 9;
        rays.count = 1;
        st.ready.kernel->trace(&light, st.ready.tracer, &rays, st.work);
        assert_int_equal(probe.lit & 1, light.r[0] > 0);
        assert_near(vec3_length(vec3_sub(places[0], lamp->position)), .5, 2e-3);
        lit += light.r[0] > 0;
    }
    assert_true(lit > 20 && lit < 180); /* in the penumbra */
    close_stage(&st);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_closed_forms),
        cmocka_unit_test(test_penumbra),
        cmocka_unit_test(test_shrinking),
        cmocka_unit_test(test_skin),
        cmocka_unit_test(test_moving_point),
        cmocka_unit_test(test_moving_ambient),
        cmocka_unit_test(test_moving_sizes),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_same_bits_moving),
        cmocka_unit_test(test_nasty),
        cmocka_unit_test(test_paths),
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_probe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
