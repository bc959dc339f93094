/* Every codec in every container that takes it, with each pixel format: what was written is
 * read again, decoded whole, and its colours compared with the test card's, by formulas of this
 * file. Options, refusals, sound, metadata; and that the check finds what is wrong. */
#include <inttypes.h>
#include <malloc.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <libavutil/imgutils.h>
#include <libavutil/pixdesc.h>

#include "files.h"
#include "movies.h"

#include "encode/video_check.h"
#include "encode/video_pixels.h"

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

/* FFmpeg says that of all palettes; ours is opaque. */
static bool has_alpha(const way *w) {
    if (strcmp(w->pixels, "pal8") == 0) return false;
    return av_pix_fmt_desc_get(av_get_pix_fmt(w->pixels))->flags & AV_PIX_FMT_FLAG_ALPHA;
}

/* How much of a patch is there where the way knows alpha; GIF knows only all and nothing. */
static double alpha_of(const way *w, int patch) {
    if (!has_alpha(w) || patch % 3 != 0) return 1;
    return w->id == AV_CODEC_ID_GIF ? 0 : 0.5;
}

/* The card of frame f: its patches, of which those with alpha are multiplied by it; and, so
 * that frames differ, a white bar in the margin of the last row that moves on by four pixels.
 */
static zt_image *card_of(const way *w, int f) {
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

static void write_way(const char *path, const way *w) {
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

/* What makes no sense is refused before the first frame, with what there is instead; nothing is
 * left. */
static void refusals(void **state) {
    (void)state;
    const struct {
        const char *target, *name, *value, *words;
        int width, height, rate;
    } cases[] = {
        {"a.mp4", "codec", "h266", "no codec \"h266\" for .mp4; did you mean \"h264\"?", 64, 64,
         24},
        {"a.mp4", "codec", "theora", "there are h264 h265 av1 vp9", 64, 64, 24},
        {"a.mp4", "codec", "prores", "prores does not go into .mp4, but into .mov .mkv", 64, 64,
         24},
        {"a.gif", "codec", "h264", "h264 does not go into .gif", 64, 64, 24},
        {"a.webm", "codec", "h264", "h264 does not go into .webm, but into .mp4 .mov .mkv", 64,
         64, 24},
        {"a.mp4", "pixel-format", "yuv420p12",
         "no pixel format \"yuv420p12\" for h264; did you mean", 64, 64, 24},
        {"a.mp4", "pixel-format", "rgb24", "there are yuv420p yuv420p10le", 64, 64, 24},
        {"a.mp4", "pixel-format", "", "there are yuv420p yuv420p10le", 64, 64, 24},
        {"a.mp4", "crf", "52", "from 0 (best) to 51", 64, 64, 24},
        {"a.mp4", "crf", "-1", "from 0 (best) to 51", 64, 64, 24},
        {"a.mp4", "crf", "good", "from 0 (best) to 51", 64, 64, 24},
        {"a.webm", "crf", "64", "from 0 (best) to 63", 64, 64, 24},
        {"a.gif", "crf", "10", "gif has no crf", 64, 64, 24},
        {"a.apng", "bitrate", "1M", "apng takes no bitrate", 64, 64, 24},
        {"a.mp4", "bitrate", "fast", "such as 8M or 800k", 64, 64, 24},
        {"a.mp4", "bitrate", "0", "such as 8M or 800k", 64, 64, 24},
        {"a.mp4", "bitrate", "1e30", "such as 8M or 800k", 64, 64, 24},
        {"a.mp4", "preset", "fats", "did you mean \"fast\"?", 64, 64, 24},
        {"a.webm", "preset", "9", "there are 8 7 6 5 4 3 2 1 0", 64, 64, 24},
        {"a.gif", "preset", "fast", "gif has no presets", 64, 64, 24},
        {"a.mp4", "encoder-option", "crf", "must be a name and a value", 64, 64, 24},
        {"a.mp4", "encoder-option", "=3", "must be a name and a value", 64, 64, 24},
        {"a.mp4", "encoder-option", "aqmode=1",
         "no encoder-option \"aqmode\" for libx264; did you mean \"aq-mode\"?", 64, 64, 24},
        {"a.mp4", "encoder-option", "aq-mode=seven", "encoder-option aq-mode=seven: ", 64, 64,
         24},
        {"a.mp4", "audio", "none.wav", "its sound, none.wav: No such file", 64, 64, 24},
        {"a.gif", "title", "x", "at most 50 frames a second", 64, 64, 60},
        {"a.mkv", "codec", "dnxhr", "dnxhr has at least 256x120 pixels, and 64x64 is less", 64,
         64, 24},
        {"a.webm", "codec", "av1", "av1 has at least 64x64", 62, 64, 24},
        {"a.mov", "codec", "prores", "an even width, and 65x64 is not; 64x64 would be", 65, 64,
         24},
        {"a.mp4", "title", "x", "an even width and height, and 64x63 is not; 64x62 would be",
         64, 63, 24},
        {"a.mp4", "codec", "H264", "did you mean \"h264\"?", 64, 64, 24},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char target[64];
        snprintf(target, sizeof target, "no/%s", cases[i].target);
        const zt_output_option options[] = {{cases[i].name, cases[i].value}, {NULL, NULL}};
        zt_output_format wrong = {.width = cases[i].width,
                                  .height = cases[i].height,
                                  .rate = {cases[i].rate, 1},
                                  .view = ZT_VIEW_SRGB};
        heard h;
        zt_output *output;
        assert_int_not_equal(zt_output_open(&output, target, &wrong, options, listener_of(&h)),
                             ZT_OK);
        assert_null(output);
        assert_told(&h, cases[i].words);
        if (exists("no")) assert_int_equal(entry_count("no"), 0);
    }
    const zt_output_option both[] = {{"crf", "20"}, {"bitrate", "1M"}, {NULL, NULL}};
    heard h;
    zt_output *output;
    assert_int_equal(zt_output_open(&output, "no/a.mp4", &format, both, listener_of(&h)),
                     ZT_EARGUMENT);
    assert_told(&h, "crf and bitrate do not go together");
}

/* Transparent films have alpha without being asked, with no fewer bits than else, where codec
 * and container can; where not, that is said, and refused if it was asked for. */
static void alpha_by_itself(void **state) {
    (void)state;
    static const struct {
        const char *target, *codec, *pixels, *opaque_pixels;
    } cases[] = {{"a.mov", "prores4444", "yuva444p10le", "yuv444p10le"},
                 {"a.webm", "vp9", "yuva420p", "yuv420p"},
                 {"a.mkv", "vp9", "yuva420p", "yuv420p"},
                 {"a.mp4", "vp9", "yuv420p", "yuv420p"},
                 {"a.mkv", "ffv1", "gbrap16le", "gbrp10le"},
                 {"a.apng", "apng", "rgba", "rgb24"},
                 {"a.gif", "gif", "bgra", "pal8"},
                 {"a.mp4", "h264", "yuv420p", "yuv420p"},
                 {"a.mov", "prores", "yuv422p10le", "yuv422p10le"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const zt_output_option options[] = {{"codec", cases[i].codec}, {NULL, NULL}};
        for (int transparent = 0; transparent < 2; transparent++) {
            zt_output_format own = format;
            zt_video_choice choice;
            heard h;
            const zt_video_ear ear = {cases[i].target, listener_of(&h)};
            own.transparent = transparent;
            assert_int_equal(zt_video_choose(&choice, &own, options, &ear), ZT_OK);
            assert_string_equal(av_get_pix_fmt_name(choice.pixels),
                                transparent ? cases[i].pixels : cases[i].opaque_pixels);
            bool lost = transparent && strcmp(cases[i].pixels, cases[i].opaque_pixels) == 0;
            assert_true((strstr(h.text, "what is transparent becomes black") != NULL) == lost);
        }
    }
    const zt_output_option asked[] = {
        {"codec", "vp9"}, {"pixel-format", "yuva420p"}, {NULL, NULL}};
    zt_video_choice choice;
    heard h;
    const zt_video_ear ear = {"a.mp4", listener_of(&h)};
    assert_int_equal(zt_video_choose(&choice, &format, asked, &ear), ZT_EUNSUPPORTED);
    assert_told(&h, ".mp4 has no place for the alpha of VP9");
}

/* A film for which there is clearly no room is refused before its first frame. */
static void no_room(void **state) {
    (void)state;
    const char *const targets[] = {"room/a.mp4", "room/a.gif", "room/a.apng"};
    for (int i = 0; i < 3; i++) {
        zt_output_format endless = {.width = 3840,
                                    .height = 2160,
                                    .rate = {24, 1},
                                    .view = ZT_VIEW_SRGB,
                                    .frame_count = INT64_C(1) << 40};
        heard h;
        zt_output *output;
        assert_int_equal(zt_output_open(&output, targets[i], &endless, NULL, listener_of(&h)),
                         ZT_EFILE);
        assert_told(&h, "GB, and the disk has room for");
        assert_int_equal(entry_count("room"), 0);
    }
}

static bool file_has(const char *path, const char *text) {
    size_t size;
    char *bytes = file_bytes(path, &size);
    bool found = memmem(bytes, size, text, strlen(text)) != NULL;
    free(bytes);
    return found;
}

static int64_t file_size(const char *path) {
    struct stat s;
    assert_int_equal(stat(path, &s), 0);
    return s.st_size;
}

/* Options reach the encoder: x264 writes its own into the stream; sizes follow quality. */
static void options_count(void **state) {
    (void)state;
    const zt_output_option own[] = {{"encoder-option", "x264-params=me=tesa:subme=9"},
                                    {"encoder-option", "refs=2"},
                                    {"crf", "23.5"},
                                    {NULL, NULL}};
    write_movie_by("own.mp4", &format, own, 10);
    assert_true(file_has("own.mp4", "me=tesa") && file_has("own.mp4", "subme=9"));
    assert_true(file_has("own.mp4", "ref=2") && file_has("own.mp4", "crf=23.5"));
    const char *const files[] = {"q.mp4", "q.mkv", "q.webm"};
    const char *const codecs[] = {"h264", "h265", "vp9"};
    for (int i = 0; i < 3; i++) {
        const zt_output_option fine[] = {{"codec", codecs[i]}, {"crf", "10"}, {NULL, NULL}},
                               rough[] = {{"codec", codecs[i]}, {"crf", "40"}, {NULL, NULL}},
                               slow[] = {
                                   {"codec", codecs[i]}, {"bitrate", "150k"}, {NULL, NULL}};
        write_movie_by(files[i], &format, fine, 24);
        int64_t fine_size = file_size(files[i]);
        write_movie_by(files[i], &format, rough, 24);
        int64_t rough_size = file_size(files[i]);
        write_movie_by(files[i], &format, slow, 24);
        if (rough_size * 2 > fine_size)
            fail_msg("%s: %" PRId64 " and %" PRId64, files[i], fine_size, rough_size);
        /* A second at 150 kbit, within a factor of three for so short a film. */
        assert_in_range(file_size(files[i]), 150000 / 8 / 3, 3 * 150000 / 8);
    }
}

/* Title, comment, how it was encoded and how it was rendered are in the container. */
static void metadata(void **state) {
    (void)state;
    const char *const files[] = {"meta.mp4", "meta.mov", "meta.mkv", "meta.webm"};
    const zt_output_option options[] = {
        {"title", "für – 日本"}, {"comment", "a; b = \"c\""}, {"crf", "21"}, {NULL, NULL}};
    const char *const rendered[] = {"synopsis", "encoder", "settings", "settings"};
    zt_output_format told = format;
    told.settings = "{\"zoetrope\": 1, \"samples\": 4}";
    for (int i = 0; i < 4; i++) {
        write_movie_by(files[i], &told, options, 3);
        film m = film_open(files[i]);
        AVDictionary *tags = m.container->metadata;
        const char *settings = i == 1 ? "encoder" : "description";
        assert_string_equal(av_dict_get(tags, "title", NULL, 0)->value, options[0].value);
        assert_string_equal(av_dict_get(tags, "comment", NULL, 0)->value, options[1].value);
        assert_non_null(av_dict_get(tags, settings, NULL, 0));
        assert_non_null(
            strstr(av_dict_get(tags, settings, NULL, 0)->value, "yuv420p, crf 21, preset "));
        const AVDictionaryEntry *how = av_dict_get(tags, rendered[i], NULL, 0);
        if (!how) fail_msg("%s has no %s", files[i], rendered[i]);
        assert_non_null(strstr(how->value, told.settings));
        film_close(&m);
    }
}

/* A tone: 16 bits, two channels, of `seconds`; the right one is silent. */
static void write_wave(const char *path, double seconds, int rate) {
    uint32_t count = (uint32_t)(seconds * rate), bytes = count * 4;
    struct {
        char riff[4];
        uint32_t size;
        char wave[8];
        uint32_t head;
        uint16_t kind, channels;
        uint32_t rate, byte_rate;
        uint16_t block, bits;
        char data[4];
        uint32_t bytes;
    } head = {"RIFF",
              36 + bytes,
              {'W', 'A', 'V', 'E', 'f', 'm', 't', ' '},
              16,
              1,
              2,
              (uint32_t)rate,
              (uint32_t)rate * 4,
              4,
              16,
              {'d', 'a', 't', 'a'},
              bytes};
    memcpy(head.riff, "RIFF", 4);
    FILE *file = fopen(path, "wb");
    assert_int_equal(fwrite(&head, 44, 1, file), 1);
    for (uint32_t i = 0; i < count; i++) {
        int16_t sample[2] = {(int16_t)(20000 * sin(2 * 3.14159265358979 * 440 * i / rate)), 0};
        fwrite(sample, 4, 1, file);
    }
    fclose(file);
}

/* What is heard of a film: how many samples, when they begin, and how often the left channel
 * crosses zero upwards. */
static void listen_to(const char *path, enum AVCodecID *id, double *seconds, int *crossings) {
    AVFormatContext *container = NULL;
    assert_int_equal(avformat_open_input(&container, path, NULL, NULL), 0);
    assert_true(avformat_find_stream_info(container, NULL) >= 0);
    assert_int_equal(container->nb_streams, 2);
    AVStream *stream = container->streams[1];
    *id = stream->codecpar->codec_id;
    const AVCodec *codec = avcodec_find_decoder(*id);
    AVCodecContext *decoder = avcodec_alloc_context3(codec);
    avcodec_parameters_to_context(decoder, stream->codecpar);
    decoder->pkt_timebase = stream->time_base;
    assert_int_equal(avcodec_open2(decoder, codec, NULL), 0);
    AVPacket *packet = av_packet_alloc();
    AVFrame *frame = av_frame_alloc();
    int64_t count = 0;
    double last = 0;
    *crossings = 0;
    for (bool more = true; more;) {
        more = av_read_frame(container, packet) >= 0;
        if (more && packet->stream_index != 1) {
            av_packet_unref(packet);
            continue;
        }
        avcodec_send_packet(decoder, more ? packet : NULL);
        av_packet_unref(packet);
        while (avcodec_receive_frame(decoder, frame) >= 0) {
            if (count == 0) /* at the beginning, but for what is cut away */
                assert_true(fabs((double)frame->pts * av_q2d(stream->time_base)) < 0.03);
            bool planar = av_sample_fmt_is_planar(frame->format);
            int channels = planar ? 1 : frame->ch_layout.nb_channels;
            for (int i = 0; i < frame->nb_samples; i++, count++) {
                double now = frame->format == AV_SAMPLE_FMT_S16
                                 ? ((int16_t *)(void *)frame->data[0])[i * channels] / 32768.0
                                 : (double)((float *)(void *)frame->data[0])[i * channels];
                if (fabs(now) < 0.05) continue;
                *crossings += last < 0 && now > 0;
                last = now;
            }
        }
    }
    *seconds = (double)count / decoder->sample_rate;
    av_frame_free(&frame);
    av_packet_free(&packet);
    avcodec_free_context(&decoder);
    avformat_close_input(&container);
}

/* Sound is the film's: copied where the container takes it, else encoded; cut where the film
 * ends, and over where it is over before; on the beat. */
static void sound(void **state) {
    (void)state;
    write_wave("tone.wav", 3, 44100);
    write_wave("short.wav", 0.25, 48000);
    const struct {
        const char *path, *sound;
        enum AVCodecID id;
        double seconds;
    } cases[] = {
        {"sound.mp4", "tone.wav", AV_CODEC_ID_AAC, 1},
        {"sound.mov", "tone.wav", AV_CODEC_ID_PCM_S16LE, 1},
        {"sound.mkv", "tone.wav", AV_CODEC_ID_PCM_S16LE, 1},
        {"sound.webm", "tone.wav", AV_CODEC_ID_OPUS, 1},
        {"short.mp4", "short.wav", AV_CODEC_ID_AAC, 0.25},
        {"short.mkv", "short.wav", AV_CODEC_ID_PCM_S16LE, 0.25},
        {"again.mp4", "sound.mp4", AV_CODEC_ID_AAC, 1},
        {"again.webm", "sound.webm", AV_CODEC_ID_OPUS, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const zt_output_option options[] = {{"audio", cases[i].sound}, {NULL, NULL}};
        write_movie_by(cases[i].path, &format, options, 24);
        enum AVCodecID id;
        double seconds;
        int crossings;
        listen_to(cases[i].path, &id, &seconds, &crossings);
        assert_int_equal(id, cases[i].id);
        /* To the sample where it is one by one; else to a packet. */
        double packet = id == AV_CODEC_ID_PCM_S16LE ? 0.0001 : 0.05;
        if (fabs(seconds - cases[i].seconds) > packet)
            fail_msg("%s: %g s of sound", cases[i].path, seconds);
        if (fabs(crossings - 440 * cases[i].seconds) > 22)
            fail_msg("%s: %d periods", cases[i].path, crossings);
        film m = film_open(cases[i].path);
        assert_int_equal(m.packet_count, 24);
        assert_int_equal(m.stream->start_time, 0);
        film_close(&m);
    }
    /* Stills and GIFs have none, which is no mistake. */
    const zt_output_option options[] = {{"audio", "tone.wav"}, {NULL, NULL}};
    write_movie_by("silent.gif", &format, options, 2);
    write_movie_by("silent.####.png", &format, options, 2);
}

/* A film of the given frames, checked against what is expected. */
static zt_status check_film(const char *path, zt_video_expected *expected, const char *words) {
    heard h;
    zt_video_ear ear = {path, listener_of(&h)};
    double psnr;
    zt_status status = zt_video_check(&psnr, path, expected, &ear);
    if (words) assert_told(&h, words);
    if (!words && status != ZT_OK) fail_msg("%s", h.text);
    return status;
}

static uint32_t box_size(const char *box) {
    const uint8_t *b = (const uint8_t *)box;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

/* The same boxes, but moov at the end. */
static void move_moov(const char *from, const char *to) {
    size_t size;
    char *bytes = file_bytes(from, &size), *moov = bytes;
    while (memcmp(moov + 4, "moov", 4) != 0) moov += box_size(moov);
    uint32_t length = box_size(moov);
    FILE *file = fopen(to, "wb");
    fwrite(bytes, 1, (size_t)(moov - bytes), file);
    fwrite(moov + length, 1, size - (size_t)(moov - bytes) - length, file);
    fwrite(moov, 1, length, file);
    fclose(file);
    free(bytes);
}

/* The check passes what is right and finds each thing that is wrong: a frame too many or too
 * few, another rate, size, codec, tag, another picture, a shorter file, moov behind mdat. */
static void check_finds(void **state) {
    (void)state;
    const way *w = &ways[0];
    write_way("checked.mp4", w);
    heard h;
    zt_video_ear ear = {"checked.mp4", listener_of(&h)};
    zt_video_choice choice, other;
    assert_int_equal(zt_video_choose(&choice, &format, NULL, &ear), ZT_OK);
    zt_video_pixels *pixels;
    assert_int_equal(zt_video_pixels_open(&pixels, &format, choice.pixels, &ear), ZT_OK);
    AVFrame *first, *last, *grey;
    zt_image *card = card_of(w, 0), *black;
    assert_int_equal(zt_video_pixels_convert(&first, pixels, card, &ear), ZT_OK);
    zt_image_free(&card);
    card = card_of(w, FRAME_COUNT - 1);
    assert_int_equal(zt_video_pixels_convert(&last, pixels, card, &ear), ZT_OK);
    zt_image_free(&card);
    assert_int_equal(zt_image_create(&black, WIDTH, HEIGHT), ZT_OK);
    assert_int_equal(zt_video_pixels_convert(&grey, pixels, black, &ear), ZT_OK);
    zt_image_free(&black);
    zt_video_pixels_close(&pixels);

    const zt_video_expected right = {
        .choice = &choice,
        .like = first,
        .rate = {24, 1},
        .frame_count = FRAME_COUNT,
        .samples = {{first, 0}, {NULL, 0}, {last, FRAME_COUNT - 1}}};
    zt_video_expected wrong = right;
    assert_int_equal(check_film("checked.mp4", &wrong, NULL), ZT_OK);
    wrong.frame_count = FRAME_COUNT + 1;
    assert_int_equal(check_film("checked.mp4", &wrong, "10 frames instead of 11"), ZT_EFILE);
    wrong.frame_count = FRAME_COUNT - 1;
    assert_int_equal(check_film("checked.mp4", &wrong, "where the rate has none"), ZT_EFILE);
    wrong = right;
    wrong.rate = (zt_rate){25, 1};
    assert_int_equal(check_film("checked.mp4", &wrong, "24/1 frames a second"), ZT_EFILE);
    wrong = right;
    wrong.has_sound = true;
    assert_int_equal(check_film("checked.mp4", &wrong, "no sound"), ZT_EFILE);
    wrong = right;
    wrong.samples[2].frame = grey;
    assert_int_equal(check_film("checked.mp4", &wrong, "another picture at frame 9"), ZT_EFILE);
    wrong = right;
    first->color_range = AVCOL_RANGE_JPEG;
    assert_int_equal(check_film("checked.mp4", &wrong, "colours tagged"), ZT_EFILE);
    first->color_range = AVCOL_RANGE_MPEG;
    first->width -= 2;
    assert_int_equal(check_film("checked.mp4", &wrong, "288x192 pixels instead of 286x192"),
                     ZT_EFILE);
    first->width += 2;
    const zt_output_option h265[] = {{"codec", "h265"}, {NULL, NULL}};
    assert_int_equal(zt_video_choose(&other, &format, h265, &ear), ZT_OK);
    wrong.choice = &other;
    assert_int_equal(check_film("checked.mp4", &wrong, "h264 instead of H.265"), ZT_EFILE);

    move_moov("checked.mp4", "late.mp4");
    wrong = right;
    assert_int_equal(check_film("late.mp4", &wrong, "moov not before mdat"), ZT_EFILE);
    wrong = right;
    assert_int_equal(truncate("checked.mp4", file_size("checked.mp4") - 2000), 0);
    assert_int_not_equal(check_film("checked.mp4", &wrong, "the check found"), ZT_OK);
    av_frame_free(&first);
    av_frame_free(&last);
    av_frame_free(&grey);
}

/* What was heard of closing. */
static void told_when_closed(void **state) {
    (void)state;
    heard h;
    zt_output *output;
    zt_output_format exact = format;
    exact.rate = (zt_rate){30000, 1001};
    const zt_output_option lossless[] = {{"codec", "ffv1"}, {NULL, NULL}};
    assert_int_equal(zt_output_open(&output, "told.mkv", &exact, lossless, listener_of(&h)),
                     ZT_OK);
    zt_image *image = picture(WIDTH, HEIGHT, 1);
    assert_int_equal(zt_output_write(output, image, 5), ZT_OK);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_string_equal(
        h.text, "told.mkv: 1 frame, FFV1, 30000/1001 fps, checked: the same to the bit");
    assert_int_equal(zt_output_open(&output, "told.mp4", &format, NULL, listener_of(&h)),
                     ZT_OK);
    assert_int_equal(zt_output_write(output, image, 5), ZT_OK);
    assert_int_equal(zt_output_write(output, image, 6), ZT_OK);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    double psnr = 0;
    assert_int_equal(sscanf(h.text,
                            "told.mp4: 2 frames, H.264, 24 fps, checked: PSNR %lf dB at least",
                            &psnr),
                     1);
    assert_true(psnr > 30 && psnr < 80);
    zt_image_free(&image);
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
        cmocka_unit_test(refusals),
        cmocka_unit_test(alpha_by_itself),
        cmocka_unit_test(no_room),
        cmocka_unit_test(options_count),
        cmocka_unit_test(metadata),
        cmocka_unit_test(sound),
        cmocka_unit_test(check_finds),
        cmocka_unit_test(told_when_closed),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
