/* The check of a movie that is closed: it passes what is right, finds what is wrong, and tells
 * what it found. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "cards.h"
#include "encode/video_check.h"
#include "encode/video_pixels.h"

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
    const way h264 = {
        .ending = "mp4", .codec = "h264", .pixels = "yuv420p", .id = AV_CODEC_ID_H264};
    const way *w = &h264;
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
    size_t size;
    free(file_bytes("checked.mp4", &size));
    assert_int_equal(truncate("checked.mp4", (off_t)size - 2000), 0);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(check_finds),
        cmocka_unit_test(told_when_closed),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
