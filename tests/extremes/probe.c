#include "probe.h"

#include <stdlib.h>
#include <string.h>

#include "render/render.h"
#include "tracer/kernel.h"

/* Opened once: what it loads stays loaded. */
struct probe_tracer {
    zt_arena arena;
    zt_meshes *meshes;
    zt_ready ready;
    void *work;
};

static zt_precision precision_of(probe_precision precision) {
    return precision == PROBE_SINGLE   ? ZT_PRECISION_SINGLE
           : precision == PROBE_DOUBLE ? ZT_PRECISION_DOUBLE
                                       : ZT_PRECISION_AUTO;
}

void probe_close(probe_tracer **tracer) {
    if (!*tracer) return;
    zt_meshes_close(&(*tracer)->meshes);
    zt_arena_free(&(*tracer)->arena);
    free(*tracer);
    *tracer = NULL;
}

probe_tracer *probe_open(const zt_scene *scene, probe_precision precision,
                         probe_precision *chosen) {
    enum { LINES = 720 }; /* of the picture that auto is asked for */
    probe_tracer *t = calloc(1, sizeof *t);
    zt_pixel pixel = zt_lens_pixel(&scene->camera, LINES);
    zt_exposure exposure = zt_exposure_of(scene);
    if (!t) return NULL;
    t->work = zt_arena_push(&t->arena, zt_kernel_work_size());
    if (!t->work ||
        zt_meshes_open(&t->meshes, scene->meshes, scene->mesh_count, 1, (zt_listener){0}) ||
        zt_tracer_prepare(&t->ready, &exposure, precision_of(precision), pixel, t->meshes,
                          &t->arena)) {
        probe_close(&t);
        return NULL;
    }
    *chosen = t->ready.precision == ZT_PRECISION_SINGLE ? PROBE_SINGLE : PROBE_DOUBLE;
    return t;
}

void probe_run(probe_tracer *t, probe *probes, int count) {
    for (int first = 0; first < count; first += ZT_BATCH) {
        zt_probe batch[ZT_BATCH];
        int some = count - first < ZT_BATCH ? count - first : ZT_BATCH;
        for (int i = 0; i < some; i++)
            batch[i] = (zt_probe){.origin = probes[first + i].origin,
                                  .direction = probes[first + i].direction,
                                  .source = probes[first + i].source};
        t->ready.kernel->probe(t->ready.tracer, batch, some, t->work);
        for (int i = 0; i < some; i++) {
            probe *p = &probes[first + i];
            const zt_probe *b = &batch[i];
            p->object = b->object;
            p->part = b->part;
            p->t = b->distance;
            p->point = b->point;
            p->normal = b->normal;
            p->lights = b->lit;
            p->next_origin = b->mirror_origin;
            p->next_direction = b->mirror_direction;
            p->next_source = b->mirror_source;
        }
    }
}

/* Renders into an image that is there. */
static int64_t render(zt_image *image, const zt_scene *scene, const probe_tracer *t,
                      zt_pool *pool, int threads) {
    zt_arena arena = {0};
    zt_render_work *work;
    zt_render_count count;
    zt_exposure exposure = zt_exposure_of(scene);
    zt_lens *lens;
    zt_render_job job = {.scene = &t->ready, .sampling = {.min = 1, .max = 1}};
    bool ok = zt_lens_prepare(&lens, &exposure, image->width, image->height, &arena) == ZT_OK &&
              (job.lens = lens) && zt_render_work_push(&work, &arena, threads) == ZT_OK &&
              zt_render(image, &count, &job, work, pool) == ZT_OK;
    zt_arena_free(&arena);
    return ok ? count.left_out : -1;
}

int64_t probe_render(float *pixels, const zt_scene *scene, probe_precision precision, int width,
                     int height, int threads) {
    probe_precision chosen;
    probe_tracer *t = probe_open(scene, precision, &chosen);
    zt_image *image = NULL;
    zt_pool *pool = NULL;
    int64_t left_out = -1;
    if (t && zt_image_create(&image, width, height) == ZT_OK &&
        zt_pool_open(&pool, threads) == ZT_OK) {
        left_out = render(image, scene, t, pool, threads);
        memcpy(pixels, image->pixels, sizeof *pixels * 4 * (size_t)(width * height));
    }
    zt_pool_close(&pool);
    zt_image_free(&image);
    probe_close(&t);
    return left_out;
}
