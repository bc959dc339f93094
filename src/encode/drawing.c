/* Drawings go to files: as they are, or as pixels. */
#include <zoetrope/drawing.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "base/text.h"
#include "encode/aside.h"
#include "encode/raster.h"
#include "image/file.h"

static const double pixels_a_unit = 2;

/* The numbers of the raster as they are, so that a raw view writes the same again. */
static zt_status to_image(zt_image **image, const zt_raster *raster) {
    ZT_TRY(zt_image_create(image, raster->width, raster->height));
    size_t count = (size_t)raster->width * (size_t)raster->height;
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            (*image)->pixels[4 * i + (size_t)c] =
                (float)(raster->pixels[i] >> (16 - 8 * c) & 0xFF) / 255;
    return ZT_OK;
}

static zt_status write_pixels(const char *path, const char *target, const char *svg,
                              size_t length, zt_listener listener) {
    const zt_raster_door *door = zt_module_door("raster", "a drawing as a PNG image", listener);
    if (!door) return ZT_EUNSUPPORTED;
    zt_raster raster = {0};
    zt_image *image = NULL;
    zt_image_wishes wishes;
    zt_status status = door->draw(&raster, svg, length, pixels_a_unit, listener);
    if (status == ZT_OK) status = to_image(&image, &raster);
    if (status == ZT_OK) status = zt_image_wish(&wishes, target, NULL, listener);
    if (status == ZT_OK)
        status = zt_image_file_write(image, ZT_VIEW_RAW, &wishes, path, listener);
    zt_image_free(&image);
    free(raster.pixels);
    return status;
}

static zt_status write_text(const char *path, const char *target, const char *svg,
                            size_t length, zt_listener listener) {
    FILE *file = fopen(path, "wb");
    bool good = file && fwrite(svg, 1, length, file) == length;
    if (file) good = fclose(file) == 0 && good;
    if (good) return ZT_OK;
    zt_tell(listener, ZT_ERROR, "cannot write %s: %s", target, strerror(errno));
    return ZT_EFILE;
}

zt_status zt_drawing_write(const char *target, const char *svg, size_t length,
                           zt_listener listener) {
    bool pixels = zt_text_ends_with(target, ".png", true);
    if (!pixels && !zt_text_ends_with(target, ".svg", true)) {
        zt_tell(listener, ZT_ERROR, "%s: a drawing can be written as .svg or .png", target);
        return ZT_EARGUMENT;
    }
    zt_aside aside;
    ZT_TRY(zt_aside_open(&aside, target, listener));
    zt_status status =
        (pixels ? write_pixels : write_text)(aside.path, target, svg, length, listener);
    if (status == ZT_OK) return zt_aside_keep(&aside, listener);
    zt_aside_drop(&aside);
    return status;
}
