/* Rows are developed to R'G'B' in floats (image/develop.h), become Y'CbCr where the format asks
 * for it, and are dithered once, to the codes of the format. */
#include "encode/video_pixels.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <libavutil/imgutils.h>
#include <libavutil/intreadwrite.h>
#include <libavutil/pixdesc.h>

#include "base/text.h"
#include "encode/video_ycbcr.h"
#include "image/develop.h"
#include "image/dither.h"

struct zt_video_pixels {
    const AVPixFmtDescriptor *layout; /* of the frames */
    enum AVPixelFormat pixels;
    bool is_rgb, has_alpha;
    zt_color *color; /* NULL: the view */
    zt_developing how;
    char *manner;
};

/* What one conversion works with, in one piece of memory. */
typedef struct lines {
    float *shown;    /* a row of R'G'B' */
    float *one;      /* a line of one component */
    float *cb, *cr;  /* sums of chroma */
    uint16_t *codes; /* of a line */
} lines;

static zt_status make_frame(AVFrame **frame, int width, int height, enum AVPixelFormat pixels,
                            const zt_video_ear *ear) {
    *frame = av_frame_alloc();
    if (!*frame) return ZT_EMEMORY;
    (*frame)->width = width;
    (*frame)->height = height;
    (*frame)->format = pixels;
    AV_TRY(ear, av_frame_get_buffer(*frame, 0));
    /* Readers may look past the ends of lines: what is there must not depend on what memory
     * held. */
    for (int i = 0; i < AV_NUM_DATA_POINTERS && (*frame)->buf[i]; i++)
        memset((*frame)->buf[i]->data, 0, (*frame)->buf[i]->size);
    return ZT_OK;
}

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

/* A line of one component, from `count` numbers that are `scale` times less than codes; those
 * of more than 8 bits fill the low ones of 16. Colours are dithered, each component by rows of
 * its own but R'G'B', so that grey stays grey; 16 bits and alpha are not. */
static void put_line(AVFrame *frame, const zt_video_pixels *p, int y, int component,
                     const float *numbers, int count, float scale, uint16_t *codes) {
    const AVComponentDescriptor *c = &p->layout->comp[component];
    uint8_t *at = frame->data[c->plane] + (ptrdiff_t)y * frame->linesize[c->plane] + c->offset;
    bool dithered = component < 3 && c->depth < 16;
    int apart = p->is_rgb ? 0 : component * (ZT_DITHER_SIDE / 3);
    zt_dither_line(codes, numbers, count, scale, dithered ? zt_dither_row(y + apart) : NULL);
    if (c->depth <= 8 && c->step == 1)
        for (int x = 0; x < count; x++) at[x] = (uint8_t)codes[x];
    else if (c->depth <= 8)
        for (int x = 0; x < count; x++, at += c->step) *at = (uint8_t)codes[x];
    else if (p->layout->flags & AV_PIX_FMT_FLAG_BE)
        for (int x = 0; x < count; x++, at += c->step) AV_WB16(at, codes[x]);
    else
        for (int x = 0; x < count; x++, at += c->step) AV_WL16(at, codes[x]);
}

static void put_alpha(AVFrame *frame, const zt_video_pixels *p, int y, const float *pixels,
                      lines *l) {
    float most = (float)((1 << p->layout->comp[3].depth) - 1);
    for (int x = 0; x < frame->width; x++) l->one[x] = zt_develop_cut(pixels[4 * x + 3]);
    put_line(frame, p, y, 3, l->one, frame->width, most, l->codes);
}

static void put_rgb(AVFrame *frame, const zt_video_pixels *p, int y, lines *l) {
    float most = (float)((1 << p->layout->comp[0].depth) - 1);
    for (int c = 0; c < 3; c++) {
        for (int x = 0; x < frame->width; x++) l->one[x] = l->shown[3 * x + c];
        put_line(frame, p, y, c, l->one, frame->width, most, l->codes);
    }
}

static void put_ycbcr(AVFrame *frame, const zt_video_pixels *p, int y, lines *l) {
    int width = frame->width, row_count = 1 << p->layout->log2_chroma_h;
    bool halved = p->layout->log2_chroma_w > 0;
    float unit = (float)(1 << (p->layout->comp[0].depth - 8));
    zt_video_luma(l->one, l->cb, l->cr, l->shown, width);
    put_line(frame, p, y, 0, l->one, width, unit, l->codes);
    for (int c = 1; (y + 1) % row_count == 0 && c < 3; c++) {
        zt_video_chroma(l->one, c == 1 ? l->cb : l->cr, width, halved, row_count);
        put_line(frame, p, y / row_count, c, l->one, halved ? width / 2 : width, unit,
                 l->codes);
    }
}

static void convert(AVFrame *frame, const zt_video_pixels *p, const zt_image *image, lines *l) {
    for (int y = 0; y < image->height; y++) {
        const float *pixels = image->pixels + (size_t)y * (size_t)image->width * 4;
        zt_develop_row(l->shown, pixels, image->width, &p->how);
        if (p->is_rgb)
            put_rgb(frame, p, y, l);
        else
            put_ycbcr(frame, p, y, l);
        if (p->has_alpha) put_alpha(frame, p, y, pixels, l);
    }
}

zt_status zt_video_pixels_convert(AVFrame **frame, const zt_video_pixels *p,
                                  const zt_image *image, const zt_video_ear *ear) {
    lines l = {0};
    zt_status status = make_frame(frame, image->width, image->height, p->pixels, ear);
    if (status == ZT_OK && !make_lines(&l, image->width)) status = ZT_EMEMORY;
    if (status == ZT_OK) {
        convert(*frame, p, image, &l);
        tag_frame(p, *frame);
    } else {
        av_frame_free(frame);
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
