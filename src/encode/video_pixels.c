/* Rows are developed to R'G'B' in floats (image/develop.h), become Y'CbCr where the format asks
 * for it, and are dithered once, to the codes of the format. A code depends on its pixel, those
 * beside it and its place, so that tiles which a slate shows already (image/stamps.h) stay. */
#include "encode/video_pixels.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <libavutil/imgutils.h>
#include <libavutil/intreadwrite.h>
#include <libavutil/pixdesc.h>

#include "base/text.h"
#include "encode/video_slates.h"
#include "encode/video_ycbcr.h"
#include "image/develop.h"
#include "image/dither.h"
#include "image/stamps.h"

struct zt_video_pixels {
    const AVPixFmtDescriptor *layout; /* of the frames */
    enum AVPixelFormat pixels;
    bool is_rgb, has_alpha;
    zt_color *color; /* NULL: the view */
    zt_developing how;
    char *manner;
    zt_video_slates *slates;
};

/* What one conversion works with, in one piece of memory: room for a row. */
typedef struct lines {
    float *shown;    /* of R'G'B' */
    float *one;      /* of one component */
    float *cb, *cr;  /* sums of chroma, from before the first pixel on */
    uint16_t *codes; /* likewise */
} lines;

/* What the numbers mean, for decoders. Y'CbCr: BT.709 primaries and matrix in 16..235 (240),
 * chroma sited left. The transfer tag is BT.709's in all views, although only the view of
 * that name has its numbers and most have sRGB's (tag 13): nearly all players show the numbers
 * of a 709 film as they are, which on an sRGB display is right, while 13 is so rare in films
 * that some programs take it for unknown. The few that take 709 at its word show the shadows a
 * little lighter, as of all films made on such a display.
 *
 * R'G'B' is tagged as what it is, displays of OpenColorIO as sRGB's: those who read APNG take
 * 709 at its word. */
static void tag_frame(const zt_video_pixels *p, AVFrame *frame) {
    frame->color_primaries = AVCOL_PRI_BT709;
    static const enum AVColorTransferCharacteristic transfers[ZT_VIEW_COUNT] = {
        [ZT_VIEW_RAW] = AVCOL_TRC_UNSPECIFIED,
        [ZT_VIEW_SRGB] = AVCOL_TRC_IEC61966_2_1,
        [ZT_VIEW_REC709] = AVCOL_TRC_BT709,
        [ZT_VIEW_FILMIC] = AVCOL_TRC_IEC61966_2_1};
    zt_view view = p->color ? ZT_VIEW_SRGB : p->how.view;
    frame->color_trc = p->is_rgb ? transfers[view] : AVCOL_TRC_BT709;
    frame->colorspace = p->is_rgb ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
    frame->color_range = p->is_rgb ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    if (!p->is_rgb) frame->chroma_location = AVCHROMA_LOC_LEFT;
}

static zt_status check_size(const zt_output_format *format, enum AVPixelFormat pixels,
                            const zt_video_ear *ear) {
    AV_TRY(ear, av_image_check_size2((unsigned)format->width, (unsigned)format->height,
                                     INT64_MAX, pixels, 0, NULL));
    return ZT_OK;
}

zt_status zt_video_pixels_open(zt_video_pixels **out, const zt_output_format *format,
                               enum AVPixelFormat pixels, const zt_video_ear *ear) {
    *out = NULL;
    zt_video_pixels *p = calloc(1, sizeof *p);
    if (!p) return ZT_EMEMORY;
    p->layout = av_pix_fmt_desc_get(pixels);
    p->pixels = pixels;
    p->is_rgb = p->layout->flags & AV_PIX_FMT_FLAG_RGB;
    p->has_alpha = p->layout->flags & AV_PIX_FMT_FLAG_ALPHA;
    zt_status status = check_size(format, pixels, ear);
    if (status == ZT_OK) status = zt_color_open(&p->color, &format->color, ear->listener);
    p->how = (zt_developing){.view = format->view,
                             .color = p->color,
                             .alpha = p->has_alpha ? ZT_ALPHA_DIVIDED : ZT_ALPHA_LEFT_OUT};
    p->manner = zt_text_print("%s %s, dithered", av_get_pix_fmt_name(pixels),
                              p->color ? p->color->manner : zt_view_name(format->view));
    if (status == ZT_OK && !p->manner) status = ZT_EMEMORY;
    if (status == ZT_OK) status = zt_video_slates_open(&p->slates);
    if (status == ZT_OK)
        *out = p;
    else
        zt_video_pixels_close(&p);
    return status;
}

