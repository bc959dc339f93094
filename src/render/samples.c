#include "render/samples.h"

#include "tracer/isa.h"
#include "tracer/sampler.h"

void zt_samples_key(zt_places *restrict places, const zt_render_job *job,
                    const int32_t *restrict column, const int32_t *restrict row, int count) {
    for (int i = 0; i < count; i++) {
        places->place_key[i] = zt_sample_key(job->place_key, column[i], row[i]);
        places->key[i] = zt_sample_key(job->frame_key, column[i], row[i]);
    }
}

/* From within pixels to the picture. */
ZT_CLONES static void add_corners(float *restrict x, float *restrict y,
                                  const int32_t *restrict column, const int32_t *restrict row,
                                  int count) {
    for (int i = 0; i < count; i++) {
        x[i] += (float)column[i];
        y[i] += (float)row[i];
    }
}

/* The middles of pixels. */
ZT_CLONES static void place_middles(float *restrict x, float *restrict y,
                                    const int32_t *restrict column, const int32_t *restrict row,
                                    int count) {
    for (int i = 0; i < count; i++) {
        x[i] = 0.5f + (float)column[i];
        y[i] = 0.5f + (float)row[i];
    }
}

static void place(zt_places *p, const zt_render_job *job, const int32_t *column,
                  const int32_t *row, int first, int count, int sample) {
    float *x = p->x + first, *y = p->y + first, *weight = p->weight + first;
    if (sample >= 0 && job->sampling.max > 1) {
        zt_sample_points(x, y, p->place_key, ZT_DIMENSION_PIXEL, (uint32_t)sample, count);
        if (job->warp) zt_warp_places(x, y, weight, job->warp, count);
        add_corners(x, y, column, row, count);
    } else {
        place_middles(x, y, column, row, count);
        for (int i = 0; job->warp && i < count; i++) weight[i] = 1;
    }
}

void zt_samples_take(zt_places *p, zt_rays *rays, const zt_render_job *job,
                     const int32_t *restrict column, const int32_t *restrict row, int first,
                     int count, int sample) {
    float unused[ZT_BATCH];
    uint32_t number = sample < 0 ? 0 : (uint32_t)sample;
    place(p, job, column, row, first, count, sample);
    if (zt_lens_has_aperture(job->lens))
        zt_sample_points(p->u + first, p->v + first, p->key, ZT_DIMENSION_LENS, number, count);
    if (job->scene->moves || zt_lens_moves(job->lens))
        zt_sample_points(rays->time + first, unused, p->key, ZT_DIMENSION_TIME, number, count);
    for (int i = 0; job->scene->random && i < count; i++) {
        rays->key[first + i] = p->key[i];
        rays->sample[first + i] = number;
    }
}
