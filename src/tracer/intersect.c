/* What a batch of rays meets. Loops run over the rays for one primitive after the other,
 * without branches, so that the compiler makes them as wide as it may. Compiled once for each
 * width of instructions (tracer/isa.h). */
#include "tracer/intersect.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "tracer/isa.h"

/* The least and the greatest of a batch's origins and directions. */
typedef struct bundle {
    zt_box origins, directions;
} bundle;

/* The bits of a float as an integer, numbered so that the order of the integers is that of the
 * floats: whose least and greatest a compiler finds many at a time without leave to reorder
 * floats. in_order is its own inverse. */
static inline int32_t in_order(int32_t bits) { return bits ^ (bits < 0 ? INT32_MAX : 0); }

static void range(real *low, real *high, const real *values, int count) {
    static_assert(sizeof(real) == sizeof(int32_t), "a real is a float");
    int32_t least = INT32_MAX, greatest = INT32_MIN;
    for (int i = 0; i < count; i++) {
        int32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        int32_t number = in_order(bits);
        least = number < least ? number : least;
        greatest = number > greatest ? number : greatest;
    }
    least = in_order(least);
    greatest = in_order(greatest);
    memcpy(low, &least, sizeof *low);
    memcpy(high, &greatest, sizeof *high);
}

static bundle bundle_of(const zt_batch *r) {
    bundle b;
    range(&b.origins.low.x, &b.origins.high.x, r->ox, r->count);
    range(&b.origins.low.y, &b.origins.high.y, r->oy, r->count);
    range(&b.origins.low.z, &b.origins.high.z, r->oz, r->count);
    range(&b.directions.low.x, &b.directions.high.x, r->dx, r->count);
    range(&b.directions.low.y, &b.directions.high.y, r->dy, r->count);
    range(&b.directions.low.z, &b.directions.high.z, r->dz, r->count);
    return b;
}

/* Narrows the distances enter … leave to those at which some ray of a bundle may be between the
 * two sides of a box across one axis, by interval arithmetic: `near` and `far` are how long the
 * way there is at least and at most, `slow` and `fast` the share of it that a step goes. What
 * is no number narrows nothing. */
static void narrow(double *enter, double *leave, double near, double far, double slow,
                   double fast) {
    if (near > 0) *enter = fmax(*enter, fast <= 0 ? INFINITY : near / fast);
    if (far < 0) *enter = fmax(*enter, slow >= 0 ? INFINITY : far / slow);
    if (slow > 0) *leave = fmin(*leave, far / slow);
    if (fast < 0) *leave = fmin(*leave, near / fast);
}

/* False only where no ray of a bundle meets a box, which is grown by more than the roundings of
 * an intersection with what is within (Boulos, Wald and Shirley, "Geometric and arithmetic
 * culling methods for entire ray packets", 2006). */
static bool bundle_meets(const bundle *b, const zt_box *box) {
    const zt_box *o = &b->origins, *d = &b->directions;
    double room = (double)((zt_box_size(o) + zt_box_size(box)) * 32 * REAL_ROUNDING);
    double enter = 0, leave = INFINITY;
    narrow(&enter, &leave, (double)box->low.x - (double)o->high.x - room,
           (double)box->high.x - (double)o->low.x + room, (double)d->low.x, (double)d->high.x);
    narrow(&enter, &leave, (double)box->low.y - (double)o->high.y - room,
           (double)box->high.y - (double)o->low.y + room, (double)d->low.y, (double)d->high.y);
    narrow(&enter, &leave, (double)box->low.z - (double)o->high.z - room,
           (double)box->high.z - (double)o->low.z + room, (double)d->low.z, (double)d->high.z);
    return enter <= leave * (1 + 0x1p-40);
}

