#include "run.h"

#include <stdio.h>
#include <string.h>

#include "base/clock.h"
#include "base/hash.h"

typedef struct running {
    const extreme_case *c;
    stage stage;
    zt_arena arena; /* of the reference */
    ref_scene ref;
    ref_hit expected[STAGE_RAYS_MAX];
    probe probes[STAGE_RAYS_MAX];
    ref_ray rays[STAGE_RAYS_MAX];
} running;

static uint64_t key_of(const char *name, int scene) {
    return zt_random_key(zt_hash_bytes(name, strlen(name)).low, (uint64_t)scene);
}

/* Mixes what the tracer said into a digest. */
static uint64_t digest(uint64_t before, const probe *p) {
    struct {
        double t;
        vec3 point, normal, origin, direction;
        int32_t object, part;
        uint64_t lights;
    } said = {p->t,      p->point, p->normal, p->next_origin, p->next_direction,
              p->object, p->part,  p->lights};
    if (p->object < 0) memset(&said, 0xff, sizeof said);
    return zt_random_key(before, zt_hash_bytes(&said, sizeof said).low);
}

/* The rays of the stage, and of those that follow from their answers. */
static void follow(running *r, probe_tracer *tracer, const judge *j, run_how how,
                   uint64_t *sum) {
    int count = r->stage.ray_count;
    for (int i = 0; i < count; i++) {
        r->probes[i] = (probe){
            .origin = r->stage.origins[i], .direction = r->stage.directions[i], .source = -1};
        r->rays[i] =
            (ref_ray){real3_of(r->stage.origins[i]), real3_of(r->stage.directions[i]), -1, -1};
    }
    for (int bounce = 0; count > 0; bounce++) {
        double begin = zt_clock_s();
        probe_run(tracer, r->probes, count);
        j->tally->seconds += zt_clock_s() - begin;
        int next = 0;
        for (int i = 0; i < count; i++) {
            const probe *a = &r->probes[i];
            *sum = digest(*sum, a);
            if (how != RUN_ANSWERS) {
                ref_hit expected = bounce ? ref_nearest(&r->ref, &r->rays[i]) : r->expected[i];
                judge_probe(j, &r->rays[i], expected, a);
            }
            if (a->object < 0 || !isfinite(vec3_max_abs(a->next_direction))) continue;
            r->rays[next] = (ref_ray){real3_of(a->next_origin), real3_of(a->next_direction),
                                      a->object, a->part};
            r->probes[next++] = probe_next(a);
        }
        count = bounce < r->c->bounces ? next : 0;
    }
}

static bool run_scene(running *r, run_result *result, int number, run_how how) {
    const extreme_case *c = r->c;
    draw d = {key_of(c->name, number), 0};
    stage_begin(&r->stage, c->rays);
    c->make(&r->stage, &d, c->extreme);
    zt_arena_reset(&r->arena);
    if (!ref_prepare(&r->ref, &r->stage.s.scene, &r->arena)) return false;
    for (int i = 0; how != RUN_ANSWERS && i < r->stage.ray_count; i++) {
        ref_ray ray = {real3_of(r->stage.origins[i]), real3_of(r->stage.directions[i]), -1, -1};
        r->expected[i] = ref_nearest(&r->ref, &ray);
    }
    for (int i = 0; i < PROBE_PRECISIONS; i++) {
        if (!result->asked[i]) continue;
        probe_precision chosen;
        probe_tracer *tracer = probe_open(&r->stage.s.scene, (probe_precision)i, &chosen);
        if (!tracer) return false;
        if (i == PROBE_AUTO) result->chose_single += chosen == PROBE_SINGLE;
        judge j = {.ref = &r->ref,
                   .tolerance = run_tolerance(chosen),
                   .strict = c->flags & CASE_STRICT,
                   .closed = c->flags & CASE_CLOSED,
                   .lights = true,
                   .verbose = how == RUN_TOLD,
                   .name = c->name,
                   .scene = number,
                   .how = (const char *[]){"single", "double", "auto"}[i],
                   .tally = &result->tallies[i]};
        follow(r, tracer, &j, how, &result->digest[i]);
        probe_close(&tracer);
    }
    result->scenes++;
    return true;
}

bool run_case(run_result *result, const extreme_case *c, int first, int count,
              unsigned precisions, run_how how) {
    static running r; /* large, and one at a time */
    r.c = c;
    bool ok = true;
    *result = (run_result){0};
    for (int i = 0; i < PROBE_PRECISIONS; i++) result->asked[i] = precisions >> i & 1;
    const bool is_short = first < 0;
    if (is_short) first = 0;
    if (count == 0) count = c->scenes;
    for (int i = first; ok && i < first + count; i++) ok = run_scene(&r, result, i, how);
    for (const int *i = cases_nasty_again; is_short && c == cases_nasty && ok && *i >= 0; i++)
        ok = run_scene(&r, result, *i, how);
    zt_arena_free(&r.arena);
    zt_arena_free(&r.stage.arena);
    return ok;
}
