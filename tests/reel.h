/* Frames one after the other, of which tiles may be copied, each compared with the same frame
 * rendered by itself. cmocka.h comes first. */
#ifndef ZT_TESTS_REEL_H
#define ZT_TESTS_REEL_H

#include <string.h>

#include "base/hash.h"
#include "image/stamps.h"
#include "render/render.h"
#include "scenes.h"

enum { REEL_WIDTH = 80, REEL_HEIGHT = 64, REEL_TILES = 20, REEL_IMAGES = 3 };

typedef struct reel {
    zt_arena run, frame;
    zt_meshes *meshes;
    zt_pool *pool;
    zt_render_work *work;
    zt_reuse *reuse;
    zt_image *image, *alone, *images[REEL_IMAGES]; /* of which frames fill the next one */
    zt_precision precision;
    zt_sampling sampling;
    bool transparent;
    int64_t shown, copied; /* tiles; */
    int64_t kept;          /* among the copied, from what was kept */
    int64_t left_out;      /* samples of the last frame; */
    int64_t samples;       /* and those that were taken */
    bool fresh; /* what it is compared with shares nothing with frames before: no hierarchies */
} reel;

static inline void reel_open(reel *r, const zt_mesh *meshes, int mesh_count) {
    *r = (reel){.precision = ZT_PRECISION_AUTO, .sampling = {.min = 1, .max = 1}};
    assert_int_equal(zt_meshes_open(&r->meshes, meshes, mesh_count, 2, (zt_listener){0}),
                     ZT_OK);
    assert_int_equal(zt_pool_open(&r->pool, 2), ZT_OK);
    assert_int_equal(zt_render_work_push(&r->work, &r->run, 2), ZT_OK);
    assert_int_equal(zt_reuse_open(&r->reuse, true), ZT_OK);
    for (int i = 0; i < REEL_IMAGES; i++) {
        assert_int_equal(zt_image_create(&r->images[i], REEL_WIDTH, REEL_HEIGHT), ZT_OK);
        assert_int_equal(zt_image_add_stamps(r->images[i]), ZT_OK);
    }
    r->image = r->images[0];
    assert_int_equal(zt_image_create(&r->alone, REEL_WIDTH, REEL_HEIGHT), ZT_OK);
}

static inline void reel_close(reel *r) {
    for (int i = 0; i < REEL_IMAGES; i++) zt_image_free(&r->images[i]);
    zt_image_free(&r->alone);
    zt_reuse_close(&r->reuse);
    zt_render_work_close(r->work);
    zt_pool_close(&r->pool);
    zt_meshes_close(&r->meshes);
    zt_arena_free(&r->run);
    zt_arena_free(&r->frame);
}

/* What a still camera's rays follow from; and all of a frame, which its random numbers do. */
static inline zt_hash reel_view(const reel *r, const zt_exposure *e) {
    zt_hash parts[2] = {zt_hash_bytes(&r->sampling, sizeof r->sampling), {0, 0}};
    for (int32_t i = 0; i < e->moment_count; i++) {
        const zt_camera *camera = &e->moments[i].camera;
        if (i > 0 && memcmp(camera, &e->moments->camera, sizeof *camera) == 0) continue;
        parts[1] = zt_hash_bytes(camera, sizeof *camera);
        parts[0] = zt_hash_bytes(parts, sizeof parts);
    }
    return parts[0];
}

static inline uint64_t reel_key(const reel *r, const zt_exposure *e) {
    zt_hash parts[2] = {reel_view(r, e), {0, 0}};
    for (int32_t i = 0; i < e->moment_count && !r->sampling.seed_fixed; i++) {
        const zt_scene *s = &e->moments[i];
        const zt_hash all[] = {
            zt_hash_bytes(s->objects, (size_t)s->object_count * sizeof *s->objects),
            zt_hash_bytes(s->lights, (size_t)s->light_count * sizeof *s->lights),
            zt_hash_bytes(s->materials, (size_t)s->material_count * sizeof *s->materials)};
        parts[1] = zt_hash_bytes(all, sizeof all);
        parts[0] = zt_hash_bytes(parts, sizeof parts);
    }
    return parts[0].low;
}

