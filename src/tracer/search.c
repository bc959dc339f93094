/* Rays go to a mesh's space and are asked about there, first against its hull, many at a time,
 * then in its hierarchy, which tells clusters of triangles to intersect. Compiled once for each
 * width of instructions and each precision (tracer/isa.h). */
#include "tracer/search.h"

#include <math.h>
#include <string.h>

#include "tracer/crowds.h"
#include "tracer/look.h"
#include "tracer/triangles.h"

/* How many times a hull is halved for a look at it, and from how many rays of a group on it is
 * quicker to ask them all about one triangle than one about all triangles of a cluster: where
 * only four numbers are computed at a time, never. */
#if defined __AVX2__
enum { HULL_LEVEL = 2, LANES_WORTH = 8 };
#else
enum { HULL_LEVEL = 2, LANES_WORTH = ZT_BATCH_LANES + 1 };
#endif

enum { GROUPS = ZT_BATCH / ZT_BATCH_LANES };

/* Groups of lanes of a batch on their way through a mesh. */
typedef struct search {
    zt_batch *rays;
    const zt_placed_mesh *placed;
    int32_t index;         /* of the primitive that the mesh is */
    bool any;              /* one hit is enough */
    real tie;              /* as in zt_tracer; of shadow rays 0 */
    int32_t first[GROUPS]; /* of each group below, where it stands in the batch */
    bool alike[GROUPS];    /* whether its rays run along one axis most */
    /* The rays in the mesh's space. */
    alignas(64) real ox[ZT_BATCH];
    alignas(64) real oy[ZT_BATCH];
    alignas(64) real oz[ZT_BATCH];
    alignas(64) real dx[ZT_BATCH];
    alignas(64) real dy[ZT_BATCH];
    alignas(64) real dz[ZT_BATCH];
    alignas(64) real begin[ZT_BATCH];   /* how far along the batch's they begin */
    alignas(64) real t[ZT_BATCH];       /* the nearest hit so far */
    alignas(64) int32_t part[ZT_BATCH]; /* and of which triangle, or -1 */
    zt_leaning_rays leaning;
    zt_bvh_rays packed;
} search;

/* ---- the way to a mesh, and its hull --------------------------------------------------------
 */

/* A group of rays in the mesh's space: origins, directions, one over them, how far to look (not
 * at all where t <= 0), and how much room boxes need for the roundings of all that. */
typedef struct lanes {
    alignas(64) real ox[ZT_BATCH_LANES];
    alignas(64) real oy[ZT_BATCH_LANES];
    alignas(64) real oz[ZT_BATCH_LANES];
    alignas(64) real dx[ZT_BATCH_LANES];
    alignas(64) real dy[ZT_BATCH_LANES];
    alignas(64) real dz[ZT_BATCH_LANES];
    alignas(64) real kx[ZT_BATCH_LANES];
    alignas(64) real ky[ZT_BATCH_LANES];
    alignas(64) real kz[ZT_BATCH_LANES];
    alignas(64) real t[ZT_BATCH_LANES];
    alignas(64) real room[ZT_BATCH_LANES];
    alignas(64) real enter[ZT_BATCH_LANES]; /* the box that was looked at last */
    alignas(64) int32_t meets[ZT_BATCH_LANES];
} lanes;

/* How far the rays of a group look: shadow rays that are hidden already, and lanes beyond the
 * count, nowhere. */
static void look_ahead(lanes *restrict l, const search *restrict s, int first) {
    const zt_batch *restrict rays = s->rays;
    const real *restrict near = rays->from->near;
    const int count = rays->count;
    if (s->any) WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
            real until = (rays->t[first + j] - near[first + j]) * (1 - TIE);
            l->t[j] = rays->hit[first + j] < 0 ? until : 0;
        }
    else {
        /* What is as near but for roundings is found in any order. */
        const real more = 1 + 2 * s->tie + 8 * REAL_ROUNDING, share = 2 * s->tie / TIE;
        WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) l->t[j] =
            rays->t[first + j] * more + share * near[first + j];
    }
    for (int j = count - first; j < ZT_BATCH_LANES; j++) l->t[j] = 0;
}

