/* Looking into a hierarchy: sixteen rays go through it together (Wald, Slusallek, Benthin and
 * Wagner, "Interactive rendering with coherent ray tracing", 2001). Compiled once for each
 * width of instructions; what is met does not depend on it, so that products and sums may be
 * fused.
 *
 * All is done in the hierarchy's own space, where directions are scaled by powers of two so
 * that their largest component is between 1 and 2. Origins further away are moved along their
 * rays to about where these come near, so that all are within 8, or else the ray is of no
 * concern. A distance t to a side at b from the origin o, worked out as b / d - o / d, is then
 * off by what moving the side by (|b| + |o|) 2^-22 is at most, that is, less than what boxes
 * are grown by (tracer/embree.c). Components below 1e-18 are taken for that, which over the
 * little way that is left is less still. */
#include "tracer/look.h"

#include <math.h>
#include <stdalign.h>
#include <stdbool.h>
#include <string.h>
#if defined __AVX2__
#include <immintrin.h>
#endif

#include "tracer/embree.h"

/* Moved origins are so much of a ray's t before the point nearest to the center, and within so
 * much of the center for rays that can touch boxes: these are within sqrt(3) of it, a t of 1 is
 * sqrt(12) at most; and then no t is as large as the last. */
#define BEFORE 2
#define REACH  8
#define FAR    64
/* How much further than asked is looked, for the roundings of far itself. */
#define FURTHER (1 + 0x1p-20)
#define LEAST   1e-18f

/* A node that is left has one child more on the stack than it took from there, but the one that
 * is next; and one place is written in vain. */
enum { LANES = ZT_BVH_LANES, STACK = ZT_BVH_DEPTH * (ZT_BVH_CHILDREN - 1) + 2 };

/* Rays: one over their directions, and the origins times that. */
typedef struct group {
    alignas(64) float kx[LANES];
    alignas(64) float ky[LANES];
    alignas(64) float kz[LANES];
    alignas(64) float ox[LANES];
    alignas(64) float oy[LANES];
    alignas(64) float oz[LANES];
    alignas(64) float far[LANES]; /* negative: looks nowhere */
    /* From a ray's far to this one: times `stretch` less `moved`. */
    alignas(64) double stretch[LANES];
    alignas(64) double moved[LANES];
    bool alike;       /* all directions have the same signs */
    bool backward[3]; /* and these: along each axis; or those of some ray */
} group;

/* Rays of a group on their way into a child, and where each enters it. */
typedef struct entry {
    alignas(64) float enter[LANES];
    uintptr_t child;
    uint32_t lanes;
} entry;

static inline float larger(float a, float b) { return a > b ? a : b; }
static inline float smaller(float a, float b) { return a < b ? a : b; }

/* A bit for each lane where a is no more than b. */
static inline uint32_t no_more(const float *restrict a, const float *restrict b) {
#if defined __AVX512F__
    return _mm512_cmp_ps_mask(_mm512_load_ps(a), _mm512_load_ps(b), _CMP_LE_OQ);
#elif defined __AVX2__
    __m256 low = _mm256_cmp_ps(_mm256_load_ps(a), _mm256_load_ps(b), _CMP_LE_OQ);
    __m256 high = _mm256_cmp_ps(_mm256_load_ps(a + 8), _mm256_load_ps(b + 8), _CMP_LE_OQ);
    return (uint32_t)_mm256_movemask_ps(low) | (uint32_t)_mm256_movemask_ps(high) << 8;
#else
    uint32_t lanes = 0;
    for (int l = 0; l < LANES; l++) lanes |= (uint32_t)(a[l] <= b[l]) << l;
    return lanes;
#endif
}

/* ---- rays -----------------------------------------------------------------------------------
 */

/* The power of two that is the exponent of an ordinary number, and its inverse. */
static inline void exponent_of(float *power, float *inverse, float a) {
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    bits &= 0x7f800000u;
    memcpy(power, &bits, sizeof bits);
    bits = 0x7f000000u - bits;
    memcpy(inverse, &bits, sizeof bits);
}

