/* Batches that meet nothing, or one flat thing, take short ways; things that lie behind others
 * are not asked; and scenes in which nothing moves have kernels of their own. Of random rooms
 * full of walls, panes and open sides the light, the paths and what is noted in footprints are
 * those of doing everything, bit by bit. A number given to the program draws others. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tracer/footprint.h"
#include "tracing.h"

static uint64_t seed = 11;

static bool chance(double share) { return test_random(&seed) < share; }
static double between(double low, double high) { return test_between(&seed, low, high); }

static vec3 somewhere(double reach) {
    return (vec3){between(-reach, reach), between(-reach, reach), between(-reach, reach)};
}

/* ---- rooms ----------------------------------------------------------------------------------
 */

enum { MATERIALS = 4 };

static int32_t any_material(void) { return (int32_t)(MATERIALS * test_random(&seed)); }

static void add_walls(test_scene *s) {
    for (int axis = 0; axis < 3; axis++)
        for (int side = -1; side <= 1; side += 2) {
            vec3 normal = {axis == 0, axis == 1, axis == 2};
            if (chance(.5)) continue;
            if (chance(.2)) normal = test_direction(&seed);
            double distance = side * between(2, 6);
            scene_plane(s, normal, distance, any_material());
            if (chance(.1)) scene_plane(s, normal, distance, any_material());
        }
}

static void add_things(test_scene *s) {
    for (int i = (int)between(0, 4); i > 0; i--) {
        vec3 at = somewhere(4);
        double reach = chance(.5) ? 9 : 2; /* panes as large as the view, and smaller ones */
        if (chance(.6))
            scene_triangle(s, vec3_add(at, somewhere(reach)), vec3_add(at, somewhere(reach)),
                           vec3_add(at, somewhere(reach)), any_material());
        else if (chance(.6))
            scene_sphere(s, at, between(.1, 2), any_material());
        else
            scene_object(s, ZT_SHAPE_DISK, any_material())->disk =
                (zt_disk){at, test_direction(&seed), between(.2, 2)};
    }
}

/* Lamps on both sides of walls, some of them with a size; as many as batches bound, now and
 * then. */
static void add_lamps(test_scene *s, bool sized) {
    int count = chance(.2) ? 12 : (int)between(0, 4);
    for (int i = 0; i < count; i++) {
        zt_light *light = scene_point_light(s, somewhere(chance(.7) ? 3 : 20), between(.1, 30));
        light->shadows = chance(.8);
        if (sized && chance(.5)) light->radius = between(.01, .5);
    }
}

static void make_room(test_scene *s, bool sized) {
    scene_begin(s);
    bool mirrors = chance(.6);
    for (int i = 0; i < MATERIALS; i++) {
        vec3 color = {test_random(&seed), test_random(&seed), chance(.2) ? 0 : 1};
        int32_t m = scene_material(s, color, mirrors && chance(.5) ? between(.3, .9) : 0);
        if (chance(.8)) continue;
        s->materials[m].pattern = ZT_PATTERN_CHECKER;
        s->materials[m].pattern_size = 1.5;
    }
    add_walls(s);
    add_things(s);
    add_lamps(s, sized);
    if (chance(.7)) scene_ambient(s, (vec3){.2, .3, .1}, test_random(&seed));
    s->scene.reflection_depth = (int32_t)between(0, 4);
}

/* A square of a picture from somewhere, near or wide, of any number of rays. */
static void make_rays(zt_rays *rays, bool both_sides) {
    vec3 from = somewhere(2), ahead = test_direction(&seed),
         right = vec3_scale(test_direction(&seed), between(.001, .08)),
         down = vec3_scale(vec3_normalize(vec3_cross(ahead, right)), vec3_length(right));
    rays->count = chance(.5) ? ZT_BATCH : 1 + (int)(ZT_BATCH * test_random(&seed));
    for (int i = 0; i < rays->count; i++) {
        vec3 d = vec3_add(
            ahead, vec3_add(vec3_scale(right, i % 16 - 7.5), vec3_scale(down, i / 16 - 7.5)));
        if (both_sides && i % 2) d = vec3_scale(d, -1);
        vec3 o = both_sides ? vec3_scale(d, -3) : from;
        rays->ox[i] = o.x, rays->oy[i] = o.y, rays->oz[i] = o.z;
        rays->dx[i] = d.x, rays->dy[i] = d.y, rays->dz[i] = d.z;
        rays->key[i] = (uint32_t)i;
        rays->sample[i] = 3;
    }
}

