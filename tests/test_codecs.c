/* Every codec in every container that takes it, with each pixel format: what was written is
 * read again, decoded whole, and its colours compared with the test card's, by formulas of this
 * file; the same film is the same file. */
#include <malloc.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <libavutil/imgutils.h>

#include "cards.h"

static const way ways[] = {
    {"mp4", "h264", "yuv420p", AV_CODEC_ID_H264, NULL, NULL, MKTAG('a', 'v', 'c', '1'), 2.5},
    {"mp4", "h264", "yuv420p10le", AV_CODEC_ID_H264, NULL, NULL, 0, 1.5},
    {"mov", "h264", "yuv422p", AV_CODEC_ID_H264, NULL, NULL, MKTAG('a', 'v', 'c', '1'), 2.5},
    {"mkv", "h264", "yuv422p10le", AV_CODEC_ID_H264, NULL, NULL, 0, 1.5},
    {"mkv", "h264", "yuv444p", AV_CODEC_ID_H264, NULL, NULL, 0, 2.5},
    {"mp4", "h264", "yuv444p10le", AV_CODEC_ID_H264, NULL, NULL, 0, 1.5},
    {"mp4", "h265", "yuv420p", AV_CODEC_ID_HEVC, NULL, NULL, MKTAG('h', 'v', 'c', '1'), 3.5},
    {"mov", "h265", "yuv420p10le", AV_CODEC_ID_HEVC, NULL, NULL, MKTAG('h', 'v', 'c', '1'), 3},
    {"mkv", "h265", "yuv422p", AV_CODEC_ID_HEVC, NULL, NULL, 0, 3.5},
    {"mkv", "h265", "yuv422p10le", AV_CODEC_ID_HEVC, NULL, NULL, 0, 3},
    {"mkv", "h265", "yuv444p", AV_CODEC_ID_HEVC, NULL, NULL, 0, 3.5},
    {"mkv", "h265", "yuv444p10le", AV_CODEC_ID_HEVC, NULL, NULL, 0, 3},
    {"mp4", "av1", "yuv420p", AV_CODEC_ID_AV1, NULL, NULL, MKTAG('a', 'v', '0', '1'), 3.5},
    {"mkv", "av1", "yuv420p", AV_CODEC_ID_AV1, NULL, NULL, 0, 3.5},
    {"webm", "av1", "yuv420p10le", AV_CODEC_ID_AV1, NULL, NULL, 0, 3},
    {"webm", "vp9", "yuv420p", AV_CODEC_ID_VP9, NULL, NULL, 0, 2.5},
    {"mp4", "vp9", "yuv420p10le", AV_CODEC_ID_VP9, NULL, NULL, MKTAG('v', 'p', '0', '9'), 2},
    {"mkv", "vp9", "yuv422p", AV_CODEC_ID_VP9, NULL, NULL, 0, 2.5},
    {"webm", "vp9", "yuv422p10le", AV_CODEC_ID_VP9, NULL, NULL, 0, 2.5},
    {"webm", "vp9", "yuv444p", AV_CODEC_ID_VP9, NULL, NULL, 0, 2.5},
    {"webm", "vp9", "yuv444p10le", AV_CODEC_ID_VP9, NULL, NULL, 0, 2.5},
    {"webm", "vp9", "yuva420p", AV_CODEC_ID_VP9, NULL, "libvpx-vp9", 0, 2.5},
    {"mkv", "vp9", "yuva420p", AV_CODEC_ID_VP9, NULL, "libvpx-vp9", 0, 2.5},
    {"mov", "prores", "yuv422p10le", AV_CODEC_ID_PRORES, NULL, NULL, MKTAG('a', 'p', 'c', 'h'),
     0.8},
    {"mkv", "prores", "yuv422p10le", AV_CODEC_ID_PRORES, NULL, NULL, 0, 0.8},
    {"mov", "prores4444", "yuv444p10le", AV_CODEC_ID_PRORES, "yuv444p12le", NULL,
     MKTAG('a', 'p', '4', 'h'), 0.8},
    {"mov", "prores4444", "yuva444p10le", AV_CODEC_ID_PRORES, "yuva444p12le", NULL,
     MKTAG('a', 'p', '4', 'h'), 0.8},
    {"mkv", "prores4444", "yuva444p10le", AV_CODEC_ID_PRORES, "yuva444p12le", NULL, 0, 0.8},
    {"mov", "dnxhr", "yuv422p10le", AV_CODEC_ID_DNXHD, NULL, NULL, MKTAG('A', 'V', 'd', 'h'),
     0.8},
    {"mkv", "dnxhr", "yuv422p", AV_CODEC_ID_DNXHD, NULL, NULL, 0, 1.6},
    {"mov", "dnxhr", "yuv444p10le", AV_CODEC_ID_DNXHD, NULL, NULL, MKTAG('A', 'V', 'd', 'h'),
     0.8},
    {"mkv", "ffv1", "gbrp10le", AV_CODEC_ID_FFV1, NULL, NULL, 0, 0.5 * 255 / 1023 + 0.01},
    {"mkv", "ffv1", "gbrp16le", AV_CODEC_ID_FFV1, NULL, NULL, 0, 0.01},
    {"mkv", "ffv1", "bgr0", AV_CODEC_ID_FFV1, NULL, NULL, 0, 0.501},
    {"mkv", "ffv1", "bgra", AV_CODEC_ID_FFV1, NULL, NULL, 0, 0.501},
    {"mkv", "ffv1", "gbrap16le", AV_CODEC_ID_FFV1, NULL, NULL, 0, 0.01},
    {"mkv", "ffv1", "yuv420p", AV_CODEC_ID_FFV1, NULL, NULL, 0, 2},
    {"mkv", "ffv1", "yuv422p10le", AV_CODEC_ID_FFV1, NULL, NULL, 0, 0.4},
    {"mkv", "ffv1", "yuv444p10le", AV_CODEC_ID_FFV1, NULL, NULL, 0, 0.4},
    {"mkv", "ffv1", "yuv444p16le", AV_CODEC_ID_FFV1, NULL, NULL, 0, 0.01},
    {"mkv", "utvideo", "gbrp", AV_CODEC_ID_UTVIDEO, NULL, NULL, 0, 0.501},
    {"mkv", "utvideo", "gbrap", AV_CODEC_ID_UTVIDEO, NULL, NULL, 0, 0.501},
    {"mkv", "utvideo", "yuv420p", AV_CODEC_ID_UTVIDEO, NULL, NULL, 0, 2},
    {"mkv", "utvideo", "yuv422p", AV_CODEC_ID_UTVIDEO, NULL, NULL, 0, 2},
    {"mkv", "utvideo", "yuv444p", AV_CODEC_ID_UTVIDEO, NULL, NULL, 0, 2},
    {"gif", "gif", "pal8", AV_CODEC_ID_GIF, "bgra", NULL, 0, 4},
    {"gif", "gif", "bgra", AV_CODEC_ID_GIF, "bgra", NULL, 0, 4},
    {"apng", "apng", "rgb24", AV_CODEC_ID_APNG, NULL, NULL, 0, 0.501},
    {"apng", "apng", "rgba", AV_CODEC_ID_APNG, NULL, NULL, 0, 0.501},
    {"apng", "apng", "rgb48be", AV_CODEC_ID_APNG, NULL, NULL, 0, 0.01},
    {"apng", "apng", "rgba64be", AV_CODEC_ID_APNG, NULL, NULL, 0, 0.01},
};
enum { WAY_COUNT = sizeof ways / sizeof *ways };

