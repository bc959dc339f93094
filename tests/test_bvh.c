/* Shows that looking into a hierarchy passes by no box that a ray touches, however odd the two
 * are; that what visitors say about rays is followed; and that rays at the very corners and
 * edges of closed meshes all meet a triangle, the same one whatever the hierarchy is like.
 * ZT_TEST_RAYS=100000000 aims that many rays at corners and edges instead of ten million. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "draw.h"
#include "tracer/bvh.h"
#include "tracer/clusters.h"
#include "tracer/triangles.h"

enum { BOXES_MAX = 300 };

static zt_bvh_builder *builder;

/* Looking as each width of instructions that this machine has does it. */
zt_bvh_look zt_bvh_look_single_scalar, zt_bvh_look_single_base;
#if defined __x86_64__
zt_bvh_look zt_bvh_look_single_avx2, zt_bvh_look_single_avx512;
#endif
static zt_bvh_look *looks[4];
static int look_count, next_look;

static void find_looks(void) {
    looks[look_count++] = zt_bvh_look_single_scalar;
    looks[look_count++] = zt_bvh_look_single_base;
#if defined __x86_64__
    if (__builtin_cpu_supports("avx2")) looks[look_count++] = zt_bvh_look_single_avx2;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
        looks[look_count++] = zt_bvh_look_single_avx512;
#endif
}

/* One width after the other. */
static void look(const zt_bvh *bvh, zt_bvh_rays *rays, zt_bvh_visit *visit, void *user) {
    looks[next_look++ % look_count](bvh, rays, visit, user);
}

static int open_builder(void **state) {
    (void)state;
    find_looks();
    return zt_bvh_open(&builder, 0, (zt_listener){0}) == ZT_OK ? 0 : -1;
}

static int close_builder(void **state) {
    (void)state;
    zt_bvh_close(&builder);
    return builder != NULL;
}

/* Boxes, rays, and which have been brought together. */
typedef struct meeting {
    zt_bvh_box boxes[BOXES_MAX];
    int32_t box_count;
    zt_bvh_rays rays;
    uint8_t visited[BOXES_MAX][ZT_BVH_RAYS];
    int visits, mistakes;
    bool finished[ZT_BVH_RAYS];
} meeting;

static uint32_t note_visit(void *user, int32_t box, int first, uint32_t lanes) {
    meeting *m = user;
    bool good = box >= 0 && box < m->box_count && first % ZT_BVH_LANES == 0 && lanes != 0 &&
                lanes >> ZT_BVH_LANES == 0;
    if (!good) m->mistakes++;
    for (int lane = 0; good && lane < ZT_BVH_LANES; lane++) {
        if (!(lanes >> lane & 1)) continue;
        if (first + lane >= m->rays.count || m->finished[first + lane]) m->mistakes++;
        m->visited[box][first + lane] = 1;
        m->visits++;
    }
    return 0;
}

/* Where ray i enters a box, with 64 bits; infinite where it does not before its far. What the
 * roundings of these let through or not is far less than what looking allows for. */
static long double entry(const zt_bvh_rays *r, int i, const zt_bvh_box *box) {
    const float o[3] = {r->ox[i], r->oy[i], r->oz[i]}, d[3] = {r->dx[i], r->dy[i], r->dz[i]};
    long double enters = 0, leaves = (long double)r->far[i];
    for (int axis = 0; axis < 3; axis++) {
        long double low = (long double)box->low[axis] - (long double)o[axis];
        long double high = (long double)box->high[axis] - (long double)o[axis];
        if (d[axis] == 0) {
            if (low > 0 || high < 0) return INFINITY;
            continue;
        }
        long double a = low / (long double)d[axis], b = high / (long double)d[axis];
        enters = fmaxl(enters, fminl(a, b));
        leaves = fminl(leaves, fmaxl(a, b));
    }
    return enters <= leaves ? enters : INFINITY;
}

static float pick(draw *d, float low, float high) { return draw_below(d, 2) ? low : high; }

/* Boxes of all sizes within `size`, here or far away, some of them flat, or of no size at all.
 */
