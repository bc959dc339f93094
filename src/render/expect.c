#include "render/expect.h"

#include <math.h>

#include "render/work.h"

enum { LOOKED_AT = 1 << 16 }; /* pixels, of which the others are thought to have as many */

double zt_expect_error(int i) { return exp2(-(double)i / ZT_EXPECT_OCTAVE); }

/* A pixel doubles its samples as long as its squared error is above what is wanted
 * (render/refine.c). The errors of points that are well spread fall as those of steps do
 * (zt_canvas_estimate); where light is random they fall less, by how much depends on the scene:
 * between that and the square root of their number. */
static void expect_slot(double *further, const zt_canvas *canvas, const zt_slot *slot,
                        int max) {
    const double fall = canvas->is_random ? 1.25 : 1.5;
    double error = (double)zt_canvas_error(canvas, slot);
    if (!(error > 0)) return;
    double level = -0.5 * ZT_EXPECT_OCTAVE * log2(fmin(error, 1));
    for (int64_t asked = slot->asked; asked < max; asked *= 2) {
        double share = (double)zt_canvas_share(canvas, asked);
        int from = (int)ceil(level + 0.5 * ZT_EXPECT_OCTAVE * log2(share));
        if (from >= ZT_EXPECT_COUNT) return;
        further[max_int(from, 0)] += (double)(asked < max - asked ? asked : max - asked);
        level += 0.5 * ZT_EXPECT_OCTAVE * fall;
    }
}

void zt_expect(zt_expected *expected, const zt_render_work *work, int max) {
    const zt_canvas *canvas = &work->canvas;
    const int32_t stride = canvas->slot_count / LOOKED_AT + 1;
    *expected = (zt_expected){.is_random = canvas->is_random};
    for (int32_t i = 0; i < canvas->slot_count; i += stride)
        expect_slot(expected->further, canvas, &canvas->slots[i], max);
    double sum = 0;
    for (int i = 0; i < ZT_EXPECT_COUNT; i++) {
        sum += stride * expected->further[i];
        expected->further[i] = sum;
    }
}