/* Component c of a pixel, as it is stored. */
static double component(const AVFrame *frame, int c, int x, int y) {
    const AVPixFmtDescriptor *layout = av_pix_fmt_desc_get(frame->format);
    bool is_chroma = c == 1 || c == 2;
    uint16_t value;
    av_read_image_line(&value, (const uint8_t **)frame->data, frame->linesize, layout,
                       is_chroma ? x >> layout->log2_chroma_w : x,
                       is_chroma ? y >> layout->log2_chroma_h : y, c, 1, 0);
    return value;
}

/* R'G'B' and alpha of 0..1: as they are, or by ITU-R BT.709-6, items 3.2 to 3.5. */
static void pixel_of(double rgba[4], const AVFrame *frame, int x, int y) {
    const AVPixFmtDescriptor *layout = av_pix_fmt_desc_get(frame->format);
    int depth = layout->comp[0].depth;
    double max = (1 << depth) - 1, step = 1 << (depth - 8);
    double a = component(frame, 0, x, y), b = component(frame, 1, x, y),
           c = component(frame, 2, x, y);
    rgba[3] = layout->nb_components > 3 ? component(frame, 3, x, y) / max : 1;
    if (layout->flags & AV_PIX_FMT_FLAG_RGB) {
        rgba[0] = a / max, rgba[1] = b / max, rgba[2] = c / max;
        return;
    }
    double luma = (a / step - 16) / 219, cb = (b / step - 128) / 224,
           cr = (c / step - 128) / 224;
    rgba[0] = luma + 1.5748 * cr;
    rgba[2] = luma + 1.8556 * cb;
    rgba[1] = (luma - 0.2126 * rgba[0] - 0.0722 * rgba[2]) / 0.7152;
    for (int i = 0; i < 3; i++) rgba[i] = fmin(1, fmax(0, rgba[i]));
}

