/* Movies that go on where they were stopped, by kill -9 at any moment: the finished file is the
 * same to the bit as that of a run which nothing stopped, and what was rendered before is not
 * wanted again. A film's frames are told apart by their keys, and show what these say. */
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <sys/wait.h>

#include <cmocka.h>

#include "files.h"
#include "movies.h"

/* At two frames a second a piece has 8; the last one here has 3. */
enum { PIECE = 8, COUNT = 27, RECORDS_MAX = 4096 };

typedef struct run {
    const char *path, *codec, *pixels, *title;
    int width, height, count;
    uint64_t edited;   /* this frame shows something else; UINT64_MAX: none */
    double render_s;   /* what a frame is said to take */
    int killed_after;  /* frames, by kill -9; -1: never */
    int stopped_after; /* frames, by closing; -1: never */
    bool overwrites;
} run;

static const run plain = {.path = "film.mp4",
                          .width = 96,
                          .height = 64,
                          .count = COUNT,
                          .edited = UINT64_MAX,
                          .render_s = 1,
                          .killed_after = -1,
                          .stopped_after = -1};

/* Records are kept in a file as they come. */
static zt_status remember(void *user, const zt_output_record *record) {
    FILE *file = fopen(user, "ab");
    bool good = file && fwrite(record, sizeof *record, 1, file) == 1;
    return file && fclose(file) == 0 && good ? ZT_OK : ZT_EFILE;
}

static int64_t recall(zt_output_record records[RECORDS_MAX], const char *path) {
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    size_t count = fread(records, sizeof *records, RECORDS_MAX, file);
    fclose(file);
    return (int64_t)count;
}

static void write_one(zt_output *output, const run *r, int frame, uint64_t shown) {
    zt_image *image = picture(r->width, r->height, (int)shown);
    image->info = (zt_image_info){.known = true, .frame = frame, .render_s = r->render_s};
    image->info.key = (zt_hash){1, shown + 1};
    if (zt_output_write(output, image, frame) != ZT_OK) fail_msg("%s", movie_heard.text);
    zt_image_free(&image);
}

/* Makes what is missing of the film; returns how many frames that were. */
static int go_on(const run *r) {
    static zt_output_record records[RECORDS_MAX];
    int64_t frames[FRAMES_MAX];
    zt_hash keys[FRAMES_MAX];
    char remembered[64];
    snprintf(remembered, sizeof remembered, "%s.records", r->path);
    for (int i = 0; i < r->count; i++) {
        frames[i] = i + 5;
        keys[i] = (zt_hash){1, (uint64_t)i + 1 + ((uint64_t)i == r->edited ? 1000 : 0)};
    }
    const zt_output_plan plan = {
        frames,        keys,     r->count,  records, recall(records, remembered),
        r->overwrites, remember, remembered};
    const zt_output_format format = {.width = r->width,
                                     .height = r->height,
                                     .rate = {2, 1},
                                     .view = ZT_VIEW_SRGB,
                                     .frame_count = r->count,
                                     .plan = &plan};
    zt_output_option options[4] = {{NULL, NULL}};
    int option_count = 0, written = 0;
    if (r->codec) options[option_count++] = (zt_output_option){"codec", r->codec};
    if (r->pixels) options[option_count++] = (zt_output_option){"pixel-format", r->pixels};
    if (r->title) options[option_count++] = (zt_output_option){"title", r->title};
    zt_output *output = open_movie_by(r->path, &format, options);
    for (int i = 0; i < r->count && written != r->stopped_after; i++) {
        if (!zt_output_wants(output, i)) continue;
        if (written == r->killed_after) raise(SIGKILL);
        write_one(output, r, (int)frames[i], keys[i].low - 1);
        written++;
    }
    close_movie(&output);
    return written;
}

/* The same in a process of its own; -1 where that was killed. */
static int go_on_apart(const run *r) {
    fflush(NULL);
    pid_t pid = fork();
    if (pid == 0) _exit(go_on(r));
    int status;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    if (WIFSIGNALED(status)) {
        assert_int_equal(WTERMSIG(status), SIGKILL);
        return -1;
    }
    return WEXITSTATUS(status);
}

