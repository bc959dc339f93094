/* What the tracer of probe_mock.c says instead of the truth. */
#ifndef ZT_TESTS_PROBE_MOCK_H
#define ZT_TESTS_PROBE_MOCK_H

#include "probe.h"

typedef enum mock_lie {
    MOCK_HONEST,
    MOCK_MISSES, /* nothing is ever hit */
    MOCK_LATE,   /* distances are a hundred thousandth too long */
    MOCK_TURNED, /* normals are off by a ten thousandth */
    MOCK_DARK,   /* no light reaches anything */
    MOCK_LIT     /* all lights reach everything */
} mock_lie;
extern mock_lie probe_mock_lie;

#endif
