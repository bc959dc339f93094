/* Chooses: the precision that a scene asks for, and the widest compiled version of the kernels
 * that this machine can run. */
#include "tracer/kernel.h"

#include <stdlib.h>

#include "base/diag.h"
#include "base/text.h"
#include "tracer/footprint.h"

#define KERNELS(isa) const zt_kernel zt_kernel_single_##isa, zt_kernel_double_##isa
extern KERNELS(scalar);
extern KERNELS(base);
#if defined __x86_64__
extern KERNELS(avx2);
extern KERNELS(avx512);
#endif

/* Compiled by ZT_REAL_NAME in tracer/prepare.c, which is of one precision at a time. */
typedef zt_status prepare(zt_tracer **tracer, zt_extents *extents, const zt_exposure *exposure,
                          const zt_needs *needs, bool everything, zt_meshes *meshes,
                          zt_arena *arena);
prepare zt_prepare_single, zt_prepare_double;
typedef zt_status prepare_search(zt_tracer *tracer, zt_meshes *meshes, zt_arena *arena);
prepare_search zt_prepare_search_single, zt_prepare_search_double;
typedef void prepare_ready(zt_ready *ready, const zt_tracer *tracer);
prepare_ready zt_prepare_ready_single, zt_prepare_ready_double;

typedef zt_status outline(zt_outline *outline, const zt_tracer *tracer, zt_arena *arena);
outline zt_outline_single, zt_outline_double;
typedef zt_status labels(zt_labels *labels, const zt_tracer *tracer, zt_arena *arena);
labels zt_labels_single, zt_labels_double;

static const zt_kernel *select_kernel(zt_precision precision) {
    const char *wanted = getenv("ZOETROPE_ISA");
    bool single = precision == ZT_PRECISION_SINGLE;
    if (wanted && zt_text_equal(wanted, "scalar"))
        return single ? &zt_kernel_single_scalar : &zt_kernel_double_scalar;
#if defined __x86_64__
    bool any = !wanted || !*wanted;
    bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
    if (has_avx512 && (any || zt_text_equal(wanted, "avx512")))
        return single ? &zt_kernel_single_avx512 : &zt_kernel_double_avx512;
    if (__builtin_cpu_supports("avx2") && (any || zt_text_equal(wanted, "avx2")))
        return single ? &zt_kernel_single_avx2 : &zt_kernel_double_avx2;
#endif
    return single ? &zt_kernel_single_base : &zt_kernel_double_base;
}

static bool wants_everything(void) {
    const char *wanted = getenv("ZOETROPE_EVERYTHING");
    return wanted && zt_text_equal(wanted, "1");
}

zt_status zt_tracer_prepare(zt_ready *ready, const zt_exposure *exposure,
                            zt_precision precision, zt_pixel pixel, zt_meshes *meshes,
                            zt_arena *arena) {
    zt_tracer *tracer = NULL;
    zt_extents extents;
    const bool all = wants_everything();
    *ready = (zt_ready){.precision = precision};
    ZT_TRY(zt_needs_find(&ready->needs, exposure, all, arena));
    const zt_needs *needs = &ready->needs;
    if (precision != ZT_PRECISION_DOUBLE) {
        ZT_TRY(zt_prepare_single(&tracer, &extents, exposure, needs, all, meshes, arena));
        ready->accuracy =
            zt_accuracy_judge(&extents, exposure->moments, pixel, ZT_PRECISION_SINGLE);
        if (precision == ZT_PRECISION_AUTO)
            ready->precision = ready->accuracy.reason == ZT_ACCURACY_FINE ? ZT_PRECISION_SINGLE
                                                                          : ZT_PRECISION_DOUBLE;
    }
    bool single = ready->precision == ZT_PRECISION_SINGLE;
    if (!single) {
        ZT_TRY(zt_prepare_double(&tracer, &extents, exposure, needs, all, meshes, arena));
        ready->beyond =
            zt_accuracy_judge(&extents, exposure->moments, pixel, ZT_PRECISION_DOUBLE);
    }
    ZT_TRY(single ? zt_prepare_search_single(tracer, meshes, arena)
                  : zt_prepare_search_double(tracer, meshes, arena));
    single ? zt_prepare_ready_single(ready, tracer) : zt_prepare_ready_double(ready, tracer);
    ready->kernel = select_kernel(ready->precision);
    ready->plain = !ready->moves && !all;
    return ZT_OK;
}

zt_status zt_outline_make(zt_outline *out, const zt_ready *ready, zt_arena *arena) {
    bool single = ready->precision == ZT_PRECISION_SINGLE;
    return (single ? zt_outline_single : zt_outline_double)(out, ready->tracer, arena);
}

zt_status zt_labels_make(zt_labels *out, const zt_ready *ready, zt_arena *arena) {
    bool single = ready->precision == ZT_PRECISION_SINGLE;
    return (single ? zt_labels_single : zt_labels_double)(out, ready->tracer, arena);
}

size_t zt_kernel_work_size(void) {
    /* The same for all widths; doubles need more. */
    return zt_kernel_double_base.work_size;
}
