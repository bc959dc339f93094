/* Whether a picture of which tiles were copied is the one that is rendered. */
#ifndef ZT_SEQUENCE_REUSE_CHECK_H
#define ZT_SEQUENCE_REUSE_CHECK_H

#include "sequence/renderer.h"

/* Renders a frame once more, without copying anything, and compares all bits of the image and
 * its further channels. ZT_EUNSUPPORTED, told with frame and pixel, where they differ; what
 * rendering may say besides. */
zt_status zt_reuse_check(zt_renderer *renderer, const zt_taking *taking, int64_t frame,
                         const zt_image *image);

#endif
