/* What is saved where frames are mostly the same again: films rendered with tiles copied from
 * the frame before, and without, in turn; their images are compared bit by bit first. */
#include <stdio.h>
#include <string.h>

#include "base/random.h"
#include "image/stamps.h"
#include "measure.h"
#include "sequence/keepsakes.h"
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

/* `samples`: how many, what is said of them, or "edges"; `radius` is that of the small thing,
 * if there is one; NULL: as it is written. */
static zt_animation *end_film(FILE *file, const char *samples, const char *radius) {
    must_be(fclose(file) == 0, "cannot write a film");
    bool edges = strcmp(samples, "edges") == 0;
    const zt_override overrides[] = {{edges ? "film.quality" : "film.samples", samples},
                                     {radius ? "small.radius" : NULL, radius},
                                     {0}};
    return film_open(scratch_path("film.yaml"), overrides);
}

/* A hall of 1,000 things that stand still, and eight lamps. */
static void write_still_hall(FILE *file) {
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
}

/* The same with a small ball that crosses it. */
static void write_hall(FILE *file) {
    write_still_hall(file);
    fprintf(
        file,
        "  - sphere: { name: small, radius: 0.15, material: matte, center: { keys: { 0: [-6, "
        "1.4, -4], "
        "400: [6, 1.4, -4] } } }\n");
}

/* The documents' room with its mirrors. */
static void write_still_room(FILE *file) {
    fprintf(file, "%s  - sphere: { center: [1.7, 0.9, 0.3], radius: 0.9, material: ball }\n",
            documents_room);
}

/* The same with a sphere that moves. */
static void write_room(FILE *file) {
    write_still_room(file);
    fprintf(
        file,
        "  - sphere: { radius: 0.25, material: ball, center: { keys: { 0: [-1.6, 0.4, 0.6], "
        "400: [0.2, 0.6, 1.4] } } }\n");
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
    /* As images of films have: a tile that one has already is not copied again. */
    must_be(zt_image_add_stamps(f.image) == ZT_OK, "stamps");
    return f;
}

static size_t image_size(const zt_image *image) {
    return 4 * sizeof(float) * (size_t)image->width * (size_t)image->height;
}

