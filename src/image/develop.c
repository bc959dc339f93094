/* To 8 bits by a table, exactly. The top half of a float's bits (exponent and seven bits of the
 * mantissa) picks a bucket of 2^16 neighbouring floats; in each bucket at most one step from a
 * code to the next one lies, and the bucket knows where. The idea of the buckets is Fabian
 * Giesen's ("float->sRGB8", 2012), whose table interpolates; this one compares and so is never
 * off by one. Owns the two tables, 6.5 KB each, made at the first use. */
#include "image/develop.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <threads.h>

#include "base/wide.h"

/* Below 2^-13 every view gives 0 of 255; from 1 on, 255. Between lie 13 octaves. */
#define FLOOR_BITS UINT32_C(0x39000000)
#define ONE_BITS   UINT32_C(0x3f800000)
enum {
    BUCKET_BITS = 16,
    BUCKET_COUNT = (ONE_BITS - FLOOR_BITS) >> BUCKET_BITS,
    VIEW_COUNT = 2
};

/* (code << 16) + 2^16 - step: with the float's low 16 bits added, the carry is the step from
 * the bucket's first code to the next. Without a step, `step` is 2^16, and nothing carries. */
static uint32_t tables[VIEW_COUNT][BUCKET_COUNT];
static once_flag tables_once = ONCE_FLAG_INIT;

/* IEC 61966-2-1. */
static double linear_to_srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

double zt_srgb_to_linear(double display) {
    return display <= 0.04045 ? display / 12.92 : pow((display + 0.055) / 1.055, 2.4);
}

double zt_develop_value(double linear, zt_view view) {
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 1;
    return view == ZT_VIEW_SRGB ? linear_to_srgb(linear) : linear;
}

static uint32_t exact_code(uint32_t bits, zt_view view) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return (uint32_t)(255 * zt_develop_value((double)value, view) + 0.5);
}

static void make_table(uint32_t *table, zt_view view) {
    for (uint32_t b = 0; b < BUCKET_COUNT; b++) {
        uint32_t first = FLOOR_BITS + (b << BUCKET_BITS);
        uint32_t code = exact_code(first, view);
        uint32_t low = 0, high = UINT32_C(1)
                                 << BUCKET_BITS; /* low has the code, high has not */
        if (exact_code(first + high - 1, view) == code) low = high - 1;
        while (high - low > 1) {
            uint32_t middle = (low + high) / 2;
            if (exact_code(first + middle, view) == code)
                low = middle;
            else
                high = middle;
        }
        assert(exact_code(first + (1 << BUCKET_BITS) - 1, view) <= code + 1);
        table[b] = (code << BUCKET_BITS) + (1 << BUCKET_BITS) - high;
    }
}

static void make_tables(void) {
    make_table(tables[ZT_VIEW_RAW], ZT_VIEW_RAW);
    make_table(tables[ZT_VIEW_SRGB], ZT_VIEW_SRGB);
}

/* The bits of numbers, cut to the range of the tables and counted from its start. By itself,
 * this is a loop without branches, which becomes wide. */
ZT_CLONES static void find_places(uint32_t *restrict places, const float *restrict numbers,
                                  int count) {
    for (int i = 0; i < count; i++) {
        float number = numbers[i] > 0x1p-13f ? numbers[i] : 0x1p-13f; /* NaN is not */
        int32_t bits; /* of positive floats, in the same order as they */
        memcpy(&bits, &number, sizeof bits);
        bits = bits < (int32_t)ONE_BITS ? bits : (int32_t)ONE_BITS - 1;
        places[i] = (uint32_t)bits - FLOOR_BITS;
    }
}

static uint8_t code_at(const uint32_t *table, uint32_t place) {
    return (uint8_t)((table[place >> BUCKET_BITS] + (place & 0xffff)) >> BUCKET_BITS);
}

/* One row, a piece at a time. */
static void develop_row(uint8_t *rgb, const float *pixels, int width, const uint32_t *table) {
    enum { PIECE = 64 };
    uint32_t places[4 * PIECE] = {0};
    for (int x = 0; x < width; x += PIECE) {
        int count = width - x < PIECE ? width - x : PIECE;
        find_places(places, pixels + 4 * (size_t)x, 4 * count);
        for (int i = 0; i < count; i++, rgb += 3)
            for (int c = 0; c < 3; c++) rgb[c] = code_at(table, places[4 * i + c]);
    }
}

void zt_develop_rgb8(uint8_t *bytes, size_t stride, const zt_image *image, zt_view view,
                     int first, int last) {
    call_once(&tables_once, make_tables);
    for (int y = first; y < last; y++, bytes += stride)
        develop_row(bytes, image->pixels + (size_t)y * (size_t)image->width * 4, image->width,
                    tables[view]);
}

void zt_develop_rgb16(uint16_t *values, size_t stride, const zt_image *image, zt_view view,
                      int first, int last) {
    for (int y = first; y < last; y++, values += stride / sizeof *values) {
        const float *pixel = image->pixels + (size_t)y * (size_t)image->width * 4;
        for (int x = 0; x < image->width; x++, pixel += 4)
            for (int c = 0; c < 3; c++)
                values[3 * x + c] =
                    (uint16_t)(65535 * zt_develop_value((double)pixel[c], view) + 0.5);
    }
}