static inline float inverse(float d) {
    float least = d < 0 ? -LEAST : LEAST;
    return 1 / (fabsf(d) < LEAST ? least : d);
}

/* Fills a group with the rays from `first` on. */
static void load(group *restrict g, const zt_bvh_rays *restrict rays, int first,
                 const zt_bvh *restrict h) {
    const double cx = h->center[0], cy = h->center[1], cz = h->center[2], scale = h->scale;
    const int count = rays->count - first;
    WIDE_LOOP for (int lane = 0; lane < LANES; lane++) {
        int i = first + lane;
        float dx = rays->dx[i], dy = rays->dy[i], dz = rays->dz[i];
        float length, shrink;
        exponent_of(&length, &shrink, larger(larger(fabsf(dx), fabsf(dy)), fabsf(dz)));
        double far = (double)rays->far[i], stretch = (double)length * scale * FURTHER;
        double ox = ((double)rays->ox[i] - cx) * scale, wx = (double)(dx * shrink);
        double oy = ((double)rays->oy[i] - cy) * scale, wy = (double)(dy * shrink);
        double oz = ((double)rays->oz[i] - cz) * scale, wz = (double)(dz * shrink);
        double nearest = -(ox * wx + oy * wy + oz * wz) / (wx * wx + wy * wy + wz * wz);
        double moved = nearest > BEFORE ? nearest - BEFORE : 0;
        float x = (float)(ox + moved * wx), left = (float)(far * stretch - moved);
        float y = (float)(oy + moved * wy), z = (float)(oz + moved * wz);
        float kx = inverse(dx * shrink), ky = inverse(dy * shrink), kz = inverse(dz * shrink);
        g->kx[lane] = kx;
        g->ky[lane] = ky;
        g->kz[lane] = kz;
        g->ox[lane] = x * kx;
        g->oy[lane] = y * ky;
        g->oz[lane] = z * kz;
        g->stretch[lane] = stretch;
        g->moved[lane] = moved;
        /* Also false where a number is not finite. */
        bool near = (fabsf(x) <= REACH) & (fabsf(y) <= REACH) & (fabsf(z) <= REACH);
        bool looks =
            (lane < count) & near & (far > 0) & (left > 0) & (length > 0) & (shrink > 0);
        g->far[lane] = looks ? smaller(left, FAR) : -INFINITY;
    }
}

/* Finds the rays that look anywhere, and what their directions have in common. */
static uint32_t face(group *g) {
    static const alignas(64) float zeros[LANES];
    const uint32_t looking = no_more(zeros, g->far);
    const float *const k[3] = {g->kx, g->ky, g->kz};
    g->alike = true;
    for (int axis = 0; axis < 3; axis++) {
        uint32_t back = no_more(k[axis], zeros) & looking;
        g->backward[axis] = back != 0;
        g->alike &= back == 0 || back == looking;
    }
    return looking;
}

/* ---- nodes ----------------------------------------------------------------------------------
 */

/* Which rays of a group enter child number c. Where their directions have the same signs, the
 * sides that they come to first are the same. */
static inline uint32_t enter_alike(float *restrict enter, const group *restrict g,
                                   const zt_bvh_node *restrict n, int c) {
    const bool x = g->backward[0], y = g->backward[1], z = g->backward[2];
    const float x0 = n->sides[x][0][c], y0 = n->sides[y][1][c], z0 = n->sides[z][2][c];
    const float x1 = n->sides[!x][0][c], y1 = n->sides[!y][1][c], z1 = n->sides[!z][2][c];
    alignas(64) float leave[LANES];
    WIDE_LOOP for (int l = 0; l < LANES; l++) {
        float ex = x0 * g->kx[l] - g->ox[l], lx = x1 * g->kx[l] - g->ox[l];
        float ey = y0 * g->ky[l] - g->oy[l], ly = y1 * g->ky[l] - g->oy[l];
        float ez = z0 * g->kz[l] - g->oz[l], lz = z1 * g->kz[l] - g->oz[l];
        enter[l] = larger(larger(ex, ey), larger(ez, 0));
        leave[l] = smaller(smaller(lx, ly), smaller(lz, g->far[l]));
    }
    return no_more(enter, leave);
}

