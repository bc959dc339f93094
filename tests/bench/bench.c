/* What rendering costs, as ratios within one run: threads against one thread, wide instructions
 * against narrow ones, and the demo film against its own playing time. Nothing is asserted:
 * these are figures to read. Run by `./dev bench`. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include <zoetrope/zoetrope.h>

enum { ROUNDS = 7 };

static double now_s(clockid_t clock) {
    struct timespec t;
    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void tell(void *user, const zt_message *message) {
    (void)user;
    char text[2048];
    zt_message_format(text, sizeof text, message);
    fprintf(stderr, "%s\n", text);
}

static void must(zt_status status, const char *what) {
    if (status == ZT_OK) return;
    fprintf(stderr, "bench: %s: %s\n", what, zt_status_text(status));
    exit(1);
}

static zt_animation *open_film(const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/animations/%s.yaml", ZT_BENCH_SOURCE_DIR, name);
    zt_animation *animation;
    must(zt_animation_read(&animation, path, NULL, 0, (zt_listener){tell, NULL}), path);
    return animation;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* One way of rendering a frame. */
typedef struct way {
    const char *isa; /* NULL: the widest */
    int threads;     /* 0: one a core */
    zt_renderer *renderer;
    double wall_s[ROUNDS];
} way;

/* Renders the middle frame in each way in turn, so that all see the same weather. */
static void compare_ways(const char *name, int samples) {
    zt_animation *animation = open_film(name);
    way ways[] = {{NULL, 0, NULL, {0}},
                  {NULL, 1, NULL, {0}},
                  {"avx2", 1, NULL, {0}},
                  {"base", 1, NULL, {0}}};
    int way_count = sizeof ways / sizeof ways[0];
    zt_image *image;
    for (int i = 0; i < way_count; i++) {
        if (ways[i].isa) setenv("ZOETROPE_ISA", ways[i].isa, 1);
        zt_render_settings settings = {.threads = ways[i].threads, .samples = samples};
        must(zt_renderer_open(&ways[i].renderer, animation, &settings,
                              (zt_listener){tell, NULL}),
             name);
        unsetenv("ZOETROPE_ISA");
    }
    zt_output_format format = zt_renderer_format(ways[0].renderer);
    must(zt_image_create(&image, format.width, format.height), name);
    int64_t frame = zt_animation_film(animation)->frame_count / 2;
    for (int round = -1; round < ROUNDS; round++) /* the first one warms up */
        for (int i = 0; i < way_count; i++) {
            double start = now_s(CLOCK_MONOTONIC);
            must(zt_renderer_frame(ways[i].renderer, frame, image, NULL), name);
            if (round >= 0) ways[i].wall_s[round] = now_s(CLOCK_MONOTONIC) - start;
        }
    double medians[4];
    for (int i = 0; i < way_count; i++) {
        qsort(ways[i].wall_s, ROUNDS, sizeof(double), compare);
        medians[i] = ways[i].wall_s[ROUNDS / 2];
        zt_renderer_close(&ways[i].renderer);
    }
    printf("%-8s %4d x %-4d %3d  %8.2f ms   1 thread x %.2f   avx2 x %.2f   base x %.2f\n",
           name, format.width, format.height, samples, 1e3 * medians[0],
           medians[1] / medians[0], medians[2] / medians[1], medians[3] / medians[1]);
    zt_image_free(&image);
    zt_animation_free(&animation);
}

/* The whole demo to a movie, against the time it plays. */
static void render_demo(void) {
    zt_animation *animation = open_film("demo");
    const zt_film *film = zt_animation_film(animation);
    zt_renderer *renderer;
    zt_output *output;
    zt_listener listener = {tell, NULL};
    zt_render_settings settings = {0};
    must(zt_renderer_open(&renderer, animation, &settings, listener), "demo");
    zt_output_format format = zt_renderer_format(renderer);
    double wall = now_s(CLOCK_MONOTONIC), cpu = now_s(CLOCK_PROCESS_CPUTIME_ID);
    must(zt_output_open(&output, "bench-demo.mp4", &format, NULL, listener), "bench-demo.mp4");
    must(zt_renderer_sequence(renderer, 0, film->frame_count - 1, output, NULL), "demo");
    must(zt_output_close(&output), "bench-demo.mp4");
    wall = now_s(CLOCK_MONOTONIC) - wall;
    cpu = now_s(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    double plays = zt_rate_time(film->rate, film->frame_count);
    printf("demo to MP4: %lld frames in %.2f s (%.2f s of CPU), plays %.2f s: %.2f x as fast "
           "as it "
           "plays\n",
           (long long)film->frame_count, wall, cpu, plays, plays / wall);
    unlink("bench-demo.mp4");
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

int main(void) {
    printf("median of %d; \"x\" is how many times as long\n", ROUNDS);
    compare_ways("fig1b", 1);
    compare_ways("fig1b", 16);
    compare_ways("fig1a", 1);
    compare_ways("demo", 1);
    render_demo();
    return 0;
}
