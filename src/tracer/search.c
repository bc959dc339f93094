/* Rays go to a mesh's space and are asked about there, first against its hull, many at a time,
 * then in its hierarchy. In single precision the hierarchy is over triangles and finds the one
 * that is met; how far away that is, is worked out here in double precision. In double precision
 * it is over boxes, and the triangles are intersected here. Compiled once for each width of
 * instructions and each precision (tracer/isa.h). */
#include "tracer/search.h"

#include <math.h>
#include <string.h>

#define ALL_DOUBLE (sizeof(real) == sizeof(double))

/* How much further than the nearest hit so far a hierarchy looks, for the roundings of its
 * distances. */
#define LOOK_FURTHER (1 + 0x1p-18f)

/* Some rays of a batch on their way through a mesh or a crowd. */
typedef struct search {
    zt_batch *rays;
    const zt_placed_mesh *placed;
    int32_t index;                /* of the primitive that the mesh is */
    bool any;                     /* one hit is enough */
    int32_t list[ZT_BATCH];       /* the numbers of the rays, as they stand below */
    /* The rays in the mesh's space. */
    alignas(64) real ox[ZT_BATCH];
    alignas(64) real oy[ZT_BATCH];
    alignas(64) real oz[ZT_BATCH];
    alignas(64) real dx[ZT_BATCH];
    alignas(64) real dy[ZT_BATCH];
    alignas(64) real dz[ZT_BATCH];
    real begin[ZT_BATCH]; /* where, along each of them, the hierarchy's rays begin */
    zt_bvh_rays packed;
} search;

/* ---- the way to a mesh, and its hull --------------------------------------------------------
 */

/* Takes listed rays, or all of the batch, to the mesh's space: a multiple of lanes. */
static void enter_mesh(search *restrict s, const zt_batch *restrict rays, int count) {
    const zt_placed_mesh *m = s->placed;
    const zt_origins *restrict from = rays->from;
    const real rxx = (real)m->rows[0].x, rxy = (real)m->rows[0].y, rxz = (real)m->rows[0].z;
    const real ryx = (real)m->rows[1].x, ryy = (real)m->rows[1].y, ryz = (real)m->rows[1].z;
    const real rzx = (real)m->rows[2].x, rzy = (real)m->rows[2].y, rzz = (real)m->rows[2].z;
    const real ax = (real)m->at.x, ay = (real)m->at.y, az = (real)m->at.z;
    int padded = zt_batch_padded(count);
    for (int j = count; j < padded; j++) s->list[j] = s->list[0];
    WIDE_LOOP for (int j = 0; j < padded; j++) {
        int32_t i = s->list[j];
        real ox = from->x[i], oy = from->y[i], oz = from->z[i];
        real dx = rays->dx[i], dy = rays->dy[i], dz = rays->dz[i];
        s->ox[j] = real_dot(rxx, rxy, rxz, ox, oy, oz) + ax;
        s->oy[j] = real_dot(ryx, ryy, ryz, ox, oy, oz) + ay;
        s->oz[j] = real_dot(rzx, rzy, rzz, ox, oy, oz) + az;
        s->dx[j] = real_dot(rxx, rxy, rxz, dx, dy, dz);
        s->dy[j] = real_dot(ryx, ryy, ryz, dx, dy, dz);
        s->dz[j] = real_dot(rzx, rzy, rzz, dx, dy, dz);
    }
}

/* ZT_BATCH_LANES rays against boxes: origins, one over directions, how far to look, and how much
 * room the boxes need for the roundings of all that. */
typedef struct lanes {
    alignas(64) real ox[ZT_BATCH_LANES];
    alignas(64) real oy[ZT_BATCH_LANES];
    alignas(64) real oz[ZT_BATCH_LANES];
    alignas(64) real kx[ZT_BATCH_LANES];
    alignas(64) real ky[ZT_BATCH_LANES];
    alignas(64) real kz[ZT_BATCH_LANES];
    alignas(64) real t[ZT_BATCH_LANES];
    alignas(64) real room[ZT_BATCH_LANES];
    alignas(64) real enter[ZT_BATCH_LANES];
    alignas(64) int32_t meets[ZT_BATCH_LANES];
} lanes;

