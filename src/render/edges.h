/* Edges: where one sample in the middle of each pixel is not enough. */
#ifndef ZT_RENDER_EDGES_H
#define ZT_RENDER_EDGES_H

#include "render/work.h"

/* Looks at the image and the canvas's paths, and lets wait the pixels that differ from one of
 * their neighbours: in what they saw, or in color by more than the error allows. */
void zt_edges_find(zt_frame *frame);

#endif
