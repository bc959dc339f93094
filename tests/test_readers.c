/* Programs of others read image files: ffmpeg and ffprobe, oiiotool, exrheader. Each test is
 * skipped where its program is not installed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <math.h>

#include "files.h"
#include "image/develop.h"
#include "image/file.h"

enum { WIDTH = 64, HEIGHT = 32, PATCH = 16, SAID_MAX = 1 << 16 };

/* The colours of 4 x 2 patches, linear. */
static const float card[8][3] = {{0, 0, 0},           {1, 1, 1},        {0.18f, 0.18f, 0.18f},
                                 {0.9f, 0.02f, 0},    {0.02f, 0.6f, 0}, {0, 0.03f, 0.9f},
                                 {0.5f, 0.4f, 0.02f}, {0.3f, 0, 0.3f}};

static bool is_there(const char *program) {
    char command[64];
    snprintf(command, sizeof command, "command -v %s >/dev/null 2>&1", program);
    return system(command) == 0;
}

/* What a program says, which must succeed. Valid until the next call. */
static const char *said(size_t *size, const char *format, ...) {
    static char text[SAID_MAX];
    char command[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    *size = fread(text, 1, sizeof text - 1, pipe);
    text[*size] = '\0';
    if (pclose(pipe) != 0) fail_msg("%s: %s", command, text);
    return text;
}

static void assert_says(const char *text, const char *words) {
    assert_non_null(text);
    if (!strstr(text, words)) fail_msg("no \"%s\" in:\n%s", words, text);
}

static zt_image *test_card(void) {
    zt_image *image;
    assert_int_equal(zt_image_create(&image, WIDTH, HEIGHT), ZT_OK);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            memcpy(image->pixels + 4 * (y * WIDTH + x), card[y / PATCH * 4 + x / PATCH],
                   3 * sizeof(float));
    image->info = (zt_image_info){.known = true,
                                  .frame = 42,
                                  .rate = {24, 1},
                                  .key = {0x0123456789abcdef, 0xfedcba9876543210},
                                  .render_s = 2.5,
                                  .seed = 7,
                                  .title = "card",
                                  .description = "card.yaml",
                                  .view = "srgb",
                                  .settings = "{\"samples\": 4}"};
    for (int i = 0; i < 4; i++) image->info.world_to_camera[5 * i] = 1;
    image->info.world_to_camera[14] = -6;
    return image;
}

static void write_card(const zt_image *image, const char *path, const char *option) {
    heard h;
    zt_image_wishes wishes;
    const zt_wish options[] = {{option ? "format-option" : NULL, option}, {NULL, NULL}};
    if (zt_image_wish(&wishes, path, options, listener_of(&h)) != ZT_OK ||
        zt_image_file_write(image, ZT_VIEW_SRGB, &wishes, path, listener_of(&h)) != ZT_OK)
        fail_msg("%s", h.text);
}

static double half_up(double value, double most) { return floor(value * most + 0.5) / most; }

/* FFmpeg, which shares no code with OpenImageIO, sees the size and the kind of numbers, and
 * decodes the card: developed where numbers are integers, as it is where they are floats. */
static void ffmpeg_sees_the_card(void **state) {
    static const struct {
        const char *path, *option, *pixels, *decoded;
        double most, within; /* the largest integer, 0: floats */
    } files[] = {{"a.png", NULL, "rgb24", "rgb24", 255, 1},
                 {"b.png", "bits=16", "rgb48be", "rgb48le", 65535, 0},
                 {"a.tif", NULL, "rgb48le", "rgb48le", 65535, 0},
                 {"b.tif", "bits=8", "rgb24", "rgb24", 255, 1},
                 {"a.jpg", NULL, "yuvj444p", "rgb24", 255, 4},
                 {"a.webp", NULL, "yuv420p", "rgb24", 255, 8},
                 {"a.dpx", NULL, "gbrp10le", "rgb48le", 65535, 65},
                 {"b.dpx", "bits=16", "rgb48le", "rgb48le", 65535, 0},
                 {"a.exr", NULL, "gbrapf32le", "gbrapf32le", 0, 0},
                 {"b.exr", "bits=half", "gbrapf32le", "gbrapf32le", 0, 0x1p-12}};
    (void)state;
    if (!is_there("ffmpeg") || !is_there("ffprobe")) skip();
    zt_image *image = test_card();
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        char line[64];
        size_t size;
        write_card(image, files[f].path, files[f].option);
        snprintf(line, sizeof line, "%d,%d,%s", WIDTH, HEIGHT, files[f].pixels);
        assert_says(said(&size,
                         "ffprobe -v error -show_entries stream=width,height,pix_fmt -of "
                         "csv=p=0 %s",
                         files[f].path),
                    line);
        const char *bytes = said(&size,
                                 "ffmpeg -v error -i %s -f rawvideo -sws_flags "
                                 "accurate_rnd+full_chroma_int -pix_fmt %s -",
                                 files[f].path, files[f].decoded);
        size_t bits = files[f].most == 255 ? 1 : files[f].most > 0 ? 2 : 4;
        assert_int_equal(size, (size_t)WIDTH * HEIGHT * (bits == 4 ? 16 : 3 * bits));
        for (int p = 0; p < 8; p++)
            for (int c = 0; c < 3; c++) {
                int at = (p / 4 * PATCH + PATCH / 2) * WIDTH + p % 4 * PATCH + PATCH / 2;
                uint16_t wide;
                float number; /* planes of green, blue, red, alpha */
                memcpy(&wide, bytes + 2 * (3 * at + c), 2);
                memcpy(&number, bytes + 4 * ((c + 2) % 3 * WIDTH * HEIGHT + at),
                       bits == 4 ? 4 : 0);
                double sent = (double)card[p][c];
                if (bits < 4)
                    sent = half_up(zt_develop_value(sent, ZT_VIEW_SRGB), files[f].most) *
                           files[f].most;
                double seen = bits == 1   ? (double)(uint8_t)bytes[3 * at + c]
                              : bits == 2 ? (double)wide
                                          : (double)number;
                if (fabs(seen - sent) > files[f].within)
                    fail_msg("%s, patch %d, channel %d: %g instead of %g", files[f].path, p, c,
                             seen, sent);
            }
    }
    zt_image_free(&image);
}

