/* Films that go on: what changes a frame's content key, and what is rendered again. */
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>

#include <cmocka.h>

#include "changed_film.h"

static void find_keys(zt_hash keys[FRAMES], const change *c) {
    zt_animation *animation;
    zt_renderer *renderer;
    heard h;
    open_changed(&animation, &renderer, c, &h);
    for (int frame = 0; frame < FRAMES; frame++)
        assert_int_equal(zt_renderer_key(&keys[frame], renderer, frame), ZT_OK);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

static void usual_keys(zt_hash keys[FRAMES]) { find_keys(keys, &(change){0}); }

/* Frames that show the same have the same key, others another one. */
static void frames_are_told_apart(void **state) {
    (void)state;
    zt_hash keys[FRAMES];
    usual_keys(keys);
    for (int a = 0; a < FRAMES; a++)
        for (int b = 0; b < FRAMES; b++) {
            int seen_a = a < 4 ? 4 : a > 8 ? 8 : a, seen_b = b < 4 ? 4 : b > 8 ? 8 : b;
            if (zt_hash_equal(keys[a], keys[b]) != (seen_a == seen_b))
                fail_msg("%d and %d", a, b);
        }
}

/* What no pixel shows does not matter. */
static void names_change_nothing(void **state) {
    (void)state;
    const change changes[] = {{0}, {.name = "loam"}, {.film = " } # remark {"}};
    zt_hash usual[FRAMES], keys[FRAMES];
    usual_keys(usual);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        find_keys(keys, &changes[i]);
        for (int frame = 0; frame < FRAMES; frame++)
            if (!zt_hash_equal(usual[frame], keys[frame])) fail_msg("change %zu, %d", i, frame);
    }
}

/* A key that is moved changes the frames after the one before it. */
static void keys_change_their_frames(void **state) {
    (void)state;
    zt_hash usual[FRAMES], keys[FRAMES];
    usual_keys(usual);
    find_keys(keys, &(change){.end = "2.5"});
    for (int frame = 0; frame < FRAMES; frame++)
        assert_int_equal(zt_hash_equal(usual[frame], keys[frame]), frame <= 4);
}

static void settings_change_all(void **state) {
    (void)state;
    const change changes[] = {{.settings = {.width = 32, .height = 20}},
                              {.settings = {.width = 16, .height = 12}},
                              {.settings = {.samples = 3}},
                              {.settings = {.precision = ZT_PRECISION_DOUBLE}},
                              {.settings = {.aovs = 1}},
                              {.film = ", seed: 7"},
                              {.point = "0.25"}};
    zt_hash usual[FRAMES], keys[FRAMES];
    usual_keys(usual);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        find_keys(keys, &changes[i]);
        for (int a = 0; a < FRAMES; a++)
            for (int b = 0; b < FRAMES; b++)
                if (zt_hash_equal(usual[a], keys[b]))
                    fail_msg("change %zu, %d and %d", i, a, b);
    }
}

/* ---- rendering again ------------------------------------------------------------------------
 */

/* Frames 0 to 4 show the same, and so do 8 to 11: one of each is rendered, with the three
 * between. What is there is kept; what is missing or damaged is made again, with the same
 * bytes; an edit renders the frames that it moves; a torn line costs its frame. */
static void films_go_on(void **state) {
    (void)state;
    static const char target[] = "a/f.##.png";
    expect(target, &(change){0}, 5, 7, 0);
    zt_hash second = hash_of("a/f.02.png"), sixth = hash_of("a/f.06.png");
    assert_false(zt_hash_equal(second, sixth));
    expect(target, &(change){0}, 0, 0, 12);
    expect(target, &(change){.name = "plaster"}, 0, 0, 12);
    expect(target, &(change){.settings.threads = 2}, 0, 0, 12);
    assert_int_equal(unlink("a/f.02.png"), 0);
    print_to("a/f.06.png", "damaged");
    expect(target, &(change){0}, 2, 0, 10);
    assert_true(zt_hash_equal(second, hash_of("a/f.02.png")) &&
                zt_hash_equal(sixth, hash_of("a/f.06.png")));
    expect(target, &(change){.end = "3"}, 4, 3, 5);
    expect(target, &(change){0}, 4, 3, 5);
    assert_true(zt_hash_equal(sixth, hash_of("a/f.06.png")));
    struct stat noted;
    assert_int_equal(stat("a/f.##.png.manifest", &noted), 0);
    assert_int_equal(truncate("a/f.##.png.manifest", noted.st_size - 40), 0);
    expect(target, &(change){0}, 1, 0, 11); /* the last line was frame 11's */
    expect(target, &(change){0}, 0, 0, 12);
    assert_int_equal(access("a/f.##.png.lock", F_OK), -1);
}

