/* A view's curve by chords: in each of 512 pieces of an octave it is a straight line. The top
 * bits of a float (exponent and nine of the mantissa) are the piece, the others the place on
 * it. The idea is Fabian Giesen's ("float->sRGB8", 2012).
 *
 * Owns the curves of the views, and the chords of each, 98 KB, made at the first use of the
 * view. */
#include "image/develop.h"

#include <math.h>
#include <string.h>
#include <threads.h>

#include "base/wide.h"
#include "image/dither.h"

/* Below 2^-21 every view gives less than half of 1 / 65535. From there to 8, above every view's
 * white, are 24 octaves. */
#define FLOOR      0x1p-21F
#define FLOOR_BITS UINT32_C(0x35000000)
#define END_BITS   UINT32_C(0x41000000)
enum { LOW_BITS = 14, CHORD_COUNT = (END_BITS - FLOOR_BITS) >> LOW_BITS };

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

/* A piece's begin, and what each of its floats adds. */
typedef struct chord {
    float begin, slope;
} chord;

typedef struct table {
    chord chords[CHORD_COUNT];
    int32_t white_bits; /* of the first float that is white */
} table;

static table tables[ZT_VIEW_COUNT];

static double value_at(uint32_t bits, zt_view view) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return bits > FLOOR_BITS ? zt_develop_value((double)value, view) : 0;
}

static void make_table(zt_view view) {
    table *t = &tables[view];
    float white = (float)views[view].white;
    if ((double)white < views[view].white) white = nextafterf(white, INFINITY);
    memcpy(&t->white_bits, &white, sizeof white);
    for (uint32_t c = 0; c < CHORD_COUNT; c++) {
        uint32_t first = FLOOR_BITS + (c << LOW_BITS), last = first + (1 << LOW_BITS);
        if (first < (uint32_t)t->white_bits && last > (uint32_t)t->white_bits)
            last = (uint32_t)t->white_bits; /* the curve has a corner there */
        double begin = value_at(first, view), rise = value_at(last, view) - begin;
        t->chords[c] = (chord){(float)begin, (float)(rise / (last - first))};
    }
}

static void make_srgb(void) { make_table(ZT_VIEW_SRGB); }
static void make_rec709(void) { make_table(ZT_VIEW_REC709); }
static void make_filmic(void) { make_table(ZT_VIEW_FILMIC); }

static const table *table_of(zt_view view) {
    static once_flag made[ZT_VIEW_COUNT] = {ONCE_FLAG_INIT, ONCE_FLAG_INIT, ONCE_FLAG_INIT,
                                            ONCE_FLAG_INIT};
    static void (*const make[ZT_VIEW_COUNT])(void) = {[ZT_VIEW_SRGB] = make_srgb,
                                                      [ZT_VIEW_REC709] = make_rec709,
                                                      [ZT_VIEW_FILMIC] = make_filmic};
    call_once(&made[view], make[view]);
    return &tables[view];
}

/* The bits of numbers, cut to those of FLOOR .. white and counted from the first. By itself, as
 * on_chords(), this is a loop without branches, which becomes wide; what is between them does
 * not, and is short. */
ZT_CLONES static void find_places(int32_t *restrict places, const float *restrict numbers,
                                  int count, int32_t white_bits) {
    for (int i = 0; i < count; i++) {
        float number = numbers[i] > FLOOR ? numbers[i] : FLOOR; /* NaN is not */
        int32_t bits; /* of positive floats, in the same order as they */
        memcpy(&bits, &number, sizeof bits);
        bits = bits < white_bits ? bits : white_bits;
        places[i] = bits - (int32_t)FLOOR_BITS;
    }
}

ZT_CLONES static void on_chords(float *restrict shown, const int32_t *restrict places,
                                const chord *restrict chords, int count) {
    for (int i = 0; i < count; i++)
        shown[i] =
            chords[i].begin + chords[i].slope * (float)(places[i] & ((1 << LOW_BITS) - 1));
}

enum { PIECE = ZT_DITHER_SIDE }; /* of a row at a time */

ZT_CLONES static void cut_all(float *restrict cut, const float *restrict numbers, int count) {
    for (int i = 0; i < count; i++) {
        float some = numbers[i] > FLOOR ? numbers[i] : 0; /* NaN is not */
        cut[i] = some < 1 ? some : 1;
    }
}

/* A piece of a row as it is. */
static void keep_piece(float *shown, const float *pixels, int width) {
    float cut[4 * PIECE];
    cut_all(cut, pixels, 4 * width);
    for (int x = 0; x < width; x++) memcpy(shown + 3 * x, cut + 4 * x, 3 * sizeof *shown);
}

/* A piece of a row through a view. */
static void develop_piece(float *shown, const float *pixels, int width, const table *table) {
    int32_t all[4 * PIECE], places[3 * PIECE];
    chord chords[3 * PIECE];
    find_places(all, pixels, 4 * width, table->white_bits);
    for (int x = 0; x < width; x++)
        for (int c = 0; c < 3; c++) {
            /* There are 4 times `width`, which the analyzer does not multiply. */
            int32_t place = places[3 * x + c] = all[4 * x + c]; /* NOLINT(*uninitialized*) */
            chords[3 * x + c] = table->chords[place >> LOW_BITS];
        }
    on_chords(shown, places, chords, 3 * width);
}

