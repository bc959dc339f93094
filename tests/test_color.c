/* Views of OpenColorIO: what becomes of colours is what the configuration says, by closed
 * forms; what is not there is told before the first image. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "files.h"
#include "image/color.h"
#include <zoetrope/output.h>

/* A configuration whose reference is some space of its own: Rec. 709 goes to it by a matrix
 * where the space's name is one that is known. Views: the reference itself, a power of it, and
 * a table in a file. */
static void write_config(const char *path, const char *light, const char *power) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(
        file,
        "ocio_profile_version: 1\n"
        "search_path: .\n"
        "strictparsing: true\n"
        "roles: { default: reference, scene_linear: reference }\n"
        "displays:\n"
        "  screen:\n"
        "    - !<View> { name: plain, colorspace: reference }\n"
        "    - !<View> { name: powerful, colorspace: power }\n"
        "  projector:\n"
        "    - !<View> { name: tabled, colorspace: table }\n"
        "active_displays: [ screen, projector ]\n"
        "active_views: [ plain, powerful, tabled ]\n"
        "colorspaces:\n"
        "  - !<ColorSpace> { name: reference }\n"
        "  - !<ColorSpace>\n"
        "    name: %s\n"
        "    to_reference: !<MatrixTransform> { matrix: [ 0.5, 0.25, 0.125, 0, 0.1, 0.8, "
        "0.05, 0, 0, 0.2, 0.6, 0, 0, 0, 0, 1 ] }\n"
        "  - !<ColorSpace>\n"
        "    name: power\n"
        "    from_reference: !<ExponentTransform> { value: [ %s, %s, %s, 1 ] }\n"
        "  - !<ColorSpace>\n"
        "    name: table\n"
        "    from_reference: !<FileTransform> { src: table.spi1d, interpolation: linear }\n",
        light, power, power, power);
    assert_int_equal(fclose(file), 0);
}

/* Straight from 0 to `middle` at 0.5, and from there to 1. */
static void write_table(double middle) {
    FILE *file = fopen("table.spi1d", "w");
    assert_non_null(file);
    fprintf(file, "Version 1\nFrom 0.0 1.0\nLength 3\nComponents 1\n{\n 0.0\n %g\n 1.0\n}\n",
            middle);
    assert_int_equal(fclose(file), 0);
}

static zt_color_wish wish_of(const char *config, const char *display, const char *view) {
    return (zt_color_wish){true, config, display, view};
}

static zt_color *opened(zt_color_wish wish) {
    heard h;
    zt_color *color;
    if (zt_color_open(&color, &wish, listener_of(&h)) != ZT_OK) fail_msg("%s", h.text);
    assert_non_null(color);
    return color;
}

enum { COUNT = 1000 };

/* Colours from dark to beyond white. */
static void fill(float *pixels) {
    for (int i = 0; i < 3 * COUNT; i++)
        pixels[i] = (float)(i % 3 == 0   ? 1e-3 * (i / 3)
                            : i % 3 == 1 ? 0.9 - 6e-4 * (i / 3)
                                         : 1.5 * fabs(sin(i)));
}

/* Applies a view to colours and compares them with Rec. 709 by the matrix, where that counts,
 * and then a function. */
static void compare(zt_color_wish wish, bool matrix, double (*then)(double)) {
    static const double rows[3][3] = {{0.5, 0.25, 0.125}, {0.1, 0.8, 0.05}, {0, 0.2, 0.6}};
    float light[3 * COUNT], shown[3 * COUNT];
    zt_color *color = opened(wish);
    fill(light);
    memcpy(shown, light, sizeof light);
    color->apply(color, shown, COUNT);
    for (int i = 0; i < 3 * COUNT; i++) {
        const float *from = light + i / 3 * 3;
        double expected = (double)light[i];
        if (matrix)
            expected = rows[i % 3][0] * (double)from[0] + rows[i % 3][1] * (double)from[1] +
                       rows[i % 3][2] * (double)from[2];
        expected = then(expected);
        if (fabs((double)shown[i] - expected) > 2e-5)
            fail_msg("%s, %s: %g becomes %.7g instead of %.7g", wish.display, wish.view,
                     (double)light[i], (double)shown[i], expected);
    }
    zt_color_close(&color);
    assert_null(color);
}

