/* What bundles pass by, what hulls turn away and what hierarchies do not look at is met by no
 * ray: the bits are those of a plain loop over all primitives and all triangles. Compiled once
 * for each precision. A number given to the program draws other scenes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define ZT_ISA base
#include "plain_loop.h"

extern const zt_kernel ZT_KERNEL_NAME(zt_kernel);

/* ---- comparing ----------------------------------------------------------------------------
 */

static int met[ZT_PRIMITIVE_KIND_COUNT], passed, hidden, open, mirrored, leaving_one, outlines;

static zt_bundle bundle_of(const zt_batch *rays, int32_t source) {
    const zt_origins *o = rays->from;
    return (zt_bundle){.origins = zt_range3(o->x, o->y, o->z, rays->count),
                       .directions = zt_range3(rays->dx, rays->dy, rays->dz, rays->count),
                       .source = source};
}

/* The primitive on which all rays begin, none of them inside it, or -1. */
static int32_t source_of(const zt_batch *rays) {
    int32_t source = rays->from->source[0];
    for (int i = 0; i < rays->count; i++)
        if (rays->from->source[i] != source) return -1;
    return source >= 0 && source % 2 == 0 ? source / 2 : -1;
}

static void tell(const zt_batch *rays, const stage *st, int i, const zt_batch *wanted) {
    int32_t hit = rays->hit[i], other = wanted->hit[i];
    printf("ray %d: o %.17g %.17g %.17g d %.17g %.17g %.17g source %d\n", i,
           (double)rays->from->x[i], (double)rays->from->y[i], (double)rays->from->z[i],
           (double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i],
           rays->from->source[i]);
    printf("  got %d (kind %d) at %.17g, wanted %d (kind %d) at %.17g; crowd %d\n", hit,
           hit < 0 ? -1 : (int)st->tracer->primitives[hit].kind, (double)rays->t[i], other,
           other < 0 || other == INT32_MAX ? -1 : (int)st->tracer->primitives[other].kind,
           (double)wanted->t[i], st->tracer->crowd_count > 0);
}

static void compare_nearest(zt_batch *rays, const stage *st) {
    static zt_batch wanted;
    wanted = *rays;
    plain_nearest(&wanted, st);
    int32_t source = source_of(rays);
    leaving_one += source >= 0;
    zt_bundle bundle = bundle_of(rays, source);
    ZT_KERNEL_NAME(zt_intersect)(rays, &bundle, st->tracer);
    for (int i = 0; i < rays->count; i++) {
        int32_t hit = rays->hit[i];
        bool mesh = hit >= 0 && st->tracer->primitives[hit].kind == ZT_PRIMITIVE_MESH;
        /* Of layers within a rounding of each other any may be told. */
        bool layer = rays->part[i] >= PARTS - LAYERS && wanted.part[i] >= PARTS - LAYERS;
        bool same = hit == wanted.hit[i] && rays->t[i] == wanted.t[i] &&
                    (!mesh || layer || rays->part[i] == wanted.part[i]);
        if (!same) tell(rays, st, i, &wanted);
        assert_true(same);
        if (hit >= 0)
            met[st->tracer->primitives[hit].kind]++;
        else
            passed++;
    }
    bool any = false;
    for (int i = 0; i < rays->count; i++) any |= wanted.hit[i] >= 0;
    if (any) assert_true(ZT_KERNEL_NAME(zt_may_meet)(&bundle, st->tracer));
}

