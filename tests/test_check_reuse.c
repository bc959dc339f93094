/* What `render --check-reuse` does, by the calls that the program makes: of a few hundred
 * random descriptions each frame is the same with tiles copied and without; and where it is
 * not, that is found, and told with frame and pixel. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <zoetrope/aov.h>
#include <zoetrope/film.h>

#include "descriptions.h"
#include "meshes.h"
#include "random_film.h"
#include "render/reuse.h"
#include "sequence/reuse_check.h"

enum { FILMS = 240, FRAMES = 5 };

static void write_ball(void) {
    ball_mesh ball = make_ball(2);
    FILE *file = fopen("ball.ply", "w");
    assert_non_null(file);
    fprintf(file,
            "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
            "property float z\nelement face %d\nproperty list uchar int vertex_indices\n"
            "end_header\n",
            (int)ball.mesh.vertex_count, (int)ball.mesh.triangle_count);
    for (int i = 0; i < ball.mesh.vertex_count; i++)
        fprintf(file, "%.9g %.9g %.9g\n", (double)ball.positions[3 * i],
                (double)ball.positions[3 * i + 1], (double)ball.positions[3 * i + 2]);
    for (int i = 0; i < ball.mesh.triangle_count; i++)
        fprintf(file, "3 %u %u %u\n", ball.triangles[3 * i], ball.triangles[3 * i + 1],
                ball.triangles[3 * i + 2]);
    assert_int_equal(fclose(file), 0);
    free_ball(&ball);
}

static zt_renderer *open_checked(const zt_animation *animation, zt_precision precision,
                                 heard *h) {
    const zt_render_settings settings = {
        .threads = 1, .precision = precision, .check_reuse = true};
    zt_renderer *renderer;
    assert_int_equal(zt_renderer_open(&renderer, animation, &settings, listener_of(h)), ZT_OK);
    return renderer;
}

/* Renders all frames into checksums. */
static zt_status render(zt_renderer *renderer, const zt_watcher *watcher) {
    int64_t numbers[FRAMES] = {0, 1, 2, 3, 4};
    const zt_frames frames = {numbers, FRAMES};
    const zt_film_order order = {
        .target = "x.hash", .frames = &frames, .title = "film", .description = "film.yaml"};
    zt_film_result result;
    return zt_film_render(&result, renderer, &order, watcher);
}

static void random_films_are_the_same(void **state) {
    (void)state;
    static film_text film;
    int64_t tiles[FILM_KINDS] = {0}, copied[FILM_KINDS] = {0};
    write_ball();
    for (int i = 0; i < FILMS; i++) {
        heard h;
        film_kind kind = (film_kind)(i % FILM_KINDS);
        draw_film(&film, (uint64_t)i, kind);
        zt_animation *animation = animation_of(film.text);
        zt_renderer *renderer = open_checked(animation, (zt_precision)(i / FILM_KINDS % 3), &h);
        if (render(renderer, NULL) != ZT_OK) fail_msg("film %d: %s\n%s", i, h.text, film.text);
        zt_stats stats = zt_renderer_stats(renderer);
        assert_int_equal(stats.frames, FRAMES);
        tiles[kind] += stats.tiles;
        copied[kind] += stats.copied_tiles;
        zt_renderer_close(&renderer);
        zt_animation_free(&animation);
    }
    for (int i = 0; i < FILM_KINDS; i++) {
        print_message("%s: %.1f %% of %d tiles are copied\n", film_kind_names[i],
                      100.0 * (double)copied[i] / (double)tiles[i], (int)tiles[i]);
        assert_true(copied[i] * 20 > tiles[i]);
    }
}

/* ---- that it can fail -----------------------------------------------------------------------
 */

/* A ball at the right moves; at the left, nothing does. */
static const char still[] =
    "zoetrope: 1\n"
    "film: { size: [48, 32], rate: 4, duration: 5, aovs: [Z] }\n"
    "camera: { position: [0, 0, 5] }\n"
    "lights:\n  - point: { position: [0, 3, 3], intensity: 20 }\n"
    "objects:\n"
    "  - plane: { normal: [0, 0, 1], distance: -1, material: { color: white } }\n"
    "  - sphere: { center: { curve: linear, keys: { 0: [2, 0, 0], 4: [2, 0.5, 0] } },\n"
    "              radius: 0.2, material: { color: red } }\n";

enum { X = 5, Y = 7 };

/* After the second frame, spoils a pixel of what the third is copied from. */
static void spoil(void *user, int64_t done, int64_t total, int64_t frame) {
    zt_reuse *reuse = ((zt_renderer *)user)->reuse;
    (void)total, (void)frame;
    if (done != 2) return;
    assert_true(reuse->last.whole);
    reuse->last.pixels[4 * (48 * Y + X) + 1] += 0x1p-20F;
    reuse->stamps[0] = UINT64_MAX; /* no image has the tile already */
}

static void wrong_tiles_are_found(void **state) {
    (void)state;
    heard h;
    zt_animation *animation = animation_of(still);
    for (int wrong = 0; wrong < 2; wrong++) {
        zt_renderer *renderer = open_checked(animation, ZT_PRECISION_AUTO, &h);
        const zt_watcher watcher = {.progress = wrong ? spoil : NULL, .user = renderer};
        assert_int_equal(render(renderer, &watcher), wrong ? ZT_EUNSUPPORTED : ZT_OK);
        if (wrong) assert_told(&h, "frame 2: with tiles copied, G of pixel (5, 7) is ");
        zt_renderer_close(&renderer);
    }
    zt_animation_free(&animation);
}

/* Each number of an image is compared, to the last bit. */
static void all_bits_are_compared(void **state) {
    (void)state;
    heard h;
    zt_taking t;
    zt_image *image;
    zt_animation *animation = animation_of(still);
    zt_renderer *renderer = open_checked(animation, ZT_PRECISION_AUTO, &h);
    assert_int_equal(zt_image_create(&image, 48, 32), ZT_OK);
    assert_int_equal(zt_image_add_aovs(image, ZT_AOV_Z), ZT_OK);
    assert_int_equal(zt_renderer_frame(renderer, 1, image, NULL), ZT_OK);
    assert_int_equal(zt_renderer_prepare(&t, renderer, 1), ZT_OK);
    assert_int_equal(zt_reuse_check(renderer, &t, 1, image), ZT_OK);
    struct {
        float *number;
        const char *told;
    } numbers[] = {{&image->pixels[0], "frame 1: with tiles copied, R of pixel (0, 0) is "},
                   {&image->pixels[4 * (48 * 32 - 1) + 3], "A of pixel (47, 31) is "},
                   {&image->channels[0].values[48 * 3 + 2], "Z of pixel (2, 3) is "}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        float was = *numbers[i].number;
        *numbers[i].number = nextafterf(was, 100);
        renderer->listener = listener_of(&h);
        assert_int_equal(zt_reuse_check(renderer, &t, 1, image), ZT_EUNSUPPORTED);
        assert_told(&h, numbers[i].told);
        *numbers[i].number = was;
    }
    assert_int_equal(zt_reuse_check(renderer, &t, 1, image), ZT_OK);
    zt_image_free(&image);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_films_are_the_same),
        cmocka_unit_test(wrong_tiles_are_found),
        cmocka_unit_test(all_bits_are_compared),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
