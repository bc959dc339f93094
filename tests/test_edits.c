/* Scenes that are edited between two runs: tiles copied from what the first one kept have the
 * bits of rendering, whatever came, went or changed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "keeping.h"
#include "meshes.h"
#include "random_scenes.h"

static const zt_sampling edges = {.min = 1, .max = 16, .error = 0.02, .edges = true};

static void assert_between(int64_t copied, int least, int most) {
    if (copied < least || copied > most)
        fail_msg("%d tiles are copied, not %d to %d", (int)copied, least, most);
}

static void edit_and_count(const zt_sampling *sampling) {
    static test_scene s, edited;
    keepsake k = {0};
    reel r;
    reel_open(&r, NULL, 0);
    r.sampling = *sampling;
    row_of_balls(&s);
    assert_int_equal(show_with(&r, NULL, &s.scene), 0);
    keep(&k, &r);
    assert_int_equal(show_with(&r, &k, &s.scene), REEL_TILES);
    for (int way = 0; way < 7; way++) {
        row_of_balls(&edited);
        zt_object *o = edited.objects, new = o[1];
        new.sphere.center.y = 0.5;
        int least = 12, most = REEL_TILES - 1;
        if (way < 3) { /* a ball comes: first, in between, last */
            int at = way == 0 ? 0 : way == 1 ? 4 : 9;
            memmove(o + at + 1, o + at, (size_t)(9 - at) * sizeof *o);
            o[at] = new;
            edited.scene.object_count++;
        } else if (way == 3) { /* one goes */
            memmove(o + 3, o + 4, 5 * sizeof *o);
            edited.scene.object_count--;
        } else if (way == 4) { /* two change places in the order; all looks the same */
            o[2] = s.objects[7];
            o[7] = s.objects[2];
        } else if (way == 5) { /* another colour */
            o[8].material = scene_material(&edited, (vec3){1, 0.2, 0.1}, 0.3);
        } else { /* a lamp goes, which lights but a part */
            edited.scene.light_count--;
            least = 4;
        }
        assert_between(show_with(&r, &k, &edited.scene), least, most);
    }
    s.scene.camera.position.x += 0.1; /* other rays */
    assert_int_equal(show_with(&r, &k, &s.scene), 0);
    free(k.bytes);
    reel_close(&r);
}

/* Each edit of the same scene changes the picture a little, and little is rendered. */
static void an_edit_costs_what_it_changes(void **state) {
    (void)state;
    const zt_sampling one = {.min = 1, .max = 1};
    edit_and_count(&one);
    edit_and_count(&edges);
    edit_and_count(&signed_edges);
}

/* How many samples a frame takes, and what it shows. */
static int64_t samples_with(reel *r, const keepsake *k, const zt_scene *scene) {
    show_with(r, k, scene);
    return r->samples;
}

/* At edges, what all pixels came to is kept: of the same scene no sample is taken again. */
static void no_sample_is_taken_twice(void **state) {
    (void)state;
    static test_scene s;
    keepsake k = {0};
    reel r;
    reel_open(&r, NULL, 0);
    r.sampling = edges;
    row_of_balls(&s);
    int64_t all = samples_with(&r, NULL, &s.scene);
    keep(&k, &r);
    assert_true(all > REEL_WIDTH * REEL_HEIGHT);
    assert_int_equal(samples_with(&r, &k, &s.scene), 0);
    free(k.bytes);
    reel_close(&r);
}

/* A keepsake that claims to be of a filter with signs, and has no sums of them, is none. */
static void sums_of_another_filter_are_none(void **state) {
    (void)state;
    static test_scene s;
    keepsake k = {0};
    zt_picture picture = {0};
    reel r;
    reel_open(&r, NULL, 0);
    row_of_balls(&s);
    r.sampling = edges;
    show_with(&r, NULL, &s.scene);
    keep(&k, &r);
    r.sampling = signed_edges;
    show_with(&r, NULL, &s.scene);
    take_out(&picture, &k);
    picture.view = r.reuse->last.view;
    begin_anew(&r);
    r.reuse->kept = &picture;
    assert_int_equal(reel_show(&r, &s.scene), 0);
    r.reuse->kept = NULL;
    zt_picture_close(&picture);
    free(k.bytes);
    reel_close(&r);
}

/* Where decisions go from pixel to pixel, tiles come from one picture alone: that which has
 * more of them. */
static void the_better_one_is_copied_from(void **state) {
    (void)state;
    static test_scene s;
    keepsake k = {0};
    reel r;
    reel_open(&r, NULL, 0);
    for (int way = 0; way < 4; way++) {
        zt_picture picture = {0};
        bool of_kept = way & 1;
        r.sampling = way & 2 ? edges : (zt_sampling){.min = 4, .max = 16, .error = 0.02};
        row_of_balls(&s);
        zt_sphere *moves = &s.objects[4].sphere, *edited = &s.objects[1].sphere;
        if (of_kept)
            edited->radius = 0.29; /* a small edit, and much that moves; or another way */
        if (!of_kept) moves->center.y = 0.5;
        show_with(&r, NULL, &s.scene);
        keep(&k, &r);
        take_out(&picture, &k);
        edited->radius = 0.3;
        moves->center.y = of_kept ? 0.5 : -0.7;
        show_with(&r, NULL, &s.scene);
        reel_show(&r, &s.scene);
        if (of_kept) moves->center.y = -0.7;
        if (!of_kept) s.objects[8].sphere.radius = 0.29;
        r.reuse->kept = &picture;
        r.kept = 0;
        int64_t copied = reel_show(&r, &s.scene);
        assert_in_range(copied, 1, REEL_TILES - 1);
        assert_int_equal(r.kept, of_kept ? copied : 0);
        r.reuse->kept = NULL;
        zt_picture_close(&picture);
    }
    free(k.bytes);
    reel_close(&r);
}

