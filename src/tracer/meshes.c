/* Each mesh has an Embree scene of its own, in its own space, built once in a run; a frame's
 * top-level scene holds instances of them. Embree finds which triangle a ray meets; how far
 * away that is, is worked out again here in double precision, so that distances compare with
 * those of other primitives and do not depend on which instructions Embree has found. */
#include "tracer/meshes.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>

#include "base/diag.h"

enum { LANES = 16, PARTS_MAX = 128 };

/* How much further than the nearest hit so far Embree looks, for the roundings of its
 * distances. */
#define LOOK_FURTHER (1 + 0x1p-18f)

typedef struct placed_mesh {
    const zt_mesh *mesh;
    int32_t primitive;
    xform place;
    double extent; /* the largest coordinate of its bounds, in the mesh's space and placed */
} placed_mesh;

struct zt_meshes {
    const zt_mesh *meshes;
    int32_t mesh_count;
    zt_listener listener;
    RTCDevice device;
    RTCScene *built; /* one for each mesh; NULL until it is needed, as are the hulls */
    zt_hull **hulls;
    RTCScene top;
    /* Instance number i of `top` shows placed[i]; those from placed_count on are disabled. */
    placed_mesh *placed;
    RTCGeometry *instances;
    int32_t placed_count, instance_count, instance_capacity;
    int32_t *placed_of_primitive;
    int32_t primitive_capacity;
    /* One for each placed mesh; with more than ZT_HULLS_MAX the last one holds all the rest. */
    zt_placed_hull placed_hulls[ZT_HULLS_MAX];
    zt_box rest_boxes[2];
};

static void tell_device_error(void *user, enum RTCError code, const char *text) {
    const zt_meshes *m = user;
    zt_tell(m->listener, ZT_ERROR, "Embree, which intersects meshes: %s (error %d)", text,
            (int)code);
}

zt_status zt_meshes_open(zt_meshes **out, const zt_mesh *meshes, int32_t mesh_count,
                         zt_listener listener) {
    *out = NULL;
    zt_meshes *m = calloc(1, sizeof *m);
    if (!m) return ZT_EMEMORY;
    m->meshes = meshes;
    m->mesh_count = mesh_count;
    m->listener = listener;
    m->built = calloc((size_t)mesh_count + 1, sizeof(RTCScene));
    m->hulls = calloc((size_t)mesh_count + 1, sizeof *m->hulls);
    if (!m->built || !m->hulls) {
        zt_meshes_close(&m);
        return ZT_EMEMORY;
    }
    *out = m;
    return ZT_OK;
}

void zt_meshes_close(zt_meshes **slot) {
    zt_meshes *m = *slot;
    if (!m) return;
    for (int32_t i = 0; i < m->instance_count; i++) rtcReleaseGeometry(m->instances[i]);
    if (m->top) rtcReleaseScene(m->top);
    for (int32_t i = 0; i < m->mesh_count; i++) {
        if (m->built && m->built[i]) rtcReleaseScene(m->built[i]);
        if (m->hulls) free(m->hulls[i]);
    }
    if (m->device) rtcReleaseDevice(m->device);
    free(m->built);
    free(m->hulls);
    free(m->placed);
    free(m->instances);
    free(m->placed_of_primitive);
    free(m);
    *slot = NULL;
}

void zt_meshes_clear(zt_meshes *m) { m->placed_count = 0; }

/* One thread builds: the tree, and with it which of two equally near triangles is met, does not
 * depend on the number of cores. */
