/* Shows that an image's file says how it was rendered, so that it comes out again bit for bit,
 * and that what is not the same is found and told. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <zoetrope/aov.h>

#include "base/hash.h"
#include "base/machine.h"
#include "image/file.h"
#include "program.h"
#include "sequence/settings.h"

/* Renders frame 3 with options to a file, and reproduces it from another directory. */
static void assert_comes_again(const char *options, const char *file) {
    char arguments[512], told[256];
    snprintf(arguments, sizeof arguments, "render film.yaml --frames 3 --overwrite -o %s %s",
             file, options);
    zoetrope_succeeds(arguments);
    assert_int_equal(chdir("elsewhere"), 0);
    snprintf(arguments, sizeof arguments, "reproduce ../%s", file);
    run *r = zoetrope(arguments);
    if (r->code != 0) fail_msg("%s %s: %d %s%s", file, options, r->code, r->out, r->err);
    snprintf(told, sizeof told, "../%s, frame 3 of ../film.yaml: identical\n", file);
    assert_string_equal(r->out, told);
    assert_string_equal(r->err, "");
    assert_int_equal(chdir(".."), 0);
}

/* Whatever decided the pixels, and however they are stored. The description is found beside the
 * image. */
static void comes_again(void **state) {
    (void)state;
    assert_int_equal(mkdir("elsewhere", 0700), 0);
    assert_comes_again("", "a.exr");
    assert_comes_again("--format-option bits=half", "a.exr");
    assert_comes_again("--format-option compression=dwaa:45 --format-option tile=16", "a.exr");
    assert_comes_again("--aovs all --samples 3 --format-option parts=layers", "a.exr");
    assert_comes_again("--size 31x17 --precision double", "a.exr");
    assert_comes_again("--samples 2-9 --error 0.01 --filter gaussian", "a.exr");
    assert_comes_again("--quality edges --set film.seed=7", "a.exr");
    assert_comes_again("--set film.seed=fixed --set ball.radius=0.7", "a.exr");
    assert_comes_again("--set film.background=transparent", "a.exr");
    assert_comes_again("", "a.png");
    assert_comes_again("--format-option bits=16 --view filmic", "a.png");
    assert_comes_again("--set film.background=transparent --samples 4", "a.png");
    assert_comes_again("--view rec709", "a.tif");
    assert_comes_again("--format-option bits=8", "a.tif");
    assert_comes_again("--format-option bits=float", "a.tif");
    zoetrope_succeeds("frame film.yaml 5 -o b.exr");
    zoetrope_succeeds("reproduce b.exr");
    zoetrope_succeeds("frame film.yaml 5 --aovs Z,N -o c.{layer}.exr");
    zoetrope_succeeds("reproduce c.rgba.exr");
    zoetrope_succeeds("reproduce c.depth.exr");
    zoetrope_succeeds("reproduce c.N.exr");
}

/* Samples that a budget of time chose are each frame's own, and held frames' too. */
static void budget_comes_again(void **state) {
    (void)state;
    zoetrope_succeeds("render film.yaml --time-per-frame 20ms -o t.#.exr");
    zoetrope_succeeds("render film.yaml --frames 0-1 --set ball.center=[0,1,0] -o h.#.exr");
    const char *files[] = {"t.0.exr", "t.4.exr", "h.1.exr"};
    for (int i = 0; i < 3; i++) {
        char arguments[64];
        snprintf(arguments, sizeof arguments, "reproduce %s", files[i]);
        run *r = zoetrope(arguments);
        assert_int_equal(r->code, 0);
        assert_contains(r->out, ": identical\n");
    }
}

/* The film with one text in the place of another. */
static void change_film(const char *from, const char *to) {
    char text[2048];
    const char *at = strstr(film, from);
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - film), film, to, at + strlen(from));
    write_text("film.yaml", text);
}

/* A description that has changed since is the reason that is told; what changes no pixel is
 * none. */
