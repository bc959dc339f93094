/* The points where rays end. Loops run over whole groups of lanes: what lies beyond the count
 * is computed and never used, but must be safe to compute. Compiled once for each width of
 * instructions and each precision (tracer/isa.h). */
#include "tracer/points.h"

#include <math.h>

#include "tracer/bundle.h"
#include "tracer/motion_points.h"
#include "tracer/points_meshes.h"
#include "tracer/points_solids.h"

/* How far off a surface rays begin that go on from it, against the roundings of surfaces that
 * lie on it, as a thing lies on a floor: a few roundings of a position on each side. Its own
 * surface is left out exactly (zt_origins.source), but for a mesh's, where more is to be left
 * (tracer/points_meshes.c). */
#define MARGIN_ROUNDINGS 8

/* ---- surfaces -------------------------------------------------------------------------------
 */

static void go_to_ends(zt_points *restrict w, const zt_batch *restrict rays,
                       zt_origins *restrict from) {
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        real t = rays->t[k];
        int32_t hit = rays->hit[k];
        w->primitive[k] = hit > 0 ? hit : 0;
        from->x[k] += t * rays->dx[k];
        from->y[k] += t * rays->dy[k];
        from->z[k] += t * rays->dz[k];
    }
}

/* The looks of point k, if it is on that surface; the normal, and the corrected position, where
 * its kind is one of which a zt_surface says all. A row of zeros leaves the position as it is.
 * Normals of what is not bent are unit as they are: `unbent` says that before the loop, and
 * changes nothing. */
static inline void find_surface(zt_points *restrict w, zt_origins *restrict from, int k,
                                const zt_surface *s, bool unbent, bool on) {
    real qx = from->x[k] - s->center.x, qy = from->y[k] - s->center.y,
         qz = from->z[k] - s->center.z;
    real nx = s->normal.x, ny = s->normal.y, nz = s->normal.z;
    if (!unbent) {
        nx += s->bend * qx;
        ny += s->bend * qy;
        nz += s->bend * qz;
        real length = real_sqrt(real_max(real_dot(nx, ny, nz, nx, ny, nz), REAL_LEAST));
        real unit = s->bend == 0 ? 1 : 1 / length;
        nx *= unit;
        ny *= unit;
        nz *= unit;
    }
    real off = real_dot(nx, ny, nz, qx, qy, qz) - s->level;
    from->x[k] = on ? from->x[k] - off * nx : from->x[k];
    from->y[k] = on ? from->y[k] - off * ny : from->y[k];
    from->z[k] = on ? from->z[k] - off * nz : from->z[k];
    from->near[k] = 0;
    w->nx[k] = on ? nx : w->nx[k];
    w->ny[k] = on ? ny : w->ny[k];
    w->nz[k] = on ? nz : w->nz[k];
    w->color_r[k] = on ? s->color.x : w->color_r[k];
    w->color_g[k] = on ? s->color.y : w->color_g[k];
    w->color_b[k] = on ? s->color.z : w->color_b[k];
    w->reflectivity[k] = on ? s->reflectivity : w->reflectivity[k];
    w->closed[k] = on ? s->closed : w->closed[k];
}

/* So few things are asked one by one; of more than so many, which each point is on. */
enum { FEW_SURFACES = 6 };

/* Lists the primitives that points lie on, in order; returns how many they are, or one more
 * than FEW_SURFACES. */
static int list_primitives(int32_t *list, const zt_points *restrict w) {
    uint32_t begin = 0;
    for (int count = 0; count <= FEW_SURFACES; count++) {
        uint32_t least = UINT32_MAX; /* from there on; those before are beyond all others */
        for (int k = 0; k < w->count; k++) {
            uint32_t off = (uint32_t)w->primitive[k] - begin;
            least = off < least ? off : least;
        }
        if (least > INT32_MAX) return count;
        begin += least;
        list[count] = (int32_t)begin++;
    }
    return FEW_SURFACES + 1;
}

/* Those of the points that lie on one primitive. */
static void find_surfaces_on(zt_points *restrict w, zt_origins *restrict from,
                             const zt_surface *surface, int32_t index) {
    const zt_surface s = *surface;
    int padded = zt_batch_padded(w->count);
    if (s.bend == 0)
        WIDE_LOOP for (int k = 0; k < padded; k++)
            find_surface(w, from, k, &s, true, w->primitive[k] == index);
    else
        WIDE_LOOP for (int k = 0; k < padded; k++)
            find_surface(w, from, k, &s, false, w->primitive[k] == index);
}

