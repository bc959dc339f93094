#include "tracer/hull.h"

static const zt_box empty_box = {{REAL_INFINITY, REAL_INFINITY, REAL_INFINITY},
                                 {-REAL_INFINITY, -REAL_INFINITY, -REAL_INFINITY}};

static void include(zt_box *box, real3 p) {
    box->low = (real3){fminf(box->low.x, p.x), fminf(box->low.y, p.y), fminf(box->low.z, p.z)};
    box->high =
        (real3){fmaxf(box->high.x, p.x), fmaxf(box->high.y, p.y), fmaxf(box->high.z, p.z)};
}

static const real3 *corner(const zt_mesh *mesh, int32_t triangle, int i) {
    return (const real3 *)(mesh->positions +
                           3 * (int64_t)mesh->triangles[3 * (int64_t)triangle + i]);
}

/* Three times the middle of a triangle along an axis (0, 1, 2). */
static real middle(const zt_mesh *mesh, int32_t triangle, int axis) {
    real sum = 0;
    for (int i = 0; i < 3; i++) {
        const real3 *p = corner(mesh, triangle, i);
        sum += axis == 0 ? p->x : axis == 1 ? p->y : p->z;
    }
    return sum;
}

/* The box of the triangles themselves, and of three times their middles. */
static void bound(zt_box *box, zt_box *middles, const zt_mesh *mesh, const int32_t *order,
                  int32_t count) {
    *box = *middles = empty_box;
    for (int32_t k = 0; k < count; k++) {
        for (int i = 0; i < 3; i++) include(box, *corner(mesh, order[k], i));
        include(middles, (real3){middle(mesh, order[k], 0), middle(mesh, order[k], 1),
                                 middle(mesh, order[k], 2)});
    }
}

/* Fills the box at `index` with the triangles order[0 .. count - 1], and those below it. */
static void split(zt_hull *hull, const zt_mesh *mesh, int32_t *order, int32_t count,
                  int index) {
    zt_box middles;
    bound(&hull->boxes[index], &middles, mesh, order, count);
    if (2 * index >= 1 << ZT_HULL_LEVELS) return;
    real x = middles.high.x - middles.low.x, y = middles.high.y - middles.low.y,
         z = middles.high.z - middles.low.z;
    int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    real low = axis == 0 ? middles.low.x : axis == 1 ? middles.low.y : middles.low.z;
    real high = axis == 0 ? middles.high.x : axis == 1 ? middles.high.y : middles.high.z;
    real cut = low + (high - low) / 2;
    int32_t left = 0;
    for (int32_t k = 0; k < count; k++) {
        int32_t triangle = order[k];
        if (!(middle(mesh, triangle, axis) < cut)) continue;
        order[k] = order[left];
        order[left++] = triangle;
    }
    split(hull, mesh, order, left, 2 * index);
    split(hull, mesh, order + left, count - left, 2 * index + 1);
}

void zt_hull_build(zt_hull *hull, const zt_mesh *mesh, int32_t *order) {
    for (int32_t i = 0; i < mesh->triangle_count; i++) order[i] = i;
    hull->boxes[0] = empty_box;
    split(hull, mesh, order, mesh->triangle_count, 1);
}
