/* An exposure made ready for a test's own rays, without a lens and a film. cmocka.h comes
 * first. */
#ifndef ZT_TESTS_STAGE_H
#define ZT_TESTS_STAGE_H

#include <stdlib.h>

#include "tracer/kernel.h"

typedef struct stage {
    zt_arena arena;
    zt_meshes *meshes;
    zt_ready ready;
    void *work;
} stage;

static inline void open_stage_of(stage *st, const zt_exposure *exposure, zt_precision precision,
                                 zt_pixel pixel) {
    const zt_scene *scene = exposure->moments;
    *st = (stage){0};
    assert_int_equal(
        zt_meshes_open(&st->meshes, scene->meshes, scene->mesh_count, 1, (zt_listener){0}),
        ZT_OK);
    assert_int_equal(
        zt_tracer_prepare(&st->ready, exposure, precision, pixel, st->meshes, &st->arena),
        ZT_OK);
    st->work = aligned_alloc(64, (zt_kernel_work_size() + 63) / 64 * 64);
    assert_non_null(st->work);
}

static inline void close_stage(stage *st) {
    free(st->work);
    zt_meshes_close(&st->meshes);
    zt_arena_free(&st->arena);
}

#endif
