/* Each hierarchy is an Embree scene of one geometry of the caller's own kind: boxes with a
 * callback.
 *
 * Such scenes Embree traverses without regard to roundings, whatever its flags say, so that
 * these are allowed for here. It sees all of it scaled by powers of two, which changes no
 * digit, and moved: space so that the boxes reach from about -1 to 1 (Embree passes by what is
 * beyond 1e18), directions so that their largest component is between 1 and 2. Origins further
 * away are moved along their rays to about where these come near, so that all are within 8, or
 * else the ray is of no concern. A distance t to a face at b from the origin o, worked out as b
 * / d - o / d with a reciprocal that is off by 2^-22, is then off by what moving the face by
 * (|b| + |o|) 2^-21.4 is at most, that is, less than GROWN. Components below 1e-18 are taken
 * for that, which over the little way that is left is less still.
 *
 * One quality serves for what is built once and for what is built each frame: a low one builds
 * in two thirds of the time and is looked through at half the speed, a high one is the same. */
#include "tracer/embree.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdalign.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/diag.h"
#include "tracer/isa.h"

enum { LANES = ZT_BVH_LANES };

#define GROWN 0x1p-18f /* by how much boxes are grown */
/* Moved origins are so much of a ray's t before the point nearest to the center, and within so
 * much of the center for rays that can touch boxes: these are within sqrt(3) of it, a t of 1 is
 * sqrt(12) at most. */
#define BEFORE 2
#define REACH  8
/* How much further than asked is looked, for the roundings of far itself. */
#define FURTHER (1 + 0x1p-20)

struct zt_embree {
    RTCDevice device;
    zt_listener listener;
};

typedef struct hierarchy {
    zt_bvh base;
    RTCScene scene;
    RTCGeometry geometry;
    double center[3], scale; /* Embree's space: (p - center) scale, a power of two */
    const zt_bvh_box *boxes; /* while it is built */
} hierarchy;

