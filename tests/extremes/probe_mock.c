/* A tracer that answers as the reference does, rounded to its precision, or wrong in a way that
 * is asked for: shows that the judge lets pass what is right, and nothing else. */
#include "probe_mock.h"

#include <stdlib.h>

#include "reference.h"

struct probe_tracer {
    zt_arena arena;
    ref_scene ref;
    bool single;
};

mock_lie probe_mock_lie = MOCK_HONEST;

static double rounded(const probe_tracer *t, real a) {
    return t->single ? (double)(float)(double)a : (double)a;
}
static vec3 rounded3(const probe_tracer *t, real3 a) {
    return (vec3){rounded(t, a.x), rounded(t, a.y), rounded(t, a.z)};
}

probe_tracer *probe_open(const zt_scene *scene, probe_precision precision,
                         probe_precision *chosen) {
    probe_tracer *t = calloc(1, sizeof *t);
    if (!t || !ref_prepare(&t->ref, scene, &t->arena)) return NULL;
    t->single = precision == PROBE_SINGLE;
    *chosen = t->single ? PROBE_SINGLE : PROBE_DOUBLE;
    return t;
}

void probe_close(probe_tracer **tracer) {
    zt_arena_free(&(*tracer)->arena);
    free(*tracer);
    *tracer = NULL;
}

/* A source is an object and a part in one number. */
static int32_t code(const ref_hit *hit) { return hit->object + 4096 * (hit->part + 1); }

static void run(const probe_tracer *t, probe *p) {
    ref_ray ray = {real3_of(p->origin), real3_of(p->direction), -1, -1};
    if (p->source >= 0) {
        ray.source_object = p->source % 4096;
        ray.source_part = p->source / 4096 - 1;
    }
    ref_hit hit = ref_nearest(&t->ref, &ray);
    if (probe_mock_lie == MOCK_MISSES) hit.object = -1;
    p->object = hit.object;
    p->part = hit.part;
    if (hit.object < 0) return;
    if (probe_mock_lie == MOCK_LATE) hit.t *= (real)(1 + 1e-5);
    const ref_primitive *primitive = &t->ref.primitives[hit.object];
    p->t = rounded(t, hit.t);
    real3 point = real3_along(ray.o, hit.t, ray.d), d = real3_unit(ray.d);
    real3 n = ref_nearest_face(primitive, hit.part, point).normal;
    if (real3_dot(n, d) > 0) n = real3_scale(n, -1);
    if (probe_mock_lie == MOCK_TURNED) n = real3_unit(real3_add(n, (real3){1e-4, 0, 1e-4}));
    p->point = rounded3(t, point);
    bool smooth = t->ref.scene->objects[hit.object].smooth;
    if (smooth) { /* of a ball, as it should look */
        vec3 center = t->ref.scene->objects[hit.object].placement.position;
        n = real3_unit(real3_sub(point, real3_of(center)));
    }
    p->normal = rounded3(t, n);
    p->next_origin = p->point;
    n = real3_of(p->normal);
    p->next_direction = rounded3(t, real3_along(d, -2 * real3_dot(d, n), n));
    p->next_source = code(&hit);
    point = real3_of(p->point);
    p->lights = 0;
    for (int32_t i = 0; i < t->ref.scene->light_count; i++) {
        real3 way = real3_sub(t->ref.lights[i], point);
        ref_ray shadow = {point, way, hit.object, hit.part};
        bool sure, lit = real3_dot(way, n) > 0 &&
                         (smooth || !ref_blocked(&sure, &t->ref, &shadow, 1, 0, -1));
        if (probe_mock_lie == MOCK_DARK) lit = false;
        if (probe_mock_lie == MOCK_LIT) lit = true;
        p->lights |= (uint64_t)lit << i;
    }
}

void probe_run(probe_tracer *tracer, probe *probes, int count) {
    for (int i = 0; i < count; i++) run(tracer, &probes[i]);
}

int64_t probe_render(float *pixels, const zt_scene *scene, probe_precision precision, int width,
                     int height, int threads) {
    (void)scene, (void)precision, (void)threads;
    for (int i = 0; i < 4 * width * height; i++) pixels[i] = 0;
    return 0;
}
