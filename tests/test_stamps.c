/* Stamps: what frames of movies and checksums are is the same with them as without, whatever
 * came before; and only tiles that are new are read. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <libavutil/imgutils.h>

#include "base/hash.h"
#include "encode/video_pixels.h"
#include "image/stamps.h"
#include "sequence/sums.h"

/* No whole number of tiles either way. */
enum { WIDTH = 70, HEIGHT = 38, COLUMNS = 5, ROWS = 3, TILES = COLUMNS * ROWS, LOOKS = 4 };
enum { BYTES_MAX = 16 * WIDTH * HEIGHT };

static const zt_video_ear ear = {"a test", {0}};

/* What a tile shows under a stamp: any numbers, some of them beyond 0 .. 1. */
static void fill_tile(zt_image *image, int tile, uint64_t stamp) {
    int left = tile % COLUMNS * ZT_STAMP_SIDE, top = tile / COLUMNS * ZT_STAMP_SIDE;
    for (int y = top; y < top + ZT_STAMP_SIDE && y < HEIGHT; y++)
        for (int x = left; x < left + ZT_STAMP_SIDE && x < WIDTH; x++)
            for (int c = 0; c < 4; c++) {
                uint64_t place = (uint64_t)((y * WIDTH + x) * 4 + c);
                float number = (float)((stamp * 1543 + place * 2903) % 4093) / 4092;
                image->pixels[place] = c < 3 ? 1.2F * number - 0.1F : number;
            }
    image->stamps[tile] = stamp;
}

static zt_image *open_image(void) {
    zt_image *image;
    assert_int_equal(zt_image_create(&image, WIDTH, HEIGHT), ZT_OK);
    assert_int_equal(zt_image_add_stamps(image), ZT_OK);
    for (int i = 0; i < TILES; i++) fill_tile(image, i, 1);
    return image;
}

/* Some tiles show something else, what they showed before, or what nobody knows. */
static void change(zt_image *image) {
    for (int i = 0; i < TILES; i++) {
        if (rand() % 3 > 0) continue;
        fill_tile(image, i, (uint64_t)(1 + rand() % LOOKS));
        if (rand() % 5 == 0) image->stamps[i] = 0;
    }
}

/* ---- frames ---------------------------------------------------------------------------------
 */

static const char *const layouts[] = {"yuv420p", "yuv420p10le", "yuv422p",  "yuv444p",
                                      "gbrp",    "yuva420p",    "gbrp10le", "yuva444p10le",
                                      "bgr0",    "rgb48be",     "gbrap16le"};
enum { LAYOUT_COUNT = sizeof layouts / sizeof *layouts };

static zt_video_pixels *open_pixels(const char *layout, zt_view view) {
    const zt_output_format format = {
        .width = WIDTH, .height = HEIGHT, .rate = {24, 1}, .view = view};
    zt_video_pixels *pixels;
    assert_int_equal(zt_video_pixels_open(&pixels, &format, av_get_pix_fmt(layout), &ear),
                     ZT_OK);
    return pixels;
}

static AVFrame *frame_of(const zt_video_pixels *pixels, const zt_image *image) {
    AVFrame *frame;
    assert_int_equal(zt_video_pixels_convert(&frame, pixels, image, &ear), ZT_OK);
    return frame;
}

static int bytes_of(uint8_t *bytes, const AVFrame *frame) {
    int size = av_image_copy_to_buffer(bytes, BYTES_MAX, (const uint8_t *const *)frame->data,
                                       frame->linesize, frame->format, WIDTH, HEIGHT, 1);
    assert_in_range(size, WIDTH * HEIGHT, BYTES_MAX);
    return size;
}

static void assert_shows(const AVFrame *frame, zt_image *image, const char *layout,
                         zt_view view) {
    static uint8_t found[BYTES_MAX], wanted[BYTES_MAX];
    zt_video_pixels *anew = open_pixels(layout, view);
    zt_image plain = *image;
    plain.stamps = NULL;
    AVFrame *reference = frame_of(anew, &plain);
    int size = bytes_of(found, frame);
    assert_int_equal(bytes_of(wanted, reference), size);
    if (memcmp(found, wanted, (size_t)size) != 0) fail_msg("%s: another frame", layout);
    av_frame_free(&reference);
    zt_video_pixels_close(&anew);
}

