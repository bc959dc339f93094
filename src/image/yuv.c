/* From linear light to 4:2:0 in one pass, a block of two rows at a time: in between, all of it
 * stays in the nearest cache. */
#include "image/yuv.h"

#include <assert.h>
#include <stddef.h>

#include "base/wide.h"
#include "image/develop.h"

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "red is a pixel's lowest byte");

enum { BLOCK = 256 };
#define RED_AND_BLUE UINT32_C(0xff00ff)

/* Two rows of developed pixels, and the sums of the two in each column, which begin with the
 * column to the left of the block. Red and blue share a number: blue << 16 | red. */
typedef struct block {
    uint32_t pixels[2][BLOCK];
    uint32_t red_blue[1 + BLOCK], green[1 + BLOCK];
} block;

/* 219 / 255 of BT.709's weights, times 2^16; 16.5 for black and rounding. */
ZT_CLONES static void make_luma(uint8_t *restrict luma, const uint32_t *restrict pixels,
                                int count) {
    for (int x = 0; x < count; x++) {
        uint32_t r = pixels[x] & 0xff, g = pixels[x] >> 8 & 0xff, b = pixels[x] >> 16 & 0xff;
        luma[x] = (uint8_t)((11966 * r + 40254 * g + 4064 * b + 33 * (1 << 15)) >> 16);
    }
}

ZT_CLONES static void sum_rows(block *sums, int count) {
    const uint32_t *restrict upper = sums->pixels[0], *restrict lower = sums->pixels[1];
    uint32_t *restrict red_blue = sums->red_blue + 1, *restrict green = sums->green + 1;
    for (int x = 0; x < count; x++) {
        red_blue[x] = (upper[x] & RED_AND_BLUE) + (lower[x] & RED_AND_BLUE);
        green[x] = (upper[x] >> 8 & 0xff) + (lower[x] >> 8 & 0xff);
    }
}

/* 224 / 255 of the weights, times 2^16, for sums that are eight times too large; 128.5 for grey
 * and rounding. */
ZT_CLONES static void make_chroma(uint8_t *restrict cb, uint8_t *restrict cr, const block *sums,
                                  int count) {
    const uint32_t *restrict red_blue = sums->red_blue, *restrict green = sums->green;
    for (int i = 0; i < count; i++) {
        uint32_t both = red_blue[2 * i] + 2 * red_blue[2 * i + 1] + red_blue[2 * i + 2];
        int32_t r = (int32_t)(both & 0xffff), b = (int32_t)(both >> 16);
        int32_t g = (int32_t)(green[2 * i] + 2 * green[2 * i + 1] + green[2 * i + 2]);
        const int32_t grey = 257 * (1 << 18);
        cb[i] = (uint8_t)((-6596 * r - 22188 * g + 28784 * b + grey) >> 19);
        cr[i] = (uint8_t)((28784 * r - 26145 * g - 2639 * b + grey) >> 19);
    }
}

static void keep_column(block *sums, int from) {
    sums->red_blue[0] = sums->red_blue[from];
    sums->green[0] = sums->green[from];
}

void zt_develop_yuv420(uint8_t *const planes[3], const int strides[3], const zt_image *image,
                       zt_view view) {
    block sums;
    for (int y = 0; y < image->height; y += 2)
        for (int x = 0; x < image->width; x += BLOCK) {
            int count = image->width - x < BLOCK ? image->width - x : BLOCK;
            for (int row = 0; row < 2; row++) {
                size_t at = (size_t)(y + row) * (size_t)image->width + (size_t)x;
                zt_develop_rgbx8((uint8_t *)sums.pixels[row], image->pixels + 4 * at, count,
                                 view);
                make_luma(planes[0] + (ptrdiff_t)(y + row) * strides[0] + x, sums.pixels[row],
                          count);
            }
            sum_rows(&sums, count);
            if (x == 0) keep_column(&sums, 1);
            make_chroma(planes[1] + (ptrdiff_t)(y / 2) * strides[1] + x / 2,
                        planes[2] + (ptrdiff_t)(y / 2) * strides[2] + x / 2, &sums, count / 2);
            keep_column(&sums, count);
        }
}
