/* Pixels in memory. */
#include <zoetrope/image.h>

#include <stdlib.h>

zt_status zt_image_create(zt_image **out, int width, int height) {
    *out = NULL;
    if (width < 1 || height < 1 || width > ZT_IMAGE_SIDE_MAX || height > ZT_IMAGE_SIDE_MAX)
        return ZT_EARGUMENT;
    zt_image *image = calloc(1, sizeof *image);
    if (!image) return ZT_EMEMORY;
    size_t pixel_count = (size_t)width * (size_t)height;
    image->width = width;
    image->height = height;
    image->pixels = calloc(pixel_count, 4 * sizeof *image->pixels);
    if (!image->pixels) {
        free(image);
        return ZT_EMEMORY;
    }
    for (size_t i = 0; i < pixel_count; i++) image->pixels[4 * i + 3] = 1;
    *out = image;
    return ZT_OK;
}

void zt_image_free(zt_image **image) {
    if (!*image) return;
    free((*image)->pixels);
    free(*image);
    *image = NULL;
}
