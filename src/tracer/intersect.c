/* What a batch of rays meets. Loops run over the rays for one primitive after the other,
 * without branches, so that the compiler makes them as wide as it may. Compiled once for each
 * width of instructions and each precision (tracer/isa.h). */
#include "tracer/intersect.h"

#include <string.h>

#include "tracer/motion_meet.h"
#include "tracer/search.h"

/* The loops of each kind of primitive: nearest hits, whether there is one at all, and nearest
 * hits of some lanes, in any order of primitives. Where things lie on each other (tie > 0), a
 * later primitive's hit counts where it is nearer by more than roundings, and an earlier one's
 * where the later one's is not: of two the same one counts in either order. */
#define DISTANCE(kind, i, near)                                                                \
    zt_##kind##_distance(&own, from->x[i], from->y[i], from->z[i], rays->dx[i], rays->dy[i],   \
                         rays->dz[i], zt_leaving(from->source[i], index), near)
#define DEFINE_LOOPS(kind)                                                                     \
    static void kind##_nearest(zt_batch *restrict rays, const zt_origins *restrict from,       \
                               const zt_primitive *p, int32_t index, int count, real tie) {    \
        const zt_primitive own = *p;                                                           \
        const real more = 1 + tie, share = tie / TIE;                                          \
        WIDE_LOOP for (int i = 0; i < count; i++) {                                            \
            real t = DISTANCE(kind, i, 0), nearest = rays->t[i];                               \
            int32_t hit = rays->hit[i];                                                        \
            bool nearer = t * more + share * from->near[i] < nearest;                          \
            rays->t[i] = nearer ? t : nearest;                                                 \
            rays->hit[i] = nearer ? index : hit;                                               \
        }                                                                                      \
    }                                                                                          \
    static void kind##_any(zt_batch *restrict rays, const zt_origins *restrict from,           \
                           const zt_primitive *p, int32_t index, int first, int end) {         \
        const zt_primitive own = *p;                                                           \
        WIDE_LOOP for (int i = first; i < end; i++) {                                          \
            real near = from->near[i], t = DISTANCE(kind, i, near);                            \
            int32_t hit = rays->hit[i];                                                        \
            rays->hit[i] = ((t > near) & (t * (1 + TIE) + near < rays->t[i])) ? 0 : hit;       \
        }                                                                                      \
    }                                                                                          \
    static void kind##_lanes(zt_batch *restrict rays, const zt_origins *restrict from,         \
                             const zt_primitive *p, int32_t index, int first, real tie) {      \
        const zt_primitive own = *p;                                                           \
        const real more = 1 + tie, share = tie / TIE;                                          \
        WIDE_LOOP for (int i = first; i < first + ZT_BATCH_LANES; i++) {                       \
            real t = DISTANCE(kind, i, 0), nearest = rays->t[i], near = share * from->near[i]; \
            int32_t hit = rays->hit[i], later = index > hit;                                   \
            int32_t before = t * more + near < nearest, after = nearest * more + near < t;     \
            int32_t no_later = (t < REAL_INFINITY) & (after == 0);                             \
            int32_t close = zt_is_close(t, nearest, tie, near) & (index != hit);               \
            rays->close[i] = zt_closer(rays->close[i], close);                                 \
            int32_t nearer = (later & before) | ((1 - later) & no_later);                      \
            rays->t[i] = nearer ? t : nearest;                                                 \
            rays->hit[i] = nearer ? index : hit;                                               \
        }                                                                                      \
    }
DEFINE_LOOPS(plane)
DEFINE_LOOPS(sphere)
DEFINE_LOOPS(triangle)
DEFINE_LOOPS(ball)
DEFINE_LOOPS(disk)
DEFINE_LOOPS(box)
DEFINE_LOOPS(cylinder)
DEFINE_LOOPS(cone)
DEFINE_LOOPS(capsule)
DEFINE_LOOPS(torus)

/* The loop of a kind, by the kind; none of meshes. */
#define LOOPS(name)                                                                            \
    {                                                                                          \
        [ZT_PRIMITIVE_PLANE] = plane_##name, [ZT_PRIMITIVE_SPHERE] = sphere_##name,            \
        [ZT_PRIMITIVE_TRIANGLE] = triangle_##name, [ZT_PRIMITIVE_BALL] = ball_##name,          \
        [ZT_PRIMITIVE_DISK] = disk_##name, [ZT_PRIMITIVE_BOX] = box_##name,                    \
        [ZT_PRIMITIVE_CYLINDER] = cylinder_##name, [ZT_PRIMITIVE_CONE] = cone_##name,          \
        [ZT_PRIMITIVE_CAPSULE] = capsule_##name, [ZT_PRIMITIVE_TORUS] = torus_##name           \
    }

typedef void loop(zt_batch *restrict rays, const zt_origins *restrict from,
                  const zt_primitive *p, int32_t index, int count, real tie);
static loop *const nearest_loops[ZT_PRIMITIVE_KIND_COUNT] = LOOPS(nearest);

typedef void any_loop(zt_batch *restrict rays, const zt_origins *restrict from,
                      const zt_primitive *p, int32_t index, int first, int end);
static any_loop *const any_loops[ZT_PRIMITIVE_KIND_COUNT] = LOOPS(any);

typedef void lanes_loop(zt_batch *restrict rays, const zt_origins *restrict from,
                        const zt_primitive *p, int32_t index, int first, real tie);