static inline double greatest(double a, double b) { return a > b ? a : b; }
static inline double most_abs(vec3 v) {
    return greatest(greatest(fabs(v.x), fabs(v.y)), fabs(v.z));
}

/* To the space of a mesh that moves, as it is at each ray's time, inverted in
 * double precision. */
static void enter_moving_mesh(lanes *restrict l, const search *restrict s, int first) {
    const zt_batch *restrict rays = s->rays;
    const zt_origins *restrict from = rays->from;
    const xform *restrict places = s->placed->places;
    const double inner = (double)s->placed->inner;
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        int i = first + j;
        const xform *a = &places[from->moment[i]], *b = a + 1;
        double between = (double)from->between[i];
        vec3 x = zt_mix3(a->x, b->x, between), y = zt_mix3(a->y, b->y, between);
        vec3 z = zt_mix3(a->z, b->z, between), shift = zt_mix3(a->shift, b->shift, between);
        vec3 rx = vec3_cross(y, z), ry = vec3_cross(z, x), rz = vec3_cross(x, y);
        double scale = 1 / vec3_dot(rx, x);
        vec3 o = {(double)from->x[i] - shift.x, (double)from->y[i] - shift.y,
                  (double)from->z[i] - shift.z};
        vec3 d = {(double)rays->dx[i], (double)rays->dy[i], (double)rays->dz[i]};
        real dx = (real)(vec3_dot(rx, d) * scale), dy = (real)(vec3_dot(ry, d) * scale),
             dz = (real)(vec3_dot(rz, d) * scale);
        double reach = greatest(greatest(most_abs(rx), most_abs(ry)), most_abs(rz)) *
                       (scale < 0 ? -scale : scale);
        double largest = most_abs(o) + 2 * most_abs(shift);
        l->ox[j] = (real)(vec3_dot(rx, o) * scale);
        l->oy[j] = (real)(vec3_dot(ry, o) * scale);
        l->oz[j] = (real)(vec3_dot(rz, o) * scale);
        l->dx[j] = dx;
        l->dy[j] = dy;
        l->dz[j] = dz;
        l->kx[j] = 1 / dx;
        l->ky[j] = 1 / dy;
        l->kz[j] = 1 / dz;
        l->room[j] = 32 * REAL_ROUNDING * (real)(3 * reach * largest + inner);
    }
}

static void enter_mesh(lanes *restrict l, const search *restrict s, int first) {
    const zt_batch *restrict rays = s->rays;
    const zt_origins *restrict from = rays->from;
    const zt_placed_mesh *m = s->placed;
    if (m->places) {
        enter_moving_mesh(l, s, first);
        look_ahead(l, s, first);
        return;
    }
    const real rxx = (real)m->rows[0].x, rxy = (real)m->rows[0].y, rxz = (real)m->rows[0].z;
    const real ryx = (real)m->rows[1].x, ryy = (real)m->rows[1].y, ryz = (real)m->rows[1].z;
    const real rzx = (real)m->rows[2].x, rzy = (real)m->rows[2].y, rzz = (real)m->rows[2].z;
    const real ax = (real)m->at.x, ay = (real)m->at.y, az = (real)m->at.z;
    const real reach = m->reach, room = m->room;
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        int i = first + j;
        real ox = from->x[i], oy = from->y[i], oz = from->z[i];
        real dx, dy, dz;
        real largest = real_max(real_max(real_abs(ox), real_abs(oy)), real_abs(oz));
        l->ox[j] = real_dot(rxx, rxy, rxz, ox, oy, oz) + ax;
        l->oy[j] = real_dot(ryx, ryy, ryz, ox, oy, oz) + ay;
        l->oz[j] = real_dot(rzx, rzy, rzz, ox, oy, oz) + az;
        dx = real_dot(rxx, rxy, rxz, rays->dx[i], rays->dy[i], rays->dz[i]);
        dy = real_dot(ryx, ryy, ryz, rays->dx[i], rays->dy[i], rays->dz[i]);
        dz = real_dot(rzx, rzy, rzz, rays->dx[i], rays->dy[i], rays->dz[i]);
        l->dx[j] = dx;
        l->dy[j] = dy;
        l->dz[j] = dz;
        l->kx[j] = 1 / dx;
        l->ky[j] = 1 / dy;
        l->kz[j] = 1 / dz;
        l->room[j] = 32 * REAL_ROUNDING * (reach * largest + room);
    }
    look_ahead(l, s, first);
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
                       !(enter * less > l->t[j] * more) & (l->t[j] > 0);
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
    for (int i = index << level; i < (index + 1) << level; i++) meet_box(l, &boxes[i]);
}

