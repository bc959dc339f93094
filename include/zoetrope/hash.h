/* Checksums and content keys: XXH3, 128 bits. */
#ifndef ZOETROPE_HASH_H
#define ZOETROPE_HASH_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zeroed: not known. */
typedef struct zt_hash {
    uint64_t high, low;
} zt_hash;

#ifdef __cplusplus
}
#endif
#endif
