/* The points of samples: that they are the nets they are said to be, scrambled alike in all
 * places, without a trace of each other, as good as theory has it, and the same by any way.
 *
 * The keys are fixed, so that a test which passes always does; limits are those that a perfect
 * sampler would miss with a probability of less than 1e-6 for all statistics together: 5.7
 * standard deviations, 6e-9 each on one side, of which there are less than a hundred. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "chance.h"
#include "scenes.h"
#include "tracer/sampler.h"

static const double deviations = 5.7;

typedef struct point {
    float u, v;
} point;

static point point_of(uint32_t key, uint32_t dimension, uint32_t sample) {
    point p;
    zt_sample_point(&p.u, &p.v, key, dimension, sample);
    return p;
}

/* Keys as pixels have them. */
static uint32_t pixel_key(int i) { return zt_sample_key(7, i % 512, i / 512); }

/* Sobol's second dimension by its direction numbers, as Bratley and Fox have it ("Algorithm
 * 659", 1988): those of the polynomial x + 1. */
static uint32_t second_by_directions(uint32_t index) {
    uint32_t result = 0, direction = UINT32_C(1) << 31;
    for (int bit = 0; bit < 32; bit++, direction ^= direction >> 1)
        if (index >> bit & 1) result ^= direction;
    return result;
}

static void second_dimension_is_sobols(void **state) {
    (void)state;
    uint64_t random = 1;
    for (uint32_t i = 0; i < 100000; i++) {
        uint32_t index = i < 5000 ? i : (uint32_t)(test_random(&random) * 4294967296.0);
        uint32_t reversed = zt_sample_reverse(index);
        assert_int_equal(zt_sample_reverse(reversed), index);
        assert_int_equal(zt_sample_second(reversed), second_by_directions(index));
    }
}

/* Of the points of 2^m samples in a row, from a multiple of it on, each elementary interval,
 * 2^a columns by 2^(m - a) rows, holds exactly one: a (0, m, 2)-net. */
static void blocks_are_nets(void **state) {
    (void)state;
    enum { M_MAX = 9, PIXELS = 40, BLOCKS = 3 };
    static const uint32_t dimensions[] = {ZT_DIMENSION_PIXEL, ZT_DIMENSION_LENS,
                                          ZT_DIMENSION_TIME, ZT_DIMENSION_LAMPS,
                                          ZT_DIMENSION_LAMPS + 77};
    static const uint32_t begins[BLOCKS] = {0, 1, 4999};
    for (int k = 0; k < PIXELS * 5 * BLOCKS; k++) {
        uint32_t key = pixel_key(k / 15), dimension = dimensions[k / BLOCKS % 5];
        for (int m = 0; m <= M_MAX; m++) {
            bool met[M_MAX + 1][1 << M_MAX] = {{false}};
            for (uint32_t i = 0; i < UINT32_C(1) << m; i++) {
                point p = point_of(key, dimension, (begins[k % BLOCKS] << m) + i);
                assert_true(p.u >= 0 && p.u < 1 && p.v >= 0 && p.v < 1);
                for (int a = 0; a <= m; a++) {
                    int column = (int)(p.u * (float)(1 << a));
                    int row = (int)(p.v * (float)(1 << (m - a)));
                    bool *cell = &met[a][(column << (m - a)) + row];
                    if (*cell) fail_msg("m = %d, a = %d: two points in one interval", m, a);
                    *cell = true;
                }
            }
        }
    }
}

/* Over pixels, any sample lies anywhere alike; so do the lower bits of its places. */
static void uniform_over_keys(void **state) {
    (void)state;
    enum { PIXELS = 1 << 16, SIDE = 16, CELLS = SIDE * SIDE };
    static const uint32_t samples[] = {0, 1, 6, 255, 4096, 60001};
    for (int d = 0; d < 4; d++)
        for (int s = 0; s < 6; s++) {
            int high[CELLS] = {0}, low[CELLS] = {0};
            for (int k = 0; k < PIXELS; k++) {
                point p = point_of(pixel_key(k), (uint32_t)d, samples[s]);
                int u = (int)(p.u * 0x1p24f), v = (int)(p.v * 0x1p24f);
                high[(u >> 20) * SIDE + (v >> 20)]++;
                low[(u >> 8 & 15) * SIDE + (v >> 8 & 15)]++;
            }
            double limit = chi_square_limit(CELLS - 1, deviations),
                   expected = (double)PIXELS / CELLS;
            assert_true(chi_square(high, CELLS, expected) < limit);
            assert_true(chi_square(low, CELLS, expected) < limit);
        }
}

/* Two inputs whose first different bit is `bit` part there; below it their outputs know nothing
 * of each other. Counted over seeds: four bits of each. */