/* All points; where they lie on few primitives, as most of a tile's do, nothing is gathered. */
static void find_surfaces(zt_points *restrict w, zt_origins *restrict from,
                          const zt_tracer *tracer) {
    int32_t list[FEW_SURFACES + 1];
    int padded = zt_batch_padded(w->count), count = list_primitives(list, w);
    w->source = count == 1 ? list[0] : -1;
    for (int i = 0; i < count && count <= FEW_SURFACES; i++)
        find_surfaces_on(w, from, &tracer->surfaces[list[i]], list[i]);
    if (count > FEW_SURFACES)
        WIDE_LOOP for (int k = 0; k < padded; k++)
            find_surface(w, from, k, &tracer->surfaces[w->primitive[k]], false, true);
}

/* A bit for each kind of primitive that points lie on, if it stands still. */
static uint32_t kinds_of(const zt_points *restrict w, const zt_tracer *tracer) {
    uint32_t kinds = 0;
    for (int k = 0; k < w->count; k++) {
        const zt_primitive *p = &tracer->primitives[w->primitive[k]];
        kinds |= (uint32_t)!p->poses << p->kind;
    }
    return kinds;
}

/* Lists the points that lie on primitives of a kind that stand still. */
static int list_kind(int32_t *restrict list, const zt_points *restrict w,
                     const zt_tracer *tracer, zt_primitive_kind kind) {
    int count = 0;
    for (int k = 0; k < w->count; k++) {
        list[count] = k;
        const zt_primitive *p = &tracer->primitives[w->primitive[k]];
        count += (p->kind == kind) & !p->poses;
    }
    return count;
}

/* Lists the points that lie on meshes. */
static int list_meshes(int32_t *restrict list, const zt_points *restrict w) {
    int32_t any = 0, count = 0;
    for (int k = 0; k < w->count; k++) any |= w->closed[k];
    for (int k = 0; any < 0 && k < w->count; k++) {
        list[count] = k;
        count += w->closed[k] < 0;
    }
    return count;
}

#define DEFINE_SOLID(kind)                                                                     \
    static void kind##_surfaces(zt_points *restrict w, zt_origins *restrict from,              \
                                const zt_tracer *tracer, const int32_t *restrict list,         \
                                int count) {                                                   \
        WIDE_LOOP for (int j = 0; j < count; j++) {                                            \
            int32_t k = list[j];                                                               \
            const zt_primitive *p = &tracer->primitives[w->primitive[k]];                      \
            zt_find_##kind(w, from, k, p->solid.rows[0], p->solid.rows[1], p->solid.rows[2],   \
                           p->solid.center, p->solid.a, p->solid.b);                           \
        }                                                                                      \
    }
DEFINE_SOLID(ball)
DEFINE_SOLID(disk)
DEFINE_SOLID(box)
DEFINE_SOLID(cylinder)
DEFINE_SOLID(cone)
DEFINE_SOLID(capsule)
DEFINE_SOLID(torus)

typedef void solid_surfaces(zt_points *restrict w, zt_origins *restrict from,
                            const zt_tracer *tracer, const int32_t *restrict list, int count);
static solid_surfaces *const solids[ZT_PRIMITIVE_KIND_COUNT] = {
    [ZT_PRIMITIVE_BALL] = ball_surfaces,  [ZT_PRIMITIVE_DISK] = disk_surfaces,
    [ZT_PRIMITIVE_BOX] = box_surfaces,    [ZT_PRIMITIVE_CYLINDER] = cylinder_surfaces,
    [ZT_PRIMITIVE_CONE] = cone_surfaces,  [ZT_PRIMITIVE_CAPSULE] = capsule_surfaces,
    [ZT_PRIMITIVE_TORUS] = torus_surfaces};

/* ---- looks ----------------------------------------------------------------------------------
 */

static inline real whole(real x) {
    return sizeof(real) == sizeof(double) ? (real)floor((double)x) : (real)floorf((float)x);
}

/* A place a little below the surface decides which cell a point is in, so that a face along the
 * border of two cells is in one of them. */
#define BELOW ((real)0x1p-10)

