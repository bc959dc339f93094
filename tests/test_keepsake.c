/* Keepsakes: what becomes of a picture that is put into bytes and is a picture again when the
 * scene has been edited, in another process: tiles copied from it have the bits of rendering,
 * whatever came, went or changed; and whatever is done to the bytes, it is a picture or none.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "meshes.h"
#include "random_scenes.h"
#include "reel.h"
#include "render/keepsake.h"
#include "render/reuse.h"

static const char arithmetic[] = "of tests";

static const zt_sampling one = {.min = 1, .max = 1};
static const zt_sampling edges = {.min = 1, .max = 16, .error = 0.02, .edges = true};
static const zt_sampling signed_edges = {
    .min = 1, .max = 16, .error = 0.02, .edges = true, .filter = ZT_FILTER_MITCHELL};

typedef struct keepsake {
    unsigned char *bytes;
    size_t size;
} keepsake;

static void keep(keepsake *k, const reel *r) {
    const zt_picture *last = &r->reuse->last;
    zt_keepsake_head head = {.frame = 1};
    assert_true(last->whole);
    free(k->bytes);
    k->bytes = malloc(zt_keepsake_room(last));
    assert_non_null(k->bytes);
    zt_keepsake_write(k->bytes, &head, last, arithmetic);
    zt_keepsake_seal(k->bytes);
    k->size = head.size;
    assert_true(k->size <= zt_keepsake_room(last));
}

static void take_out(zt_picture *picture, const keepsake *k) {
    assert_true(zt_keepsake_read(picture, k->bytes, k->size, arithmetic));
}

/* The run ends, and another one begins. */
static void begin_anew(reel *r) {
    zt_reuse_close(&r->reuse);
    assert_int_equal(zt_reuse_open(&r->reuse, true), ZT_OK);
    for (int i = 0; i < REEL_IMAGES; i++) zt_image_forget_stamps(r->images[i]);
    r->reuse->keeps = true;
}

/* Shows a scene in a run of its own, with what was kept of another one; returns how many tiles
 * are copied from that. */
static int64_t show_with(reel *r, const keepsake *k, const zt_scene *scene) {
    zt_picture picture = {0};
    begin_anew(r);
    if (k) take_out(&picture, k);
    r->reuse->kept = k ? &picture : NULL;
    int64_t copied = reel_show(r, scene);
    r->reuse->kept = NULL;
    zt_picture_close(&picture);
    return copied;
}

/* ---- edits ----------------------------------------------------------------------------------
 */

/* A floor, a row of balls, a lamp. */
static void row_of_balls(test_scene *s) {
    scene_begin(s);
    int32_t grey = scene_material(s, (vec3){0.5, 0.5, 0.5}, 0);
    scene_plane(s, (vec3){0, 1, 0}, -1, grey);
    for (int i = 0; i < 8; i++) scene_sphere(s, (vec3){-3.5 + i, -0.7, -5}, 0.3, grey);
    scene_ambient(s, (vec3){1, 1, 1}, 0.1);
    scene_point_light(s, (vec3){0, 6, -2}, 20);
    scene_point_light(s, (vec3){3, 0.4, -9}, 1);
}

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
        if (of_kept) edited->radius = 0.29; /* a small edit, and much that moves */
        show_with(&r, NULL, &s.scene);
        keep(&k, &r);
        take_out(&picture, &k);
        edited->radius = 0.3;
        if (of_kept) moves->center.y = 0.5;
        show_with(&r, NULL, &s.scene);
        reel_show(&r, &s.scene);
        if (of_kept) moves->center.y = -0.7;
        if (!of_kept) s.objects[8].sphere.radius = 0.29;
        r.reuse->kept = &picture;
        r.kept = 0;
        int64_t copied = reel_show(&r, &s.scene);
        assert_in_range(copied, 1, REEL_TILES - 1);
        if (of_kept) assert_int_equal(r.kept, copied);
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

/* ---- bytes ----------------------------------------------------------------------------------
 */

/* All that pictures may have is there. */
static void make_keepsake(keepsake *k) {
    static test_scene s;
    reel r;
    reel_open(&r, NULL, 0);
    r.sampling = signed_edges;
    row_of_balls(&s);
    show_with(&r, NULL, &s.scene);
    keep(k, &r);
    reel_close(&r);
}

