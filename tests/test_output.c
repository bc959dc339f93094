/* Outputs: the rules that hold for all of them, numbered images, and checksums. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "files.h"
#include "image/file.h"
#include <zoetrope/output.h>

static const zt_output_format format = {
    .width = 16, .height = 12, .rate = {24, 1}, .view = ZT_VIEW_SRGB};

static zt_output *open_output(const char *target) {
    heard h;
    zt_output *output;
    if (zt_output_open(&output, target, &format, NULL, listener_of(&h)) != ZT_OK)
        fail_msg("%s", h.text);
    return output;
}

static void assert_refused(const char *target, const char *words) {
    heard h;
    zt_output *output = (zt_output *)&h;
    assert_int_not_equal(zt_output_open(&output, target, &format, NULL, listener_of(&h)),
                         ZT_OK);
    assert_null(output);
    assert_told(&h, words);
}

static void write_frames(zt_output *output, const int64_t *frames, int count) {
    for (int i = 0; i < count; i++) {
        zt_image *image = picture(format.width, format.height, (int)frames[i]);
        assert_int_equal(zt_output_write(output, image, frames[i]), ZT_OK);
        zt_image_free(&image);
    }
}

static void write_all(const char *target, const int64_t *frames, int count) {
    zt_output *output = open_output(target);
    write_frames(output, frames, count);
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* The image at `path` is the one that was written as this frame, bit for bit. */
static void assert_frame(const char *path, int frame) {
    zt_image *image = picture(format.width, format.height, frame);
    heard h;
    zt_image_wishes wishes;
    assert_int_equal(zt_image_wish(&wishes, path, NULL, listener_of(&h)), ZT_OK);
    assert_int_equal(
        zt_image_file_write(image, format.view, &wishes, "expected", listener_of(&h)), ZT_OK);
    zt_image_free(&image);
    if (!exists(path)) fail_msg("no file %s", path);
    assert_true(same_files(path, "expected"));
}

/* A # or @ is a digit, %04d four of them, a minus is none, and a number that needs more gets
 * more: no two frames share a file. Directories are made; those that look like patterns are not
 * taken for one. */
static void patterns(void **state) {
    (void)state;
    const int64_t frames[] = {-3, 0, 7, 42, 9999, 10000, 123456789012};
    const struct {
        const char *target, *names[7];
    } cases[] = {
        {"p1/a.####.png",
         {"a.-0003.png", "a.0000.png", "a.0007.png", "a.0042.png", "a.9999.png", "a.10000.png",
          "a.123456789012.png"}},
        {"p2/deep/er/%03d.exr",
         {"-003.exr", "000.exr", "007.exr", "042.exr", "9999.exr", "10000.exr",
          "123456789012.exr"}},
        {"p3#%s%d##/b%dc.TIF",
         {"b-3c.TIF", "b0c.TIF", "b7c.TIF", "b42c.TIF", "b9999c.TIF", "b10000c.TIF",
          "b123456789012c.TIF"}},
        {"./p4//#.jpg",
         {"-3.jpg", "0.jpg", "7.jpg", "42.jpg", "9999.jpg", "10000.jpg", "123456789012.jpg"}},
        {"p5@@/a@@@.png",
         {"a-003.png", "a000.png", "a007.png", "a042.png", "a9999.png", "a10000.png",
          "a123456789012.png"}},
    };
    for (int c = 0; c < 5; c++) {
        write_all(cases[c].target, frames, 7);
        int directory_length = (int)(strrchr(cases[c].target, '/') - cases[c].target);
        for (int i = 0; i < 7; i++) {
            char path[128];
            snprintf(path, sizeof path, "%.*s/%s", directory_length, cases[c].target,
                     cases[c].names[i]);
            assert_frame(path, (int)frames[i]);
        }
        char directory[64];
        snprintf(directory, sizeof directory, "%.*s", directory_length, cases[c].target);
        assert_int_equal(entry_count(directory), 7); /* nothing else is left there */
    }
}