/* ---- comparing ------------------------------------------------------------------------------
 */

static void assert_same_light(const zt_radiance *a, const zt_radiance *b, int count) {
    const size_t size = (size_t)count * sizeof *a->r;
    assert_memory_equal(a->r, b->r, size);
    assert_memory_equal(a->g, b->g, size);
    assert_memory_equal(a->b, b->b, size);
    assert_memory_equal(a->a, b->a, size);
}

/* Light, what met something, paths and a footprint, of doing everything or not. */
typedef struct answer {
    zt_radiance light;
    zt_footprint footprint;
    bool met;
} answer;

static void ask(answer *to, zt_rays *rays, stage *st) {
    zt_outline outline;
    zt_labels labels;
    assert_int_equal(zt_outline_make(&outline, &st->ready, &st->arena), ZT_OK);
    assert_int_equal(zt_labels_make(&labels, &st->ready, &st->arena), ZT_OK);
    *to = (answer){0};
    rays->labels = &labels;
    rays->wants_cover = true;
    rays->footprint = &to->footprint;
    rays->outline = &outline;
    to->met = st->ready.kernel->trace(&to->light, st->ready.tracer, rays, st->work);
    rays->labels = NULL;
    rays->footprint = NULL;
}

/* The same without paths, with a footprint and without, and by the plain kernel. */
static void compare_ways(const answer *all, zt_rays *rays, stage *st, zt_ray_counts *sum) {
    static zt_radiance light;
    zt_outline outline;
    zt_footprint footprint = {0};
    assert_int_equal(zt_outline_make(&outline, &st->ready, &st->arena), ZT_OK);
    rays->outline = &outline;
    for (int way = 0; way < 3; way++) {
        memset(&light, 0, sizeof light);
        rays->footprint = way == 0 ? &footprint : NULL;
        zt_trace *trace = way == 2 ? st->ready.kernel->trace_plain : st->ready.kernel->trace;
        bool met = trace(&light, st->ready.tracer, rays, st->work);
        assert_same_light(&light, &all->light, rays->count);
        assert_int_equal(met, all->met);
        zt_ray_counts_add(sum, &light.counts);
    }
    rays->footprint = NULL;
}

static void compare(zt_rays *rays, const zt_exposure *exposure, bool sized, bool both_sides,
                    zt_ray_counts *sum) {
    static answer all, some;
    stage everything, own;
    setenv("ZOETROPE_EVERYTHING", "1", 1);
    open_stage(&everything, exposure);
    unsetenv("ZOETROPE_EVERYTHING");
    open_stage(&own, exposure);
    assert_true(own.ready.plain && !everything.ready.plain);
    for (int batch = 0; batch < 8; batch++) {
        make_rays(rays, both_sides);
        ask(&all, rays, &everything);
        ask(&some, rays, &own);
        assert_same_light(&some.light, &all.light, rays->count);
        assert_memory_equal(some.light.path, all.light.path,
                            (size_t)rays->count * sizeof *all.light.path);
        int32_t any = 0;
        for (int i = 0; i < rays->count; i++) any |= all.light.a[i] > 0;
        assert_int_equal(all.met, any);
        assert_int_equal(some.met, any);
        assert_true(some.footprint.met == all.footprint.met);
        if (!sized) { /* else lamps that are asked count as if they shone */
            assert_true(some.footprint.faced == all.footprint.faced);
            assert_true(some.footprint.lit == all.footprint.lit);
        }
        compare_ways(&all, rays, &own, sum);
    }
    close_stage(&everything);
    close_stage(&own);
}

/* In both precisions, by the widest instructions and without any. */
static void test_rooms(void **state) {
    (void)state;
    enum { ROOMS = 150 };
    static test_scene s;
    static zt_rays rays;
    zt_ray_counts sum = {0};
    for (int room = 0; room < ROOMS; room++) {
        bool sized = chance(.2);
        make_room(&s, sized);
        zt_exposure exposure = zt_exposure_of(&s.scene);
        setenv("ZOETROPE_ISA", room % 3 ? "" : "scalar", 1);
        EACH_PRECISION compare(&rays, &exposure, sized, false, &sum);
    }
    unsetenv("ZOETROPE_ISA");
    print_message("of %d batches %d met nothing, %d one flat thing alone\n", (int)sum.batches,
                  (int)sum.bare_batches, (int)sum.flat_batches);
    assert_true(sum.bare_batches > sum.batches / 40);
    assert_true(sum.flat_batches > sum.batches / 40);
}