/* The shadow rays from where the others begin to a lamp. */
static void compare_shadows(const zt_batch *rays, const stage *st, real3 lamp) {
    static zt_batch shadow, wanted;
    const zt_origins *o = rays->from;
    shadow = *rays;
    for (int i = 0; i < rays->count; i++) {
        real x = lamp.x - o->x[i], y = lamp.y - o->y[i], z = lamp.z - o->z[i];
        real distance = real_sqrt(real_dot(x, y, z, x, y, z));
        shadow.dx[i] = x / distance, shadow.dy[i] = y / distance, shadow.dz[i] = z / distance;
        shadow.t[i] = i % 9 ? distance : 0; /* such a ray looks nowhere */
        shadow.hit[i] = -1;
    }
    wanted = shadow;
    plain_any(&wanted, st);
    zt_bundle bundle = zt_bundle_to(zt_range3(o->x, o->y, o->z, rays->count),
                                    (zt_box){lamp, lamp}, source_of(rays));
    bool may = ZT_KERNEL_NAME(zt_may_meet)(&bundle, st->tracer);
    ZT_KERNEL_NAME(zt_occlude)(&shadow, &bundle, st->tracer);
    for (int i = 0; i < rays->count; i++) {
        bool same = (shadow.hit[i] >= 0) == (wanted.hit[i] >= 0);
        if (!same) tell(&shadow, st, i, &wanted);
        assert_true(same);
        hidden += wanted.hit[i] >= 0;
        open += wanted.hit[i] < 0;
        assert_true(may || wanted.hit[i] < 0);
    }
}

/* ---- rays ---------------------------------------------------------------------------------
 */

static zt_origins from;
static zt_batch rays;
static double times[ZT_BATCH]; /* of rays, where something moves */

/* At one time all, or each at its own. */
static void set_times(uint64_t *seed) {
    double time = test_random(seed);
    bool one = test_random(seed) < .3;
    for (int i = 0; i < ZT_BATCH; i++)
        times[i] = floor((one ? time : test_random(seed)) * 65536) / 65536;
}

static void set_moments(const stage *st) {
    if (!st->tracer->moves) return;
    for (int i = 0; i < ZT_BATCH; i++)
        from.between[i] = (real)zt_exposure_find(&from.moment[i], &st->exposure,
                                                 st->tracer->moment_at, times[i]);
}

static void set_ray(int i, vec3 o, vec3 d, int32_t source) {
    from.x[i] = (real)o.x, from.y[i] = (real)o.y, from.z[i] = (real)o.z;
    from.near[i] = (real)vec3_max_abs(o) * TIE;
    from.source[i] = source;
    rays.dx[i] = (real)d.x, rays.dy[i] = (real)d.y, rays.dz[i] = (real)d.z;
}

/* Rays from the camera: narrow, wide, along an axis; to one of the things or anywhere. */
static void camera_rays(uint64_t *seed, int batch, const stage *st) {
    rays.from = &from;
    set_times(seed);
    set_moments(st);
    rays.count = 1 + (int)(test_random(seed) * ZT_BATCH);
    vec3 along = test_direction(seed);
    const zt_primitive *p =
        &st->tracer->primitives[(int32_t)(test_random(seed) * st->tracer->primitive_count)];
    if (batch % 2 && p->kind != ZT_PRIMITIVE_PLANE)
        along = vec3_normalize((vec3){(double)(p->box.low.x + p->box.high.x),
                                      (double)(p->box.low.y + p->box.high.y),
                                      (double)(p->box.low.z + p->box.high.z)});
    double spread = exp(test_between(seed, -6, 1));
    for (int i = 0; i < rays.count; i++) {
        vec3 d = vec3_normalize(vec3_add(along, vec3_scale(test_direction(seed), spread)));
        if (batch % 7 == 6) d = (vec3){0, 0, i % 2 ? 1 : -1};
        set_ray(i, (vec3){0, 0, 0}, d, -1);
    }
}

/* Rays to corners of meshes, or rather as far inside of a triangle as the share says. */
static void corner_rays(uint64_t *seed, const stage *st, double inside) {
    const zt_placed_mesh *m =
        &st->tracer->placed[(int)(test_random(seed) * st->tracer->placed_count)];
    int part = (int)(test_random(seed) * PARTS), which = (int)(test_random(seed) * 3);
    for (int i = 0; i < rays.count; i++) {
        vec3 corners[3], aim = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            const float *v = positions + 3 * (size_t)whole[3 * part + (which + k) % 3];
            corners[k] = (vec3){(double)v[0], (double)v[1], (double)v[2]};
            aim = vec3_add(aim, vec3_scale(corners[k], k ? inside / 2 : 1 - inside));
        }
        set_ray(i, (vec3){0, 0, 0}, vec3_normalize(xform_point(&m->place, aim)), -1);
        if (i % 3 == 2) part = (int)(test_random(seed) * PARTS), which = i % 3;
    }
}

