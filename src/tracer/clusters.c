/* Triangles are halved, and the halves again, where that costs a ray least: the sum of each
 * half's surface times its number of clusters (Goldsmith and Salmon, "Automatic creation of
 * object hierarchies for ray tracing", 1987), looked for at a few places along each axis (Wald,
 * "On fast construction of SAH-based bounding volume hierarchies", 2007). */
#include "tracer/clusters.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/pool.h"

enum {
    BINS = 16,
    DEPTH_MAX = 60,
    LATER_MAX = 256, /* parts that threads take, at most */
    AT_ONCE = 1024   /* clusters written by one task */
};

/* Four of each, so that a register holds them; the fourth means nothing. */
typedef struct box4 {
    alignas(16) float low[4], high[4];
} box4;

static const box4 empty_box = {{INFINITY, INFINITY, INFINITY, 0},
                               {-INFINITY, -INFINITY, -INFINITY, 0}};

typedef struct item {
    box4 box;
    int32_t triangle;
    int32_t leaf; /* how many, from here on, make a cluster; 0 within one */
} item;

typedef struct bin {
    box4 box;
    int32_t count;
} bin;

typedef struct cut {
    int axis, bin; /* what lies in bins up to this one goes to the left; axis -1: none */
    float low, scale;
} cut;

static inline float smaller(float a, float b) { return a < b ? a : b; }
static inline float larger(float a, float b) { return a > b ? a : b; }

static inline void include(box4 *box, const float *low, const float *high) {
    for (int i = 0; i < 4; i++) {
        box->low[i] = smaller(box->low[i], low[i]);
        box->high[i] = larger(box->high[i], high[i]);
    }
}

/* Half the surface. */
static float surface(const box4 *b) {
    float x = b->high[0] - b->low[0], y = b->high[1] - b->low[1], z = b->high[2] - b->low[2];
    return x * y + y * z + z * x;
}

static inline float middle(const item *it, int axis) {
    return it->box.low[axis] * 0.5f + it->box.high[axis] * 0.5f;
}

static inline int bin_of(float at, float low, float scale) {
    int index = (int)((at - low) * scale);
    return index < 0 ? 0 : index < BINS ? index : BINS - 1;
}

static float cluster_cost(const bin *b) {
    int32_t clusters = (b->count + ZT_CLUSTER - 1) / ZT_CLUSTER;
    return b->count ? surface(&b->box) * (float)clusters : 0;
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
    box4 middles = empty_box;
    for (int32_t k = 0; k < count; k++) {
        float at[4] = {middle(&items[k], 0), middle(&items[k], 1), middle(&items[k], 2), 0};
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
            include(&b->box, items[k].box.low, items[k].box.high);
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

/* Orders items so that clusters stand together, each marked where it begins. Ranges of up to
 * `enough` are put off: listed, to be split on any thread. */
typedef struct range {
    item *items;
    int32_t count, depth;
} range;

typedef struct work {
    range later[LATER_MAX];
    int later_count;
    zt_clusters *out;
    item *items;
    int32_t *starts; /* of each cluster */
    const float *positions;
    const uint32_t *triangles;
} work;

static void split(work *w, range r, int32_t enough) {
    while (r.count > ZT_CLUSTER) {
        if (r.count <= enough && w->later_count < LATER_MAX) {
            w->later[w->later_count++] = r;
            return;
        }
        cut at = find_cut(r.items, r.count);
        bool found = at.axis >= 0 && r.depth < DEPTH_MAX;
        int32_t left = found ? part(r.items, r.count, at) : r.count / 2;
        split(w, (range){r.items, left, r.depth + 1}, enough);
        r = (range){r.items + left, r.count - left, r.depth + 1};
    }
    if (r.count > 0) r.items->leaf = r.count;
}

static void split_range(void *user, int task, int worker) {
    (void)worker;
    work *w = user;
    split(w, w->later[task], 0);
}

static void put_cluster(const work *w, int32_t index) {
    const item *items = w->items + w->starts[index];
    zt_cluster *c = &w->out->clusters[index];
    box4 box = empty_box;
    for (int32_t k = 0; k < ZT_CLUSTER; k++) {
        const item *it = &items[k < items->leaf ? k : items->leaf - 1];
        const uint32_t *corners = w->triangles + 3 * (int64_t)it->triangle;
        c->triangles[k] = it->triangle;
        include(&box, it->box.low, it->box.high);
        for (int corner = 0; corner < 3; corner++)
            for (int axis = 0; axis < 3; axis++)
                c->corners[corner][axis][k] = w->positions[3 * (int64_t)corners[corner] + axis];
    }
    memcpy(w->out->boxes[index].low, box.low, sizeof w->out->boxes->low);
    memcpy(w->out->boxes[index].high, box.high, sizeof w->out->boxes->high);
}

static void put_some(void *user, int task, int worker) {
    (void)worker;
    work *w = user;
    int32_t end = w->out->count < (task + 1) * AT_ONCE ? w->out->count : (task + 1) * AT_ONCE;
    for (int32_t index = task * AT_ONCE; index < end; index++) put_cluster(w, index);
}

/* On several threads, where there are any. */
static void run(zt_pool *pool, int count, void (*task)(void *, int, int), work *w) {
    if (pool) zt_pool_run(pool, count, task, w);
    for (int i = 0; !pool && i < count; i++) task(w, i, 0);
}

static void bound_triangles(item *items, const float *positions, const uint32_t *triangles,
                            int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        items[i] = (item){.box = empty_box, .triangle = i};
        for (int corner = 0; corner < 3; corner++) {
            const float *p = positions + 3 * (int64_t)triangles[3 * (int64_t)i + corner];
            const float at[4] = {p[0], p[1], p[2], 0};
            include(&items[i].box, at, at);
        }
    }
}

zt_status zt_clusters_build(zt_clusters *out, const float *positions, const uint32_t *triangles,
                            int32_t triangle_count, zt_pool *pool) {
    *out = (zt_clusters){0};
    size_t count = (size_t)triangle_count;
    work w = {.out = out,
              .items = aligned_alloc(16, (count + 1) * sizeof *w.items),
              .starts = calloc(count + 1, sizeof *w.starts),
              .positions = positions,
              .triangles = triangles};
    if (w.items && w.starts) {
        bound_triangles(w.items, positions, triangles, triangle_count);
        split(&w, (range){w.items, triangle_count, 0}, triangle_count / 16);
        run(pool, w.later_count, split_range, &w);
        for (int32_t i = 0; i < triangle_count; i += w.items[i].leaf)
            w.starts[out->count++] = i;
        out->clusters = aligned_alloc(64, ((size_t)out->count + 1) * sizeof *out->clusters);
        out->boxes = malloc(((size_t)out->count + 1) * sizeof *out->boxes);
        if (out->clusters && out->boxes)
            run(pool, (out->count + AT_ONCE - 1) / AT_ONCE, put_some, &w);
    }
    free(w.items);
    free(w.starts);
    if (out->clusters && out->boxes) return ZT_OK;
    zt_clusters_free(out);
    return ZT_EMEMORY;
}

void zt_clusters_free(zt_clusters *clusters) {
    free(clusters->clusters);
    free(clusters->boxes);
    *clusters = (zt_clusters){0};
}