static void draw_boxes(meeting *m, draw *d, int32_t count, double size) {
    m->box_count = count;
    double shift = draw_below(d, 4) ? 0 : size * draw_magnitude(d, 1, 1e5);
    for (int32_t k = 0; k < count; k++) {
        double half = size * draw_magnitude(d, 1e-7, .5);
        for (int axis = 0; axis < 3; axis++) {
            double middle = shift + draw_between(d, -size, size);
            if (draw_below(d, 8) == 0) middle = shift;
            double reach = draw_below(d, 5) ? half * draw_unit(d) : 0;
            m->boxes[k].low[axis] = (float)(middle - reach);
            m->boxes[k].high[axis] = (float)(middle + reach);
        }
    }
}

/* A ray that has to do with a box: it begins within it, on it or outside, and aims at its
 * inside, a face, an edge or a corner; directions may have zeros or next to nothing in them. */
static void draw_ray(meeting *m, draw *d, int i, double size) {
    const zt_bvh_box *box = &m->boxes[draw_below(d, m->box_count)];
    const zt_bvh_box *other = &m->boxes[draw_below(d, m->box_count)];
    float o[3], way[3];
    bool on = draw_below(d, 4) == 0;
    double away = draw_below(d, 4) ? 1 : draw_magnitude(d, 1, 0x1p18);
    for (int axis = 0; axis < 3; axis++) {
        float low = box->low[axis], high = box->high[axis];
        o[axis] = (float)(draw_between(d, -2, 2) * size * away);
        if (on) o[axis] = pick(d, other->low[axis], other->high[axis]);
        float to = draw_below(d, 3) ? pick(d, low, high)
                                    : (float)draw_between(d, (double)low, (double)high);
        way[axis] = to - o[axis];
    }
    if (draw_below(d, 3) == 0) {
        int axis = draw_below(d, 3); /* nearly or wholly along a plane of the box */
        o[axis] = pick(d, box->low[axis], box->high[axis]);
        way[axis] = draw_below(d, 2) ? 0 : (float)(size * draw_magnitude(d, 1e-30, 1e-10));
        if (draw_below(d, 2)) {
            axis = (axis + 1) % 3; /* and an axis */
            o[axis] = pick(d, box->low[axis], box->high[axis]);
            way[axis] = 0;
        }
    }
    double length = hypot(hypot((double)way[0], (double)way[1]), (double)way[2]);
    if (!(length > 0)) way[0] = 1, length = 1;
    double to_length = draw_below(d, 2) ? 1 / length : draw_magnitude(d, 1e-20, 1e20) / length;
    m->rays.ox[i] = o[0], m->rays.oy[i] = o[1], m->rays.oz[i] = o[2];
    m->rays.dx[i] = (float)((double)way[0] * to_length);
    m->rays.dy[i] = (float)((double)way[1] * to_length);
    m->rays.dz[i] = (float)((double)way[2] * to_length);
    m->rays.far[i] = draw_below(d, 2) ? INFINITY : (float)(draw_between(d, .01, 3) / to_length);
}

static void draw_rays(meeting *m, draw *d, double size) {
    m->rays.count = ZT_BVH_RAYS - draw_below(d, 40);
    for (int i = 0; i < ZT_BVH_RAYS; i++) draw_ray(m, d, i, size);
}

/* Whether a ray begins where something is promised about it. */
static bool is_near(const meeting *m, int i) {
    const float o[3] = {m->rays.ox[i], m->rays.oy[i], m->rays.oz[i]};
    double furthest = 0, size = 0;
    for (int axis = 0; axis < 3; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t k = 0; k < m->box_count; k++) {
            low = fmin(low, (double)m->boxes[k].low[axis]);
            high = fmax(high, (double)m->boxes[k].high[axis]);
        }
        size = fmax(size, fmax(high - low, 0x1p-24 * fabs(high + low)));
        furthest = fmax(furthest, fabs((double)o[axis] - (low + high) / 2));
    }
    return furthest <= 0x1p26 * size;
}