static void scrambling_is_nested(void **state) {
    (void)state;
    enum { SEEDS = 1 << 16 };
    static const uint32_t inputs[] = {0, 0x9b60933au, 0xffffffffu, 0x00000140u};
    for (int i = 0; i < 4; i++)
        for (int bit = 0; bit < 20; bit += 3) {
            int counts[256] = {0};
            uint32_t top = bit ? ~UINT32_C(0) << (32 - bit) : 0;
            for (uint32_t s = 0; s < SEEDS; s++) {
                uint32_t seed = zt_sample_mix(s), one = inputs[i],
                         two = one ^ UINT32_C(1) << (31 - bit);
                one = zt_sample_reverse(zt_sample_scramble(zt_sample_reverse(one), seed));
                two = zt_sample_reverse(zt_sample_scramble(zt_sample_reverse(two), seed));
                assert_true(((one ^ two) & top) == 0 && (one ^ two) >> (31 - bit) & 1);
                counts[(one >> (27 - bit) & 15) << 4 | (two >> (27 - bit) & 15)]++;
            }
            double got = chi_square(counts, 256, SEEDS / 256.0);
            if (got >= chi_square_limit(255, deviations))
                fail_msg("input %08x, bit %d: chi-square %.0f", inputs[i], bit, got);
        }
}

/* ---- independence ---------------------------------------------------------------------------
 */

/* Owen's scramble as he defines it ("Randomly permuted (t, m, s)-nets and (t, s)-sequences",
 * 1995): for each beginning of a number a coin of its own says whether the next bit flips. Of
 * the upper `depth` bits. */
static uint32_t by_coins(uint32_t x, uint64_t key, int depth) {
    uint32_t result = x;
    for (int bit = 0; bit < depth; bit++) {
        uint64_t node = (uint64_t)bit << 32 | (bit ? x >> (32 - bit) : 0);
        result ^= (uint32_t)(zt_random_key(key, node) & 1) << (31 - bit);
    }
    return result;
}

/* The same points made without any shortcut: the first 2^16 of them, to 12 bits and a rest. */
static point point_by_coins(uint32_t key, uint32_t dimension, uint32_t sample) {
    uint64_t seed = zt_random_key(zt_random_key(1234, key), dimension);
    uint32_t index = by_coins(sample << 16, zt_random_key(seed, 0), 16) >> 16;
    uint32_t u = by_coins(zt_sample_reverse(index), zt_random_key(seed, 1), 12);
    uint32_t v = by_coins(second_by_directions(index), zt_random_key(seed, 2), 12);
    uint64_t rest = zt_random_key(zt_random_key(seed, 3), sample);
    return (point){zt_sample_unit((u & 0xfff00000u) | (uint32_t)(rest & 0xfffff)),
                   zt_sample_unit((v & 0xfff00000u) | (uint32_t)(rest >> 44))};
}

/* One of a point's two numbers: of which pixel, counted from another, and for which end. */
typedef struct strand {
    int key_step;
    uint32_t dimension;
    bool second;
} strand;

typedef point point_function(uint32_t key, uint32_t dimension, uint32_t sample);

static double strand_at(strand s, point_function *f, int key, uint32_t sample) {
    point p = f(pixel_key(key + s.key_step), s.dimension, sample);
    return (double)(s.second ? p.v : p.u);
}

/* The correlation r of two strands over the samples of a pixel, over pixels. */
typedef struct correlation {
    double mean, square, square_error; /* of r, of r^2, and the standard error of the latter */
    double unevenness;                 /* chi-square of the pairs of numbers */
} correlation;

enum { KEYS = 4096, SAMPLES = 16, SIDE = 16, CELLS = SIDE * SIDE };

static correlation correlate(const strand pair[2], point_function *f) {
    int counts[CELLS] = {0};
    double sum = 0, squares = 0, fourths = 0;
    for (int k = 0; k < KEYS; k++) {
        double r = 0;
        for (uint32_t s = 0; s < SAMPLES; s++) {
            double a = strand_at(pair[0], f, k, s), b = strand_at(pair[1], f, k, s);
            counts[(int)(a * SIDE) * SIDE + (int)(b * SIDE)]++;
            r += 12 * (a - 0.5) * (b - 0.5) / SAMPLES;
        }
        sum += r;
        squares += r * r;
        fourths += r * r * r * r;
    }
    double square = squares / KEYS;
    return (correlation){sum / KEYS, square, sqrt((fourths / KEYS - square * square) / KEYS),
                         chi_square(counts, CELLS, (double)KEYS * SAMPLES / CELLS)};
}

/* Numbers of the same samples for different ends, or of neighbours, know of each other only
 * what those of true coins do: seen together they fill the square evenly, their correlation
 * over the samples of a pixel is 0 in the mean over pixels, and spreads as it does there. */