/* Of the first frames; returns how many tiles of them are copied. */
static double compare(frames *with, frames *without) {
    int64_t tiles = 0, copied = 0;
    for (int64_t i = 0; i < COMPARED; i++) {
        must_be(zt_renderer_frame(with->renderer, i, with->image, NULL) == ZT_OK &&
                    zt_renderer_frame(without->renderer, i, without->image, NULL) == ZT_OK,
                "a frame");
        must_be(memcmp(with->image->pixels, without->image->pixels, image_size(with->image)) ==
                    0,
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
    zt_animation *animation = end_film(file, samples, NULL);
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

/* ---- after an edit --------------------------------------------------------------------------
 */

enum { EDIT_FRAMES = ROUNDS + 2 };

/* The hall's next frames, by a run that keeps them, and copies from what was kept. */
static frames open_kept(const zt_animation *animation, const char *target, bool anew) {
    static int64_t numbers[EDIT_FRAMES];
    static const zt_frames all = {numbers, EDIT_FRAMES};
    for (int i = 0; i < EDIT_FRAMES; i++) numbers[i] = i;
    frames f = open_frames(animation, true);
    f.repeats = 1;
    const zt_keepsakes_order order = {scratch_path(target), &all, 0, INT64_C(4) << 30, anew};
    must(zt_keepsakes_open(&f.renderer->keepsakes, &order, f.renderer), "what was kept");
    return f;
}

static spent kept_run(void *user) {
    frames *f = user;
    zt_renderer *r = f->renderer;
    zt_hash key;
    spent begun = spent_now();
    must(zt_renderer_key(&key, r, f->next), "a key");
    must(zt_renderer_frame(r, f->next, f->image, NULL), "a frame");
    zt_keepsakes_take(r->keepsakes, f->next, key);
    f->next++;
    return spent_since(begun);
}

static void close_kept(frames *f) {
    zt_keepsakes_close(&f->renderer->keepsakes);
    frames_close(f);
}

static zt_animation *open_hall(const char *camera, const char *samples, const char *radius) {
    FILE *file = begin_film(camera);
    write_hall(file);
    return end_film(file, samples, radius);
}

static void measure_edit(const char *name, const char *camera, const char *samples) {
    if (wanted && !strstr(name, wanted)) return;
    zt_animation *before = open_hall(camera, samples, NULL),
                 *edited = open_hall(camera, samples, "0.2");
    frames first = open_kept(before, "first", true);
    for (int i = 0; i < EDIT_FRAMES; i++) kept_run(&first);
    close_kept(&first);
    frames anew = open_frames(edited, false), making = open_kept(before, "other", true),
           with = open_kept(edited, "first", false);
    anew.repeats = 1;
    kept_run(&with);
    frames_run(&anew);
    must_be(memcmp(with.image->pixels, anew.image->pixels, image_size(with.image)) == 0,
            "the same bits after an edit");
    runner runners[] = {{.name = "anew", .run = frames_run, .user = &anew},
                        {.name = "making", .run = kept_run, .user = &making},
                        {.name = "with", .run = kept_run, .user = &with}};
    race(runners, 3, ROUNDS);
    zt_stats stats = zt_renderer_stats(with.renderer);
    double a = runners[0].median.wall_s, m = runners[1].median.wall_s,
           w = runners[2].median.wall_s;
    printf("%-32s %8.2f %8.2f %8.2f %8.2f x %5.1f %%  %d\n", name, 1e3 * a, 1e3 * m, 1e3 * w,
           a / w, 100. * (double)stats.copied_tiles / (double)stats.tiles, (int)stats.found);
    frames_close(&anew);
    close_kept(&making);
    close_kept(&with);
    zt_animation_free(&before);
    zt_animation_free(&edited);
}

static void measure_edits(const char *still) {
    static const char moving[] = "position: { keys: { 0: [0, 4, 6], 400: [4, 4, 6] } }, "
                                 "look_at: [0, 1, -6], fov: 50 deg";
    printf("\nafter the small ball of the hall was made larger: rendered anew, of the film "
           "before\n"
           "and kept, and with tiles copied from what was kept; how many times quicker than "
           "anew;\n"
           "the tiles that are copied; of how many frames there was something.\n");
    measure_edit("edit, camera moves, 1 sample", moving, "1");
    measure_edit("edit, camera moves, 4 samples", moving, "4");
    measure_edit("edit, camera moves, 16 samples", moving, "16");
    measure_edit("edit, camera moves, edges", moving, "edges");
    measure_edit("edit, camera stands, 4 samples", still, "4");
    measure_edit("edit, camera stands, 16 samples", still, "16");
    measure_edit("edit, camera stands, edges", still, "edges");
}

/* ---- held frames ----------------------------------------------------------------------------
 */

static spent program_run(void *user) { return run_program(user, 1); }

/* Of a film in which nothing changes, to checksums: what all frames take more than the first.
 */
static void measure_held(const char *name, const char *camera, void (*write)(FILE *file)) {
    enum { HELD = 399 };
    if (wanted && !strstr(name, wanted)) return;
    FILE *file = begin_film(camera);
    write(file);
    must_be(fclose(file) == 0, "cannot write a film");
    char film[512];
    snprintf(film, sizeof film, "%s", scratch_path("film.yaml"));
#define RENDER(frames)                                                                         \
    (char *[]){ZT_BENCH_PROGRAM, "render",      "-q", film,        "--frames",                 \
               frames,           "--overwrite", "-o", "held.hash", NULL}
    runner runners[] = {{.name = "one", .run = program_run, .user = RENDER("0")},
                        {.name = "all", .run = program_run, .user = RENDER("0-399")}};
    race(runners, 2, ROUNDS);
    spent one = runners[0].median, all = runners[1].median;
    printf("%-32s %8.2f ms, %.2f of processor time: at most 1 ms\n", name,
           1e3 * (all.wall_s - one.wall_s) / HELD, 1e3 * (all.cpu_s - one.cpu_s) / HELD);
}

int main(int argc, char **argv) {
    static const char hall[] = "position: [0, 4, 6], look_at: [0, 1, -6], fov: 50 deg",
                      room[] =
                          "position: [1.2, 2.4, 7.5], look_at: [-0.2, 1.3, 0], fov: 40 deg",
                      adaptive[] = "{ min: 4, max: 64, error: 0.01 }";
    wanted = argc > 1 ? argv[1] : NULL;
    printf(
        "1280 x 720, milliseconds of wall time a frame, all rendered and with tiles copied;\n"
        "how many times quicker, by wall and by processor time, and how many it should be;\n"
        "the tiles that are copied; what freezing and preparing take of it.\n");
    measure("hall of 1,000 things, 1 sample", hall, write_hall, "1", "8 x");
    measure("hall of 1,000 things, 4 samples", hall, write_hall, "4", "8 x");
    measure("hall of 1,000 things, adaptive", hall, write_hall, adaptive, "");
    measure("hall of 1,000 things, edges", hall, write_hall, "edges", "");
    measure("documents' room, 1 sample", room, write_room, "1", "");
    measure("documents' room, 4 samples", room, write_room, "4", "3 x");
    measure("documents' room, 16 samples", room, write_room, "16", "3 x");
    measure("documents' room, adaptive", room, write_room, adaptive, "");
    measure("documents' room, edges", room, write_room, "edges", "");
    measure("everything moves, 1 sample", room, write_storm, "1", "0.98 x");
    measure("everything moves, 4 samples", room, write_storm, "4", "0.98 x");
    measure("everything moves, adaptive", room, write_storm, adaptive, "0.98 x");
    measure("everything moves, edges", room, write_storm, "edges", "0.98 x");
    measure_edits(hall);
    printf("\nheld frames, milliseconds of wall time each, to checksums:\n");
    measure_held("held, the documents' room", room, write_still_room);
    measure_held("held, the hall of 1,000 things", hall, write_still_hall);
    return 0;
}
