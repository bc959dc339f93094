#include "base/hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

zt_hash zt_hash_bytes(const void *bytes, size_t size) {
    XXH128_hash_t hash = XXH3_128bits(bytes, size);
    return (zt_hash){hash.high64, hash.low64};
}
