/* Content keys of frames that are rendered with a sampling of their own. */
#ifndef ZT_SEQUENCE_KEY_H
#define ZT_SEQUENCE_KEY_H

#include "sequence/renderer.h"

/* zt_renderer_key(), of a frame that is rendered with this sampling. */
zt_status zt_renderer_key_of(zt_hash *key, zt_renderer *renderer, int64_t frame,
                             const zt_sampling *sampling);

#endif
