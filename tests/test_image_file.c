/* Image files: what is written can be read again with the numbers promised, and nothing that a
 * file or a disk does ends the process or goes unsaid. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <time.h>

#include <cmocka.h>

#include "files.h"
#include "image/develop.h"
#include "image/file.h"
#include <zoetrope/zoetrope.h>

static zt_image *read_back(const char *path) {
    heard h;
    zt_image *image;
    if (zt_image_file_read(&image, path, listener_of(&h)) != ZT_OK) fail_msg("%s", h.text);
    return image;
}

static void write_wished(const zt_image *image, zt_view view, const char *path,
                         const zt_wish *options) {
    heard h;
    zt_image_wishes wishes;
    if (zt_image_wish(&wishes, path, options, listener_of(&h)) != ZT_OK ||
        zt_image_file_write(image, view, &wishes, path, listener_of(&h)) != ZT_OK)
        fail_msg("%s", h.text);
}

static void write_picture(const zt_image *image, zt_view view, const char *path) {
    write_wished(image, view, path, NULL);
}

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

/* What a format does not have is told with what there is instead. */
static void wishes_refused(void **state) {
    static const struct {
        const char *path, *name, *value, *told;
    } wishes[] = {
        {"x.png", "bits", "32", "bits=32 makes no sense for a png file; there is: 8, 16"},
        {"x.png", "compression", "dwaa", "there is: rle, zip:0-9"},
        {"x.png", "compression", "zip:10", "there is: rle, zip:0-9"},
        {"x.exr", "compression", "dwaa:0", "dwaa:1-100000"},
        {"x.exr", "compression", "piz:3", "piz, pxr24"},
        {"x.exr", "compression", "", "none, rle"},
        {"x.exr", "bits", "8", "float, half"},
        {"x.exr", "tile", "17", "multiple of 16"},
        {"x.jpg", "tile", "16", "there is: none"},
        {"x.jpg", "compression", "jpeg:101", "jpeg:1-100"},
        {"x.hdr", "compression", "zip", "there is: none"},
        {"x.gift", "bits", "8", "ending of x.gift"},
        {"x.png", "parts", "layers",
         "parts=layers makes no sense for a png file; there is: one"},
        {"x.exr", "parts", "each", "there is: one, layers"},
        {"x.png", "depth", "8",
         "format-option depth=8: must be bits, compression, tile or parts"},
    };
    (void)state;
    for (size_t i = 0; i < sizeof wishes / sizeof *wishes; i++) {
        heard h;
        zt_image_wishes got;
        char text[64];
        snprintf(text, sizeof text, "%s=%s", wishes[i].name, wishes[i].value);
        const zt_wish options[] = {{"format-option", text}, {NULL, NULL}};
        assert_int_not_equal(zt_image_wish(&got, wishes[i].path, options, listener_of(&h)),
                             ZT_OK);
        assert_told(&h, wishes[i].told);
    }
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

/* A full disk is an error in every format, told with its reason; the process goes on. */
static void full_disk(void **state) {
    (void)state;
    zt_image *image = picture(256, 256, 0);
    for (const char *const *ending = zt_image_file_endings; *ending; ending++) {
        heard h;
        char path[32];
        snprintf(path, sizeof path, "full%s", *ending);
        zt_image_wishes wishes;
        assert_int_equal(zt_image_wish(&wishes, path, NULL, listener_of(&h)), ZT_OK);
        disk_has(100);
        zt_status status =
            zt_image_file_write(image, ZT_VIEW_RAW, &wishes, path, listener_of(&h));
        disk_has(0);
        assert_int_equal(status, ZT_EFILE);
        assert_told(&h, "File too large");
        write_picture(image, ZT_VIEW_RAW, path);
    }
    zt_image_free(&image);
}

static void assert_unreadable(const char *path) {
    heard h;
    zt_image *image = (zt_image *)&h;
    if (zt_image_file_read(&image, path, listener_of(&h)) == ZT_OK)
        fail_msg("%s was read", path);
    assert_null(image);
    assert_told(&h, path);
}

static void write_bytes(const char *path, const char *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* What is no picture is refused: nothing there, a directory, emptiness, noise, a picture cut in
 * its middle. */
static void unreadable_files(void **state) {
    (void)state;
    zt_image *image = picture(64, 64, 0);
    write_picture(image, ZT_VIEW_SRGB, "whole.exr");
    zt_image_free(&image);
    size_t size;
    char *bytes = file_bytes("whole.exr", &size);
    write_bytes("cut.exr", bytes, size / 2);
    write_bytes("empty.png", bytes, 0);
    memset(bytes, 0x5a, size);
    write_bytes("noise.png", bytes, size);
    write_bytes("noise.exr", bytes, size);
    free(bytes);
    assert_int_equal(mkdir("directory.png", 0777), 0);
    const char *const paths[] = {"missing.png", "directory.png", "empty.png",
                                 "noise.png",   "noise.exr",     "cut.exr"};
    for (int i = 0; i < 6; i++) assert_unreadable(paths[i]);
}

/* A few bytes that claim to be 2^15 pixels wide and high, with the right checksum. */
static void huge_claims(void **state) {
    (void)state;
    zt_image *image = picture(64, 64, 0);
    write_picture(image, ZT_VIEW_SRGB, "whole.png");
    zt_image_free(&image);
    size_t size;
    char *bytes = file_bytes("whole.png", &size);
    memcpy(bytes + 16, "\0\0\x80\0\0\0\x80\0\x08\x02\0\0\0\x4b\x1e\x34\x28", 17);
    write_bytes("huge.png", bytes, size);
    free(bytes);
    assert_unreadable("huge.png");
}

/* A picture that is covered by 1/4 to the left, not at all in one pixel, wholly elsewhere; its
 * colours are multiplied by that. */
static zt_image *covered_picture(void) {
    zt_image *image = picture(8, 4, 0);
    for (int i = 0; i < 8 * 4; i++) {
        float alpha = i == 9 ? 0 : i % 8 < 4 ? 0.25f : 1;
        for (int c = 0; c < 4; c++) image->pixels[4 * i + c] *= alpha;
    }
    return image;
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

/* An attribute of an OpenEXR file by the format's own layout: name, 0, type, 0, size, value. */
static const char *exr_attribute(const char *bytes, size_t size, const char *name,
                                 const char *type, int32_t *length) {
    char head[128];
    size_t used = strlen(name) + 1 + strlen(type) + 1;
    memcpy(head, name, strlen(name) + 1);
    memcpy(head + strlen(name) + 1, type, strlen(type) + 1);
    const char *found = memmem(bytes, size, head, used);
    if (!found) return NULL;
    memcpy(length, found + used, 4);
    return found + used + 4;
}

static void assert_exr_text(const char *bytes, size_t size, const char *name,
                            const char *expected) {
    int32_t length;
    const char *text = exr_attribute(bytes, size, name, "string", &length);
    if (!text || (size_t)length != strlen(expected) ||
        memcmp(text, expected, strlen(expected)) != 0)
        fail_msg("%s is %.*s", name, text ? length : 4, text ? text : "none");
}

/* The values of a channel that is stored without compression, a line a block, with its type;
 * 1 is half, 2 is float. Channels come in the order of their names. */
static const char *exr_line(const char *bytes, size_t size, const char *name, int width, int y,
                            int height, int *type) {
    int32_t length, kind;
    const char *list = exr_attribute(bytes, size, "channels", "chlist", &length);
    assert_non_null(list);
    size_t before = 0, found = SIZE_MAX, line = 0;
    for (; *list; list += strlen(list) + 1 + 16) {
        memcpy(&kind, list + strlen(list) + 1, 4);
        size_t channel = (size_t)width * (kind == 1 ? 2 : 4);
        if (strcmp(list, name) == 0) {
            found = before;
            *type = kind;
        }
        before += channel;
        line = before;
    }
    if (found == SIZE_MAX) return NULL;
    return bytes + size - (line + 8) * (size_t)(height - y) + 8 + found;
}

static const zt_wish uncompressed[] = {
    {"format-option", "compression=none"}, {"format-option", "bits=half"}, {NULL, NULL}};

/* An OpenEXR file has the image's further channels, as floats by their names; others have not.
 */
static void exr_has_all_channels(void **state) {
    static const char *const names[] = {"Z", "P.X", "id.object", "samples", "error"};
    (void)state;
    for (int alpha = 0; alpha < 2; alpha++) {
        zt_image *image = alpha ? covered_picture() : picture(8, 4, 0);
        write_picture(image, ZT_VIEW_SRGB, "plain.png");
        for (int c = 0; c < 5; c++) {
            assert_int_equal(zt_image_add_channel(image, names[c]), ZT_OK);
            for (int i = 0; i < 8 * 4; i++)
                image->channels[c].values[i] = 100000.25f * (float)(c + 1) + (float)i;
        }
        write_picture(image, ZT_VIEW_SRGB, "layers.png");
        assert_true(same_files("plain.png", "layers.png"));
        write_wished(image, ZT_VIEW_SRGB, "layers.exr", uncompressed);
        size_t size;
        char *bytes = file_bytes("layers.exr", &size);
        for (int y = 0; y < 4; y++) {
            int type = 0;
            for (int c = 0; c < 5; c++) {
                const char *line = exr_line(bytes, size, names[c], 8, y, 4, &type);
                assert_non_null(line);
                assert_int_equal(type, 2);
                assert_memory_equal(line, image->channels[c].values + 8 * y, 8 * sizeof(float));
            }
            assert_non_null(exr_line(bytes, size, "R", 8, y, 4, &type));
            assert_int_equal(type, 1);
            assert_non_null(exr_line(bytes, size, "A", 8, y, 4, &type)); /* always */
        }
        free(bytes);
        zt_image *back = read_back("layers.exr"); /* colours first, and no Z taken for A */
        for (int i = 0; i < 4 * 8 * 4; i++)
            assert_true(fabs((double)(back->pixels[i] - image->pixels[i])) <= 0x1p-12);
        zt_image_free(&back);
        zt_image_free(&image);
    }
}

static void assert_same_channels(const zt_image *back, const zt_image *image) {
    size_t size = (size_t)image->width * (size_t)image->height * sizeof(float);
    assert_memory_equal(back->pixels, image->pixels, 4 * size);
    assert_int_equal(back->channel_count, image->channel_count);
    for (int c = 0; c < image->channel_count; c++) {
        const float *values = zt_image_channel(back, image->channels[c].name);
        assert_non_null(values);
        assert_memory_equal(values, image->channels[c].values, size);
    }
}

/* Whether layers share a part or have one each, and whether the file is on the disk or in
 * memory: what is read is what was written, each number of each channel. */
static void channels_are_read(void **state) {
    static const char *const names[] = {"Z",   "N.X",       "N.Y",         "N.Z",
                                        "P.X", "id.object", "id.material", "error"};
    static const zt_wish wishes[][3] = {
        {{"format-option", "parts=one"}},
        {{"format-option", "parts=layers"}},
        {{"format-option", "parts=layers"}, {"format-option", "tile=16"}}};
    (void)state;
    zt_image *image = covered_picture();
    for (int c = 0; c < 8; c++) {
        assert_int_equal(zt_image_add_channel(image, names[c]), ZT_OK);
        for (int i = 0; i < image->width * image->height; i++)
            image->channels[c].values[i] = 100000.25f * (float)(c + 1) + (float)i;
    }
    image->channels[0].values[3] = INFINITY; /* nothing is met */
    for (int w = 0; w < 3; w++) {
        write_wished(image, ZT_VIEW_SRGB, "parts.exr", wishes[w]);
        zt_image *back = read_back("parts.exr");
        assert_same_channels(back, image);
        zt_image_free(&back);
        heard h;
        zt_bytes bytes;
        bytes.data = (unsigned char *)file_bytes("parts.exr", &bytes.size);
        assert_int_equal(zt_image_file_decode(&back, &bytes, "of.exr", listener_of(&h)), ZT_OK);
        assert_same_channels(back, image);
        zt_image_free(&back);
        bytes.size /= 2;
        assert_int_equal(zt_image_file_decode(&back, &bytes, "half.exr", listener_of(&h)),
                         ZT_EFILE);
        assert_told(&h, "half.exr");
        assert_null(back);
        free(bytes.data);
    }
    zt_image_free(&image);
}

static void know(zt_image *image) {
    image->info = (zt_image_info){.known = true,
                                  .frame = -5000000000,
                                  .rate = {30000, 1001},
                                  .key = {0x0123456789abcdef, 0xfedcba9876543210},
                                  .render_s = 2.5,
                                  .seed = UINT64_MAX,
                                  .title = "Näher",
                                  .description = "film.yaml",
                                  .view = "filmic",
                                  .settings = "{\"samples\": 4}"};
    for (int i = 0; i < 16; i++) image->info.world_to_camera[i] = i + 0.5;
}

/* What an image is of goes along, by the names that the format has for it. */
static void files_tell_what_they_are_of(void **state) {
    (void)state;
    zt_image *image = picture(8, 4, 0);
    size_t size;
    write_picture(image, ZT_VIEW_SRGB, "unknown.exr");
    char *bytes = file_bytes("unknown.exr", &size);
    assert_null(memmem(bytes, size, "zoetrope", 8));
    assert_null(memmem(bytes, size, "oftware", 7));
    free(bytes);
    know(image);
    write_picture(image, ZT_VIEW_SRGB, "known.exr");
    bytes = file_bytes("known.exr", &size);
    assert_exr_text(bytes, size, "Software", "Zoetrope " ZT_VERSION);
    assert_exr_text(bytes, size, "zoetrope:frame", "-5000000000");
    assert_exr_text(bytes, size, "zoetrope:rate", "30000/1001");
    assert_exr_text(bytes, size, "zoetrope:key", "0123456789abcdeffedcba9876543210");
    assert_exr_text(bytes, size, "zoetrope:seed", "18446744073709551615");
    assert_exr_text(bytes, size, "zoetrope:description", "film.yaml");
    assert_exr_text(bytes, size, "zoetrope:settings", "{\"samples\": 4}");
    int32_t length, rate[2];
    float number, matrix[16];
    const char *value = exr_attribute(bytes, size, "framesPerSecond", "rational", &length);
    assert_true(value && length == 8);
    memcpy(rate, value, 8);
    assert_true(rate[0] == 30000 && rate[1] == 1001);
    value = exr_attribute(bytes, size, "renderTime", "float", &length);
    assert_non_null(value);
    memcpy(&number, value, 4);
    assert_true(number == 2.5f);
    value = exr_attribute(bytes, size, "pixelAspectRatio", "float", &length);
    assert_non_null(value);
    memcpy(&number, value, 4);
    assert_true(number == 1);
    value = exr_attribute(bytes, size, "worldToCamera", "m44f", &length);
    assert_true(value && length == 64);
    memcpy(matrix, value, 64);
    for (int i = 0; i < 16; i++) assert_true(matrix[i] == (float)i + 0.5f);
    assert_null(exr_attribute(bytes, size, "worldToNDC", "m44f", &length)); /* all zeros */
    free(bytes);
    image->info.world_to_ndc[3] = 2;
    write_picture(image, ZT_VIEW_SRGB, "ndc.exr");
    bytes = file_bytes("ndc.exr", &size);
    value = exr_attribute(bytes, size, "worldToNDC", "m44f", &length);
    assert_non_null(value);
    memcpy(matrix, value, 64);
    assert_true(matrix[3] == 2 && matrix[12] == 0);
    free(bytes);

    write_picture(image, ZT_VIEW_SRGB, "known.png");
    bytes = file_bytes("known.png", &size);
    static const char *const texts[] = {"Software\0Zoetrope " ZT_VERSION,
                                        "zoetrope:key\0000123456789abcdeffedcba9876543210",
                                        "zoetrope:settings\0{\"samples\": 4}"};
    static const size_t sizes[] = {23, 45, 32};
    for (int i = 0; i < 3; i++)
        if (!memmem(bytes, size, texts[i], sizes[i])) fail_msg("no %s", texts[i]);
    free(bytes);
    write_picture(image, ZT_VIEW_SRGB, "known.tif");
    bytes = file_bytes("known.tif", &size);
    assert_non_null(
        memmem(bytes, size, "Zoetrope " ZT_VERSION, strlen("Zoetrope " ZT_VERSION)));
    static const char description[] = "zoetrope:frame: -5000000000\n"
                                      "zoetrope:rate: 30000/1001\n"
                                      "zoetrope:key: 0123456789abcdeffedcba9876543210\n"
                                      "zoetrope:seed: 18446744073709551615\n"
                                      "zoetrope:title: Näher\n"
                                      "zoetrope:description: film.yaml\n"
                                      "zoetrope:view: filmic\n"
                                      "zoetrope:settings: {\"samples\": 4}\n";
    assert_non_null(memmem(bytes, size, description, sizeof description));
    free(bytes);
    static const char *const others[] = {"o.jpg", "o.webp", "o.hdr"};
    for (int f = 0; f < 3; f++) { /* which stay as they are */
        write_picture(image, ZT_VIEW_SRGB, others[f]);
        assert_int_equal(rename(others[f], "known"), 0);
        image->info.known = false;
        write_picture(image, ZT_VIEW_SRGB, others[f]);
        image->info.known = true;
        assert_true(same_files(others[f], "known"));
    }
    zt_image_free(&image);
}

static void assert_text(const char *text, const char *expected) {
    if (expected)
        assert_string_equal(text, expected);
    else
        assert_null(text);
}

/* What a file says that it is of is read again, texts of many lines and of all letters, and
 * those that look like another one's, included. */
static void what_files_tell_is_read(void **state) {
    (void)state;
    static const char *const paths[] = {"back.exr", "back.png", "back.tif"};
    static const char *const settings[] = {
        NULL, "samples: 4\n size:\n\n  - 3\n",
        "\n\n\"a\"\nzoetrope:frame: 7\n zoetrope:title: \\n\xc3\xa4"};
    zt_image *image = picture(8, 4, 0);
    for (int f = 0; f < 3; f++)
        for (int s = 0; s < 3; s++) {
            know(image);
            image->info.settings = settings[s];
            if (s == 1) image->info.title = image->info.description = NULL;
            write_picture(image, ZT_VIEW_SRGB, paths[f]);
            zt_image *back = read_back(paths[f]);
            const zt_image_info *b = &back->info, *i = &image->info;
            assert_true(b->known && b->frame == i->frame && b->seed == i->seed);
            assert_true(b->rate.num == 30000 && b->rate.den == 1001);
            assert_true(zt_hash_equal(b->key, i->key));
            assert_text(b->title, i->title);
            assert_text(b->description, i->description);
            assert_text(b->view, i->view);
            assert_text(b->settings, i->settings);
            assert_int_equal(back->linear, f == 0);
            zt_image_free(&back);
        }
    image->info.known = false;
    for (int f = 0; f < 3; f++) {
        write_picture(image, ZT_VIEW_SRGB, paths[f]);
        zt_image *back = read_back(paths[f]);
        assert_true(!back->info.known);
        zt_image_free(&back);
    }
    zt_image_free(&image);
}

/* Returns how many there were. `to` is as long. */
static int replace_all(char *bytes, size_t size, const char *from, const char *to) {
    int count = 0;
    size_t length = strlen(from);
    for (char *at = bytes; (at = memmem(at, size - (size_t)(at - bytes), from, length));
         count++)
        memcpy(at, to, length);
    return count;
}

/* A file that says nonsense is a picture of something unknown. */
static void nonsense_is_not_known(void **state) {
    static const struct {
        const char *from, *to;
    } changes[] = {{"-5000000000", "-500000000x"},   {"-5000000000", "+5000000000"},
                   {"30000/1001", "30000/0000"},     {"30000/1001", "30000:1001"},
                   {"0123456789ab", "0123456789aB"}, {"cdeffedcba", "cdef edcba"},
                   {"18446744073", "98446744073"},   {"zoetrope:seed", "zoetrope_seed"},
                   {"-5000000000", "-0000000000"},   {"30000/1001", "30000/ 101"}};
    (void)state;
    zt_image *image = picture(8, 4, 0);
    know(image);
    write_picture(image, ZT_VIEW_SRGB, "sense.tif");
    size_t size;
    char *bytes = file_bytes("sense.tif", &size);
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        assert_true(replace_all(bytes, size, changes[i].from, changes[i].to) > 0);
        write_bytes("nonsense.tif", bytes, size);
        replace_all(bytes, size, changes[i].to, changes[i].from);
        zt_image *back = read_back("nonsense.tif");
        if (back->info.known) fail_msg("%s is known", changes[i].to);
        zt_image_free(&back);
    }
    write_bytes("nonsense.tif", bytes, size);
    zt_image *back = read_back("nonsense.tif");
    assert_true(back->info.known);
    zt_image_free(&back);
    free(bytes);
    zt_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formats_hold_the_picture),
        cmocka_unit_test(wishes_come_true),
        cmocka_unit_test(wishes_refused),
        cmocka_unit_test(exr_has_no_infinities),
        cmocka_unit_test(name_and_path),
        cmocka_unit_test(no_file_has_a_date),
        cmocka_unit_test(full_disk),
        cmocka_unit_test(unreadable_files),
        cmocka_unit_test(huge_claims),
        cmocka_unit_test(alpha_where_it_says_something),
        cmocka_unit_test(exr_has_all_channels),
        cmocka_unit_test(channels_are_read),
        cmocka_unit_test(files_tell_what_they_are_of),
        cmocka_unit_test(what_files_tell_is_read),
        cmocka_unit_test(nonsense_is_not_known),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