/* Tiles come from whichever has them: from the frame before what the edit touches, from what
 * was kept what moves. And what was copied is copied from again. */
static void either_has_what_the_other_has_not(void **state) {
    (void)state;
    static test_scene s;
    keepsake k = {0};
    zt_picture picture = {0};
    reel r;
    reel_open(&r, NULL, 0);
    row_of_balls(&s);
    zt_sphere *mover = &s.objects[1].sphere, *edited = &s.objects[8].sphere;
    double begin = mover->center.y;
    mover->center.y = begin + 0.6; /* the second frame */
    show_with(&r, NULL, &s.scene);
    keep(&k, &r);
    edited->radius = 0.2;
    mover->center.y = begin; /* the first one, edited, in another run */
    show_with(&r, NULL, &s.scene);
    mover->center.y = begin + 0.6; /* and the second */
    take_out(&picture, &k);
    int64_t alone = reel_show(&r, &s.scene);
    mover->center.y = begin;
    reel_show(&r, &s.scene);
    mover->center.y = begin + 0.6;
    r.reuse->kept = &picture;
    int64_t both = reel_show(&r, &s.scene); /* a tile that is touched by either is rendered */
    assert_in_range(both, REEL_TILES - 2, REEL_TILES);
    assert_true(alone < both);
    assert_int_equal(r.kept, both - alone);
    r.reuse->kept = NULL;
    assert_int_equal(reel_show(&r, &s.scene), REEL_TILES);
    zt_picture_close(&picture);
    free(k.bytes);
    reel_close(&r);
}

/* ---- random edits ---------------------------------------------------------------------------
 */

enum { SCENES = 120, EDITS = 8, KEPT = 3 };

/* A scene that is edited again and again, shown by runs that have their meshes elsewhere. */
static void edit_scene(reel reels[2], uint64_t key, const zt_mesh *meshes) {
    static test_scene s;
    static const int samples[] = {1, 1, 4, 16};
    keepsake kept[KEPT] = {{0}};
    draw d = {key, 0};
    zt_picture picture = {0};
    draw_scene(&d, &s, meshes);
    const zt_filter filters[] = {ZT_FILTER_BOX, ZT_FILTER_TENT, ZT_FILTER_MITCHELL};
    zt_sampling sampling = {.filter = filters[draw_below(&d, 3)],
                            .seed_fixed = draw_below(&d, 3) == 0,
                            .error = 0.03,
                            .edges = draw_below(&d, 3) == 0};
    sampling.min = sampling.max = samples[draw_below(&d, 4)];
    if (sampling.edges || draw_below(&d, 3) == 0) sampling.max = 16;
    zt_precision precision = draw_below(&d, 3);
    bool transparent = draw_below(&d, 4) == 0;
    for (int i = 0; i < EDITS; i++) {
        reel *r = &reels[draw_below(&d, 2)];
        const keepsake *from = &kept[draw_below(&d, KEPT)];
        r->sampling = sampling;
        r->precision = precision;
        r->transparent = transparent;
        if (draw_below(&d, 3)) begin_anew(r);
        r->reuse->keeps = true;
        if (from->bytes) take_out(&picture, from);
        r->reuse->kept = from->bytes ? &picture : NULL;
        reel_show(r, &s.scene);
        r->reuse->kept = NULL;
        keepsake *to = &kept[draw_below(&d, KEPT)];
        if (r->reuse->last.whole) keep(to, r); /* not so where it is rendered by itself */
        for (int k = draw_below(&d, 3); k >= 0; k--) edit(&d, &s);
    }
    for (int i = 0; i < KEPT; i++) free(kept[i].bytes);
    zt_picture_close(&picture);
}

static void after_any_edit_it_is_the_same(void **state) {
    (void)state;
    ball_mesh ball = make_ball(2);
    const zt_mesh meshes[2][MESHES] = {{cube_mesh(), ball.mesh}, {cube_mesh(), ball.mesh}};
    reel reels[2];
    for (int i = 0; i < 2; i++) reel_open(&reels[i], meshes[i], MESHES);
    for (uint64_t i = 0; i < SCENES; i++) edit_scene(reels, i, meshes[0]);
    int64_t shown = reels[0].shown + reels[1].shown, kept = reels[0].kept + reels[1].kept;
    print_message("%.1f %% of %d tiles are copied from what was kept\n",
                  100.0 * (double)kept / (double)shown, (int)shown);
    assert_true(kept * 10 > shown);
    for (int i = 0; i < 2; i++) reel_close(&reels[i]);
    free_ball(&ball);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_edit_costs_what_it_changes),
        cmocka_unit_test(no_sample_is_taken_twice),
        cmocka_unit_test(either_has_what_the_other_has_not),
        cmocka_unit_test(sums_of_another_filter_are_none),
        cmocka_unit_test(the_better_one_is_copied_from),
        cmocka_unit_test(after_any_edit_it_is_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