/* A loop for each kind of primitive. What is nearer by nothing leaves the earlier hit. */
#define DEFINE_LOOPS(kind)                                                                     \
    static void kind##_intersect(zt_batch *restrict rays, const zt_primitive *p,               \
                                 int32_t index, int count) {                                   \
        WIDE_LOOP for (int i = 0; i < count; i++) {                                            \
            real t = zt_##kind##_distance(p, rays->ox[i], rays->oy[i], rays->oz[i],            \
                                          rays->dx[i], rays->dy[i], rays->dz[i]);              \
            real nearest = rays->t[i];                                                         \
            int32_t hit = rays->hit[i];                                                        \
            rays->t[i] = t < nearest ? t : nearest;                                            \
            rays->hit[i] = t < nearest ? index : hit;                                          \
        }                                                                                      \
    }
DEFINE_LOOPS(plane)
DEFINE_LOOPS(sphere)
DEFINE_LOOPS(ellipsoid)
DEFINE_LOOPS(triangle)

static void intersect_analytic(zt_batch *rays, const bundle *b, const zt_tracer *tracer) {
    int count = zt_batch_padded(rays->count);
    for (int32_t index = 0; index < tracer->primitive_count; index++) {
        const zt_primitive *p = &tracer->primitives[index];
        /* Not ellipsoids: how far their roundings reach depends on how stretched they are. */
        bool bounded = p->kind == ZT_PRIMITIVE_SPHERE || p->kind == ZT_PRIMITIVE_TRIANGLE;
        if (bounded && !bundle_meets(b, &p->box)) continue;
        switch (p->kind) {
        case ZT_PRIMITIVE_PLANE:
            plane_intersect(rays, p, index, count);
            break;
        case ZT_PRIMITIVE_SPHERE:
            sphere_intersect(rays, p, index, count);
            break;
        case ZT_PRIMITIVE_ELLIPSOID:
            ellipsoid_intersect(rays, p, index, count);
            break;
        case ZT_PRIMITIVE_TRIANGLE:
            triangle_intersect(rays, p, index, count);
            break;
        case ZT_PRIMITIVE_MESH:
            break;
        }
    }
}

/* ZT_BATCH_LANES rays in the space of a hull: origins, one over directions, how far to look,
 * and how much room the boxes need for the roundings of all that. */
typedef struct lanes {
    alignas(64) real ox[ZT_BATCH_LANES];
    alignas(64) real oy[ZT_BATCH_LANES];
    alignas(64) real oz[ZT_BATCH_LANES];
    alignas(64) real kx[ZT_BATCH_LANES];
    alignas(64) real ky[ZT_BATCH_LANES];
    alignas(64) real kz[ZT_BATCH_LANES];
    alignas(64) real t[ZT_BATCH_LANES];
    alignas(64) real room[ZT_BATCH_LANES];
    alignas(64) int32_t meets[ZT_BATCH_LANES];
} lanes;

static void enter_hull(lanes *restrict l, const zt_batch *restrict rays, int first,
                       const zt_placed_hull *hull) {
    const real3 rx = hull->rows[0], ry = hull->rows[1], rz = hull->rows[2], at = hull->at;
    const real reach = hull->reach, size = hull->size;
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        real ox = rays->ox[first + j], oy = rays->oy[first + j], oz = rays->oz[first + j];
        real dx = rays->dx[first + j], dy = rays->dy[first + j], dz = rays->dz[first + j];
        l->ox[j] = real_dot(rx.x, rx.y, rx.z, ox, oy, oz) + at.x;
        l->oy[j] = real_dot(ry.x, ry.y, ry.z, ox, oy, oz) + at.y;
        l->oz[j] = real_dot(rz.x, rz.y, rz.z, ox, oy, oz) + at.z;
        l->kx[j] = 1 / real_dot(rx.x, rx.y, rx.z, dx, dy, dz);
        l->ky[j] = 1 / real_dot(ry.x, ry.y, ry.z, dx, dy, dz);
        l->kz[j] = 1 / real_dot(rz.x, rz.y, rz.z, dx, dy, dz);
        l->t[j] = rays->t[first + j];
        real largest = real_max(real_max(fabsf(ox), fabsf(oy)), fabsf(oz));
        l->room[j] = 32 * REAL_ROUNDING * (reach * largest + size);
    }
}