static void description_changes(void **state) {
    (void)state;
    zoetrope_succeeds("render film.yaml --frames 3 -o a.exr");
    change_film("name: ball", "name: ball # which rolls");
    zoetrope_succeeds("reproduce a.exr");
    change_film("name: ball", "name: earth");
    zoetrope_succeeds("reproduce a.exr");
    change_film("1 s: [2, 1, 0]", "1 s: [2, 1.1, 0]");
    run *r = zoetrope("reproduce a.exr");
    assert_int_equal(r->code, 1);
    assert_string_equal(r->err, "");
    assert_contains(r->out, "a.exr, frame 3 of film.yaml: ");
    assert_contains(r->out, " of 2304 pixels differ\n");
    assert_contains(r->out, "film.yaml, or what it refers to, has changed since\n");
    write_text("old.yaml", film);
    zoetrope_succeeds("reproduce a.exr old.yaml");
    /* Below the plane, where no light falls on it and no ray meets it. */
    change_film("objects:\n", "objects:\n"
                              "  - sphere: { center: [0, -9, 0], radius: 1 }\n");
    r = zoetrope("reproduce a.exr");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "identical pixels, though what is rendered differs\n");
}

/* Changes a number of an image's file, which stays what it says it is. */
static void touch_pixel(const char *path, const char *option, size_t index, float by) {
    zt_image *image;
    zt_image_wishes wishes;
    const zt_wish options[] = {{"format-option", option}, {NULL, NULL}};
    const zt_listener none = {0};
    assert_int_equal(zt_image_read(&image, path, none), ZT_OK);
    image->pixels[index] += by;
    assert_int_equal(zt_image_wish(&wishes, path, options, none), ZT_OK);
    assert_int_equal(zt_image_file_write(image, ZT_VIEW_RAW, &wishes, path, none), ZT_OK);
    zt_image_free(&image);
}

/* One number of one pixel that was changed is found, at its place, and said to be the file's
 * own change. */
static void pixels_change(void **state) {
    (void)state;
    zoetrope_succeeds("render film.yaml --frames 3 -o a.exr");
    touch_pixel("a.exr", "bits=float", 4 * (64 * 7 + 10) + 1, 0.5F);
    touch_pixel("a.exr", "bits=float", 4 * (64 * 30 + 2) + 2, -8.0F);
    run *r = zoetrope("reproduce a.exr");
    assert_int_equal(r->code, 1);
    assert_contains(r->out, ": 2 of 2304 pixels differ\npixel 10,7: G was ");
    assert_contains(r->out, "\npixel 2,30: B was -");
    assert_null(strstr(r->out, "..."));
    assert_contains(r->out, "the largest difference, 8, is at pixel 2,30: B was ");
    assert_contains(r->out, "what is rendered is the same: a.exr has changed, or the machine");
    /* The least that a number can change by. */
    zoetrope_succeeds("render film.yaml --frames 3 --overwrite -o a.exr");
    zoetrope_succeeds("reproduce a.exr");
    touch_pixel("a.exr", "bits=float", 4 * (64 * 35 + 63) + 3, -0x1p-24F);
    r = zoetrope("reproduce a.exr");
    assert_int_equal(r->code, 1);
    assert_contains(r->out,
                    "1 of 2304 pixels differ\npixel 63,35: A was 0.99999994, and is 1\n");
}

/* A copy of a file with the settings that it says replaced. */
static void write_with_settings(const char *path, const char *from, const char *settings) {
    zt_image *image;
    zt_image_wishes wishes;
    const zt_listener none = {0};
    assert_int_equal(zt_image_read(&image, from, none), ZT_OK);
    image->info.settings = settings;
    assert_int_equal(zt_image_wish(&wishes, path, NULL, none), ZT_OK);
    assert_int_equal(zt_image_file_write(image, ZT_VIEW_RAW, &wishes, path, none), ZT_OK);
    zt_image_free(&image);
}