/* What a film that was stopped has is there when it goes on, and the end is the same. */
static void stopped_films_go_on(void **state) {
    (void)state;
    zt_film_result result;
    heard h;
    expect("whole.##.png", &(change){0}, 5, 7, 0);
    assert_int_equal(render(&result, &h, "s.##.png", &(change){0}, (zt_film_order){0}, 6),
                     ZT_ESTOPPED);
    assert_int_equal(result.rendered + result.held, 6);
    expect("s.##.png", &(change){0}, 3, 3, 6);
    for (int i = 0; i < FRAMES; i++) {
        char whole[32], stopped[32];
        snprintf(whole, sizeof whole, "whole.%02d.png", i);
        snprintf(stopped, sizeof stopped, "s.%02d.png", i);
        /* They tell their keys, and how they were made is the same. */
        assert_true(zt_hash_equal(hash_of(whole), hash_of(stopped)));
    }
}

/* A file that is not known to be of this film stays as it is, unless it may be replaced. */
static void strangers_stay(void **state) {
    (void)state;
    zt_film_result result;
    heard h;
    print_to("t.05.png", "somebody else's");
    zt_hash before = hash_of("t.05.png");
    assert_int_equal(
        render(&result, &h, "t.##.png", &(change){0}, (zt_film_order){0}, INT64_MAX), ZT_EFILE);
    assert_told(&h, "t.05.png");
    assert_non_null(strstr(h.text, "--overwrite"));
    assert_true(zt_hash_equal(before, hash_of("t.05.png")) && access("t.00.png", F_OK) != 0);
    assert_int_equal(render(&result, &h, "t.##.png", &(change){0},
                            (zt_film_order){.overwrites = true}, INT64_MAX),
                     ZT_OK);
    assert_int_equal(result.rendered + result.held, FRAMES);
    assert_false(zt_hash_equal(before, hash_of("t.05.png")));
}

/* A second one on the same target is told who is at work, and changes nothing; nor does one
 * that would do a part of it. */
static void one_at_a_time(void **state) {
    (void)state;
    static const char *const targets[] = {"l.##.png", "l.mp4"};
    for (int i = 0; i < 2; i++) {
        zt_film_result result;
        heard h;
        char lock_path[16], told[64];
        snprintf(lock_path, sizeof lock_path, "%s.lock", targets[i]);
        snprintf(told, sizeof told, "%s is being rendered by process 17 on attic", targets[i]);
        print_to(lock_path, "process 17 on attic\n");
        int lock = open(lock_path, O_RDWR), entries = entry_count(".");
        assert_true(lock >= 0 && flock(lock, LOCK_EX) == 0);
        for (int parts = 0; parts < 2; parts++) {
            zt_film_order order = {.part = parts, .part_count = 2 * parts};
            assert_int_equal(render(&result, &h, targets[i], &(change){0}, order, INT64_MAX),
                             ZT_EFILE);
            assert_told(&h, told);
            assert_int_equal(entry_count("."), entries);
        }
        close(lock); /* it died: what is left of its lock holds nobody up */
        expect(targets[i], &(change){0}, 5, 7, 0);
    }
}

/* A movie is one file, and so are its parts. */
static void parts_of_movies_share_nothing(void **state) {
    (void)state;
    zt_film_result result;
    heard h;
    print_to("m.mp4.lock", "process 17 on attic\n");
    int lock = open("m.mp4.lock", O_RDWR);
    assert_true(lock >= 0 && flock(lock, LOCK_SH) == 0);
    zt_film_order part = {.part = 1, .part_count = 2};
    assert_int_equal(render(&result, &h, "m.mp4", &(change){0}, part, INT64_MAX), ZT_EFILE);
    close(lock);
}

/* Several share a target, each a part of its own; nobody takes all of it meanwhile. What all of
 * them completed is the whole film. */
