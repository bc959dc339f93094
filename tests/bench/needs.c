/* What is left out within a frame: 200 lamps of which four reach the room that is seen, against
 * those four alone and against doing everything, bits compared; and programs as a whole: how
 * long they take to begin, and how much memory. A program of its own. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "measure.h"

enum { COLUMNS = 10, ROWS = 5, SIDE = 4, ROUNDS = 7, STARTS = 21 };

/* ---- rooms ---------------------------------------------------------------------------------
 */

static void write_lamps(FILE *file, int column, int row) {
    for (int i = 0; i < 4; i++)
        fprintf(file, "  - point: { position: [%d, 2.5, %d], intensity: 1.5 }\n",
                column * SIDE + 1 + 2 * (i & 1), row * SIDE + 1 + 2 * (i >> 1));
}

/* Rooms of 4 x 4, 3 high, behind walls, a camera in the middle one; with the lamps of all of
 * them, or its own. */
static zt_animation *rooms(bool all) {
    const char *path = scratch_path(all ? "all.yaml" : "own.yaml");
    FILE *file = fopen(path, "w");
    must_be(file != NULL, "no description");
    fputs("zoetrope: 1\nfilm: { size: [640, 640], rate: 24, duration: 1 }\n"
          "camera: { position: [16.4, 2.9, 8.4], look_at: [19, 0.5, 11], fov: 75 deg }\n"
          "materials: { wall: { color: [0.7, 0.6, 0.5] }, ball: { color: [0.3, 0.6, 0.8] } }\n"
          "lights:\n  - ambient: { intensity: 0.1 }\n",
          file);
    for (int i = 0; i < COLUMNS * ROWS; i++)
        if (all || (i % COLUMNS == 4 && i / COLUMNS == 2))
            write_lamps(file, i % COLUMNS, i / COLUMNS);
    fputs("objects:\n  - plane: { normal: [0, 1, 0], distance: 0, material: wall }\n"
          "  - plane: { normal: [0, 1, 0], distance: 3, material: wall }\n",
          file);
    for (int i = 0; i <= COLUMNS; i++)
        fprintf(file,
                "  - box: { center: [%d, 1.5, %g], size: [0.2, 3.2, %g], material: wall }\n",
                i * SIDE, ROWS * SIDE / 2., ROWS * SIDE + .2);
    for (int i = 0; i <= ROWS; i++)
        fprintf(file,
                "  - box: { center: [%g, 1.5, %d], size: [%g, 3.2, 0.2], material: wall }\n",
                COLUMNS * SIDE / 2., i * SIDE, COLUMNS * SIDE + .2);
    for (int i = 0; i < 3; i++)
        fprintf(file, "  - sphere: { center: [%d, 0.5, %g], radius: 0.5, material: ball }\n",
                17 + i, 10 + .6 * i);
    must_be(fclose(file) == 0, "no description");
    return film_open(path, NULL);
}

typedef struct way {
    frames frames;
    const char *everything; /* of ZOETROPE_EVERYTHING */
} way;

static spent way_run(void *user) {
    way *w = user;
    setenv("ZOETROPE_EVERYTHING", w->everything, 1);
    spent s = frames_run(&w->frames);
    setenv("ZOETROPE_EVERYTHING", "0", 1);
    return s;
}

static bool same_bits(const way *a, const way *b) {
    const zt_image *x = a->frames.image, *y = b->frames.image;
    size_t size = 4 * sizeof(float) * (size_t)x->width * (size_t)x->height;
    return memcmp(x->pixels, y->pixels, size) == 0;
}