static void weave(zt_points *restrict w, const zt_origins *restrict from,
                  const zt_tracer *tracer) {
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        int32_t index = tracer->surfaces[w->primitive[k]].pattern;
        const zt_weave *v = &tracer->weaves[index > 0 ? index : 0];
        real px = from->x[k], py = from->y[k], pz = from->z[k];
        real nx = w->nx[k], ny = w->ny[k], nz = w->nz[k];
        real3 rx = v->rows[0], ry = v->rows[1], rz = v->rows[2];
        real mx = real_dot(rx.x, rx.y, rx.z, nx, ny, nz),
             my = real_dot(ry.x, ry.y, ry.z, nx, ny, nz),
             mz = real_dot(rz.x, rz.y, rz.z, nx, ny, nz);
        real below = BELOW / real_sqrt(real_max(real_dot(mx, my, mz, mx, my, mz), REAL_LEAST));
        real sum = whole(real_dot(rx.x, rx.y, rx.z, px, py, pz) + v->at.x - below * mx) +
                   whole(real_dot(ry.x, ry.y, ry.z, px, py, pz) + v->at.y - below * my) +
                   whole(real_dot(rz.x, rz.y, rz.z, px, py, pz) + v->at.z - below * mz);
        bool odd = sum - 2 * whole(sum / 2) != 0;
        bool other = (index >= 0) & odd;
        w->cell[k] = other;
        w->color_r[k] = other ? v->other.x : w->color_r[k];
        w->color_g[k] = other ? v->other.y : w->color_g[k];
        w->color_b[k] = other ? v->other.z : w->color_b[k];
    }
}

/* Turns the normals to the side that the rays came from. */
static void face_rays(zt_points *restrict w, const zt_batch *restrict rays,
                      zt_origins *restrict from) {
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        real nx = w->nx[k], ny = w->ny[k], nz = w->nz[k];
        bool away = real_dot(nx, ny, nz, rays->dx[k], rays->dy[k], rays->dz[k]) > 0;
        w->nx[k] = away ? -nx : nx;
        w->ny[k] = away ? -ny : ny;
        w->nz[k] = away ? -nz : nz;
        int32_t inside = away & (w->closed[k] > 0);
        from->source[k] = w->closed[k] < 0 ? -1 : 2 * w->primitive[k] + inside;
    }
}

/* Makes the points what further rays begin at. */
static void leave_surfaces(zt_points *restrict w, zt_origins *restrict from) {
    int padded = zt_batch_padded(w->count);
    WIDE_LOOP for (int k = 0; k < padded; k++) {
        real px = from->x[k], py = from->y[k], pz = from->z[k];
        real largest = real_max(real_max(real_abs(px), real_abs(py)), real_abs(pz));
        real margin = (largest + from->near[k]) * (MARGIN_ROUNDINGS * REAL_ROUNDING);
        from->x[k] = px + margin * w->nx[k];
        from->y[k] = py + margin * w->ny[k];
        from->z[k] = pz + margin * w->nz[k];
        from->near[k] = largest * TIE;
    }
}

/* ---- the short way --------------------------------------------------------------------------
 */

/* The flat thing without a pattern that all rays hit from one side; or NULL. */
static const zt_surface *find_flat(bool *away, const zt_batch *restrict rays,
                                   const zt_tracer *tracer) {
    const int32_t first = rays->hit[0];
    const zt_primitive_kind kind = tracer->primitives[first].kind;
    const zt_surface *s = &tracer->surfaces[first];
    if (kind != ZT_PRIMITIVE_PLANE && kind != ZT_PRIMITIVE_TRIANGLE) return NULL;
    if (tracer->everything || tracer->moves || tracer->changes || s->pattern >= 0) return NULL;
    const real3 n = s->normal;
    int32_t others = 0, any = 0, all = 1;
    WIDE_LOOP for (int k = 0; k < zt_batch_padded(rays->count); k++) {
        int32_t leaves = real_dot(n.x, n.y, n.z, rays->dx[k], rays->dy[k], rays->dz[k]) > 0;
        others |= rays->hit[k] ^ first;
        any |= leaves;
        all &= leaves;
    }
    *away = any;
    return others || any != all ? NULL : s;
}

