/* What keyframes cost: evaluations a second of one track on one core, by how many keys it has
 * and in which order it is asked, and the time to freeze a scene in which ten thousand things
 * move. Nothing is asserted: these are figures to read. Run by `./dev bench`. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "base/random.h"
#include "keyframe/animation.h"

enum { QUERIES = 1 << 20, MOVING = 10000, KEYS = 100, ROUNDS = 5 };

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double draw(uint64_t key) { return (double)(zt_random_mix(key) >> 11) * 0x1p-53; }

static void must(int good, const char *what) {
    if (good) return;
    fprintf(stderr, "bench: %s failed\n", what);
    exit(1);
}

/* A track of keys about a second apart. */
static zt_curve make(zt_arena *arena, zt_value_kind value_kind, zt_curve_kind kind, int count) {
    zt_arena temporary = {0};
    zt_key *keys = ZT_PUSH(&temporary, zt_key, (size_t)count);
    double(*values)[4] = zt_arena_push_array(&temporary, sizeof *values, (size_t)count);
    must(keys && values, "memory");
    for (int k = 0; k < count; k++) {
        for (int c = 0; c < 4; c++) values[k][c] = draw((uint64_t)(4 * k + c)) - 0.5;
        keys[k] =
            (zt_key){.time_s = k + 0.5 * draw((uint64_t)k), .value = values[k], .kind = kind};
    }
    zt_curve_spec spec = {.value_kind = value_kind, .key_count = count, .keys = keys};
    zt_curve curve;
    must(zt_curve_from_keys(&curve, arena, &spec) == ZT_OK, "a curve");
    zt_arena_free(&temporary);
    return curve;
}

/* Millions of evaluations a second, the best of some rounds. */
static double rate(const zt_curve *curve, const double *times, double *sum) {
    double best = 0;
    for (int round = 0; round < ROUNDS; round++) {
        double start = now_s(), value[ZT_VALUE_WIDTH_MAX];
        for (int i = 0; i < QUERIES; i++) {
            zt_curve_eval(value, curve, times[i]);
            *sum += value[0];
        }
        double per_s = QUERIES / (now_s() - start);
        if (per_s > best) best = per_s;
    }
    return best / 1e6;
}

static void evaluate(double *sum) {
    static const struct {
        const char *name;
        zt_value_kind value_kind;
        zt_curve_kind kind;
    } tracks[] = {{"number", ZT_VALUE_NUMBER, ZT_CURVE_LINEAR},
                  {"number", ZT_VALUE_NUMBER, ZT_CURVE_SMOOTH},
                  {"number", ZT_VALUE_NUMBER, ZT_CURVE_BEZIER},
                  {"vector", ZT_VALUE_VECTOR, ZT_CURVE_SMOOTH},
                  {"rotation", ZT_VALUE_ROTATION, ZT_CURVE_LINEAR},
                  {"rotation", ZT_VALUE_ROTATION, ZT_CURVE_SMOOTH}};
    static const int counts[] = {2, 100, 1000000};
    double *times = calloc(QUERIES, sizeof *times);
    must(times != NULL, "memory");
    printf("million evaluations a second    keys:      2      100  1000000\n");
    for (size_t t = 0; t < sizeof tracks / sizeof *tracks; t++)
        for (int at_random = 0; at_random < 2; at_random++) {
            printf("%-9s %-8s %-14s     ", tracks[t].name, zt_curve_name(tracks[t].kind),
                   at_random ? "at random" : "in order");
            for (int n = 0; n < 3; n++) {
                zt_arena arena = {0};
                zt_curve curve = make(&arena, tracks[t].value_kind, tracks[t].kind, counts[n]);
                for (int i = 0; i < QUERIES; i++)
                    times[i] =
                        (counts[n] - 1) * (at_random ? draw((uint64_t)i) : (double)i / QUERIES);
                printf(" %8.1f", rate(&curve, times, sum));
                zt_arena_free(&arena);
            }
            printf("\n");
        }
    free(times);
}

/* Ten thousand spheres, each with a center on a smooth curve of its own. */
static void freeze(double *sum) {
    zt_animation animation = {.film = {.frame_count = 1}};
    zt_arena *arena = &animation.arena, frame = {0};
    zt_track *tracks = ZT_PUSH(arena, zt_track, MOVING);
    animation.rest.objects = ZT_PUSH(arena, zt_object, MOVING);
    must(tracks && animation.rest.objects, "memory");
    animation.rest.object_count = animation.track_count = MOVING;
    for (int i = 0; i < MOVING; i++) {
        zt_property_rest(&animation.rest, ZT_OWNER_SPHERE, i);
        tracks[i] = (zt_track){.property = zt_property_find(ZT_OWNER_SPHERE, "center"),
                               .index = i,
                               .name = "ball.center",
                               .curve = make(arena, ZT_VALUE_VECTOR, ZT_CURVE_SMOOTH, KEYS)};
    }
    animation.tracks = tracks;
    double best = 1e9;
    for (int round = 0; round < 5 * ROUNDS; round++) {
        zt_scene scene;
        zt_arena_reset(&frame);
        double start = now_s();
        must(zt_animation_freeze(&scene, &animation, round * 3.7, &frame, (zt_listener){0}) ==
                 ZT_OK,
             "freezing");
        double took = now_s() - start;
        if (took < best) best = took;
        *sum += scene.objects[MOVING - 1].sphere.center.x;
    }
    printf("freezing %d moving objects: %.2f ms\n", MOVING, 1e3 * best);
    zt_arena_free(&frame);
    zt_arena_free(arena);
}

int main(void) {
    double sum = 0; /* so that nothing is left out as unused */
    evaluate(&sum);
    freeze(&sum);
    return sum == 0.12345;
}