static zt_status start_device(zt_meshes *m) {
    m->device = rtcNewDevice("threads=1");
    if (!m->device) {
        zt_tell(m->listener, ZT_ERROR, "Embree, which intersects meshes, does not start here");
        return ZT_EUNSUPPORTED;
    }
    rtcSetDeviceErrorFunction(m->device, tell_device_error, m);
    m->top = rtcNewScene(m->device);
    if (!m->top) return ZT_EMEMORY;
    rtcSetSceneFlags(m->top, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    return ZT_OK;
}

static zt_status build_hull(zt_meshes *m, int32_t index) {
    const zt_mesh *mesh = &m->meshes[index];
    int32_t *order = malloc((size_t)mesh->triangle_count * sizeof *order + 1);
    if (!m->hulls[index]) m->hulls[index] = malloc(sizeof **m->hulls);
    bool room = order && m->hulls[index];
    if (room) zt_hull_build(m->hulls[index], mesh, order);
    free(order);
    return room ? ZT_OK : ZT_EMEMORY;
}

static zt_status build_mesh(zt_meshes *m, int32_t index) {
    const zt_mesh *mesh = &m->meshes[index];
    RTCScene scene = m->built[index] = rtcNewScene(m->device);
    if (!scene) return ZT_EMEMORY;
    RTCGeometry geometry = rtcNewGeometry(m->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!geometry) return ZT_EMEMORY;
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh->positions, 0, 3 * sizeof(float),
                               (size_t)mesh->vertex_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh->triangles, 0, 3 * sizeof(uint32_t),
                               (size_t)mesh->triangle_count);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene);
    return rtcGetDeviceError(m->device) == RTC_ERROR_NONE ? ZT_OK : ZT_EMEMORY;
}

/* Makes room for one more instance, disabled. */
static zt_status grow_instances(zt_meshes *m) {
    if (m->instance_count == m->instance_capacity) {
        size_t capacity = m->instance_capacity ? 2 * (size_t)m->instance_capacity : 16;
        placed_mesh *placed = realloc(m->placed, capacity * sizeof *placed);
        if (placed) m->placed = placed;
        RTCGeometry *instances = realloc(m->instances, capacity * sizeof(RTCGeometry));
        if (instances) m->instances = instances;
        if (!placed || !instances) return ZT_EMEMORY;
        m->instance_capacity = (int32_t)capacity;
    }
    RTCGeometry instance = rtcNewGeometry(m->device, RTC_GEOMETRY_TYPE_INSTANCE);
    if (!instance) return ZT_EMEMORY;
    rtcAttachGeometryByID(m->top, instance, (unsigned)m->instance_count);
    m->instances[m->instance_count++] = instance;
    return ZT_OK;
}

static zt_status reach_primitive(zt_meshes *m, int32_t primitive) {
    if (primitive < m->primitive_capacity) return ZT_OK;
    size_t capacity = 2 * (size_t)primitive + 16;
    int32_t *grown = realloc(m->placed_of_primitive, capacity * sizeof *grown);
    if (!grown) return ZT_EMEMORY;
    m->placed_of_primitive = grown;
    m->primitive_capacity = (int32_t)capacity;
    return ZT_OK;
}

zt_status zt_meshes_place(zt_meshes *m, int32_t mesh, int32_t primitive, const xform *place) {
    if (!m->device) ZT_TRY(start_device(m));
    if (!m->built[mesh]) {
        ZT_TRY(build_hull(m, mesh));
        ZT_TRY(build_mesh(m, mesh));
    }
    if (m->placed_count == m->instance_count) ZT_TRY(grow_instances(m));
    ZT_TRY(reach_primitive(m, primitive));
    const zt_mesh *numbers = &m->meshes[mesh];
    vec3 reach = vec3_max(vec3_scale(numbers->low, -1), numbers->high);
    vec3 at = xform_point(place, numbers->origin);
    double own = vec3_max_abs(reach);
    double longest =
        fmax(vec3_max_abs(place->x), fmax(vec3_max_abs(place->y), vec3_max_abs(place->z)));
    m->placed[m->placed_count] = (placed_mesh){numbers, primitive, *place,
                                               vec3_max_abs(place->shift) + 3 * longest * own};
    m->placed_of_primitive[primitive] = m->placed_count;
    RTCGeometry instance = m->instances[m->placed_count++];
    const float columns[12] = {(float)place->x.x, (float)place->x.y, (float)place->x.z,
                               (float)place->y.x, (float)place->y.y, (float)place->y.z,
                               (float)place->z.x, (float)place->z.y, (float)place->z.z,
                               (float)at.x,       (float)at.y,       (float)at.z};
    rtcSetGeometryInstancedScene(instance, m->built[mesh]);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    rtcEnableGeometry(instance);
    rtcCommitGeometry(instance);
    return ZT_OK;
}

static real3 row_of(double x, double y, double z) { return (real3){(real)x, (real)y, (real)z}; }

