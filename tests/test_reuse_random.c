/* Random scenes of all kinds of things, lamps and lenses, of which random parts change from
 * frame to frame; frames come in any order, some again and again. Whatever is copied has the
 * bits of what is rendered. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "meshes.h"
#include "random_scenes.h"
#include "reel.h"

enum { SCENES = 300, FRAMES = 5, SHOWN = 9 };

/* Which pixels take how many samples. */
typedef enum kind { EVEN, SIGNED, ADAPTIVE, EDGES, KINDS } kind;
static const char *const kind_names[KINDS] = {"even", "signed", "adaptive", "edges"};

/* By any filter. */
static zt_sampling draw_sampling(draw *d, kind kind) {
    static const int samples[] = {1, 1, 1, 4, 16}, least[] = {1, 2, 4, 7};
    zt_sampling s = {.filter = draw_below(d, 3) ? ZT_FILTER_BOX
                                                : (zt_filter)draw_below(d, ZT_FILTER_COUNT),
                     .seed_fixed = draw_below(d, 4) == 0};
    if (kind == SIGNED) s.filter = ZT_FILTER_MITCHELL;
    s.min = s.max = samples[draw_below(d, 5)];
    if (kind < ADAPTIVE) return s;
    s.edges = kind == EDGES;
    s.min = s.edges ? 1 : least[draw_below(d, 4)];
    s.max = 8 << draw_below(d, 2);
    s.error = draw_below(d, 2) ? 0.05 : 0.01;
    if (draw_below(d, 8) == 0) s.mean_max = 3;
    return s;
}

static void show_scene(reel *r, uint64_t key, const zt_mesh *meshes) {
    static test_scene base, moments[2];
    static const double times[] = {0, 1};
    static const bool steps[] = {false, false};
    draw d = {key, 0};
    draw_scene(&d, &base, meshes);
    r->sampling = draw_sampling(&d, key % KINDS);
    r->transparent = draw_below(&d, 8) == 0;
    r->precision = draw_below(&d, 3);
    bool blurred = draw_below(&d, 5) == 0, stays[SCENE_OBJECTS_MAX];
    /* Whether it is true decides what is kept, but not what is seen. */
    for (int i = 0; i < SCENE_OBJECTS_MAX; i++) stays[i] = draw_below(&d, 4) > 0;
    for (int i = 0; i < SHOWN; i++) {
        int frame = i < 2 ? 0 : draw_below(&d, FRAMES);
        frame_of(moments, &base, key ^ UINT64_C(0x5eed), frame);
        zt_scene both[2] = {moments[0].scene, moments[1].scene};
        zt_exposure exposure = {.moments = both,
                                .times = times,
                                .steps = steps,
                                .moment_count = blurred ? 2 : 1,
                                .stays = stays};
        r->fresh = i == SHOWN - 1;
        reel_expose(r, &exposure);
    }
}

static void copied_or_rendered_it_is_the_same(void **state) {
    (void)state;
    static zt_mesh meshes[MESHES];
    meshes[0] = cube_mesh();
    ball_mesh ball = make_ball(2);
    meshes[1] = ball.mesh;
    int64_t shown[KINDS] = {0}, copied[KINDS] = {0};
    for (uint64_t i = 0; i < SCENES; i++) {
        reel r;
        reel_open(&r, meshes, MESHES);
        show_scene(&r, i, meshes);
        shown[i % KINDS] += r.shown;
        copied[i % KINDS] += r.copied;
        reel_close(&r);
    }
    free_ball(&ball);
    for (int i = 0; i < KINDS; i++) {
        print_message("%s: %.1f %% of %d tiles are copied\n", kind_names[i],
                      100.0 * (double)copied[i] / (double)shown[i], (int)shown[i]);
        assert_true(copied[i] * 5 > shown[i]);
    }
}

/* ---- where it matters in which order things are asked ---------------------------------------
 */

/* Stacks of three disks, each of which is about as far as the next one, but for roundings, and
 * the first is not as far as the third. Which of them is met depends on the order in which they
 * are asked, and so on the rays that travel together, also back from a mirror behind them. They
 * come after a while, at the left; a ball moves before them, others stand about. */
static void show_stacks(reel *r, uint64_t key) {
    enum { OTHERS = 40, STACKS = 50, SHOWS = 8 };
    static test_scene s;
    draw d = {key, 0};
    scene_begin(&s);
    for (int i = 0; i < MATERIALS; i++) scene_material(&s, draw_color(&d), i == 0 ? 0.8 : 0);
    s.scene.reflection_depth = 1;
    scene_ambient(&s, (vec3){1, 1, 1}, 1);
    scene_plane(&s, (vec3){0, 0, 1}, -12, 0);
    for (int i = 0; i < OTHERS; i++) scene_sphere(&s, draw_place(&d), 0.1, 1);
    int others = s.scene.object_count, begin = draw_below(&d, SHOWS);
    for (int i = 0; i < STACKS; i++) {
        vec3 at = {draw_between(&d, -5, 0.5), draw_between(&d, -5, 5), -6};
        double step = 0x1p-18 * draw_between(&d, 0.3, 6);
        for (int k = 0; k < 3; k++, at.z += step)
            scene_object(&s, ZT_SHAPE_DISK, 1 + draw_below(&d, MATERIALS - 1))->disk =
                (zt_disk){at, {0, 0, 1}, draw_between(&d, 0.2, 1)};
    }
    int all = s.scene.object_count;
    r->sampling = draw_sampling(&d, key % KINDS);
    r->precision = ZT_PRECISION_SINGLE;
    for (int i = 0; i < SHOWS; i++) {
        s.scene.object_count = i < begin ? others : all;
        s.objects[1].sphere.center =
            (vec3){draw_between(&d, -3, 1), draw_between(&d, -3, 3), -4};
        reel_show(r, &s.scene);
    }
}

static void order_makes_no_difference(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 40; i++) {
        reel r;
        reel_open(&r, NULL, 0);
        show_stacks(&r, i);
        reel_close(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(order_makes_no_difference),
        cmocka_unit_test(copied_or_rendered_it_is_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
