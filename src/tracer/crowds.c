/* Rays against primitives that are too many to be asked one by one: a hierarchy over their
 * boxes tells which. Compiled once for each width of instructions and each precision. */
#include "tracer/crowds.h"

#include "tracer/look.h"
#include "tracer/search.h"

typedef struct crowd_search {
    zt_batch *rays;
    const zt_tracer *tracer;
    const zt_crowd *crowd;
    bool any;
    real begin[ZT_BATCH]; /* where, along each ray, the hierarchy's begins */
    zt_bvh_rays packed;
} crowd_search;

/* Some rays against one primitive of a crowd. Others of their group are asked as well, since it
 * costs nothing. */
static uint32_t visit_primitive(void *user, int32_t box, int first, uint32_t set) {
    crowd_search *c = user;
    zt_batch *rays = c->rays;
    int32_t index = c->crowd->primitives[box];
    const zt_primitive *p = &c->tracer->primitives[index];
    if (p->kind == ZT_PRIMITIVE_MESH)
        ZT_KERNEL_NAME(zt_search_mesh_lanes)(rays, c->tracer, index, first, set, c->any);
    else
        ZT_KERNEL_NAME(zt_meet_lanes)(rays, c->tracer, index, first, c->any);
    if (c->any)
        for (int i = first; i < first + ZT_BATCH_LANES; i++)
            c->packed.far[i] = rays->hit[i] >= 0 ? -1 : c->packed.far[i];
    else
        for (int i = first; i < first + ZT_BATCH_LANES; i++)
            c->packed.far[i] = (float)(rays->t[i] - c->begin[i]) * ZT_LOOK_FURTHER;
    return (1u << ZT_BATCH_LANES) - 1;
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

void ZT_KERNEL_NAME(zt_search_crowd)(zt_batch *rays, const zt_tracer *tracer,
                                     const zt_crowd *crowd, bool any) {
    crowd_search c;
    c.rays = rays;
    c.tracer = tracer;
    c.crowd = crowd;
    c.any = any;
    const zt_origins *from = rays->from;
    const real before = ZT_LOOK_BEFORE * zt_box_size(&crowd->box);
    c.packed.count = rays->count;
    for (int i = 0; i < rays->count; i++) {
        real ox = from->x[i], oy = from->y[i], oz = from->z[i];
        real dx = rays->dx[i], dy = rays->dy[i], dz = rays->dz[i];
        real begin = real_max(enter_box(&crowd->box, ox, oy, oz, dx, dy, dz) - before, 0);
        bool looks = !any || (rays->hit[i] < 0 && rays->t[i] > 0);
        c.begin[i] = begin;
        c.packed.ox[i] = (float)(ox + begin * dx);
        c.packed.oy[i] = (float)(oy + begin * dy);
        c.packed.oz[i] = (float)(oz + begin * dz);
        c.packed.dx[i] = (float)dx;
        c.packed.dy[i] = (float)dy;
        c.packed.dz[i] = (float)dz;
        c.packed.far[i] = looks ? (float)(rays->t[i] - begin) * ZT_LOOK_FURTHER : -1;
    }
    ZT_KERNEL_NAME(zt_bvh_look)(crowd->bvh, &c.packed, visit_primitive, &c);
}
