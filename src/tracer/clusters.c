/* Triangles are halved, and the halves again, where that costs a ray least: the sum of each
 * half's surface times its number of clusters (Goldsmith and Salmon, "Automatic creation of
 * object hierarchies for ray tracing", 1987), looked for at a few places along each axis (Wald,
 * "On fast construction of SAH-based bounding volume hierarchies", 2007). */
#include "tracer/clusters.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

enum { BINS = 16, DEPTH_MAX = 60 };

/* A triangle's box; its middle times two is low + high. */
typedef struct item {
    float low[3], high[3];
    int32_t triangle;
} item;

static const zt_bvh_box empty_box = {{INFINITY, INFINITY, INFINITY},
                                     {-INFINITY, -INFINITY, -INFINITY}};

typedef struct bin {
    zt_bvh_box box;
    int32_t count;
} bin;

typedef struct cut {
    int axis, bin; /* what lies in bins up to this one goes to the left; axis -1: none */
    float low, scale;
} cut;

static inline float smaller(float a, float b) { return a < b ? a : b; }
static inline float larger(float a, float b) { return a > b ? a : b; }

static inline void include(zt_bvh_box *box, const float *low, const float *high) {
    for (int i = 0; i < 3; i++) {
        box->low[i] = smaller(box->low[i], low[i]);
        box->high[i] = larger(box->high[i], high[i]);
    }
}

/* Half the surface. */
static float surface(const zt_bvh_box *b) {
    float x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x * y + y * z + z * x;
}

static inline float middle(const item *it, int axis) {
    return it->low[axis] * 0.5f + it->high[axis] * 0.5f;
}

static inline int bin_of(float at, float low, float scale) {
    int index = (int)((at - low) * scale);
    return index < 0 ? 0 : index < BINS ? index : BINS - 1;
}

static float cluster_cost(const bin *b) {
    return b->count ? surface(&b->box) * (float)((b->count + ZT_CLUSTER - 1) / ZT_CLUSTER) : 0;
}

static void add(bin *to, const bin *b) {
    include(&to->box, b->box.low, b->box.high);
    to->count += b->count;
}

/* The best place along one axis, if it is better than `best`, what was found so far. */
static float best_cut(cut *out, const bin *bins, int axis, float low, float scale, float best) {
    float right_cost[BINS];
    bin side = {empty_box, 0};
    for (int i = BINS - 1; i > 0; i--) {
        add(&side, &bins[i]);
        right_cost[i] = cluster_cost(&side);
    }
    int32_t all = side.count + bins[0].count;
    side = (bin){empty_box, 0};
    for (int i = 0; i + 1 < BINS; i++) {
        add(&side, &bins[i]);
        float cost = cluster_cost(&side) + right_cost[i + 1];
        if (!(cost < best) || side.count == 0 || side.count == all) continue;
        best = cost;
        *out = (cut){axis, i, low, scale};
    }
    return best;
}

static cut find_cut(const item *items, int32_t count) {
    cut found = {.axis = -1};
    zt_bvh_box middles = empty_box;
    for (int32_t k = 0; k < count; k++) {
        float at[3] = {middle(&items[k], 0), middle(&items[k], 1), middle(&items[k], 2)};
        include(&middles, at, at);
    }
    bin bins[3][BINS];
    float scale[3];
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < BINS; i++) bins[axis][i] = (bin){empty_box, 0};
        scale[axis] = BINS * 0.9999f / (middles.high[axis] - middles.low[axis]);
        if (!(scale[axis] < INFINITY)) scale[axis] = 0; /* all in one place */
    }
    for (int32_t k = 0; k < count; k++)
        for (int axis = 0; axis < 3; axis++) {
            float at = middle(&items[k], axis);
            bin *b = &bins[axis][bin_of(at, middles.low[axis], scale[axis])];
            include(&b->box, items[k].low, items[k].high);
            b->count++;
        }
    float best = INFINITY;
    for (int axis = 0; axis < 3; axis++)
        best = best_cut(&found, bins[axis], axis, middles.low[axis], scale[axis], best);
    return found;
}

/* Brings those to the left of the cut to the front; returns their number. */
static int32_t part(item *items, int32_t count, cut at) {
    int32_t left = 0;
    for (int32_t right = count; left < right;) {
        if (bin_of(middle(&items[left], at.axis), at.low, at.scale) <= at.bin) {
            left++;
        } else {
            item other = items[--right];
            items[right] = items[left];
            items[left] = other;
        }
    }
    return left;
}

static void put_cluster(zt_clusters *out, const item *items, int32_t count,
                        const float *positions, const uint32_t *triangles) {
    zt_cluster *c = &out->clusters[out->count];
    zt_bvh_box *box = &out->boxes[out->count++];
    *box = empty_box;
    for (int32_t k = 0; k < ZT_CLUSTER; k++) {
        const item *it = &items[k < count ? k : count - 1];
        c->triangles[k] = it->triangle;
        include(box, it->low, it->high);
        for (int corner = 0; corner < 3; corner++) {
            const float *p =
                positions + 3 * (int64_t)triangles[3 * (int64_t)it->triangle + corner];
            for (int axis = 0; axis < 3; axis++) c->corners[corner][axis][k] = p[axis];
        }
    }
}

static void split(zt_clusters *out, item *items, int32_t count, const float *positions,
                  const uint32_t *triangles, int depth) {
    if (count <= ZT_CLUSTER) {
        if (count > 0) put_cluster(out, items, count, positions, triangles);
        return;
    }
    cut at = find_cut(items, count);
    int32_t left = at.axis >= 0 && depth < DEPTH_MAX ? part(items, count, at) : count / 2;
    split(out, items, left, positions, triangles, depth + 1);
    split(out, items + left, count - left, positions, triangles, depth + 1);
}

zt_status zt_clusters_build(zt_clusters *out, const float *positions, const uint32_t *triangles,
                            int32_t triangle_count) {
    *out = (zt_clusters){0};
    size_t count = (size_t)triangle_count;
    item *items = malloc(count * sizeof *items + 1);
    out->clusters = aligned_alloc(64, (count + 1) * sizeof *out->clusters);
    out->boxes = malloc((count + 1) * sizeof *out->boxes);
    bool room = items && out->clusters && out->boxes;
    for (int32_t i = 0; room && i < triangle_count; i++) {
        zt_bvh_box box = empty_box;
        for (int corner = 0; corner < 3; corner++) {
            const float *p = positions + 3 * (int64_t)triangles[3 * (int64_t)i + corner];
            include(&box, p, p);
        }
        for (int axis = 0; axis < 3; axis++) {
            items[i].low[axis] = box.low[axis];
            items[i].high[axis] = box.high[axis];
        }
        items[i].triangle = i;
    }
    if (room) split(out, items, triangle_count, positions, triangles, 0);
    free(items);
    if (!room) zt_clusters_free(out);
    return room ? ZT_OK : ZT_EMEMORY;
}

void zt_clusters_free(zt_clusters *clusters) {
    free(clusters->clusters);
    free(clusters->boxes);
    *clusters = (zt_clusters){0};
}