static void enter_lanes(lanes *restrict l, const search *restrict s, int first) {
    const zt_placed_mesh *m = s->placed;
    const zt_origins *restrict from = s->rays->from;
    const real *restrict t = s->rays->t;
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        int32_t i = s->list[first + j];
        l->ox[j] = s->ox[first + j];
        l->oy[j] = s->oy[first + j];
        l->oz[j] = s->oz[first + j];
        l->kx[j] = 1 / s->dx[first + j];
        l->ky[j] = 1 / s->dy[first + j];
        l->kz[j] = 1 / s->dz[first + j];
        l->t[j] = t[i];
        real largest =
            real_max(real_max(real_abs(from->x[i]), real_abs(from->y[i])), real_abs(from->z[i]));
        l->room[j] = 32 * REAL_ROUNDING * (m->reach * largest + m->room);
    }
}

/* Adds to `meets` the rays that meet a box, grown by their room, before their t; a doubt (what
 * is no number compares as false) counts as meeting. Distances to the sides may each be off by
 * a few roundings (Ize, "Robust BVH ray traversal", JCGT 2(2), 2013). */
static inline void meet_box(lanes *restrict l, const zt_bvh_box *box) {
    const real less = 1 - 16 * REAL_ROUNDING, more = 1 + 16 * REAL_ROUNDING;
    const real x = box->low[0], y = box->low[1], z = box->low[2];
    const real xx = box->high[0], yy = box->high[1], zz = box->high[2];
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        real room = l->room[j];
        real x0 = (x - room - l->ox[j]) * l->kx[j], x1 = (xx + room - l->ox[j]) * l->kx[j];
        real y0 = (y - room - l->oy[j]) * l->ky[j], y1 = (yy + room - l->oy[j]) * l->ky[j];
        real z0 = (z - room - l->oz[j]) * l->kz[j], z1 = (zz + room - l->oz[j]) * l->kz[j];
        real enter = real_max(real_max(real_min(x0, x1), real_min(y0, y1)), real_min(z0, z1));
        real leave = real_min(real_min(real_max(x0, x1), real_max(y0, y1)), real_max(z0, z1));
        l->enter[j] = enter;
        l->meets[j] |= !(leave < 0) & !(enter * less > leave * more) &
                       !(enter * less > l->t[j] * more) &
                       !(l->t[j] <= 0); /* such a ray looks nowhere */
    }
}

static inline bool any_meets(const lanes *l) {
    int32_t any = 0;
    for (int j = 0; j < ZT_BATCH_LANES; j++) any |= l->meets[j];
    return any;
}

/* Leaves in `meets` the rays that meet box number `index` of a hull, or rather those of its
 * halves, `level` times halved. */
static void meet_halves(lanes *restrict l, const zt_bvh_box *boxes, int index, int level) {
    memset(l->meets, 0, sizeof l->meets);
    meet_box(l, &boxes[index]);
    if (level == 0 || !any_meets(l)) return;
    enum { STEP = 3 }; /* levels from one look to the next: halves of halves of halves */
    int step = level < STEP ? level : STEP;
    int32_t all[ZT_BATCH_LANES] = {0};
    for (int i = index << step; i < (index + 1) << step; i++) {
        meet_halves(l, boxes, i, level - step);
        for (int j = 0; j < ZT_BATCH_LANES; j++) all[j] |= l->meets[j];
    }
    memcpy(l->meets, all, sizeof all);
}

/* Fills the hierarchy's rays with those that meet the hull; the list and the rays in the mesh's
 * space shrink to them. Doubles begin where they enter the box around it, so that floats keep
 * what counts. */