/* Makes what were rays to something, and others that met something else or nothing, the last
 * ones on the way from those to these that still meet what those met: rays along an outline. */
static void outline_rays(uint64_t *seed, const stage *st) {
    enum { STEPS = 2 + (int)(8 * sizeof(real)) };
    static zt_batch within, without;
    camera_rays(seed, 1, st);
    rays.count = rays.count < 24 ? rays.count : 24;
    bool corners = st->tracer->placed_count > 0 && test_random(seed) < .5;
    uint64_t before = *seed;
    if (corners) corner_rays(seed, st, .01);
    within = rays;
    plain_nearest(&within, st);
    if (corners) {
        *seed = before;
        corner_rays(seed, st, -.01);
    }
    for (int i = 0; i < rays.count && !corners; i++) {
        vec3 d = {(double)rays.dx[i], (double)rays.dy[i], (double)rays.dz[i]};
        double spread = exp(test_between(seed, -4, 1));
        d = vec3_normalize(vec3_add(d, vec3_scale(test_direction(seed), spread)));
        set_ray(i, (vec3){0, 0, 0}, d, -1);
    }
    without = rays;
    plain_nearest(&without, st);
    int count = 0;
    for (int i = 0; i < rays.count; i++) {
        if (within.hit[i] == without.hit[i]) continue;
        within.hit[count] = within.hit[i];
        within.dx[count] = within.dx[i], without.dx[count] = without.dx[i];
        within.dy[count] = within.dy[i], without.dy[count] = without.dy[i];
        within.dz[count] = within.dz[i], without.dz[count] = without.dz[i];
        times[count] = times[i];
        count++;
    }
    set_moments(st);
    rays.count = count;
    for (int step = 0; step < STEPS; step++) {
        for (int i = 0; i < count; i++) {
            vec3 a = {(double)within.dx[i], (double)within.dy[i], (double)within.dz[i]};
            vec3 b = {(double)without.dx[i], (double)without.dy[i], (double)without.dz[i]};
            set_ray(i, (vec3){0, 0, 0}, vec3_normalize(vec3_add(a, b)), -1);
        }
        plain_nearest(&rays, st);
        for (int i = 0; i < count; i++) {
            zt_batch *side = rays.hit[i] == within.hit[i] ? &within : &without;
            side->dx[i] = rays.dx[i], side->dy[i] = rays.dy[i], side->dz[i] = rays.dz[i];
        }
    }
    /* As few, now and then, as make the narrowest bundles. */
    if (test_random(seed) < .7) rays.count = count = count < 3 ? count : 3;
    for (int i = 0; i < count; i++)
        rays.dx[i] = within.dx[i], rays.dy[i] = within.dy[i], rays.dz[i] = within.dz[i];
    outlines += count;
}

/* Where the kernel itself says that mirrored rays go on: all of those that hit something, or
 * only those from the thing that the first one hit. */
static void mirror_rays(zt_probe *probes, const stage *st, void *work, bool one) {
    for (int i = 0; i < rays.count; i++)
        probes[i] = (zt_probe){
            .origin = {(double)from.x[i], (double)from.y[i], (double)from.z[i]},
            .direction = {(double)rays.dx[i], (double)rays.dy[i], (double)rays.dz[i]},
            .time = times[i],
            .source = from.source[i]};
    ZT_KERNEL_NAME(zt_kernel).probe(st->tracer, probes, rays.count, work);
    int count = 0;
    int32_t first = -1;
    for (int i = 0; i < rays.count; i++) {
        const zt_probe *p = &probes[i];
        if (p->object < 0) continue;
        if (first < 0) first = p->object;
        if (one && p->object != first) continue;
        times[count] = times[i];
        set_ray(count++, p->mirror_origin, p->mirror_direction, p->mirror_source);
    }
    rays.count = count;
    set_moments(st);
}