static void no_box_is_passed_by(void **state) {
    (void)state;
    static meeting m;
    draw d = {.key = 1};
    int64_t pairs = 0, touched = 0, visited = 0, missed = 0;
    zt_bvh *bvh = NULL;
    for (int round = 0; round < 2000; round++) {
        double size = draw_below(&d, 2) ? 1 : draw_magnitude(&d, 1e-30, 1e30);
        draw_boxes(&m, &d, 1 + draw_below(&d, draw_below(&d, 2) ? 5 : BOXES_MAX), size);
        draw_rays(&m, &d, size);
        assert_int_equal(zt_bvh_of_boxes(&bvh, builder, m.boxes, m.box_count), ZT_OK);
        memset(m.visited, 0, sizeof m.visited);
        look(bvh, &m.rays, note_visit, &m);
        pairs += (int64_t)m.box_count * m.rays.count;
        bool near[ZT_BVH_RAYS];
        for (int i = 0; i < m.rays.count; i++) near[i] = is_near(&m, i);
        for (int32_t k = 0; k < m.box_count; k++)
            for (int i = 0; i < m.rays.count; i++) {
                bool touches =
                    m.rays.far[i] > 0 && near[i] && entry(&m.rays, i, &m.boxes[k]) < INFINITY;
                touched += touches;
                visited += m.visited[k][i];
                missed += touches && !m.visited[k][i];
            }
    }
    print_message("%lld rays and boxes: %lld touch, %lld visited, %lld missed\n",
                  (long long)pairs, (long long)touched, (long long)visited, (long long)missed);
    assert_int_equal(missed, 0);
    assert_int_equal(m.mistakes, 0);
    assert_true(touched > 100000);
    assert_true(visited < pairs / 10); /* it is not all of them that are visited */
    zt_bvh_free(&bvh);
    assert_null(bvh);
}

/* The nearest box, found by a visitor that shortens the rays. */
typedef struct search {
    meeting *m;
    long double nearest[ZT_BVH_RAYS];
} search;

static uint32_t shorten(void *user, int32_t box, int first, uint32_t lanes) {
    const uint32_t all = lanes;
    search *s = user;
    for (int i = first; lanes; i++, lanes >>= 1) {
        if (!(lanes & 1)) continue;
        long double at = entry(&s->m->rays, i, &s->m->boxes[box]);
        if (at < s->nearest[i]) {
            s->nearest[i] = at;
            s->m->rays.far[i] = (float)at;
        }
        s->m->visits++;
    }
    return all;
}

static void rays_that_are_shortened_find_the_nearest(void **state) {
    (void)state;
    static meeting m;
    static search s;
    draw d = {.key = 2};
    int visits = 0, pairs = 0;
    zt_bvh *bvh = NULL;
    for (int round = 0; round < 100; round++) {
        draw_boxes(&m, &d, BOXES_MAX, 1);
        draw_rays(&m, &d, 1);
        assert_int_equal(zt_bvh_of_boxes(&bvh, builder, m.boxes, m.box_count), ZT_OK);
        long double expected[ZT_BVH_RAYS];
        for (int i = 0; i < m.rays.count; i++) {
            expected[i] = s.nearest[i] = INFINITY;
            if (!(m.rays.far[i] > 0)) continue;
            for (int32_t k = 0; k < m.box_count; k++) {
                long double at = entry(&m.rays, i, &m.boxes[k]);
                if (at < expected[i]) expected[i] = at;
            }
        }
        s.m = &m;
        m.visits = 0;
        look(bvh, &m.rays, shorten, &s);
        for (int i = 0; i < m.rays.count; i++)
            assert_true((float)s.nearest[i] == (float)expected[i]);
        visits += m.visits;
        pairs += m.rays.count * m.box_count;
    }
    print_message("nearest: %.1f of %d boxes visited for each ray\n",
                  (double)visits / pairs * BOXES_MAX, BOXES_MAX);
    assert_true(visits < pairs / 4);
    zt_bvh_free(&bvh);
}

