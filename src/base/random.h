/* Random numbers that are addressed, not drawn: a value is a function of its key alone, so any
 * sample can be asked for again, in any order, by any thread. */
#ifndef ZT_BASE_RANDOM_H
#define ZT_BASE_RANDOM_H

#include <stdint.h>

/* Mixes all bits of a word (SplitMix64's finalizer, Steele, Lea and Flood 2014). */
static inline uint64_t zt_random_mix(uint64_t x) {
    x = (x ^ (x >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94D049BB133111EB);
    return x ^ (x >> 31);
}

/* A key made of another one and a further number: seed, then frame, then pixel, and so on. */
static inline uint64_t zt_random_key(uint64_t key, uint64_t number) {
    return zt_random_mix(key + UINT64_C(0x9E3779B97F4A7C15) * (number + 1));
}

#endif