static void forget(const char *path) {
    const char *const endings[] = {"", ".part", ".part.frames", ".records", ".joined"};
    for (int i = 0; i < 5; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s%s", path, endings[i]);
        unlink(name);
    }
}

static void assert_only_film(const char *path) {
    const char *const endings[] = {".part", ".part.frames", ".joined"};
    for (int i = 0; i < 3; i++) {
        char name[64];
        snprintf(name, sizeof name, "%s%s", path, endings[i]);
        if (exists(name)) fail_msg("%s is left", name);
    }
}

/* The film of a run that nothing stopped, under another name. */
static void make_whole(const run *r, const char *path) {
    run whole = *r;
    whole.path = path;
    whole.killed_after = whole.stopped_after = -1;
    forget(path);
    assert_int_equal(go_on_apart(&whole), r->count);
    assert_only_film(path);
}

static const struct {
    const char *ending, *codec, *pixels;
    int width;
} ways[] = {{"mp4", "h264", NULL, 96},
            {"mkv", "h264", "yuv444p10le", 96},
            {"mov", "h265", NULL, 96},
            {"mp4", "av1", NULL, 96},
            {"webm", "vp9", NULL, 96},
            {"webm", "vp9", "yuva420p", 96},
            {"mkv", "ffv1", NULL, 96},
            {"mov", "prores", NULL, 96},
            {"mov", "prores4444", "yuva444p10le", 96},
            {"mkv", "dnxhr", NULL, 256},
            {"gif", "gif", NULL, 96},
            {"apng", "apng", "rgb24", 96},
            {"apng", "apng", "rgba64be", 96}};
enum { WAY_COUNT = sizeof ways / sizeof *ways };

static run run_of(int way, char path[64], const char *name) {
    snprintf(path, 64, "%s.%s", name, ways[way].ending);
    run r = plain;
    r.path = path;
    r.codec = ways[way].codec;
    r.pixels = ways[way].pixels;
    r.width = ways[way].width;
    r.height = ways[way].width > 200 ? 128 : 64;
    return r;
}

/* Killed again and again: in the middle of pieces, at their ends, before the first frame. Each
 * frame is rendered once in all, and the film is the same, of each codec and kind of file. */
static void killed_anywhere(void **state) {
    (void)state;
    const int steps[] = {0, 3, 5, 1, 7, 8, 2};
    for (int w = 0; w < WAY_COUNT; w++) {
        char path[64], whole[64];
        run r = run_of(w, path, "killed");
        snprintf(whole, sizeof whole, "whole.%s", ways[w].ending);
        make_whole(&r, whole);
        forget(path);
        int rendered = 0;
        for (int i = 0; i < 7; i++) {
            r.killed_after = steps[i];
            assert_int_equal(go_on_apart(&r), -1);
            rendered += steps[i];
            assert_false(exists(path));
        }
        r.killed_after = -1;
        assert_int_equal(go_on_apart(&r), COUNT - rendered);
        if (!same_files(path, whole)) fail_msg("%s %s: other bits", r.codec, path);
        assert_only_film(path);
        assert_int_equal(go_on_apart(&r), 0); /* there is nothing to do */
        if (!same_files(path, whole)) fail_msg("%s %s: it was touched", r.codec, path);
        assert_only_film(path);
    }
}

/* Killed from outside, at whatever moment that is. */
static void killed_anytime(void **state) {
    (void)state;
    srand(7);
    for (int w = 0; w < WAY_COUNT; w += 4) {
        char path[64], whole[64];
        run r = run_of(w, path, "anytime");
        snprintf(whole, sizeof whole, "whole.%s", ways[w].ending);
        make_whole(&r, whole);
        forget(path);
        for (int i = 0; i < 12; i++) {
            fflush(NULL);
            pid_t pid = fork();
            if (pid == 0) _exit(go_on(&r));
            usleep((useconds_t)(rand() % 60000));
            kill(pid, SIGKILL);
            assert_int_equal(waitpid(pid, NULL, 0), pid);
        }
        go_on_apart(&r);
        if (!same_files(path, whole)) fail_msg("%s: other bits", path);
        assert_only_film(path);
    }
}

