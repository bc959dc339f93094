/* What rendering costs, as ratios within one run, beside what they should reach. Nothing is
 * asserted: these are figures to read (README.md). Run by `./dev bench`, with --peers against
 * other ray tracers too. */
#include "bench.h"

#include <stdio.h>
#include <string.h>

int main(int argc, char **argv) {
    bool with_peers = argc == 2 && strcmp(argv[1], "--peers") == 0;
    if (argc != 1 && !with_peers) {
        fprintf(stderr, "Usage: %s [--peers]\n", argv[0]);
        return 2;
    }
    printf("Medians of interleaved rounds, milliseconds of wall and processor time a frame.\n");
    if (with_peers) bench_duels();
    bench_starts(with_peers);
    bench_ways();
    bench_floors();
    bench_features();
    bench_growth();
    bench_movie();
    return 0;
}