static void compare_film(uint64_t *seed, int rounds, int least, int most, int batches,
                         bool moves) {
    static test_scene s[MOMENTS_MAX];
    static stage st;
    static zt_probe probes[ZT_BATCH];
    void *work = aligned_alloc(64, (ZT_KERNEL_NAME(zt_kernel).work_size + 63) / 64 * 64);
    assert_non_null(work);
    assert_int_equal(zt_meshes_open(&st.meshes, models, MODELS, 1, (zt_listener){0}), ZT_OK);
    assert_int_equal(zt_meshes_open(&st.piece_meshes, models, MODELS, 1, (zt_listener){0}),
                     ZT_OK);
    for (int round = 0; round < rounds; round++) {
        int moments = moves ? 2 + round % 3 : 1,
            things = least + (int)(test_random(seed) * (most - least + 1));
        uint64_t before = *seed, way = before + 5;
        for (int m = 0; m < moments; m++) {
            *seed = before;
            make_scene(&s[m], seed, things);
            if (m > 0) carry(&s[m], way, .4 * m / (moments - 1));
        }
        set_stage(&st, s, moments);
        if (!moves) assert_true(st.tracer->tie == 0);
        for (int batch = 0; batch < batches; batch++) {
            if (batch % 2)
                outline_rays(seed, &st);
            else
                camera_rays(seed, batch / 2, &st);
            if (rays.count == 0) continue;
            compare_nearest(&rays, &st);
            for (int depth = 0; depth < 3; depth++) {
                mirror_rays(probes, &st, work, batch % 3 == 0);
                if (rays.count == 0) break;
                for (int32_t l = 0; l < st.tracer->lamp_count; l++)
                    compare_shadows(&rays, &st, st.tracer->lamps[l].poses->position);
                compare_nearest(&rays, &st);
                mirrored += rays.count;
            }
        }
        zt_arena_free(&st.arena);
    }
    zt_meshes_close(&st.meshes);
    zt_meshes_close(&st.piece_meshes);
    free(work);
}

static void assert_all_met(void) {
    printf("met by kind:");
    for (int k = 0; k < ZT_PRIMITIVE_KIND_COUNT; k++) printf(" %d", met[k]);
    printf("; %d passed, %d hidden, %d open, %d mirrored, %d bundles from one thing, "
           "%d along outlines\n",
           passed, hidden, open, mirrored, leaving_one, outlines);
    for (int k = 0; k < ZT_PRIMITIVE_KIND_COUNT; k++) assert_true(met[k] > 150);
    assert_true(passed > 10000 && hidden > 10000 && open > 10000 && mirrored > 10000);
    assert_true(leaving_one > 100 && outlines > 1000);
    memset(met, 0, sizeof met);
    passed = hidden = open = mirrored = leaving_one = outlines = 0;
}

static uint64_t more; /* other numbers than the usual ones */

/* Few things, which are asked one by one. */
static void test_few(void **state) {
    (void)state;
    uint64_t seed = 1 + more;
    make_models(&seed);
    compare_film(&seed, 250, 1, 20, 16, false);
    assert_all_met();
}

/* So many that a hierarchy tells where to look. */
static void test_crowd(void **state) {
    (void)state;
    uint64_t seed = 2 + more;
    make_models(&seed);
    compare_film(&seed, 60, 50, 120, 16, false);
    assert_all_met();
}

/* The same of what moves: each ray at its own time. */
static void test_moving(void **state) {
    (void)state;
    uint64_t seed = 3 + more;
    make_models(&seed);
    compare_film(&seed, 80, 1, 20, 16, true);
    compare_film(&seed, 12, 50, 120, 16, true);
    assert_all_met();
}

int main(int count, char **arguments) {
    if (count > 1) more = (uint64_t)atoll(arguments[1]);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_few), cmocka_unit_test(test_crowd),
                                       cmocka_unit_test(test_moving)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
