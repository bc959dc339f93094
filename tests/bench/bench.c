/* What rendering costs, as ratios within one run, beside what they should reach. Nothing is
 * asserted: these are figures to read (README.md). Run by `./dev bench`, with --peers against
 * other ray tracers too. Names of parts choose. */
#include "bench.h"

#include <stdio.h>
#include <string.h>

static bool with_peers;

static void duels(void) {
    if (with_peers) bench_duels();
}

static void starts(void) { bench_starts(with_peers); }

static const struct {
    const char *name;
    void (*run)(void);
} parts[] = {{"duels", duels},         {"starts", starts},           {"ways", bench_ways},
             {"floors", bench_floors}, {"features", bench_features}, {"growth", bench_growth},
             {"movie", bench_movie}};
enum { PART_COUNT = sizeof parts / sizeof *parts };

static int part_of(const char *name) {
    int part = 0;
    while (part < PART_COUNT && strcmp(parts[part].name, name) != 0) part++;
    return part;
}

int main(int argc, char **argv) {
    bool chosen[PART_COUNT] = {false};
    with_peers = argc > 1 && strcmp(argv[1], "--peers") == 0;
    int first = with_peers ? 2 : 1;
    for (int i = first; i < argc; i++) {
        int part = part_of(argv[i]);
        if (part == PART_COUNT) {
            fprintf(stderr,
                    "Usage: %s [--peers] [duels|starts|ways|floors|features|growth|movie]...\n",
                    argv[0]);
            return 2;
        }
        chosen[part] = true;
    }
    printf("Medians of interleaved rounds, milliseconds of wall and processor time a frame.\n");
    for (int part = 0; part < PART_COUNT; part++)
        if (argc == first || chosen[part]) parts[part].run();
    return 0;
}