void zt_video_pixels_close(zt_video_pixels **converter) {
    zt_video_pixels *p = *converter;
    if (!p) return;
    zt_color_close(&p->color);
    zt_video_slates_close(&p->slates);
    free(p->manner);
    free(p);
    *converter = NULL;
}

const char *zt_video_pixels_manner(const zt_video_pixels *converter) {
    return converter->manner;
}

static bool make_lines(lines *l, int width) {
    size_t count = (size_t)width;
    l->shown = calloc(3 * count + count + 2 * (count + 2), sizeof *l->shown);
    l->codes = malloc(count * sizeof *l->codes);
    if (!l->shown) return false;
    l->one = l->shown + 3 * count;
    l->cb = l->one + count;
    l->cr = l->cb + count + 2;
    return l->codes;
}

static void free_lines(lines *l) {
    free(l->shown);
    free(l->codes);
}

/* Pixels of a row: first .. last - 1. */
typedef struct span {
    int first, last;
} span;

/* Columns of one component in a line, from numbers that are `scale` times less than codes;
 * those of more than 8 bits fill the low ones of 16. Colours are dithered, each component by
 * rows of its own but R'G'B', so that grey stays grey; 16 bits and alpha are not. */
static void put_line(AVFrame *frame, const zt_video_pixels *p, int y, int component,
                     const float *numbers, span at, float scale, uint16_t *codes) {
    const AVComponentDescriptor *c = &p->layout->comp[component];
    uint8_t *to = frame->data[c->plane] + (ptrdiff_t)y * frame->linesize[c->plane] + c->offset +
                  (ptrdiff_t)at.first * c->step;
    bool dithered = component < 3 && c->depth < 16;
    int apart = p->is_rgb ? 0 : component * (ZT_DITHER_SIDE / 3), count = at.last - at.first;
    zt_dither_line(codes, numbers, at.first, count, scale,
                   dithered ? zt_dither_row(y + apart) : NULL);
    if (c->depth <= 8 && c->step == 1)
        for (int x = 0; x < count; x++) to[x] = (uint8_t)codes[x];
    else if (c->depth <= 8)
        for (int x = 0; x < count; x++, to += c->step) *to = (uint8_t)codes[x];
    else if (p->layout->flags & AV_PIX_FMT_FLAG_BE)
        for (int x = 0; x < count; x++, to += c->step) AV_WB16(to, codes[x]);
    else
        for (int x = 0; x < count; x++, to += c->step) AV_WL16(to, codes[x]);
}

static void put_alpha(AVFrame *frame, const zt_video_pixels *p, int y, const float *pixels,
                      span at, lines *l) {
    float most = (float)((1 << p->layout->comp[3].depth) - 1);
    for (int x = at.first; x < at.last; x++)
        l->one[x - at.first] = zt_develop_cut(pixels[4 * x + 3]);
    put_line(frame, p, y, 3, l->one, at, most, l->codes);
}

static void put_rgb(AVFrame *frame, const zt_video_pixels *p, int y, span at, lines *l) {
    float most = (float)((1 << p->layout->comp[0].depth) - 1);
    for (int c = 0; c < 3; c++) {
        for (int x = 0; x < at.last - at.first; x++) l->one[x] = l->shown[3 * x + c];
        put_line(frame, p, y, c, l->one, at, most, l->codes);
    }
}

