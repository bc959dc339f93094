/* Loops over rays for one primitive that moves, as those of tracer/intersect.c for what stands
 * still: first the primitive's poses at the rays' times, then where these are met. Compiled
 * once for each width of instructions and each precision (tracer/isa.h). */
#include "tracer/motion_meet.h"

#include "tracer/motion_lanes.h"

#define RAY      from->x[i], from->y[i], from->z[i], rays->dx[i], rays->dy[i], rays->dz[i]
#define POINT(n) ((real3){s->of[n][j], s->of[n + 1][j], s->of[n + 2][j]})

/* How ray i meets what has the poses number j in `s`, further on than `least`; how it leaves
 * its surface as it is for what stands still. */
#define plane_MEET  zt_plane_meet(POINT(0), s->of[3][j], RAY, left, least)
#define sphere_MEET zt_sphere_meet(POINT(0), s->of[3][j], RAY, left, least)
#define triangle_MEET                                                                          \
    (left == 0 ? zt_triangle_meet(POINT(0), POINT(3), POINT(6), RAY) : REAL_INFINITY)
#define DEFINE_SOLID(kind, KIND)                                                               \
    static inline real kind##_moving(const zt_poses *restrict s, int j, real unit, real ox,    \
                                     real oy, real oz, real dx, real dy, real dz,              \
                                     int32_t left, real near) {                                \
        zt_solid_pose m = zt_solid_at(s, j, unit, KIND);                                       \
        real gx = ox - m.center.x, gy = oy - m.center.y, gz = oz - m.center.z;                 \
        real t =                                                                               \
            zt_##kind##_meet(real_dot(m.x.x, m.x.y, m.x.z, gx, gy, gz),                        \
                             real_dot(m.y.x, m.y.y, m.y.z, gx, gy, gz),                        \
                             real_dot(m.z.x, m.z.y, m.z.z, gx, gy, gz),                        \
                             real_dot(m.x.x, m.x.y, m.x.z, dx, dy, dz),                        \
                             real_dot(m.y.x, m.y.y, m.y.z, dx, dy, dz),                        \
                             real_dot(m.z.x, m.z.y, m.z.z, dx, dy, dz), m.a, m.b, left, near); \
        return m.good ? t : REAL_INFINITY;                                                     \
    }
DEFINE_SOLID(ball, ZT_PRIMITIVE_BALL)
DEFINE_SOLID(disk, ZT_PRIMITIVE_DISK)
DEFINE_SOLID(box, ZT_PRIMITIVE_BOX)
DEFINE_SOLID(cylinder, ZT_PRIMITIVE_CYLINDER)
DEFINE_SOLID(cone, ZT_PRIMITIVE_CONE)
DEFINE_SOLID(capsule, ZT_PRIMITIVE_CAPSULE)
DEFINE_SOLID(torus, ZT_PRIMITIVE_TORUS)
#define ball_MEET     ball_moving(s, j, unit, RAY, left, least)
#define disk_MEET     disk_moving(s, j, unit, RAY, left, least)
#define box_MEET      box_moving(s, j, unit, RAY, left, least)
#define cylinder_MEET cylinder_moving(s, j, unit, RAY, left, least)
#define cone_MEET     cone_moving(s, j, unit, RAY, left, least)
#define capsule_MEET  capsule_moving(s, j, unit, RAY, left, least)
#define torus_MEET    torus_moving(s, j, unit, RAY, left, least)

#define DEFINE_LOOPS(kind)                                                                     \
    static void kind##_lanes(zt_batch *restrict rays, const zt_origins *restrict from,         \
                             const zt_poses *restrict s, real unit, int32_t index, int first,  \
                             int count, real tie) {                                            \
        const real more = 1 + tie, share = tie / TIE, least = 0;                               \
        (void)unit, (void)least;                                                               \
        WIDE_LOOP for (int j = 0; j < count; j++) {                                            \
            int i = first + j;                                                                 \
            int32_t left = zt_leaving(from->source[i], index);                                 \
            real t = kind##_MEET, nearest = rays->t[i], near = share * from->near[i];          \
            int32_t hit = rays->hit[i], later = index > hit;                                   \
            int32_t before = t * more + near < nearest, after = nearest * more + near < t;     \
            int32_t no_later = (t < REAL_INFINITY) & (after == 0);                             \
            int32_t close = zt_is_close(t, nearest, tie, near) & (index != hit);               \
            rays->close[i] = zt_closer(rays->close[i], close);                                 \
            int32_t nearer = (later & before) | ((1 - later) & no_later);                      \
            rays->t[i] = nearer ? t : nearest;                                                 \
            rays->hit[i] = nearer ? index : hit;                                               \
        }                                                                                      \
    }                                                                                          \
    static void kind##_any(zt_batch *restrict rays, const zt_origins *restrict from,           \
                           const zt_poses *restrict s, real unit, int32_t index, int first,    \
                           int count, real tie) {                                              \
        (void)unit, (void)tie;                                                                 \
        WIDE_LOOP for (int j = 0; j < count; j++) {                                            \
            int i = first + j;                                                                 \
            int32_t left = zt_leaving(from->source[i], index);                                 \
            real least = from->near[i], t = kind##_MEET;                                       \
            int32_t hit = rays->hit[i];                                                        \
            rays->hit[i] = ((t > least) & (t * (1 + TIE) + least < rays->t[i])) ? 0 : hit;     \
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

typedef void loop(zt_batch *restrict rays, const zt_origins *restrict from,
                  const zt_poses *restrict s, real unit, int32_t index, int first, int count,
                  real tie);
static loop *const loops[ZT_PRIMITIVE_KIND_COUNT][2] = {
    [ZT_PRIMITIVE_PLANE] = {plane_lanes, plane_any},
    [ZT_PRIMITIVE_SPHERE] = {sphere_lanes, sphere_any},
    [ZT_PRIMITIVE_TRIANGLE] = {triangle_lanes, triangle_any},
    [ZT_PRIMITIVE_BALL] = {ball_lanes, ball_any},
    [ZT_PRIMITIVE_DISK] = {disk_lanes, disk_any},
    [ZT_PRIMITIVE_BOX] = {box_lanes, box_any},
    [ZT_PRIMITIVE_CYLINDER] = {cylinder_lanes, cylinder_any},
    [ZT_PRIMITIVE_CONE] = {cone_lanes, cone_any},
    [ZT_PRIMITIVE_CAPSULE] = {capsule_lanes, capsule_any},
    [ZT_PRIMITIVE_TORUS] = {torus_lanes, torus_any}};

void ZT_KERNEL_NAME(zt_meet_moving)(zt_batch *rays, const zt_tracer *tracer, int32_t index,
                                    int first, int end, bool any) {
    const zt_primitive *p = &tracer->primitives[index];
    zt_poses poses;
    for (int at = first; at < end; at += ZT_POSE_LANES) {
        int count = end - at < ZT_POSE_LANES ? end - at : ZT_POSE_LANES;
        zt_load_poses(&poses, p->poses, zt_pose_size(p->kind), tracer->straight, rays->from, at,
                      count);
        loops[p->kind][any](rays, rays->from, &poses, p->unit, index, at, count, tracer->tie);
    }
}