static double same(double value) { return value; }
static double squared(double value) { return value * value; }
static double tabled(double value) {
    return value >= 1 ? 1 : value < 0.5 ? 0.6 * value : 0.3 + 1.4 * (value - 0.5);
}

/* Each view of each display; the usual ones where none is named; and $OCIO where no file is. */
static void views_are_the_configurations(void **state) {
    (void)state;
    write_config("a.ocio", "lin_rec709", "2");
    write_table(0.3);
    compare(wish_of("a.ocio", "screen", "plain"), true, same);
    compare(wish_of("a.ocio", "screen", "powerful"), true, squared);
    compare(wish_of("a.ocio", "projector", "tabled"), true, tabled);
    compare(wish_of("a.ocio", NULL, "powerful"), true, squared);
    compare(wish_of("a.ocio", "projector", NULL), true, tabled);
    compare(wish_of("a.ocio", NULL, NULL), true, same);
    assert_int_equal(setenv("OCIO", "a.ocio", 1), 0);
    compare(wish_of(NULL, "screen", "powerful"), true, squared);
    assert_int_equal(unsetenv("OCIO"), 0);
}

/* Where a configuration does not know linear Rec. 709, its scene_linear is taken for it. */
static void light_is_scene_linear_elsewhere(void **state) {
    (void)state;
    write_config("b.ocio", "Linear Rec.709 (sRGB)", "2");
    compare(wish_of("b.ocio", "screen", "powerful"), true, squared);
    write_config("c.ocio", "other", "2");
    compare(wish_of("c.ocio", "screen", "powerful"), false, squared);
}

