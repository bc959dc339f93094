/* Developing: the fast way gives what the definition gives, for floats all over the range. */
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

enum { BATCH = 4096 };

static float from_bits(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static long double srgb(long double v) {
    return v <= 0.0031308L ? 12.92L * v : 1.055L * powl(v, 1 / 2.4L) - 0.055L;
}

/* From the conditions alone that BT.2020-2 gives for the two constants: both parts and their
 * slopes meet at b, so a = 10 b^0.55 and 4.5 b = a b^0.45 - a + 1. */
static long double rec709(long double v) {
    static long double a, b;
    for (long double low = 0, high = 1; a == 0;) {
        b = (low + high) / 2;
        if (high - low < 1e-18L)
            a = 10 * powl(b, 0.55L);
        else if (5.5L * b - 10 * powl(b, 0.55L) + 1 > 0)
            low = b;
        else
            high = b;
    }
    return v < b ? 4.5L * v : a * powl(v, 0.45L) - a + 1;
}

/* As it is printed in Hable's "Filmic Tonemapping Operators", 2010. */
static long double hable(long double x) {
    const long double A = 0.15L, B = 0.5L, C = 0.1L, D = 0.2L, E = 0.02L, F = 0.3L;
    return (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F;
}

/* The curves written once more, in long double and from their sources' texts. */
static long double reference(float linear, zt_view view) {
    if (isnan(linear) || linear <= 0) return 0;
    if (linear >= (view == ZT_VIEW_FILMIC ? 5.6 : 1)) return 1;
    if (view == ZT_VIEW_RAW) return linear;
    if (view == ZT_VIEW_SRGB) return srgb(linear);
    if (view == ZT_VIEW_REC709) return rec709(linear);
    return fmaxl(srgb(hable(2 * (long double)linear) / hable(11.2L)), 0);
}

/* Develops `count` (a multiple of 3) values and compares each with the exact result: rows,
 * which no order of developing changes; 16 bits, which are the nearest but for 0.03 of a step;
 * and 8 bits, which are one of the two codes beside it, and the code itself where it is one. */
static void compare(const float *values, int count, zt_view view) {
    static float pixels[BATCH / 3 * 4], shown[BATCH], alone[BATCH];
    static uint8_t bytes[BATCH];
    static uint16_t deep[BATCH];
    const zt_developing how = {.view = view};
    zt_image image = {.width = count / 3, .height = 1, .pixels = pixels};
    for (int i = 0; i < count; i++) pixels[i / 3 * 4 + i % 3] = values[i];
    zt_develop_row(shown, pixels, count / 3, &how);
    zt_develop_8(bytes, 0, &image, &how, 0, 1);
    zt_develop_16(deep, 0, &image, &how, 0, 1);
    for (int x = 0; x < count / 3; x++) zt_develop_row(alone + 3 * x, pixels + 4 * x, 1, &how);
    assert_memory_equal(alone, shown, (size_t)count * sizeof *shown);
    for (int i = 0; i < count; i++) {
        long double exact = reference(values[i], view), code = 255 * exact;
        bool dark = values[i] < 0x1.01p-21f; /* nearly black, and taken for it */
        bool near = fabsl(shown[i] - exact) <= (dark ? exact : 4e-7L);
        bool near_16 = fabsl(deep[i] - 65535 * exact) <= 0.53L;
        bool beside = bytes[i] >= floorl(code - 0.003L) && bytes[i] <= ceill(code + 0.003L);
        bool kept = fabsl(code - roundl(code)) > 0.0015L || bytes[i] == roundl(code);
        if (!near || !near_16 || !beside || !kept)
            fail_msg("%a in view %d: %.9g, %d, %d instead of %.9Lg", values[i], view, shown[i],
                     deep[i], bytes[i], exact);
    }
}

/* Around each code, every float for 2000 to both sides is right. */
static void codes_are_kept(void **state) {
    (void)state;
    float values[3999];
    for (int view = 0; view < ZT_VIEW_COUNT; view++)
        for (int code = 1; code <= 255; code++) {
            uint32_t low = 0, high = 0x41000000; /* 0 and 8 */
            while (high - low > 1) {
                uint32_t middle = (low + high) / 2;
                if (255 * reference(from_bits(middle), view) >= code)
                    high = middle;
                else
                    low = middle;
            }
            for (uint32_t i = 0; i < 3999; i++) values[i] = from_bits(high - 2000 + i);
            compare(values, 3999, view);
        }
}

/* Any bits whatever: numbers above 1 and below 0, infinities, what is no number, the smallest.
 */
static void any_float_is_right(void **state) {
    (void)state;
    float values[3999];
    uint64_t random = 88172645463325252u;
    for (int round = 0; round < 400; round++) {
        for (int i = 0; i < 3999; i++) {
            random ^= random << 13, random ^= random >> 7, random ^= random << 17;
            uint32_t bits = (uint32_t)(random >> 20);
            /* Every other one from 2^-16 .. 8, where the codes are. */
            values[i] = from_bits(i % 2 ? 0x37800000 + bits % 0x09800000 : bits);
        }
        compare(values, 3999, round % ZT_VIEW_COUNT);
    }
    const float special[] = {0,    -0.0f,    1,         INFINITY, -INFINITY, NAN,
                             -NAN, 1e-45f,   -1e-45f,   3e38f,    -3e38f,    0x1p-13f,
                             5.6f, 5.59999f, 0.999999f, 1.00001f, 0.00012f,  8};
    for (int view = 0; view < ZT_VIEW_COUNT; view++) compare(special, 18, view);
}

static void assert_near(double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance)) fail_msg("%.17g is not %.17g", found, expected);
}

