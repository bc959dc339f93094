/* To 8 bits by a table, exactly. The top half of a float's bits (exponent and seven bits of the
 * mantissa) picks a bucket of 2^16 neighbouring floats; in each bucket at most one step from a
 * code to the next one lies, and the bucket knows where. The idea of the buckets is Fabian
 * Giesen's ("float->sRGB8", 2012), whose table interpolates; this one compares and so is never
 * off by one. Owns the two tables, 6.5 KB each, made at the first use. */
#include "image/develop.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>
#include <threads.h>
#if defined __x86_64__
#include <immintrin.h>
#endif

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

typedef float float4 __attribute__((vector_size(16)));
typedef int32_t int4 __attribute__((vector_size(16)));
typedef uint32_t uint4 __attribute__((vector_size(16)));

/* The bits of a pixel's four numbers, cut to the range of the tables and counted from its
 * start. In a vector the cuts are masks; written one by one, compilers make branches of them,
 * which a noisy picture makes slow. */
static uint4 table_places(const float *pixel) {
    const float4 floor = {0x1p-13f, 0x1p-13f, 0x1p-13f, 0x1p-13f};
    const int4 last = {ONE_BITS - 1, ONE_BITS - 1, ONE_BITS - 1, ONE_BITS - 1};
    float4 values;
    memcpy(&values, pixel, sizeof values);
    int4 bits = (int4)values; /* of positive floats, in the same order as they */
    int4 below_one = bits<last, above_floor = values> floor; /* NaN is not */
    bits = (bits & below_one) | (last & ~below_one);
    return ((uint4)bits - FLOOR_BITS) & (uint4)above_floor;
}

static uint8_t code_at(const uint32_t *table, uint32_t place) {
    return (uint8_t)((table[place >> BUCKET_BITS] + (place & 0xffff)) >> BUCKET_BITS);
}

static void develop_pixel(uint8_t *rgbx, const float *pixel, const uint32_t *table) {
    uint4 places = table_places(pixel);
    for (int c = 0; c < 4; c++) rgbx[c] = code_at(table, places[c]);
}

#if defined __x86_64__
#define WIDE __attribute__((target("avx2")))

/* Two pixels at a time, in Intel's own words: the vectors of C know no tables, and compilers
 * take looking up eight numbers at once for dearer than it is. Gives the codes as 32-bit
 * numbers. */
WIDE static inline __m256i codes_of_two(const float *pixels, const uint32_t *table) {
    /* Where one of the two is no number, the larger one is the second. */
    __m256 values = _mm256_max_ps(_mm256_loadu_ps(pixels), _mm256_set1_ps(0x1p-13f));
    __m256i bits =
        _mm256_min_epi32(_mm256_castps_si256(values), _mm256_set1_epi32(ONE_BITS - 1));
    __m256i places = _mm256_sub_epi32(bits, _mm256_set1_epi32(FLOOR_BITS));
    __m256i buckets = _mm256_srli_epi32(places, BUCKET_BITS);
    __m256i steps = _mm256_i32gather_epi32((const int *)table, buckets, sizeof *table);
    __m256i within = _mm256_and_si256(places, _mm256_set1_epi32((1 << BUCKET_BITS) - 1));
    return _mm256_srli_epi32(_mm256_add_epi32(steps, within), BUCKET_BITS);
}

/* Develops pixels by fours; returns how many that are. */
WIDE static int develop_fours(uint8_t *rgbx, const float *pixel, int count,
                              const uint32_t *table) {
    int x = 0;
    for (; x + 4 <= count; x += 4, pixel += 16, rgbx += 16) {
        __m256i words =
            _mm256_packus_epi32(codes_of_two(pixel, table), codes_of_two(pixel + 8, table));
        __m256i bytes = _mm256_packus_epi16(words, words);
        /* One half has pixels 0 and 2, the other 1 and 3. */
        __m128i four = _mm_unpacklo_epi32(_mm256_castsi256_si128(bytes),
                                          _mm256_extracti128_si256(bytes, 1));
        memcpy(rgbx, &four, 16);
    }
    return x;
}

static bool can_be_wide(void) { return __builtin_cpu_supports("avx2"); }
#else
static int develop_fours(uint8_t *rgbx, const float *pixel, int count, const uint32_t *table) {
    (void)rgbx, (void)pixel, (void)count, (void)table;
    return 0;
}

static bool can_be_wide(void) { return false; }
#endif

void zt_develop_rgbx8(uint8_t *bytes, const float *pixels, int count, zt_view view) {
    call_once(&tables_once, make_tables);
    const uint32_t *table = tables[view];
    int x = can_be_wide() ? develop_fours(bytes, pixels, count, table) : 0;
    for (; x < count; x++) develop_pixel(bytes + 4 * x, pixels + 4 * x, table);
}

/* One row, a piece at a time. */
static void develop_row(uint8_t *rgb, const float *pixels, int width, zt_view view) {
    enum { PIECE = 64 };
    uint8_t rgbx[4 * PIECE];
    for (int x = 0; x < width; x += PIECE) {
        int count = width - x < PIECE ? width - x : PIECE;
        zt_develop_rgbx8(rgbx, pixels + 4 * (size_t)x, count, view);
        for (int i = 0; i < count; i++, rgb += 3) memcpy(rgb, rgbx + 4 * i, 3);
    }
}

void zt_develop_rgb8(uint8_t *bytes, size_t stride, const zt_image *image, zt_view view,
                     int first, int last) {
    for (int y = first; y < last; y++, bytes += stride)
        develop_row(bytes, image->pixels + (size_t)y * (size_t)image->width * 4, image->width,
                    view);
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