static uint32_t finish(void *user, int32_t box, int first, uint32_t lanes) {
    const uint32_t all = lanes;
    meeting *m = user;
    note_visit(user, box, first, lanes);
    for (int i = first; lanes; i++, lanes >>= 1) {
        if (!(lanes & 1) || i % 3 == 0) continue;
        m->rays.far[i] = i % 3 == 1 ? -1 : 0;
        m->finished[i] = true;
    }
    return all;
}

/* Ten boxes one behind the other, and a ray through them all. */
static void line_up(meeting *m) {
    *m = (meeting){.box_count = 10, .rays.count = 100};
    for (int k = 0; k < 10; k++)
        m->boxes[k] = (zt_bvh_box){{-1, -1, (float)(2 * k + 1)}, {1, 1, (float)(2 * k + 2)}};
    for (int i = 0; i < ZT_BVH_RAYS; i++) {
        m->rays.dz[i] = 1;
        m->rays.far[i] = 100;
    }
}

static void a_ray_that_is_done_visits_no_more(void **state) {
    (void)state;
    static meeting m;
    line_up(&m);
    zt_bvh *bvh = NULL;
    assert_int_equal(zt_bvh_of_boxes(&bvh, builder, m.boxes, m.box_count), ZT_OK);
    look(bvh, &m.rays, finish, &m);
    assert_int_equal(m.mistakes, 0);
    assert_int_equal(m.visits, 34 * 10 + 66);
    zt_bvh_free(&bvh);
}

static void rays_that_are_none_look_nowhere(void **state) {
    (void)state;
    static meeting m;
    line_up(&m);
    zt_bvh *bvh = NULL;
    assert_int_equal(zt_bvh_of_boxes(&bvh, builder, m.boxes, m.box_count), ZT_OK);
    const float odd[] = {NAN, INFINITY, -INFINITY};
    float *const numbers[] = {m.rays.ox, m.rays.oy, m.rays.oz, m.rays.dx, m.rays.dy, m.rays.dz};
    for (int k = 0; k < 18; k++) numbers[k / 3][2 * k] = odd[k % 3];
    m.rays.dz[40] = 0;
    m.rays.far[42] = 0;
    m.rays.far[44] = -1;
    m.rays.far[46] = NAN;
    m.rays.far[48] = .99f; /* ends before the first box */
    look(bvh, &m.rays, note_visit, &m);
    assert_int_equal(m.mistakes, 0);
    for (int i = 0; i < m.rays.count; i++)
        for (int32_t k = 0; k < m.box_count; k++)
            assert_int_equal(m.visited[k][i],
                             !(i % 2 == 0 && (i < 36 || (i >= 40 && i <= 48))));
    zt_bvh_free(&bvh);
}

static void boxes_that_are_none_are_left_out(void **state) {
    (void)state;
    static meeting m;
    line_up(&m);
    m.boxes[2].low[1] = 2; /* above its high */
    m.boxes[3].high[0] = NAN;
    m.boxes[5].low[2] = -INFINITY;
    m.boxes[9].high[2] = INFINITY;
    zt_bvh *bvh = NULL;
    memset(m.visited, 0, sizeof m.visited);
    assert_int_equal(zt_bvh_of_boxes(&bvh, builder, m.boxes, m.box_count), ZT_OK);
    look(bvh, &m.rays, note_visit, &m);
    for (int32_t k = 0; k < 10; k++)
        assert_int_equal(m.visited[k][7], k != 2 && k != 3 && k != 5 && k != 9);
    zt_bvh_free(&bvh);
}

/* A hierarchy over nothing, over much, over nothing again: made anew each time. */
static void hierarchies_are_made_anew(void **state) {
    (void)state;
    static meeting m;
    zt_bvh *bvh = NULL;
    for (int round = 0; round < 20; round++) {
        line_up(&m);
        m.box_count = round * 7 % 11;
        for (int k = 0; k < 10; k++) m.boxes[k].low[0] += (float)round * 1e-3f;
        assert_int_equal(zt_bvh_of_boxes(&bvh, builder, m.boxes, m.box_count), ZT_OK);
        look(bvh, &m.rays, note_visit, &m);
        assert_int_equal(m.mistakes, 0);
        assert_int_equal(m.visits, m.rays.count * m.box_count);
    }
    zt_bvh_free(&bvh);
    zt_bvh *none = NULL;
    zt_bvh_free(&none);
}

