/* What sharing a frame's tiles out among threads costs: the part of the threads' time in which
 * they have none. A tile is stood for by three microseconds of counting, what 16 x 16 rays of a
 * simple scene take. Frames come one right after the other, or after a pause that lets the
 * threads fall asleep. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/clock.h"
#include "base/pool.h"

enum { ROUNDS = 101, THREADS_MAX = 256, TILE_NS = 3000 };

typedef struct frame {
    int count; /* to count to for a tile */
    struct {
        _Alignas(64) double begun_s, ended_s; /* 0: has had no tile */
    } threads[THREADS_MAX];
} frame;

static void count_to(int count) {
    for (volatile int i = 0; i < count; i++) continue;
}

static void tile(void *user, int task, int worker) {
    (void)task;
    frame *f = user;
    if (f->threads[worker].begun_s == 0) f->threads[worker].begun_s = zt_clock_s();
    count_to(f->count);
    f->threads[worker].ended_s = zt_clock_s();
}

/* How far one counts in the time of a tile, by the quickest of some trials. */
static int calibrate(void) {
    const int trial = 1000 * 1000;
    double best_s = 1;
    for (int i = 0; i < 10; i++) {
        double start_s = zt_clock_s();
        count_to(trial);
        double took_s = zt_clock_s() - start_s;
        if (took_s < best_s) best_s = took_s;
    }
    return (int)(trial * (1e-9 * TILE_NS) / best_s);
}

/* Before the first tile, and from the last one to the end of the frame. */
static double idle_share(frame *f, zt_pool *pool, int tile_count) {
    int thread_count = zt_pool_thread_count(pool);
    for (int t = 0; t < thread_count; t++) f->threads[t].begun_s = f->threads[t].ended_s = 0;
    double start_s = zt_clock_s();
    zt_pool_run(pool, tile_count, tile, f);
    double wall_s = zt_clock_s() - start_s, busy_s = 0;
    for (int t = 0; t < thread_count; t++)
        busy_s += f->threads[t].ended_s - f->threads[t].begun_s;
    return 1 - busy_s / (thread_count * wall_s);
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_share(frame *f, zt_pool *pool, int tile_count, long pause_ns) {
    double shares[ROUNDS];
    for (int r = 0; r < ROUNDS; r++) {
        if (pause_ns) nanosleep(&(struct timespec){.tv_nsec = pause_ns}, NULL);
        shares[r] = idle_share(f, pool, tile_count);
    }
    qsort(shares, ROUNDS, sizeof *shares, compare);
    return shares[ROUNDS / 2];
}

int main(void) {
    static frame f;
    static const struct {
        const char *size;
        int tile_count;
    } frames[] = {{"160x90", 60}, {"640x360", 920}, {"1280x720", 3600}};
    int thread_count = zt_pool_core_count() < THREADS_MAX ? zt_pool_core_count() : THREADS_MAX;
    zt_pool *pool;
    if (zt_pool_open(&pool, thread_count) != ZT_OK) return EXIT_FAILURE;
    f.count = calibrate();
    printf("\nthreads without a tile, in %% of a frame's time, %d threads\n", thread_count);
    printf("%-10s %14s %14s\n", "frame", "in a row", "after 1 ms");
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++)
        printf("%-10s %14.1f %14.1f\n", frames[i].size,
               100 * median_share(&f, pool, frames[i].tile_count, 0),
               100 * median_share(&f, pool, frames[i].tile_count, 1000 * 1000));
    zt_pool_close(&pool);
    return EXIT_SUCCESS;
}
