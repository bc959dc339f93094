/* For tests of codecs: the format of their movies, and movies of the test card, written in one
 * way or another. cmocka.h comes first. */
#ifndef ZT_TESTS_CARDS_H
#define ZT_TESTS_CARDS_H

#include <libavutil/pixdesc.h>

#include "movies.h"

enum { CARD = 48, WIDTH = PATCH_COLUMNS * CARD, HEIGHT = PATCH_COUNT / PATCH_COLUMNS * CARD };
enum { FRAME_COUNT = 10 };

static const zt_output_format format = {.width = WIDTH,
                                        .height = HEIGHT,
                                        .rate = {24, 1},
                                        .view = ZT_VIEW_SRGB,
                                        .frame_count = FRAME_COUNT};

/* One way to write a movie, and what is to be found. */
typedef struct way {
    const char *ending, *codec, *pixels;
    enum AVCodecID id;
    const char *decoded; /* the pixel format of the decoder's, where it is another */
    const char *decoder; /* that knows alpha, or NULL */
    uint32_t tag;        /* of MP4 and MOV; 0: any */
    double tolerance;    /* of 255 */
} way;

/* FFmpeg says that of all palettes; ours is opaque. */
static inline bool has_alpha(const way *w) {
    if (strcmp(w->pixels, "pal8") == 0) return false;
    return av_pix_fmt_desc_get(av_get_pix_fmt(w->pixels))->flags & AV_PIX_FMT_FLAG_ALPHA;
}

/* How much of a patch is there where the way knows alpha; GIF knows only all and nothing. */
static inline double alpha_of(const way *w, int patch) {
    if (!has_alpha(w) || patch % 3 != 0) return 1;
    return w->id == AV_CODEC_ID_GIF ? 0 : 0.5;
}

/* The card of frame f: its patches, of which those with alpha are multiplied by it; and, so
 * that frames differ, a white bar in the margin of the last row that moves on by four pixels.
 */
static inline zt_image *card_of(const way *w, int f) {
    zt_image *card = test_card(CARD);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float *pixel = card->pixels + 4 * (size_t)(y * WIDTH + x);
            float alpha = (float)alpha_of(w, y / CARD * PATCH_COLUMNS + x / CARD);
            for (int c = 0; c < 4; c++) pixel[c] *= alpha;
            if (y >= HEIGHT - 6 && x >= 4 * f && x < 4 * f + 4)
                for (int c = 0; c < 4; c++) pixel[c] = 1;
        }
    return card;
}

static inline void write_way(const char *path, const way *w) {
    const zt_output_option options[] = {
        {"codec", w->codec}, {"pixel-format", w->pixels}, {NULL, NULL}};
    zt_output *output = open_movie_by(path, &format, options);
    for (int f = 0; f < FRAME_COUNT; f++) {
        zt_image *card = card_of(w, f);
        assert_int_equal(zt_output_write(output, card, f), ZT_OK);
        zt_image_free(&card);
    }
    close_movie(&output);
}

#endif
