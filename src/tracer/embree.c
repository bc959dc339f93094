/* Each hierarchy is an Embree scene of one geometry: triangles, or boxes with a callback. */
#include "tracer/embree.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"

enum { LANES = 16 };

struct zt_embree {
    RTCDevice device;
    zt_listener listener;
};

/* A hierarchy. Over boxes, the geometry and the boxes are kept, to be built anew. */
typedef struct hierarchy {
    zt_bvh base;
    RTCScene scene;
    RTCGeometry geometry;
    const zt_bvh_box *boxes;
} hierarchy;

/* What a callback of zt_bvh_look needs; the Embree context is what Embree hands on. */
typedef struct look {
    struct RTCIntersectContext context;
    zt_bvh_rays *rays;
    zt_bvh_visit *visit;
    void *user;
} look;

static void tell_device_error(void *user, enum RTCError code, const char *text) {
    const zt_embree *embree = user;
    zt_tell(embree->listener, ZT_ERROR, "Embree, which finds what rays meet: %s (error %d)",
            text, (int)code);
}

static zt_status embree_open(zt_embree **out, int threads, zt_listener listener) {
    char config[32];
    snprintf(config, sizeof config, "threads=%d", threads);
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
    if (h->geometry) rtcReleaseGeometry(h->geometry);
    if (h->scene) rtcReleaseScene(h->scene);
    free(h);
    *slot = NULL;
}

/* A hierarchy of a scene and a geometry that have nothing in them yet. */
static zt_status embree_new(zt_bvh **out, const zt_embree *embree, enum RTCGeometryType type) {
    hierarchy *h = calloc(1, sizeof *h);
    *out = (zt_bvh *)h;
    if (!h) return ZT_EMEMORY;
    h->base.door = &zt_door_embree;
    h->scene = rtcNewScene(embree->device);
    h->geometry = rtcNewGeometry(embree->device, type);
    if (h->scene && h->geometry) {
        rtcAttachGeometry(h->scene, h->geometry);
        return ZT_OK;
    }
    embree_free(out);
    return ZT_EMEMORY;
}

/* The device has told what went wrong, where something did. */
static zt_status commit(zt_bvh **bvh, const zt_embree *embree) {
    const hierarchy *h = (hierarchy *)*bvh;
    rtcCommitGeometry(h->geometry);
    rtcCommitScene(h->scene);
    if (rtcGetDeviceError(embree->device) == RTC_ERROR_NONE) return ZT_OK;
    embree_free(bvh);
    return ZT_EMEMORY;
}

static zt_status embree_of_triangles(zt_bvh **out, zt_embree *embree, const float *positions,
                                     int32_t vertex_count, const uint32_t *triangles,
                                     int32_t triangle_count) {
    ZT_TRY(embree_new(out, embree, RTC_GEOMETRY_TYPE_TRIANGLE));
    const hierarchy *h = (hierarchy *)*out;
    rtcSetSharedGeometryBuffer(h->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               positions, 0, 3 * sizeof(float), (size_t)vertex_count);
    rtcSetSharedGeometryBuffer(h->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               triangles, 0, 3 * sizeof(uint32_t), (size_t)triangle_count);
    rtcSetSceneFlags(h->scene, RTC_SCENE_FLAG_ROBUST);
    return commit(out, embree);
}

static void box_bounds(const struct RTCBoundsFunctionArguments *arguments) {
    const hierarchy *h = arguments->geometryUserPtr;
    const zt_bvh_box *box = &h->boxes[arguments->primID];
    *arguments->bounds_o = (struct RTCBounds){.lower_x = box->low[0],
                                              .lower_y = box->low[1],
                                              .lower_z = box->low[2],
                                              .upper_x = box->high[0],
                                              .upper_y = box->high[1],
                                              .upper_z = box->high[2]};
}

/* Where `far` and the number of a ray stand among the members of Embree's ray packets of any
 * width, each of which is an array of one element for each lane. */
enum { MEMBER_FAR = 8, MEMBER_ID = 10 };

static void box_intersect(const struct RTCIntersectFunctionNArguments *arguments) {
    const look *l = (const look *)arguments->context;
    float *far = (float *)arguments->rayhit + MEMBER_FAR * (size_t)arguments->N;
    const unsigned *id = (unsigned *)arguments->rayhit + MEMBER_ID * (size_t)arguments->N;
    int32_t numbers[LANES], lanes[LANES];
    int count = 0;
    for (unsigned int lane = 0; lane < arguments->N; lane++) {
        if (!arguments->valid[lane]) continue;
        lanes[count] = (int32_t)lane;
        numbers[count++] = (int32_t)id[lane];
    }
    if (count == 0) return;
    l->visit(l->user, (int32_t)arguments->primID, numbers, count);
    for (int i = 0; i < count; i++) {
        float now = l->rays->far[numbers[i]];
        far[lanes[i]] = now < 0 ? -INFINITY : now;
    }
}

