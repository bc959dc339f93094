/* What bvh.c forwards to: the table of the module `embree` (base/module.h), the door to Embree.
 */
#ifndef ZT_TRACER_EMBREE_H
#define ZT_TRACER_EMBREE_H

#include "base/module.h"
#include "tracer/bvh.h"

/* An Embree device. */
typedef struct zt_embree zt_embree;

typedef struct zt_embree_door {
    zt_status (*open)(zt_embree **embree, int threads, zt_listener listener);
    void (*close)(zt_embree **embree);
    /* All below is as bvh.h has it. */
    zt_status (*of_boxes)(zt_bvh **bvh, zt_embree *embree, const zt_bvh_box *boxes,
                          int32_t box_count);
    void (*free)(zt_bvh **bvh);
    void (*look)(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_kind kind, zt_bvh_visit *visit,
                 void *user);
} zt_embree_door;

/* What each hierarchy begins with, so that calls with one need not look for the table. */
struct zt_bvh {
    const zt_embree_door *door;
};

#endif