/* Each box of an outer hierarchy holds an inner one, looked into from within the visit. */
typedef struct nest {
    const zt_bvh *inner;
    meeting outer, *inside;
} nest;

static uint32_t visit_nest(void *user, int32_t box, int first, uint32_t lanes) {
    nest *n = user;
    note_visit(&n->outer, box, first, lanes);
    line_up(n->inside);
    for (int i = 0; i < n->inside->rays.count; i++)
        if (i >= ZT_BVH_LANES || !(lanes >> i & 1)) n->inside->rays.far[i] = -1;
    look(n->inner, &n->inside->rays, note_visit, n->inside);
    n->outer.mistakes += n->inside->mistakes;
    n->outer.mistakes += n->inside->visits != 10 * __builtin_popcount(lanes);
    return 0;
}

static void visitors_may_look_further(void **state) {
    (void)state;
    static nest n;
    static meeting inside;
    line_up(&n.outer);
    n.inside = &inside;
    zt_bvh *inner = NULL, *outer = NULL;
    assert_int_equal(zt_bvh_of_boxes(&inner, builder, n.outer.boxes, 10), ZT_OK);
    assert_int_equal(zt_bvh_of_boxes(&outer, builder, n.outer.boxes, 10), ZT_OK);
    n.inner = inner;
    look(outer, &n.outer.rays, visit_nest, &n);
    assert_int_equal(n.outer.mistakes, 0);
    assert_int_equal(n.outer.visits, n.outer.rays.count * 10);
    zt_bvh_free(&inner);
    zt_bvh_free(&outer);
}

/* Closed meshes, which contain `center`, or a ring around it when they have one. */
typedef struct closed_mesh {
    const char *name;
    float *positions;
    uint32_t *triangles;
    int32_t vertex_count, triangle_count;
    double ring;
} closed_mesh;

static closed_mesh new_mesh(const char *name, int32_t vertex_count, int32_t triangle_count) {
    return (closed_mesh){name,
                         malloc((size_t)vertex_count * 3 * sizeof(float)),
                         malloc((size_t)triangle_count * 3 * sizeof(uint32_t)),
                         vertex_count,
                         triangle_count,
                         0};
}

static void free_mesh(closed_mesh *m) {
    free(m->positions);
    free(m->triangles);
}

static void put_vertex(closed_mesh *m, int32_t k, double x, double y, double z) {
    m->positions[3 * k] = (float)x;
    m->positions[3 * k + 1] = (float)y;
    m->positions[3 * k + 2] = (float)z;
}

static void put_triangle(closed_mesh *m, int32_t k, int32_t a, int32_t b, int32_t c) {
    m->triangles[3 * k] = (uint32_t)a;
    m->triangles[3 * k + 1] = (uint32_t)b;
    m->triangles[3 * k + 2] = (uint32_t)c;
}

/* A ball of radius 1 around (shift, shift, shift), with fans of `sectors` at its poles. */
static closed_mesh ball(const char *name, int rings, int sectors, double shift) {
    closed_mesh m = new_mesh(name, (rings - 1) * sectors + 2, 2 * (rings - 1) * sectors);
    int32_t north = (rings - 1) * sectors, south = north + 1, k = 0;
    put_vertex(&m, north, shift, shift, shift + 1);
    put_vertex(&m, south, shift, shift, shift - 1);
    for (int r = 1; r < rings; r++)
        for (int s = 0; s < sectors; s++) {
            double down = acos(-1.0) * r / rings, turn = 2 * acos(-1.0) * s / sectors;
            put_vertex(&m, (r - 1) * sectors + s, shift + sin(down) * cos(turn),
                       shift + sin(down) * sin(turn), shift + cos(down));
        }
    for (int s = 0; s < sectors; s++) {
        int32_t next = (s + 1) % sectors, last = (rings - 2) * sectors;
        put_triangle(&m, k++, north, s, next);
        put_triangle(&m, k++, south, last + next, last + s);
        for (int r = 0; r + 2 < rings; r++) {
            int32_t upper = r * sectors, lower = upper + sectors;
            put_triangle(&m, k++, upper + s, lower + s, lower + next);
            put_triangle(&m, k++, upper + s, lower + next, upper + next);
        }
    }
    return m;
}

