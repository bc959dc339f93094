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
#include "scene/needs.h"
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
    /* When: a fraction of the shutter's opening. Read where the tracer moves. */
    alignas(64) float time[ZT_BATCH];
    /* Random numbers for lamps with a size are keyed by these (tracer/sampler.h): those of the
     * ray's pixel in this frame, and which sample it is. Read where there are such lamps. */
    alignas(64) uint32_t key[ZT_BATCH];
    alignas(64) uint32_t sample[ZT_BATCH];
    int count;
    /* What is asked for of zt_radiance besides the light: paths, which tell things and lamps by
     * these numbers, or NULL; and cover. */
    const struct zt_labels *labels;
    bool wants_cover;
    /* Grows by what the rays touch of this outline, which is the tracer's; NULL: nobody asks.
     */
    struct zt_footprint *footprint;
    const struct zt_outline *outline;
} zt_rays;

/* How many rays of each kind were traced; and how many were not, of all that there are where
 * from each point one goes to each lamp and, up to the scene's depth, a mirrored one goes on.
 * And how many batches that took, how many of these met nothing, and how many only one flat
 * thing that nothing shadows and that does not reflect. */
typedef struct zt_ray_counts {
    int64_t primary, shadow, mirror;
    int64_t primary_avoided, shadow_avoided, mirror_avoided;
    int64_t batches, bare_batches, flat_batches;
} zt_ray_counts;

static inline void zt_ray_counts_add(zt_ray_counts *sum, const zt_ray_counts *counts) {
    sum->primary += counts->primary;
    sum->shadow += counts->shadow;
    sum->mirror += counts->mirror;
    sum->primary_avoided += counts->primary_avoided;
    sum->shadow_avoided += counts->shadow_avoided;
    sum->mirror_avoided += counts->mirror_avoided;
    sum->batches += counts->batches;
    sum->bare_batches += counts->bare_batches;
    sum->flat_batches += counts->flat_batches;
}

/* Linear light for each ray. */
typedef struct zt_radiance {
    alignas(64) float r[ZT_BATCH];
    alignas(64) float g[ZT_BATCH];
    alignas(64) float b[ZT_BATCH];
    /* Of what the ray saw, where asked for: the same for two rays where they and their mirrored
     * rays met the same things, of those with edges the same faces and of patterns the same
     * cells, and the same lamps are hidden from there. */
    alignas(64) uint32_t path[ZT_BATCH];
    alignas(64) float a[ZT_BATCH]; /* where asked for: 1 of a ray that met something, or 0 */
    zt_ray_counts counts;          /* added to */
} zt_radiance;

/* One ray asked about by itself. `source` is -1 for a ray that begins anywhere, or what
 * `mirror_source` was for the ray that is mirrored. Space is relative to the camera. */
typedef struct zt_probe {
    vec3 origin, direction; /* of any length but zero */
    double time;            /* a fraction of the shutter's opening */
    int32_t source;
    /* As in zt_rays, and how many mirrors came before (for all that are asked at once as for
     * the first): which places of lamps with a size are asked about. */
    uint32_t key, sample;
    int32_t depth;
    bool unlit;        /* lamps are not asked for, likewise: nothing is said of them */
    vec3 *lamp_points; /* NULL, or room for one for each light of the scene */
    /* The answer. `object` is an index in the scene, or -1 where nothing is hit: then the rest
     * says nothing. */
    int32_t object;
    int32_t part;       /* of a mesh: which triangle, else -1 */
    double distance;    /* in the unit of space */
    vec3 point, normal; /* the normal is unit and faces the ray's origin */
    vec3 color;         /* of the surface there */
    uint64_t lit;       /* bit i: nothing hides the scene's light number i (< 64, not an ambient
                           one; the surface faces it) */
    /* lamp_points[i]: where on that light was looked, where the surface faces it. */
    vec3 mirror_origin, mirror_direction; /* how the mirrored ray would go on */
    int32_t mirror_source;
} zt_probe;

typedef struct zt_tracer zt_tracer;

/* Follows rays; returns false where none met anything, so that all light is 0. */
typedef bool zt_trace(zt_radiance *light, const zt_tracer *tracer, const zt_rays *rays,
                      void *work);

/* What there is once for each width of instructions and each precision. */
typedef struct zt_kernel {
    zt_trace *trace;
    /* The same without what most frames miss: for scenes that are plain (zt_ready), and rays of
     * which neither path nor footprint is asked for. */
    zt_trace *trace_plain;
    /* False only where no ray from the camera's own place meets anything whose direction, of
     * any length, lies between two. */
    bool (*may_meet)(const zt_tracer *tracer, vec3 low, vec3 high);
    void (*probe)(const zt_tracer *tracer, zt_probe *probes, int count, void *work);
    size_t work_size; /* of what a thread works with, aligned to 64 bytes */
} zt_kernel;

/* A scene made ready, and why it was made in which precision. Lives in the frame's arena. */
typedef struct zt_ready {
    const zt_tracer *tracer;
    const zt_kernel *kernel;
    zt_precision precision; /* not ZT_PRECISION_AUTO */
    /* What asks for double: FINE where nobody asked (double was wanted); and what asks for more
     * than double, where that was chosen. */
    zt_accuracy accuracy, beyond;
    zt_needs needs;
    bool moves;  /* something moves while the shutter is open, the camera left aside */
    bool plain;  /* that is not so, and what is not needed is left out */
    bool random; /* there are lamps with a size: light is a mean over random numbers */
} zt_ready;

/* Prepares an exposure for a picture. Space is relative to the camera of the first moment.
 * The kernel is the one for the widest instructions that this machine has, or that the
 * environment variable ZOETROPE_ISA names: scalar, base, avx2 or avx512. Where the environment
 * variable ZOETROPE_EVERYTHING is 1 nothing is left out that changes nothing. */
zt_status zt_tracer_prepare(zt_ready *ready, const zt_exposure *exposure,
                            zt_precision precision, zt_pixel pixel, zt_meshes *meshes,
                            zt_arena *arena);

/* What a thread works with, whatever the kernel: bytes, aligned to 64. */
size_t zt_kernel_work_size(void);

#endif
