/* Embree builds hierarchies (its builder of other people's nodes); what it says of a node is
 * written into one of ours, in memory of its.
 *
 * Boxes are scaled by a power of two, which changes no digit, and moved, so that all together
 * reach from about -1 to 1; and they are grown by more than the roundings of looking
 * (tracer/look.c).
 *
 * One quality serves for what is built once and for what is built each frame: a low one builds
 * in two thirds of the time and is looked through at half the speed, a high one is the same. */
#include "tracer/embree.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/diag.h"

/* By how much boxes are grown. */
#define GROWN 0x1p-18f

struct zt_embree {
    RTCDevice device;
    zt_listener listener;
};

typedef struct hierarchy {
    zt_bvh base;
    RTCBVH nodes;
    struct RTCBuildPrimitive *boxes;
    int32_t room; /* for so many boxes */
} hierarchy;

static void tell_device_error(void *user, enum RTCError code, const char *text) {
    const zt_embree *embree = user;
    zt_tell(embree->listener, ZT_ERROR, "Embree, which finds what rays meet: %s (error %d)",
            text, (int)code);
}

static zt_status embree_open(zt_embree **out, int threads, zt_listener listener) {
    char config[32];
    snprintf(config, sizeof config, "threads=%d,start_threads=1", threads);
    zt_embree *embree = *out = calloc(1, sizeof *embree);
    if (!embree) return ZT_EMEMORY;
    embree->listener = listener;
    embree->device = rtcNewDevice(config);
    if (!embree->device) {
        zt_tell(listener, ZT_ERROR, "Embree, which finds what rays meet, does not start here");
        free(embree);
        *out = NULL;
        return ZT_EUNSUPPORTED;
    }
    rtcSetDeviceErrorFunction(embree->device, tell_device_error, embree);
    return ZT_OK;
}

static void embree_close(zt_embree **slot) {
    rtcReleaseDevice((*slot)->device);
    free(*slot);
    *slot = NULL;
}

extern const zt_embree_door zt_door_embree;

static void embree_free(zt_bvh **slot) {
    hierarchy *h = (hierarchy *)*slot;
    if (h->nodes) rtcReleaseBVH(h->nodes);
    free(h->boxes);
    free(h);
    *slot = NULL;
}

static zt_status new_hierarchy(zt_bvh **out, const zt_embree *embree) {
    hierarchy *h = calloc(1, sizeof *h);
    *out = (zt_bvh *)h;
    if (!h) return ZT_EMEMORY;
    h->base.door = &zt_door_embree;
    h->nodes = rtcNewBVH(embree->device);
    if (h->nodes) return ZT_OK;
    embree_free(out);
    return ZT_EMEMORY;
}

/* ---- boxes ----------------------------------------------------------------------------------
 */

static bool is_box(const zt_bvh_box *b) {
    bool good = true;
    for (int i = 0; i < 3; i++)
        good &= (b->low[i] <= b->high[i]) & (b->low[i] > -INFINITY) & (b->high[i] < INFINITY);
    return good;
}

/* Has the hierarchy's space reach from about -1 to 1. */
static void fit_space(zt_bvh *h, const zt_bvh_box *boxes, int32_t count) {
    double half = 0;
    for (int i = 0; i < 3; i++) {
        float low = INFINITY, high = -INFINITY;
        for (int32_t k = 0; k < count; k++) {
            if (!is_box(&boxes[k])) continue;
            if (boxes[k].low[i] < low) low = boxes[k].low[i];
            if (boxes[k].high[i] > high) high = boxes[k].high[i];
        }
        h->center[i] = low <= high ? ((double)low + (double)high) / 2 : 0;
        /* Single precision has no finer places there than that. */
        half = fmax(half, fabs(h->center[i]) * 0x1p-24);
        if (low <= high) half = fmax(half, (double)high - h->center[i]);
    }
    int exponent;
    frexp(half, &exponent);
    h->scale = ldexp(1, -exponent);
}

static zt_status make_room(hierarchy *h, int32_t count) {
    if (h->boxes && count <= h->room) return ZT_OK;
    free(h->boxes);
    h->room = count;
    h->boxes = aligned_alloc(32, ((size_t)count + 1) * sizeof *h->boxes);
    return h->boxes ? ZT_OK : ZT_EMEMORY;
}

/* Puts what are boxes in the hierarchy's space; returns their number. */
static size_t put_boxes(hierarchy *h, const zt_bvh_box *boxes, int32_t count) {
    const double *center = h->base.center, scale = h->base.scale;
    size_t put = 0;
    for (int32_t k = 0; k < count; k++) {
        if (!is_box(&boxes[k])) continue;
        float low[3], high[3];
        for (int i = 0; i < 3; i++) {
            low[i] = (float)(((double)boxes[k].low[i] - center[i]) * scale) - GROWN;
            high[i] = (float)(((double)boxes[k].high[i] - center[i]) * scale) + GROWN;
        }
        h->boxes[put++] = (struct RTCBuildPrimitive){.lower_x = low[0],
                                                     .lower_y = low[1],
                                                     .lower_z = low[2],
                                                     .upper_x = high[0],
                                                     .upper_y = high[1],
                                                     .upper_z = high[2],
                                                     .primID = (unsigned)k};
    }
    return put;
}

