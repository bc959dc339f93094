/* Lamps with a size, and lamps that move: what must not change the bits, what must stay finite;
 * and what is told of rays' paths, counted of them, and said of a single one. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tracer/footprint.h"
#include "tracing.h"

static const vec3 down = {0, -1, 0};

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
        int row = i / 16;
        vec3 d = {(i % 16 - 8) / 16., row / 16. - .7, -1};
        rays.oz[i] = rays.ox[i] = rays.oy[i] = 0;
        rays.dx[i] = d.x;
        rays.dy[i] = d.y;
        rays.dz[i] = d.z;
        rays.time[i] = (float)test_random(&seed);
        rays.key[i] = (uint32_t)i;
        rays.sample[i] = 5;
    }
    rays.count = ZT_BATCH - 3;
    for (int count = 2; count <= 3; count++) {
        zt_exposure exposure = {.moments = moments + (3 - count),
                                .times = count == 3 ? times : (const double[]){0, 1},
                                .steps = steps,
                                .moment_count = count};
        EACH_PRECISION {
            for (int i = 0; i < 4; i++) {
                setenv("ZOETROPE_ISA", names[i], 1);
                stage st;
                zt_labels labels;
                open_stage(&st, &exposure);
                assert_true(st.ready.moves && st.ready.random);
                assert_int_equal(zt_labels_make(&labels, &st.ready, &st.arena), ZT_OK);
                rays.labels = &labels;
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
    zt_labels labels;
    assert_int_equal(zt_labels_make(&labels, &st.ready, &st.arena), ZT_OK);
    rays.count = count;
    rays.labels = &labels;
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
    assert_int_equal(light.counts.shadow, 0);     /* nothing is in between */
    assert_int_equal(light.counts.mirror, 0);     /* and there is nothing to be mirrored */
    scene_sphere(&s, (vec3){0, 500, 1000}, 1, 0); /* somewhere: now there is */
    light.counts = (zt_ray_counts){0};
    trace_paths(&light, &s.scene, toward, 5);
    assert_int_equal(light.counts.primary, 5);
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
        cmocka_unit_test(test_same_bits), cmocka_unit_test(test_same_bits_moving),
        cmocka_unit_test(test_nasty),     cmocka_unit_test(test_paths),
        cmocka_unit_test(test_counts),    cmocka_unit_test(test_probe),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