/* The definition has the values that the sRGB standard and every table of it give. */
static void definition_is_srgb(void **state) {
    (void)state;
    assert_near(zt_develop_value(0.5, ZT_VIEW_SRGB), 0.7353569830524495, 1e-12);
    assert_near(zt_develop_value(0.18, ZT_VIEW_SRGB), 0.4613561295004415, 1e-12);
    assert_near(zt_develop_value(0.002, ZT_VIEW_SRGB), 0.02584, 1e-12);
    assert_near(zt_develop_value(0.25, ZT_VIEW_RAW), 0.25, 0);
    assert_near(zt_develop_value(7, ZT_VIEW_RAW), 1, 0);
    assert_near(zt_develop_value(-7, ZT_VIEW_SRGB), 0, 0);
    assert_near(zt_develop_value((double)NAN, ZT_VIEW_SRGB), 0, 0);
    for (int i = 0; i <= 1000; i++) {
        double back = zt_develop_value(zt_srgb_to_linear(i / 1000.0), ZT_VIEW_SRGB);
        assert_near(back, i / 1000.0, 1e-6);
    }
}

/* The other views at points that their sources give, or that follow by hand; each rises, and
 * none is white before its white. */
static void definitions_of_the_others(void **state) {
    (void)state;
    assert_near(zt_develop_value(0.01, ZT_VIEW_REC709), 0.045, 1e-15);
    /* By the rounded constants of BT.709-6: within the error of their rounding. */
    for (double v = 0.018; v < 1; v += 0.01)
        assert_near(zt_develop_value(v, ZT_VIEW_REC709), 1.099 * pow(v, 0.45) - 0.099, 3e-4);
    /* At x = 2 the curve is 0.704 / 1.66 - 1 / 15, at 11.2 it is 19.38 / 24.476 - 1 / 15. */
    double one = (0.704 / 1.66 - 1 / 15.0) / (19.38 / 24.476 - 1 / 15.0);
    assert_near(zt_develop_value(1, ZT_VIEW_FILMIC), 1.055 * pow(one, 1 / 2.4) - 0.055, 1e-14);
    const double whites[] = {1, 1, 1, 5.6};
    for (int view = 0; view < ZT_VIEW_COUNT; view++) {
        assert_near(zt_develop_value(0, view), 0, 0);
        assert_near(zt_develop_value(whites[view], view), 1, 0);
        for (double v = 1e-9, last = 0; v < whites[view]; v *= 1.0001) {
            double now = zt_develop_value(v, view);
            if (!(now > last && now < 1)) fail_msg("view %d at %.17g: %.17g", view, v, now);
            last = now;
        }
        assert_near(zt_develop_value(nextafter(whites[view], 0), view), 1, 1e-15);
    }
}

/* Only the rows asked for are read and written, and the gap between rows stays as it was. */
static void rows_and_stride(void **state) {
    (void)state;
    enum { STRIDE = 11 };
    zt_image *image;
    assert_int_equal(zt_image_create(&image, 2, 5), ZT_OK);
    for (int y = 0; y < 5; y++)
        for (int i = 0; i < 8; i++) image->pixels[8 * y + i] = (float)(10 * y + i) / 255;
    uint8_t bytes[3 * STRIDE];
    memset(bytes, 0xee, sizeof bytes);
    zt_develop_8(bytes, STRIDE, image, &(zt_developing){.view = ZT_VIEW_RAW}, 2, 4);
    for (int y = 0; y < 3; y++)
        for (int i = 0; i < STRIDE; i++) {
            bool inside = y < 2 && i < 6;
            assert_int_equal(bytes[y * STRIDE + i],
                             inside ? 10 * (y + 2) + i + (i >= 3 ? 1 : 0) : 0xee);
        }
    zt_image_free(&image);
}