/* What printf would do something with, and what says no or two places, is refused at once. */
static void hostile_patterns(void **state) {
    (void)state;
    const char *const targets[] = {
        "h/%s.png",
        "h/%n.png",
        "h/%.png",
        "h/%%.png",
        "h/%x.png",
        "h/%4d.png",
        "h/%0d.png",
        "h/%00d.png",
        "h/%-4d.png",
        "h/%+d.png",
        "h/%*d.png",
        "h/%1$d.png",
        "h/%ld.png",
        "h/%04d%04d.png",
        "h/##%d.png",
        "h/%d##.png",
        "h/a#b#.png",
        "h/#@.png",
        "h/@@%d.png",
        "h/@@@@@@@@@@@@@@@@@@@@@.png",
        "h/%04d.%s.png",
        "h/%099999999999d.png",
        "h/%0999d.png",
        "h/%021d.png",
        "h/%04294967300d.png",
        "h/%0-4d.png",
        "h/#####################.png",
    };
    for (size_t i = 0; i < sizeof targets / sizeof *targets; i++)
        assert_refused(targets[i], "frame number");
    assert_false(exists("h"));
}

/* A name without a place for the number is one image; the second is refused, the first stays.
 */
static void single_image(void **state) {
    (void)state;
    const int64_t frames[] = {5, 6};
    write_all("one/image.png", frames, 1);
    assert_frame("one/image.png", 5);

    heard h;
    zt_output *output;
    assert_int_equal(zt_output_open(&output, "one/two.png", &format, NULL, listener_of(&h)),
                     ZT_OK);
    write_frames(output, frames, 1);
    zt_image *image = picture(format.width, format.height, 6);
    assert_int_equal(zt_output_write(output, image, 6), ZT_EARGUMENT);
    assert_told(&h, "####");
    assert_int_equal(zt_output_write(output, image, 7), ZT_EARGUMENT);
    assert_int_equal(h.error_count, 1); /* told once */
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_frame("one/two.png", 5);
    assert_int_equal(entry_count("one"), 2);
    zt_image_free(&image);

    /* Told beforehand that more will come, it is refused before the first. */
    zt_output_format several = format;
    several.frame_count = 2;
    assert_int_equal(zt_output_open(&output, "one/three.png", &several, NULL, listener_of(&h)),
                     ZT_EARGUMENT);
    assert_null(output);
    assert_int_equal(entry_count("one"), 2);
}

/* Endings that do not exist: the message names those that do, and the nearest. */
static void unknown_endings(void **state) {
    (void)state;
    assert_refused("u/film.mp5", "did you mean \".mp4\"?");
    assert_refused("u/a.####.pgn", "did you mean \".png\"?");
    assert_refused("u/a.hsah", "did you mean \".hash\"?");
    assert_refused("u.png/film", "a movie .mp4 .mov .mkv .webm .gif .apng; images .png .exr "
                                 ".tif .tiff .jpg .jpeg .webp .hdr .dpx; "
                                 "checksums .hash");
    assert_refused("u/%s%n", "no output is named u/%s%n");
    assert_refused("", "no output is named");
    assert_refused("mp4", "no output is named mp4");
    assert_false(exists("u") || exists("u.png"));
}

/* Each kind of output refuses, before the first image, a place where nothing can be written. */
static void unwritable_places(void **state) {
    (void)state;
    const char *const names[] = {"a.mp4", "a.####.png", "a.png", "a.hash"};
    fclose(fopen("file", "w"));
    for (int i = 0; i < 4; i++) {
        char target[64];
        snprintf(target, sizeof target, "file/%s", names[i]);
        assert_refused(target, "Not a directory");
        snprintf(target, sizeof target, "file/deeper/%s", names[i]);
        assert_refused(target, "Not a directory");
        snprintf(target, sizeof target, "/proc/zoetrope/%s", names[i]);
        assert_refused(target, "cannot make the directory /proc/zoetrope: ");
    }
    assert_int_equal(mkdir("taken.mp4", 0777) | mkdir("taken.png", 0777), 0);
    assert_refused("taken.mp4", "it is a directory");
    assert_refused("taken.png", "it is a directory");
    char path[400] = "long/";
    memset(path + 5, 'x', 300);
    memcpy(path + 305, ".mp4", 5);
    assert_refused(path, "File name too long");
}

