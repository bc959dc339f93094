#include "base/hash.h"

#include <stdlib.h>
#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

zt_hash zt_hash_bytes(const void *bytes, size_t size) {
    XXH128_hash_t hash = XXH3_128bits(bytes, size);
    return (zt_hash){hash.high64, hash.low64};
}

bool zt_hash_read(zt_hash *hash, const char *text) {
    if (strlen(text) != 32 || strspn(text, "0123456789abcdef") != 32) return false;
    char high[17] = {0};
    memcpy(high, text, 16);
    *hash = (zt_hash){strtoull(high, NULL, 16), strtoull(text + 16, NULL, 16)};
    return true;
}
