#include "tracer/meshes.h"

#include <math.h>
#include <stdlib.h>

struct zt_meshes {
    int32_t mesh_count;
    zt_bvh_builder *builder;
    zt_built_mesh *built; /* one for each mesh */
    zt_bvh *crowd;
};

zt_status zt_meshes_open(zt_meshes **out, const zt_mesh *meshes, int32_t mesh_count,
                         int threads, zt_listener listener) {
    *out = NULL;
    zt_meshes *m = calloc(1, sizeof *m);
    if (!m) return ZT_EMEMORY;
    m->built = calloc((size_t)mesh_count + 1, sizeof *m->built);
    zt_status status = m->built ? zt_bvh_open(&m->builder, threads, listener) : ZT_EMEMORY;
    if (status != ZT_OK) {
        zt_meshes_close(&m);
        return status;
    }
    m->mesh_count = mesh_count;
    for (int32_t i = 0; i < mesh_count; i++) m->built[i].mesh = &meshes[i];
    *out = m;
    return ZT_OK;
}

void zt_meshes_close(zt_meshes **slot) {
    zt_meshes *m = *slot;
    if (!m) return;
    for (int32_t i = 0; i < m->mesh_count; i++) {
        zt_bvh_free(&m->built[i].triangles);
        zt_bvh_free(&m->built[i].boxes);
        free(m->built[i].triangle_boxes);
        free(m->built[i].hull);
    }
    zt_bvh_free(&m->crowd);
    zt_bvh_close(&m->builder);
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

/* The boxes are grown by the roundings of rays that are made single precision near the mesh. */
static zt_status build_boxes(zt_built_mesh *b, zt_bvh_builder *builder) {
    const zt_mesh *mesh = b->mesh;
    const zt_bvh_box *all = &b->hull->boxes[1];
    float room = 0;
    for (int axis = 0; axis < 3; axis++)
        room = fmaxf(room, fmaxf(fabsf(all->low[axis]), fabsf(all->high[axis])) * 0x1p-20f);
    b->triangle_boxes = malloc((size_t)mesh->triangle_count * sizeof *b->triangle_boxes + 1);
    if (!b->triangle_boxes) return ZT_EMEMORY;
    for (int32_t i = 0; i < mesh->triangle_count; i++) {
        zt_bvh_box *box = &b->triangle_boxes[i];
        for (int axis = 0; axis < 3; axis++) {
            float v[3];
            for (int k = 0; k < 3; k++)
                v[k] =
                    mesh->positions[3 * (int64_t)mesh->triangles[3 * (int64_t)i + k] + axis];
            box->low[axis] = fminf(v[0], fminf(v[1], v[2])) - room;
            box->high[axis] = fmaxf(v[0], fmaxf(v[1], v[2])) + room;
        }
    }
    return zt_bvh_of_boxes(&b->boxes, builder, b->triangle_boxes, mesh->triangle_count);
}

zt_status zt_meshes_build(const zt_built_mesh **built, zt_meshes *m, int32_t index,
                          bool boxes) {
    zt_built_mesh *b = &m->built[index];
    const zt_mesh *mesh = b->mesh;
    *built = b;
    if (!b->hull) ZT_TRY(build_hull(b));
    if (boxes) return b->boxes ? ZT_OK : build_boxes(b, m->builder);
    if (b->triangles) return ZT_OK;
    return zt_bvh_of_triangles(&b->triangles, m->builder, mesh->positions, mesh->vertex_count,
                               mesh->triangles, mesh->triangle_count);
}

zt_status zt_meshes_crowd(const zt_bvh **crowd, zt_meshes *m, const zt_bvh_box *boxes,
                          int32_t count) {
    ZT_TRY(zt_bvh_of_boxes(&m->crowd, m->builder, boxes, count));
    *crowd = m->crowd;
    return ZT_OK;
}