static void put_ycbcr(AVFrame *frame, const zt_video_pixels *p, int y, span at, lines *l) {
    int row_count = 1 << p->layout->log2_chroma_h, count = at.last - at.first;
    bool halved = p->layout->log2_chroma_w > 0;
    float unit = (float)(1 << (p->layout->comp[0].depth - 8));
    zt_video_luma(l->one, l->cb, l->cr, l->shown, count);
    put_line(frame, p, y, 0, l->one, at, unit, l->codes);
    for (int c = 1; (y + 1) % row_count == 0 && c < 3; c++) {
        int before = halved && at.first > 0; /* of a pixel that only its neighbor asks for */
        span some = {(at.first + before) / (halved + 1), at.last / (halved + 1)};
        zt_video_chroma(l->one, c == 1 ? l->cb : l->cr, count, before, halved, row_count);
        put_line(frame, p, y / row_count, c, l->one, some, unit, l->codes);
    }
}

/* Those pixels, and what besides them depends on their colours. */
static void convert_span(AVFrame *frame, const zt_video_pixels *p, int y, span at,
                         const zt_image *image, lines *l) {
    const float *pixels = image->pixels + (size_t)y * (size_t)image->width * 4;
    if (!p->is_rgb && p->layout->log2_chroma_w > 0) {
        at.first -= at.first > 0;
        at.last = at.last + 2 < image->width ? at.last + 2 : image->width;
    }
    zt_develop_row(l->shown, pixels + 4 * (size_t)at.first, at.last - at.first, &p->how);
    if (p->is_rgb)
        put_rgb(frame, p, y, at, l);
    else
        put_ycbcr(frame, p, y, at, l);
    if (p->has_alpha) put_alpha(frame, p, y, pixels, at, l);
}

static bool is_shown(const zt_image *image, const uint64_t *stamps, int tile) {
    return image->stamps && image->stamps[tile] && image->stamps[tile] == stamps[tile];
}

/* Converts the tiles that the slate does not show, as many side by side as there are. */
static void convert(zt_video_slate *slate, const zt_video_pixels *p, const zt_image *image,
                    lines *l) {
    int columns = zt_stamp_tiles(image->width), rows = zt_stamp_tiles(image->height);
    int64_t spared = (int64_t)columns * rows;
    for (int row = 0; row < rows; row++) {
        int first = row * columns, begin = row * ZT_STAMP_SIDE, end = begin + ZT_STAMP_SIDE;
        if (end > image->height) end = image->height;
        for (int from = 0, to; from < columns; from = to + 1) {
            for (to = from; to < columns && !is_shown(image, slate->stamps, first + to);) to++;
            span at = {from * ZT_STAMP_SIDE, to * ZT_STAMP_SIDE};
            spared -= to - from;
            if (at.last > image->width) at.last = image->width;
            for (int y = begin; y < end && from < to; y++)
                convert_span(slate->frame, p, y, at, image, l);
        }
    }
    size_t size = (size_t)columns * (size_t)rows * sizeof *slate->stamps;
    if (image->stamps)
        memcpy(slate->stamps, image->stamps, size);
    else
        memset(slate->stamps, 0, size);
    zt_video_slates_spare(p->slates, spared);
}

int64_t zt_video_pixels_spared(const zt_video_pixels *p) {
    return zt_video_slates_spared(p->slates);
}

static zt_status take_slate(zt_video_slate **slate, const zt_video_pixels *p, int width,
                            int height, const zt_video_ear *ear) {
    return zt_video_slates_take(slate, p->slates, width, height, p->pixels, ear);
}

static zt_status show_slate(AVFrame **frame, const zt_video_pixels *p, zt_video_slate *slate) {
    tag_frame(p, slate->frame);
    *frame = av_frame_clone(slate->frame);
    zt_video_slates_give(p->slates, slate);
    return *frame ? ZT_OK : ZT_EMEMORY;
}

zt_status zt_video_pixels_like(AVFrame **frame, const zt_video_pixels *p, int width, int height,
                               const zt_video_ear *ear) {
    zt_video_slate *slate;
    ZT_TRY(take_slate(&slate, p, width, height, ear));
    return show_slate(frame, p, slate);
}

