/* R'G'B' of 8 or 16 bits is developed (image/develop.h). Formats of R'G'B' get it as it is,
 * formats of Y'CbCr by libswscale, or with more than 8 bits by video_ycbcr. */
#include "encode/video_pixels.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <libavutil/imgutils.h>
#include <libavutil/intreadwrite.h>
#include <libavutil/opt.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>

#include "encode/video_ycbcr.h"
#include "image/develop.h"

struct zt_video_pixels {
    const AVPixFmtDescriptor *layout; /* of the frames */
    enum AVPixelFormat pixels;
    bool is_rgb, is_deep, has_alpha;
    AVFrame *rgb;                 /* an image developed: RGB24, RGBA, RGB48 or RGBA64 */
    struct SwsContext *converter; /* from there to Y'CbCr of 8 bits; else NULL */
    float *chroma;                /* for Y'CbCr of more */
    zt_image row;                 /* one, without the alpha in its colours */
    uint16_t *line;               /* of one component */
    zt_view view;
};

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
 * R'G'B' is tagged as what it is: those who read APNG take 709 at its word. */
static void tag_frame(const zt_video_pixels *p, AVFrame *frame) {
    frame->color_primaries = AVCOL_PRI_BT709;
    static const enum AVColorTransferCharacteristic transfers[ZT_VIEW_COUNT] = {
        [ZT_VIEW_RAW] = AVCOL_TRC_UNSPECIFIED,
        [ZT_VIEW_SRGB] = AVCOL_TRC_IEC61966_2_1,
        [ZT_VIEW_REC709] = AVCOL_TRC_BT709,
        [ZT_VIEW_FILMIC] = AVCOL_TRC_IEC61966_2_1};
    frame->color_trc = p->is_rgb ? transfers[p->view] : AVCOL_TRC_BT709;
    frame->colorspace = p->is_rgb ? AVCOL_SPC_RGB : AVCOL_SPC_BT709;
    frame->color_range = p->is_rgb ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG;
    if (!p->is_rgb) frame->chroma_location = AVCHROMA_LOC_LEFT;
}

/* From full-range R'G'B' to BT.709 limited range, rounded and with chroma from all pixels. */
static zt_status make_converter(zt_video_pixels *p, const zt_video_ear *ear) {
    p->converter = sws_alloc_context();
    if (!p->converter) return ZT_EMEMORY;
    const struct {
        const char *name;
        int64_t value;
    } options[] = {
        {"srcw", p->rgb->width},
        {"srch", p->rgb->height},
        {"src_format", p->rgb->format},
        {"src_range", 1},
        {"dstw", p->rgb->width},
        {"dsth", p->rgb->height},
        {"dst_format", p->pixels},
        {"dst_range", 0},
        {"dst_h_chr_pos", 0},                                  /* left in its pair of pixels, */
        {"dst_v_chr_pos", p->layout->log2_chroma_h ? 128 : 0}, /* in the middle of its rows */
        {"sws_flags", SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INP | SWS_BITEXACT},
    };
    for (size_t i = 0; i < sizeof options / sizeof *options; i++)
        AV_TRY(ear, av_opt_set_int(p->converter, options[i].name, options[i].value, 0));
    AV_TRY(ear, sws_init_context(p->converter, NULL, NULL));
    const int *bt709 = sws_getCoefficients(SWS_CS_ITU709);
    AV_TRY(ear,
           sws_setColorspaceDetails(p->converter, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16));
    return ZT_OK;
}

static zt_status open_all(zt_video_pixels *p, const zt_output_format *format,
                          const zt_video_ear *ear) {
    enum AVPixelFormat rgb = p->is_deep ? AV_PIX_FMT_RGB48 : AV_PIX_FMT_RGB24;
    if (p->has_alpha) rgb = p->is_deep ? AV_PIX_FMT_RGBA64 : AV_PIX_FMT_RGBA;
    ZT_TRY(make_frame(&p->rgb, format->width, format->height, rgb, ear));
    size_t width = (size_t)format->width;
    p->row = (zt_image){.width = format->width, .height = 1};
    p->row.pixels = malloc(4 * width * sizeof *p->row.pixels);
    p->line = malloc(4 * width * sizeof *p->line);
    p->chroma = malloc(2 * (width + 2) * sizeof *p->chroma);
    if (!p->row.pixels || !p->line || !p->chroma) return ZT_EMEMORY;
    return p->is_rgb || p->is_deep ? ZT_OK : make_converter(p, ear);
}

zt_status zt_video_pixels_open(zt_video_pixels **out, const zt_output_format *format,
                               enum AVPixelFormat pixels, const zt_video_ear *ear) {
    *out = NULL;
    zt_video_pixels *p = calloc(1, sizeof *p);
    if (!p) return ZT_EMEMORY;
    p->layout = av_pix_fmt_desc_get(pixels);
    p->pixels = pixels;
    p->view = format->view;
    p->is_rgb = p->layout->flags & AV_PIX_FMT_FLAG_RGB;
    p->is_deep = p->layout->comp[0].depth > 8;
    p->has_alpha = p->layout->flags & AV_PIX_FMT_FLAG_ALPHA;
    zt_status status = open_all(p, format, ear);
    if (status == ZT_OK)
        *out = p;
    else
        zt_video_pixels_close(&p);
    return status;
}

