/* Dithering: what the mask is like, and what becomes of numbers by it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "image/develop.h"
#include "image/dither.h"

enum { SIDE = ZT_DITHER_SIDE };

static const zt_developing raw = {.view = ZT_VIEW_RAW};

/* The bytes of a picture of one number. */
static uint8_t *flat(float number, int width, int height) {
    zt_image *image;
    uint8_t *bytes = malloc((size_t)(3 * width * height));
    assert_int_equal(zt_image_create(&image, width, height), ZT_OK);
    assert_non_null(bytes);
    for (int i = 0; i < 4 * width * height; i++) image->pixels[i] = number;
    zt_develop_8(bytes, (size_t)(3 * width), image, &raw, 0, height);
    zt_image_free(&image);
    return bytes;
}

/* Each of the 256 thresholds is there as often as any other, and the mask begins again after 64
 * rows, above the picture, too. */
static void thresholds_are_even(void **state) {
    (void)state;
    int counts[256] = {0};
    for (int y = 0; y < SIDE; y++) {
        for (int x = 0; x < SIDE; x++) counts[zt_dither_row(y)[x]]++;
        assert_memory_equal(zt_dither_row(y), zt_dither_row(y + 7 * SIDE), SIDE);
        assert_memory_equal(zt_dither_row(y), zt_dither_row(y - SIDE), SIDE);
    }
    for (int t = 0; t < 256; t++) assert_int_equal(counts[t], SIDE * SIDE / 256);
}

/* How much of what dithering adds at a level is coarse: the mean power of the waves of at most
 * 8 over the mask's side, where that of white noise is 1; and of the strongest of them. */
static void coarse(double *mean, double *peak, int level) {
    const double turn = 2 * 3.14159265358979323846 / SIDE, share = level / 256.0;
    int count = 0;
    *mean = *peak = 0;
    for (int v = -8; v <= 8; v++)
        for (int u = 0; u <= 8; u++) {
            if (u * u + v * v > 64 || (u == 0 && v <= 0)) continue;
            double real = 0, imaginary = 0;
            for (int y = 0; y < SIDE; y++)
                for (int x = 0; x < SIDE; x++) {
                    double on = (zt_dither_row(y)[x] < level) - share;
                    real += on * cos(turn * (u * x + v * y));
                    imaginary += on * sin(turn * (u * x + v * y));
                }
            double power =
                (real * real + imaginary * imaginary) / (SIDE * SIDE) / (share * (1 - share));
            *mean += power;
            *peak = fmax(*peak, power);
            count++;
        }
    *mean /= count;
}

/* At all levels but the outermost, a fiftieth of white noise and no wave that stands out: the
 * spectrum that is called blue noise (Ulichney, "Dithering with blue noise", 1988). A regular
 * pattern (Bayer's) has as little of it, but waves instead, which the last test would find. */
static void noise_is_blue(void **state) {
    (void)state;
    for (int level = 48; level <= 208; level += 32) {
        double mean, peak;
        coarse(&mean, &peak, level);
        if (mean > 0.05 || peak > 0.25) fail_msg("level %d: %g, %g", level, mean, peak);
    }
}

/* And no wave of any length holds more than a fiftieth of the whole, as those of a pattern do.
 */
static void there_is_no_pattern(void **state) {
    (void)state;
    const double turn = 2 * 3.14159265358979323846 / SIDE;
    double strongest = 0;
    for (int v = 0; v < SIDE; v++)
        for (int u = 0; u <= SIDE / 2; u++) {
            double real = 0, imaginary = 0;
            if (u == 0 && v == 0) continue;
            for (int y = 0; y < SIDE; y++)
                for (int x = 0; x < SIDE; x++) {
                    double on = (zt_dither_row(y)[x] < 128) - 0.5;
                    real += on * cos(turn * (u * x + v * y));
                    imaginary += on * sin(turn * (u * x + v * y));
                }
            /* Over all waves these add up to 1. */
            double part =
                (real * real + imaginary * imaginary) / (SIDE * SIDE) / (SIDE * SIDE) * 4;
            strongest = fmax(strongest, part);
        }
    if (strongest > 0.02) fail_msg("a wave holds %g of the whole", strongest);
}

/* The mean of a flat picture is its number: to a hundredth of a code, at all of them. */
static void means_are_kept(void **state) {
    (void)state;
    for (int i = 0; i <= 255 * 16; i += 7) {
        double exact = i / 16.0 + i % 11 / 180.0, sum = 0;
        if (exact > 255) exact = 255;
        uint8_t *bytes = flat((float)(exact / 255), SIDE, SIDE);
        for (int k = 0; k < 3 * SIDE * SIDE; k++) {
            assert_true(bytes[k] == (int)exact || bytes[k] == (int)ceil(exact));
            sum += bytes[k];
        }
        if (fabs(sum / (3 * SIDE * SIDE) - exact) > 0.0025)
            fail_msg("%.6f becomes %.6f", exact, sum / (3 * SIDE * SIDE));
        free(bytes);
    }
}

/* What is a code stays it, to the last pixel: white, black and a test card's colours; and what
 * is one but for the roundings of rendering. */