static void bench_lamps(void) {
    zt_animation *own = rooms(false), *all = rooms(true);
    const zt_render_settings settings = {.samples = 4, .no_reuse = true};
    const zt_render_settings once = {.samples = 1, .no_reuse = true};
    way ways[] = {{frames_open(own, settings, 1), "0"},
                  {frames_open(all, settings, 1), "0"},
                  {frames_open(all, once, 1), "0"},
                  {frames_open(all, once, 1), "1"}};
    runner runners[] = {{.name = "its own four lamps", .run = way_run, .user = &ways[0]},
                        {.name = "200 lamps", .run = way_run, .user = &ways[1]},
                        {.name = "200 lamps, one sample", .run = way_run, .user = &ways[2]},
                        {.name = "the same, everything", .run = way_run, .user = &ways[3]}};
    race(runners, 4, ROUNDS);
    print_title("a room of 50, 4 lamps each: 640 x 640, 4 samples");
    for (int i = 0; i < 4; i++) {
        print_spent(runners[i].name, runners[i].median);
        if (i == 1) print_ratio(runners[1].median.wall_s / runners[0].median.wall_s, -1.5);
        if (i == 3) print_ratio(runners[3].median.wall_s / runners[2].median.wall_s, 0);
        print_end();
    }
    must_be(same_bits(&ways[0], &ways[1]), "lamps behind walls change the picture");
    must_be(same_bits(&ways[2], &ways[3]), "what is left out changes the picture");
    puts("bits: the same");
    for (int i = 0; i < 4; i++) frames_close(&ways[i].frames);
    zt_animation_free(&own);
    zt_animation_free(&all);
}

/* ---- programs ------------------------------------------------------------------------------
 */

static spent program_run(void *user) { return run_program(user, 1); }

static void bench_programs(void) {
    static char room[] = ZT_BENCH_SOURCE_DIR "/animations/fig1b.yaml",
                knot[] = ZT_BENCH_SOURCE_DIR "/animations/fig1a.yaml";
#define FRAME(film, size, target)                                                              \
    (char *const[]) {                                                                          \
        ZT_BENCH_PROGRAM, "frame", "-q", film, "0", "--size", size, "--overwrite", "-o",       \
            target, NULL                                                                       \
    }
    struct {
        const char *name;
        char *const *arguments;
        double limit_ms;
    } rows[] = {{"to a checksum", FRAME(room, "16x16", "start.hash"), 15},
                {"to MP4", FRAME(room, "16x16", "start.mp4"), 60},
                {"ffmpeg -version", (char *const[]){"ffmpeg", "-version", NULL}, 0},
                {"oiiotool --version", (char *const[]){"oiiotool", "--version", NULL}, 0},
                {"the room to MP4, 1280 x 720", FRAME(room, "1280x720", "start.mp4"), 0},
                {"the room to PNG", FRAME(room, "1280x720", "start.png"), 0},
                {"the knot to a checksum", FRAME(knot, "1280x720", "start.hash"), 0},
                {"the knot to MP4", FRAME(knot, "1280x720", "start.mp4"), 0},
                {"the knot to PNG", FRAME(knot, "1280x720", "start.png"), 0}};
    enum { COUNT = sizeof rows / sizeof *rows };
    runner runners[COUNT];
    for (int i = 0; i < COUNT; i++)
        runners[i] = (runner){
            .name = rows[i].name, .run = program_run, .user = (void *)rows[i].arguments};
    print_title("whole processes: a frame of the room of 16 x 16 pixels, and larger ones");
    for (int i = 0; i < COUNT; i++) {
        struct rusage usage;
        race(&runners[i], 1, STARTS);
        print_spent(runners[i].name, runners[i].median);
        if (rows[i].limit_ms > 0) print_limit(runners[i].median, rows[i].limit_ms);
        /* The largest of all so far, which the first is the least of. */
        must_be(getrusage(RUSAGE_CHILDREN, &usage) == 0, "no usage");
        printf("  at most %.1f MB", (double)usage.ru_maxrss / 1024);
        print_end();
    }
}

static void bench_size(void) {
    struct stat file;
    must_be(stat(ZT_BENCH_PROGRAM, &file) == 0, "no program");
    print_title("the program");
    zt_library libraries[ZT_LIBRARY_COUNT];
    zt_libraries(libraries);
    printf("%.2f MB; built without:", (double)file.st_size / (1 << 20));
    int left = 0;
    for (int i = 0; i < ZT_LIBRARY_COUNT; i++)
        if (!libraries[i].built && ++left) printf(" %s", libraries[i].name);
    puts(left ? "" : " nothing");
}

int main(void) {
    bench_programs();
    bench_lamps();
    bench_size();
    return 0;
}
