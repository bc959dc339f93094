/* Checksums and content hashes: XXH3, 128 bits. The door to xxHash. */
#ifndef ZT_BASE_HASH_H
#define ZT_BASE_HASH_H

#include <stdbool.h>
#include <stddef.h>

#include <zoetrope/hash.h>

zt_hash zt_hash_bytes(const void *bytes, size_t size);

/* Reads 32 hexadecimal digits, as of "%016" PRIx64 twice; false for anything else. */
bool zt_hash_read(zt_hash *hash, const char *text);

#endif
