/* Image files: what is written can be read again with the numbers promised, as precisely as the
 * format and the wishes say, and the same picture is the same file. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <time.h>

#include <cmocka.h>

#include "image/develop.h"
#include "image_files.h"

/* The largest difference of any number from what `expect` makes of the picture's. */
static double largest_difference(const zt_image *image, const char *path,
                                 double (*expect)(double)) {
    zt_image *back = read_back(path);
    assert_int_equal(back->width, image->width);
    assert_int_equal(back->height, image->height);
    double largest = 0;
    for (int i = 0; i < 4 * image->width * image->height; i++) {
        double expected = i % 4 == 3 ? 1 : expect((double)image->pixels[i]);
        largest = fmax(largest, fabs((double)back->pixels[i] - expected));
    }
    zt_image_free(&back);
    return largest;
}

/* 8 bits are dithered, and so one of the two codes beside this. */
static const double code = 1.0001 / 255;
static double srgb8(double linear) { return zt_develop_value(linear, ZT_VIEW_SRGB); }
static double srgb16(double linear) {
    return floor(65535 * zt_develop_value(linear, ZT_VIEW_SRGB) + 0.5) / 65535;
}
static double raw8(double linear) { return zt_develop_value(linear, ZT_VIEW_RAW); }
static double as_it_is(double linear) { return linear; }

/* Each format holds the picture as precisely as it can: PNG and TIFF to their last bit, EXR
 * exactly, JPEG to what the eye sees. Odd sizes, so that row lengths show. */
static void formats_hold_the_picture(void **state) {
    (void)state;
    zt_image *image = picture(61, 43, 0);
    write_picture(image, ZT_VIEW_SRGB, "a.png");
    assert_true(largest_difference(image, "a.png", srgb8) < code);
    write_picture(image, ZT_VIEW_RAW, "raw.PNG");
    assert_true(largest_difference(image, "raw.PNG", raw8) < code);
    write_picture(image, ZT_VIEW_SRGB, "a.tif");
    assert_true(largest_difference(image, "a.tif", srgb16) < 1e-7);
    write_picture(image, ZT_VIEW_SRGB, "a.exr");
    assert_true(largest_difference(image, "a.exr", as_it_is) == 0);
    zt_image_free(&image);

    image =
        picture(64, 64, 0); /* JPEG spreads sharp edges: without the third channel's stripes */
    for (int i = 0; i < 64 * 64; i++) image->pixels[4 * i + 2] = 0.5f;
    write_picture(image, ZT_VIEW_SRGB, "a.jpg");
    assert_true(largest_difference(image, "a.jpg", srgb8) < 8.0 / 255);
    write_picture(image, ZT_VIEW_SRGB, "b.jpeg");
    assert_true(same_files("a.jpg", "b.jpeg"));
    write_picture(image, ZT_VIEW_SRGB, "a.webp");
    assert_true(largest_difference(image, "a.webp", srgb8) < 24.0 / 255);
    zt_image_free(&image);
}

static double dpx10(double linear) {
    return floor(1023 * zt_develop_value(linear, ZT_VIEW_SRGB) + 0.5) / 1023;
}

/* What can be wished for of each format is what is in the file: as many digits as were asked
 * for, whatever the compression, if it is one that loses nothing. */