void zt_video_pixels_close(zt_video_pixels **converter) {
    zt_video_pixels *p = *converter;
    if (!p) return;
    sws_freeContext(p->converter);
    av_frame_free(&p->rgb);
    free(p->row.pixels);
    free(p->line);
    free(p->chroma);
    free(p);
    *converter = NULL;
}

/* Colours come multiplied by alpha; files hold them without. */
static void divide_by_alpha(float *row, const float *pixels, int width) {
    for (int i = 0; i < 4 * width; i++) {
        float alpha = pixels[i / 4 * 4 + 3];
        row[i] = alpha > 0 && alpha < 1 && i % 4 < 3 ? pixels[i] / alpha : pixels[i];
    }
}

/* One row of R'G'B' and alpha, which is linear in all views. */
static void develop_alpha(zt_video_pixels *p, const float *pixels, uint8_t *out) {
    int width = p->row.width, max = p->is_deep ? 65535 : 255;
    uint16_t *deep = (uint16_t *)out;
    divide_by_alpha(p->row.pixels, pixels, width);
    if (p->is_deep)
        zt_develop_rgb16(p->line, 0, &p->row, p->view, 0, 1);
    else
        zt_develop_rgb8((uint8_t *)p->line, 0, &p->row, p->view, 0, 1);
    for (int i = 0; i < 4 * width; i++) {
        int from = i / 4 * 3 + i % 4;
        double alpha = zt_develop_value((double)pixels[i / 4 * 4 + 3], ZT_VIEW_RAW);
        int value = i % 4 == 3   ? (int)(max * alpha + 0.5)
                    : p->is_deep ? p->line[from]
                                 : ((uint8_t *)p->line)[from];
        if (p->is_deep)
            deep[i] = (uint16_t)value;
        else
            out[i] = (uint8_t)value;
    }
}

static void develop(zt_video_pixels *p, const zt_image *image) {
    size_t stride = (size_t)p->rgb->linesize[0];
    if (!p->has_alpha && p->is_deep)
        zt_develop_rgb16((uint16_t *)(void *)p->rgb->data[0], stride, image, p->view, 0,
                         image->height);
    else if (!p->has_alpha)
        zt_develop_rgb8(p->rgb->data[0], stride, image, p->view, 0, image->height);
    for (int y = 0; p->has_alpha && y < image->height; y++)
        develop_alpha(p, image->pixels + (size_t)y * (size_t)image->width * 4,
                      p->rgb->data[0] + (size_t)y * stride);
}

/* A line of one component; those of more than 8 bits fill the low ones of 16. */
static void put_line(AVFrame *frame, const AVPixFmtDescriptor *layout, int y, int component,
                     const uint16_t *line) {
    const AVComponentDescriptor *c = &layout->comp[component];
    uint8_t *at = frame->data[c->plane] + (ptrdiff_t)y * frame->linesize[c->plane] + c->offset;
    bool big_endian = layout->flags & AV_PIX_FMT_FLAG_BE;
    for (int x = 0; x < frame->width; x++, at += c->step)
        if (c->depth <= 8)
            *at = (uint8_t)line[x];
        else if (big_endian)
            AV_WB16(at, line[x]);
        else
            AV_WL16(at, line[x]);
}

/* R'G'B' in another layout: each number the nearest of the format's. */
static void lay_out(zt_video_pixels *p, AVFrame *frame) {
    int component_count = p->has_alpha ? 4 : 3, width = frame->width;
    for (int y = 0; y < frame->height; y++) {
        const uint8_t *row = p->rgb->data[0] + (ptrdiff_t)y * p->rgb->linesize[0];
        const uint16_t *deep = (const uint16_t *)(const void *)row;
        for (int c = 0; c < component_count; c++) {
            uint32_t max = (1u << p->layout->comp[c].depth) - 1;
            for (int x = 0; x < width; x++) {
                int from = x * component_count + c;
                p->line[x] =
                    p->is_deep ? (uint16_t)((deep[from] * max + 32767) / 65535) : row[from];
            }
            put_line(frame, p->layout, y, c, p->line);
        }
    }
}

zt_status zt_video_pixels_convert(AVFrame **frame, zt_video_pixels *p, const zt_image *image,
                                  const zt_video_ear *ear) {
    develop(p, image);
    zt_status status = make_frame(frame, image->width, image->height, p->pixels, ear);
    if (status == ZT_OK && p->converter) {
        const uint8_t *const *rgb = (const uint8_t *const *)p->rgb->data;
        int error = sws_scale(p->converter, rgb, p->rgb->linesize, 0, image->height,
                              (*frame)->data, (*frame)->linesize);
        if (error < 0) status = zt_libav_refuse(ear, error);
    } else if (status == ZT_OK && p->is_rgb) {
        lay_out(p, *frame);
    } else if (status == ZT_OK) {
        zt_video_ycbcr(*frame, p->rgb, p->chroma);
    }
    if (status == ZT_OK)
        tag_frame(p, *frame);
    else
        av_frame_free(frame);
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