/* A ring of radius 1 around z whose tube has a radius of 0.3. */
static closed_mesh torus(int along, int around) {
    closed_mesh m = new_mesh("ring", along * around, 2 * along * around);
    m.ring = 1;
    for (int a = 0; a < along; a++)
        for (int b = 0; b < around; b++) {
            double s = 2 * acos(-1.0) * a / along, t = 2 * acos(-1.0) * b / around;
            double r = 1 + .3 * cos(t);
            put_vertex(&m, a * around + b, r * cos(s), r * sin(s), .3 * sin(t));
            int32_t next_a = (a + 1) % along * around, next_b = (b + 1) % around;
            int32_t k = 2 * (a * around + b);
            put_triangle(&m, k, a * around + b, next_a + b, next_a + next_b);
            put_triangle(&m, k + 1, a * around + b, next_a + next_b, a * around + next_b);
        }
    return m;
}

/* Rays into the clusters of a mesh, and the triangles that they meet. */
typedef struct shot {
    const zt_clusters *clusters;
    zt_bvh_rays rays;
    zt_leaning_rays leaning;
    int32_t triangle[ZT_BVH_RAYS];
} shot;

static uint32_t meet(void *user, int32_t box, int first, uint32_t lanes) {
    const uint32_t all = lanes;
    shot *s = user;
    for (int i = first; lanes; i++, lanes >>= 1)
        if (lanes & 1)
            zt_meet_cluster(&s->rays.far[i], &s->triangle[i], &s->clusters->clusters[box],
                            &s->leaning, i);
    return all;
}

/* At corners, edges and now and then the inside of triangles, from within. */
static void aim(shot *s, const closed_mesh *m, draw *d, double shift) {
    s->rays.count = ZT_BVH_RAYS;
    for (int i = 0; i < ZT_BVH_RAYS; i++) {
        double turn = draw_between(d, 0, 2 * acos(-1.0)), inner = m->ring ? .1 : .5;
        double from[3] = {m->ring * cos(turn), m->ring * sin(turn), 0}, weight[3] = {1, 0, 0};
        if (draw_below(d, 2)) weight[0] = 1 - (weight[1] = draw_unit(d));
        if (draw_below(d, 8) == 0) weight[0] -= (weight[2] = draw_unit(d) * weight[0]);
        const uint32_t *t = m->triangles + 3 * draw_below(d, m->triangle_count);
        float *const o[3] = {s->rays.ox, s->rays.oy, s->rays.oz};
        float *const way[3] = {s->rays.dx, s->rays.dy, s->rays.dz};
        for (int axis = 0; axis < 3; axis++) {
            double to = 0;
            for (int k = 0; k < 3; k++)
                to += weight[k] * (double)m->positions[3 * t[k] + (uint32_t)axis];
            o[axis][i] = (float)(shift + from[axis] + draw_between(d, -inner, inner));
            way[axis][i] = (float)(to - (double)o[axis][i]);
        }
        s->rays.far[i] = INFINITY;
        s->triangle[i] = -1;
    }
    zt_lean_rays(&s->leaning, s->rays.ox, s->rays.oy, s->rays.oz, s->rays.dx, s->rays.dy,
                 s->rays.dz, ZT_BVH_RAYS);
}

static int64_t ray_count(void) {
    const char *asked = getenv("ZT_TEST_RAYS");
#ifdef __SANITIZE_ADDRESS__
    return asked ? atoll(asked) : 1000000;
#else
    return asked ? atoll(asked) : 10000000;
#endif
}

