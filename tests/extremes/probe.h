/* The door to the tracer under test: rays in, what it says of them out. All in doubles,
 * relative to the camera; nothing else of the suite sees the tracer. */
#ifndef ZT_TESTS_PROBE_H
#define ZT_TESTS_PROBE_H

#include <stdbool.h>
#include <stdint.h>

#include "scene/scene.h"

typedef enum probe_precision {
    PROBE_SINGLE,
    PROBE_DOUBLE,
    PROBE_AUTO,
    PROBE_PRECISIONS
} probe_precision;

typedef struct probe {
    vec3 origin, direction; /* the ray, direction of length 1 */
    int32_t source;         /* -1, or `next_source` of the probe that it goes on from */

    int32_t object, part; /* what it hits, -1 for nothing; part is the triangle of a mesh */
    double t;
    vec3 point, normal;
    uint32_t lights;                  /* bit i: the i-th point light reaches the point */
    vec3 next_origin, next_direction; /* the mirrored ray */
    int32_t next_source;
} probe;

/* The mirrored ray of a probe that hit something. */
static inline probe probe_next(const probe *p) {
    return (probe){
        .origin = p->next_origin, .direction = p->next_direction, .source = p->next_source};
}

typedef struct probe_tracer probe_tracer;

/* Opens the tracer for a scene; `meshes` of it must outlive the tracer. NULL where it cannot be
 * opened. *chosen is single or double. */
probe_tracer *probe_open(const zt_scene *scene, probe_precision precision,
                         probe_precision *chosen);
void probe_run(probe_tracer *tracer, probe *probes, int count);
void probe_close(probe_tracer **tracer);

/* Renders a picture (width * height * 4 floats) on so many threads; how many samples were not
 * finite and left out, -1 where it failed. */
int64_t probe_render(float *pixels, const zt_scene *scene, probe_precision precision, int width,
                     int height, int threads);

#endif