/* The middles of all patches are in the mean what was sent, and each pixel of them but for that
 * much more, as dithering may add a step to each of its components. */
static void assert_patch(const AVFrame *frame, const way *w, const char *path, int f, int p) {
    const int margin = 16;
    double alpha = alpha_of(w, p), sums[4] = {0};
    int count = 0;
    for (int y = margin; y < CARD - margin; y += 3)
        for (int x = margin; x < CARD - margin; x += 3, count++) {
            double found[4];
            pixel_of(found, frame, p % PATCH_COLUMNS * CARD + x, p / PATCH_COLUMNS * CARD + y);
            for (int c = 0; c < 4; c++) {
                double sent =
                    c == 3 ? alpha
                           : display_value((double)patches[p][c] * (alpha > 0), format.view);
                double off = 255 * (found[c] - sent);
                sums[c] += off;
                if (alpha == 0 && c < 3) continue; /* nobody sees it */
                if (fabs(off) > w->tolerance + 1.5)
                    fail_msg("%s %s: frame %d, patch %d, channel %d: off by %g of 255", path,
                             w->pixels, f, p, c, off);
            }
        }
    for (int c = alpha == 0 ? 3 : 0; c < 4; c++)
        if (fabs(sums[c]) > w->tolerance * count)
            fail_msg("%s %s: frame %d, patch %d, channel %d: off by %g of 255 in the mean",
                     path, w->pixels, f, p, c, sums[c] / count);
}

static void assert_card(const AVFrame *frame, const way *w, const char *path, int f) {
    for (int p = 0; p < PATCH_COUNT; p++) assert_patch(frame, w, path, f, p);
}

/* The bar stands where frame f has it: frames come in their order. */
static void assert_order(const AVFrame *frame, const char *path, int f) {
    double here[4], before[4];
    pixel_of(here, frame, 4 * f + 2, HEIGHT - 3);
    pixel_of(before, frame, 4 * f + 10, HEIGHT - 3);
    if (here[1] < 0.7 || before[1] * before[3] > 0.5)
        fail_msg("%s: frame %d is another one", path, f);
}

static void assert_tags(const AVStream *stream, const way *w, bool is_rgb) {
    const AVCodecParameters *p = stream->codecpar;
    bool holds_tags = w->id != AV_CODEC_ID_GIF && w->id != AV_CODEC_ID_APNG;
    assert_int_equal(p->codec_id, w->id);
    assert_int_equal(p->width, WIDTH);
    assert_int_equal(p->height, HEIGHT);
    if (w->tag) assert_int_equal(p->codec_tag, w->tag);
    if (holds_tags) {
        assert_int_equal(p->color_primaries, AVCOL_PRI_BT709);
        assert_int_equal(p->color_trc, is_rgb ? AVCOL_TRC_IEC61966_2_1 : AVCOL_TRC_BT709);
        assert_int_equal(p->color_space, is_rgb ? AVCOL_SPC_RGB : AVCOL_SPC_BT709);
        assert_int_equal(p->color_range, is_rgb ? AVCOL_RANGE_JPEG : AVCOL_RANGE_MPEG);
    }
    if (w->id != AV_CODEC_ID_GIF) { /* whose last frame lasts 4 hundredths */
        double rate = av_q2d(stream->avg_frame_rate);
        if (fabs(rate - 24) > 0.03) fail_msg("%s: rate %g", w->codec, rate);
    }
}