/* What cannot be reproduced is told, with the reason. */
static void refusals(void **state) {
    (void)state;
    assert_int_equal(mkdir("far", 0700), 0);
    zoetrope_succeeds("render film.yaml --frames 3 -o a.exr");
    zoetrope_succeeds("render film.yaml --frames 3 -o a.jpg");
    zt_image *image;
    assert_int_equal(zt_image_read(&image, "a.exr", (zt_listener){0}), ZT_OK);
    assert_contains(image->info.settings, "\"arithmetic\": \"zoetrope 3 " ZT_MACHINE "\"");
    zt_image_free(&image);
    write_with_settings("far/a.exr", "a.exr",
                        "{\"zoetrope\": 1, \"arithmetic\": \"zoetrope 3 " ZT_MACHINE
                        "\", \"size\": [64, 36], "
                        "\"min\": 1, \"max\": 1, \"filter\": \"box\", \"seed\": 0, "
                        "\"precision\": \"auto\", \"view\": \"srgb\"}");
    write_with_settings("broken.exr", "a.exr", "{\"zoetrope\": 1, \"size\": 7}");
    write_with_settings("nothing.exr", "a.exr", NULL);
    write_with_settings("small.exr", "a.exr",
                        "{\"zoetrope\": 1, \"arithmetic\": \"zoetrope 3 " ZT_MACHINE
                        "\", \"size\": [64, 35], "
                        "\"min\": 1, \"max\": 1, \"filter\": \"box\", \"seed\": 0, "
                        "\"precision\": \"auto\", \"view\": \"srgb\"}");
    write_with_settings(
        "later.exr", "a.exr",
        "{\"zoetrope\": 1, \"arithmetic\": \"zoetrope 3 vax\", \"size\": [64, 36], "
        "\"min\": 2, \"max\": 2, \"filter\": \"box\", \"seed\": 0, "
        "\"precision\": \"auto\", \"view\": \"srgb\"}");
    static const refusal cases[] = {
        {"reproduce none.exr", "cannot read none.exr", 3},
        {"reproduce film.yaml", "cannot read film.yaml", 3},
        {"reproduce a.jpg", "a.jpg does not say how it was rendered; .exr, .png and .tif", 3},
        {"reproduce nothing.exr", "nothing.exr does not say how it was rendered", 3},
        {"reproduce broken.exr", "broken.exr:1:", 3},
        {"reproduce small.exr", "small.exr was rendered with 64 x 35 pixels, and has 64 x 36",
         3},
        {"reproduce a.exr none.yaml", "none.yaml", 3},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run *r = zoetrope(cases[i].arguments);
        if (r->code != cases[i].code)
            fail_msg("%s: %d %s", cases[i].arguments, r->code, r->err);
        assert_contains(r->err, cases[i].told);
        assert_string_equal(r->out, "");
    }
    run *r = zoetrope("reproduce later.exr");
    assert_int_equal(r->code, 1); /* of the same version on another architecture */
    assert_contains(r->out, "by a version of the program, or on an architecture, "
                            "that computes other pixels\n");
    assert_int_equal(chdir("far"), 0);
    r = zoetrope("reproduce a.exr");
    assert_int_equal(chdir(".."), 0);
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "a.exr is of film.yaml, which is neither there nor beside it; say "
                            "where it is: zoetrope reproduce a.exr FILE");
}

/* ---- the text of settings ------------------------------------------------------------------
 */