/* ---- nodes: what Embree calls, from any of its threads --------------------------------------
 */

static void *new_node(RTCThreadLocalAllocator memory, unsigned count, void *user) {
    (void)count;
    (void)user;
    return rtcThreadLocalAlloc(memory, sizeof(zt_bvh_node), 64);
}

static void *new_leaf(RTCThreadLocalAllocator memory, const struct RTCBuildPrimitive *boxes,
                      size_t count, void *user) {
    (void)memory;
    (void)count; /* 1, as it was asked to be */
    (void)user;
    return (void *)zt_bvh_leaf((int32_t)boxes->primID); /* NOLINT(performance-no-int-to-ptr) */
}

static void set_children(void *slot, void **children, unsigned count, void *user) {
    (void)user;
    zt_bvh_node *node = slot;
    for (unsigned i = 0; i < ZT_BVH_CHILDREN; i++)
        node->children[i] = i < count ? (uintptr_t)children[i] : 0;
}

/* Orders children by their middles along the axis on which these are furthest apart. */
static void order_children(zt_bvh_node *node, unsigned count) {
    float middles[3][ZT_BVH_CHILDREN], widest = -1;
    for (int axis = 0; axis < 3; axis++) {
        float low = INFINITY, high = -INFINITY;
        for (unsigned i = 0; i < count; i++) {
            float middle = node->sides[0][axis][i] + node->sides[1][axis][i];
            middles[axis][i] = middle;
            low = fminf(low, middle);
            high = fmaxf(high, middle);
        }
        if (!(high - low > widest)) continue;
        widest = high - low;
        node->axis = axis;
    }
    const float *at = middles[node->axis];
    for (unsigned i = 0; i < ZT_BVH_CHILDREN; i++) {
        unsigned k = i;
        for (; i < count && k > 0 && at[node->order[k - 1]] > at[i]; k--)
            node->order[k] = node->order[k - 1];
        node->order[k] = (uint8_t)i;
    }
}

static void set_bounds(void *slot, const struct RTCBounds **bounds, unsigned count,
                       void *user) {
    (void)user;
    zt_bvh_node *node = slot;
    for (unsigned i = 0; i < ZT_BVH_CHILDREN; i++) {
        static const struct RTCBounds nowhere = {
            ZT_BVH_NOWHERE, ZT_BVH_NOWHERE, ZT_BVH_NOWHERE, 0,
            ZT_BVH_NOWHERE, ZT_BVH_NOWHERE, ZT_BVH_NOWHERE, 0};
        const struct RTCBounds *b = i < count ? bounds[i] : &nowhere;
        const float low[3] = {b->lower_x, b->lower_y, b->lower_z};
        const float high[3] = {b->upper_x, b->upper_y, b->upper_z};
        for (int axis = 0; axis < 3; axis++) {
            node->sides[0][axis][i] = low[axis];
            node->sides[1][axis][i] = high[axis];
        }
    }
    order_children(node, count);
}

/* ---- hierarchies ----------------------------------------------------------------------------
 */

static zt_status build(hierarchy *h, const zt_embree *embree, const zt_bvh_box *boxes,
                       int32_t count) {
    ZT_TRY(make_room(h, count));
    fit_space(&h->base, boxes, count);
    h->base.root = 0;
    struct RTCBuildArguments arguments = rtcDefaultBuildArguments();
    arguments.primitives = h->boxes;
    arguments.primitiveCount = arguments.primitiveArrayCapacity = put_boxes(h, boxes, count);
    if (arguments.primitiveCount == 0) return ZT_OK;
    arguments.bvh = h->nodes;
    arguments.maxBranchingFactor = ZT_BVH_CHILDREN;
    arguments.maxDepth = ZT_BVH_DEPTH;
    arguments.maxLeafSize = 1;
    arguments.createNode = new_node;
    arguments.setNodeChildren = set_children;
    arguments.setNodeBounds = set_bounds;
    arguments.createLeaf = new_leaf;
    h->base.root = (uintptr_t)rtcBuildBVH(&arguments);
    bool good = rtcGetDeviceError(embree->device) == RTC_ERROR_NONE && h->base.root;
    return good ? ZT_OK : ZT_EMEMORY; /* the device has told what went wrong */
}

static zt_status embree_of_boxes(zt_bvh **bvh, zt_embree *embree, const zt_bvh_box *boxes,
                                 int32_t box_count) {
    if (!*bvh) ZT_TRY(new_hierarchy(bvh, embree));
    zt_status status = build((hierarchy *)*bvh, embree, boxes, box_count);
    if (status != ZT_OK) embree_free(bvh);
    return status;
}

ZT_MODULE_DOOR(zt_embree_door, embree) = {
    embree_open,
    embree_close,
    embree_of_boxes,
    embree_free,
};