/* A bit that is changed anywhere, and what is cut short, is found; of another version, too. */
static void damage_is_found(void **state) {
    (void)state;
    keepsake k = {0};
    zt_picture picture = {0};
    make_keepsake(&k);
    take_out(&picture, &k);
    assert_false(zt_keepsake_read(&picture, k.bytes, k.size, "of others"));
    assert_false(picture.whole);
    for (size_t i = 0; i < k.size; i += i < 200 ? 1 : 997) {
        k.bytes[i] ^= 16;
        if (zt_keepsake_read(&picture, k.bytes, k.size, arithmetic)) fail_msg("byte %zu", i);
        k.bytes[i] ^= 16;
    }
    for (size_t size = 0; size < k.size; size += size < 200 ? 1 : 1997) {
        unsigned char *cut = malloc(size + 1); /* so that reading behind it is seen */
        memcpy(cut, k.bytes, size);
        assert_false(zt_keepsake_read(&picture, cut, size, arithmetic));
        free(cut);
    }
    take_out(&picture, &k);
    zt_picture_close(&picture);
    free(k.bytes);
}

static void assert_sums_equal(const zt_canvas_sum *a, const zt_canvas_sum *b) {
    assert_memory_equal(a, b, offsetof(zt_canvas_sum, taken));
    assert_int_equal(a->taken, b->taken);
}

/* Each pixel's, one after the other; returns how many there are. */
static int compare_rounds(const zt_rounds *a, const zt_rounds *b) {
    int count = 0;
    for (int pixel = 0; pixel < REEL_WIDTH * REEL_HEIGHT; pixel++) {
        uint32_t i = a->first[pixel], k = b->first[pixel];
        for (; i && k; i = a->rounds[i].next, k = b->rounds[k].next) {
            const zt_round *x = &a->rounds[i], *y = &b->rounds[k];
            assert_sums_equal(&x->sum, &y->sum);
            assert_sums_equal(&a->negative[i], &b->negative[k]);
            assert_true(x->error == y->error && x->step == y->step && x->strange == y->strange);
            count++;
        }
        assert_true(!i && !k);
    }
    return count;
}

/* Each truth and number is itself again. */
static void all_of_it_is_kept(void **state) {
    (void)state;
    keepsake k = {0};
    zt_picture picture = {0}, again = {0};
    make_keepsake(&k);
    take_out(&picture, &k);
    zt_outline *o = &picture.outline;
    const size_t count =
        (size_t)zt_tile_count(picture.width, picture.height) * ZT_PICTURE_PARTS;
    for (int n = 0; n < 8; n++) {
        for (size_t i = 0; i < count; i++) {
            zt_footprint *f = &picture.footprints[i];
            f->doubtful = (n + i) & 1;
            f->restless = (n + i) >> 1 & 1;
            f->steps[0].leaves = (n + i) >> 2 & 1;
        }
        for (int32_t i = 0; i < o->thing_count; i++) {
            zt_outline_thing *thing = &o->things[i];
            thing->moves = (n + i) & 1;
            thing->unbounded = (n + i) >> 1 & 1;
            thing->round = (n + i) >> 2 & 1;
            thing->stretch = (float)(n + i);
        }
        for (int32_t i = 0; i < o->lamp_count; i++) {
            o->lamps[i].drawn = (n + i) & 1;
            o->lamps[i].shadows = (n + i) >> 1 & 1;
        }
        o->ambient_moves = n & 1;
        o->blind = n >> 1 & 1;
        o->faint = n >> 2 & 1;
        o->brightest = n;
        zt_keepsake_head head = {.frame = 1};
        zt_keepsake_write(k.bytes, &head, &picture, arithmetic);
        zt_keepsake_seal(k.bytes);
        take_out(&again, &k);
        const zt_outline *other = &again.outline;
        assert_memory_equal(again.footprints, picture.footprints,
                            count * sizeof *again.footprints);
        assert_memory_equal(other->things, o->things,
                            (size_t)o->thing_count * sizeof *o->things);
        assert_memory_equal(other->lamps, o->lamps, (size_t)o->lamp_count * sizeof *o->lamps);
        assert_int_equal(other->ambient_moves, o->ambient_moves);
        assert_int_equal(other->blind, o->blind);
        assert_int_equal(other->faint, o->faint);
        assert_true(other->brightest == o->brightest);
        assert_memory_equal(again.pixels, picture.pixels,
                            4 * sizeof(float) * REEL_WIDTH * REEL_HEIGHT);
        assert_memory_equal(again.paths, picture.paths,
                            sizeof(uint32_t) * REEL_WIDTH * REEL_HEIGHT);
        assert_true(compare_rounds(&picture.rounds, &again.rounds) > 100);
    }
    zt_picture_close(&picture);
    zt_picture_close(&again);
    free(k.bytes);
}

