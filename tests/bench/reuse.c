/* What is saved where frames are mostly the same again: films rendered with tiles copied from
 * the frame before, and without, in turn; their images are compared bit by bit first. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "measure.h"
#include "sequence/renderer.h"

enum { ROUNDS = 7, FRAMES = 12, COMPARED = 16 };

static double draw(uint64_t key, double low, double high) {
    return low + (high - low) * (double)(zt_random_mix(key) >> 11) * 0x1p-53;
}

static FILE *begin_film(const char *camera) {
    FILE *file = fopen(scratch_path("film.yaml"), "wb");
    must_be(file != NULL, "cannot write a film");
    fprintf(file,
            "zoetrope: 1\n"
            "film: { size: [1280, 720], rate: 24, duration: 400, view: raw, reflections: 4 }\n"
            "camera: { %s }\n"
            "materials:\n"
            "  mirror: { color: [0.55, 0.6, 0.65], reflectivity: 0.35 }\n"
            "  ball: { color: [0.45, 0.4, 0.25], reflectivity: 0.6 }\n"
            "  matte: { color: [0.45, 0.6, 0.5] }\n",
            camera);
    return file;
}

static zt_animation *end_film(FILE *file, const char *samples) {
    must_be(fclose(file) == 0, "cannot write a film");
    const zt_override overrides[] = {{"film.samples", samples}, {0}};
    return film_open(scratch_path("film.yaml"), overrides);
}

/* A hall of 1,000 things that stand still, eight lamps, a small ball that crosses it. */
static void write_hall(FILE *file) {
    fprintf(file, "lights:\n  - ambient: { intensity: 0.2 }\n");
    for (int i = 0; i < 8; i++)
        fprintf(file, "  - point: { position: [%g, 7.5, %g], intensity: 12 }\n",
                -9.0 + 6 * (i % 4), i < 4 ? -3.0 : -12.0);
    fprintf(file, "objects:\n"
                  "  - plane: { normal: [0, 1, 0], material: matte }\n"
                  "  - plane: { normal: [0, -1, 0], distance: -8, material: matte }\n"
                  "  - plane: { normal: [0, 0, 1], distance: -16, material: matte }\n");
    for (uint64_t i = 0; i < 1000; i++) {
        uint64_t key = zt_random_key(1, i);
        double x = draw(key, -11, 11), z = draw(key + 1, -15, -1),
               size = draw(key + 2, 0.1, 0.3);
        if (i % 2)
            fprintf(
                file,
                "  - box: { center: [%.4f, %.4f, %.4f], size: [%.4f, %.4f, %.4f], material: "
                "matte }\n",
                x, size, z, size, 2 * size, size);
        else
            fprintf(
                file,
                "  - sphere: { center: [%.4f, %.4f, %.4f], radius: %.4f, material: matte }\n",
                x, size, z, size);
    }
    fprintf(file,
            "  - sphere: { radius: 0.15, material: matte, center: { keys: { 0: [-6, 1.4, -4], "
            "400: [6, 1.4, -4] } } }\n");
}

/* The documents' room with its mirrors, and a sphere that moves. */
static void write_room(FILE *file) {
    fprintf(
        file,
        "%s"
        "  - sphere: { center: [1.7, 0.9, 0.3], radius: 0.9, material: ball }\n"
        "  - sphere: { radius: 0.25, material: ball, center: { keys: { 0: [-1.6, 0.4, 0.6], "
        "400: [0.2, 0.6, 1.4] } } }\n",
        documents_room);
}

/* All that there is moves, and the camera stands still. */
static void write_storm(FILE *file) {
    write_room(file);
    for (uint64_t i = 0; i < 60; i++) {
        uint64_t key = zt_random_key(2, i);
        fprintf(file,
                "  - sphere: { radius: 0.3, material: %s, center: { keys: { 0: [%.3f, %.3f, "
                "%.3f], 400: [%.3f, %.3f, %.3f] } } }\n",
                i % 3 ? "matte" : "mirror", draw(key, -2.5, 2.5), draw(key + 1, 0.3, 2.7),
                draw(key + 2, -2.5, 1.5), draw(key + 3, -2.5, 2.5), draw(key + 4, 0.3, 2.7),
                draw(key + 5, -2.5, 1.5));
    }
}

