/* What films do without: frames that show the same as others are rendered once, finished ones
 * are looked at again only where that is asked for; parts and budgets are gone on with as they
 * were begun; who comes second, or is refused, changes nothing. */
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/wait.h>

#include <cmocka.h>

#include "changed_film.h"
#include "sequence/manifest.h"

static int64_t noted_size(void) {
    struct stat there;
    return stat("k.##.png.manifest", &there) == 0 ? (int64_t)there.st_size : 0;
}

/* Killed wherever it is, again and again, a film goes on, and in the end has the very files of
 * one that nothing stopped, each rendered once but for what was under way. */
static void killed_films_go_on(void **state) {
    (void)state;
    zt_film_result result;
    heard h;
    const change slow = {.settings.samples = 10000};
    int killed_count = 0;
    for (int i = 0; i < 4; i++) {
        int64_t noted = noted_size();
        pid_t pid = fork(); /* before this process has threads of any library */
        assert_true(pid >= 0);
        if (pid == 0)
            _exit(render(&result, &h, "k.##.png", &slow, (zt_film_order){0}, INT64_MAX) == ZT_OK
                      ? 0
                      : 1);
        int code;
        for (int wait_ms = 0; wait_ms < 20000 && noted_size() == noted; wait_ms++) usleep(1000);
        usleep((useconds_t)(7000 * i));
        kill(pid, SIGKILL);
        assert_int_equal(waitpid(pid, &code, 0), pid);
        assert_true(WIFSIGNALED(code) || code == 0);
        killed_count += WIFSIGNALED(code);
    }
    assert_int_equal(render(&result, &h, "k.##.png", &slow, (zt_film_order){0}, INT64_MAX),
                     ZT_OK);
    if (result.kept == 0 || killed_count < 2)
        fail_msg("%d kept, %d killed", (int)result.kept, killed_count);
    expect("w.##.png", &slow, 5, 7, 0);
    for (int i = 0; i < FRAMES; i++) {
        char killed[16], whole[16];
        snprintf(killed, sizeof killed, "k.%02d.png", i);
        snprintf(whole, sizeof whole, "w.%02d.png", i);
        assert_true(same_files(killed, whole));
    }
    assert_false(exists("k.##.png.lock"));
}

/* There and back: frames 9 and 11 show what the first five do, frame 10 what 8 does. */
static const change swing = {.end = "2, 1, 0], 9: [0, 1, 0], 10: [2, 1, 0], 11: [0"};

static void assert_same_pixels(const char *a, const char *b, bool wanted) {
    zt_image *one, *other;
    heard h;
    if (zt_image_read(&one, a, listener_of(&h)) != ZT_OK ||
        zt_image_read(&other, b, listener_of(&h)) != ZT_OK)
        fail_msg("%s", h.text);
    bool equal = memcmp(one->pixels, other->pixels, 16 * 10 * 4 * sizeof(float)) == 0;
    if (equal != wanted) fail_msg("%s and %s", a, b);
    zt_image_free(&one);
    zt_image_free(&other);
}

/* Five images are rendered, though those that are equal do not follow each other; the files are
 * those of all frames. The same of a movie, whose frames come in their order. */
static void equal_frames_are_rendered_once(void **state) {
    (void)state;
    expect("e.##.exr", &swing, 5, 7, 0);
    expect("e.##.exr", &swing, 0, 0, FRAMES);
    assert_same_pixels("e.00.exr", "e.09.exr", true);
    assert_same_pixels("e.00.exr", "e.11.exr", true);
    assert_same_pixels("e.08.exr", "e.10.exr", true);
    assert_same_pixels("e.08.exr", "e.09.exr", false);
    expect("e.mp4", &swing, 5, 7, 0);
    expect("e.mp4", &swing, 0, 0, FRAMES);
}

/* Has the manifest say that a frame's numbers were others. */
static void forge(const char *target, int64_t frame) {
    zt_notes notes;
    zt_manifest_line header = {.kind = ZT_LINE_HEADER, .width = 16, .height = 10};
    assert_int_equal(zt_notes_open(&notes, target, &header, false, false, (zt_listener){0}),
                     ZT_OK);
    const zt_manifest_frame *f = zt_manifest_find(notes.known, frame);
    assert_non_null(f);
    zt_manifest_line line = {.kind = ZT_LINE_FRAME, .frame = *f};
    line.frame.pixels.low ^= 1;
    assert_int_equal(zt_notes_add(&notes, &line), ZT_OK);
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
}

/* Finished frames are rendered again, as many as are asked for or there are, and are the same;
 * one that is not is told, with its file, which stays. */