static void shoot_closed(closed_mesh mesh, double shift, int64_t rays) {
    static shot s;
    draw d = {.key = 3};
    zt_clusters clusters;
    zt_bvh *bvh = NULL;
    assert_int_equal(
        zt_clusters_build(&clusters, mesh.positions, mesh.triangles, mesh.triangle_count, NULL),
        ZT_OK);
    assert_int_equal(zt_bvh_of_boxes(&bvh, builder, clusters.boxes, clusters.count), ZT_OK);
    s.clusters = &clusters;
    int64_t through = 0, shots = 0;
    for (; shots < rays; shots += ZT_BVH_RAYS) {
        aim(&s, &mesh, &d, shift);
        look(bvh, &s.rays, meet, &s);
        for (int i = 0; i < ZT_BVH_RAYS; i++) through += s.triangle[i] < 0;
        /* A convex body is met where was aimed, and not behind. */
        for (int i = 0; i < ZT_BVH_RAYS && !mesh.ring; i++) through += !(s.rays.far[i] < 1.01f);
    }
    print_message("%-6s %7d triangles: %lld rays at corners and edges, %lld got through\n",
                  mesh.name, mesh.triangle_count, (long long)shots, (long long)through);
    assert_int_equal(through, 0);
    zt_bvh_free(&bvh);
    zt_clusters_free(&clusters);
    free_mesh(&mesh);
}

static void no_ray_gets_through_a_closed_mesh(void **state) {
    (void)state;
    int64_t share = ray_count() / 5;
    shoot_closed(ball("ball", 8, 12, 0), 0, share);
    shoot_closed(ball("ball", 100, 200, 0), 0, share);
    shoot_closed(ball("afar", 60, 100, 100), 100, share);
    shoot_closed(ball("fan", 3, 1000, 0), 0, share);
    shoot_closed(torus(300, 100), 0, share);
}

/* Each triangle twice, the second time in another place of the list: what a ray meets is what
 * looking at all of them finds, however many threads have built the hierarchy. */
static void triangles_are_met_by_index(void **state) {
    (void)state;
    static shot s, all;
    closed_mesh m = torus(60, 30);
    int32_t count = m.triangle_count;
    m.triangles = realloc(m.triangles, (size_t)count * 6 * sizeof(uint32_t));
    assert_non_null(m.triangles);
    for (int32_t k = 0; k < count; k++)
        memcpy(m.triangles + 3 * (count + k), m.triangles + 3 * ((int64_t)k * 7 % count),
               3 * sizeof(uint32_t));
    m.triangle_count = 2 * count;
    zt_clusters clusters;
    assert_int_equal(
        zt_clusters_build(&clusters, m.positions, m.triangles, m.triangle_count, NULL), ZT_OK);
    s.clusters = all.clusters = &clusters;
    const int threads[] = {1, 2, 4};
    for (int k = 0; k < 3; k++) {
        zt_bvh_builder *own;
        zt_bvh *bvh = NULL;
        draw d = {.key = 4};
        assert_int_equal(zt_bvh_open(&own, threads[k], (zt_listener){0}), ZT_OK);
        assert_int_equal(zt_bvh_of_boxes(&bvh, own, clusters.boxes, clusters.count), ZT_OK);
        for (int round = 0; round < 40; round++) {
            aim(&s, &m, &d, 0);
            all = s;
            look(bvh, &s.rays, meet, &s);
            for (int32_t box = 0; box < clusters.count; box++)
                for (int first = 0; first < ZT_BVH_RAYS; first += ZT_BVH_LANES)
                    meet(&all, box, first, 0xffff);
            assert_memory_equal(s.triangle, all.triangle, sizeof s.triangle);
            assert_memory_equal(s.rays.far, all.rays.far, sizeof s.rays.far);
            for (int i = 0; i < ZT_BVH_RAYS; i++) {
                assert_in_range(s.triangle[i], 0, m.triangle_count - 1);
                if (count % 7) assert_true(s.triangle[i] < count); /* the first of the two */
            }
        }
        zt_bvh_free(&bvh);
        zt_bvh_close(&own);
    }
    zt_clusters_free(&clusters);
    free_mesh(&m);
}