/* What the callback needs; the Embree context is what Embree hands on. */
typedef struct look {
    struct RTCIntersectContext context;
    zt_bvh_rays *rays;
    zt_bvh_visit *visit;
    void *user;
    int first;
    /* From a ray's far to Embree's: times `stretch` less `moved`. */
    alignas(64) double stretch[LANES], moved[LANES];
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

static bool is_box(const zt_bvh_box *b) {
    bool good = true;
    for (int i = 0; i < 3; i++)
        good &= (b->low[i] <= b->high[i]) & (b->low[i] > -INFINITY) & (b->high[i] < INFINITY);
    return good;
}

/* Bounds that are not finite have Embree leave a box out. */
static void bounds_of_box(const struct RTCBoundsFunctionArguments *arguments) {
    const hierarchy *h = arguments->geometryUserPtr;
    const zt_bvh_box *box = &h->boxes[arguments->primID];
    float low[3], high[3], grown = is_box(box) ? GROWN : -INFINITY;
    for (int i = 0; i < 3; i++) {
        low[i] = (float)(((double)box->low[i] - h->center[i]) * h->scale) - grown;
        high[i] = (float)(((double)box->high[i] - h->center[i]) * h->scale) + grown;
    }
    *arguments->bounds_o = (struct RTCBounds){.lower_x = low[0],
                                              .lower_y = low[1],
                                              .lower_z = low[2],
                                              .upper_x = high[0],
                                              .upper_y = high[1],
                                              .upper_z = high[2]};
}

/* Where members of Embree's ray packets stand, each of them one element for each lane. */
enum { MEMBER_FAR = 8, MEMBER_ID = 10 };

/* Embree hands on as many lanes at a time as it has instructions for, in an order of its own
 * where that is not 16: they are told by their numbers, which lanes that are not valid need not
 * have. */
ZT_CLONES static void visit_box(const struct RTCIntersectFunctionNArguments *arguments) {
    const look *l = (const look *)arguments->context;
    unsigned lane_count = arguments->N;
    float *packet_far = (float *)arguments->rayhit + MEMBER_FAR * (size_t)lane_count;
    const unsigned *number = (unsigned *)arguments->rayhit + MEMBER_ID * (size_t)lane_count;
    const float *far = l->rays->far + l->first;
    uint32_t lanes = 0;
    for (unsigned k = 0; k < lane_count; k++) {
        unsigned i = number[k] % LANES;
        lanes |= (uint32_t)(arguments->valid[k] & (far[i] > 0)) << i;
    }
    if (!lanes) return;
    uint32_t nearer = l->visit(l->user, (int32_t)arguments->primID, l->first, lanes);
    for (unsigned k = 0; nearer && k < lane_count; k++) {
        unsigned i = number[k] % LANES;
        if (!(nearer >> i & 1)) continue;
        double left = (double)far[i] * l->stretch[i] - l->moved[i];
        packet_far[k] = far[i] > 0 ? (float)left : -INFINITY;
    }
}

static zt_status new_hierarchy(zt_bvh **out, const zt_embree *embree) {
    hierarchy *h = calloc(1, sizeof *h);
    *out = (zt_bvh *)h;
    if (!h) return ZT_EMEMORY;
    h->base.door = &zt_door_embree;
    h->scene = rtcNewScene(embree->device);
    h->geometry = rtcNewGeometry(embree->device, RTC_GEOMETRY_TYPE_USER);
    if (!h->scene || !h->geometry) {
        embree_free(out);
        return ZT_EMEMORY;
    }
    rtcSetGeometryUserData(h->geometry, h);
    rtcSetGeometryBoundsFunction(h->geometry, bounds_of_box, NULL);
    rtcSetGeometryIntersectFunction(h->geometry, visit_box);
    rtcAttachGeometry(h->scene, h->geometry);
    return ZT_OK;
}

/* Has Embree's space reach from about -1 to 1. */
static void fit_space(hierarchy *h, const zt_bvh_box *boxes, int32_t count) {
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

static zt_status embree_of_boxes(zt_bvh **bvh, zt_embree *embree, const zt_bvh_box *boxes,
                                 int32_t box_count) {
    if (!*bvh) ZT_TRY(new_hierarchy(bvh, embree));
    hierarchy *h = (hierarchy *)*bvh;
    h->boxes = boxes;
    fit_space(h, boxes, box_count);
    rtcSetGeometryUserPrimitiveCount(h->geometry, (unsigned)box_count);
    rtcCommitGeometry(h->geometry);
    rtcCommitScene(h->scene);
    h->boxes = NULL;
    if (rtcGetDeviceError(embree->device) == RTC_ERROR_NONE) return ZT_OK;
    embree_free(bvh); /* the device has told what went wrong */
    return ZT_EMEMORY;
}

/* The power of two that is the exponent of an ordinary number, and its inverse. */
static inline void exponent_of(float *power, float *inverse, float a) {
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    bits &= 0x7f800000u;
    memcpy(power, &bits, sizeof bits);
    bits = 0x7f000000u - bits;
    memcpy(inverse, &bits, sizeof bits);
}

static inline float larger(float a, float b) { return a > b ? a : b; }

/* Fills a packet with rays from l->first on. Returns whether any of them looks anywhere. */
ZT_CLONES static bool load_packet(struct RTCRay16 *restrict packet, int *restrict valid,
                                  look *restrict l, const zt_bvh_rays *restrict rays,
                                  const hierarchy *restrict h) {
    double cx = h->center[0], cy = h->center[1], cz = h->center[2], scale = h->scale;
    int any = 0, first = l->first, count = rays->count - first;
    WIDE_LOOP
    for (int lane = 0; lane < LANES; lane++) {
        int i = first + lane;
        float dx = rays->dx[i], dy = rays->dy[i], dz = rays->dz[i];
        float length, shrink;
        exponent_of(&length, &shrink, larger(larger(fabsf(dx), fabsf(dy)), fabsf(dz)));
        double far = (double)rays->far[i], stretch = (double)length * scale * FURTHER;
        double ox = ((double)rays->ox[i] - cx) * scale, wx = (double)(dx * shrink);
        double oy = ((double)rays->oy[i] - cy) * scale, wy = (double)(dy * shrink);
        double oz = ((double)rays->oz[i] - cz) * scale, wz = (double)(dz * shrink);
        double nearest = -(ox * wx + oy * wy + oz * wz) / (wx * wx + wy * wy + wz * wz);
        double moved = nearest > BEFORE ? nearest - BEFORE : 0;
        float x = (float)(ox + moved * wx), left = (float)(far * stretch - moved);
        float y = (float)(oy + moved * wy), z = (float)(oz + moved * wz);
        packet->org_x[lane] = x;
        packet->org_y[lane] = y;
        packet->org_z[lane] = z;
        packet->dir_x[lane] = dx * shrink;
        packet->dir_y[lane] = dy * shrink;
        packet->dir_z[lane] = dz * shrink;
        l->stretch[lane] = stretch;
        l->moved[lane] = moved;
        /* Also false where a number is not finite. */
        bool near = (fabsf(x) <= REACH) & (fabsf(y) <= REACH) & (fabsf(z) <= REACH);
        int looks =
            -((lane < count) & near & (far > 0) & (left > 0) & (length > 0) & (shrink > 0));
        valid[lane] = looks;
        packet->tfar[lane] = looks ? left : -INFINITY; /* not all packets heed `valid` */
        any |= looks;
    }
    return any != 0;
}

static void embree_look(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_kind kind,
                        zt_bvh_visit *visit, void *user) {
    const hierarchy *h = (const hierarchy *)bvh;
    look l = {.rays = rays, .visit = visit, .user = user};
    rtcInitIntersectContext(&l.context);
    if (kind == ZT_BVH_COHERENT) l.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    alignas(64) struct RTCRayHit16 packet = {0}; /* what no ray changes is set once */
    memset(packet.ray.mask, 0xff, sizeof packet.ray.mask);
    memset(packet.hit.geomID, 0xff, sizeof packet.hit.geomID);
    for (unsigned lane = 0; lane < LANES; lane++) packet.ray.id[lane] = lane;
    for (; l.first < rays->count; l.first += LANES) {
        alignas(64) int valid[LANES];
        if (load_packet(&packet.ray, valid, &l, rays, h))
            rtcIntersect16(valid, h->scene, &l.context, &packet);
    }
}

ZT_MODULE_DOOR(zt_embree_door, embree) = {
    embree_open, embree_close, embree_of_boxes, embree_free, embree_look,
};
