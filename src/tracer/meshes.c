#include "tracer/meshes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include "base/bits.h"
#include "base/diag.h"

struct zt_meshes {
    int32_t mesh_count;
    zt_bvh_builder *builder;
    bool large;           /* there is a mesh that is worth several threads */
    zt_pool *pool;        /* those threads, or NULL */
    mtx_t building;       /* held while a mesh is built */
    zt_status status;     /* of that */
    zt_built_mesh *built; /* one for each mesh */
    zt_bvh *crowds[2];    /* of what does not stay; of what does */
    zt_bvh_box *stayed;   /* over which boxes the latter is */
    int32_t stayed_count;
};

zt_status zt_meshes_open(zt_meshes **out, const zt_mesh *meshes, int32_t mesh_count,
                         int threads, zt_listener listener) {
    *out = NULL;
    zt_meshes *m = calloc(1, sizeof *m);
    if (!m) return ZT_EMEMORY;
    if (mtx_init(&m->building, mtx_plain) != thrd_success) {
        free(m);
        return ZT_EMEMORY;
    }
    m->built = calloc((size_t)mesh_count + 1, sizeof *m->built);
    zt_status status = m->built ? zt_bvh_open(&m->builder, threads, listener) : ZT_EMEMORY;
    if (status != ZT_OK) {
        zt_meshes_close(&m);
        return status;
    }
    m->mesh_count = mesh_count;
    for (int32_t i = 0; i < mesh_count; i++) {
        m->built[i].mesh = &meshes[i];
        m->large |= meshes[i].triangle_count >= ZT_CLUSTERS_MANY;
    }
    *out = m;
    return ZT_OK;
}

void zt_meshes_close(zt_meshes **slot) {
    zt_meshes *m = *slot;
    if (!m) return;
    for (int32_t i = 0; m->built && i < m->mesh_count; i++) {
        zt_bvh_free(&m->built[i].bvh);
        zt_clusters_free(&m->built[i].clusters);
        free(m->built[i].hull);
    }
    for (int i = 0; i < 2; i++) zt_bvh_free(&m->crowds[i]);
    free(m->stayed);
    zt_bvh_close(&m->builder);
    zt_pool_close(&m->pool);
    mtx_destroy(&m->building);
    free(m->built);
    free(m);
    *slot = NULL;
}

static zt_status build_hull(zt_built_mesh *b) {
    int32_t *order = malloc((size_t)b->mesh->triangle_count * sizeof *order + 1);
    b->hull = malloc(sizeof *b->hull);
    bool room = order && b->hull;
    if (room) zt_hull_build(b->hull, b->mesh, order);
    free(order);
    return room ? ZT_OK : ZT_EMEMORY;
}

/* The boxes are grown by the roundings, in single precision, of rays that begin near the mesh
 * and of their intersection with what is within. */
static zt_status build_bvh(zt_built_mesh *b, zt_bvh_builder *builder, zt_pool *pool) {
    const zt_mesh *mesh = b->mesh;
    ZT_TRY(zt_clusters_build(&b->clusters, mesh->positions, mesh->triangles,
                             mesh->triangle_count, pool));
    const zt_bvh_box *all = &b->hull->boxes[1];
    float size = 0;
    for (int axis = 0; axis < 3; axis++)
        size = fmaxf(size, fmaxf(fabsf(all->low[axis]), fabsf(all->high[axis])));
    for (int32_t i = 0; i < b->clusters.count; i++)
        for (int axis = 0; axis < 3; axis++) {
            b->clusters.boxes[i].low[axis] -= size * 0x1p-19f;
            b->clusters.boxes[i].high[axis] += size * 0x1p-19f;
        }
    return zt_bvh_of_boxes(&b->bvh, builder, b->clusters.boxes, b->clusters.count);
}

/* Without an origin, its bounds are the numbers of its positions. */
static zt_bvh_box box_around(const zt_mesh *mesh) {
    const double low[] = {mesh->low.x, mesh->low.y, mesh->low.z},
                 high[] = {mesh->high.x, mesh->high.y, mesh->high.z},
                 origin[] = {mesh->origin.x, mesh->origin.y, mesh->origin.z};
    zt_bvh_box box;
    for (int i = 0; i < 3; i++) {
        double room = origin[i] == 0 ? 0 : 0x1p-50 * fmax(fabs(low[i]), fabs(high[i]));
        box.low[i] = nextafterf((float)(low[i] - origin[i] - room), -INFINITY);
        box.high[i] = nextafterf((float)(high[i] - origin[i] + room), INFINITY);
    }
    return box;
}

zt_status zt_meshes_start(zt_meshes *m) {
    const int threads = zt_bvh_threads(m->builder);
    ZT_TRY(zt_bvh_start(m->builder));
    /* Without the threads it takes longer. */
    if (!m->pool && threads > 1 && m->large) (void)zt_pool_open(&m->pool, threads);
    return ZT_OK;
}

zt_status zt_meshes_begin(zt_built_mesh **built, zt_meshes *m, int32_t index) {
    zt_built_mesh *b = *built = &m->built[index];
    if (b->owner) return ZT_OK;
    ZT_TRY(zt_meshes_start(m));
    b->content = zt_mesh_content(b->mesh);
    b->around = box_around(b->mesh);
    b->owner = m;
    return ZT_OK;
}

bool zt_meshes_build(zt_built_mesh *b) {
    zt_meshes *m = b->owner;
    mtx_lock(&m->building);
    if (m->status == ZT_OK && !zt_mesh_is_built(b)) {
        m->status = build_hull(b);
        if (m->status == ZT_OK) m->status = build_bvh(b, m->builder, m->pool);
        atomic_store_explicit(&b->built, m->status == ZT_OK, memory_order_release);
    }
    mtx_unlock(&m->building);
    return zt_mesh_is_built(b);
}

bool zt_meshes_met(const zt_meshes *m, int32_t mesh) {
    return zt_mesh_is_built(&m->built[mesh]);
}

zt_status zt_meshes_status(const zt_meshes *m) { return m->status; }

zt_status zt_meshes_crowd(const zt_bvh **crowd, zt_meshes *m, bool stays,
                          const zt_bvh_box *boxes, int32_t count) {
    const size_t size = (size_t)count * sizeof *boxes;
    const bool same = stays && m->crowds[1] && m->stayed_count == count &&
                      zt_bits_equal(m->stayed, boxes, size);
    if (!same) ZT_TRY(zt_bvh_of_boxes(&m->crowds[stays], m->builder, boxes, count));
    *crowd = m->crowds[stays];
    if (same || !stays) return ZT_OK;
    zt_bvh_box *stayed = realloc(m->stayed, size);
    m->stayed_count = stayed ? count : 0;
    if (!stayed) return ZT_EMEMORY;
    m->stayed = stayed;
    memcpy(stayed, boxes, size);
    return ZT_OK;
}
