/* Keepsakes of reels: a picture is put into bytes, and copied from in a run of its own.
 * cmocka.h comes first. */
#ifndef ZT_TESTS_KEEPING_H
#define ZT_TESTS_KEEPING_H

#include <stdlib.h>

#include "reel.h"
#include "render/keepsake.h"
#include "render/reuse.h"

static const char arithmetic[] = "of tests";

static const zt_sampling signed_edges = {
    .min = 1, .max = 16, .error = 0.02, .edges = true, .filter = ZT_FILTER_MITCHELL};

typedef struct keepsake {
    unsigned char *bytes;
    size_t size;
} keepsake;

static inline void keep(keepsake *k, const reel *r) {
    const zt_picture *last = &r->reuse->last;
    zt_keepsake_head head = {.frame = 1};
    assert_true(last->whole);
    free(k->bytes);
    k->bytes = malloc(zt_keepsake_room(last));
    assert_non_null(k->bytes);
    zt_keepsake_write(k->bytes, &head, last, arithmetic);
    zt_keepsake_seal(k->bytes);
    k->size = head.size;
    assert_true(k->size <= zt_keepsake_room(last));
}

static inline void take_out(zt_picture *picture, const keepsake *k) {
    assert_true(zt_keepsake_read(picture, k->bytes, k->size, arithmetic));
}

/* The run ends, and another one begins. */
static inline void begin_anew(reel *r) {
    zt_reuse_close(&r->reuse);
    assert_int_equal(zt_reuse_open(&r->reuse, true), ZT_OK);
    for (int i = 0; i < REEL_IMAGES; i++) zt_image_forget_stamps(r->images[i]);
    r->reuse->keeps = true;
}

/* Shows a scene in a run of its own, with what was kept of another one; returns how many tiles
 * are copied from that. */
static inline int64_t show_with(reel *r, const keepsake *k, const zt_scene *scene) {
    zt_picture picture = {0};
    begin_anew(r);
    if (k) take_out(&picture, k);
    r->reuse->kept = k ? &picture : NULL;
    int64_t copied = reel_show(r, scene);
    r->reuse->kept = NULL;
    zt_picture_close(&picture);
    return copied;
}

/* A floor, a row of balls, a lamp. */
static inline void row_of_balls(test_scene *s) {
    scene_begin(s);
    int32_t grey = scene_material(s, (vec3){0.5, 0.5, 0.5}, 0);
    scene_plane(s, (vec3){0, 1, 0}, -1, grey);
    for (int i = 0; i < 8; i++) scene_sphere(s, (vec3){-3.5 + i, -0.7, -5}, 0.3, grey);
    scene_ambient(s, (vec3){1, 1, 1}, 0.1);
    scene_point_light(s, (vec3){0, 6, -2}, 20);
    scene_point_light(s, (vec3){3, 0.4, -9}, 1);
}

#endif