static void ends_are_independent(void **state) {
    (void)state;
    static const strand pairs[][2] = {
        {{0, ZT_DIMENSION_PIXEL, false}, {0, ZT_DIMENSION_LENS, false}},
        {{0, ZT_DIMENSION_PIXEL, false}, {0, ZT_DIMENSION_LENS, true}},
        {{0, ZT_DIMENSION_PIXEL, true}, {0, ZT_DIMENSION_TIME, false}},
        {{0, ZT_DIMENSION_LENS, true}, {0, ZT_DIMENSION_TIME, false}},
        {{0, ZT_DIMENSION_TIME, false}, {0, ZT_DIMENSION_LAMPS, true}},
        {{0, ZT_DIMENSION_LAMPS, false}, {0, ZT_DIMENSION_LAMPS + 1, false}},
        {{0, ZT_DIMENSION_LAMPS, true}, {0, ZT_DIMENSION_LAMPS + 64, true}},
        {{0, ZT_DIMENSION_PIXEL, false}, {0, ZT_DIMENSION_PIXEL, true}},
        {{0, ZT_DIMENSION_PIXEL, false}, {1, ZT_DIMENSION_PIXEL, false}},
        {{0, ZT_DIMENSION_LENS, false}, {512, ZT_DIMENSION_LENS, false}},
        {{0, ZT_DIMENSION_TIME, false}, {513, ZT_DIMENSION_TIME, false}},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        correlation is = correlate(pairs[i], point_of),
                    should = correlate(pairs[i], point_by_coins);
        if (is.unevenness >= chi_square_limit(CELLS - 1, deviations))
            fail_msg("pair %zu: uneven", i);
        if (fabs(is.mean) >= deviations * sqrt(is.square / KEYS))
            fail_msg("pair %zu: correlation %g", i, is.mean);
        double error = hypot(is.square_error, should.square_error);
        if (fabs(is.square - should.square) >= deviations * error)
            fail_msg("pair %zu: correlations spread %.4f, not %.4f", i, is.square,
                     should.square);
    }
}

/* ---- convergence ----------------------------------------------------------------------------
 */

typedef double integrand(const double *x);
static double smooth(const double *x) { return exp(x[0] + x[1]); }
static double half_covered(const double *x) { return x[1] < 0.31 + 0.37 * x[0]; }
static double round_spot(const double *x) { return x[0] * x[0] + x[1] * x[1] < 0.7; }
static double through_lens(const double *x) { /* an edge, out of focus, moving */
    return x[0] + 0.5 * x[2] + 0.7 * x[4] < 1.03;
}

enum { POINTS_LOG = 10, TRIALS = 256 };

/* The root mean square error of the mean of 2^m points for each m, over pixels; `white`: of
 * independent random numbers. Checks that none of the means is off in one direction. */
static void errors_of(double errors[POINTS_LOG + 1], integrand *f, double truth, bool white) {
    uint64_t random = 99;
    double squares[POINTS_LOG + 1] = {0}, sums[POINTS_LOG + 1] = {0};
    for (int k = 0; k < TRIALS; k++) {
        double sum = 0;
        for (uint32_t s = 0, m = 0; s < 1 << POINTS_LOG; s++) {
            double x[6];
            for (uint32_t d = 0; d < 3; d++) {
                point p = point_of(pixel_key(k), d, s);
                x[2 * d] = white ? test_random(&random) : (double)p.u;
                x[2 * d + 1] = white ? test_random(&random) : (double)p.v;
            }
            sum += f(x);
            if (s + 1 != UINT32_C(1) << m) continue;
            double error = sum / (s + 1) - truth;
            squares[m] += error * error;
            sums[m] += error;
            m++;
        }
    }
    for (int m = 0; m <= POINTS_LOG; m++) {
        errors[m] = sqrt(squares[m] / TRIALS);
        assert_true(fabs(sums[m] / TRIALS) < deviations * errors[m] / sqrt(TRIALS));
    }
}