/* The same for a directory without the right to write, which does not bind the superuser. */
static void forbidden_directory(void **state) {
    (void)state;
    uid_t user = geteuid();
    assert_int_equal(mkdir("forbidden", 0555), 0);
    if (user == 0 && seteuid(65534) != 0) skip();
    assert_refused("forbidden/a.mp4", "Permission denied");
    assert_refused("forbidden/a.####.png", "Permission denied");
    assert_refused("forbidden/a.hash", "Permission denied");
    assert_refused("forbidden/deeper/a.png", "Permission denied");
    assert_int_equal(seteuid(user), 0);
}

/* An older image stays until the new one is complete. On a full disk it stays, too, nothing
 * half is left, and the error is told once. */
static void full_disk(void **state) {
    (void)state;
    const char *const targets[] = {"full/a.####.png", "full/a.####.exr", "full/a.####.tif",
                                   "full/a.####.jpg", "full/a.hash"};
    const char *const files[] = {"full/a.0001.png", "full/a.0001.exr", "full/a.0001.tif",
                                 "full/a.0001.jpg", "full/a.hash"};
    const int64_t older[] = {1};
    for (int i = 0; i < 5; i++) {
        write_all(targets[i], older, 1);
        size_t size, size_now;
        char *bytes = file_bytes(files[i], &size);
        heard h;
        zt_output *output;
        assert_int_equal(zt_output_open(&output, targets[i], &format, NULL, listener_of(&h)),
                         ZT_OK);
        zt_image *image = picture(format.width, format.height, 2);
        disk_has(20);
        assert_int_equal(zt_output_write(output, image, 1), ZT_EFILE);
        assert_int_equal(zt_output_write(output, image, 2), ZT_EFILE);
        disk_has(0);
        assert_int_equal(zt_output_write(output, image, 3), ZT_EFILE);
        assert_int_equal(zt_output_close(&output), ZT_OK);
        assert_told(&h, "File too large");
        char *bytes_now = file_bytes(files[i], &size_now);
        assert_int_equal(size_now, size);
        assert_memory_equal(bytes_now, bytes, size);
        free(bytes);
        free(bytes_now);
        zt_image_free(&image);
    }
    assert_int_equal(entry_count("full"), 5);
}

/* The rules for all outputs: images of the size that was told, frames that rise, rates and
 * sizes that make sense; an output that failed stays failed; closing twice, or nothing, is
 * harmless. */
static void rules(void **state) {
    (void)state;
    heard h;
    zt_output *output;
    zt_image *image = picture(format.width, format.height, 0);
    zt_image *other = picture(format.height, format.width, 0);
    const char *const targets[] = {"rules/a.mp4", "rules/##.png", "rules/a.hash"};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(zt_output_open(&output, targets[i], &format, NULL, listener_of(&h)),
                         ZT_OK);
        assert_int_equal(zt_output_write(output, other, 0), ZT_EARGUMENT);
        assert_told(&h, "12x16");
        assert_int_equal(zt_output_write(output, image, 0), ZT_EARGUMENT);
        assert_int_equal(zt_output_close(&output), ZT_OK);

        assert_int_equal(zt_output_open(&output, targets[i], &format, NULL, listener_of(&h)),
                         ZT_OK);
        assert_int_equal(zt_output_write(output, image, -4), ZT_OK);
        assert_int_equal(zt_output_write(output, image, 9), ZT_OK);
        assert_int_equal(zt_output_write(output, image, 9), ZT_EARGUMENT);
        assert_told(&h, "frame 9 came after frame 9");
        assert_int_equal(zt_output_close(&output), ZT_OK);
        assert_int_equal(zt_output_close(&output), ZT_OK);
    }
    assert_int_equal(entry_count("rules"), 2); /* the two images that were complete */

    const zt_output_format wrong[] = {
        {.width = 0, .height = 12, .rate = {24, 1}, .view = ZT_VIEW_RAW},
        {.width = 16, .height = -2, .rate = {24, 1}, .view = ZT_VIEW_RAW},
        {.width = 16, .height = 65538, .rate = {24, 1}, .view = ZT_VIEW_RAW},
        {.width = 16, .height = 12, .rate = {0, 1}, .view = ZT_VIEW_RAW},
        {.width = 16, .height = 12, .rate = {24, 0}, .view = ZT_VIEW_RAW},
        {.width = 16, .height = 12, .rate = {-24, -1}, .view = ZT_VIEW_RAW}};
    for (int i = 0; i < 6; i++) {
        assert_int_equal(
            zt_output_open(&output, "wrong/a.mp4", &wrong[i], NULL, listener_of(&h)),
            ZT_EARGUMENT);
        assert_null(output);
        assert_int_equal(h.error_count, 1);
    }
    assert_false(exists("wrong"));
    zt_image_free(&image);
    zt_image_free(&other);
}