/* Adds a group of the batch's rays to those that the hierarchy is asked about, if any of the
 * lanes in `set` meets the hull. */
static void pack(search *restrict s, int first, uint32_t set) {
    zt_built_mesh *built = s->placed->built;
    zt_bvh_rays *restrict packed = &s->packed;
    lanes l;
    real begin[ZT_BATCH_LANES];
    enter_mesh(&l, s, first);
    if (!zt_mesh_is_built(built)) {
        meet_halves(&l, &built->around, 0, 0);
        if (!any_meets(&l) || !zt_meshes_build(built)) return;
    }
    const zt_bvh_box *boxes = built->hull->boxes;
    meet_halves(&l, boxes, 1, 0);
    if (!any_meets(&l)) return;
    memcpy(begin, l.enter, sizeof begin);
    meet_halves(&l, boxes, 1, HULL_LEVEL);
    if (!any_meets(&l)) return;
    const int at = packed->count;
    const real before = ZT_LOOK_BEFORE * s->placed->inner;
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        real slow = real_min(real_min(real_abs(l.kx[j]), real_abs(l.ky[j])), real_abs(l.kz[j]));
        real t0 = begin[j] - before * slow;
        t0 = ((t0 > 0) & (t0 < REAL_INFINITY)) ? t0 : 0;
        real ox = l.ox[j] + t0 * l.dx[j], oy = l.oy[j] + t0 * l.dy[j],
             oz = l.oz[j] + t0 * l.dz[j], t = l.t[j] - t0;
        bool looks = l.meets[j] & (int32_t)(set >> j & 1);
        s->begin[at + j] = t0;
        s->t[at + j] = t;
        s->part[at + j] = -1;
        s->ox[at + j] = ox;
        s->oy[at + j] = oy;
        s->oz[at + j] = oz;
        s->dx[at + j] = l.dx[j];
        s->dy[at + j] = l.dy[j];
        s->dz[at + j] = l.dz[j];
        packed->ox[at + j] = (float)ox;
        packed->oy[at + j] = (float)oy;
        packed->oz[at + j] = (float)oz;
        packed->dx[at + j] = (float)l.dx[j];
        packed->dy[at + j] = (float)l.dy[j];
        packed->dz[at + j] = (float)l.dz[j];
        packed->far[at + j] = looks ? (float)t * ZT_LOOK_FURTHER : -1;
    }
    s->first[at / ZT_BATCH_LANES] = first;
    packed->count += ZT_BATCH_LANES;
}

/* ---- triangles ------------------------------------------------------------------------------
 */

static uint32_t visit_cluster(void *user, int32_t box, int first, uint32_t set) {
    search *s = user;
    const zt_cluster *cluster = &s->placed->built->clusters.clusters[box];
    uint32_t found = 0;
    if (s->alike[first / ZT_BATCH_LANES] && __builtin_popcount(set) >= LANES_WORTH)
        found = zt_meet_cluster_lanes(s->t, s->part, cluster, &s->leaning, first, set);
    else
        for (; set; set &= set - 1) {
            int j = first + __builtin_ctz(set);
            if (zt_meet_cluster(&s->t[j], &s->part[j], cluster, &s->leaning, j))
                found |= 1u << (j - first);
        }
    for (uint32_t left = found; left; left &= left - 1) {
        int j = first + __builtin_ctz(left);
        s->packed.far[j] = s->any ? -1 : (float)s->t[j] * ZT_LOOK_FURTHER;
    }
    return found;
}