static lanes_loop *const lanes_loops[ZT_PRIMITIVE_KIND_COUNT] = LOOPS(lanes);

void ZT_KERNEL_NAME(zt_meet_lanes)(zt_batch *rays, const zt_tracer *tracer, int32_t index,
                                   int first, bool any) {
    const zt_primitive *p = &tracer->primitives[index];
    if (p->poses)
        ZT_KERNEL_NAME(zt_meet_moving)(rays, tracer, index, first, first + ZT_BATCH_LANES, any);
    else if (any)
        any_loops[p->kind](rays, rays->from, p, index, first, first + ZT_BATCH_LANES);
    else
        lanes_loops[p->kind](rays, rays->from, p, index, first, tracer->tie);
}

/* Whether a primitive can be met by a ray of a bundle, and where. What all rays leave, and none
 * inwards, is not met again unless it bulges inwards. */
static bool may_meet(zt_depths *at, const zt_bundle *b, const zt_primitive *p, int32_t index) {
    bool bulges = p->kind == ZT_PRIMITIVE_TORUS || p->kind == ZT_PRIMITIVE_MESH;
    if (b->source == index && !bulges) return false;
    *at = (zt_depths){0, INFINITY};
    if (p->kind == ZT_PRIMITIVE_PLANE && p->poses) return true;
    return p->kind == ZT_PRIMITIVE_PLANE
               ? zt_bundle_meets_plane(at, b, p->plane.normal, p->plane.distance)
               : zt_bundle_meets_at(at, b, &p->box, p->stretch);
}

bool ZT_KERNEL_NAME(zt_may_meet)(zt_bundle *b, const zt_tracer *tracer) {
    zt_depths unused;
    for (; b->passed_count < tracer->single_count; b->passed_count++) {
        int32_t index = tracer->single[b->passed_count];
        if (may_meet(&unused, b, &tracer->primitives[index], index)) return true;
    }
    return tracer->crowd_count > 0;
}

enum { MEETINGS_MAX = 64 };

/* Things that a bundle may meet, and how near. */
typedef struct meetings {
    int32_t index[MEETINGS_MAX];
    double near[MEETINGS_MAX];
    int count;
    double far; /* by there all rays have met one of them or of those before */
} meetings;

/* Lists things that are asked one by one, as many as there is room for; returns the first one
 * that is left. */
static int32_t list_meetings(meetings *m, const zt_bundle *bundle, const zt_tracer *tracer,
                             int32_t k) {
    m->count = 0;
    for (; k < tracer->single_count && m->count < MEETINGS_MAX; k++) {
        int32_t index = tracer->single[k];
        const zt_primitive *p = &tracer->primitives[index];
        zt_depths at;
        if (p->kind == ZT_PRIMITIVE_MESH || !may_meet(&at, bundle, p, index)) continue;
        m->index[m->count] = index;
        m->near[m->count++] = at.near;
        m->far = least_of(m->far, at.far);
    }
    return k;
}

bool ZT_KERNEL_NAME(zt_intersect)(zt_batch *rays, const zt_bundle *bundle,
                                  const zt_tracer *tracer) {
    const double behind = 1 + 0x1p-10;
    meetings m;
    int padded = zt_batch_padded(rays->count);
    for (int i = 0; i < padded; i++) {
        rays->t[i] = REAL_INFINITY;
        rays->hit[i] = -1;
    }
    if (tracer->crowd_count > 0) memset(rays->close, 0, sizeof rays->close);
    bool any = tracer->placed_count > 0 || tracer->crowd_count > 0;
    const bool searches = any;
    m.far = INFINITY;
    for (int32_t k = 0; k < tracer->single_count;) {
        k = list_meetings(&m, bundle, tracer, k);
        any |= m.count > 0;
        for (int i = 0; i < m.count; i++) {
            const zt_primitive *p = &tracer->primitives[m.index[i]];
            /* Where nothing lies on anything else, what is behind another thing is not met. */
            if (tracer->tie == 0 && m.near[i] > m.far * behind) continue;
            if (p->poses)
                ZT_KERNEL_NAME(zt_meet_moving)(rays, tracer, m.index[i], 0, padded, false);
            else
                nearest_loops[p->kind](rays, rays->from, p, m.index[i], padded, tracer->tie);
        }
    }
    if (searches) ZT_KERNEL_NAME(zt_search_nearest)(rays, bundle, tracer);
    return any;
}

void ZT_KERNEL_NAME(zt_occlude)(zt_batch *rays, const zt_bundle *bundle,
                                const zt_tracer *tracer) {
    zt_depths unused;
    int padded = zt_batch_padded(rays->count);
    for (int32_t k = bundle->passed_count; k < tracer->single_count; k++) {
        int32_t index = tracer->single[k];
        const zt_primitive *p = &tracer->primitives[index];
        if (p->kind == ZT_PRIMITIVE_MESH || !may_meet(&unused, bundle, p, index)) continue;
        if (p->poses)
            ZT_KERNEL_NAME(zt_meet_moving)(rays, tracer, index, 0, padded, true);
        else
            any_loops[p->kind](rays, rays->from, p, index, 0, padded);
    }
    if (tracer->placed_count > 0 || tracer->crowd_count > 0)
        ZT_KERNEL_NAME(zt_search_any)(rays, bundle, tracer);
}