/* Every code of 16 bits is kept, in rows longer than what is developed at a time. */
static void deep_codes_are_kept(void **state) {
    (void)state;
    enum { WIDTH = 65536 / 3 + 1 };
    zt_image *image;
    assert_int_equal(zt_image_create(&image, WIDTH, 1), ZT_OK);
    uint16_t *values = malloc(WIDTH * 3 * sizeof *values);
    assert_non_null(values);
    for (int i = 0; i < WIDTH * 3; i++)
        image->pixels[i / 3 * 4 + i % 3] = (float)zt_srgb_to_linear(i / 65535.0);
    zt_develop_16(values, 0, image, &(zt_developing){.view = ZT_VIEW_SRGB}, 0, 1);
    for (int i = 0; i < 65536; i++) assert_int_equal(values[i], i);
    free(values);
    zt_image_free(&image);
}

/* Colours that are multiplied by A are divided by it, or not; A itself is the nearest code, and
 * is cut. Where nothing is covered, colours stay as they are. */
static void alpha_goes_along(void **state) {
    (void)state;
    float pixels[] = {0.25f, 0.125f, 0, 0.5f,  0.2f, 0.4f, 0.6f, 0,
                      1,     0.4f,   0, 1.25f, 0.2f, 0,    0,    -0.25f};
    const zt_image image = {.width = 4, .height = 1, .pixels = pixels};
    const uint8_t divided[] = {128, 64, 0, 128, 51, 102, 153, 0, 204, 82, 0, 255, 51, 0, 0, 0},
                  kept[] = {64, 32, 0, 128, 51, 102, 153, 0, 255, 102, 0, 255, 51, 0, 0, 0};
    for (int k = 0; k < 2; k++) {
        const zt_developing how = {.view = ZT_VIEW_RAW,
                                   .alpha = k ? ZT_ALPHA_KEPT : ZT_ALPHA_DIVIDED};
        const uint8_t *expected = k ? kept : divided;
        uint8_t bytes[16];
        uint16_t deep[16];
        zt_develop_8(bytes, 0, &image, &how, 0, 1);
        zt_develop_16(deep, 0, &image, &how, 0, 1);
        for (int i = 0; i < 16; i++) {
            assert_true(abs(bytes[i] - expected[i]) <= (i % 4 == 3 ? 0 : 1));
            assert_true(abs(deep[i] - 257 * expected[i]) <= 129);
        }
        assert_int_equal(deep[0], k ? 16384 : 32768);
        assert_int_equal(deep[3], 32768);
    }
}

/* What counts instead of a view gets rows of colours, divided by A where that is asked for, and
 * may give anything. */
static void swap_colours(const zt_color *color, float *pixels, int count) {
    (void)color;
    for (int i = 0; i < count; i++, pixels += 3) {
        float red = pixels[0];
        pixels[0] = pixels[2];
        pixels[1] = i == 0 ? NAN : 2 * pixels[1] - 1;
        pixels[2] = red;
    }
}

static void colour_counts_instead(void **state) {
    (void)state;
    enum { WIDTH = 3000 };
    static float pixels[4 * WIDTH];
    static uint16_t deep[3 * WIDTH];
    const zt_color color = {.apply = swap_colours};
    const zt_developing how = {.view = ZT_VIEW_FILMIC, .color = &color};
    for (int i = 0; i < 4 * WIDTH; i++) pixels[i] = (float)i / (4 * WIDTH);
    const zt_image image = {.width = WIDTH, .height = 1, .pixels = pixels};
    float shown[3 * 4];
    zt_develop_row(shown, pixels, 4, &how);
    const float swapped[] = {pixels[2], 0, pixels[0], pixels[6], 0, pixels[4]};
    assert_memory_equal(shown, swapped, sizeof swapped);
    zt_develop_16(deep, 0, &image, &how, 0, 1);
    for (int x = 0; x < WIDTH; x++) {
        float green = 2 * pixels[4 * x + 1] - 1;
        assert_int_equal(deep[3 * x], (int)(65535 * pixels[4 * x + 2] + 0.5f));
        if (x % 1024)
            assert_int_equal(deep[3 * x + 1], green > 0 ? (int)(65535 * green + 0.5f) : 0);
        assert_int_equal(deep[3 * x + 2], (int)(65535 * pixels[4 * x] + 0.5f));
    }
    const zt_developing divided = {.color = &color, .alpha = ZT_ALPHA_DIVIDED};
    const float half[] = {0.25f, 0.375f, 0.125f, 0.5f, 0.25f, 0.375f, 0.125f, 0.5f};
    zt_develop_row(shown, half, 2, &divided);
    assert_true(shown[0] == 0.25f && shown[2] == 0.5f && shown[4] == 0.5f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(codes_are_kept),     cmocka_unit_test(any_float_is_right),
        cmocka_unit_test(definition_is_srgb), cmocka_unit_test(definitions_of_the_others),
        cmocka_unit_test(rows_and_stride),    cmocka_unit_test(deep_codes_are_kept),
        cmocka_unit_test(alpha_goes_along),   cmocka_unit_test(colour_counts_instead),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