zt_status zt_video_pixels_convert(AVFrame **frame, const zt_video_pixels *p,
                                  const zt_image *image, const zt_video_ear *ear) {
    lines l = {0};
    zt_video_slate *slate = NULL;
    zt_status status = make_lines(&l, image->width) ? ZT_OK : ZT_EMEMORY;
    if (status == ZT_OK) status = take_slate(&slate, p, image->width, image->height, ear);
    if (status == ZT_OK) {
        convert(slate, p, image, &l);
        status = show_slate(frame, p, slate);
    }
    free_lines(&l);
    return status;
}

/* Components of the same meaning and place; of a depth that is not less (ProRes 4444 is decoded
 * to 12 bits). */
static bool comparable(const AVPixFmtDescriptor *a, const AVPixFmtDescriptor *b) {
    return a && b && a->nb_components >= b->nb_components &&
           a->comp[0].depth >= b->comp[0].depth && a->log2_chroma_w == b->log2_chroma_w &&
           a->log2_chroma_h == b->log2_chroma_h &&
           !((a->flags ^ b->flags) & AV_PIX_FMT_FLAG_RGB);
}

static void read_line(uint16_t *line, const AVFrame *frame, int component, int y, int width) {
    av_read_image_line(line, (const uint8_t **)frame->data, frame->linesize,
                       av_pix_fmt_desc_get(frame->format), 0, y, component, width, 0);
}

/* The sum of squared differences of one component, and how many numbers it has. Of what is
 * transparent in both, colours do not matter. `lines` has place for four. */
static double sum_squares(int64_t *count, const AVFrame *a, const AVFrame *b, int component,
                          uint16_t *lines) {
    const AVPixFmtDescriptor *a_layout = av_pix_fmt_desc_get(a->format);
    const AVPixFmtDescriptor *b_layout = av_pix_fmt_desc_get(b->format);
    bool is_chroma = component == 1 || component == 2;
    int width = is_chroma ? AV_CEIL_RSHIFT(b->width, b_layout->log2_chroma_w) : b->width;
    int height = is_chroma ? AV_CEIL_RSHIFT(b->height, b_layout->log2_chroma_h) : b->height;
    int shift = a_layout->comp[0].depth - b_layout->comp[0].depth;
    bool masked = b_layout->nb_components == 4 && component < 3 && width == b->width;
    uint16_t *a_line = lines, *b_line = a_line + width, *a_mask = b_line + width,
             *b_mask = a_mask + width;
    double sum = 0;
    for (int y = 0; y < height; y++) {
        read_line(a_line, a, component, y, width);
        read_line(b_line, b, component, y, width);
        if (masked) {
            read_line(a_mask, a, 3, y, width);
            read_line(b_mask, b, 3, y, width);
        }
        int64_t row_sum = 0;
        for (int x = 0; x < width; x++) {
            int64_t difference = a_line[x] - (b_line[x] << shift);
            if (!masked || a_mask[x] || b_mask[x]) row_sum += difference * difference;
        }
        sum += (double)row_sum;
    }
    *count += (int64_t)width * height;
    return sum;
}

double zt_video_psnr(const AVFrame *found, const AVFrame *sent) {
    const AVPixFmtDescriptor *layout = av_pix_fmt_desc_get(sent->format);
    const AVPixFmtDescriptor *found_layout = av_pix_fmt_desc_get(found->format);
    if (found->width != sent->width || found->height != sent->height ||
        !comparable(found_layout, layout))
        return -1;
    uint16_t *lines = malloc(4 * (size_t)sent->width * sizeof *lines);
    if (!lines) return -1;
    double sum = 0, max = (1 << found_layout->comp[0].depth) - 1;
    int64_t count = 0;
    for (int c = 0; c < layout->nb_components; c++)
        sum += sum_squares(&count, found, sent, c, lines);
    free(lines);
    return sum > 0 ? 10 * log10(max * max * (double)count / sum) : (double)INFINITY;
}
