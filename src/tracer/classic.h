/* The classic integrator: the light seen along a batch of rays, in the model of the first
 * ray tracer (Whitted's mirrors, shadows and point lights, "An improved illumination model for
 * shaded display", CACM 23(6), 1980) with light fading by the square of the distance. */
#ifndef ZT_TRACER_CLASSIC_H
#define ZT_TRACER_CLASSIC_H

#include "tracer/tracer.h"

/* What one thread needs besides the rays; its contents mean nothing between calls. */
typedef struct zt_classic_work {
    /* The paths that hit something, compacted: which ray they began as, how much of their light
     * arrives, the direction they came along, and the surface there. */
    alignas(64) int32_t pixel[ZT_BATCH];
    alignas(64) real weight[ZT_BATCH];
    alignas(64) int32_t primitive[ZT_BATCH];
    alignas(64) int32_t part[ZT_BATCH];
    alignas(64) real dx[ZT_BATCH];
    alignas(64) real dy[ZT_BATCH];
    alignas(64) real dz[ZT_BATCH];
    alignas(64) real px[ZT_BATCH];
    alignas(64) real py[ZT_BATCH];
    alignas(64) real pz[ZT_BATCH];
    alignas(64) real nx[ZT_BATCH];
    alignas(64) real ny[ZT_BATCH];
    alignas(64) real nz[ZT_BATCH];
    alignas(64) real margin[ZT_BATCH]; /* how far off the surface further rays begin */
    alignas(64) real color_r[ZT_BATCH];
    alignas(64) real color_g[ZT_BATCH];
    alignas(64) real color_b[ZT_BATCH];
    alignas(64) real reflectivity[ZT_BATCH];
    /* Light at those points: of all lamps so far, and of one lamp. */
    alignas(64) real sum_r[ZT_BATCH];
    alignas(64) real sum_g[ZT_BATCH];
    alignas(64) real sum_b[ZT_BATCH];
    alignas(64) real lamp_r[ZT_BATCH];
    alignas(64) real lamp_g[ZT_BATCH];
    alignas(64) real lamp_b[ZT_BATCH];
    alignas(64) int32_t wanted[ZT_BATCH]; /* which of them go on */
    alignas(64) int32_t list[ZT_BATCH];   /* the numbers of those */
    zt_batch shadow;
    int count; /* points */
} zt_classic_work;

/* Linear light for each ray of a batch. */
typedef struct zt_radiance {
    alignas(64) real r[ZT_BATCH];
    alignas(64) real g[ZT_BATCH];
    alignas(64) real b[ZT_BATCH];
} zt_radiance;

/* Traces rays (origins, directions and count given; t is set here). For each hit:
 *     ambient * color
 *   + for each point light, each channel cut to 0..1:
 *         power / d^2 * |v . n| * color, none where the light is behind the surface or hidden
 *   + reflectivity * what is seen along the mirrored ray, to the scene's depth
 * Nothing hit is black. The normal n faces the side that the ray came from. */
typedef void zt_classic_trace(zt_radiance *light, const zt_tracer *tracer, zt_batch *rays,
                              zt_classic_work *work);

/* The version of the above for the widest instructions that this machine has, or that the
 * environment variable ZOETROPE_ISA (base, avx2, avx512) asks for. All give the same bits. */
zt_classic_trace *zt_classic_select(void);

#endif
