/* A builder of hierarchies, and looking into them by each width of instructions in turn. */
#ifndef ZT_TESTS_LOOKING_H
#define ZT_TESTS_LOOKING_H

#include "tracer/bvh.h"

static zt_bvh_builder *builder;

/* Looking as each width of instructions that this machine has does it. */
zt_bvh_look zt_bvh_look_single_scalar, zt_bvh_look_single_base;
#if defined __x86_64__
zt_bvh_look zt_bvh_look_single_avx2, zt_bvh_look_single_avx512;
#endif
static zt_bvh_look *looks[4];
static int look_count, next_look;

static inline void find_looks(void) {
    looks[look_count++] = zt_bvh_look_single_scalar;
    looks[look_count++] = zt_bvh_look_single_base;
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) looks[look_count++] = zt_bvh_look_single_avx2;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
        looks[look_count++] = zt_bvh_look_single_avx512;
#endif
}

/* One width after the other. */
static inline void look(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_visit *visit, void *user) {
    looks[next_look++ % look_count](bvh, rays, visit, user);
}

/* Setup and teardown of a group. */
static inline int open_builder(void **state) {
    (void)state;
    find_looks();
    return zt_bvh_open(&builder, 0, (zt_listener){0}) == ZT_OK ? 0 : -1;
}

static inline int close_builder(void **state) {
    (void)state;
    zt_bvh_close(&builder);
    return builder != NULL;
}

#endif
