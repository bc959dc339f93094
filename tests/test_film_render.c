/* Content keys: what changes a frame's key, and what does not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include <zoetrope/renderer.h>

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

static void print_to(const char *path, const char *text) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void find_keys(zt_hash keys[FRAMES], const change *c) {
    char text[2048];
    const char *name = c->name ? c->name : "clay";
    snprintf(text, sizeof text, film, c->film ? c->film : "", name, name,
             c->end ? c->end : "2");
    print_to("film.yaml", text);
    snprintf(text, sizeof text, mesh, c->point ? c->point : "0");
    print_to("m.ply", text);
    zt_animation *animation;
    zt_renderer *renderer;
    heard h;
    if (zt_animation_read(&animation, "film.yaml", NULL, 0, listener_of(&h)) != ZT_OK)
        fail_msg("%s", h.text);
    zt_render_settings settings = c->settings;
    settings.threads = 1;
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, (zt_listener){0}),
                     ZT_OK);
    for (int frame = 0; frame < FRAMES; frame++)
        assert_int_equal(zt_renderer_key(&keys[frame], renderer, frame), ZT_OK);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

static bool same(zt_hash a, zt_hash b) { return a.high == b.high && a.low == b.low; }

static void usual_keys(zt_hash keys[FRAMES]) { find_keys(keys, &(change){0}); }

/* Frames that show the same have the same key, others another one. */
static void frames_are_told_apart(void **state) {
    (void)state;
    zt_hash keys[FRAMES];
    usual_keys(keys);
    for (int a = 0; a < FRAMES; a++)
        for (int b = 0; b < FRAMES; b++) {
            int seen_a = a < 4 ? 4 : a > 8 ? 8 : a, seen_b = b < 4 ? 4 : b > 8 ? 8 : b;
            if (same(keys[a], keys[b]) != (seen_a == seen_b)) fail_msg("%d and %d", a, b);
        }
}

/* What no pixel shows does not matter. */
static void names_change_nothing(void **state) {
    (void)state;
    const change changes[] = {{0}, {.name = "loam"}, {.film = " } # remark {"}};
    zt_hash usual[FRAMES], keys[FRAMES];
    usual_keys(usual);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        find_keys(keys, &changes[i]);
        for (int frame = 0; frame < FRAMES; frame++)
            if (!same(usual[frame], keys[frame])) fail_msg("change %zu, %d", i, frame);
    }
}

/* A key that is moved changes the frames after the one before it. */
static void keys_change_their_frames(void **state) {
    (void)state;
    zt_hash usual[FRAMES], keys[FRAMES];
    usual_keys(usual);
    find_keys(keys, &(change){.end = "2.5"});
    for (int frame = 0; frame < FRAMES; frame++)
        assert_int_equal(same(usual[frame], keys[frame]), frame <= 4);
}

static void settings_change_all(void **state) {
    (void)state;
    const change changes[] = {{.settings = {.width = 32, .height = 20}},
                              {.settings = {.width = 16, .height = 12}},
                              {.settings = {.samples = 3}},
                              {.settings = {.precision = ZT_PRECISION_DOUBLE}},
                              {.settings = {.aovs = 1}},
                              {.film = ", seed: 7"},
                              {.point = "0.25"}};
    zt_hash usual[FRAMES], keys[FRAMES];
    usual_keys(usual);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        find_keys(keys, &changes[i]);
        for (int a = 0; a < FRAMES; a++)
            for (int b = 0; b < FRAMES; b++)
                if (same(usual[a], keys[b])) fail_msg("change %zu, %d and %d", i, a, b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_told_apart), cmocka_unit_test(names_change_nothing),
        cmocka_unit_test(keys_change_their_frames), cmocka_unit_test(settings_change_all)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
