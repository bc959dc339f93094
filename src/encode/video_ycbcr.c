#include "encode/video_ycbcr.h"

#include <stdbool.h>
#include <stdint.h>

#include <libavutil/pixdesc.h>

/* ITU-R BT.709-6, items 3.2 and 3.3. */
static const float red_share = 0.2126F, green_share = 0.7152F, blue_share = 0.0722F;
static const float blue_span = 1.8556F, red_span = 1.5748F;

static uint16_t nearest(float value) { return (uint16_t)(value + 0.5F); }

/* One row: writes its luma, and adds to that of the chroma's, a place of which lies before the
 * first pixel. `unit` is a step of 8 bits. */
static void convert_row(uint16_t *luma, float *cb, float *cr, const uint16_t *rgb, int channels,
                        int width, float unit) {
    const float scale = 1 / 65535.0F;
    for (int x = 0; x < width; x++, rgb += channels) {
        float r = (float)rgb[0] * scale, g = (float)rgb[1] * scale, b = (float)rgb[2] * scale;
        float y = red_share * r + green_share * g + blue_share * b;
        luma[x] = nearest(unit * (16 + 219 * y));
        cb[x + 1] += (b - y) / blue_span;
        cr[x + 1] += (r - y) / red_span;
    }
}

/* The sums of `row_count` rows become one of chroma. */
static void put_chroma(uint16_t *out, float *sums, int width, bool halved, int row_count,
                       float unit) {
    float scale = 224 * unit / (float)row_count;
    sums[0] = sums[1];
    sums[width + 1] = sums[width];
    if (halved)
        for (int x = 0; x < width / 2; x++) {
            const float *at = sums + 1 + 2 * x;
            out[x] = nearest(128 * unit + scale / 4 * (at[-1] + 2 * at[0] + at[1]));
        }
    else
        for (int x = 0; x < width; x++) out[x] = nearest(128 * unit + scale * sums[x + 1]);
    for (int x = 0; x < width + 2; x++) sums[x] = 0;
}

static uint16_t *row_of(const AVFrame *frame, int plane, int y) {
    return (uint16_t *)(void *)(frame->data[plane] + (ptrdiff_t)y * frame->linesize[plane]);
}

void zt_video_ycbcr(AVFrame *frame, const AVFrame *rgb, float *scratch) {
    const AVPixFmtDescriptor *layout = av_pix_fmt_desc_get(frame->format);
    int channels = av_pix_fmt_desc_get(rgb->format)->nb_components,
        depth = layout->comp[0].depth;
    int row_count = 1 << layout->log2_chroma_h, width = frame->width;
    float unit = (float)(1 << (depth - 8)), *cb = scratch, *cr = scratch + width + 2;
    for (int x = 0; x < 2 * (width + 2); x++) scratch[x] = 0;
    for (int y = 0; y < frame->height; y++) {
        const uint16_t *row = row_of(rgb, 0, y);
        convert_row(row_of(frame, 0, y), cb, cr, row, channels, width, unit);
        if ((y + 1) % row_count == 0) {
            bool halved = layout->log2_chroma_w > 0;
            put_chroma(row_of(frame, 1, y / row_count), cb, width, halved, row_count, unit);
            put_chroma(row_of(frame, 2, y / row_count), cr, width, halved, row_count, unit);
        }
        if (layout->nb_components > 3) {
            uint16_t *alpha = row_of(frame, 3, y);
            uint32_t max = (1u << depth) - 1;
            for (int x = 0; x < width; x++)
                alpha[x] = (uint16_t)((row[x * channels + 3] * max + 32767) / 65535);
        }
    }
}
