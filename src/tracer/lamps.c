/* Lamps that have a size or move, for the points of a batch. Loops run over whole groups of
 * lanes. Compiled once for each width of instructions and each precision (tracer/isa.h). */
#include "tracer/lamps.h"

#include <string.h>

#include "tracer/sampler.h"

/* Where on the lamp each point looks. */
typedef struct places {
    alignas(64) float u[ZT_BATCH];
    alignas(64) float v[ZT_BATCH];
} places;

static void take_places(places *restrict at, const zt_points *restrict p,
                        const zt_rays *restrict given, uint32_t dimension) {
    int padded = zt_batch_padded(p->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        int32_t i = p->pixel[k];
        zt_sample_point(&at->u[k], &at->v[k], given->key[i], dimension, given->sample[i]);
    }
}

static LAMP_INLINE real mix(real a, real b, real t) { return a * (1 - t) + b * t; }

static LAMP_INLINE real3 mix3(real3 a, real3 b, real t) {
    return (real3){mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t)};
}

static LAMP_INLINE real3 unit3(real3 v) {
    real by = 1 / real_sqrt(real_dot(v.x, v.y, v.z, v.x, v.y, v.z));
    return (real3){v.x * by, v.y * by, v.z * by};
}

/* A lamp on its way from one moment to the next. Axes go straight on as all else does, and are
 * made unit and square again. */
static LAMP_INLINE zt_lamp_pose pose_between(const zt_lamp_pose *p, real t, bool turns) {
    const zt_lamp_pose *q = p + 1;
    zt_lamp_pose pose = {.position = mix3(p->position, q->position, t),
                         .power = mix3(p->power, q->power, t),
                         .a = mix(p->a, q->a, t),
                         .b = mix(p->b, q->b, t),
                         .shadows = t < (real)0.5 ? p->shadows : q->shadows};
    if (!turns) return pose;
    real3 x = unit3(mix3(p->x, q->x, t)), y = mix3(p->y, q->y, t);
    real along = real_dot(x.x, x.y, x.z, y.x, y.y, y.z);
    y = unit3((real3){y.x - along * x.x, y.y - along * x.y, y.z - along * x.z});
    pose.x = x;
    pose.y = y;
    pose.z = (real3){x.y * y.z - x.z * y.y, x.z * y.x - x.x * y.z, x.x * y.y - x.y * y.x};
    return pose;
}

/* One lamp's work on a batch. */
typedef struct task {
    zt_lamp_light *light;
    zt_batch *shadow;
    const zt_lamp *lamp;
    const zt_points *points;
    const places *at;
} task;

typedef void aim(const task *task);

/* All points, of lamps of a kind that stand still, move, or move straight on between the only
 * two moments there are, whose poses then are not looked up. */
#define DEFINE_AIM(name, WAY, moves, straight, turns)                                          \
    static void name(const task *task) {                                                       \
        zt_batch *restrict shadow = task->shadow;                                              \
        const zt_origins *restrict from = shadow->from;                                        \
        const zt_points *restrict p = task->points;                                            \
        const zt_lamp_pose *poses = task->lamp->poses, still = *poses;                         \
        const float *restrict us = task->at->u, *restrict vs = task->at->v;                    \
        zt_lamp_light *restrict light = task->light;                                           \
        int padded = zt_batch_padded(p->count);                                                \
        WIDE_LOOP for (int k = 0; k < padded; k++) {                                           \
            zt_lamp_pose l = still;                                                            \
            if (moves)                                                                         \
                l = pose_between(poses + ((straight) ? 0 : from->moment[k]), from->between[k], \
                                 (turns));                                                     \
            real px = from->x[k], py = from->y[k], pz = from->z[k];                            \
            real nx = p->nx[k], ny = p->ny[k], nz = p->nz[k];                                  \
            float u = us[k], v = vs[k];                                                        \
            zt_lamp_way way = (WAY);                                                           \
            light->r[k] = l.power.x * way.fade;                                                \
            light->g[k] = l.power.y * way.fade;                                                \
            light->b[k] = l.power.z * way.fade;                                                \
            shadow->dx[k] = way.x;                                                             \
            shadow->dy[k] = way.y;                                                             \
            shadow->dz[k] = way.z;                                                             \
            shadow->t[k] = l.shadows != 0 ? way.distance : 0;                                  \
        }                                                                                      \
    }
#define DEFINE_AIMS(kind, WAY, turns)                                                          \
    DEFINE_AIM(kind##_still, WAY, false, false, turns)                                         \
    DEFINE_AIM(kind##_straight, WAY, true, true, turns)                                        \
    DEFINE_AIM(kind##_moving, WAY, true, false, turns)                                         \
    static aim *const kind##_aims[] = {kind##_still, kind##_straight, kind##_moving};
DEFINE_AIMS(point, zt_point_way(&l, px, py, pz, nx, ny, nz, u, v), false)
DEFINE_AIMS(ball, zt_ball_way(&l, px, py, pz, nx, ny, nz, u, v), false)
DEFINE_AIMS(disk, zt_disk_way(&l, px, py, pz, nx, ny, nz, u, v, false), true)
DEFINE_AIMS(near_disk, zt_disk_way(&l, px, py, pz, nx, ny, nz, u, v, true), true)
DEFINE_AIMS(rectangle, zt_rectangle_way(&l, px, py, pz, nx, ny, nz, u, v), true)

/* Whether some point is near to a disk. */
static bool any_is_near(const task *task) {
    const zt_origins *restrict from = task->shadow->from;
    const zt_lamp *lamp = task->lamp;
    int32_t any = 0;
    for (int k = 0; k < task->points->count; k++) {
        zt_lamp_pose l = *lamp->poses;
        if (lamp->moves)
            l = pose_between(lamp->poses + from->moment[k], from->between[k], true);
        zt_front f = zt_front_of(&l, from->x[k], from->y[k], from->z[k]);
        any |= zt_disk_is_near(&l, &f);
    }
    return any;
}

void ZT_KERNEL_NAME(zt_lamp_aim)(zt_lamp_light *light, zt_batch *shadow, const zt_lamp *lamp,
                                 const zt_points *points, const zt_rays *given,
                                 uint32_t dimension, bool straight) {
    static aim *const *const aims[] = {[ZT_LAMP_POINT] = point_aims,
                                       [ZT_LAMP_BALL] = ball_aims,
                                       [ZT_LAMP_DISK] = disk_aims,
                                       [ZT_LAMP_RECTANGLE] = rectangle_aims};
    places at;
    task task = {light, shadow, lamp, points, &at};
    if (lamp->has_size)
        take_places(&at, points, given, dimension);
    else
        memset(&at, 0, sizeof at);
    bool near = lamp->kind == ZT_LAMP_DISK && any_is_near(&task);
    (near ? near_disk_aims : aims[lamp->kind])[!lamp->moves ? 0 : straight ? 1 : 2](&task);
}