static zt_status embree_of_boxes(zt_bvh **bvh, zt_embree *embree, const zt_bvh_box *boxes,
                                 int32_t box_count) {
    if (!*bvh) {
        ZT_TRY(embree_new(bvh, embree, RTC_GEOMETRY_TYPE_USER));
        hierarchy *h = (hierarchy *)*bvh;
        rtcSetSceneFlags(h->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
        rtcSetSceneBuildQuality(h->scene, RTC_BUILD_QUALITY_LOW);
        rtcSetGeometryUserData(h->geometry, h);
        rtcSetGeometryBoundsFunction(h->geometry, box_bounds, NULL);
        rtcSetGeometryIntersectFunction(h->geometry, box_intersect);
    }
    hierarchy *h = (hierarchy *)*bvh;
    h->boxes = boxes;
    rtcSetGeometryUserPrimitiveCount(h->geometry, (unsigned)box_count);
    return commit(bvh, embree);
}

/* Fills a packet with rays from `first` on. Returns how many of them look anywhere. */
static int load_packet(struct RTCRay16 *packet, int *valid, const zt_bvh_rays *rays,
                       int first) {
    memcpy(packet->org_x, rays->ox + first, sizeof packet->org_x);
    memcpy(packet->org_y, rays->oy + first, sizeof packet->org_y);
    memcpy(packet->org_z, rays->oz + first, sizeof packet->org_z);
    memcpy(packet->dir_x, rays->dx + first, sizeof packet->dir_x);
    memcpy(packet->dir_y, rays->dy + first, sizeof packet->dir_y);
    memcpy(packet->dir_z, rays->dz + first, sizeof packet->dir_z);
    memcpy(packet->tfar, rays->far + first, sizeof packet->tfar);
    int count = 0;
    for (int lane = 0; lane < LANES; lane++) {
        valid[lane] = (first + lane < rays->count) & (packet->tfar[lane] >= 0) ? -1 : 0;
        count -= valid[lane];
        packet->tnear[lane] = 0;
        packet->time[lane] = 0;
        packet->mask[lane] = ~0u;
        packet->id[lane] = (unsigned)(first + lane);
        packet->flags[lane] = 0;
    }
    return count;
}

static void init_context(struct RTCIntersectContext *context, zt_bvh_kind kind) {
    rtcInitIntersectContext(context);
    if (kind == ZT_BVH_COHERENT) context->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
}

static void embree_nearest(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_kind kind) {
    const hierarchy *h = (const hierarchy *)bvh;
    struct RTCIntersectContext context;
    init_context(&context, kind);
    for (int first = 0; first < rays->count; first += LANES) {
        alignas(64) int valid[LANES];
        alignas(64) struct RTCRayHit16 packet;
        for (int lane = 0; lane < LANES; lane++)
            packet.hit.geomID[lane] = packet.hit.primID[lane] = RTC_INVALID_GEOMETRY_ID;
        if (load_packet(&packet.ray, valid, rays, first))
            rtcIntersect16(valid, h->scene, &context, &packet);
        memcpy(rays->far + first, packet.ray.tfar, sizeof packet.ray.tfar);
        memcpy(rays->triangle + first, packet.hit.primID, sizeof packet.hit.primID);
    }
}

static void embree_any(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_kind kind) {
    const hierarchy *h = (const hierarchy *)bvh;
    struct RTCIntersectContext context;
    init_context(&context, kind);
    for (int first = 0; first < rays->count; first += LANES) {
        alignas(64) int valid[LANES];
        alignas(64) struct RTCRay16 packet;
        if (load_packet(&packet, valid, rays, first))
            rtcOccluded16(valid, h->scene, &context, &packet);
        for (int lane = 0; lane < LANES; lane++)
            rays->triangle[first + lane] = valid[lane] && packet.tfar[lane] < 0 ? 0 : -1;
    }
}

static void embree_look(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_kind kind,
                        zt_bvh_visit *visit, void *user) {
    const hierarchy *h = (const hierarchy *)bvh;
    look l = {.rays = rays, .visit = visit, .user = user};
    init_context(&l.context, kind);
    for (int first = 0; first < rays->count; first += LANES) {
        alignas(64) int valid[LANES];
        alignas(64) struct RTCRayHit16 packet;
        for (int lane = 0; lane < LANES; lane++)
            packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        if (load_packet(&packet.ray, valid, rays, first))
            rtcIntersect16(valid, h->scene, &l.context, &packet);
    }
}

ZT_MODULE_DOOR(zt_embree_door, embree) = {
    embree_open, embree_close,   embree_of_triangles, embree_of_boxes,
    embree_free, embree_nearest, embree_any,          embree_look,
};
