/* What bvh.c forwards to, the table of the module `embree` (base/module.h), the door to Embree;
 * and the hierarchies that it builds, for looking into them (tracer/look.c). */
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
} zt_embree_door;

/* Nodes have up to so many children; so many are below each other at most. */
enum { ZT_BVH_CHILDREN = 4, ZT_BVH_DEPTH = 64 };

/* In all directions from what there is in a hierarchy's space, and out of reach: the sides of
 * children that are none. */
#define ZT_BVH_NOWHERE 1e20f

/* A child is a node, or an odd number: a leaf, one box. */
typedef struct zt_bvh_node {
    _Alignas(64) float sides[2][3][ZT_BVH_CHILDREN]; /* the low and the high ones, by axis */
    uintptr_t children[ZT_BVH_CHILDREN];
    int32_t axis;                   /* along which they lie */
    uint8_t order[ZT_BVH_CHILDREN]; /* in this order, about */
} zt_bvh_node;

static inline uintptr_t zt_bvh_leaf(int32_t box) { return (uintptr_t)box << 1 | 1; }
static inline int32_t zt_bvh_leaf_box(uintptr_t leaf) { return (int32_t)(leaf >> 1); }

/* What each hierarchy begins with. */
struct zt_bvh {
    const zt_embree_door *door;
    uintptr_t root;          /* like a child; 0: there is nothing */
    double center[3], scale; /* its own space: (p - center) scale, a power of two */
};

#endif