static void parts_share(void **state) {
    (void)state;
    static const char target[] = "p.##.png";
    const zt_film_order first = {.part = 1, .part_count = 2},
                        second = {.part = 2, .part_count = 2};
    zt_film_result result;
    heard h;
    int whole = open("p.##.png.lock", O_RDWR | O_CREAT, 0666);
    int part = open("p.##.png.1-of-2.lock", O_RDWR | O_CREAT, 0666);
    assert_true(flock(whole, LOCK_SH) == 0 && flock(part, LOCK_EX) == 0);
    assert_int_equal(render(&result, &h, target, &(change){0}, first, INT64_MAX), ZT_EFILE);
    assert_told(&h, "part 1 of 2 of p.##.png is being rendered by");
    assert_int_equal(render(&result, &h, target, &(change){0}, (zt_film_order){0}, INT64_MAX),
                     ZT_EFILE);
    assert_told(&h, "p.##.png is being rendered by");
    assert_true(access("p.00.png", F_OK) != 0);
    assert_int_equal(render(&result, &h, target, &(change){0}, second, INT64_MAX), ZT_OK);
    assert_int_equal(result.count, FRAMES / 2);
    assert_int_equal(result.rendered + result.held, FRAMES / 2);
    assert_true(access("p.05.png", F_OK) != 0 && access("p.06.png", F_OK) == 0);
    assert_true(access("p.##.png.lock", F_OK) == 0 &&
                access("p.##.png.2-of-2.lock", F_OK) != 0);
    close(part);
    close(whole);
    assert_int_equal(render(&result, &h, target, &(change){0}, first, INT64_MAX), ZT_OK);
    assert_int_equal(result.rendered + result.held, FRAMES / 2);
    expect(target, &(change){0}, 0, 0, FRAMES);
    assert_true(access("p.##.png.lock", F_OK) != 0 &&
                access("p.##.png.1-of-2.lock", F_OK) != 0);
}

/* ---- what is told ---------------------------------------------------------------------------
 */

/* Who listens takes a while, and notices whether somebody else speaks meanwhile. */
typedef struct slow_ear {
    atomic_int speaking, count;
    atomic_bool together;
} slow_ear;

static void hear_slowly(void *user, const zt_message *message) {
    slow_ear *ear = user;
    (void)message;
    (void)message;
    if (atomic_fetch_add(&ear->speaking, 1) > 0) atomic_store(&ear->together, true);
    nanosleep(&(struct timespec){0, 300 * 1000 * 1000}, NULL);
    atomic_fetch_sub(&ear->speaking, 1);
    atomic_fetch_add(&ear->count, 1);
}

/* The first frame asks for more than single precision while a movie without alpha is opened:
 * both say so, one after the other. */
static void warnings_come_in_turn(void **state) {
    (void)state;
    print_to("ground.yaml",
             "zoetrope: 1\n"
             "film: { size: [16, 10], rate: 12, duration: 1 s, background: transparent }\n"
             "camera: { position: [0, 1, 6] }\n"
             "objects: [sphere: { center: [0, -1e7, 0], radius: 1e7 }]\n"
             "lights: [ambient: {}]\n");
    zt_animation *animation;
    zt_renderer *renderer;
    assert_int_equal(zt_animation_read(&animation, "ground.yaml", NULL, 0, (zt_listener){0}),
                     ZT_OK);
    slow_ear ear = {0};
    const zt_render_settings settings = {.threads = 1, .precision = ZT_PRECISION_SINGLE};
    assert_int_equal(
        zt_renderer_open(&renderer, animation, &settings, (zt_listener){hear_slowly, &ear}),
        ZT_OK);
    const zt_frames frames = {&(int64_t){0}, 1};
    const zt_film_order order = {.target = "turns.mp4", .frames = &frames, .forgets = true};
    zt_film_result result;
    assert_int_equal(zt_film_render(&result, renderer, &order, NULL), ZT_OK);
    assert_int_equal(ear.count, 3); /* and in the end what the movie holds */
    assert_false(ear.together);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(frames_are_told_apart),
                                       cmocka_unit_test(names_change_nothing),
                                       cmocka_unit_test(keys_change_their_frames),
                                       cmocka_unit_test(settings_change_all),
                                       cmocka_unit_test(films_go_on),
                                       cmocka_unit_test(stopped_films_go_on),
                                       cmocka_unit_test(strangers_stay),
                                       cmocka_unit_test(one_at_a_time),
                                       cmocka_unit_test(parts_of_movies_share_nothing),
                                       cmocka_unit_test(parts_share),
                                       cmocka_unit_test(warnings_come_in_turn)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