static void pack(search *restrict s, int count) {
    const zt_bvh_box *boxes = s->placed->built->hull->boxes;
    zt_bvh_rays *restrict packed = &s->packed;
    int kept = 0;
    for (int first = 0; first < count; first += ZT_BATCH_LANES) {
        lanes l;
        real begin[ZT_BATCH_LANES];
        enter_lanes(&l, s, first);
        memset(l.meets, 0, sizeof l.meets);
        meet_box(&l, &boxes[1]);
        memcpy(begin, l.enter, sizeof begin);
        if (!any_meets(&l)) continue;
        meet_halves(&l, boxes, 1, ZT_HULL_LEVELS - 1);
        for (int j = 0; j < ZT_BATCH_LANES && first + j < count; j++) {
            int from = first + j;
            real t0 = ALL_DOUBLE && begin[j] > 0 ? begin[j] : 0;
            real t = s->rays->t[s->list[from]];
            s->list[kept] = s->list[from];
            s->ox[kept] = s->ox[from];
            s->oy[kept] = s->oy[from];
            s->oz[kept] = s->oz[from];
            s->dx[kept] = s->dx[from];
            s->dy[kept] = s->dy[from];
            s->dz[kept] = s->dz[from];
            s->begin[kept] = t0;
            packed->ox[kept] = (float)(s->ox[from] + t0 * s->dx[from]);
            packed->oy[kept] = (float)(s->oy[from] + t0 * s->dy[from]);
            packed->oz[kept] = (float)(s->oz[from] + t0 * s->dz[from]);
            packed->dx[kept] = (float)s->dx[from];
            packed->dy[kept] = (float)s->dy[from];
            packed->dz[kept] = (float)s->dz[from];
            packed->far[kept] = (float)(t - t0) * LOOK_FURTHER;
            kept += l.meets[j];
        }
    }
    packed->count = kept;
}

/* ---- triangles ------------------------------------------------------------------------------
 */

typedef struct corners {
    real3 v[3];
} corners;

static inline corners corners_of(const zt_mesh *mesh, int32_t triangle) {
    corners c;
    const uint32_t *of = mesh->triangles + 3 * (int64_t)triangle;
    for (int k = 0; k < 3; k++) {
        const float *p = mesh->positions + 3 * (int64_t)of[k];
        c.v[k] = (real3){(real)p[0], (real)p[1], (real)p[2]};
    }
    return c;
}

/* Takes a hit of listed ray j; of the same mesh the nearest counts, and the first of equals. */
static void take(search *s, int j, real t, int32_t triangle) {
    zt_batch *rays = s->rays;
    int32_t i = s->list[j], hit = rays->hit[i];
    real nearest = rays->t[i];
    bool nearer = t < nearest || (t == nearest && (hit == s->index ? triangle < rays->part[i]
                                                                   : s->index < hit));
    if (!nearer) return;
    rays->t[i] = t;
    rays->hit[i] = s->index;
    rays->part[i] = triangle;
}

/* Where a ray meets the plane of a triangle; what the hierarchy said where that is no place in
 * front of it, as for a ray within the plane. */
static inline double plane_distance(const search *s, int j, int32_t triangle, float about) {
    const zt_batch *rays = s->rays;
    const zt_placed_mesh *m = s->placed;
    int32_t i = s->list[j];
    corners c = corners_of(m->built->mesh, triangle);
    vec3 v0 = {(double)c.v[0].x, (double)c.v[0].y, (double)c.v[0].z};
    vec3 v1 = {(double)c.v[1].x, (double)c.v[1].y, (double)c.v[1].z};
    vec3 v2 = {(double)c.v[2].x, (double)c.v[2].y, (double)c.v[2].z};
    vec3 n = vec3_cross(vec3_sub(v1, v0), vec3_sub(v2, v0));
    vec3 o = zt_placed_point(m, (vec3){(double)rays->from->x[i], (double)rays->from->y[i],
                                       (double)rays->from->z[i]});
    vec3 d = {(double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i]};
    vec3 e = {vec3_dot(m->rows[0], d), vec3_dot(m->rows[1], d), vec3_dot(m->rows[2], d)};
    double t = vec3_dot(n, vec3_sub(v0, o)) / vec3_dot(n, e);
    return t > 0 && t <= (double)about * 1.001 ? t : (double)about;
}