/* Adds to `meets` the rays that meet a box, grown by their room, before their t; a doubt (what
 * is no number compares as false) counts as meeting. Distances to the sides may each be off by
 * a few roundings (Ize, "Robust BVH ray traversal", JCGT 2(2), 2013). */
static inline void meet_box(lanes *restrict l, const zt_box box) {
    const real less = 1 - 16 * REAL_ROUNDING, more = 1 + 16 * REAL_ROUNDING;
    WIDE_LOOP for (int j = 0; j < ZT_BATCH_LANES; j++) {
        real room = l->room[j];
        real x0 = (box.low.x - room - l->ox[j]) * l->kx[j];
        real x1 = (box.high.x + room - l->ox[j]) * l->kx[j];
        real y0 = (box.low.y - room - l->oy[j]) * l->ky[j];
        real y1 = (box.high.y + room - l->oy[j]) * l->ky[j];
        real z0 = (box.low.z - room - l->oz[j]) * l->kz[j];
        real z1 = (box.high.z + room - l->oz[j]) * l->kz[j];
        real enter = real_max(real_max(real_min(x0, x1), real_min(y0, y1)), real_min(z0, z1));
        real leave = real_min(real_min(real_max(x0, x1), real_max(y0, y1)), real_max(z0, z1));
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
static void meet_halves(lanes *restrict l, const zt_box *boxes, int index, int level) {
    memset(l->meets, 0, sizeof l->meets);
    meet_box(l, boxes[index]);
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

/* Lists the rays that may meet a mesh before their t; `open_only` leaves out the ones that have
 * met something. */
static int list_mesh_rays(int32_t *restrict list, const zt_batch *restrict rays,
                          const bundle *bundle, const zt_tracer *tracer, bool open_only) {
    const zt_placed_hull *all, *hulls[ZT_HULLS_MAX];
    int all_count = zt_meshes_hulls(&all, tracer->meshes), hull_count = 0, count = 0;
    for (int h = 0; h < all_count; h++)
        if (bundle_meets(bundle, &all[h].around)) hulls[hull_count++] = &all[h];
    if (hull_count == 0) return 0;
    for (int first = 0; first < rays->count; first += ZT_BATCH_LANES) {
        int32_t meets[ZT_BATCH_LANES] = {0};
        for (int h = 0; h < hull_count; h++) {
            lanes l;
            enter_hull(&l, rays, first, hulls[h]);
            meet_halves(&l, hulls[h]->boxes, 1, hulls[h]->level);
            for (int j = 0; j < ZT_BATCH_LANES; j++) meets[j] |= l.meets[j];
        }
        for (int j = 0; j < ZT_BATCH_LANES && first + j < rays->count; j++) {
            list[count] = first + j;
            count += meets[j] & (!open_only | (rays->hit[first + j] < 0));
        }
    }
    return count;
}

void ZT_ISA_NAME(zt_intersect)(zt_batch *rays, const zt_tracer *tracer) {
    for (int i = 0; i < zt_batch_padded(rays->count); i++) {
        rays->t[i] = REAL_INFINITY;
        rays->hit[i] = -1;
    }
    bundle b = bundle_of(rays);
    intersect_analytic(rays, &b, tracer);
    if (!tracer->meshes) return;
    int32_t list[ZT_BATCH];
    int count = list_mesh_rays(list, rays, &b, tracer, false);
    zt_meshes_intersect(tracer->meshes, rays, list, count);
}

void ZT_ISA_NAME(zt_occlude)(zt_batch *rays, const zt_tracer *tracer) {
    bundle b = bundle_of(rays);
    intersect_analytic(rays, &b, tracer);
    if (!tracer->meshes) return;
    int32_t list[ZT_BATCH];
    int count = list_mesh_rays(list, rays, &b, tracer, true);
    zt_meshes_occlude(tracer->meshes, rays, list, count);
}
