/* One frame rendered in several ways: threads, widths of instructions, sizes. */
#include <stdio.h>

#include "bench.h"
#include "measure.h"

/* How a frame is rendered, and what the first way's time over this one's should be. */
typedef struct way {
    const char *name;
    const char *isa; /* NULL: the widest */
    zt_render_settings settings;
    double reach;
} way;

enum { ROUNDS = 9, WAYS_MAX = 8 };

/* Prints each way with how many times as long as the first one it takes, for each pixel. */
static void compare(const char *film, int samples, const way *ways, int count, int repeats) {
    zt_animation *animation = film_open(film, NULL);
    frames opened[WAYS_MAX];
    runner runners[WAYS_MAX];
    double pixels[WAYS_MAX];
    for (int i = 0; i < count; i++) {
        zt_render_settings settings = ways[i].settings;
        settings.samples = samples;
        opened[i] = frames_open(animation, settings, repeats);
        opened[i].isa = ways[i].isa;
        zt_output_format format = zt_renderer_format(opened[i].renderer);
        pixels[i] = (double)format.width * format.height;
        opened[i].repeats = (int)(repeats * (pixels[0] / pixels[i])); /* about as long */
        runners[i] = (runner){.name = ways[i].name, .run = frames_run, .user = &opened[i]};
    }
    race(runners, count, ROUNDS);
    print_title("%s, %d sample%s", film, samples, samples == 1 ? "" : "s");
    for (int i = 0; i < count; i++) {
        print_spent(runners[i].name, runners[i].median);
        double times = runners[i].median.wall_s / pixels[i];
        if (i > 0) print_ratio(times / (runners[0].median.wall_s / pixels[0]), ways[i].reach);
        if (ways[i].settings.threads == 0)
            printf("  %.2f cores busy", runners[i].median.cpu_s / runners[i].median.wall_s);
        print_end();
        frames_close(&opened[i]);
    }
    zt_animation_free(&animation);
}

void bench_ways(void) {
    static const way ways[] = {
        {.name = "one thread a core"},
        {.name = "one thread", .settings.threads = 1, .reach = 1.9},
        {.name = "one thread, avx2", .isa = "avx2", .settings.threads = 1},
        {.name = "one thread, base", .isa = "base", .settings.threads = 1},
        {.name = "one thread, scalar", .isa = "scalar", .settings.threads = 1},
        {.name = "double precision", .settings.precision = ZT_PRECISION_DOUBLE},
        {.name = "160 x 90, for each pixel", .settings = {.width = 160, .height = 90}},
    };
    int count = sizeof ways / sizeof *ways;
    compare("fig1b", 1, ways, count, 8);
    compare("fig1b", 16, ways, count, 1);
    compare("fig1a", 1, ways, count, 4);
    compare("demo", 1, ways, count, 4);
}