/* Of all layouts: some frames are held while the next ones come, and stay as they are. */
static void frames_are_the_same(void **state) {
    (void)state;
    static uint8_t before[BYTES_MAX], after[BYTES_MAX];
    for (int l = 0; l < LAYOUT_COUNT; l++) {
        zt_view view = l % 2 ? ZT_VIEW_SRGB : ZT_VIEW_RAW;
        zt_video_pixels *pixels = open_pixels(layouts[l], view);
        zt_image *image = open_image();
        AVFrame *held = frame_of(pixels, image);
        bytes_of(before, held);
        for (int i = 0; i < 24; i++) {
            srand((unsigned)i);
            change(image);
            AVFrame *frame = frame_of(pixels, image);
            assert_shows(frame, image, layouts[l], view);
            av_frame_free(&frame);
        }
        int size = bytes_of(after, held);
        assert_memory_equal(after, before, (size_t)size);
        av_frame_free(&held);
        zt_image_free(&image);
        zt_video_pixels_close(&pixels);
    }
}

/* What the stamp says is there already is not looked at. */
static void known_tiles_are_not_read(void **state) {
    (void)state;
    static uint8_t before[BYTES_MAX], after[BYTES_MAX];
    zt_video_pixels *pixels = open_pixels("yuv444p", ZT_VIEW_SRGB);
    zt_image *image = open_image();
    AVFrame *frame = frame_of(pixels, image);
    int size = bytes_of(before, frame);
    av_frame_free(&frame);
    fill_tile(image, 7, 2);
    image->stamps[7] = 1;
    frame = frame_of(pixels, image);
    bytes_of(after, frame);
    assert_memory_equal(after, before, (size_t)size);
    av_frame_free(&frame);
    image->stamps[7] = 2;
    frame = frame_of(pixels, image);
    bytes_of(after, frame);
    assert_memory_not_equal(after, before, (size_t)size);
    av_frame_free(&frame);
    zt_image_free(&image);
    zt_video_pixels_close(&pixels);
}

/* ---- checksums ------------------------------------------------------------------------------
 */

static zt_hash sum_of(zt_sums *sums, const zt_image *image) {
    zt_hash sum;
    assert_int_equal(zt_sums_of(&sum, sums, image), ZT_OK);
    return sum;
}

static void assert_sum(zt_sums *sums, const zt_image *image, bool same) {
    zt_image plain = *image;
    plain.stamps = NULL;
    assert_int_equal(zt_hash_equal(sum_of(sums, image), sum_of(NULL, &plain)), same);
}

/* Each number counts, with and without stamps; and what the stamp says is known is not read. */
static void sums_are_the_same(void **state) {
    (void)state;
    zt_sums *sums;
    assert_int_equal(zt_sums_open(&sums), ZT_OK);
    zt_image *image = open_image();
    assert_int_equal(zt_image_add_channel(image, "depth"), ZT_OK);
    for (int i = 0; i < 24; i++) {
        srand((unsigned)i);
        change(image);
        assert_sum(sums, image, true);
    }
    for (int i = 0; i < TILES; i++) fill_tile(image, i, 1);
    zt_hash before = sum_of(sums, image);
    image->channels[0].values[WIDTH * HEIGHT - 1] = 1;
    assert_false(zt_hash_equal(sum_of(sums, image), before));
    before = sum_of(NULL, image);
    for (int i = 0; i < 4 * WIDTH * HEIGHT; i += 61) {
        float own = image->pixels[i];
        image->pixels[i] = own + 1;
        assert_false(zt_hash_equal(sum_of(NULL, image), before));
        assert_sum(sums, image, false);
        image->pixels[i] = own;
    }
    zt_image_free(&image);
    zt_sums_close(&sums);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(frames_are_the_same),
                                       cmocka_unit_test(known_tiles_are_not_read),
                                       cmocka_unit_test(sums_are_the_same)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