/* OpenEXR's own program sees the attributes that compositing asks for, by their names and
 * types. */
static void exrheader_sees_attributes(void **state) {
    static const char *const lines[] = {
        "R, 32-bit floating-point",
        "A, 32-bit floating-point",
        "N.X, 32-bit floating-point",
        "framesPerSecond (type rational): 24/1 (24)",
        "time 00:00:01:18",
        "worldToCamera (type m44f)",
        "Software (type string): \"Zoetrope",
        "renderTime (type float): 2.5",
        "chromaticities (type chromaticities):",
        "red   (0.64 0.33)",
        "white (0.3127 0.329)",
        "pixelAspectRatio (type float): 1",
        "zoetrope:frame (type string): \"42\"",
        "zoetrope:seed (type string): \"7\"",
        "zoetrope:key (type string): \"0123456789abcdeffedcba9876543210\"",
        "zoetrope:settings (type string): \"{\"samples\": 4}\"",
        "dataWindow (type box2i): (0 0) - (63 31)",
        "compression (type compression): run-length"};
    (void)state;
    if (!is_there("exrheader")) skip();
    size_t size;
    zt_image *image = test_card();
    assert_int_equal(zt_image_add_channel(image, "N.X"), ZT_OK);
    write_card(image, "head.exr", NULL);
    const char *text = said(&size, "exrheader head.exr");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) assert_says(text, lines[i]);
    write_card(image, "tiles.exr", "tile=32");
    assert_says(said(&size, "exrheader tiles.exr"), "tile size 32 by 32 pixels");
    write_card(image, "dwaa.exr", "compression=dwaa:60");
    assert_says(said(&size, "exrheader dwaa.exr"), "dwa, small scanline blocks");
    zt_image_free(&image);
}

