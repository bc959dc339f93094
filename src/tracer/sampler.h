/* The points of samples: Sobol's sequence, two dimensions at a time, shuffled and with Owen
 * scrambling (Burley, "Practical hash-based Owen scrambling", JCGT 9(4), 2020). A point is a
 * function of its key, its dimension and the sample's number alone, so that any sample can be
 * taken again by itself. Straight code without branches, for loops over many samples. */
#ifndef ZT_TRACER_SAMPLER_H
#define ZT_TRACER_SAMPLER_H

#include <stdint.h>

#include "base/random.h"

/* What the points are for: two numbers each. */
enum {
    ZT_DIMENSION_PIXEL, /* where in a pixel */
    ZT_DIMENSION_LENS,
    ZT_DIMENSION_TIME,
    ZT_DIMENSION_LAMPS /* and on: of lamp i after d mirrors, d * lamp_count + i further */
};

/* What the points of a pixel are keyed by, given what those of its frame are. */
static inline uint32_t zt_sample_key(uint64_t frame_key, int32_t column, int32_t row) {
    return (uint32_t)zt_random_key(zt_random_key(frame_key, (uint32_t)column), (uint32_t)row);
}

static inline uint32_t zt_sample_reverse(uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/* Owen's nested uniform scramble: each bit is flipped or not depending on the bits above it.
 * The hash works upwards, so it takes and gives reversed bits (the constants are Burley's). */
static inline uint32_t zt_sample_scramble(uint32_t reversed, uint32_t seed) {
    uint32_t x = reversed;
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

/* Sobol's second dimension of an index with reversed bits: its generator matrix is Pascal's
 * triangle modulo 2, the fifth Kronecker power of (1 1; 0 1), and so five exchanges between
 * halves, as in a fast Fourier transform. */
static inline uint32_t zt_sample_second(uint32_t reversed) {
    uint32_t y = reversed;
    y ^= (y & 0x55555555u) << 1;
    y ^= (y & 0x33333333u) << 2;
    y ^= (y & 0x0f0f0f0fu) << 4;
    y ^= (y & 0x00ff00ffu) << 8;
    return y ^ y << 16;
}

/* Mixes all bits of a word (Wellons, "Prospecting for hash functions", lowbias32, 2018). */
static inline uint32_t zt_sample_mix(uint32_t x) {
    x = (x ^ (x >> 16)) * 0x21f0aaadu;
    x = (x ^ (x >> 15)) * 0x735a2d97u;
    return x ^ (x >> 15);
}

/* 24 bits of [0, 1). */
static inline float zt_sample_unit(uint32_t bits) {
    return (float)(int32_t)(bits >> 8) * 0x1p-24f;
}

/* The point (u, v) in [0, 1)^2 of sample number `sample` in a dimension. Of the points of one
 * key and dimension, each 2^n from a multiple of 2^n on are well spread. */
static inline void zt_sample_point(float *u, float *v, uint32_t key, uint32_t dimension,
                                   uint32_t sample) {
    uint32_t seed = zt_sample_mix(key + 0x9e3779b9u * (dimension + 1));
    uint32_t index = zt_sample_scramble(zt_sample_reverse(sample), seed); /* reversed */
    uint32_t first = zt_sample_reverse(index);
    uint32_t second = zt_sample_reverse(zt_sample_second(index));
    first = zt_sample_scramble(first, zt_sample_mix(seed ^ 0x68bc21ebu));
    second = zt_sample_scramble(second, zt_sample_mix(seed ^ 0x02e5be93u));
    *u = zt_sample_unit(zt_sample_reverse(first));
    *v = zt_sample_unit(zt_sample_reverse(second));
}

/* The points of sample number `sample` of `count` keys. */
void zt_sample_points(float *u, float *v, const uint32_t *key, uint32_t dimension,
                      uint32_t sample, int count);

#endif
