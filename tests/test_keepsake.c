/* Keepsakes: what becomes of a picture that is put into bytes and is a picture again, in
 * another process; whatever is done to the bytes, it is a picture or none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "keeping.h"
#include "random_scenes.h"

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
        cmocka_unit_test(all_of_it_is_kept),
        cmocka_unit_test(damage_is_found),
        cmocka_unit_test(nothing_may_be_left),
        cmocka_unit_test(hostile_bytes_break_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
