/* How many samples a picture would take with smaller errors, as its last canvas shows. */
#ifndef ZT_RENDER_EXPECT_H
#define ZT_RENDER_EXPECT_H

#include "render/render.h"

/* Errors from 1 down to 1e-6. */
enum { ZT_EXPECT_OCTAVE = 16, ZT_EXPECT_COUNT = 20 * ZT_EXPECT_OCTAVE };

/* Error number i: 2 ^ (-i / 16). */
double zt_expect_error(int i);

typedef struct zt_expected {
    bool is_random; /* samples are everywhere, and not only at edges */
    double further[ZT_EXPECT_COUNT];
} zt_expected;

/* further[i]: how many samples the last picture that was not even would take beyond those that
 * it has, for error number i, in pixels that have taken some, none of them more than `max`. */
void zt_expect(zt_expected *expected, const zt_render_work *work, int max);

#endif
