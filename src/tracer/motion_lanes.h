/* The poses of what moves at the times of many rays, as structures of arrays that loops can
 * take many lanes at a time of. */
#ifndef ZT_TRACER_MOTION_LANES_H
#define ZT_TRACER_MOTION_LANES_H

#include "tracer/isa.h"
#include "tracer/motion.h"

/* So many rays at a time, that their poses stay near. */
enum { ZT_POSE_LANES = 64 };

typedef struct zt_poses {
    alignas(64) real of[ZT_POSE_NUMBERS][ZT_POSE_LANES];
} zt_poses;

/* Those of one primitive for the rays first .. first + count - 1. `straight`: there are two
 * moments only, so that nothing has to be looked up. */
static inline void zt_load_poses(zt_poses *restrict out, const real *restrict table, int size,
                                 bool straight, const zt_origins *restrict from, int first,
                                 int count) {
    const real *restrict between = from->between + first;
    const int32_t *restrict moment = from->moment + first;
    for (int n = 0; n < size; n++) {
        const real begin = table[n], change = table[size + n];
        real *restrict of = out->of[n];
        if (straight)
            WIDE_LOOP for (int j = 0; j < count; j++) of[j] = begin + between[j] * change;
        else
            WIDE_LOOP for (int j = 0; j < count; j++) {
                int32_t at = moment[j] * (2 * size) + n;
                of[j] = table[at] + between[j] * table[at + size];
            }
    }
}

/* A solid at one time: as it stands in a zt_primitive. `good` is 0 where it is flattened or has
 * no size, so that there is nothing to hit. */
typedef struct zt_solid_pose {
    real3 x, y, z; /* rows */
    real3 center;
    real a, b;
    int32_t good;
} zt_solid_pose;

static inline real3 zt_cross(real3 a, real3 b) {
    return (real3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline real3 zt_times(real3 v, real s) { return (real3){v.x * s, v.y * s, v.z * s}; }

/* The pose of lane j of a solid of a kind, which is known where this is compiled. */
static inline zt_solid_pose zt_solid_at(const zt_poses *restrict s, int j, real unit,
                                        zt_primitive_kind kind) {
    real3 x = {s->of[0][j], s->of[1][j], s->of[2][j]};
    real3 y = {s->of[3][j], s->of[4][j], s->of[5][j]};
    real3 z = {s->of[6][j], s->of[7][j], s->of[8][j]};
    zt_solid_pose pose;
    pose.center = (real3){s->of[9][j], s->of[10][j], s->of[11][j]};
    pose.a = pose.b = 1;
    real wide = 1;
    if (zt_pose_size(kind) == ZT_POSE_NUMBERS) {
        bool cone = kind == ZT_PRIMITIVE_CONE;
        real p = s->of[12][j], q = s->of[13][j];
        wide = cone ? real_max(p, q) : q;
        x = zt_times(x, wide);
        y = zt_times(y, wide);
        z = cone ? z : zt_times(z, wide);
        pose.a = kind == ZT_PRIMITIVE_TORUS ? real_min(p / wide, 1) : p / wide;
        pose.b = q / wide;
    }
    pose.x = zt_cross(y, z);
    pose.y = zt_cross(z, x);
    pose.z = zt_cross(x, y);
    real scale = unit / real_dot(x.x, x.y, x.z, pose.x.x, pose.x.y, pose.x.z);
    pose.x = zt_times(pose.x, scale);
    pose.y = zt_times(pose.y, scale);
    pose.z = zt_times(pose.z, scale);
    pose.good = (wide > 0) & (real_abs(scale) < REAL_INFINITY);
    return pose;
}

#endif
