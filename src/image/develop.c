/* To 8 bits by a table, exactly. The top half of a float's bits (exponent and seven bits of the
 * mantissa) picks a bucket of 2^16 neighbouring floats; in each bucket at most one step from a
 * code to the next one lies, and the bucket knows where. The idea of the buckets is Fabian
 * Giesen's ("float->sRGB8", 2012), whose table interpolates; this one compares and so is never
 * off by one.
 *
 * To 16 bits by chords, exactly: in each of 128 pieces of an octave a straight line tells the
 * code to within one, and the place where the next code begins settles it.
 *
 * Owns the curves of the views, and of each a table for 8 bits, 8 KB, and one for 16, 300 KB,
 * made at the first use of the view; the latter takes some 50 ms. */
#include "image/develop.h"

#include <assert.h>
#include <math.h>
#include <string.h>
#include <threads.h>

#include "base/wide.h"

/* Below 2^-13 every view gives 0 of 255. From there to 8, above every view's white, are 16
 * octaves. */
#define FLOOR_BITS UINT32_C(0x39000000)
#define END_BITS   UINT32_C(0x41000000)
enum { BUCKET_BITS = 16, BUCKET_COUNT = (END_BITS - FLOOR_BITS) >> BUCKET_BITS };

static double keep(double linear) { return linear; }

/* IEC 61966-2-1. */
static double linear_to_srgb(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * pow(linear, 1 / 2.4) - 0.055;
}

double zt_srgb_to_linear(double display) {
    return display <= 0.04045 ? display / 12.92 : pow((display + 0.055) / 1.055, 2.4);
}

/* ITU-R BT.709-6, item 1.2. Its 1.099 and 0.018 are rounded, and leave a gap of 16 codes of
 * 65536 between the two parts; with all their digits (from the two equations in table 4 of
 * ITU-R BT.2020-2) the parts meet smoothly, nowhere further from the rounded ones than a tenth
 * of a code of 8 bits. */
static double linear_to_rec709(double linear) {
    const double a = 1.09929682680944, b = 0.018053968510807;
    return linear < b ? 4.5 * linear : a * pow(linear, 0.45) - (a - 1);
}

/* John Hable, "Filmic Tonemapping Operators" (2010), with the numbers printed there: light is
 * doubled, and 11.2 of it is white.
 *
 *   (x (A x + C B) + D E) / (x (A x + B) + D F) - E / F
 *   A = 0.15, B = 0.5, C = 0.1, D = 0.2, E = 0.02, F = 0.3
 *
 * is here one fraction, without the factor 1 / F, which the division by white cancels: so small
 * numbers lose no digits, and 0 is 0. It rises everywhere, as all terms of its derivative are
 * positive. */
#define FILMIC_WHITE 5.6
static double filmic_part(double linear) {
    double x = 2 * linear;
    return x * (0.042 * x + 0.005) / (x * (0.15 * x + 0.5) + 0.06);
}

static double linear_to_filmic(double linear) {
    return linear_to_srgb(filmic_part(linear) / filmic_part(FILMIC_WHITE));
}

/* `curve` rises from 0 at 0 to 1 at `white`. */
static const struct {
    const char *name;
    double white;
    double (*curve)(double linear);
} views[ZT_VIEW_COUNT] = {
    [ZT_VIEW_RAW] = {"raw", 1, keep},
    [ZT_VIEW_SRGB] = {"srgb", 1, linear_to_srgb},
    [ZT_VIEW_REC709] = {"rec709", 1, linear_to_rec709},
    [ZT_VIEW_FILMIC] = {"filmic", FILMIC_WHITE, linear_to_filmic},
};

const char *zt_view_name(zt_view view) { return views[view].name; }

double zt_develop_value(double linear, zt_view view) {
    if (!(linear > 0)) return 0;
    return linear < views[view].white ? views[view].curve(linear) : 1;
}

/* The bits of the last float below white, which has the highest code already. */
static uint32_t last_bits(zt_view view) {
    float white = (float)views[view].white;
    if ((double)white >= views[view].white) white = nextafterf(white, 0);
    uint32_t bits;
    memcpy(&bits, &white, sizeof bits);
    return bits;
}

/* (code << 16) + 2^16 - step: with the float's low 16 bits added, the carry is the step from
 * the bucket's first code to the next. Without a step, `step` is 2^16, and nothing carries. */
typedef struct table {
    uint32_t buckets[BUCKET_COUNT];
    uint32_t last; /* last_bits() */
} table;

static table tables[ZT_VIEW_COUNT];

static uint32_t exact_code(uint32_t bits, zt_view view) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return (uint32_t)(255 * zt_develop_value((double)value, view) + 0.5);
}

static void make_table(zt_view view) {
    tables[view].last = last_bits(view);
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
        tables[view].buckets[b] = (code << BUCKET_BITS) + (1 << BUCKET_BITS) - high;
    }
}

static void make_raw(void) { make_table(ZT_VIEW_RAW); }
static void make_srgb(void) { make_table(ZT_VIEW_SRGB); }
static void make_rec709(void) { make_table(ZT_VIEW_REC709); }
static void make_filmic(void) { make_table(ZT_VIEW_FILMIC); }

