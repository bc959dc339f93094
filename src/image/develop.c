/* To 8 bits by a table, exactly. The top half of a float's bits (exponent and seven bits of the
 * mantissa) picks a bucket of 2^16 neighbouring floats; in each bucket at most one step from a
 * code to the next one lies, and the bucket knows where. The idea of the buckets is Fabian
 * Giesen's ("float->sRGB8", 2012), whose table interpolates; this one compares and so is never
 * off by one. Owns the two tables, 6.5 KB each, made at the first use.
 *
 * To 16 bits by chords, exactly: in each of 128 pieces of an octave a straight line tells the
 * code to within one, and the place where the next code begins settles it. Owns two tables of
 * these, 300 KB each, each made at the first use of its view in some 50 ms. */
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
    VIEWS = ZT_VIEW_COUNT
};

/* (code << 16) + 2^16 - step: with the float's low 16 bits added, the carry is the step from
 * the bucket's first code to the next. Without a step, `step` is 2^16, and nothing carries. */
static uint32_t tables[VIEWS][BUCKET_COUNT];
static once_flag tables_once = ONCE_FLAG_INIT;

const char *zt_view_name(zt_view view) {
    static const char *const names[ZT_VIEW_COUNT] = {"raw", "srgb", "rec709", "filmic"};
    return names[view];
}

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

/* The bits of numbers, cut to the range of the tables and counted from its start, which is that
 * of `floor`. By itself, this is a loop without branches, which becomes wide. */
ZT_CLONES static void find_places(uint32_t *restrict places, const float *restrict numbers,
                                  int count, float floor) {
    int32_t floor_bits;
    memcpy(&floor_bits, &floor, sizeof floor_bits);
    for (int i = 0; i < count; i++) {
        float number = numbers[i] > floor ? numbers[i] : floor; /* NaN is not */
        int32_t bits; /* of positive floats, in the same order as they */
        memcpy(&bits, &number, sizeof bits);
        bits = bits < (int32_t)ONE_BITS ? bits : (int32_t)ONE_BITS - 1;
        places[i] = (uint32_t)(bits - floor_bits);
    }
}

static uint8_t code_at(const uint32_t *table, uint32_t place) {
    return (uint8_t)((table[place >> BUCKET_BITS] + (place & 0xffff)) >> BUCKET_BITS);
}

enum { PIECE = 64 }; /* of a row at a time */

static void develop_row(uint8_t *rgb, const float *pixels, int width, const uint32_t *table) {
    uint32_t places[4 * PIECE] = {0};
    for (int x = 0; x < width; x += PIECE) {
        int count = width - x < PIECE ? width - x : PIECE;
        find_places(places, pixels + 4 * (size_t)x, 4 * count, 0x1p-13f);
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

/* Below 2^-21 every view gives 0 of 65535. */
#define DEEP_FLOOR_BITS UINT32_C(0x35000000)
enum { DEEP_MAX = 65535, CHORD_COUNT = (ONE_BITS - DEEP_FLOOR_BITS) >> BUCKET_BITS };

/* Of one view. A chord is the code at its piece's begin and what the piece adds, both times
 * 2^16 and a quarter of a code too low; so it tells the code, or the one before. */
typedef struct deep_table {
    struct {
        uint32_t code, rise;
    } chords[CHORD_COUNT];
    uint32_t begins[DEEP_MAX + 2]; /* the first place of each code */
} deep_table;

static deep_table deep_tables[VIEWS];
static once_flag deep_once[VIEWS] = {ONCE_FLAG_INIT, ONCE_FLAG_INIT};

/* The exact code at a place, not yet rounded down. */
static double deep_value(uint32_t place, zt_view view) {
    uint32_t bits = DEEP_FLOOR_BITS + place;
    float value;
    memcpy(&value, &bits, sizeof value);
    return DEEP_MAX * zt_develop_value((double)value, view) + 0.5;
}

static uint32_t deep_code_at(const deep_table *table, uint32_t place) {
    uint32_t piece = place >> BUCKET_BITS, low = place & 0xffff;
    uint32_t code = table->chords[piece].code +
                    (uint32_t)((uint64_t)table->chords[piece].rise * low >> BUCKET_BITS);
    code >>= BUCKET_BITS;
    return code + (place >= table->begins[code + 1]);
}

static void make_deep_table(zt_view view) {
    deep_table *table = &deep_tables[view];
    uint32_t code = 0, piece_size = UINT32_C(1) << BUCKET_BITS;
    for (uint32_t p = 0; p < CHORD_COUNT; p++) {
        uint32_t first = p << BUCKET_BITS, last = first + piece_size - 1;
        double begin = deep_value(first, view), end = deep_value(last, view);
        double low = begin < 0.25 ? 0 : begin - 0.25;
        table->chords[p].code = (uint32_t)(low * piece_size);
        table->chords[p].rise = (uint32_t)((end - begin) * piece_size);
        for (; code < (uint32_t)end; code++) { /* where the next code begins, by halving */
            uint32_t before = first > 0 ? first - 1 : 0, after = last;
            if (code > 0 && table->begins[code] > first) before = table->begins[code];
            while (after - before > 1) {
                uint32_t middle = before + (after - before) / 2;
                if ((uint32_t)deep_value(middle, view) > code)
                    after = middle;
                else
                    before = middle;
            }
            table->begins[code + 1] = after;
        }
    }
    table->begins[DEEP_MAX + 1] = UINT32_MAX;
}

static void make_deep_raw(void) { make_deep_table(ZT_VIEW_RAW); }
static void make_deep_srgb(void) { make_deep_table(ZT_VIEW_SRGB); }

static void develop_deep_row(uint16_t *rgb, const float *pixels, int width,
                             const deep_table *table) {
    uint32_t places[4 * PIECE] = {0};
    for (int x = 0; x < width; x += PIECE) {
        int count = width - x < PIECE ? width - x : PIECE;
        find_places(places, pixels + 4 * (size_t)x, 4 * count, 0x1p-21f);
        for (int i = 0; i < count; i++, rgb += 3)
            for (int c = 0; c < 3; c++)
                rgb[c] = (uint16_t)deep_code_at(table, places[4 * i + c]);
    }
}

void zt_develop_rgb16(uint16_t *values, size_t stride, const zt_image *image, zt_view view,
                      int first, int last) {
    call_once(&deep_once[view], view == ZT_VIEW_RAW ? make_deep_raw : make_deep_srgb);
    for (int y = first; y < last; y++, values += stride / sizeof *values)
        develop_deep_row(values, image->pixels + (size_t)y * (size_t)image->width * 4,
                         image->width, &deep_tables[view]);
}
