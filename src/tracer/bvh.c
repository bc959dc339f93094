/* This side of the door to Embree. */
#include "tracer/bvh.h"

#include <stdlib.h>

#include "base/diag.h"
#include "base/pool.h"
#include "tracer/embree.h"

struct zt_bvh_builder {
    const zt_embree_door *door;
    zt_embree *embree; /* NULL until the first hierarchy */
    int threads;
    zt_listener listener;
};

zt_status zt_bvh_open(zt_bvh_builder **out, int threads, zt_listener listener) {
    zt_bvh_builder *builder = *out = calloc(1, sizeof *builder);
    if (!builder) return ZT_EMEMORY;
    builder->threads = threads > 0 ? threads : zt_pool_core_count();
    builder->listener = listener;
    return ZT_OK;
}

void zt_bvh_close(zt_bvh_builder **slot) {
    if (!*slot) return;
    if ((*slot)->embree) (*slot)->door->close(&(*slot)->embree);
    free(*slot);
    *slot = NULL;
}

int zt_bvh_threads(const zt_bvh_builder *builder) { return builder->threads; }

zt_status zt_bvh_start(zt_bvh_builder *builder) {
    if (builder->embree) return ZT_OK;
    builder->door = zt_module_door("embree", "meshes and crowds of objects", builder->listener);
    if (!builder->door) return ZT_EUNSUPPORTED;
    return builder->door->open(&builder->embree, builder->threads, builder->listener);
}

zt_status zt_bvh_of_boxes(zt_bvh **bvh, zt_bvh_builder *builder, const zt_bvh_box *boxes,
                          int32_t box_count) {
    ZT_TRY(zt_bvh_start(builder));
    return builder->door->of_boxes(bvh, builder->embree, boxes, box_count);
}

void zt_bvh_free(zt_bvh **bvh) {
    if (*bvh) (*bvh)->door->free(bvh);
}
