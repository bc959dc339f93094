/* The manifest as the renderer fills it and goes by it. */
#ifndef ZT_SEQUENCE_MANIFEST_H
#define ZT_SEQUENCE_MANIFEST_H

#include <zoetrope/manifest.h>

/* What one frame was rendered with: samples a pixel, as in zt_sampling. */
typedef struct zt_manifest_frame {
    int64_t frame;
    int32_t min, max;
    double error; /* 0 where min = max */
    int32_t mean_max;
} zt_manifest_frame;

/* Owned by the caller; NULL when out of memory. */
zt_manifest *zt_manifest_create(int width, int height, zt_precision precision);

/* Frames come in any order; of one that comes again the later counts. ZT_EMEMORY. */
zt_status zt_manifest_add(zt_manifest *manifest, const zt_manifest_frame *frame);

/* NULL where it has no such frame. */
const zt_manifest_frame *zt_manifest_find(const zt_manifest *manifest, int64_t frame);

#endif
