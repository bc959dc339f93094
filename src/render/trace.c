/* Batches of samples on their way through the tracer. */
#include <string.h>

#include "render/work.h"

/* Exchanges rows, of `width` numbers of 32 bits, and columns. */
static void turn(void *numbers, int width, int height) {
    enum { SIZE = 4 };
    static_assert(sizeof(float) == SIZE, "a number is one of 32 bits");
    char *own = numbers, turned[SIZE * ZT_BATCH];
    for (int i = 0; i < width; i++)
        for (int k = 0; k < height; k++)
            memcpy(turned + SIZE * (i * height + k), own + SIZE * (k * width + i), SIZE);
    memcpy(own, turned, (size_t)width * (size_t)height * SIZE);
}

/* All that tells where, when and of whom rays are. */
static void turn_places(zt_render_thread *own, const zt_render_job *job, int count, int now) {
    turn(own->places.x, count, now);
    turn(own->places.y, count, now);
    if (zt_lens_has_aperture(job->lens)) {
        turn(own->places.u, count, now);
        turn(own->places.v, count, now);
    }
    if (job->scene->moves || zt_lens_moves(job->lens)) turn(own->rays.time, count, now);
    if (job->scene->random) {
        turn(own->rays.key, count, now);
        turn(own->rays.sample, count, now);
    }
}

static void turn_light(zt_radiance *light, const zt_rays *rays, int count, int now) {
    turn(light->r, now, count);
    turn(light->g, now, count);
    turn(light->b, now, count);
    if (rays->labels) turn(light->path, now, count);
    if (rays->wants_cover) turn(light->a, now, count);
}

bool zt_frame_trace(zt_frame *f, zt_render_thread *own, int count, int now) {
    const zt_render_job *job = f->job;
    const zt_places *p = &own->places;
    const bool turns = now > 1 && (f->costly || f->at_edges);
    if (turns) turn_places(own, job, count, now);
    zt_lens_rays(&own->rays, job->lens, p->x, p->y, p->u, p->v, now * count);
    own->light.counts = (zt_ray_counts){0};
    bool met = f->trace(&own->light, job->scene->tracer, &own->rays, own->kernel);
    own->bare = !met;
    own->count.samples += now * count;
    zt_ray_counts_add(&own->count.rays, &own->light.counts);
    if (turns && met) turn_light(&own->light, &own->rays, count, now);
    return met;
}