static void wishes_come_true(void **state) {
    static const struct {
        const char *path, *bits, *compression, *tile;
        double (*expect)(double);
        double within;
    } files[] = {
        {"w.png", "16", "zip:9", NULL, srgb16, 1e-7},
        {"w8.png", "8", "zip:1", NULL, srgb8, 1.0001 / 255},
        {"w.exr", "float", "piz", NULL, as_it_is, 0},
        {"z.exr", "float", "zip:9", "32", as_it_is, 0},
        {"n.exr", "half", "none", "16", as_it_is, 0x1p-12},
        {"r.exr", "float", "rle", NULL, as_it_is, 0},
        {"s.exr", "float", "zips", NULL, as_it_is, 0},
        {"p.exr", "float", "pxr24", NULL, as_it_is, 0x1p-15},
        {"b.exr", "half", "b44", NULL, as_it_is, 0.2},
        {"d.exr", "half", "dwaa:10", NULL, as_it_is, 0.2},
        {"e.exr", "half", "dwab", NULL, as_it_is, 0.2},
        {"w.tif", "float", "zip", NULL, as_it_is, 0},
        {"l.tif", "16", "lzw", NULL, srgb16, 1e-7},
        {"t.tiff", "8", "none", "16", srgb8, 1.0001 / 255},
        {"w.dpx", "16", NULL, NULL, srgb16, 1e-7},
        {"t.dpx", "10", NULL, NULL, dpx10, 0x1p-10} /* its reader fills up with zeros */,
        {"w.hdr", NULL, NULL, NULL, as_it_is, 0x1p-8},
    };
    (void)state;
    zt_image *image = picture(61, 43, 0);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char texts[3][64];
        zt_wish options[4] = {{NULL, NULL}};
        const char *const wished[3] = {files[i].bits, files[i].compression, files[i].tile};
        static const char *const keys[3] = {"bits", "compression", "tile"};
        for (int k = 0, count = 0; k < 3; k++) {
            if (!wished[k]) continue;
            snprintf(texts[k], sizeof texts[k], "%s=%s", keys[k], wished[k]);
            options[count++] = (zt_wish){"format-option", texts[k]};
        }
        write_wished(image, ZT_VIEW_SRGB, files[i].path, options);
        double off = largest_difference(image, files[i].path, files[i].expect);
        if (!(off <= files[i].within)) fail_msg("%s is off by %g", files[i].path, off);
    }
    zt_image_free(&image);
}

/* Half floats end at 65504: brighter light stays the brightest there is, and never an infinity,
 * which would spread over the whole picture in the first blur. */
static void exr_has_no_infinities(void **state) {
    (void)state;
    zt_image *image = picture(4, 1, 0);
    const float values[] = {1e30f, -1e30f, INFINITY, 65504, -0.25f, 3.5f, 0, 1000};
    for (int i = 0; i < 8; i++) image->pixels[i / 3 * 4 + i % 3] = values[i];
    static const zt_wish half[] = {{"format-option", "bits=half"}, {NULL, NULL}};
    write_wished(image, ZT_VIEW_RAW, "bright.exr", half);
    zt_image *back = read_back("bright.exr");
    const float expected[] = {65504, -65504, 65504, 65504, -0.25f, 3.5f, 0, 1000};
    for (int i = 0; i < 8; i++) assert_true(back->pixels[i / 3 * 4 + i % 3] == expected[i]);
    zt_image_free(&back);
    zt_image_free(&image);
}

/* The name decides the format, the path only where it goes; names are any UTF-8. The same
 * picture is the same file. */
static void name_and_path(void **state) {
    (void)state;
    heard h;
    zt_image *image = picture(16, 8, 0);
    zt_image_wishes png, other;
    assert_int_equal(zt_image_wish(&png, "x.png", NULL, listener_of(&h)), ZT_OK);
    assert_int_equal(
        zt_image_file_write(image, ZT_VIEW_SRGB, &png, "näher – 日本.part", listener_of(&h)),
        ZT_OK);
    write_picture(image, ZT_VIEW_SRGB, "plain.png");
    assert_true(same_files("näher – 日本.part", "plain.png"));
    size_t size;
    char *bytes = file_bytes("plain.png", &size);
    assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
    assert_non_null(
        memmem(bytes, size, "sRGB", 4)); /* tagged for the display it is meant for */
    free(bytes);

    assert_int_equal(zt_image_wish(&other, "x.webm", NULL, listener_of(&h)), ZT_EUNSUPPORTED);
    assert_told(&h, "ending");
    assert_int_equal(
        zt_image_file_write(image, ZT_VIEW_SRGB, &png, "none/x.png", listener_of(&h)),
        ZT_EFILE);
    assert_told(&h, "none/x.png: No such file or directory");
    zt_image_free(&image);
}