/* Colours as they are where a pixel is covered. */
static const float *divide(float *divided, const float *pixels, int width) {
    for (int x = 0; x < width; x++, pixels += 4)
        for (int c = 0; c < 4; c++) {
            bool some = c < 3 && pixels[3] > 0;
            divided[4 * x + c] = some ? pixels[c] / pixels[3] : pixels[c];
        }
    return divided;
}

/* Displays of OpenColorIO may give anything. */
static void apply_color(float *shown, int width, const zt_color *color) {
    color->apply(color, shown, width);
    for (int i = 0; i < 3 * width; i++) shown[i] = zt_develop_cut(shown[i]);
}

void zt_develop_row(float *shown, const float *pixels, int width, const zt_developing *how) {
    bool raw = how->view == ZT_VIEW_RAW;
    const table *table = how->color || raw ? NULL : table_of(how->view);
    float divided[4 * PIECE];
    for (int x = 0; x < width; x += PIECE) {
        int count = width - x < PIECE ? width - x : PIECE;
        float *to = shown + 3 * (size_t)x;
        const float *from = pixels + 4 * (size_t)x;
        if (how->alpha == ZT_ALPHA_DIVIDED) from = divide(divided, from, count);
        if (table)
            develop_piece(to, from, count, table);
        else if (!how->color)
            keep_piece(to, from, count);
        else
            for (int i = 0; i < 3 * count; i++) to[i] = from[i / 3 * 4 + i % 3];
    }
    if (how->color) apply_color(shown, width, how->color);
}

ZT_CLONES static void dither(uint8_t *restrict bytes, const float *restrict shown,
                             const uint8_t *restrict thresholds, int count) {
    for (int i = 0; i < count; i++)
        bytes[i] = (uint8_t)zt_dither_code(255 * shown[i], thresholds[i]);
}

ZT_CLONES static void round_16(uint16_t *restrict values, const float *restrict shown,
                               int count) {
    for (int i = 0; i < count; i++) values[i] = (uint16_t)(int32_t)(65535 * shown[i] + 0.5F);
}

enum { ROOM = 16 * PIECE }; /* pixels that are developed at a time */

/* A piece's codes of three and its A become four. */
static void put_8(uint8_t *bytes, const uint8_t *codes, const float *pixels, int width) {
    for (int x = 0; x < width; x++, pixels += 4, bytes += 4, codes += 3) {
        memcpy(bytes, codes, 3);
        bytes[3] = (uint8_t)(255 * zt_develop_cut(pixels[3]) + 0.5F);
    }
}

static void develop_row_8(uint8_t *bytes, const float *pixels, int width,
                          const zt_developing *how, const uint8_t *thresholds) {
    float shown[3 * ROOM];
    uint8_t codes[3 * PIECE];
    bool alpha = how->alpha != ZT_ALPHA_LEFT_OUT;
    for (int x = 0; x < width; x += PIECE, pixels += 4 * PIECE) {
        int count = width - x < PIECE ? width - x : PIECE;
        if (x % ROOM == 0)
            zt_develop_row(shown, pixels, width - x < ROOM ? width - x : ROOM, how);
        dither(alpha ? codes : bytes, shown + 3 * (x % ROOM), thresholds, 3 * count);
        if (alpha) put_8(bytes, codes, pixels, count);
        bytes += (alpha ? 4 : 3) * count;
    }
}

void zt_develop_8(uint8_t *bytes, size_t stride, const zt_image *image,
                  const zt_developing *how, int first, int last) {
    uint8_t thresholds[3 * PIECE]; /* one for the colours of a pixel, so that grey stays grey */
    for (int y = first; y < last; y++, bytes += stride) {
        for (int i = 0; i < 3 * PIECE; i++) thresholds[i] = zt_dither_row(y)[i / 3];
        develop_row_8(bytes, image->pixels + (size_t)y * (size_t)image->width * 4, image->width,
                      how, thresholds);
    }
}

static void put_16(uint16_t *values, const uint16_t *codes, const float *pixels, int width) {
    for (int x = 0; x < width; x++, pixels += 4, values += 4, codes += 3) {
        memcpy(values, codes, 3 * sizeof *codes);
        values[3] = (uint16_t)(65535 * zt_develop_cut(pixels[3]) + 0.5F);
    }
}

static void develop_row_16(uint16_t *values, const float *pixels, int width,
                           const zt_developing *how) {
    float shown[3 * ROOM];
    uint16_t codes[3 * ROOM];
    bool alpha = how->alpha != ZT_ALPHA_LEFT_OUT;
    for (int x = 0; x < width; x += ROOM, pixels += 4 * ROOM) {
        int count = width - x < ROOM ? width - x : ROOM;
        zt_develop_row(shown, pixels, count, how);
        round_16(alpha ? codes : values, shown, 3 * count);
        if (alpha) put_16(values, codes, pixels, count);
        values += (alpha ? 4 : 3) * count;
    }
}

void zt_develop_16(uint16_t *values, size_t stride, const zt_image *image,
                   const zt_developing *how, int first, int last) {
    for (int y = first; y < last; y++, values += stride / sizeof *values)
        develop_row_16(values, image->pixels + (size_t)y * (size_t)image->width * 4,
                       image->width, how);
}
