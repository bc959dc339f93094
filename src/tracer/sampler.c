#include "tracer/sampler.h"

#include "base/random.h"
#include "tracer/isa.h"

static inline uint32_t reverse_bits(uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/* Owen's nested uniform scramble: each bit is flipped or not depending on the bits above it.
 * The hash works upwards, so it runs on reversed bits (the constants are Burley's). */
static inline uint32_t scramble(uint32_t x, uint32_t seed) {
    x = reverse_bits(x);
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return reverse_bits(x);
}

/* Sobol's second dimension: its generator matrix is Pascal's triangle modulo 2, the fifth
 * Kronecker power of (1 1; 0 1), and so five exchanges between halves, as in a fast Fourier
 * transform. */
static inline uint32_t sobol_second(uint32_t index) {
    uint32_t y = reverse_bits(index);
    y ^= (y & 0x55555555u) << 1;
    y ^= (y & 0x33333333u) << 2;
    y ^= (y & 0x0f0f0f0fu) << 4;
    y ^= (y & 0x00ff00ffu) << 8;
    return y ^ y << 16;
}

static inline float unit_interval(uint32_t bits) { return (float)(bits >> 8) * 0x1p-24f; }

zt_pixel_seeds zt_sample_seeds(int32_t column, int32_t row) {
    uint64_t key = zt_random_key(zt_random_key(0, (uint64_t)column), (uint64_t)row);
    return (zt_pixel_seeds){(uint32_t)key, (uint32_t)(key >> 32),
                            (uint32_t)zt_random_key(key, 0)};
}

ZT_CLONES void zt_sample_pixels(float *restrict x, float *restrict y,
                                const int32_t *restrict column, const int32_t *restrict row,
                                const zt_pixel_seeds *restrict seeds, int count, int sample,
                                int sample_count) {
    if (sample_count == 1) {
        for (int i = 0; i < count; i++) {
            x[i] = (float)column[i] + 0.5f;
            y[i] = (float)row[i] + 0.5f;
        }
        return;
    }
    for (int i = 0; i < count; i++) {
        uint32_t index = scramble((uint32_t)sample, seeds[i].order);
        x[i] = (float)column[i] + unit_interval(scramble(reverse_bits(index), seeds[i].x));
        y[i] = (float)row[i] + unit_interval(scramble(sobol_second(index), seeds[i].y));
    }
}