/* The bits of numbers, cut to those of `floor` .. `last` and counted from the first. By itself,
 * this is a loop without branches, which becomes wide. */
ZT_CLONES static void find_places(uint32_t *restrict places, const float *restrict numbers,
                                  int count, float floor, uint32_t last) {
    int32_t floor_bits;
    memcpy(&floor_bits, &floor, sizeof floor_bits);
    for (int i = 0; i < count; i++) {
        float number = numbers[i] > floor ? numbers[i] : floor; /* NaN is not */
        int32_t bits; /* of positive floats, in the same order as they */
        memcpy(&bits, &number, sizeof bits);
        bits = bits < (int32_t)last ? bits : (int32_t)last;
        places[i] = (uint32_t)(bits - floor_bits);
    }
}

static uint8_t code_at(const uint32_t *buckets, uint32_t place) {
    return (uint8_t)((buckets[place >> BUCKET_BITS] + (place & 0xffff)) >> BUCKET_BITS);
}

enum { PIECE = 64 }; /* of a row at a time */

static void develop_row(uint8_t *rgb, const float *pixels, int width, const table *table) {
    uint32_t places[4 * PIECE] = {0};
    for (int x = 0; x < width; x += PIECE) {
        int count = width - x < PIECE ? width - x : PIECE;
        find_places(places, pixels + 4 * (size_t)x, 4 * count, 0x1p-13f, table->last);
        for (int i = 0; i < count; i++, rgb += 3)
            for (int c = 0; c < 3; c++) rgb[c] = code_at(table->buckets, places[4 * i + c]);
    }
}

void zt_develop_rgb8(uint8_t *bytes, size_t stride, const zt_image *image, zt_view view,
                     int first, int last) {
    static once_flag made[ZT_VIEW_COUNT] = {ONCE_FLAG_INIT, ONCE_FLAG_INIT, ONCE_FLAG_INIT,
                                            ONCE_FLAG_INIT};
    static void (*const make[ZT_VIEW_COUNT])(void) = {make_raw, make_srgb, make_rec709,
                                                      make_filmic};
    call_once(&made[view], make[view]);
    for (int y = first; y < last; y++, bytes += stride)
        develop_row(bytes, image->pixels + (size_t)y * (size_t)image->width * 4, image->width,
                    &tables[view]);
}

/* Below 2^-21 every view gives 0 of 65535. */
#define DEEP_FLOOR_BITS UINT32_C(0x35000000)
enum { DEEP_MAX = 65535, CHORD_COUNT = (END_BITS - DEEP_FLOOR_BITS) >> BUCKET_BITS };

/* Of one view. A chord is the code at its piece's begin and what the piece adds, both times
 * 2^16 and a quarter of a code too low; so it tells the code, or the one before. */
typedef struct deep_table {
    struct {
        uint32_t code, rise;
    } chords[CHORD_COUNT];
    uint32_t begins[DEEP_MAX + 2]; /* the first place of each code */
    uint32_t last;                 /* last_bits() */
} deep_table;

static deep_table deep_tables[ZT_VIEW_COUNT];

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
    table->last = last_bits(view);
    uint32_t end_place = table->last - DEEP_FLOOR_BITS;
    for (uint32_t p = 0; p <= end_place >> BUCKET_BITS; p++) {
        uint32_t first = p << BUCKET_BITS, last = first + piece_size - 1;
        if (last > end_place) last = end_place; /* the curve has a corner at white */
        double begin = deep_value(first, view), end = deep_value(last, view);
        double low = begin < 0.25 ? 0 : begin - 0.25;
        table->chords[p].code = (uint32_t)(low * piece_size);
        table->chords[p].rise =
            (uint32_t)((end - begin) * piece_size / (last - first + 1) * piece_size);
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
static void make_deep_rec709(void) { make_deep_table(ZT_VIEW_REC709); }
static void make_deep_filmic(void) { make_deep_table(ZT_VIEW_FILMIC); }

static void develop_deep_row(uint16_t *rgb, const float *pixels, int width,
                             const deep_table *table) {
    uint32_t places[4 * PIECE] = {0};
    for (int x = 0; x < width; x += PIECE) {
        int count = width - x < PIECE ? width - x : PIECE;
        find_places(places, pixels + 4 * (size_t)x, 4 * count, 0x1p-21f, table->last);
        for (int i = 0; i < count; i++, rgb += 3)
            for (int c = 0; c < 3; c++)
                rgb[c] = (uint16_t)deep_code_at(table, places[4 * i + c]);
    }
}

void zt_develop_rgb16(uint16_t *values, size_t stride, const zt_image *image, zt_view view,
                      int first, int last) {
    static once_flag made[ZT_VIEW_COUNT] = {ONCE_FLAG_INIT, ONCE_FLAG_INIT, ONCE_FLAG_INIT,
                                            ONCE_FLAG_INIT};
    static void (*const make[ZT_VIEW_COUNT])(void) = {make_deep_raw, make_deep_srgb,
                                                      make_deep_rec709, make_deep_filmic};
    call_once(&made[view], make[view]);
    for (int y = first; y < last; y++, values += stride / sizeof *values)
        develop_deep_row(values, image->pixels + (size_t)y * (size_t)image->width * 4,
                         image->width, &deep_tables[view]);
}
