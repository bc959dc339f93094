/* libswscale does this, too, but not dithered, and makes white 943 of 10 bits instead of 940.
 */
#include "encode/video_ycbcr.h"

#include "base/wide.h"

/* ITU-R BT.709-6, items 3.2 to 3.4. */
static const float red_share = 0.2126F, green_share = 0.7152F, blue_share = 0.0722F;
static const float blue_step = 224 / 1.8556F, red_step = 224 / 1.5748F;

ZT_CLONES static void convert(float *restrict luma, float *restrict cb, float *restrict cr,
                              const float *restrict shown, int width) {
    for (int x = 0; x < width; x++) {
        float r = shown[3 * x], g = shown[3 * x + 1], b = shown[3 * x + 2];
        float y = red_share * r + green_share * g + blue_share * b;
        luma[x] = 16 + 219 * y;
        cb[x] += blue_step * (b - y);
        cr[x] += red_step * (r - y);
    }
}

void zt_video_luma(float *luma, float *cb, float *cr, const float *shown, int width) {
    convert(luma, cb + 1, cr + 1, shown, width);
}

ZT_CLONES static void halve(float *restrict line, const float *restrict sums, int count,
                            float scale) {
    for (int x = 0; x < count; x++)
        line[x] = 128 + scale * (sums[2 * x] + 2 * sums[2 * x + 1] + sums[2 * x + 2]);
}

void zt_video_chroma(float *line, float *sums, int width, int before, bool halved,
                     int row_count) {
    float scale = 1 / (float)row_count;
    sums[0] = sums[1]; /* beyond its edge the picture goes on as it begins */
    if (halved)
        halve(line, sums + before, (width - before) / 2, scale / 4);
    else
        for (int x = 0; x < width; x++) line[x] = 128 + scale * sums[x + 1];
    for (int x = 0; x < width + 2; x++) sums[x] = 0;
}