/* ---- measuring ------------------------------------------------------------------------------
 */

static frames open_frames(const zt_animation *animation, bool reuses) {
    frames f = frames_open(animation, (zt_render_settings){0}, FRAMES);
    zt_render_settings settings = {.no_reuse = !reuses};
    zt_renderer_close(&f.renderer);
    must_be(zt_renderer_open(&f.renderer, animation, &settings, (zt_listener){0}) == ZT_OK,
            "a renderer");
    return f;
}

/* Of the first frames; returns how many tiles of them are copied. */
static double compare(frames *with, frames *without) {
    size_t size = 4 * sizeof(float) * (size_t)with->image->width * (size_t)with->image->height;
    int64_t tiles = 0, copied = 0;
    for (int64_t i = 0; i < COMPARED; i++) {
        must_be(zt_renderer_frame(with->renderer, i, with->image, NULL) == ZT_OK &&
                    zt_renderer_frame(without->renderer, i, without->image, NULL) == ZT_OK,
                "a frame");
        must_be(memcmp(with->image->pixels, without->image->pixels, size) == 0,
                "the same bits with and without");
        tiles += i < 2 ? 0 : with->renderer->cost.tiles;
        copied += i < 2 ? 0 : with->renderer->cost.tiles_copied;
    }
    with->next = without->next = COMPARED;
    return (double)copied / (double)tiles;
}

static const char *wanted; /* a part of the name of what is measured; NULL: all */

static void measure(const char *name, const char *camera, void (*write)(FILE *file),
                    const char *samples, const char *reach) {
    if (wanted && !strstr(name, wanted)) return;
    FILE *file = begin_film(camera);
    write(file);
    zt_animation *animation = end_film(file, samples);
    frames with = open_frames(animation, true), without = open_frames(animation, false);
    double copied = compare(&with, &without);
    runner runners[] = {{.name = "with", .run = frames_run, .user = &with},
                        {.name = "without", .run = frames_run, .user = &without}};
    race(runners, 2, ROUNDS);
    const zt_frame_cost *cost = &with.renderer->cost;
    spent a = runners[0].median, b = runners[1].median;
    printf("%-32s %8.2f %8.2f %8.2f x %8.2f x  %-6s  %4.1f %%  %.2f %.2f ms\n", name,
           1e3 * b.wall_s, 1e3 * a.wall_s, b.wall_s / a.wall_s, b.cpu_s / a.cpu_s, reach,
           100 * copied, 1e3 * cost->freeze_s, 1e3 * cost->prepare_s);
    frames_close(&with);
    frames_close(&without);
    zt_animation_free(&animation);
}

int main(int argc, char **argv) {
    static const char hall[] = "position: [0, 4, 6], look_at: [0, 1, -6], fov: 50 deg",
                      room[] =
                          "position: [1.2, 2.4, 7.5], look_at: [-0.2, 1.3, 0], fov: 40 deg";
    wanted = argc > 1 ? argv[1] : NULL;
    printf(
        "1280 x 720, milliseconds of wall time a frame, all rendered and with tiles copied;\n"
        "how many times quicker, by wall and by processor time, and how many it should be;\n"
        "the tiles that are copied; what freezing and preparing take of it.\n");
    measure("hall of 1,000 things, 1 sample", hall, write_hall, "1", "8 x");
    measure("hall of 1,000 things, 4 samples", hall, write_hall, "4", "8 x");
    measure("documents' room, 1 sample", room, write_room, "1", "");
    measure("documents' room, 4 samples", room, write_room, "4", "3 x");
    measure("documents' room, 16 samples", room, write_room, "16", "3 x");
    measure("everything moves, 1 sample", room, write_storm, "1", "0.98 x");
    measure("everything moves, 4 samples", room, write_storm, "4", "0.98 x");
    return 0;
}
