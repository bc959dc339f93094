/* Checksums and content hashes: XXH3, 128 bits. The door to xxHash. */
#ifndef ZT_BASE_HASH_H
#define ZT_BASE_HASH_H

#include <stddef.h>

#include <zoetrope/hash.h>

zt_hash zt_hash_bytes(const void *bytes, size_t size);

#endif