/* What there is not is told, with what there is; nothing is opened. */
static void refusals(void **state) {
    (void)state;
    write_config("a.ocio", "lin_rec709", "2");
    write_table(0.3);
    FILE *file = fopen("no.ocio", "w");
    assert_true(file && fputs("this is: [ no configuration\n", file) >= 0 && fclose(file) == 0);
    assert_int_equal(mkdir("elsewhere", 0777), 0);
    write_config("elsewhere/a.ocio", "lin_rec709", "2"); /* without its table */
    assert_int_equal(unsetenv("OCIO"), 0);
    const struct {
        zt_color_wish wish;
        const char *words;
    } cases[] = {
        {wish_of("missing.ocio", NULL, NULL), "missing.ocio: the file cannot be read"},
        {wish_of(".", NULL, NULL), ".: the file cannot be read"},
        {wish_of("no.ocio", NULL, NULL), "no.ocio: "},
        {wish_of(NULL, NULL, NULL), "$OCIO is not set"},
        {wish_of("a.ocio", "screem", NULL),
         "no display \"screem\"; did you mean \"screen\"? There is: screen, projector"},
        {wish_of("a.ocio", "wall", NULL), "no display \"wall\". There is: screen, projector"},
        {wish_of("a.ocio", "screen", "tabled"),
         "no view \"tabled\" of the display \"screen\". There is: plain, powerful"},
        {wish_of("a.ocio", "screen", "plan"), "did you mean \"plain\"?"},
        {wish_of("elsewhere/a.ocio", "projector", NULL), "table.spi1d"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        heard h;
        zt_color *color;
        assert_int_not_equal(zt_color_open(&color, &cases[i].wish, listener_of(&h)), ZT_OK);
        assert_null(color);
        assert_told(&h, cases[i].words);
    }
    zt_color *none;
    heard h;
    assert_int_equal(zt_color_open(&none, &(zt_color_wish){0}, listener_of(&h)), ZT_OK);
    assert_null(none);
}

static void assert_manner(zt_color_wish wish, const char *manner, bool same_one) {
    zt_color *color = opened(wish);
    assert_int_equal(strcmp(color->manner, manner) == 0, same_one);
    zt_color_close(&color);
}

/* What a view is known by changes with all that decides the numbers, tables in other files,
 * too, and with nothing else. */
static void manners_tell_apart(void **state) {
    (void)state;
    write_config("a.ocio", "lin_rec709", "2");
    write_table(0.3);
    const zt_color_wish power = wish_of("a.ocio", "screen", "powerful"),
                        table = wish_of("a.ocio", "projector", "tabled");
    zt_color *color = opened(power), *tables = opened(table);
    assert_manner(power, color->manner, true);
    assert_manner(wish_of("a.ocio", NULL, "powerful"), color->manner, true);
    assert_manner(wish_of("a.ocio", "screen", "plain"), color->manner, false);
    assert_int_equal(mkdir("d", 0777), 0);
    assert_int_equal(chdir("d"), 0);
    write_config("other.ocio", "lin_rec709", "2.001");
    assert_manner(wish_of("other.ocio", "screen", "powerful"), color->manner, false);
    write_config("a.ocio", "lin_rec709", "2");
    write_table(0.31);
    assert_manner(power, color->manner, true);
    assert_manner(table, tables->manner, false);
    assert_int_equal(chdir(".."), 0);
    zt_color_close(&color);
    zt_color_close(&tables);
}

static void write_by(const char *target, zt_view view, zt_color_wish wish,
                     const zt_output_option *options) {
    heard h;
    zt_output *output;
    const zt_output_format format = {
        .width = 96, .height = 54, .rate = {24, 1}, .view = view, .color = wish};
    if (zt_output_open(&output, target, &format, options, listener_of(&h)) != ZT_OK)
        fail_msg("%s", h.text);
    for (int f = 0; f < 3; f++) {
        zt_image *image = picture(96, 54, f);
        for (int i = 0; i < 4 * 96 * 54;
             i++) /* a 64th of white, which powers of 2 keep exact */
            if (i % 4 < 3) image->pixels[i] = roundf(image->pixels[i] * 64) / 64;
        assert_int_equal(zt_output_write(output, image, f), ZT_OK);
        zt_image_free(&image);
    }
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* A view that leaves light as it is makes the files that `raw` makes, whatever the zt_view; one
 * that does not makes others. EXR stays linear. */
static void outputs_are_by_the_view(void **state) {
    (void)state;
    write_config("c.ocio", "other", "2");
    const zt_color_wish plain = wish_of("c.ocio", "screen", "plain"),
                        power = wish_of("c.ocio", "screen", "powerful"), none = {0};
    const zt_output_option lossless[] = {{"codec", "ffv1"}, {NULL, NULL}};
    static const char *const kinds[][4] = {{"p.#.png", "p.1.png", "r.#.png", "r.1.png"},
                                           {"p.#.tif", "p.1.tif", "r.#.tif", "r.1.tif"},
                                           {"p.mp4", "p.mp4", "r.mp4", "r.mp4"},
                                           {"p.mkv", "p.mkv", "r.mkv", "r.mkv"},
                                           {"p.#.exr", "p.1.exr", "r.#.exr", "r.1.exr"}};
    for (int k = 0; k < 5; k++) {
        const zt_output_option *options = k == 3 ? lossless : NULL;
        write_by(kinds[k][2], ZT_VIEW_RAW, none, options);
        write_by(kinds[k][0], ZT_VIEW_RAW, plain, options);
        if (k != 2 && k != 3) /* where movies say which view it was */
            assert_true(same_files(kinds[k][1], kinds[k][3]));
        write_by(kinds[k][0], ZT_VIEW_RAW, power, options);
        assert_int_equal(same_files(kinds[k][1], kinds[k][3]), k == 4);
    }
}

/* What cannot be opened is told when the output is, and nothing is left. */
static void outputs_refuse(void **state) {
    (void)state;
    write_config("a.ocio", "lin_rec709", "2");
    static const char *const targets[] = {"no.#.png", "no.mp4", "no.gif"};
    for (int t = 0; t < 3; t++) {
        heard h;
        zt_output *output;
        const zt_output_format format = {.width = 96,
                                         .height = 54,
                                         .rate = {24, 1},
                                         .color = wish_of("a.ocio", "screen", "glowing")};
        assert_int_not_equal(
            zt_output_open(&output, targets[t], &format, NULL, listener_of(&h)), ZT_OK);
        assert_null(output);
        assert_told(&h, "no view \"glowing\"");
        assert_false(exists(targets[t]));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_are_the_configurations),
        cmocka_unit_test(light_is_scene_linear_elsewhere),
        cmocka_unit_test(refusals),
        cmocka_unit_test(manners_tell_apart),
        cmocka_unit_test(outputs_are_by_the_view),
        cmocka_unit_test(outputs_refuse),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
