/* The floor under a frame: the kernels alone, in a bare loop on one core over rays that lie
 * ready, without sampling, lens, film, image or threads. */
#include <assert.h>
#include <stdio.h>

#include "bench.h"
#include "keyframe/animation.h"
#include "measure.h"
#include "render/lens.h"

enum { WIDTH = 1280, HEIGHT = 720, ROUNDS = 9, SIDE = 16, BLOCK = 4 };
enum { COLUMNS = WIDTH / SIDE, TILES = COLUMNS * (HEIGHT / SIDE) };
static_assert(SIDE * SIDE == ZT_BATCH, "a tile is a batch");

/* The rays of a tile through the middle of its pixels, in blocks of 4 x 4. */
static void make_rays(zt_rays *rays, const zt_lens *lens, int tile) {
    float x[ZT_BATCH], y[ZT_BATCH];
    for (int i = 0; i < ZT_BATCH; i++) {
        int block = i / (BLOCK * BLOCK), within = i % (BLOCK * BLOCK), across = SIDE / BLOCK;
        int column = tile % COLUMNS * SIDE + block % across * BLOCK + within % BLOCK;
        int row = tile / COLUMNS * SIDE + block / across * BLOCK + within / BLOCK;
        x[i] = (float)column + 0.5f;
        y[i] = (float)row + 0.5f;
    }
    zt_lens_rays(rays, lens, x, y, NULL, NULL, ZT_BATCH);
}

typedef struct loop {
    zt_ready ready;
    const zt_lens *lens;
    zt_rays *rays; /* of a row of tiles: few enough for a cache */
    void *work;
} loop;

static spent loop_run(void *user) {
    loop *l = user;
    zt_radiance light;
    spent sum = {0, 0};
    for (int first = 0; first < TILES; first += COLUMNS) {
        for (int i = 0; i < COLUMNS; i++) make_rays(&l->rays[i], l->lens, first + i);
        spent start = spent_now();
        for (int i = 0; i < COLUMNS; i++)
            l->ready.kernel->trace(&light, l->ready.tracer, &l->rays[i], l->work);
        spent row = spent_since(start);
        sum = (spent){sum.wall_s + row.wall_s, sum.cpu_s + row.cpu_s};
    }
    return sum;
}

static void measure(const char *film) {
    zt_animation *animation = film_open(film, NULL);
    zt_arena arena = {0};
    zt_scene scene;
    zt_meshes *meshes;
    must(zt_animation_freeze(&scene, animation, 0, &arena, to_stderr), film);
    must(zt_meshes_open(&meshes, scene.meshes, scene.mesh_count, 1, to_stderr), film);
    zt_lens *lens;
    zt_exposure own = zt_exposure_of(&scene);
    must(zt_lens_prepare(&lens, &own, WIDTH, HEIGHT, &arena), film);
    zt_rays *rays = ZT_PUSH(&arena, zt_rays, COLUMNS);
    void *work = zt_arena_push(&arena, zt_kernel_work_size());
    must_be(rays && work, "out of memory");
    zt_scene bare = scene; /* what primary rays hit, and its color */
    bare.light_count = bare.reflection_depth = 0;
    const zt_scene *scenes[] = {&scene, &bare};
    loop loops[2];
    runner runners[] = {{"all of the light", loop_run, &loops[0], {0, 0}},
                        {"primary rays alone", loop_run, &loops[1], {0, 0}}};
    for (int i = 0; i < 2; i++) {
        loops[i] = (loop){.lens = lens, .rays = rays, .work = work};
        zt_exposure exposure = zt_exposure_of(scenes[i]);
        must(zt_tracer_prepare(&loops[i].ready, &exposure, ZT_PRECISION_AUTO,
                               zt_lens_pixel(&scene.camera, HEIGHT), meshes, &arena),
             film);
    }
    race(runners, 2, ROUNDS);
    print_title("%s, the kernels alone in a bare loop on one core, 1 sample", film);
    for (int i = 0; i < 2; i++) {
        print_spent(runners[i].name, runners[i].median);
        printf("  %.1f million primary rays a second",
               1e-6 * WIDTH * HEIGHT / runners[i].median.wall_s);
        print_end();
    }
    zt_meshes_close(&meshes);
    zt_arena_free(&arena);
    zt_animation_free(&animation);
}

void bench_floors(void) {
    measure("fig1b");
    measure("fig1a");
}