/* All of zt_points_find in one go: number by number the same. */
static void find_flat_points(zt_points *restrict w, const zt_batch *restrict rays,
                             zt_origins *restrict from, const zt_surface *only, bool away) {
    const zt_surface s = *only;
    const real3 n = s.normal, c = s.center;
    const int32_t first = rays->hit[0];
    w->flat = true;
    w->normal = away ? (real3){-n.x, -n.y, -n.z} : n;
    w->color = s.color;
    w->reflects = s.reflectivity;
    w->source = first;
    const real3 facing = w->normal;
    zt_ranging x = ZT_RANGING, y = ZT_RANGING, z = ZT_RANGING;
    WIDE_LOOP for (int k = 0; k < zt_batch_padded(w->count); k++) {
        real t = rays->t[k];
        real px = from->x[k] + t * rays->dx[k], py = from->y[k] + t * rays->dy[k],
             pz = from->z[k] + t * rays->dz[k];
        real off = real_dot(n.x, n.y, n.z, px - c.x, py - c.y, pz - c.z) - s.level;
        px -= off * n.x;
        py -= off * n.y;
        pz -= off * n.z;
        real largest = real_max(real_max(real_abs(px), real_abs(py)), real_abs(pz));
        real margin = largest * (MARGIN_ROUNDINGS * REAL_ROUNDING);
        px += margin * facing.x;
        py += margin * facing.y;
        pz += margin * facing.z;
        from->x[k] = px;
        from->y[k] = py;
        from->z[k] = pz;
        from->near[k] = largest * TIE;
        from->source[k] = 2 * first;
        zt_range_add(&x, px);
        zt_range_add(&y, py);
        zt_range_add(&z, pz);
    }
    w->places = zt_ranges_end(&x, &y, &z);
}

void ZT_KERNEL_NAME(zt_points_spread)(zt_points *restrict w) {
    if (!w->flat) return;
    const real3 normal = w->normal, color = w->color;
    const real reflects = w->reflects;
    const int32_t primitive = w->source;
    WIDE_LOOP for (int k = 0; k < zt_batch_padded(w->count); k++) {
        w->primitive[k] = primitive;
        w->nx[k] = normal.x;
        w->ny[k] = normal.y;
        w->nz[k] = normal.z;
        w->color_r[k] = color.x;
        w->color_g[k] = color.y;
        w->color_b[k] = color.z;
        w->reflectivity[k] = reflects;
    }
}

void ZT_KERNEL_NAME(zt_points_find)(zt_points *w, zt_batch *rays, const zt_tracer *tracer) {
    zt_origins *from = rays->from;
    int32_t list[ZT_BATCH];
    bool away;
    w->count = rays->count;
    const zt_surface *only = find_flat(&away, rays, tracer);
    if (only) {
        find_flat_points(w, rays, from, only, away);
        return;
    }
    w->flat = false;
    go_to_ends(w, rays, from);
    find_surfaces(w, from, tracer);
    if (tracer->changes) ZT_KERNEL_NAME(zt_change_colors)(w, from, tracer);
    if (tracer->moves) ZT_KERNEL_NAME(zt_find_moving)(w, from, tracer);
    int mesh_count = 0;
    uint32_t kinds = tracer->has_solids ? kinds_of(w, tracer) : 0;
    for (zt_primitive_kind kind = ZT_PRIMITIVE_BALL; kind < ZT_PRIMITIVE_KIND_COUNT; kind++)
        if (kinds >> kind & 1)
            solids[kind](w, from, tracer, list, list_kind(list, w, tracer, kind));
    if (tracer->placed_count > 0) mesh_count = list_meshes(list, w);
    if (mesh_count > 0) ZT_KERNEL_NAME(zt_find_on_meshes)(w, rays, tracer, list, mesh_count);
    if (tracer->has_patterns) weave(w, from, tracer);
    if (tracer->changes) ZT_KERNEL_NAME(zt_change_patterns)(w, from, tracer);
    face_rays(w, rays, from);
    leave_surfaces(w, from);
    if (mesh_count > 0) ZT_KERNEL_NAME(zt_smooth_on_meshes)(w, rays, tracer, list, mesh_count);
    /* Where rays leave a closed thing's inside they meet it again. */
    int32_t inside = 0;
    for (int k = 0; k < w->count; k++) inside |= from->source[k] & 1;
    if (inside) w->source = -1;
    w->places = zt_range3(from->x, from->y, from->z, w->count);
}
