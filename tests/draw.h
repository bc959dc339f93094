/* Numbers for property tests: the same ones each time. */
#ifndef ZT_TESTS_DRAW_H
#define ZT_TESTS_DRAW_H

#include <math.h>
#include <stdint.h>

#include "base/quat.h"
#include "base/random.h"

typedef struct draw {
    uint64_t key, number;
} draw;

static inline uint64_t draw_bits(draw *d) { return zt_random_key(d->key, d->number++); }
static inline int draw_below(draw *d, int count) {
    return (int)(draw_bits(d) % (uint64_t)count);
}
static inline double draw_unit(draw *d) { return (double)(draw_bits(d) >> 11) * 0x1p-53; }
static inline double draw_between(draw *d, double low, double high) {
    return low + (high - low) * draw_unit(d);
}
/* Any magnitude between the two, each power of ten as likely as another. */
static inline double draw_magnitude(draw *d, double low, double high) {
    return exp(draw_between(d, log(low), log(high)));
}
/* What breaks careless code: ordinary numbers among zeros, equals, giants and dwarfs. */
static inline double draw_nasty(draw *d) {
    static const double odd[] = {0,
                                 -0.0,
                                 1,
                                 -1,
                                 1e300,
                                 -1e300,
                                 1e-300,
                                 -1e-300,
                                 5e-324,
                                 -5e-324,
                                 1.7976931348623157e308,
                                 -1.7976931348623157e308};
    switch (draw_below(d, 4)) {
    case 0:
        return odd[draw_below(d, (int)(sizeof odd / sizeof *odd))];
    case 1:
        return (draw_below(d, 2) ? 1 : -1) * draw_magnitude(d, 1e-300, 1e300);
    case 2:
        return draw_below(d, 3);
    default:
        return draw_between(d, -10, 10);
    }
}
static inline quat draw_rotation(draw *d) {
    for (;;) {
        quat q = {draw_between(d, -1, 1), draw_between(d, -1, 1), draw_between(d, -1, 1),
                  draw_between(d, -1, 1)};
        double n = quat_dot(q, q);
        if (n > 1e-3 && n < 1) return quat_normalize(q);
    }
}

#endif