/* One wall that the rays of a batch come to from both of its sides, with lamps on each. */
static void test_both_sides(void **state) {
    (void)state;
    enum { WALLS = 20 };
    static test_scene s;
    static zt_rays rays;
    zt_ray_counts sum = {0};
    for (int wall = 0; wall < WALLS; wall++) {
        scene_begin(&s);
        scene_material(&s, (vec3){.9, .5, .7}, wall % 2 ? .5 : 0);
        scene_plane(&s, test_direction(&seed), 0, 0);
        add_lamps(&s, false);
        scene_ambient(&s, white, .2);
        s.scene.reflection_depth = 2;
        zt_exposure exposure = zt_exposure_of(&s.scene);
        EACH_PRECISION compare(&rays, &exposure, false, true, &sum);
    }
    /* All meet it, and together they lie on one side of it only where there is one of them. */
    assert_int_equal(sum.bare_batches, 0);
    assert_true(sum.flat_batches < sum.batches / 40);
}

/* Of mostly empty pictures tiles are left out before there are rays: small things, planes that
 * end at a horizon and single panes, near and far, are all there nevertheless. */
static void make_emptiness(test_scene *s) {
    scene_begin(s);
    scene_material(s, (vec3){1, .5, .3}, 0);
    scene_material(s, white, .5);
    if (chance(.3)) scene_plane(s, test_direction(&seed), between(-2, 2), 0);
    double scale = pow(10, between(-3, 6));
    for (int i = (int)between(0, 4); i > 0; i--) {
        vec3 at = vec3_scale(somewhere(6), scale);
        double radius = scale * between(.001, .2);
        if (chance(.5))
            scene_sphere(s, at, radius, i % 2);
        else
            scene_triangle(s, at, vec3_add(at, somewhere(radius)),
                           vec3_add(at, somewhere(10 * radius)), i % 2);
    }
    scene_ambient(s, white, 1);
    zt_camera *camera = &s->scene.camera;
    camera->position = vec3_scale(somewhere(1), scale);
    camera->rotation = quat_axis_angle(test_direction(&seed), between(-3, 3));
    s->scene.reflection_depth = 2;
}

static void test_empty_tiles(void **state) {
    (void)state;
    enum { PICTURES = 400, WIDTH = 100, HEIGHT = 72, SAMPLES = 4 };
    static test_scene s;
    int64_t left_out = 0, lit = 0;
    for (int i = 0; i < PICTURES; i++) {
        make_emptiness(&s);
        zt_exposure exposure = zt_exposure_of(&s.scene);
        zt_sampling sampling = {.seed = (uint32_t)i};
        sampling.min = sampling.max = i % 2 ? 1 : SAMPLES;
        precision = i % 4 < 2 ? ZT_PRECISION_SINGLE : ZT_PRECISION_DOUBLE;
        zt_render_count count;
        setenv("ZOETROPE_EVERYTHING", "1", 1);
        zt_image *all = render_exposure(&count, &exposure, WIDTH, HEIGHT, sampling, 2);
        assert_int_equal(count.rays.primary, (int64_t)WIDTH * HEIGHT * sampling.max);
        unsetenv("ZOETROPE_EVERYTHING");
        zt_image *own = render_exposure(&count, &exposure, WIDTH, HEIGHT, sampling, 2);
        assert_int_equal(count.rays.primary + count.rays.primary_avoided,
                         (int64_t)WIDTH * HEIGHT * sampling.max);
        assert_memory_equal(own->pixels, all->pixels, 4 * WIDTH * HEIGHT * sizeof *all->pixels);
        left_out += count.rays.primary_avoided > 0;
        for (int k = 0; k < WIDTH * HEIGHT; k++) lit += all->pixels[4 * k] > 0;
        zt_image_free(&all);
        zt_image_free(&own);
    }
    print_message("%d of %d pictures have tiles that are left out; %d pixels are not empty\n",
                  (int)left_out, PICTURES, (int)lit);
    assert_true(left_out > PICTURES / 2);
    assert_true(lit > PICTURES * 20);
}

int main(int count, char **arguments) {
    if (count > 1) seed = strtoull(arguments[1], NULL, 10);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rooms),
                                       cmocka_unit_test(test_both_sides),
                                       cmocka_unit_test(test_empty_tiles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