/* Each triangle is in one cluster, once but for filling up, and within its box. */
static void clusters_hold_each_triangle(void **state) {
    (void)state;
    closed_mesh m = torus(50, 21);
    for (int32_t k = 0; k < m.triangle_count / 2; k++) /* half of them in one place */
        memcpy(m.triangles + 3 * k, m.triangles, 3 * sizeof(uint32_t));
    zt_clusters c;
    assert_int_equal(zt_clusters_build(&c, m.positions, m.triangles, m.triangle_count, NULL),
                     ZT_OK);
    int32_t *cluster_of = malloc((size_t)m.triangle_count * sizeof *cluster_of);
    memset(cluster_of, 0xff, (size_t)m.triangle_count * sizeof *cluster_of);
    for (int32_t k = 0; k < c.count; k++)
        for (int i = 0; i < ZT_CLUSTER; i++) {
            int32_t triangle = c.clusters[k].triangles[i];
            assert_in_range(triangle, 0, m.triangle_count - 1);
            assert_true(cluster_of[triangle] == -1 || cluster_of[triangle] == k);
            cluster_of[triangle] = k;
            for (int corner = 0; corner < 3; corner++)
                for (int axis = 0; axis < 3; axis++) {
                    float at = c.clusters[k].corners[corner][axis][i];
                    uint32_t vertex = m.triangles[3 * triangle + corner];
                    assert_true(at == m.positions[3 * vertex + (uint32_t)axis]);
                    assert_true(at >= c.boxes[k].low[axis] && at <= c.boxes[k].high[axis]);
                }
        }
    for (int32_t k = 0; k < m.triangle_count; k++) assert_true(cluster_of[k] >= 0);
    assert_true(c.count < m.triangle_count / 5);
    free(cluster_of);
    zt_clusters_free(&c);
    assert_int_equal(zt_clusters_build(&c, m.positions, m.triangles, 0, NULL), ZT_OK);
    assert_int_equal(c.count, 0);
    zt_clusters_free(&c);
    free_mesh(&m);
}

/* However many threads make them. */
static void clusters_are_the_same_for_any_threads(void **state) {
    (void)state;
    closed_mesh m = torus(200, 101);
    zt_clusters alone, together;
    zt_pool *pool;
    assert_int_equal(zt_pool_open(&pool, 3), ZT_OK);
    assert_int_equal(
        zt_clusters_build(&alone, m.positions, m.triangles, m.triangle_count, NULL), ZT_OK);
    assert_int_equal(
        zt_clusters_build(&together, m.positions, m.triangles, m.triangle_count, pool), ZT_OK);
    zt_pool_close(&pool);
    assert_int_equal(alone.count, together.count);
    size_t count = (size_t)alone.count;
    assert_memory_equal(alone.clusters, together.clusters, count * sizeof *alone.clusters);
    assert_memory_equal(alone.boxes, together.boxes, count * sizeof *alone.boxes);
    zt_clusters_free(&alone);
    zt_clusters_free(&together);
    free_mesh(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_box_is_passed_by),
        cmocka_unit_test(rays_that_are_shortened_find_the_nearest),
        cmocka_unit_test(a_ray_that_is_done_visits_no_more),
        cmocka_unit_test(rays_that_are_none_look_nowhere),
        cmocka_unit_test(boxes_that_are_none_are_left_out),
        cmocka_unit_test(hierarchies_are_made_anew),
        cmocka_unit_test(visitors_may_look_further),
        cmocka_unit_test(clusters_hold_each_triangle),
        cmocka_unit_test(clusters_are_the_same_for_any_threads),
        cmocka_unit_test(triangles_are_met_by_index),
        cmocka_unit_test(no_ray_gets_through_a_closed_mesh),
    };
    return cmocka_run_group_tests(tests, open_builder, close_builder);
}
