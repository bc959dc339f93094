/* The whole way from a description to images: threads, single frames, resizing, stopping. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include <zoetrope/film.h>

#include "base/hash.h"

static const char film_text[] =
    "zoetrope: 1\n"
    "film: { size: [96, 54], rate: 30000/1001, duration: 20, reflections: 3 }\n"
    "camera: { position: { keys: { 0: [0, 2, 6], 19: [1, 2, 5] } }, look_at: [0, 1, 0] }\n"
    "materials:\n"
    "  mirror: { color: [0.5, 0.5, 0.5], reflectivity: { keys: { 0: 0.1, 10: 0.5 } } }\n"
    "lights:\n"
    "  - ambient: { intensity: 0.2 }\n"
    "  - point: { position: { keys: { 0: [3, 4, 3], 19: [-3, 4, 3] } }, intensity: 20 }\n"
    "objects:\n"
    "  - plane: { normal: [0, 1, 0], material: mirror }\n"
    "  - group:\n"
    "      rotation: { curve: linear, keys: { 0: [0, 0, 0], 10: [0, 120, 0], 20: [0, 240, 0] } "
    "}\n"
    "      objects:\n"
    "        - sphere: { center: [1, 1, 0], radius: 0.6, material: mirror }\n"
    "        - mesh: { file: models/knot.ply, position: [-1, 1, 0], scale: 0.7 }\n";

/* The description stands beside the models, under a name of its own. */
static zt_animation *open_film(void) {
    char path[] = ZT_TEST_SOURCE_DIR "/animations/.test_sequence_XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, film_text, sizeof film_text - 1), sizeof film_text - 1);
    close(file);
    zt_animation *animation;
    zt_status status = zt_animation_read(&animation, path, NULL, 0, (zt_listener){0});
    unlink(path);
    assert_int_equal(status, ZT_OK);
    return animation;
}

static zt_renderer *open_renderer(const zt_animation *animation, int threads) {
    zt_renderer *renderer;
    zt_render_settings settings = {.threads = threads};
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, (zt_listener){0}),
                     ZT_OK);
    return renderer;
}

static zt_hash render_hash(zt_renderer *renderer, int64_t frame) {
    zt_image *image;
    zt_output_format format = zt_renderer_format(renderer);
    assert_int_equal(zt_image_create(&image, format.width, format.height), ZT_OK);
    assert_int_equal(zt_renderer_frame(renderer, frame, image, NULL), ZT_OK);
    zt_hash hash =
        zt_hash_bytes(image->pixels, (size_t)image->width * (size_t)image->height * 16);
    zt_image_free(&image);
    return hash;
}

static void assert_same(zt_hash a, zt_hash b) { assert_true(zt_hash_equal(a, b)); }

/* 1 thread against 4; forwards against backwards; a renderer that did nothing else before. */
static void test_same_bits(void **state) {
    (void)state;
    zt_animation *animation = open_film();
    zt_renderer *one = open_renderer(animation, 1), *four = open_renderer(animation, 4);
    zt_hash forwards[20];
    for (int frame = 0; frame < 20; frame++) forwards[frame] = render_hash(one, frame);
    for (int frame = 19; frame >= 0; frame--)
        assert_same(forwards[frame], render_hash(four, frame));
    zt_renderer *fresh = open_renderer(animation, 2);
    assert_same(forwards[13], render_hash(fresh, 13));
    for (int frame = 1; frame < 20; frame++) /* and it does move */
        assert_true(forwards[frame].low != forwards[frame - 1].low);
    zt_renderer_close(&fresh);
    zt_renderer_close(&one);
    zt_renderer_close(&four);
    zt_animation_free(&animation);
}

typedef struct counter {
    int64_t told_count, last_frame, stop_after;
} counter;

static void count_progress(void *user, int64_t done, int64_t total, int64_t frame) {
    counter *c = user;
    c->told_count++;
    c->last_frame = frame;
    assert_int_equal(done, c->told_count);
    assert_int_equal(total, 16);
}
static bool stop_when_counted(void *user) {
    const counter *c = user;
    return c->told_count >= c->stop_after;
}

/* Reads "frame size hash" lines; returns how many, the frame numbers in `frames`. */
static int read_hashes(const char *path, long *frames, char (*hashes)[40], int most) {
    FILE *file = fopen(path, "r");
    if (!file) return -1;
    char line[200];
    int count = 0;
    while (count < most && fgets(line, sizeof line, file))
        if (sscanf(line, "%ld %*s %39s", &frames[count], hashes[count]) == 2) count++;
    fclose(file);
    return count;
}

/* A sequence writes each frame once, in order; the same bits as the frame alone; a range; and
 * one that is stopped keeps what it has. */
static void test_sequence(void **state) {
    (void)state;
    zt_animation *animation = open_film();
    zt_renderer *renderer = open_renderer(animation, 2);
    assert_int_equal(zt_renderer_format(renderer).rate.num, 30000);
    int64_t numbers[16];
    for (int i = 0; i < 16; i++) numbers[i] = 2 + i;
    zt_frames wanted_frames = {numbers, 16};
    for (int stop = 0; stop < 2; stop++) {
        counter count = {.stop_after = stop ? 5 : 1000};
        zt_watcher watcher = {count_progress, stop_when_counted, &count};
        char path[] = "test_sequence.hash";
        zt_film_order order = {.target = path, .frames = &wanted_frames};
        zt_film_result result;
        assert_int_equal(zt_film_render(&result, renderer, &order, &watcher),
                         stop ? ZT_ESTOPPED : ZT_OK);
        assert_int_equal(result.rendered + result.held, stop ? 5 : 16);
        long frames[32];
        char hashes[32][40];
        int line_count = read_hashes(path, frames, hashes, 32);
        assert_int_equal(line_count, stop ? 5 : 16);
        for (int i = 0; i < line_count; i++) {
            char wanted[40];
            zt_hash hash = render_hash(renderer, frames[i]);
            snprintf(wanted, sizeof wanted, "%016llx%016llx", (unsigned long long)hash.high,
                     (unsigned long long)hash.low);
            assert_int_equal(frames[i], 2 + i);
            assert_string_equal(hashes[i], wanted);
        }
        unlink(path);
    }
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

/* Settings override the film; impossible ones are refused. */
static void test_settings(void **state) {
    (void)state;
    zt_animation *animation = open_film();
    zt_renderer *renderer;
    zt_render_settings settings = {.width = 31, .height = 17, .samples = 3};
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, (zt_listener){0}),
                     ZT_OK);
    zt_output_format format = zt_renderer_format(renderer);
    assert_int_equal(format.width, 31);
    assert_int_equal(format.height, 17);
    zt_image *wrong;
    assert_int_equal(zt_image_create(&wrong, 32, 17), ZT_OK);
    assert_int_equal(zt_renderer_frame(renderer, 0, wrong, NULL), ZT_EARGUMENT);
    zt_image_free(&wrong);
    zt_renderer_close(&renderer);
    const zt_render_settings refused[] = {{.width = 31},
                                          {.width = -1, .height = 5},
                                          {.samples = -1},
                                          {.threads = -2},
                                          {.width = 1 << 20, .height = 1}};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++)
        assert_int_equal(zt_renderer_open(&renderer, animation, &refused[i], (zt_listener){0}),
                         ZT_EARGUMENT);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_sequence),
        cmocka_unit_test(test_settings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