/* A box around a placed mesh: its bounds, turned into the space relative to the camera. */
static zt_box box_around(const placed_mesh *placed) {
    const xform *m = &placed->place;
    vec3 half = vec3_scale(vec3_sub(placed->mesh->high, placed->mesh->low), 0.5);
    vec3 center = xform_point(m, vec3_add(placed->mesh->low, half));
    vec3 reach = {fabs(m->x.x) * half.x + fabs(m->y.x) * half.y + fabs(m->z.x) * half.z,
                  fabs(m->x.y) * half.x + fabs(m->y.y) * half.y + fabs(m->z.y) * half.z,
                  fabs(m->x.z) * half.x + fabs(m->y.z) * half.y + fabs(m->z.z) * half.z};
    vec3 low = vec3_sub(center, reach), high = vec3_add(center, reach);
    return (zt_box){row_of(low.x, low.y, low.z), row_of(high.x, high.y, high.z)};
}

static zt_box box_of_both(zt_box a, zt_box b) {
    return (zt_box){
        {fminf(a.low.x, b.low.x), fminf(a.low.y, b.low.y), fminf(a.low.z, b.low.z)},
        {fmaxf(a.high.x, b.high.x), fmaxf(a.high.y, b.high.y), fmaxf(a.high.z, b.high.z)}};
}

/* The hull of a placed mesh, with the parts of one level. */
static zt_placed_hull place_hull(const zt_meshes *m, const placed_mesh *placed, int level) {
    const zt_hull *hull = m->hulls[placed->mesh - m->meshes];
    xform place = placed->place;
    place.shift = xform_point(&place, placed->mesh->origin);
    xform back = xform_inverse(&place);
    double reach =
        3 * fmax(vec3_max_abs(back.x), fmax(vec3_max_abs(back.y), vec3_max_abs(back.z)));
    return (zt_placed_hull){
        .rows = {row_of(back.x.x, back.y.x, back.z.x), row_of(back.x.y, back.y.y, back.z.y),
                 row_of(back.x.z, back.y.z, back.z.z)},
        .at = row_of(back.shift.x, back.shift.y, back.shift.z),
        .reach = (real)reach,
        .size = (real)(reach * vec3_max_abs(place.shift) + zt_box_size(&hull->boxes[1])),
        .around = box_around(placed),
        .boxes = hull->boxes,
        .level = level};
}

static void place_hulls(zt_meshes *m) {
    bool crowd = m->placed_count > ZT_HULLS_MAX;
    int32_t single_count = crowd ? ZT_HULLS_MAX - 1 : m->placed_count;
    int level = 0;
    while (level + 1 < ZT_HULL_LEVELS && (single_count << (level + 1)) <= PARTS_MAX) level++;
    for (int32_t i = 0; i < single_count; i++)
        m->placed_hulls[i] = place_hull(m, &m->placed[i], level);
    if (!crowd) return;
    zt_box rest = box_around(&m->placed[single_count]);
    for (int32_t i = single_count + 1; i < m->placed_count; i++)
        rest = box_of_both(rest, box_around(&m->placed[i]));
    m->rest_boxes[1] = rest;
    m->placed_hulls[single_count] = (zt_placed_hull){.rows = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                                     .reach = 1,
                                                     .size = (real)zt_box_size(&rest),
                                                     .around = rest,
                                                     .boxes = m->rest_boxes};
}

zt_status zt_meshes_commit(zt_meshes *m) {
    place_hulls(m);
    for (int32_t i = m->placed_count; i < m->instance_count; i++)
        rtcDisableGeometry(m->instances[i]);
    rtcCommitScene(m->top);
    return rtcGetDeviceError(m->device) == RTC_ERROR_NONE ? ZT_OK : ZT_EMEMORY;
}

int zt_meshes_hulls(const zt_placed_hull **hulls, const zt_meshes *m) {
    *hulls = m->placed_hulls;
    return m->placed_count < ZT_HULLS_MAX ? m->placed_count : ZT_HULLS_MAX;
}

static void corners(vec3 *corner, const placed_mesh *placed, int32_t triangle) {
    for (int i = 0; i < 3; i++)
        corner[i] = xform_point(&placed->place, zt_mesh_corner(placed->mesh, triangle, i));
}

/* Where ray number i meets the plane of a triangle; what Embree said where that is no place in
 * front of it, as for a ray within the plane. */
