/* Surfaces and looks of what moves. Compiled once for each width of instructions and each
 * precision (tracer/isa.h). */
#include "tracer/motion_points.h"

#include <math.h>
#include <string.h>

#include "tracer/motion_lanes.h"
#include "tracer/points_solids.h"

/* ---- surfaces -------------------------------------------------------------------------------
 */

/* Points that lie on primitives of one kind: their numbers, and the poses there. */
typedef struct moving_points {
    int32_t list[ZT_POSE_LANES];
    alignas(64) real unit[ZT_POSE_LANES];
    zt_poses poses;
    int count;
} moving_points;

static void add_point(moving_points *m, const zt_primitive *p, const zt_origins *from, int k) {
    const int size = zt_pose_size(p->kind), j = m->count++;
    const real *begin = p->poses + (size_t)from->moment[k] * (size_t)(2 * size);
    m->list[j] = k;
    m->unit[j] = p->unit;
    for (int n = 0; n < size; n++)
        m->poses.of[n][j] = begin[n] + from->between[k] * begin[size + n];
}

/* A point p goes onto the surface by n . (p - center) - level along the unit normal n. */
static inline void settle(zt_points *restrict w, zt_origins *restrict from, int k, real3 n,
                          real3 center, real level) {
    real unit = 1 / real_sqrt(real_max(real_dot(n.x, n.y, n.z, n.x, n.y, n.z), REAL_LEAST));
    real nx = n.x * unit, ny = n.y * unit, nz = n.z * unit;
    real qx = from->x[k] - center.x, qy = from->y[k] - center.y, qz = from->z[k] - center.z;
    real off = real_dot(nx, ny, nz, qx, qy, qz) - level * unit;
    from->x[k] -= off * nx;
    from->y[k] -= off * ny;
    from->z[k] -= off * nz;
    w->nx[k] = nx;
    w->ny[k] = ny;
    w->nz[k] = nz;
}

#define POINT(n) ((real3){s->of[n][j], s->of[n + 1][j], s->of[n + 2][j]})

static void plane_surfaces(zt_points *restrict w, zt_origins *restrict from,
                           const moving_points *restrict m) {
    const zt_poses *restrict s = &m->poses;
    WIDE_LOOP for (int j = 0; j < m->count; j++)
        settle(w, from, m->list[j], POINT(0), (real3){0, 0, 0}, s->of[3][j]);
}

static void sphere_surfaces(zt_points *restrict w, zt_origins *restrict from,
                            const moving_points *restrict m) {
    const zt_poses *restrict s = &m->poses;
    WIDE_LOOP for (int j = 0; j < m->count; j++) {
        int32_t k = m->list[j];
        real3 c = POINT(0);
        real nx = from->x[k] - c.x, ny = from->y[k] - c.y, nz = from->z[k] - c.z;
        real unit = 1 / real_sqrt(real_max(real_dot(nx, ny, nz, nx, ny, nz), REAL_LEAST));
        settle(w, from, k, (real3){nx * unit, ny * unit, nz * unit}, c, s->of[3][j]);
    }
}

static void triangle_surfaces(zt_points *restrict w, zt_origins *restrict from,
                              const moving_points *restrict m) {
    const zt_poses *restrict s = &m->poses;
    WIDE_LOOP for (int j = 0; j < m->count; j++) {
        real3 a = POINT(0), b = POINT(3), c = POINT(6);
        real ex = b.x - a.x, ey = b.y - a.y, ez = b.z - a.z;
        real fx = c.x - a.x, fy = c.y - a.y, fz = c.z - a.z;
        double nx = real_products(ey, fz, ez, fy), ny = real_products(ez, fx, ex, fz),
               nz = real_products(ex, fy, ey, fx);
        double unit = 1 / sqrt(nx * nx + ny * ny + nz * nz);
        real3 n = {(real)(nx * unit), (real)(ny * unit), (real)(nz * unit)};
        settle(w, from, m->list[j], n, a, 0);
    }
}

/* As for solids that stand still (tracer/points.c). */
#define DEFINE_SOLID(kind, KIND)                                                               \
    static void kind##_surfaces(zt_points *restrict w, zt_origins *restrict from,              \
                                const moving_points *restrict m) {                             \
        WIDE_LOOP for (int j = 0; j < m->count; j++) {                                         \
            zt_solid_pose p = zt_solid_at(&m->poses, j, m->unit[j], KIND);                     \
            zt_find_##kind(w, from, m->list[j], p.x, p.y, p.z, p.center, p.a, p.b);            \
        }                                                                                      \
    }
DEFINE_SOLID(ball, ZT_PRIMITIVE_BALL)
DEFINE_SOLID(disk, ZT_PRIMITIVE_DISK)
DEFINE_SOLID(box, ZT_PRIMITIVE_BOX)
DEFINE_SOLID(cylinder, ZT_PRIMITIVE_CYLINDER)
DEFINE_SOLID(cone, ZT_PRIMITIVE_CONE)
DEFINE_SOLID(capsule, ZT_PRIMITIVE_CAPSULE)
DEFINE_SOLID(torus, ZT_PRIMITIVE_TORUS)

typedef void surfaces(zt_points *restrict w, zt_origins *restrict from,
                      const moving_points *restrict m);