/* All that a text says is read again from it, whatever the names are made of. */
static void settings_are_read_again(void **state) {
    (void)state;
    const zt_override overrides[] = {{"big \"one\".x", "a\\b\n\t[1, 2]"},
                                     {"k\xC3\xB6rper \xF0\x9D\x84\x9E.y", "\x01\x7F"}};
    const zt_settings settings = {.width = 65536,
                                  .height = 1,
                                  .sampling = {.min = 3,
                                               .max = 65536,
                                               .error = 1.0 / 3,
                                               .mean_max = 77,
                                               .edges = true,
                                               .filter = ZT_FILTER_BLACKMAN_HARRIS,
                                               .filter_width = 0.1 + 0.2,
                                               .seed = UINT32_MAX,
                                               .seed_fixed = true},
                                  .precision = ZT_PRECISION_DOUBLE,
                                  .aovs = ZT_AOV_Z | ZT_AOV_ERROR,
                                  .view = ZT_VIEW_FILMIC,
                                  .color = {true, "a b.ocio", NULL, "Film"},
                                  .format = "bits=half,tile=64",
                                  .overrides = overrides,
                                  .override_count = 2,
                                  .arithmetic = "some \"version\""};
    zt_arena arena = {0};
    zt_settings read;
    heard h;
    const char *text;
    assert_int_equal(zt_settings_print(&text, &settings, &arena), ZT_OK);
    for (const char *c = text; *c; c++) assert_in_range(*c, 32, 126); /* one line of ASCII */
    assert_int_equal(zt_settings_read(&read, text, "a", &arena, listener_of(&h)), ZT_OK);
    assert_int_equal(read.width, 65536);
    assert_int_equal(read.height, 1);
    assert_int_equal(read.sampling.min, 3);
    assert_int_equal(read.sampling.max, 65536);
    assert_true(read.sampling.error == 1.0 / 3);
    assert_int_equal(read.sampling.mean_max, 77);
    assert_true(read.sampling.edges && read.sampling.seed_fixed);
    assert_int_equal(read.sampling.filter, ZT_FILTER_BLACKMAN_HARRIS);
    assert_true(read.sampling.filter_width == 0.1 + 0.2);
    assert_true(read.sampling.seed == UINT32_MAX);
    assert_int_equal(read.precision, ZT_PRECISION_DOUBLE);
    assert_int_equal(read.aovs, ZT_AOV_Z | ZT_AOV_ERROR);
    assert_int_equal(read.view, ZT_VIEW_FILMIC);
    assert_true(read.color.wished && !read.color.display);
    assert_string_equal(read.color.config, "a b.ocio");
    assert_string_equal(read.color.view, "Film");
    assert_string_equal(read.format, "bits=half,tile=64");
    assert_string_equal(read.arithmetic, "some \"version\"");
    assert_int_equal(read.override_count, 2);
    for (int i = 0; i < 2; i++) {
        assert_string_equal(read.overrides[i].name, overrides[i].name);
        assert_string_equal(read.overrides[i].value, overrides[i].value);
    }
    zt_arena_free(&arena);
}

/* Texts that are no such thing are told at their place; none is taken for another one. */
static void settings_that_are_none(void **state) {
    (void)state;
#define HEAD "{\"zoetrope\": 1, \"arithmetic\": \"1\", \"size\": [4, 4], "
#define REST "\"filter\": \"box\", \"precision\": \"auto\", \"view\": \"srgb\""
    const char *const texts[] = {
        "",
        "{}",
        "[]",
        "{\"zoetrope\": 2, \"arithmetic\": \"1\", \"size\": [4, 4], \"min\": 1, \"max\": "
        "1, " REST "}",
        HEAD "\"min\": 1, " REST "}",
        HEAD "\"min\": 2, \"max\": 1, " REST "}",
        HEAD "\"min\": 1, \"max\": 1, \"max\": 1, " REST "}",
        HEAD "\"min\": 0, \"max\": 1, " REST "}",
        HEAD "\"min\": 1, \"max\": 1, " REST ", \"aovs\": [\"Q\"]}",
        HEAD "\"min\": 1, \"max\": 1, " REST ", \"aovs\": []}",
        HEAD "\"min\": 1, \"max\": 1, " REST ", \"set\": [\"a\"]}",
        HEAD "\"min\": 1, \"max\": 1, " REST ", \"set\": [\"a\", \"\\ud800\"]}",
        HEAD "\"min\": 1, \"max\": 1, " REST ", \"quality\": \"good\"}",
        HEAD "\"min\": 1, \"max\": 1, " REST "} {",
        HEAD "\"min\": 1, \"max\": 1, " REST,
    };
    zt_arena arena = {0};
    zt_settings read;
    heard h;
    assert_int_equal(zt_settings_read(&read, HEAD "\"min\": 1, \"max\": 1, " REST "}", "a",
                                      &arena, listener_of(&h)),
                     ZT_OK);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        zt_status status = zt_settings_read(&read, texts[i], "a", &arena, listener_of(&h));
        if (status != ZT_EFILE || h.error_count != 1)
            fail_msg("%d, %d errors: %s", status, h.error_count, texts[i]);
    }
    zt_arena_free(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(comes_again),
        IN_DIRECTORY(budget_comes_again),
        IN_DIRECTORY(description_changes),
        IN_DIRECTORY(pixels_change),
        IN_DIRECTORY(refusals),
        cmocka_unit_test(settings_are_read_again),
        cmocka_unit_test(settings_that_are_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
