/* Batches of samples on their way through the tracer. */
#include <string.h>

#include "render/work.h"

enum { SIZE = 4, SIDE = 4 };
static_assert(sizeof(float) == SIZE, "a number is one of 32 bits");
typedef int32_t four __attribute__((vector_size(SIDE * SIZE)));

/* The same for SIDE by SIDE numbers, from one place to another. */
static inline void turn_square(char *to, int to_width, const char *from, int from_width) {
    four a, b, c, d;
    memcpy(&a, from, sizeof a);
    memcpy(&b, from + SIZE * from_width, sizeof b);
    memcpy(&c, from + SIZE * 2 * from_width, sizeof c);
    memcpy(&d, from + SIZE * 3 * from_width, sizeof d);
    const four ab = __builtin_shufflevector(a, b, 0, 4, 1, 5),
               cd = __builtin_shufflevector(c, d, 0, 4, 1, 5),
               ba = __builtin_shufflevector(a, b, 2, 6, 3, 7),
               dc = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    const four columns[SIDE] = {__builtin_shufflevector(ab, cd, 0, 1, 4, 5),
                                __builtin_shufflevector(ab, cd, 2, 3, 6, 7),
                                __builtin_shufflevector(ba, dc, 0, 1, 4, 5),
                                __builtin_shufflevector(ba, dc, 2, 3, 6, 7)};
    for (int i = 0; i < SIDE; i++)
        memcpy(to + SIZE * i * to_width, &columns[i], sizeof columns[i]);
}

/* Exchanges rows, of `width` numbers of 32 bits, and columns. */
static void turn(void *numbers, int width, int height) {
    char *own = numbers, turned[SIZE * ZT_BATCH];
    const bool squares = width % SIDE == 0 && height % SIDE == 0;
    for (int i = 0; squares && i < width; i += SIDE)
        for (int k = 0; k < height; k += SIDE)
            turn_square(turned + SIZE * (i * height + k), height, own + SIZE * (k * width + i),
                        width);
    for (int i = 0; !squares && i < width; i++)
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
