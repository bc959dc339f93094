/* Rays go to a mesh's space and are asked about there, first against its hull, many at a time,
 * then in its hierarchy, which tells clusters of triangles to intersect. Compiled once for each
 * width of instructions and each precision (tracer/isa.h). */
#include "tracer/search.h"

#include <math.h>
#include <string.h>

#include "tracer/triangles.h"

/* How much further than the nearest hit so far a hierarchy looks, for the roundings of its
 * distances; and how long before the box around a mesh its rays begin, so that they begin
 * before all that is in it. */
#define LOOK_FURTHER (1 + 0x1p-18f)
#define BEFORE       (1 - (real)0x1p-6)

/* How many times a hull is halved for a look at it, and from how many rays of a group on it is
 * quicker to ask them all about one triangle than one about all triangles of a cluster. */
enum { HULL_LEVEL = 3, LANES_WORTH = 4 };

/* Some rays of a batch on their way through a mesh or a crowd. */
typedef struct search {
    zt_batch *rays;
    const zt_placed_mesh *placed;
    int32_t index;          /* of the primitive that the mesh is */
    bool any;               /* one hit is enough */
    int32_t list[ZT_BATCH]; /* the numbers of the rays, as they stand below */
    /* The rays in the mesh's space. */
    alignas(64) real ox[ZT_BATCH];
    alignas(64) real oy[ZT_BATCH];
    alignas(64) real oz[ZT_BATCH];
    alignas(64) real dx[ZT_BATCH];
    alignas(64) real dy[ZT_BATCH];
    alignas(64) real dz[ZT_BATCH];
    real begin[ZT_BATCH];               /* how far along the batch's they begin */
    alignas(64) real t[ZT_BATCH];       /* the nearest hit so far */
    alignas(64) int32_t part[ZT_BATCH]; /* and of which triangle, or -1 */
    zt_leaning_rays leaning;
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

/* ZT_BATCH_LANES rays against boxes: origins, one over directions, how far to look, and how
 * much room the boxes need for the roundings of all that. */
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
        real largest = real_max(real_max(real_abs(from->x[i]), real_abs(from->y[i])),
                                real_abs(from->z[i]));
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
 * space shrink to them. They begin before they enter the box around it, so that single
 * precision keeps what counts. */
static void pack(search *restrict s, int count) {
    const zt_bvh_box *boxes = s->placed->built->hull->boxes;
    zt_bvh_rays *restrict packed = &s->packed;
    const zt_origins *from = s->rays->from;
    int kept = 0;
    for (int first = 0; first < count; first += ZT_BATCH_LANES) {
        lanes l;
        real begin[ZT_BATCH_LANES];
        enter_lanes(&l, s, first);
        memset(l.meets, 0, sizeof l.meets);
        meet_box(&l, &boxes[1]);
        if (!any_meets(&l)) continue;
        memcpy(begin, l.enter, sizeof begin);
        meet_halves(&l, boxes, 1, HULL_LEVEL);
        for (int j = 0; j < ZT_BATCH_LANES && first + j < count; j++) {
            int own = first + j;
            int32_t i = s->list[own];
            real t0 = begin[j] * BEFORE;
            t0 = t0 > 0 && t0 < REAL_INFINITY ? t0 : 0;
            real t = s->rays->t[i];
            s->list[kept] = i;
            s->begin[kept] = t0;
            s->t[kept] = (s->any ? (t - from->near[i]) / (1 + TIE) : t) - t0;
            s->part[kept] = -1;
            s->dx[kept] = s->dx[own];
            s->dy[kept] = s->dy[own];
            s->dz[kept] = s->dz[own];
            s->ox[kept] = s->ox[own] + t0 * s->dx[kept];
            s->oy[kept] = s->oy[own] + t0 * s->dy[kept];
            s->oz[kept] = s->oz[own] + t0 * s->dz[kept];
            packed->ox[kept] = (float)s->ox[kept];
            packed->oy[kept] = (float)s->oy[kept];
            packed->oz[kept] = (float)s->oz[kept];
            packed->dx[kept] = (float)s->dx[kept];
            packed->dy[kept] = (float)s->dy[kept];
            packed->dz[kept] = (float)s->dz[kept];
            packed->far[kept] = (float)s->t[kept] * LOOK_FURTHER;
            kept += l.meets[j];
        }
    }
    packed->count = kept;
}

/* ---- triangles ------------------------------------------------------------------------------
 */

static void visit_cluster(void *user, int32_t box, int first, uint32_t set) {
    search *s = user;
    const zt_cluster *cluster = &s->placed->built->clusters.clusters[box];
    uint32_t found = 0;
    if (__builtin_popcount(set) >= LANES_WORTH && zt_lean_alike(&s->leaning, first, set))
        found = zt_meet_cluster_lanes(s->t, s->part, cluster, &s->leaning, first, set);
    else
        for (; set; set &= set - 1) {
            int j = first + __builtin_ctz(set);
            if (zt_meet_cluster(&s->t[j], &s->part[j], cluster, &s->leaning, j))
                found |= 1u << (j - first);
        }
    for (; found; found &= found - 1) {
        int j = first + __builtin_ctz(found);
        s->packed.far[j] = s->any ? -1 : (float)s->t[j] * LOOK_FURTHER;
    }
}

/* The listed rays, `count` of them, against one mesh. */
static void search_mesh(search *s, int count, zt_bvh_kind kind) {
    zt_batch *rays = s->rays;
    enter_mesh(s, rays, count);
    pack(s, count);
    if (s->packed.count == 0) return;
    zt_lean_rays(&s->leaning, s->ox, s->oy, s->oz, s->dx, s->dy, s->dz, s->packed.count);
    zt_bvh_look(s->placed->built->bvh, &s->packed, kind, visit_cluster, s);
    for (int j = 0; j < s->packed.count; j++) {
        int32_t i = s->list[j], hit = rays->hit[i];
        if (s->part[j] < 0) continue;
        real t = s->begin[j] + s->t[j];
        if (t == rays->t[i] && hit >= 0 && hit < s->index) continue;
        rays->t[i] = t;
        rays->hit[i] = s->index;
        rays->part[i] = s->part[j];
    }
}

/* ---- crowds ---------------------------------------------------------------------------------
 */

typedef struct crowd_search {
    zt_batch *rays;
    const zt_tracer *tracer;
    bool any;
    zt_bvh_kind kind;
    real begin[ZT_BATCH]; /* where, along each ray, the hierarchy's begins */
    zt_bvh_rays packed;
} crowd_search;

/* Some rays against one primitive of a crowd. Others of their group are asked as well, since it
 * costs nothing. Shadow rays are asked for their nearest hit. */
static void visit_primitive(void *user, int32_t box, int first, uint32_t set) {
    crowd_search *c = user;
    zt_batch *rays = c->rays;
    int32_t index = c->tracer->crowd_primitives[box];
    const zt_primitive *p = &c->tracer->primitives[index];
    if (p->kind == ZT_PRIMITIVE_MESH) {
        search s;
        int count = 0;
        s.rays = rays;
        s.placed = &c->tracer->placed[p->placed];
        s.index = index;
        s.any = c->any;
        for (uint32_t left = set; left; left &= left - 1)
            s.list[count++] = first + __builtin_ctz(left);
        search_mesh(&s, count, c->kind);
    } else {
        ZT_KERNEL_NAME(zt_meet_lanes)(rays, c->tracer, index, first, c->any);
    }
    for (int i = first; i < first + ZT_BATCH_LANES; i++) {
        bool done = c->any & (rays->hit[i] >= 0);
        c->packed.far[i] = done ? -1 : (float)(rays->t[i] - c->begin[i]) * LOOK_FURTHER;
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
    const zt_origins *from = rays->from;
    c.packed.count = rays->count;
    for (int i = 0; i < rays->count; i++) {
        real ox = from->x[i], oy = from->y[i], oz = from->z[i];
        real dx = rays->dx[i], dy = rays->dy[i], dz = rays->dz[i];
        real begin = enter_box(&tracer->crowd_box, ox, oy, oz, dx, dy, dz) * BEFORE;
        bool looks = !any || (rays->hit[i] < 0 && rays->t[i] > 0);
        c.begin[i] = begin;
        c.packed.ox[i] = (float)(ox + begin * dx);
        c.packed.oy[i] = (float)(oy + begin * dy);
        c.packed.oz[i] = (float)(oz + begin * dz);
        c.packed.dx[i] = (float)dx;
        c.packed.dy[i] = (float)dy;
        c.packed.dz[i] = (float)dz;
        c.packed.far[i] = looks ? (float)(rays->t[i] - begin) * LOOK_FURTHER : -1;
    }
    zt_bvh_look(tracer->crowd, &c.packed, kind, visit_primitive, &c);
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