/* Intersects some rays with one triangle, in double precision. */
static void visit_triangle(void *user, int32_t triangle, const int32_t *numbers, int count) {
    search *s = user;
    corners c = corners_of(s->placed->built->mesh, triangle);
    for (int k = 0; k < count; k++) {
        int j = numbers[k];
        real t = zt_triangle_meet(c.v[0], c.v[1], c.v[2], s->ox[j], s->oy[j], s->oz[j],
                                  s->dx[j], s->dy[j], s->dz[j]);
        int32_t i = s->list[j];
        if (!(t <= s->rays->t[i])) continue;
        if (s->any) {
            if (!(t * (1 + TIE) + s->rays->from->near[i] < s->rays->t[i])) continue;
            s->rays->hit[i] = 0;
            s->packed.far[j] = -1;
        } else {
            take(s, j, t, triangle);
            s->packed.far[j] = (float)(s->rays->t[i] - s->begin[j]) * LOOK_FURTHER;
        }
    }
}

/* The listed rays, `count` of them, against one mesh. */
static void search_mesh(search *s, int count, zt_bvh_kind kind) {
    const zt_built_mesh *built = s->placed->built;
    enter_mesh(s, s->rays, count);
    pack(s, count);
    zt_bvh_rays *packed = &s->packed;
    if (packed->count == 0) return;
    if (ALL_DOUBLE) {
        zt_bvh_look(built->boxes, packed, kind, visit_triangle, s);
    } else if (s->any) {
        for (int j = 0; j < packed->count; j++)
            packed->far[j] = (float)s->rays->t[s->list[j]] * (float)(1 - TIE);
        zt_bvh_any(built->triangles, packed, kind);
        for (int j = 0; j < packed->count; j++)
            if (packed->triangle[j] >= 0) s->rays->hit[s->list[j]] = 0;
    } else {
        zt_bvh_nearest(built->triangles, packed, kind);
        for (int j = 0; j < packed->count; j++)
            if (packed->triangle[j] >= 0)
                take(s, j, (real)plane_distance(s, j, packed->triangle[j], packed->far[j]),
                     packed->triangle[j]);
    }
}

/* ---- crowds ---------------------------------------------------------------------------------
 */

typedef struct crowd_search {
    zt_batch *rays;
    const zt_tracer *tracer;
    bool any;
    zt_bvh_kind kind;
    int32_t list[ZT_BATCH];
    real begin[ZT_BATCH]; /* where, along each ray, the hierarchy's begins */
    zt_bvh_rays packed;
} crowd_search;

/* Some rays against one primitive of a crowd. Shadow rays are asked for their nearest hit too,
 * which costs them nothing. */
static void visit_primitive(void *user, int32_t box, const int32_t *numbers, int count) {
    crowd_search *c = user;
    int32_t index = c->tracer->crowd_primitives[box], list[ZT_BATCH];
    const zt_primitive *p = &c->tracer->primitives[index];
    for (int k = 0; k < count; k++) list[k] = c->list[numbers[k]];
    if (p->kind == ZT_PRIMITIVE_MESH) {
        search s;
        s.rays = c->rays;
        s.placed = &c->tracer->placed[p->placed];
        s.index = index;
        s.any = c->any;
        memcpy(s.list, list, (size_t)count * sizeof *list);
        search_mesh(&s, count, c->kind);
    } else {
        ZT_KERNEL_NAME(zt_meet_listed)(c->rays, c->tracer, index, list, count, c->any);
    }
    for (int k = 0; k < count; k++) {
        int32_t i = list[k];
        bool done = c->any && c->rays->hit[i] >= 0;
        real far = c->rays->t[i] - c->begin[numbers[k]];
        c->packed.far[numbers[k]] = done ? -1 : (float)far * LOOK_FURTHER;
    }
}