/* Bytes that nobody asked for are not passed over, even with the right checksum. */
static void nothing_may_be_left(void **state) {
    (void)state;
    keepsake k = {0};
    zt_picture picture = {0};
    zt_keepsake_head head;
    make_keepsake(&k);
    for (size_t more = 0; more < 3; more++) {
        unsigned char *bytes = calloc(1, k.size + 4 * more);
        memcpy(bytes, k.bytes, k.size);
        memcpy(&head, bytes, sizeof head);
        head.size = k.size + 4 * more;
        memcpy(bytes, &head, sizeof head);
        zt_keepsake_seal(bytes);
        bool read = zt_keepsake_read(&picture, bytes, head.size, arithmetic);
        assert_int_equal(read, more == 0);
        free(bytes);
    }
    zt_picture_close(&picture);
    free(k.bytes);
}

static void ask_all(const zt_picture *picture, const zt_outline *now) {
    zt_arena arena = {0};
    zt_differences d;
    int touched = 0;
    assert_int_equal(zt_differences_find(&d, &picture->outline, now, false, &arena), ZT_OK);
    int parts = ZT_PICTURE_PARTS * zt_tile_count(picture->width, picture->height);
    for (int i = 0; i < parts; i++)
        touched += zt_footprint_touched(&picture->footprints[i], &d);
    assert_in_range(touched, 0, parts);
    zt_arena_free(&arena);
}

/* Somebody wrote anything, with the right checksum: it is a picture or none, and nothing breaks
 * where tiles are looked for in it. */
static void hostile_bytes_break_nothing(void **state) {
    enum { HEAD = sizeof(zt_keepsake_head) };
    (void)state;
    static test_scene s;
    keepsake k = {0};
    draw d = {7, 0};
    reel r;
    int read = 0;
    make_keepsake(&k);
    row_of_balls(&s);
    reel_open(&r, NULL, 0);
    s.objects[4].sphere.radius = 0.2;
    show_with(&r, NULL, &s.scene);
    for (int i = 0; i < 3000; i++) {
        size_t size =
            draw_below(&d, 3) ? k.size : HEAD + (size_t)draw_below(&d, (int)k.size - HEAD);
        unsigned char *bytes = malloc(size);
        zt_keepsake_head head;
        memcpy(bytes, k.bytes, size);
        for (int n = draw_below(&d, 8); n >= 0; n--) {
            size_t from = draw_below(&d, 2) ? 40 : HEAD;
            bytes[from + (size_t)draw_below(&d, (int)(size - from))] =
                draw_below(&d, 2) ? 255 : (unsigned char)draw_below(&d, 256);
        }
        memcpy(&head, bytes, sizeof head);
        head.size = size;
        memcpy(bytes, &head, sizeof head);
        zt_keepsake_seal(bytes);
        zt_picture picture = {0};
        bool good = zt_keepsake_read(&picture, bytes, size, arithmetic);
        read += good;
        if (good) ask_all(&picture, &r.reuse->last.outline);
        zt_picture_close(&picture);
        free(bytes);
    }
    assert_true(read > 100);
    free(k.bytes);
    reel_close(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_edit_costs_what_it_changes),
        cmocka_unit_test(no_sample_is_taken_twice),
        cmocka_unit_test(either_has_what_the_other_has_not),
        cmocka_unit_test(the_better_one_is_copied_from),
        cmocka_unit_test(after_any_edit_it_is_the_same),
        cmocka_unit_test(all_of_it_is_kept),
        cmocka_unit_test(damage_is_found),
        cmocka_unit_test(nothing_may_be_left),
        cmocka_unit_test(hostile_bytes_break_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