static void codes_stay(void **state) {
    (void)state;
    for (int code = 0; code <= 255; code++)
        for (int near = -1; near <= 1; near++) {
            uint8_t *bytes = flat((float)((code + 0.0015 * near) / 255), 100, 70);
            for (int k = 0; k < 3 * 100 * 70; k++) assert_int_equal(bytes[k], code);
            free(bytes);
        }
}

/* Grey stays grey, and the rows do not depend on which of them are developed together. */
static void greys_and_rows(void **state) {
    (void)state;
    enum { WIDTH = 1200, HEIGHT = 80 };
    zt_image *image;
    assert_int_equal(zt_image_create(&image, WIDTH, HEIGHT), ZT_OK);
    uint8_t *all = malloc(3 * WIDTH * HEIGHT), *one = malloc(3 * WIDTH);
    assert_true(all && one);
    for (int i = 0; i < 4 * WIDTH * HEIGHT; i++)
        image->pixels[i] =
            (float)(i / 4 % WIDTH) / WIDTH * 0.9f + (float)(i / 4 / WIDTH) * 1e-3f;
    const zt_developing how = {.view = ZT_VIEW_SRGB};
    zt_develop_8(all, 3 * WIDTH, image, &how, 0, HEIGHT);
    for (int y = 0; y < HEIGHT; y++) {
        zt_develop_8(one, 3 * WIDTH, image, &how, y, y + 1);
        assert_memory_equal(one, all + (size_t)(3 * WIDTH * y), 3 * WIDTH);
        for (int x = 0; x < WIDTH; x++)
            assert_true(one[3 * x] == one[3 * x + 1] && one[3 * x] == one[3 * x + 2]);
    }
    free(all);
    free(one);
    zt_image_free(&image);
}

/* A dark ramp over 8 codes in 1280 pixels would be bands of 160. But near whole codes, where
 * there is little to add, no run of one code is longer than the distance over which the ramp
 * stays within a quarter of it; and the mean of all 64 rows follows the ramp. */
static void slow_ramps_have_no_bands(void **state) {
    (void)state;
    enum { WIDTH = 1280 };
    zt_image *image;
    assert_int_equal(zt_image_create(&image, WIDTH, SIDE), ZT_OK);
    uint8_t *bytes = malloc(3 * WIDTH * SIDE);
    assert_non_null(bytes);
    for (int i = 0; i < 4 * WIDTH * SIDE; i++)
        image->pixels[i] = (float)((10 + 8.0 * (i / 4 % WIDTH) / WIDTH) / 255);
    zt_develop_8(bytes, 3 * WIDTH, image, &raw, 0, SIDE);
    int longest = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0, run = 0; x < WIDTH; x++) {
            bool same = x > 0 && bytes[3 * (y * WIDTH + x)] == bytes[3 * (y * WIDTH + x - 1)];
            run = same ? run + 1 : 1;
            if (run > longest) longest = run;
        }
    if (longest > 80) fail_msg("a run of %d pixels", longest);
    for (int x = 0; x + SIDE <= WIDTH; x += SIDE) {
        double sum = 0, exact = 10 + 8 * (x + (SIDE - 1) / 2.0) / WIDTH;
        for (int y = 0; y < SIDE; y++)
            for (int i = 0; i < SIDE; i++) sum += bytes[3 * (y * WIDTH + x + i)];
        if (fabs(sum / (SIDE * SIDE) - exact) > 0.01)
            fail_msg("at %d: %g instead of %g", x, sum / (SIDE * SIDE), exact);
    }
    free(bytes);
    zt_image_free(&image);
}

/* Lines of codes of any depth: between the two codes, the whole ones kept; without a mask the
 * nearest. */
static void lines_of_codes(void **state) {
    (void)state;
    enum { COUNT = 1000 };
    float numbers[COUNT];
    uint16_t codes[COUNT];
    for (int depth = 8; depth <= 16; depth += 2) {
        float most = (float)((1 << depth) - 1);
        for (int i = 0; i < COUNT; i++) numbers[i] = (float)i / (COUNT - 1);
        zt_dither_line(codes, numbers, 0, COUNT, most, NULL);
        for (int i = 0; i < COUNT; i++)
            assert_true(fabs((double)codes[i] - (double)numbers[i] * (double)most) <= 0.51);
        zt_dither_line(codes, numbers, 0, COUNT, most, zt_dither_row(5));
        int up = 0, down = 0;
        for (int i = 0; i < COUNT; i++) {
            double off = (double)codes[i] - (double)numbers[i] * (double)most;
            assert_true(fabs(off) < 1);
            up += off > 0.5;
            down += off < -0.5;
        }
        assert_true(up > COUNT / 20 && down > COUNT / 20);
        assert_true(codes[0] == 0 && codes[COUNT - 1] == (1 << depth) - 1);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thresholds_are_even),
        cmocka_unit_test(noise_is_blue),
        cmocka_unit_test(there_is_no_pattern),
        cmocka_unit_test(means_are_kept),
        cmocka_unit_test(codes_stay),
        cmocka_unit_test(greys_and_rows),
        cmocka_unit_test(slow_ramps_have_no_bands),
        cmocka_unit_test(lines_of_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
