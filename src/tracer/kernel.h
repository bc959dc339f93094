/* The tracer as those above it see it: whatever its precision, and whatever the width of the
 * instructions that it runs on. */
#ifndef ZT_TRACER_KERNEL_H
#define ZT_TRACER_KERNEL_H

#include <stdalign.h>
#include <stddef.h>
#include <stdint.h>

#include <zoetrope/precision.h>
#include <zoetrope/status.h>

#include "base/arena.h"
#include "scene/scene.h"
#include "tracer/accuracy.h"
#include "tracer/meshes.h"

/* Rays that travel together, at most: a tile of 16 x 16 pixels. */
enum { ZT_BATCH = 256 };

/* Rays through the camera's lens: origins and directions (of any length) relative to the
 * camera. */
typedef struct zt_rays {
    alignas(64) double ox[ZT_BATCH];
    alignas(64) double oy[ZT_BATCH];
    alignas(64) double oz[ZT_BATCH];
    alignas(64) double dx[ZT_BATCH];
    alignas(64) double dy[ZT_BATCH];
    alignas(64) double dz[ZT_BATCH];
    int count;
} zt_rays;

/* Linear light for each ray. */
typedef struct zt_radiance {
    alignas(64) float r[ZT_BATCH];
    alignas(64) float g[ZT_BATCH];
    alignas(64) float b[ZT_BATCH];
} zt_radiance;

/* One ray asked about by itself. `source` is -1 for a ray that begins anywhere, or what
 * `mirror_source` was for the ray that is mirrored. Space is relative to the camera. */
typedef struct zt_probe {
    vec3 origin, direction; /* of any length but zero */
    int32_t source;
    /* The answer. `object` is an index in the scene, or -1 where nothing is hit: then the rest
     * says nothing. */
    int32_t object;
    int32_t part;       /* of a mesh: which triangle, else -1 */
    double distance;    /* in the unit of space */
    vec3 point, normal; /* the normal is unit and faces the ray's origin */
    uint64_t lit;       /* bit i: nothing hides the scene's light number i (a point light, < 64,
                           before which the surface faces) */
    vec3 mirror_origin, mirror_direction; /* how the mirrored ray would go on */
    int32_t mirror_source;
} zt_probe;

typedef struct zt_tracer zt_tracer;

/* What there is once for each width of instructions and each precision. */
typedef struct zt_kernel {
    void (*trace)(zt_radiance *light, const zt_tracer *tracer, const zt_rays *rays, void *work);
    void (*probe)(const zt_tracer *tracer, zt_probe *probes, int count, void *work);
    size_t work_size; /* of what a thread works with, aligned to 64 bytes */
} zt_kernel;

/* A scene made ready, and why it was made in which precision. Lives in the frame's arena. */
typedef struct zt_ready {
    const zt_tracer *tracer;
    const zt_kernel *kernel;
    zt_precision precision; /* not ZT_PRECISION_AUTO */
    zt_accuracy
        accuracy; /* what asks for double; FINE where nobody asked (double was wanted) */
} zt_ready;

/* Prepares a scene for a picture whose pixels are `pixel` wide at distance 1. The kernel is the
 * one for the widest instructions that this machine has, or that the environment variable
 * ZOETROPE_ISA names: scalar, base, avx2 or avx512. */
zt_status zt_tracer_prepare(zt_ready *ready, const zt_scene *scene, zt_precision precision,
                            double pixel, zt_meshes *meshes, zt_arena *arena);

/* What a thread works with, whatever the kernel: bytes, aligned to 64. */
size_t zt_kernel_work_size(void);

#endif
