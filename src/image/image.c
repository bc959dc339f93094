/* Pixels in memory. */
#include <zoetrope/image.h>

#include <stdlib.h>
#include <string.h>

#include "base/pages.h"
#include "image/info.h"
#include "image/stamps.h"

typedef struct zt_image_text {
    struct zt_image_text *next;
    char text[];
} zt_image_text;

const char *zt_image_own_text(zt_image *image, const char *text) {
    size_t size = strlen(text) + 1;
    zt_image_text *own = malloc(sizeof *own + size);
    if (!own) return NULL;
    own->next = image->texts;
    image->texts = own;
    return memcpy(own->text, text, size);
}

zt_status zt_image_create(zt_image **out, int width, int height) {
    *out = NULL;
    if (width < 1 || height < 1 || width > ZT_IMAGE_SIDE_MAX || height > ZT_IMAGE_SIDE_MAX)
        return ZT_EARGUMENT;
    zt_image *image = calloc(1, sizeof *image);
    if (!image) return ZT_EMEMORY;
    size_t pixel_count = (size_t)width * (size_t)height;
    image->width = width;
    image->height = height;
    image->linear = true;
    image->pixels = zt_pages_alloc(pixel_count * 4 * sizeof *image->pixels);
    if (!image->pixels) {
        free(image);
        return ZT_EMEMORY;
    }
    for (size_t i = 0; i < pixel_count; i++)
        memcpy(image->pixels + 4 * i, (float[4]){0, 0, 0, 1}, 4 * sizeof *image->pixels);
    *out = image;
    return ZT_OK;
}

void zt_image_free(zt_image **image) {
    if (!*image) return;
    for (int i = 0; i < (*image)->channel_count; i++) free((*image)->channels[i].values);
    free((*image)->pixels);
    free((*image)->stamps);
    while ((*image)->texts) {
        zt_image_text *next = (*image)->texts->next;
        free((*image)->texts);
        (*image)->texts = next;
    }
    free(*image);
    *image = NULL;
}

float *zt_image_channel(const zt_image *image, const char *name) {
    for (int i = 0; i < image->channel_count; i++)
        if (strcmp(image->channels[i].name, name) == 0) return image->channels[i].values;
    return NULL;
}

zt_status zt_image_add_channel(zt_image *image, const char *name) {
    if (zt_image_channel(image, name)) return ZT_OK;
    if (image->channel_count == ZT_IMAGE_CHANNELS_MAX) return ZT_EARGUMENT;
    zt_channel *added = &image->channels[image->channel_count];
    added->name = name;
    added->values = calloc((size_t)image->width * (size_t)image->height, sizeof(float));
    if (!added->values) return ZT_EMEMORY;
    image->channel_count++;
    return ZT_OK;
}

static size_t stamp_count(const zt_image *image) {
    return (size_t)zt_stamp_tiles(image->width) * (size_t)zt_stamp_tiles(image->height);
}

zt_status zt_image_add_stamps(zt_image *image) {
    image->stamps = calloc(stamp_count(image), sizeof *image->stamps);
    return image->stamps ? ZT_OK : ZT_EMEMORY;
}

void zt_image_forget_stamps(zt_image *image) {
    if (image->stamps) memset(image->stamps, 0, stamp_count(image) * sizeof *image->stamps);
}
