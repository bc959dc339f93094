/* Reconstruction filters, sampled by importance: each pixel takes samples of its own alone,
 * which fall where the filter is large and then all count the same, so that nothing is shared
 * between pixels or tiles (Ernst, Stamminger and Greiner, "Filter importance sampling", 2006).
 */
#ifndef ZT_RENDER_FILTER_H
#define ZT_RENDER_FILTER_H

#include <zoetrope/sampling.h>
#include <zoetrope/status.h>

#include "base/arena.h"

/* The filters, each along x times the same along y, by the distance x from the pixel's middle
 * in pixels, w being the width from end to end:
 *
 *   box              1                                              w = 1
 *   tent             1 - |x| / (w / 2)                              w = 2
 *   gaussian         exp(-8 (x / w)^2), cut off: sigma is w / 4      w = 2
 *   mitchell         Mitchell and Netravali's cubic, 4 x / w         w = 4
 *   blackman-harris  the window of four terms over w (Harris, 1978)  w = 4
 */
double zt_filter_eval(zt_filter filter, double width, double x);

/* The width that holds: what is asked for, or the filter's own. */
double zt_filter_width(const zt_sampling *sampling);

/* A filter made ready to place samples. Lives in the arena that it was made in. */
typedef struct zt_warp zt_warp;

/* NULL for the box of one pixel, which leaves samples where they are. ZT_EMEMORY. */
zt_status zt_warp_prepare(const zt_warp **warp, const zt_sampling *sampling, zt_arena *arena);

/* Whether some samples count negatively. */
bool zt_warp_is_signed(const zt_warp *warp);

/* Takes points of the unit square to places relative to the pixel's top left corner, as dense
 * as the filter's magnitude is there; `weight` becomes its sign, 1 or -1. */
void zt_warp_places(float *x, float *y, float *weight, const zt_warp *warp, int count);

#endif