/* What is cheap to render is not kept frame by frame: a piece at most is lost. */
static void cheap_frames(void **state) {
    (void)state;
    run r = plain;
    r.render_s = 0.001;
    make_whole(&r, "whole.mp4");
    r.killed_after = PIECE + 3;
    assert_int_equal(go_on_apart(&r), -1);
    assert_false(exists("film.mp4.part.frames"));
    r.killed_after = -1;
    assert_int_equal(go_on_apart(&r), COUNT - PIECE);
    assert_true(same_files("film.mp4", "whole.mp4"));
    forget("film.mp4");
}

/* While it grows the film plays: a decoder gets all that is in it, and it is a film for others,
 * too. */
static void plays_while_it_grows(void **state) {
    (void)state;
    for (int w = 0; w < WAY_COUNT; w++) {
        char path[64], part[80];
        run r = run_of(w, path, "grows");
        forget(path);
        r.killed_after = 2 * PIECE + 1;
        assert_int_equal(go_on_apart(&r), -1);
        snprintf(part, sizeof part, "%s.part", path);
        film m = film_open(part);
        AVFrame *frames[FRAMES_MAX] = {0};
        int count = decode(&m, 0, m.packet_count, frames);
        if (count < 2 * PIECE) fail_msg("%s: %d frames", part, count);
        for (int f = 0; f < count; f++) {
            double time = (double)frames[f]->pts * av_q2d(m.stream->time_base);
            if (fabs(time - f / 2.0) > 0.001) fail_msg("%s: frame %d at %g s", part, f, time);
            assert_int_equal(frames[f]->width, r.width);
        }
        free_frames(frames, count);
        film_close(&m);
        forget(path);
    }
}

/* One frame shows something else: only its piece is made again, and the film is that which
 * would have been made at once. A palette is the whole film's. */
static void edited(void **state) {
    (void)state;
    for (int w = 0; w < WAY_COUNT; w++) {
        char path[64], whole[64];
        run r = run_of(w, path, "edited");
        bool has_pieces = strcmp(ways[w].ending, "gif") && strcmp(ways[w].ending, "apng");
        snprintf(whole, sizeof whole, "whole.%s", ways[w].ending);
        forget(path);
        assert_int_equal(go_on_apart(&r), COUNT);
        r.edited = PIECE + 2;
        int made = go_on_apart(&r);
        if (made != (has_pieces ? PIECE : COUNT)) fail_msg("%s: %d frames", path, made);
        make_whole(&r, whole);
        if (!same_files(path, whole)) fail_msg("%s: other bits", path);
        assert_only_film(path);
        forget(path);
    }
}

/* Killed, edited, killed, and edited back. */
static void edited_between(void **state) {
    (void)state;
    run r = plain;
    make_whole(&r, "whole.mp4");
    r.killed_after = 2 * PIECE + 2;
    assert_int_equal(go_on_apart(&r), -1);
    r.edited = 1;
    r.killed_after = 3; /* of the first piece */
    assert_int_equal(go_on_apart(&r), -1);
    r.edited = UINT64_MAX;
    r.killed_after = -1;
    assert_int_equal(go_on_apart(&r), COUNT - 2 * PIECE - 2);
    assert_true(same_files("film.mp4", "whole.mp4"));
    assert_only_film("film.mp4");
    forget("film.mp4");
}

/* What is encoded in another way is encoded anew; a film that only says something else keeps
 * its pieces; and what overwrites begins from nothing. */
static void other_wishes(void **state) {
    (void)state;
    run r = plain;
    r.killed_after = 2 * PIECE;
    assert_int_equal(go_on_apart(&r), -1);
    r.killed_after = -1;
    r.pixels = "yuv444p";
    assert_int_equal(go_on_apart(&r), COUNT);
    make_whole(&r, "whole.mp4");
    assert_true(same_files("film.mp4", "whole.mp4"));
    r.title = "another one";
    assert_int_equal(go_on_apart(&r), 0);
    make_whole(&r, "whole.mp4");
    assert_true(same_files("film.mp4", "whole.mp4"));
    r.overwrites = true;
    assert_int_equal(go_on_apart(&r), COUNT);
    assert_true(same_files("film.mp4", "whole.mp4"));
    forget("film.mp4");
}

/* A film that is closed before its end plays, and goes on: of one with pieces nothing is left
 * beside it but frames that wait. */
