/* Developing: the fast way gives what the definition gives, for every float that could tell. */
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
    return srgb(hable(2 * (long double)linear) / hable(11.2L));
}

/* Develops `count` (a multiple of 3) values through 1-row images and compares each with the
 * nearest of 256. */
static void compare(const float *values, int count, zt_view view) {
    static float pixels[BATCH / 3 * 4];
    static uint8_t bytes[BATCH];
    zt_image image = {.width = count / 3, .height = 1, .pixels = pixels};
    for (int i = 0; i < count; i++) pixels[i / 3 * 4 + i % 3] = values[i];
    zt_develop_rgb8(bytes, 0, &image, view, 0, 1);
    /* Where rows are one pixel wide, each is developed alone, and not beside others. */
    zt_image narrow = {.width = 1, .height = count / 3, .pixels = pixels};
    static uint8_t alone[BATCH];
    zt_develop_rgb8(alone, 3, &narrow, view, 0, count / 3);
    assert_memory_equal(alone, bytes, (size_t)count);
    for (int i = 0; i < count; i++) {
        int expected = (int)floorl(255 * reference(values[i], view) + 0.5L);
        if (bytes[i] != expected)
            fail_msg("%a in view %d: %d instead of %d", values[i], view, bytes[i], expected);
    }
}

/* Around the step from each code to the next, every float for 2000 to both sides is right. */
static void steps_are_exact(void **state) {
    (void)state;
    float values[3999];
    for (int view = 0; view < ZT_VIEW_COUNT; view++)
        for (int code = 1; code <= 255; code++) {
            uint32_t low = 0, high = 0x41000000; /* 0 and 8 */
            while (high - low > 1) {
                uint32_t middle = (low + high) / 2;
                if (255 * reference(from_bits(middle), view) + 0.5L >= code)
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
static void any_float_is_exact(void **state) {
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
    zt_develop_rgb8(bytes, STRIDE, image, ZT_VIEW_RAW, 2, 4);
    for (int y = 0; y < 3; y++)
        for (int i = 0; i < STRIDE; i++) {
            bool inside = y < 2 && i < 6;
            assert_int_equal(bytes[y * STRIDE + i],
                             inside ? 10 * (y + 2) + i + (i >= 3 ? 1 : 0) : 0xee);
        }
    zt_image_free(&image);
}

/* 16 bits: the nearest of 65536 for values spread over the range and beyond it. */
static void sixteen_bits_are_exact(void **state) {
    (void)state;
    enum { WIDTH = 40000 };
    zt_image *image;
    assert_int_equal(zt_image_create(&image, WIDTH, 1), ZT_OK);
    uint16_t *values = malloc(WIDTH * 3 * sizeof *values);
    assert_non_null(values);
    for (int view = 0; view < ZT_VIEW_COUNT; view++) {
        for (int i = 0; i < WIDTH * 4; i++)
            image->pixels[i] = (view == ZT_VIEW_FILMIC ? 5.6f : 1) * (float)(i - 1000) /
                               (float)(WIDTH * 4 - 2000);
        image->pixels[4] = NAN;
        zt_develop_rgb16(values, WIDTH * 6, image, view, 0, 1);
        for (int i = 0; i < WIDTH * 3; i++) {
            float linear = image->pixels[i / 3 * 4 + i % 3];
            assert_int_equal(values[i], (int)floorl(65535 * reference(linear, view) + 0.5L));
        }
    }
    free(values);
    zt_image_free(&image);
}

/* The first float whose 16-bit code is at least this one. */
static uint32_t deep_step(int code, zt_view view) {
    uint32_t low = 0, high = 0x41000000;
    while (high - low > 1) {
        uint32_t middle = (low + high) / 2;
        if (65535 * reference(from_bits(middle), view) + 0.5L >= code)
            high = middle;
        else
            low = middle;
    }
    return high;
}

/* At the step from each of the 65536 codes to the next, the floats on both sides are right, and
 * so are those that are no numbers, or none of 0..1. Rows of any length. */
static void deep_steps_are_exact(void **state) {
    (void)state;
    enum { WIDTH = 65535 };
    zt_image *image;
    assert_int_equal(zt_image_create(&image, WIDTH, 1), ZT_OK);
    uint16_t *values = malloc(WIDTH * 3 * sizeof *values);
    assert_non_null(values);
    for (int view = 0; view < ZT_VIEW_COUNT; view++) {
        for (int code = 1; code <= WIDTH; code++) {
            uint32_t step = deep_step(code, view);
            for (uint32_t i = 0; i < 3; i++)
                image->pixels[4 * (code - 1) + i] = from_bits(step - 2 + i);
        }
        zt_develop_rgb16(values, 0, image, view, 0, 1);
        for (int code = 1; code <= WIDTH; code++)
            for (int i = 0; i < 3; i++)
                if (values[3 * (code - 1) + i] != (i < 2 ? code - 1 : code))
                    fail_msg("view %d, before %d: %d", view, code, values[3 * (code - 1) + i]);
    }
    const float special[] = {0,      -0.0f,    1,           INFINITY, -INFINITY, NAN,
                             -NAN,   1e-45f,   -1e-45f,     3e38f,    0x1p-21f,  0x1p-22f,
                             -3e38f, 1.00001f, 0.99999994f, 5.6f,     5.59999f,  8};
    zt_image odd = {.width = 6, .height = 1, .pixels = image->pixels};
    for (int i = 0; i < 18; i++) image->pixels[i / 3 * 4 + i % 3] = special[i];
    for (int view = 0; view < ZT_VIEW_COUNT; view++) {
        zt_develop_rgb16(values, 0, &odd, view, 0, 1);
        for (int i = 0; i < 18; i++)
            assert_int_equal(values[i],
                             (int)floorl(65535 * reference(special[i], view) + 0.5L));
    }
    free(values);
    zt_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_are_exact),      cmocka_unit_test(any_float_is_exact),
        cmocka_unit_test(definition_is_srgb),   cmocka_unit_test(definitions_of_the_others),
        cmocka_unit_test(rows_and_stride),      cmocka_unit_test(sixteen_bits_are_exact),
        cmocka_unit_test(deep_steps_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
