/* For tests that look at whole pictures of a description: a text becomes an image. cmocka.h
 * comes first. */
#ifndef ZT_TESTS_PICTURES_H
#define ZT_TESTS_PICTURES_H

#include <zoetrope/aov.h>
#include <zoetrope/renderer.h>

#include "descriptions.h"

/* A frame of a text's animation, of the caller to free; with the channels of the settings. */
static inline zt_image *picture_of(const char *text, int64_t frame,
                                   const zt_render_settings *settings) {
    zt_animation *animation = animation_of(text);
    zt_renderer *renderer;
    zt_image *image;
    assert_int_equal(zt_renderer_open(&renderer, animation, settings, (zt_listener){0}), ZT_OK);
    zt_output_format format = zt_renderer_format(renderer);
    assert_int_equal(zt_image_create(&image, format.width, format.height), ZT_OK);
    assert_int_equal(zt_image_add_aovs(image, settings->aovs), ZT_OK);
    assert_int_equal(zt_renderer_frame(renderer, frame, image, NULL), ZT_OK);
    zt_renderer_close(&renderer);
    zt_animation_free(&animation);
    return image;
}

static inline size_t pixel_count_of(const zt_image *image) {
    return (size_t)image->width * (size_t)image->height;
}

#endif