/* The slope of the straight line through log error over log count, by least squares. */
static double slope_of(const double errors[POINTS_LOG + 1], int from) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int m = from; m <= POINTS_LOG; m++) {
        double e = log2(errors[m]);
        n++, x += m, y += e, xx += m * m, xy += m * e;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

static void assert_slope(integrand *f, double truth, bool white, double low, double high) {
    double errors[POINTS_LOG + 1];
    errors_of(errors, f, truth, white);
    double slope = slope_of(errors, 2);
    if (slope < low || slope > high)
        fail_msg("slope %.3f is not in %.2f .. %.2f", slope, low, high);
}

/* Errors fall as theory has it for scrambled nets: smooth integrands by n^-1.5 (Owen,
 * "Scrambled net variance for integrals of smooth functions", 1997), those with an edge by
 * n^-0.75 (He and Wang, "On the convergence rate of randomized quasi-Monte Carlo for
 * discontinuous functions", 2015); independent numbers by n^-0.5, which shows that the measure
 * is right. */
static void errors_fall_as_they_should(void **state) {
    (void)state;
    const double e = 2.71828182845904523536, spot = 0.25 * 3.14159265358979323846 * 0.7;
    assert_slope(smooth, (e - 1) * (e - 1), true, -0.55, -0.45);
    assert_slope(smooth, (e - 1) * (e - 1), false, -1.65, -1.35);
    assert_slope(half_covered, 0.31 + 0.37 / 2, true, -0.55, -0.45);
    assert_slope(half_covered, 0.31 + 0.37 / 2, false, -0.85, -0.67);
    assert_slope(round_spot, spot, false, -0.85, -0.67);
}

/* The volume below x + a y + b z = c in the unit cube, by inclusion and exclusion. */
static double volume_below(double a, double b, double c) {
    double sum = 0;
    for (int i = 0; i < 8; i++) {
        double rest = c - (i & 1) - (i & 2 ? a : 0) - (i & 4 ? b : 0);
        double part = rest > 0 ? rest * rest * rest / (6 * a * b) : 0;
        sum += __builtin_popcount((unsigned)i) % 2 ? -part : part;
    }
    return sum;
}

/* An integrand of several ends, each of which has points of its own, is never worse off than
 * with independent numbers. */
static void padding_does_no_harm(void **state) {
    (void)state;
    double padded[POINTS_LOG + 1], white[POINTS_LOG + 1];
    double truth = volume_below(0.5, 0.7, 1.03);
    errors_of(padded, through_lens, truth, false);
    errors_of(white, through_lens, truth, true);
    for (int m = 2; m <= POINTS_LOG; m++) assert_true(padded[m] < white[m]);
    assert_true(slope_of(padded, 2) < -0.5);
}

/* ---- the same by any way --------------------------------------------------------------------
 */

#define WIDE_COPY(name, attributes)                                                            \
    attributes static void name(float *restrict u, float *restrict v,                          \
                                const uint32_t *restrict key, uint32_t dimension,              \
                                uint32_t sample, int count) {                                  \
        for (int i = 0; i < count; i++)                                                        \
            zt_sample_point(&u[i], &v[i], key[i], dimension, sample);                          \
    }
WIDE_COPY(plain, __attribute__((noinline)))
#if defined __x86_64__ && !defined __clang__
WIDE_COPY(width_128, __attribute__((noinline, optimize("O3"))))
WIDE_COPY(width_256, __attribute__((noinline, optimize("O3"), target("arch=x86-64-v3"))))
WIDE_COPY(width_512, __attribute__((noinline, optimize("O3"), target("arch=x86-64-v4"))))
#endif

/* Many pixels at once, by each width of instructions that there is, any number of them, from
 * any place on; and one alone, in any order: the same bits, and nothing written beyond. */
static void same_by_any_way(void **state) {
    (void)state;
    enum { MOST = 70 };
    typedef void points(float *, float *, const uint32_t *, uint32_t, uint32_t, int);
    points *ways[5] = {zt_sample_points, plain};
    int way_count = 2;
#if defined __x86_64__ && !defined __clang__
    ways[way_count++] = width_128;
    if (__builtin_cpu_supports("avx2")) ways[way_count++] = width_256;
    if (__builtin_cpu_supports("avx512bw")) ways[way_count++] = width_512;
#endif
    static const uint32_t samples[] = {0, 1, 17, 65535, 0x80000000u, 0xffffffffu};
    for (int w = 0; w < way_count; w++)
        for (int count = 0; count < MOST; count++) {
            uint32_t key[MOST], sample = samples[count % 6], dimension = (uint32_t)count / 6;
            float u[MOST + 1], v[MOST + 1];
            for (int i = 0; i < MOST; i++) key[i] = pixel_key(count * MOST + i);
            u[count] = v[count] = -1;
            ways[w](u, v, key, dimension, sample, count);
            assert_true(u[count] == -1 && v[count] == -1);
            for (int i = count - 1; i >= 0; i--) {
                point p = point_of(key[i], dimension, sample);
                assert_true(p.u == u[i] && p.v == v[i]);
            }
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(second_dimension_is_sobols),
        cmocka_unit_test(blocks_are_nets),
        cmocka_unit_test(uniform_over_keys),
        cmocka_unit_test(scrambling_is_nested),
        cmocka_unit_test(ends_are_independent),
        cmocka_unit_test(errors_fall_as_they_should),
        cmocka_unit_test(padding_does_no_harm),
        cmocka_unit_test(same_by_any_way),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