static inline void reel_prepare(zt_ready *ready, reel *r, const zt_exposure *exposure,
                                zt_meshes *meshes) {
    assert_int_equal(zt_tracer_prepare(ready, exposure, r->precision,
                                       zt_lens_finest_pixel(exposure, REEL_WIDTH, REEL_HEIGHT),
                                       meshes, &r->frame),
                     ZT_OK);
}

/* Of two images, tiles with equal stamps are the same. */
static inline void reel_compare_stamps(const zt_image *a, const zt_image *b) {
    const int columns = zt_stamp_tiles(REEL_WIDTH);
    for (int y = 0; y < REEL_HEIGHT; y++)
        for (int x = 0; x < REEL_WIDTH; x++) {
            int tile = y / ZT_STAMP_SIDE * columns + x / ZT_STAMP_SIDE;
            size_t at = 4 * ((size_t)y * REEL_WIDTH + (size_t)x);
            if (a->stamps[tile] && a->stamps[tile] == b->stamps[tile])
                assert_memory_equal(a->pixels + at, b->pixels + at, 4 * sizeof(float));
        }
}

/* Shows an exposure both ways; returns how many tiles were copied. */
static inline int64_t reel_expose(reel *r, const zt_exposure *exposure) {
    zt_ready ready;
    zt_lens *lens;
    zt_render_count count, alone;
    zt_arena_reset(&r->frame);
    reel_prepare(&ready, r, exposure, r->meshes);
    assert_int_equal(zt_lens_prepare(&lens, exposure, REEL_WIDTH, REEL_HEIGHT, &r->frame),
                     ZT_OK);
    zt_render_job job = {.scene = &ready,
                         .lens = lens,
                         .sampling = r->sampling,
                         .transparent = r->transparent,
                         .reuse = r->reuse,
                         .view = reel_view(r, exposure),
                         .place_key = r->sampling.seed,
                         .frame_key = reel_key(r, exposure)};
    assert_int_equal(zt_warp_prepare(&job.warp, &r->sampling, &r->frame), ZT_OK);
    if (r->sampling.edges)
        assert_int_equal(
            zt_thin_prepare(&job.thin, exposure, REEL_WIDTH, REEL_HEIGHT, &r->frame), ZT_OK);
    r->image = r->images[r->shown / REEL_TILES % REEL_IMAGES];
    assert_int_equal(zt_render(r->image, &count, &job, r->work, r->pool), ZT_OK);
    for (int i = 0; i < REEL_IMAGES; i++) reel_compare_stamps(r->image, r->images[i]);
    job.reuse = NULL;
    zt_meshes *own = NULL;
    if (r->fresh) {
        const zt_scene *s = exposure->moments;
        assert_int_equal(zt_meshes_open(&own, s->meshes, s->mesh_count, 1, (zt_listener){0}),
                         ZT_OK);
        reel_prepare(&ready, r, exposure, own);
    }
    assert_int_equal(zt_render(r->alone, &alone, &job, r->work, r->pool), ZT_OK);
    zt_meshes_close(&own);
    const size_t size = sizeof(float) * 4 * REEL_WIDTH * REEL_HEIGHT;
    for (size_t i = 0; i < size / sizeof(float); i++)
        if (memcmp(&r->image->pixels[i], &r->alone->pixels[i], sizeof(float)) != 0)
            fail_msg("pixel (%d, %d): copied %.9g, rendered %.9g", (int)(i / 4 % REEL_WIDTH),
                     (int)(i / 4 / REEL_WIDTH), (double)r->image->pixels[i],
                     (double)r->alone->pixels[i]);
    assert_int_equal(count.left_out, alone.left_out);
    assert_int_equal(count.tiles, REEL_TILES);
    assert_int_equal(alone.tiles_copied, 0);
    r->left_out = count.left_out;
    r->samples = count.samples;
    r->shown += count.tiles;
    r->copied += count.tiles_copied;
    r->kept += count.tiles_kept;
    return count.tiles_copied;
}

static inline int64_t reel_show(reel *r, const zt_scene *scene) {
    zt_exposure exposure = zt_exposure_of(scene);
    return reel_expose(r, &exposure);
}

#endif