static void closed_early(void **state) {
    (void)state;
    for (int w = 0; w < WAY_COUNT; w++) {
        char path[64], whole[64];
        run r = run_of(w, path, "early");
        snprintf(whole, sizeof whole, "whole.%s", ways[w].ending);
        forget(path);
        r.stopped_after = PIECE + 3;
        assert_int_equal(go_on_apart(&r), PIECE + 3);
        film m = film_open(path);
        assert_int_equal(m.packet_count, PIECE + 3);
        film_close(&m);
        r.stopped_after = -1;
        int made = go_on_apart(&r);
        if (made != COUNT - PIECE - 3) fail_msg("%s: %d frames", path, made);
        make_whole(&r, whole);
        if (!same_files(path, whole)) fail_msg("%s: other bits", path);
        assert_only_film(path);
        forget(path);
    }
}

static void spoil(const char *path, long at, int change) {
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    fseek(file, at, at < 0 ? SEEK_END : SEEK_SET);
    int c = fgetc(file);
    fseek(file, -1, SEEK_CUR);
    fputc(c ^ change, file);
    fclose(file);
}

static long size_of(const char *path) {
    struct stat s;
    assert_int_equal(stat(path, &s), 0);
    return (long)s.st_size;
}

/* Of a finished film that was damaged, what is damaged is made again. */
static void damaged_film(void **state) {
    (void)state;
    const char *const paths[] = {"film.mp4", "film.mkv"};
    for (int i = 0; i < 2; i++) {
        run r = plain;
        r.path = paths[i];
        char whole[64];
        snprintf(whole, sizeof whole, "whole%s", paths[i]);
        make_whole(&r, whole);
        assert_int_equal(go_on_apart(&r), COUNT);
        spoil(r.path, size_of(r.path) * 3 / 5, 0x10); /* in the pictures */
        int made = go_on_apart(&r);
        if (made != PIECE && made != COUNT - 3 * PIECE) fail_msg("%d frames", made);
        assert_true(same_files(r.path, whole));
        assert_int_equal(truncate(r.path, size_of(r.path) / 2), 0);
        made = go_on_apart(&r);
        assert_in_range(made, 1, COUNT);
        assert_true(same_files(r.path, whole));
        assert_int_equal(truncate(r.path, 0), 0);
        assert_int_equal(go_on_apart(&r), COUNT);
        assert_true(same_files(r.path, whole));
        forget(r.path);
    }
}

/* Whatever somebody did to the files beside the film, it is made, and right. */
static void damaged_parts(void **state) {
    (void)state;
    run r = plain;
    make_whole(&r, "whole.mp4");
    srand(11);
    for (int i = 0; i < 60; i++) {
        const char *path = i % 3 ? "film.mp4.part" : "film.mp4.part.frames";
        forget("film.mp4");
        r.killed_after = 2 * PIECE + 3;
        assert_int_equal(go_on_apart(&r), -1);
        long size = size_of(path);
        for (int k = 0; k < 1 + i % 4; k++) spoil(path, rand() % size, 1 + rand() % 255);
        if (i % 5 == 0) assert_int_equal(truncate(path, rand() % size), 0);
        if (i % 7 == 0) {
            FILE *file = fopen(path, "ab");
            for (int k = 0; k < 3000; k++) fputc(rand(), file);
            fclose(file);
        }
        r.killed_after = -1;
        assert_in_range(go_on_apart(&r), COUNT - 2 * PIECE - 3, COUNT);
        if (!same_files("film.mp4", "whole.mp4")) fail_msg("%d: other bits", i);
        assert_only_film("film.mp4");
    }
    forget("film.mp4");
}

int main(void) {
    av_log_set_level(AV_LOG_ERROR); /* decoders say which they are */
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(killed_anywhere), cmocka_unit_test(killed_anytime),
        cmocka_unit_test(cheap_frames),    cmocka_unit_test(plays_while_it_grows),
        cmocka_unit_test(edited),          cmocka_unit_test(edited_between),
        cmocka_unit_test(other_wishes),    cmocka_unit_test(closed_early),
        cmocka_unit_test(damaged_film),    cmocka_unit_test(damaged_parts)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
