/* What a thread works with while a batch goes its way, and what those who move it along share:
 * tracer/classic.c, which follows it; tracer/rays.c, which begins it; tracer/light.c, which
 * lights its points; and tracer/probes.c, which asks about rays one by one. */
#ifndef ZT_TRACER_WORK_H
#define ZT_TRACER_WORK_H

#include "tracer/bundle.h"
#include "tracer/isa.h"
#include "tracer/lamps.h"
#include "tracer/points.h"
#include "tracer/reach.h"

/* What one thread works with; its contents mean nothing between calls. */
typedef struct zt_work {
    zt_origins from; /* of the rays, and then of the shadow rays as well */
    zt_batch rays, shadow;
    zt_box directions; /* bounds of the rays' directions */
    zt_points points;
    /* Light at the points: of all lamps so far, and of one lamp. */
    alignas(64) real sum_r[ZT_BATCH];
    alignas(64) real sum_g[ZT_BATCH];
    alignas(64) real sum_b[ZT_BATCH];
    zt_lamp_light lamp;
    alignas(64) uint32_t hidden[ZT_BATCH]; /* the sum of the labels of lamps that are */
    alignas(64) int32_t wanted[ZT_BATCH];  /* which of the rays or points go on */
    alignas(64) int32_t list[ZT_BATCH];    /* the numbers of those */
    zt_reach_memory reach;
} zt_work;

/* ---- rays (tracer/rays.c)
 * --------------------------------------------------------------------
 */

/* Makes the batch the first rays, with unit directions; `places` of the points are bounds of
 * where these begin. */
void ZT_KERNEL_NAME(zt_work_begin)(zt_work *work, const zt_tracer *tracer,
                                   const zt_rays *given);

/* Lets go of the rays that hit nothing. */
void ZT_KERNEL_NAME(zt_work_keep_hits)(zt_work *work, const zt_tracer *tracer);

/* Loops run over whole groups of lanes: what lies beyond the count is computed and never used,
 * but must be safe to compute. */

static inline bool all_wanted(const zt_work *w, int count) {
    int32_t all = 1;
    for (int i = 0; i < count; i++) all &= w->wanted[i];
    return all;
}

static inline int count_wanted(const zt_work *w, int count) {
    int32_t wanted = 0;
    for (int i = 0; i < count; i++) wanted += w->wanted[i];
    return wanted;
}

/* Compacts, of `count` numbers 0, 1, …, those that are wanted; the rest of the last group of
 * lanes repeats the first. */
static inline int list_wanted(int32_t *restrict list, const int32_t *restrict wanted,
                              int count) {
    int listed = 0;
    for (int i = 0; i < count; i++) {
        list[listed] = i;
        listed += wanted[i];
    }
    for (int i = listed; i < zt_batch_padded(listed); i++) list[i] = list[0];
    return listed;
}

/* Moves what ray i carries through time to place k; numbers in `list` are no less than their
 * places. */
static inline void move_moments(zt_origins *restrict from, const int32_t *restrict list,
                                int count) {
    WIDE_LOOP for (int k = 0; k < count; k++) {
        int32_t i = list[k];
        from->moment[k] = from->moment[i];
        from->between[k] = from->between[i];
    }
}

/* Turns ray k, which ended where such a normal is, to its mirrored direction. */
static inline void mirror_ray(zt_batch *rays, int k, real nx, real ny, real nz) {
    real twice = -2 * real_dot(nx, ny, nz, rays->dx[k], rays->dy[k], rays->dz[k]);
    real dx = rays->dx[k] + twice * nx, dy = rays->dy[k] + twice * ny,
         dz = rays->dz[k] + twice * nz;
    /* Unit but for roundings, of which one step of Newton's for 1 / sqrt leaves none. */
    real unit = (real)1.5 - (real)0.5 * real_dot(dx, dy, dz, dx, dy, dz);
    rays->dx[k] = dx * unit;
    rays->dy[k] = dy * unit;
    rays->dz[k] = dz * unit;
}

/* ---- light (tracer/light.c)
 * ------------------------------------------------------------------
 */

/* What lamp number `index` gives the points, after so many mirrors: added to the sums; or,
 * where something may hide it, kept, with the shadow rays. */
void ZT_KERNEL_NAME(zt_work_shine)(zt_work *work, const zt_tracer *tracer, int32_t index,
                                   bool hidden, const zt_rays *given, int32_t depth);

/* Sums up the light at the points; returns how many shadow rays that took. */
int ZT_KERNEL_NAME(zt_work_light)(zt_work *work, zt_ray_counts *counts, const zt_tracer *tracer,
                                  const zt_rays *given, int32_t depth);

/* ---- probes (tracer/probes.c)
 * ----------------------------------------------------------------
 */

void ZT_KERNEL_NAME(zt_work_probe)(const zt_tracer *tracer, zt_probe *probes, int count,
                                   void *work);

#endif
