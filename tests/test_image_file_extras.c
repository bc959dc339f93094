/* What image files hold besides colours, written and read again: further channels, and what an
 * image is of. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "image_files.h"
#include <zoetrope/zoetrope.h>

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
        cmocka_unit_test(exr_has_all_channels),
        cmocka_unit_test(channels_are_read),
        cmocka_unit_test(files_tell_what_they_are_of),
        cmocka_unit_test(what_files_tell_is_read),
        cmocka_unit_test(nonsense_is_not_known),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