/* Each codec, container and pixel format: all frames, in order, in colours, with alpha, tagged.
 */
static void all_ways(void **state) {
    (void)state;
    for (int i = 0; i < WAY_COUNT; i++) {
        const way *w = &ways[i];
        char path[64];
        snprintf(path, sizeof path, "ways/%s.%s", w->codec, w->ending);
        write_way(path, w);
        film m = film_open(path);
        AVFrame *frames[FRAMES_MAX] = {0};
        assert_int_equal(decode_by(w->decoder, &m, 0, m.packet_count, frames), FRAME_COUNT);
        const char *decoded = w->decoded ? w->decoded : w->pixels;
        for (int f = 0; f < FRAME_COUNT; f++) {
            assert_string_equal(av_get_pix_fmt_name(frames[f]->format), decoded);
            assert_card(frames[f], w, path, f);
            assert_order(frames[f], path, f);
            AVRational base = m.stream->time_base;
            double time = (double)frames[f]->pts * av_q2d(base);
            double tick = w->id == AV_CODEC_ID_GIF ? 0.01 : 0.001;
            if (fabs(time - f / 24.0) > 0.501 * tick)
                fail_msg("%s: frame %d at %g s", path, f, time);
        }
        assert_tags(m.stream, w,
                    av_pix_fmt_desc_get(frames[0]->format)->flags & AV_PIX_FMT_FLAG_RGB);
        free_frames(frames, FRAME_COUNT);
        film_close(&m);
    }
}

/* The same film is the same file, also where the process may use only one core, and whatever
 * memory held before. */
static void same_bits(void **state) {
    (void)state;
    cpu_set_t all, one;
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    CPU_ZERO(&one);
    for (int core = 0; core < CPU_SETSIZE && CPU_COUNT(&one) == 0; core++)
        if (CPU_ISSET(core, &all)) CPU_SET(core, &one);
    for (int i = 0; i < WAY_COUNT; i++) {
        const way *w = &ways[i];
        if (i > 0 && strcmp(w->codec, ways[i - 1].codec) == 0) continue;
        char a[64], b[64];
        snprintf(a, sizeof a, "bits/a.%s", w->ending);
        snprintf(b, sizeof b, "bits/b.%s", w->ending);
        mallopt(M_PERTURB, 85);
        write_way(a, w);
        mallopt(M_PERTURB, 170);
        assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
        write_way(b, w);
        mallopt(M_PERTURB, 0);
        assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
        if (!same_files(a, b)) fail_msg("%s: other bits on one core", w->codec);
    }
}

/* R'G'B' says which transfer function its numbers have; each film names its view in words. */
static void views_are_tagged(void **state) {
    (void)state;
    const struct {
        const char *name;
        enum AVColorTransferCharacteristic transfer;
    } views[] = {{"view raw", AVCOL_TRC_UNSPECIFIED},
                 {"view srgb", AVCOL_TRC_IEC61966_2_1},
                 {"view rec709", AVCOL_TRC_BT709},
                 {"view filmic", AVCOL_TRC_IEC61966_2_1}};
    const zt_output_option lossless[] = {
        {"codec", "ffv1"}, {"pixel-format", "bgr0"}, {NULL, NULL}};
    for (int view = 0; view < ZT_VIEW_COUNT; view++) {
        zt_output_format seen = format;
        seen.view = (zt_view)view;
        zt_output *output = open_movie_by("view.mkv", &seen, lossless);
        zt_image *image = picture(WIDTH, HEIGHT, 1);
        assert_int_equal(zt_output_write(output, image, 0), ZT_OK);
        zt_image_free(&image);
        close_movie(&output);
        film m = film_open("view.mkv");
        assert_int_equal(m.stream->codecpar->color_trc, views[view].transfer);
        const AVDictionaryEntry *told =
            av_dict_get(m.container->metadata, "description", NULL, 0);
        assert_non_null(told);
        assert_non_null(strstr(told->value, views[view].name));
        film_close(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_ways),
        cmocka_unit_test(views_are_tagged),
        cmocka_unit_test(same_bits),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
