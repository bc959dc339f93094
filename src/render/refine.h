/* Further samples for the pixels of a canvas, in rounds over the whole picture, until each is
 * as good as it was asked for. */
#ifndef ZT_RENDER_REFINE_H
#define ZT_RENDER_REFINE_H

#include "render/work.h"

/* All pixels of the picture wait, those next to each other one after the other; where tiles are
 * copied, only those to which something else may come than what was copied. */
void zt_refine_begin(zt_frame *frame);

/* Takes samples for the pixels that wait, and then writes them and all further channels to the
 * image. ZT_ESTOPPED. */
zt_status zt_refine(zt_frame *frame);

#endif