static inline uint32_t enter_anyhow(float *restrict enter, const group *restrict g,
                                    const zt_bvh_node *restrict n, int c) {
    const float x = n->sides[0][0][c], y = n->sides[0][1][c], z = n->sides[0][2][c];
    const float xx = n->sides[1][0][c], yy = n->sides[1][1][c], zz = n->sides[1][2][c];
    alignas(64) float leave[LANES];
    WIDE_LOOP for (int l = 0; l < LANES; l++) {
        float x0 = x * g->kx[l] - g->ox[l], x1 = xx * g->kx[l] - g->ox[l];
        float y0 = y * g->ky[l] - g->oy[l], y1 = yy * g->ky[l] - g->oy[l];
        float z0 = z * g->kz[l] - g->oz[l], z1 = zz * g->kz[l] - g->oz[l];
        float ex = smaller(x0, x1), ey = smaller(y0, y1), ez = smaller(z0, z1);
        float lx = larger(x0, x1), ly = larger(y0, y1), lz = larger(z0, z1);
        enter[l] = larger(larger(ex, ey), larger(ez, 0));
        leave[l] = smaller(smaller(lx, ly), smaller(lz, g->far[l]));
    }
    return no_more(enter, leave);
}

/* Puts the children of a node that are entered on the stack, the nearest about last: without a
 * branch, as none could be foretold. Returns the new top. */
static inline int enter_node(entry *stack, int top, const group *g, const zt_bvh_node *n,
                             uint32_t lanes, bool alike) {
    const int flip = g->backward[n->axis] ? 0 : ZT_BVH_CHILDREN - 1;
    for (int k = 0; k < ZT_BVH_CHILDREN; k++) {
        entry *e = &stack[top];
        int c = n->order[k ^ flip];
        uint32_t some =
            alike ? enter_alike(e->enter, g, n, c) : enter_anyhow(e->enter, g, n, c);
        e->lanes = some & lanes;
        e->child = n->children[c];
        top += e->lanes != 0;
    }
    return top;
}

/* Has some rays of a group visit a box, and learns what that made of their far. */
static inline void visit_box(group *restrict g, zt_bvh_rays *rays, int first, int32_t box,
                             uint32_t lanes, zt_bvh_visit *visit, void *user) {
    const uint32_t nearer = visit(user, box, first, lanes);
    if (!nearer) return;
    WIDE_LOOP for (int l = 0; l < LANES; l++) {
        float far = rays->far[first + l];
        float left = smaller((float)((double)far * g->stretch[l] - g->moved[l]), FAR);
        left = far > 0 ? left : -INFINITY;
        g->far[l] = (nearer >> l & 1) ? left : g->far[l];
    }
}

void ZT_KERNEL_NAME(zt_bvh_look)(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_visit *visit,
                                 void *user) {
    group g;
    entry stack[STACK];
    for (int first = 0; bvh->root && first < rays->count; first += LANES) {
        load(&g, rays, first, bvh);
        stack[0] = (entry){.child = bvh->root, .lanes = face(&g)};
        for (int top = 1; top > 0;) {
            const entry *e = &stack[--top];
            const uintptr_t child = e->child;
            const uint32_t lanes = e->lanes & no_more(e->enter, g.far);
            if (!lanes) continue;
            const zt_bvh_node *n = (const zt_bvh_node *)child; /* NOLINT(*int-to-ptr) */
            if (child & 1)
                visit_box(&g, rays, first, zt_bvh_leaf_box(child), lanes, visit, user);
            else if (g.alike)
                top = enter_node(stack, top, &g, n, lanes, true);
            else
                top = enter_node(stack, top, &g, n, lanes, false);
        }
    }
}