static surfaces *const kinds[ZT_PRIMITIVE_KIND_COUNT] = {
    [ZT_PRIMITIVE_PLANE] = plane_surfaces,       [ZT_PRIMITIVE_SPHERE] = sphere_surfaces,
    [ZT_PRIMITIVE_TRIANGLE] = triangle_surfaces, [ZT_PRIMITIVE_BALL] = ball_surfaces,
    [ZT_PRIMITIVE_DISK] = disk_surfaces,         [ZT_PRIMITIVE_BOX] = box_surfaces,
    [ZT_PRIMITIVE_CYLINDER] = cylinder_surfaces, [ZT_PRIMITIVE_CONE] = cone_surfaces,
    [ZT_PRIMITIVE_CAPSULE] = capsule_surfaces,   [ZT_PRIMITIVE_TORUS] = torus_surfaces};

static void find_kind(zt_points *w, zt_origins *from, const zt_tracer *tracer,
                      zt_primitive_kind kind) {
    moving_points m;
    m.count = 0;
    for (int k = 0; k < w->count; k++) {
        const zt_primitive *p = &tracer->primitives[w->primitive[k]];
        if (p->kind == kind && p->poses) add_point(&m, p, from, k);
        if (m.count < ZT_POSE_LANES && (m.count == 0 || k + 1 < w->count)) continue;
        kinds[kind](w, from, &m);
        m.count = 0;
    }
}

void ZT_KERNEL_NAME(zt_find_moving)(zt_points *w, zt_origins *from, const zt_tracer *tracer) {
    uint32_t there = 0;
    for (int k = 0; k < w->count; k++) {
        const zt_primitive *p = &tracer->primitives[w->primitive[k]];
        there |= p->poses ? 1u << p->kind : 0;
    }
    for (; there; there &= there - 1)
        find_kind(w, from, tracer, (zt_primitive_kind)__builtin_ctz(there));
}

/* ---- looks ----------------------------------------------------------------------------------
 */

enum { LOOKS_NUMBERS = sizeof(zt_looks) / sizeof(double) };

static zt_looks looks_at(const zt_looks *looks, int32_t moment, double between) {
    double numbers[LOOKS_NUMBERS], next[LOOKS_NUMBERS];
    zt_looks at;
    memcpy(numbers, &looks[moment], sizeof numbers);
    memcpy(next, &looks[moment + 1], sizeof next);
    for (int n = 0; n < LOOKS_NUMBERS; n++) numbers[n] += between * (next[n] - numbers[n]);
    memcpy(&at, numbers, sizeof at);
    return at;
}

/* A place a little below the surface decides, as for patterns that stay (tracer/points.c). */
#define BELOW 0x1p-10

/* Whether a point is in a cell of the other color. */
static bool in_other(const zt_looks *now, zt_pattern pattern, vec3 p, vec3 n) {
    xform back = xform_inverse(&now->place);
    double cells = 1 / now->size, at[3], in[3];
    for (int i = 0; i < 3; i++) {
        vec3 row = zt_xform_row(&back, i);
        at[i] = vec3_dot(row, vec3_sub(p, now->place.shift)) * cells;
        in[i] = vec3_dot(row, n) * cells;
    }
    if (pattern == ZT_PATTERN_STRIPES) {
        vec3 across = now->across;
        at[0] = at[0] * across.x + at[1] * across.y + at[2] * across.z;
        in[0] = in[0] * across.x + in[1] * across.y + in[2] * across.z;
        at[1] = at[2] = in[1] = in[2] = 0;
    }
    double below = BELOW / sqrt(in[0] * in[0] + in[1] * in[1] + in[2] * in[2]), sum = 0;
    for (int i = 0; i < 3; i++) sum += floor(at[i] - below * in[i]);
    return sum - 2 * floor(sum / 2) != 0;
}

void ZT_KERNEL_NAME(zt_change_colors)(zt_points *w, const zt_origins *from,
                                      const zt_tracer *tracer) {
    for (int k = 0; k < w->count; k++) {
        const zt_change *change = &tracer->changes[w->primitive[k]];
        if (!change->looks) continue;
        zt_looks now = looks_at(change->looks, from->moment[k], (double)from->between[k]);
        w->color_r[k] = (real)now.color.x;
        w->color_g[k] = (real)now.color.y;
        w->color_b[k] = (real)now.color.z;
        w->reflectivity[k] = (real)now.reflectivity;
    }
}

void ZT_KERNEL_NAME(zt_change_patterns)(zt_points *w, const zt_origins *from,
                                        const zt_tracer *tracer) {
    for (int k = 0; k < w->count; k++) {
        const zt_change *change = &tracer->changes[w->primitive[k]];
        if (!change->looks || change->pattern == ZT_PATTERN_NONE) continue;
        zt_looks now = looks_at(change->looks, from->moment[k], (double)from->between[k]);
        vec3 p = {(double)from->x[k], (double)from->y[k], (double)from->z[k]};
        vec3 n = {(double)w->nx[k], (double)w->ny[k], (double)w->nz[k]};
        w->cell[k] = in_other(&now, change->pattern, p, n);
        if (!w->cell[k]) continue;
        w->color_r[k] = (real)now.other_color.x;
        w->color_g[k] = (real)now.other_color.y;
        w->color_b[k] = (real)now.other_color.z;
    }
}