static real plane_distance(const zt_batch *rays, int i, const placed_mesh *placed,
                           int32_t triangle, real embree_distance) {
    vec3 corner[3];
    corners(corner, placed, triangle);
    vec3 normal = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
    vec3 origin = {(double)rays->ox[i], (double)rays->oy[i], (double)rays->oz[i]};
    vec3 direction = {(double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i]};
    double t = vec3_dot(normal, vec3_sub(corner[0], origin)) / vec3_dot(normal, direction);
    return t > 0 && t <= (double)embree_distance * 1.001 ? (real)t : embree_distance;
}

/* Fills a packet with listed rays, `count` of them, which look `reach` times as far as the
 * batch's t. Lanes beyond repeat the last ray and are not valid. */
static void load_packet(struct RTCRay16 *packet, int *valid, const zt_batch *rays,
                        const int32_t *list, int count, real reach) {
    for (int lane = 0; lane < LANES; lane++) {
        int i = list[lane < count ? lane : count - 1];
        valid[lane] = lane < count ? -1 : 0;
        packet->org_x[lane] = rays->ox[i];
        packet->org_y[lane] = rays->oy[i];
        packet->org_z[lane] = rays->oz[i];
        packet->dir_x[lane] = rays->dx[i];
        packet->dir_y[lane] = rays->dy[i];
        packet->dir_z[lane] = rays->dz[i];
        packet->tnear[lane] = 0;
        packet->tfar[lane] = rays->t[i] * reach;
        packet->time[lane] = 0;
        packet->mask[lane] = ~0u;
        packet->id[lane] = 0;
        packet->flags[lane] = 0;
    }
}

static void take_hit(const zt_meshes *m, zt_batch *rays, int i,
                     const struct RTCRayHit16 *packet, int lane) {
    const placed_mesh *placed = &m->placed[packet->hit.instID[0][lane]];
    int32_t triangle = (int32_t)packet->hit.primID[lane];
    real t = plane_distance(rays, i, placed, triangle, packet->ray.tfar[lane]);
    bool nearer = t < rays->t[i] || (t == rays->t[i] && placed->primitive < rays->hit[i]);
    if (!nearer) return;
    rays->t[i] = t;
    rays->hit[i] = placed->primitive;
    rays->part[i] = triangle;
}

void zt_meshes_intersect(const zt_meshes *m, zt_batch *rays, const int32_t *list,
                         int list_count) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        RTC_INTERSECT_CONTEXT_FLAG_COHERENT; /* half the time, also for mirrored rays */
    for (int first = 0; first < list_count; first += LANES) {
        alignas(64) int valid[LANES];
        alignas(64) struct RTCRayHit16 packet;
        load_packet(&packet.ray, valid, rays, list + first, list_count - first, LOOK_FURTHER);
        for (int lane = 0; lane < LANES; lane++) {
            packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
            packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, m->top, &context, &packet);
        for (int lane = 0; lane < LANES; lane++)
            if (valid[lane] && packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID)
                take_hit(m, rays, list[first + lane], &packet, lane);
    }
}

void zt_meshes_occlude(const zt_meshes *m, zt_batch *rays, const int32_t *list,
                       int list_count) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (int first = 0; first < list_count; first += LANES) {
        alignas(64) int valid[LANES];
        alignas(64) struct RTCRay16 packet;
        load_packet(&packet, valid, rays, list + first, list_count - first, 1);
        rtcOccluded16(valid, m->top, &context, &packet);
        for (int lane = 0; lane < LANES; lane++)
            if (valid[lane] && packet.tfar[lane] < 0) rays->hit[list[first + lane]] = 0;
    }
}

void zt_meshes_surface(real3 *normal, real3 *corner, real *extent, const zt_meshes *m,
                       int32_t primitive, int32_t part) {
    const placed_mesh *placed = &m->placed[m->placed_of_primitive[primitive]];
    vec3 c[3];
    corners(c, placed, part);
    vec3 n = vec3_normalize(vec3_cross(vec3_sub(c[1], c[0]), vec3_sub(c[2], c[0])));
    *normal = (real3){(real)n.x, (real)n.y, (real)n.z};
    *corner = (real3){(real)c[0].x, (real)c[0].y, (real)c[0].z};
    *extent = (real)placed->extent;
}