/* No file knows the hour: the same picture is the same file tomorrow. */
static void no_file_has_a_date(void **state) {
    (void)state;
    time_t now = time(NULL);
    char years[2][5]; /* today's and, around midnight of a year, yesterday's */
    strftime(years[0], 5, "%Y", localtime(&now));
    now -= 86400;
    strftime(years[1], 5, "%Y", localtime(&now));
    zt_image *image = picture(4, 4, 0);
    for (const char *const *ending = zt_image_file_endings; *ending; ending++) {
        char path[32];
        snprintf(path, sizeof path, "date%s", *ending);
        write_picture(image, ZT_VIEW_SRGB, path);
        size_t size;
        char *bytes = file_bytes(path, &size);
        assert_null(memmem(bytes, size, years[0], 4));
        assert_null(memmem(bytes, size, years[1], 4));
        free(bytes);
    }
    zt_image_free(&image);
}

/* Where something shows through, files have A; integers hold colours that are not multiplied by
 * it, but in DPX, and floats those that are. */
static void alpha_where_it_says_something(void **state) {
    static const struct {
        const char *path, *bits;
        double (*expect)(double);
        bool divided;
        double within;
    } files[] = {
        {"alpha.png", "bits=8", srgb8, true, 1.0001 / 255},
        {"alpha16.png", "bits=16", srgb16, true, 1e-6},
        {"alpha.tif", "bits=16", srgb16, true, 1e-6},
        {"alphaf.tif", "bits=float", as_it_is, false, 0},
        {"alpha.exr", "bits=half", as_it_is, false, 0x1p-12},
        {"alpha.dpx", "bits=16", srgb16, false, 1e-6},
    };
    (void)state;
    zt_image *image = covered_picture();
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        const zt_wish options[] = {{"format-option", files[f].bits}, {NULL, NULL}};
        write_wished(image, ZT_VIEW_SRGB, files[f].path, options);
        zt_image *back = read_back(files[f].path);
        double steps = strstr(files[f].bits, "=8") ? 255 : 65535;
        bool integers = files[f].expect != as_it_is;
        for (int i = 0; i < 4 * 8 * 4; i++) {
            double value = (double)image->pixels[i], alpha = (double)image->pixels[i | 3];
            if (i % 4 == 3)
                value = integers ? floor(steps * alpha + 0.5) / steps : alpha;
            else
                value = files[f].expect(files[f].divided && alpha > 0 ? value / alpha : value);
            double off = fabs((double)back->pixels[i] - value);
            if (!(off <= files[f].within))
                fail_msg("%s is off by %g at %d", files[f].path, off, i);
        }
        zt_image_free(&back);
    }
    write_picture(image, ZT_VIEW_SRGB, "alpha.webp");
    zt_image *back = read_back("alpha.webp"); /* of which A is kept as it is */
    for (int i = 3; i < 4 * 8 * 4; i += 4)
        assert_true(fabs((double)(back->pixels[i] - image->pixels[i])) <= 0.5001 / 255);
    zt_image_free(&back);

    write_picture(image, ZT_VIEW_SRGB, "over.jpg"); /* no place for A: over black */
    for (int i = 3; i < 4 * 8 * 4; i += 4) image->pixels[i] = 1;
    write_picture(image, ZT_VIEW_SRGB, "opaque.jpg");
    assert_true(same_files("over.jpg", "opaque.jpg"));
    write_picture(image, ZT_VIEW_SRGB, "opaque.png");
    size_t size;
    char *bytes = file_bytes("opaque.png", &size);
    assert_int_equal(bytes[25], 2); /* IHDR: R G B */
    free(bytes);
    bytes = file_bytes("alpha.png", &size);
    assert_int_equal(bytes[25], 6); /* R G B A */
    free(bytes);
    zt_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formats_hold_the_picture),
        cmocka_unit_test(wishes_come_true),
        cmocka_unit_test(exr_has_no_infinities),
        cmocka_unit_test(name_and_path),
        cmocka_unit_test(no_file_has_a_date),
        cmocka_unit_test(alpha_where_it_says_something),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
