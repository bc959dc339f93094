/* Whole processes that render next to nothing: what it takes to begin. */
#include <stdio.h>

#include "bench.h"
#include "measure.h"
#include "peers.h"

enum { ROUNDS = 21 };

static const struct {
    const char *film;
    double limit_ms;
} rows[] = {{"fig1b", 15}, {"fig1a", 60}};

typedef struct program {
    char *const *arguments;
} program;

static spent program_run(void *user) { return run_program(((program *)user)->arguments, 1); }

static void start(const char *film, double limit_ms, bool with_peers) {
    char path[512], scene[64];
    snprintf(path, sizeof path, "%s/animations/%s.yaml", ZT_BENCH_SOURCE_DIR, film);
    snprintf(scene, sizeof scene, "%s.tachyon", film);
    program own = {(char *const[]){ZT_BENCH_PROGRAM, "frame", "-q", path, "0", "--size",
                                   "16x16", "-o", "start.hash", NULL}};
    program peer = {(char *const[]){"tachyon", scene, "-res", "16", "16", "-format", "PPM",
                                    "-o", "start.ppm", NULL}};
    runner runners[] = {{.name = "zoetrope", .run = program_run, .user = &own},
                        {.name = "tachyon", .run = program_run, .user = &peer}};
    if (with_peers) write_peers(film, 16, 16);
    race(runners, with_peers ? 2 : 1, ROUNDS);
    print_title("start: %s, one frame of 16 x 16 pixels, whole process", film);
    print_spent(runners[0].name, runners[0].median);
    print_limit(runners[0].median, limit_ms);
    print_end();
    if (!with_peers) return;
    print_spent(runners[1].name, runners[1].median);
    print_ratio(runners[1].median.wall_s / runners[0].median.wall_s, 0);
    print_end();
}

void bench_starts(bool with_peers) {
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        start(rows[i].film, rows[i].limit_ms, with_peers);
}
