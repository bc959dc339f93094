/* Image files that are written and read again, and a picture that is partly transparent.
 * cmocka.h comes first. */
#ifndef ZT_TESTS_IMAGE_FILES_H
#define ZT_TESTS_IMAGE_FILES_H

#include "files.h"
#include "image/file.h"

static inline zt_image *read_back(const char *path) {
    heard h;
    zt_image *image;
    if (zt_image_file_read(&image, path, listener_of(&h)) != ZT_OK) fail_msg("%s", h.text);
    return image;
}

static inline void write_wished(const zt_image *image, zt_view view, const char *path,
                                const zt_wish *options) {
    heard h;
    zt_image_wishes wishes;
    if (zt_image_wish(&wishes, path, options, listener_of(&h)) != ZT_OK ||
        zt_image_file_write(image, view, &wishes, path, listener_of(&h)) != ZT_OK)
        fail_msg("%s", h.text);
}

static inline void write_picture(const zt_image *image, zt_view view, const char *path) {
    write_wished(image, view, path, NULL);
}

static inline void write_bytes(const char *path, const char *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

/* A picture that is covered by 1/4 to the left, not at all in one pixel, wholly elsewhere; its
 * colours are multiplied by that. */
static inline zt_image *covered_picture(void) {
    zt_image *image = picture(8, 4, 0);
    for (int i = 0; i < 8 * 4; i++) {
        float alpha = i == 9 ? 0 : i % 8 < 4 ? 0.25f : 1;
        for (int c = 0; c < 4; c++) image->pixels[4 * i + c] *= alpha;
    }
    return image;
}

#endif
