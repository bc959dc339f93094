/* Checksums and content keys: XXH3, 128 bits. */
#ifndef ZOETROPE_HASH_H
#define ZOETROPE_HASH_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zeroed: not known. */
typedef struct zt_hash {
    uint64_t high, low;
} zt_hash;

static inline bool zt_hash_is_known(zt_hash hash) { return hash.high || hash.low; }

static inline bool zt_hash_equal(zt_hash a, zt_hash b) {
    return a.high == b.high && a.low == b.low;
}

#ifdef __cplusplus
}
#endif
#endif
