/* Looking into a hierarchy passes by no box that a ray touches, however odd the two are; and
 * what visitors say about rays is followed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "draw.h"
#include "looking.h"

enum { BOXES_MAX = 300 };

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_box_is_passed_by),
        cmocka_unit_test(rays_that_are_shortened_find_the_nearest),
        cmocka_unit_test(a_ray_that_is_done_visits_no_more),
        cmocka_unit_test(rays_that_are_none_look_nowhere),
        cmocka_unit_test(boxes_that_are_none_are_left_out),
        cmocka_unit_test(hierarchies_are_made_anew),
        cmocka_unit_test(visitors_may_look_further),
    };
    return cmocka_run_group_tests(tests, open_builder, close_builder);
}
