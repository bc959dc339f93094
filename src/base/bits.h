/* What numbers are to the last bit. */
#ifndef ZT_BASE_BITS_H
#define ZT_BASE_BITS_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* Whether things without padding, as numbers and structs of doubles alone, are equal to the
 * last bit: 0 is not -0, and a NaN is itself. */
static inline bool zt_bits_equal(const void *a, const void *b, size_t size) {
    return memcmp(a, b, size) == 0;
}

#endif
