#include "tracer/hull.h"

#include <math.h>

static const zt_bvh_box empty_box = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};

static const float *corner(const zt_mesh *mesh, int32_t triangle, int i) {
    return mesh->positions + 3 * (int64_t)mesh->triangles[3 * (int64_t)triangle + i];
}

/* Three times the middle of a triangle along an axis. */
static float middle(const zt_mesh *mesh, int32_t triangle, int axis) {
    return corner(mesh, triangle, 0)[axis] + corner(mesh, triangle, 1)[axis] +
           corner(mesh, triangle, 2)[axis];
}

static float less(float a, float b) { return a < b ? a : b; }
static float more(float a, float b) { return a > b ? a : b; }

/* The box of the triangles themselves, and of three times their middles. */
static void bound(zt_bvh_box *box, zt_bvh_box *middles, const zt_mesh *mesh,
                  const int32_t *order, int32_t count) {
    *box = *middles = empty_box;
    for (int32_t k = 0; k < count; k++)
        for (int axis = 0; axis < 3; axis++) {
            float a = corner(mesh, order[k], 0)[axis], b = corner(mesh, order[k], 1)[axis],
                  c = corner(mesh, order[k], 2)[axis], sum = a + b + c;
            box->low[axis] = less(box->low[axis], less(a, less(b, c)));
            box->high[axis] = more(box->high[axis], more(a, more(b, c)));
            middles->low[axis] = less(middles->low[axis], sum);
            middles->high[axis] = more(middles->high[axis], sum);
        }
}

/* Fills the box at `index` with the triangles order[0 .. count - 1], and those below it. */
static void split(zt_hull *hull, const zt_mesh *mesh, int32_t *order, int32_t count,
                  int index) {
    zt_bvh_box middles;
    bound(&hull->boxes[index], &middles, mesh, order, count);
    if (2 * index >= 1 << ZT_HULL_LEVELS) return;
    int axis = 0;
    for (int i = 1; i < 3; i++)
        if (middles.high[i] - middles.low[i] > middles.high[axis] - middles.low[axis]) axis = i;
    float cut = middles.low[axis] + (middles.high[axis] - middles.low[axis]) / 2;
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