/* A timecode counts frames from midnight at whole rates; where it cannot, there is none. */
static void timecodes(void **state) {
    static const struct {
        int64_t frame;
        zt_rate rate;
        const char *code;
    } rows[] = {{0, {24, 1}, "00:00:00:00"},
                {23, {24, 1}, "00:00:00:23"},
                {1439, {24, 1}, "00:00:59:23"},
                {25 * 3600 * 12, {25, 1}, "12:00:00:00"},
                {30 * 86400 - 1, {30, 1}, "23:59:59:29"},
                {30 * 86400, {30, 1}, NULL},
                {-1, {24, 1}, NULL},
                {10, {30000, 1001}, NULL},
                {10, {60, 1}, NULL}};
    (void)state;
    if (!is_there("exrheader")) skip();
    zt_image *image = test_card();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        size_t size;
        image->info.frame = rows[i].frame;
        image->info.rate = rows[i].rate;
        write_card(image, "code.exr", NULL);
        const char *text = said(&size, "exrheader code.exr");
        if (rows[i].code)
            assert_says(text, rows[i].code);
        else
            assert_null(strstr(text, "timeCode"));
    }
    zt_image_free(&image);
}

/* Layers that have a part each are found by their names, with their channels. */
static void oiiotool_sees_parts(void **state) {
    static const char *const channels[] = {"Z",         "N.X",         "N.Y",  "N.Z",
                                           "id.object", "id.material", "error"};
    static const char *const lines[] = {"channel list: R, G, B, A",
                                        "channel list: Z",
                                        "channel list: N.X, N.Y, N.Z",
                                        "channel list: id.material, id.object",
                                        "channel list: error",
                                        "name: \"rgba\"",
                                        "name: \"depth\"",
                                        "name: \"N\"",
                                        "name: \"id\"",
                                        "name: \"error\""};
    (void)state;
    if (!is_there("oiiotool")) skip();
    size_t size;
    zt_image *image = test_card();
    for (int c = 0; c < 7; c++)
        assert_int_equal(zt_image_add_channel(image, channels[c]), ZT_OK);
    write_card(image, "parts.exr", "parts=layers");
    const char *text = said(&size, "oiiotool --info -v -a parts.exr");
    assert_says(text, "5 subimages");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) assert_says(text, lines[i]);
    write_card(image, "one.exr", NULL);
    text = said(&size, "oiiotool --info -v -a one.exr");
    assert_says(text, "11 channel, float openexr");
    assert_says(text, "oiio:subimages: 1");
    zt_image_free(&image);
}

/* What other formats have a place for. */
static void oiiotool_sees_attributes(void **state) {
    static const struct {
        const char *path, *lines[5];
    } files[] = {
        {"o.png",
         {"64 x   32, 3 channel, uint8 png", "zoetrope:frame: \"42\"",
          "oiio:ColorSpace: \"sRGB\"", "Software: \"Zoetrope",
          "zoetrope:key: \"0123456789abcdef"}},
        {"o.tif",
         {"64 x   32, 3 channel, uint16 tiff", "zoetrope:frame: 42", "zoetrope:seed: 7",
          "Software: \"Zoetrope", "zoetrope:description: card.yaml"}},
        {"o.dpx",
         {"64 x   32, 3 channel, uint10 dpx", "dpx:FrameRate: 24", "dpx:FramePosition: 42",
          "dpx:TimeCode: \"00:00:01:18\"", "Software: \"Zoetrope"}},
        {"o.exr",
         {"64 x   32, 4 channel, float openexr", "framesPerSecond: 24/1 (24)",
          "smpte:TimeCode: 00:00:01:18",
          "worldToCamera: 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -6, 1",
          "oiio:ColorSpace: \"Linear\""}},
        {"o.jpg", {"64 x   32, 3 channel, uint8 jpeg"}},
        {"o.webp", {"64 x   32, 3 channel, uint8 webp"}},
        {"o.hdr", {"64 x   32, 3 channel, float hdr"}}};
    (void)state;
    if (!is_there("oiiotool")) skip();
    zt_image *image = test_card();
    for (size_t f = 0; f < sizeof files / sizeof *files; f++) {
        size_t size;
        write_card(image, files[f].path, NULL);
        const char *text = said(&size, "oiiotool --info -v %s", files[f].path);
        for (int i = 0; i < 5 && files[f].lines[i]; i++) assert_says(text, files[f].lines[i]);
    }
    zt_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ffmpeg_sees_the_card),
        cmocka_unit_test(exrheader_sees_attributes),
        cmocka_unit_test(timecodes),
        cmocka_unit_test(oiiotool_sees_parts),
        cmocka_unit_test(oiiotool_sees_attributes),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