/* Where a ray enters a box, or 0 where it begins within or never does. */
static inline real enter_box(const zt_box *b, real ox, real oy, real oz, real dx, real dy,
                             real dz) {
    real x = real_min((b->low.x - ox) / dx, (b->high.x - ox) / dx);
    real y = real_min((b->low.y - oy) / dy, (b->high.y - oy) / dy);
    real z = real_min((b->low.z - oz) / dz, (b->high.z - oz) / dz);
    real enter = real_max(real_max(x, y), z);
    return enter > 0 && enter < REAL_INFINITY ? enter : 0;
}

static void search_crowd(zt_batch *rays, const zt_tracer *tracer, bool any, zt_bvh_kind kind) {
    crowd_search c;
    c.rays = rays;
    c.tracer = tracer;
    c.any = any;
    c.kind = kind;
    int kept = 0;
    const zt_origins *from = rays->from;
    for (int i = 0; i < rays->count; i++) {
        real ox = from->x[i], oy = from->y[i], oz = from->z[i];
        real dx = rays->dx[i], dy = rays->dy[i], dz = rays->dz[i];
        real begin = ALL_DOUBLE ? enter_box(&tracer->crowd_box, ox, oy, oz, dx, dy, dz) : 0;
        c.list[kept] = i;
        c.begin[kept] = begin;
        c.packed.ox[kept] = (float)(ox + begin * dx);
        c.packed.oy[kept] = (float)(oy + begin * dy);
        c.packed.oz[kept] = (float)(oz + begin * dz);
        c.packed.dx[kept] = (float)dx;
        c.packed.dy[kept] = (float)dy;
        c.packed.dz[kept] = (float)dz;
        c.packed.far[kept] = (float)(rays->t[i] - begin) * LOOK_FURTHER;
        kept += !any || (rays->hit[i] < 0 && rays->t[i] > 0);
    }
    c.packed.count = kept;
    if (kept > 0) zt_bvh_look(tracer->crowd, &c.packed, kind, visit_primitive, &c);
}

/* ---- both -----------------------------------------------------------------------------------
 */

static void search_all(zt_batch *rays, const zt_bundle *bundle, const zt_tracer *tracer,
                       bool any, zt_bvh_kind kind) {
    if (tracer->crowd) {
        search_crowd(rays, tracer, any, kind);
        return;
    }
    for (int32_t k = 0; k < tracer->single_count; k++) {
        int32_t index = tracer->single[k];
        const zt_primitive *p = &tracer->primitives[index];
        if (p->kind != ZT_PRIMITIVE_MESH || !zt_bundle_meets(bundle, &p->box, 1)) continue;
        search s;
        s.rays = rays;
            s.placed = &tracer->placed[p->placed];
        s.index = index;
        s.any = any;
        int count = 0;
        for (int i = 0; i < rays->count; i++) {
            s.list[count] = i;
            count += !any || (rays->hit[i] < 0 && rays->t[i] > 0);
        }
        if (count > 0) search_mesh(&s, count, kind);
    }
}

void ZT_KERNEL_NAME(zt_search_nearest)(zt_batch *rays, const zt_bundle *bundle,
                                       const zt_tracer *tracer, zt_running running) {
    search_all(rays, bundle, tracer, false,
               running == ZT_RUNNING_TOGETHER ? ZT_BVH_COHERENT : ZT_BVH_SCATTERED);
}

void ZT_KERNEL_NAME(zt_search_any)(zt_batch *rays, const zt_bundle *bundle,
                                   const zt_tracer *tracer) {
    search_all(rays, bundle, tracer, true, ZT_BVH_COHERENT);
}