/* What was found becomes the batch's. */
static void take(const search *restrict s) {
    zt_batch *restrict rays = s->rays;
    const real *restrict near = rays->from->near;
    const int32_t index = s->index;
    const real more = 1 + s->tie, share = s->tie / TIE;
    for (int at = 0; at < s->packed.count; at += ZT_BATCH_LANES) {
        const int first = s->first[at / ZT_BATCH_LANES];
        WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
            real t = s->begin[at + j] + s->t[at + j], nearest = rays->t[first + j];
            int32_t hit = rays->hit[first + j], part = s->part[at + j];
            real slack = share * near[first + j];
            /* As in the loops over lanes of tracer/intersect.c. */
            int32_t later = index > hit;
            int32_t before = t * more + slack < nearest, after = nearest * more + slack < t;
            int32_t no_later = after == 0;
            int32_t nearer = (part >= 0) & ((later & before) | ((1 - later) & no_later));
            int32_t close = (part >= 0) & (index != hit) &
                            zt_is_close(t, nearest, s->tie + 4 * REAL_ROUNDING, slack);
            rays->close[first + j] |= close ? CLOSE_SEVERAL : 0; /* t is off by roundings */
            rays->t[first + j] = nearer ? t : nearest;
            rays->hit[first + j] = nearer ? index : hit;
            rays->part[first + j] = nearer ? part : rays->part[first + j];
        }
    }
}

/* The groups that were packed, against the mesh. */
static void search_mesh(search *s) {
    const int count = s->packed.count;
    if (count == 0) return;
    zt_lean_rays(&s->leaning, s->ox, s->oy, s->oz, s->dx, s->dy, s->dz, count);
    for (int at = 0; at < count; at += ZT_BATCH_LANES)
        s->alike[at / ZT_BATCH_LANES] = zt_lean_alike(&s->leaning, at);
    ZT_KERNEL_NAME(zt_bvh_look)(s->placed->built->bvh, &s->packed, visit_cluster, s);
    take(s);
}

static void begin_search(search *s, zt_batch *rays, const zt_tracer *tracer, int32_t index,
                         bool any) {
    s->rays = rays;
    s->placed = &tracer->placed[tracer->primitives[index].placed];
    s->index = index;
    s->any = any;
    s->tie = any ? 0 : tracer->tie;
    s->packed.count = 0;
}

void ZT_KERNEL_NAME(zt_search_mesh_lanes)(zt_batch *rays, const zt_tracer *tracer,
                                          int32_t index, int first, uint32_t set, bool any) {
    search s;
    begin_search(&s, rays, tracer, index, any);
    pack(&s, first, set);
    search_mesh(&s);
}

/* ---- all ------------------------------------------------------------------------------------
 */

static void search_all(zt_batch *rays, const zt_bundle *bundle, const zt_tracer *tracer,
                       bool any) {
    for (int i = 0; i < tracer->crowd_count; i++)
        ZT_KERNEL_NAME(zt_search_crowd)(rays, tracer, &tracer->crowds[i], any);
    for (int32_t k = 0; k < tracer->single_count; k++) {
        int32_t index = tracer->single[k];
        const zt_primitive *p = &tracer->primitives[index];
        if (p->kind != ZT_PRIMITIVE_MESH || !zt_bundle_meets(bundle, &p->box, 1)) continue;
        search s;
        begin_search(&s, rays, tracer, index, any);
        for (int first = 0; first < rays->count; first += ZT_BATCH_LANES) pack(&s, first, ~0u);
        search_mesh(&s);
    }
}

void ZT_KERNEL_NAME(zt_search_nearest)(zt_batch *rays, const zt_bundle *bundle,
                                       const zt_tracer *tracer) {
    search_all(rays, bundle, tracer, false);
}

void ZT_KERNEL_NAME(zt_search_any)(zt_batch *rays, const zt_bundle *bundle,
                                   const zt_tracer *tracer) {
    search_all(rays, bundle, tracer, true);
}