static void finished_frames_are_verified(void **state) {
    (void)state;
    static const char *const targets[] = {"v/v.##.png", "v.mp4"};
    static const char *const named[] = {"v.06.png", "v.mp4"};
    for (int i = 0; i < 2; i++) {
        zt_film_result result;
        heard h;
        zt_film_order all = {.verify = 100}, some = {.verify = 3};
        expect(targets[i], &(change){0}, 5, 7, 0);
        assert_int_equal(render(&result, &h, targets[i], &(change){0}, some, INT64_MAX), ZT_OK);
        assert_true(result.verified == 3 && result.kept == FRAMES && result.rendered == 0);
        assert_int_equal(render(&result, &h, targets[i], &(change){0}, all, INT64_MAX), ZT_OK);
        assert_int_equal(result.verified, FRAMES);
        forge(targets[i], 6);
        zt_hash before = hash_of(i ? "v.mp4" : "v/v.06.png");
        assert_int_equal(render(&result, &h, targets[i], &(change){0}, all, INT64_MAX),
                         ZT_EFILE);
        assert_told(&h, "frame 6 was rendered again");
        assert_non_null(strstr(h.text, named[i]));
        assert_int_equal(result.verified, FRAMES - 1);
        assert_true(zt_hash_equal(before, hash_of(i ? "v.mp4" : "v/v.06.png")));
    }
}

/* ---- parts ----------------------------------------------------------------------------------
 */

/* Notes down that frame 0 took so long, and all others a second. */
static void note_times(const char *target, double first_s) {
    zt_notes notes;
    zt_manifest_line header = {.kind = ZT_LINE_HEADER, .width = 16, .height = 10};
    assert_int_equal(zt_notes_open(&notes, target, &header, false, false, (zt_listener){0}),
                     ZT_OK);
    for (int i = 0; i < FRAMES; i++) {
        zt_manifest_line line = {.kind = ZT_LINE_FRAME,
                                 .frame = {.frame = i, .render_s = i ? 1 : first_s}};
        assert_int_equal(zt_notes_add(&notes, &line), ZT_OK);
    }
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
}

static void expect_part(const change *c, int64_t part, int64_t count) {
    zt_film_result result;
    heard h;
    const zt_film_order order = {.part = part, .part_count = 2};
    assert_int_equal(render(&result, &h, "p.##.png", c, order, INT64_MAX), ZT_OK);
    assert_int_equal(result.count, count);
}

/* Parts take as long as each other, by what frames took; and as they were divided first, they
 * stay, whatever is found out meanwhile, until the film is another one. */
static void parts_stay(void **state) {
    (void)state;
    note_times("p.##.png", 11);
    expect_part(&(change){0}, 2, 11);
    note_times("p.##.png", 1);
    expect_part(&(change){0}, 1, 1);
    expect("p.##.png", &(change){0}, 0, 0, FRAMES);
    expect_part(&(change){0}, 2, 11);
    note_times("p.##.png", 3);
    const change other = {.name = "other", .film = ", seed: 3"};
    expect_part(&other, 1, 5);
    expect_part(&other, 2, 7);
    expect("p.##.png", &other, 0, 0, FRAMES);
}

/* ---- budgets --------------------------------------------------------------------------------
 */

static zt_film_result render_in(const char *target, double film_s, int64_t patience_frames,
                                zt_status wanted) {
    zt_film_result result;
    heard h;
    const zt_film_order order = {.budget = {.film_s = film_s}};
    zt_status status = render(&result, &h, target, &(change){0}, order, patience_frames);
    if (status != wanted) fail_msg("%s", h.text);
    return result;
}

/* What was done in a budget stays when the film goes on; another budget is another film. */
static void budgets_go_on(void **state) {
    (void)state;
    zt_film_result r = render_in("b.##.png", 0.6, 5, ZT_ESTOPPED);
    assert_int_equal(r.rendered, 5);
    zt_hash first = hash_of("b.00.png");
    r = render_in("b.##.png", 0.6, INT64_MAX, ZT_OK);
    assert_true(r.kept == 5 && r.rendered == FRAMES - 5);
    assert_true(zt_hash_equal(first, hash_of("b.00.png")));
    r = render_in("b.##.png", 0.6, INT64_MAX, ZT_OK);
    assert_int_equal(r.kept, FRAMES);
    assert_int_equal(unlink("b.03.png"), 0);
    r = render_in("b.##.png", 0.6, INT64_MAX, ZT_OK);
    assert_true(r.kept == FRAMES - 1 && r.rendered == 1);
    r = render_in("b.##.png", 0.3, INT64_MAX, ZT_OK);
    assert_int_equal(r.rendered, FRAMES);
}

/* ---- others ---------------------------------------------------------------------------------
 */

/* What is refused before the first frame leaves nothing behind. */
static void what_is_refused_leaves_nothing(void **state) {
    (void)state;
    static const zt_output_option wrong[] = {{"nonsense", "1"}, {NULL, NULL}};
    const zt_film_order orders[] = {{.options = wrong},
                                    {.options = wrong, .part = 1, .part_count = 2}};
    int entries = entry_count(".");
    for (int i = 0; i < 2; i++) {
        zt_film_result result;
        heard h;
        assert_int_equal(
            render(&result, &h, "new/dir/f.##.png", &(change){0}, orders[i], INT64_MAX),
            ZT_EARGUMENT);
        assert_told(&h, "nonsense");
        assert_int_equal(entry_count("."), entries);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(killed_films_go_on),
                                       cmocka_unit_test(equal_frames_are_rendered_once),
                                       cmocka_unit_test(finished_frames_are_verified),
                                       cmocka_unit_test(parts_stay),
                                       cmocka_unit_test(budgets_go_on),
                                       cmocka_unit_test(what_is_refused_leaves_nothing)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
