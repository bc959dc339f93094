/* For tests of films that go on: a film of which some frames show the same, rendered again
 * after a change. cmocka.h comes first. */
#ifndef ZT_TESTS_CHANGED_FILM_H
#define ZT_TESTS_CHANGED_FILM_H

#include <stdio.h>
#include <string.h>

#include <zoetrope/film.h>

#include "base/hash.h"
#include "files.h"

enum { FRAMES = 12 };

/* The ball rests until frame 4, moves until 8, and rests again; %s: a material's name, the
 * place where it is at last, the film's sampling, and a point of the mesh. */
static const char film[] =
    "zoetrope: 1\n"
    "film: { size: [16, 10], rate: 12, duration: 1 s%s }\n"
    "camera: { position: [0, 1, 6], look_at: [0, 1, 0] }\n"
    "materials:\n"
    "  %s: { color: [0.5, 0.4, 0.3] }\n"
    "lights:\n"
    "  - point: { position: [2, 4, 2], intensity: 30 }\n"
    "objects:\n"
    "  - mesh: { file: m.ply }\n"
    "  - sphere:\n"
    "      material: %s\n"
    "      radius: 1\n"
    "      center: { curve: linear, keys: { 0: [0, 1, 0], 4: [0, 1, 0], 8: [%s, 1, 0] } }\n";
static const char mesh[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                           "property float y\nproperty float z\nelement face 1\n"
                           "property list uchar int vertex_indices\nend_header\n"
                           "0 0 0\n1 0 0\n%s 1 0\n3 0 1 2\n";

/* What a film differs by from the usual one; zeroed: by nothing. */
typedef struct change {
    const char *film, *name, *end, *point;
    zt_render_settings settings;
} change;

static inline void print_to(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* The film with a change, ready to be rendered. */
static inline void open_changed(zt_animation **animation, zt_renderer **renderer,
                                const change *c, heard *h) {
    char text[2048];
    const char *name = c->name ? c->name : "clay";
    snprintf(text, sizeof text, film, c->film ? c->film : "", name, name,
             c->end ? c->end : "2");
    print_to("film.yaml", text);
    snprintf(text, sizeof text, mesh, c->point ? c->point : "0");
    print_to("m.ply", text);
    zt_render_settings settings = c->settings;
    if (settings.threads == 0) settings.threads = 1;
    if (zt_animation_read(animation, "film.yaml", NULL, 0, listener_of(h)) != ZT_OK)
        fail_msg("%s", h->text);
    assert_int_equal(zt_renderer_open(renderer, *animation, &settings, listener_of(h)), ZT_OK);
}

/* Stops after so many frames. */
typedef struct patience {
    int64_t most, done;
} patience;

static inline void count_frame(void *user, int64_t done, int64_t total, int64_t frame) {
    (void)total, (void)frame;
    ((patience *)user)->done = done;
}

static inline bool is_over(void *user) {
    const patience *p = user;
    return p->done >= p->most;
}

/* Renders all frames of the film with a change, or as many as there is patience for. */
static inline zt_status render(zt_film_result *result, heard *h, const char *target,
                               const change *c, zt_film_order order, int64_t patience_frames) {
    zt_animation *animation;
    zt_renderer *renderer;
    open_changed(&animation, &renderer, c, h);
    int64_t numbers[FRAMES];
    for (int i = 0; i < FRAMES; i++) numbers[i] = i;
    zt_frames frames = {numbers, FRAMES};
    patience p = {patience_frames, 0};
    zt_watcher watcher = {count_frame, is_over, &p};
    order.target = target;
    order.frames = &frames;
    order.title = order.description = "film";
    zt_status status = zt_film_render(result, renderer, &order, &watcher);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
    return status;
}

/* Renders what is missing, and says how many frames that were, by what became of them. */
static inline void expect(const char *target, const change *c, int rendered, int held,
                          int kept) {
    zt_film_result result;
    heard h;
    zt_status status = render(&result, &h, target, c, (zt_film_order){0}, INT64_MAX);
    if (status != ZT_OK) fail_msg("%s", h.text);
    assert_int_equal(result.rendered, rendered);
    assert_int_equal(result.held, held);
    assert_int_equal(result.kept, kept);
}

static inline zt_hash hash_of(const char *path) {
    static unsigned char bytes[1 << 16];
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_true(size > 0 && size < sizeof bytes);
    return zt_hash_bytes(bytes, size);
}

#endif
