/* Points on triangles of meshes: the flat surface of many at a time, in double precision;
 * colors and bent normals, which few ask for, one by one. Compiled once for each width of
 * instructions and each precision (tracer/isa.h). */
#include "tracer/points_meshes.h"

#include <math.h>

/* What is added to a point's numbers for the margin in which rays leave it (tracer/points.c),
 * by how far the mesh reaches: numbers in the mesh's own space are rounded as well, in its
 * intersection and in the next ray's. */
#define MESH_MARGIN 4

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

/* By runs of points that lie on the same mesh; on one that moves, one by one. */
void ZT_KERNEL_NAME(zt_find_on_meshes)(zt_points *w, zt_batch *rays, const zt_tracer *tracer,
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

void ZT_KERNEL_NAME(zt_smooth_on_meshes)(zt_points *w, zt_batch *rays, const zt_tracer *tracer,
                                         const int32_t *list, int count) {
    for (int j = 0; j < count; j++) smooth_mesh(w, rays, tracer, list[j]);
}
