/* The points where rays end. Loops run over whole groups of lanes: what lies beyond the count
 * is computed and never used, but must be safe to compute. Compiled once for each width of
 * instructions and each precision (tracer/isa.h). */
#include "tracer/points.h"

#include <math.h>

#include "tracer/motion_points.h"
#include "tracer/points_solids.h"

/* How far off a surface rays begin that go on from it, against the roundings of surfaces that
 * lie on it, as a thing lies on a floor: a few roundings of a position on each side. Its own
 * surface is left out exactly (zt_origins.source), but for a mesh's: there, the numbers in the
 * mesh's own space are rounded as well, in its intersection and in the next ray's. */
#define MARGIN_ROUNDINGS 8
#define MESH_MARGIN      4

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

/* The looks of point k; the normal, and the corrected position, where its kind is one of which
 * a zt_surface says all. A row of zeros leaves the position as it is. Normals of what is not
 * bent are unit as they are: `flat` says that before the loop, and changes nothing. */
static inline void find_surface(zt_points *restrict w, zt_origins *restrict from, int k,
                                const zt_surface *s, bool flat) {
    real qx = from->x[k] - s->center.x, qy = from->y[k] - s->center.y,
         qz = from->z[k] - s->center.z;
    real nx = s->normal.x, ny = s->normal.y, nz = s->normal.z;
    if (!flat) {
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
    from->x[k] -= off * nx;
    from->y[k] -= off * ny;
    from->z[k] -= off * nz;
    from->near[k] = 0;
    w->nx[k] = nx;
    w->ny[k] = ny;
    w->nz[k] = nz;
    w->color_r[k] = s->color.x;
    w->color_g[k] = s->color.y;
    w->color_b[k] = s->color.z;
    w->reflectivity[k] = s->reflectivity;
    w->closed[k] = s->closed;
}

/* All points; where they lie on one primitive, as most of a tile's do, nothing is gathered. */
static void find_surfaces(zt_points *restrict w, zt_origins *restrict from,
                          const zt_tracer *tracer) {
    int32_t first = w->primitive[0], others = 0;
    int padded = zt_batch_padded(w->count);
    for (int k = 0; k < w->count; k++) others |= w->primitive[k] ^ first;
    w->source = others ? -1 : first;
    if (others) {
        WIDE_LOOP for (int k = 0; k < padded; k++)
            find_surface(w, from, k, &tracer->surfaces[w->primitive[k]], false);
        return;
    }
    const zt_surface only = tracer->surfaces[first];
    if (only.bend == 0)
        WIDE_LOOP for (int k = 0; k < padded; k++) find_surface(w, from, k, &only, true);
    else
        WIDE_LOOP for (int k = 0; k < padded; k++) find_surface(w, from, k, &only, false);
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

/* ---- meshes ---------------------------------------------------------------------------------
 */

static vec3 corner(const float *values, const uint32_t *of, int i) {
    const float *v = values + 3 * (int64_t)of[i];
    return (vec3){(double)v[0], (double)v[1], (double)v[2]};
}

/* Takes a gradient or normal of the mesh's space to the space relative to the camera. */
static vec3 out_of_mesh(const zt_placed_mesh *m, vec3 n) {
    return vec3_add(vec3_add(vec3_scale(m->rows[0], n.x), vec3_scale(m->rows[1], n.y)),
                    vec3_scale(m->rows[2], n.z));
}

static vec3 unit(vec3 v) { return vec3_scale(v, 1 / sqrt(vec3_dot(v, v))); }

/* A point on a triangle of a mesh, in the mesh's space: the corners, and twice the area as a
 * vector. */
typedef struct mesh_point {
    const zt_placed_mesh *placed;
    zt_placed_mesh now; /* room for it */
    const uint32_t *of;
    vec3 at, v[3], area;
} mesh_point;

/* The mesh that point k is on, as it is at the ray's time; `now` is room for one that moves. */
static const zt_placed_mesh *placed_at(zt_placed_mesh *now, const zt_points *w,
                                       const zt_origins *from, const zt_tracer *tracer, int k) {
    const zt_placed_mesh *m = &tracer->placed[tracer->primitives[w->primitive[k]].placed];
    if (!m->places) return m;
    *now = zt_placed_at(m, from->moment[k], (double)from->between[k]);
    return now;
}

static void find_mesh_point(mesh_point *p, const zt_points *w, const zt_batch *rays,
                            const zt_tracer *tracer, int k) {
    const zt_origins *from = rays->from;
    p->placed = placed_at(&p->now, w, from, tracer, k);
    const zt_mesh *mesh = p->placed->built->mesh;
    p->of = mesh->triangles + 3 * (int64_t)rays->part[k];
    p->at = zt_placed_point(p->placed,
                            (vec3){(double)from->x[k], (double)from->y[k], (double)from->z[k]});
    for (int i = 0; i < 3; i++) p->v[i] = corner(mesh->positions, p->of, i);
    p->area = vec3_cross(vec3_sub(p->v[1], p->v[0]), vec3_sub(p->v[2], p->v[0]));
}

/* The shares that the corners have in a point. */
static void share(double *shares, const mesh_point *p) {
    vec3 e = vec3_sub(p->v[1], p->v[0]), f = vec3_sub(p->v[2], p->v[0]),
         q = vec3_sub(p->at, p->v[0]);
    double whole = 1 / vec3_dot(p->area, p->area);
    shares[1] = fmin(fmax(vec3_dot(vec3_cross(q, f), p->area) * whole, 0), 1);
    shares[2] = fmin(fmax(vec3_dot(vec3_cross(e, q), p->area) * whole, 0), 1 - shares[1]);
    shares[0] = 1 - shares[1] - shares[2];
}

static void color_mesh(zt_points *w, const zt_batch *rays, const zt_tracer *tracer, int k) {
    double shares[3], color[3] = {0, 0, 0};
    mesh_point p;
    find_mesh_point(&p, w, rays, tracer, k);
    share(shares, &p);
    for (int i = 0; i < 3; i++) {
        const float *c = p.placed->built->mesh->colors + 3 * (int64_t)p.of[i];
        for (int channel = 0; channel < 3; channel++)
            color[channel] += shares[i] * (double)c[channel];
    }
    w->color_r[k] *= (real)color[0];
    w->color_g[k] *= (real)color[1];
    w->color_b[k] *= (real)color[2];
}

/* The corners of triangles of a mesh, as their numbers stand. */
typedef struct facets {
    alignas(64) float v[3][3][ZT_BATCH]; /* by corner and axis */
} facets;

static void load_facets(facets *f, const zt_mesh *mesh, const int32_t *part, int count,
                        const int32_t *list) {
    for (int j = 0; j < count; j++) {
        const uint32_t *of = mesh->triangles + 3 * (int64_t)part[list[j]];
        for (int i = 0; i < 3; i++) {
            const float *p = mesh->positions + 3 * (int64_t)of[i];
            for (int axis = 0; axis < 3; axis++) f->v[i][axis][j] = p[axis];
        }
    }
}

/* Listed points on one mesh: the normal, and the position corrected along it, in double
 * precision. With the plane n . (q - v0) = 0 of the mesh's space, q = M p + a, the gradient for
 * p is M^T n. */
static void find_facets(zt_points *restrict w, zt_origins *restrict from,
                        const facets *restrict f, const zt_placed_mesh *m,
                        const int32_t *restrict list, int count) {
    const vec3 rx = m->rows[0], ry = m->rows[1], rz = m->rows[2], at = m->at;
    const real extent = m->extent;
    WIDE_LOOP for (int j = 0; j < count; j++) {
        int32_t k = list[j];
        double px = (double)from->x[k], py = (double)from->y[k], pz = (double)from->z[k];
        double vx = (double)f->v[0][0][j], vy = (double)f->v[0][1][j],
               vz = (double)f->v[0][2][j];
        double ex = (double)f->v[1][0][j] - vx, ey = (double)f->v[1][1][j] - vy,
               ez = (double)f->v[1][2][j] - vz;
        double fx = (double)f->v[2][0][j] - vx, fy = (double)f->v[2][1][j] - vy,
               fz = (double)f->v[2][2][j] - vz;
        double nx = ey * fz - ez * fy, ny = ez * fx - ex * fz, nz = ex * fy - ey * fx;
        double qx = rx.x * px + rx.y * py + rx.z * pz + at.x - vx;
        double qy = ry.x * px + ry.y * py + ry.z * pz + at.y - vy;
        double qz = rz.x * px + rz.y * py + rz.z * pz + at.z - vz;
        double gx = rx.x * nx + ry.x * ny + rz.x * nz, gy = rx.y * nx + ry.y * ny + rz.y * nz,
               gz = rx.z * nx + ry.z * ny + rz.z * nz;
        double unit = 1 / sqrt(gx * gx + gy * gy + gz * gz);
        gx *= unit;
        gy *= unit;
        gz *= unit;
        double step = (nx * qx + ny * qy + nz * qz) * unit;
        real x = (real)(px - step * gx), y = (real)(py - step * gy), z = (real)(pz - step * gz);
        real largest = real_max(real_max(real_abs(x), real_abs(y)), real_abs(z));
        from->x[k] = x;
        from->y[k] = y;
        from->z[k] = z;
        from->near[k] = MESH_MARGIN * (largest + extent);
        w->nx[k] = (real)gx;
        w->ny[k] = (real)gy;
        w->nz[k] = (real)gz;
    }
}

/* Listed points on meshes, by runs that lie on the same one; on one that moves, one by one. */
static void find_meshes(zt_points *w, zt_batch *rays, const zt_tracer *tracer,
                        const int32_t *list, int count) {
    facets f;
    zt_placed_mesh now;
    for (int first = 0, end; first < count; first = end) {
        int32_t primitive = w->primitive[list[first]];
        for (end = first + 1; end < count && w->primitive[list[end]] == primitive;) end++;
        const zt_placed_mesh *m = placed_at(&now, w, rays->from, tracer, list[first]);
        if (m->places) end = first + 1;
        load_facets(&f, m->built->mesh, rays->part, end - first, list + first);
        find_facets(w, rays->from, &f, m, list + first, end - first);
        for (int j = first; m->vertex_colors && j < end; j++)
            color_mesh(w, rays, tracer, list[j]);
    }
}

/* Bends the normal of a smooth mesh's point, and lifts the point onto the surface that the bent
 * normals speak of: onto the planes that stand across the corners' normals, each by its share
 * (Hanika, "Hacking the shadow terminator", Ray Tracing Gems II, 2021). Both on the side that
 * the flat normal, which faces the ray, says. */
static void smooth_mesh(zt_points *w, zt_batch *rays, const zt_tracer *tracer, int k) {
    if (!tracer->placed[tracer->primitives[w->primitive[k]].placed].smooth) return;
    mesh_point p;
    find_mesh_point(&p, w, rays, tracer, k);
    zt_origins *from = rays->from;
    vec3 flat = {(double)w->nx[k], (double)w->ny[k], (double)w->nz[k]};
    vec3 own[3], bent = {0, 0, 0}, lift = {0, 0, 0};
    double shares[3];
    share(shares, &p);
    for (int i = 0; i < 3; i++) {
        own[i] = corner(p.placed->built->mesh->normals, p.of, i);
        bent = vec3_add(bent, vec3_scale(unit(out_of_mesh(p.placed, own[i])), shares[i]));
    }
    bent = unit(bent);
    double side = vec3_dot(bent, flat) < 0 ? -1 : 1;
    /* In the mesh's space, where the corners are: normals there stand across as well. */
    for (int i = 0; i < 3; i++) {
        double above = vec3_dot(vec3_sub(p.at, p.v[i]), own[i]) * side;
        lift = vec3_sub(lift, vec3_scale(own[i], side * fmin(above, 0) * shares[i]));
    }
    if (!isfinite(bent.x) || !isfinite(lift.x + lift.y + lift.z)) return;
    vec3 out = xform_vector(&p.placed->place, lift);
    from->x[k] += (real)out.x;
    from->y[k] += (real)out.y;
    from->z[k] += (real)out.z;
    w->nx[k] = (real)(side * bent.x);
    w->ny[k] = (real)(side * bent.y);
    w->nz[k] = (real)(side * bent.z);
}

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

void ZT_KERNEL_NAME(zt_points_find)(zt_points *w, zt_batch *rays, const zt_tracer *tracer) {
    zt_origins *from = rays->from;
    int32_t list[ZT_BATCH];
    w->count = rays->count;
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
    find_meshes(w, rays, tracer, list, mesh_count);
    if (tracer->has_patterns) weave(w, from, tracer);
    if (tracer->changes) ZT_KERNEL_NAME(zt_change_patterns)(w, from, tracer);
    face_rays(w, rays, from);
    leave_surfaces(w, from);
    for (int j = 0; j < mesh_count; j++) smooth_mesh(w, rays, tracer, list[j]);
    /* Where rays leave a closed thing's inside they meet it again. */
    int32_t inside = 0;
    for (int k = 0; k < w->count; k++) inside |= from->source[k] & 1;
    if (inside) w->source = -1;
}
