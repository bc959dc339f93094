#include "leaks.h"

#include <stdio.h>

#include "base/clock.h"

enum { LEAK_RAYS = 65536, RAYS_A_MESH = 1 << 16 };

const extreme_case leaks_case = {"edges and corners", NULL, 0, 0, 0, 0, CASE_CLOSED};

typedef struct closed_mesh {
    stage stage;
    xform place;
    const zt_mesh *mesh;
    double reach;
} closed_mesh;

/* A convex ball of few or of many triangles, turned, and stretched now and then. */
static void make(closed_mesh *m, draw *d) {
    stage_begin(&m->stage, 0);
    int rings = 2 + draw_below(d, draw_below(d, 2) ? 6 : 60);
    int sectors = 3 + draw_below(d, draw_below(d, 2) ? 6 : 90);
    int32_t number = stage_ball_mesh(&m->stage, 1, rings, sectors, false);
    zt_placement *p = &stage_mesh_object(&m->stage, number, stage_within(d, 10))->placement;
    p->rotation = draw_rotation(d);
    if (draw_below(d, 2))
        p->scale = (vec3){draw_magnitude(d, .1, 10), draw_magnitude(d, .1, 10),
                          draw_magnitude(d, .1, 10)};
    m->place = xform_place(p->position, p->rotation, p->scale);
    m->mesh = &m->stage.meshes[number];
    m->reach = vec3_max_abs(p->scale);
}

/* A ray at a corner or an edge, in a line with a point deep inside, from without or within. */
static void aim(probe *p, double *distance, const closed_mesh *m, draw *d) {
    int32_t triangle = draw_below(d, m->mesh->triangle_count);
    int corner = draw_below(d, 3);
    vec3 a = zt_mesh_corner(m->mesh, triangle, corner);
    vec3 b = zt_mesh_corner(m->mesh, triangle, (corner + 1) % 3);
    double along = draw_below(d, 3) ? draw_unit(d) : 0;
    vec3 to = xform_point(&m->place, vec3_add(a, vec3_scale(vec3_sub(b, a), along)));
    vec3 from = xform_point(&m->place, stage_within(d, .2));
    if (draw_below(d, 2))
        from = vec3_add(to, vec3_scale(vec3_sub(to, from), draw_between(d, .1, 5)));
    vec3 way = vec3_sub(to, from);
    *distance = vec3_length(way);
    *p = (probe){.origin = from, .direction = vec3_normalize(way), .source = -1};
}

static void check(tally *t, const probe *p, double distance, bool verbose, const char *what) {
    t->rays++;
    t->hits += p->object >= 0;
    if (p->object >= 0 && fabs(p->t - distance) <= 1e-4 * (distance + 20)) return;
    if (++t->leaks <= 3 && verbose)
        printf("  leak (%s): (%.17g %.17g %.17g) + t (%.17g %.17g %.17g) at %.17g: t %.17g\n",
               what, p->origin.x, p->origin.y, p->origin.z, p->direction.x, p->direction.y,
               p->direction.z, distance, p->object < 0 ? -1 : p->t);
}

/* Mirrored outward from a convex thing, a ray never comes back to it. Where it runs along a
 * neighbour, roundings of the corners decide: those are left out. */
static bool goes_out(const probe *p, const closed_mesh *m) {
    vec3 from_center = vec3_sub(p->point, m->place.shift);
    if (vec3_dot(from_center, p->normal) < 0) return false; /* hit from within */
    return vec3_dot(p->next_direction, p->normal) > 1e-2;
}

static void run_mesh(tally *t, probe_tracer *tracer, const closed_mesh *m, draw *d, int count,
                     bool verbose, uint64_t *digest) {
    static probe probes[LEAK_RAYS];
    static double distances[LEAK_RAYS];
    for (int i = 0; i < count; i++) aim(&probes[i], &distances[i], m, d);
    double begin = zt_clock_s();
    probe_run(tracer, probes, count);
    t->seconds += zt_clock_s() - begin;
    int next = 0;
    for (int i = 0; i < count; i++) {
        check(t, &probes[i], distances[i], verbose, m->reach > 1 ? "stretched" : "ball");
        *digest = zt_random_key(*digest, (uint64_t)probes[i].part);
        if (probes[i].object >= 0 && goes_out(&probes[i], m))
            probes[next++] = probe_next(&probes[i]);
    }
    probe_run(tracer, probes, next);
    for (int i = 0; i < next; i++)
        if (probes[i].object >= 0 && ++t->wrong <= 3 && verbose)
            printf("  hit twice: (%.17g %.17g %.17g) + t (%.17g %.17g %.17g): t %.17g\n",
                   probes[i].origin.x, probes[i].origin.y, probes[i].origin.z,
                   probes[i].direction.x, probes[i].direction.y, probes[i].direction.z,
                   probes[i].t);
}

bool run_leaks(run_result *result, int64_t rays, run_how how) {
    bool verbose = how == RUN_TOLD;
    static closed_mesh m;
    *result = (run_result){.asked = {true, true, true}};
    int per_mesh = rays < 20 * RAYS_A_MESH ? (int)(rays / 20) : RAYS_A_MESH;
    for (int64_t done = 0, scene = 0; per_mesh > 0 && done < rays; done += per_mesh, scene++)
        for (int i = 0; i < PROBE_PRECISIONS; i++) {
            draw d = {zt_random_key(99, (uint64_t)scene), 0};
            probe_precision chosen;
            make(&m, &d);
            probe_tracer *tracer = probe_open(&m.stage.s.scene, (probe_precision)i, &chosen);
            if (!tracer) return false;
            if (i == PROBE_AUTO) result->chose_single += chosen == PROBE_SINGLE;
            if (i == PROBE_AUTO) result->scenes++;
            run_mesh(&result->tallies[i], tracer, &m, &d, per_mesh, verbose,
                     &result->digest[i]);
            probe_close(&tracer);
        }
    zt_arena_free(&m.stage.arena);
    return true;
}