/* An option that an output does not know is refused before anything is made, and the one that
 * may have been meant is named; a list may be empty. */
static void unknown_options(void **state) {
    (void)state;
    const struct {
        const char *target, *name, *words;
    } cases[] = {
        {"options/a.hash", "preset", "no option \"preset\" for checksums"},
        {"options/a.png", "preset", "no option \"preset\" for images"},
        {"options/a.mp4", "presets",
         "no option \"presets\" for a movie; did you mean \"preset\"?"},
        {"options/a.mp4", "", "no option \"\" for a movie"},
    };
    zt_output *output;
    for (int i = 0; i < 4; i++) {
        heard h;
        const zt_output_option options[] = {{cases[i].name, "fast"}, {NULL, NULL}};
        assert_int_equal(
            zt_output_open(&output, cases[i].target, &format, options, listener_of(&h)),
            ZT_EARGUMENT);
        assert_null(output);
        assert_told(&h, cases[i].words);
    }
    assert_false(exists("options"));
    const zt_output_option none[] = {{NULL, NULL}};
    heard h;
    assert_int_equal(zt_output_open(&output, "a.hash", &format, none, listener_of(&h)), ZT_OK);
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* A line for each frame, all of one length; the sum is XXH3's, and changes with the least of
 * bits. Nothing is there before it is complete. */
static void checksums(void **state) {
    (void)state;
    zt_image *image = picture(format.width, format.height, 0);
    for (int i = 0; i < 4 * 16 * 12; i++) image->pixels[i] = 0;
    zt_output *output = open_output("sums/a.hash");
    assert_int_equal(zt_output_write(output, image, -7), ZT_OK);
    image->pixels[700] = 1e-45f;
    assert_int_equal(zt_output_write(output, image, 0), ZT_OK);
    image->pixels[700] = 0;
    assert_int_equal(zt_output_write(output, image, 123456), ZT_OK);
    assert_false(exists("sums/a.hash"));
    assert_int_equal(zt_output_close(&output), ZT_OK);
    size_t size;
    char *text = file_bytes("sums/a.hash", &size), sums[3][33];
    const char *const beginnings[] = {"          -7    16x12    ", "           0    16x12    ",
                                      "      123456    16x12    "};
    assert_int_equal(size, 3 * 58);
    for (int i = 0; i < 3; i++) {
        assert_memory_equal(text + 58 * i, beginnings[i], 25);
        assert_int_equal(sscanf(text + 58 * i + 25, "%32[0-9a-f]\n", sums[i]), 1);
        assert_int_equal(strlen(sums[i]), 32);
        assert_int_equal(text[58 * i + 57], '\n');
    }
    /* head -c 3072 /dev/zero | xxhsum -H2 */
    assert_string_equal(sums[0], "9d8b4c3ca1cf49010c0c6fa00c213db1");
    assert_string_equal(sums[2], sums[0]);
    assert_string_not_equal(sums[1], sums[0]);
    free(text);
    zt_image_free(&image);

    output = open_output("sums/a.hash"); /* nothing written: the older one stays */
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_true(exists("sums/a.hash"));
    assert_int_equal(entry_count("sums"), 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patterns),          cmocka_unit_test(hostile_patterns),
        cmocka_unit_test(single_image),      cmocka_unit_test(unknown_endings),
        cmocka_unit_test(unwritable_places), cmocka_unit_test(forbidden_directory),
        cmocka_unit_test(full_disk),         cmocka_unit_test(rules),
        cmocka_unit_test(unknown_options),   cmocka_unit_test(checksums),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
