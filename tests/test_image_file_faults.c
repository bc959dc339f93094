/* Nothing that a wish, an image file or a disk does ends the process or goes unsaid. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "image_files.h"

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wishes_refused),
        cmocka_unit_test(full_disk),
        cmocka_unit_test(unreadable_files),
        cmocka_unit_test(huge_claims),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
