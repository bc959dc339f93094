/* Shows that polygons are cut into triangles that cover them exactly once, whatever their
 * shape, in bounded time. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "base/random.h"
#include "base/vec.h"
#include "description/triangulate.h"
#include "patience.h"

static const double pi = 3.14159265358979323846;
enum { MOST = 100000 };

static struct {
    double positions[3 * MOST];
    uint32_t corners[MOST], triangles[3 * MOST];
    int32_t count;
} polygon;

/* A corner more, in a plane of our own that is parallel to none of the axes'. */
static void add_corner(double x, double y) {
    static const vec3 u = {0.8, 0.36, 0.48}, v = {-0.6, 0.48, 0.64}, o = {5, -3, 2};
    double *p = polygon.positions + 3 * polygon.count;
    p[0] = o.x + x * u.x + y * v.x;
    p[1] = o.y + x * u.y + y * v.y;
    p[2] = o.z + x * u.z + y * v.z;
    polygon.corners[polygon.count] = (uint32_t)polygon.count;
    polygon.count++;
}

static vec3 position(uint32_t vertex) {
    const double *p = polygon.positions + 3 * (size_t)vertex;
    return (vec3){p[0], p[1], p[2]};
}

/* Area vector of the triangle that three vertices make. */
static vec3 triangle_area(const uint32_t *t) {
    vec3 a = position(t[0]);
    return vec3_scale(vec3_cross(vec3_sub(position(t[1]), a), vec3_sub(position(t[2]), a)),
                      0.5);
}

static zt_triangulator triangulate(void) {
    zt_arena arena = {0};
    zt_triangulator t;
    assert_int_equal(zt_triangulator_create(&t, &arena, polygon.positions, polygon.count),
                     ZT_OK);
    zt_triangulate(&t, polygon.triangles, polygon.corners, polygon.count);
    zt_arena_free(&arena);
    return t;
}

/* All triangles turn the polygon's way, and their areas add up to its own, which the shoelace
 * formula gave: so none overlaps another or reaches outside. */
static void assert_covered(double area) {
    zt_triangulator t = triangulate();
    assert_int_equal(t.given_up, 0);
    vec3 normal = {0, -0.8, 0.6}; /* of add_corner's plane: u x v */
    double sum = 0;
    for (int32_t i = 0; i < polygon.count - 2; i++) {
        vec3 a = triangle_area(polygon.triangles + 3 * i);
        if (area < 0) a = vec3_scale(a, -1);
        assert_true(vec3_dot(a, normal) > -1e-12 * fabs(area));
        sum += vec3_length(a);
    }
    assert_true(fabs(sum / fabs(area) - 1) < 1e-9);
}

static double shoelace(const double (*p)[2], int count) {
    double sum = 0;
    for (int i = 0; i < count; i++) {
        const double *a = p[i], *b = p[(i + 1) % count];
        sum += a[0] * b[1] - a[1] * b[0];
    }
    return sum / 2;
}

/* The polygon in all its rotations, so that each corner is the first one once, and both ways
 * round. */
static void assert_always_covered(const double (*p)[2], int count) {
    for (int first = 0; first < count; first++)
        for (int direction = -1; direction <= 1; direction += 2) {
            polygon.count = 0;
            for (int i = 0; i < count; i++) {
                int k = (first + direction * i + count) % count;
                add_corner(p[k][0], p[k][1]);
            }
            assert_covered(direction * shoelace(p, count));
        }
}

/* A convex polygon is a fan around its first corner. */
static void convex_becomes_a_fan(void **state) {
    (void)state;
    polygon.count = 0;
    for (int i = 0; i < 7; i++) add_corner(cos(2 * pi * i / 7), sin(2 * pi * i / 7));
    assert_covered(7 * 0.5 * sin(2 * pi / 7));
    for (uint32_t i = 0; i < 5; i++) {
        const uint32_t *t = polygon.triangles + 3 * i;
        assert_int_equal(t[0], 0);
        assert_int_equal(t[1], i + 1);
        assert_int_equal(t[2], i + 2);
    }
}

/* The one way to cut an arrowhead, from whichever corner it begins. */
static void concave_quads(void **state) {
    (void)state;
    const double arrow[4][2] = {{0, 0}, {2, 2}, {0, 1}, {-2, 2}};
    assert_always_covered(arrow, 4);
}

static void known_shapes(void **state) {
    (void)state;
    const double ell[6][2] = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
    assert_always_covered(ell, 6);
    const double comb[12][2] = {{0, 0}, {6, 0}, {6, 5},   {5, 1}, {4, 5},   {3.5, 1},
                                {3, 5}, {2, 1}, {1.5, 5}, {1, 1}, {0.5, 5}, {0, 1}};
    assert_always_covered(comb, 12);
    /* Corners on straight edges, and corners that stand twice. */
    const double straight[8][2] = {{0, 0}, {1, 0}, {2, 0}, {2, 1},
                                   {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    assert_always_covered(straight, 8);
    const double twice[7][2] = {{0, 0}, {0, 0}, {3, 0}, {3, 3}, {3, 3}, {1, 1}, {0, 3}};
    assert_always_covered(twice, 7);
    /* A square with a square hole, joined by a bridge that is gone over twice. */
    const double hole[10][2] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0},
                                {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}};
    assert_always_covered(hole, 10);
}

/* A corner on a straight edge is a corner of some triangle that has an area: a neighbour that
 * shares it leaves no crack. */
static void straight_corners_are_kept(void **state) {
    (void)state;
    const double square[5][2] = {{0, 0}, {1, 0}, {2, 0}, {2, 2}, {0, 2}};
    for (int first = 0; first < 5; first++) {
        polygon.count = 0;
        for (int i = 0; i < 5; i++)
            add_corner(square[(first + i) % 5][0], square[(first + i) % 5][1]);
        triangulate();
        for (int i = 0; i < 3; i++)
            assert_true(vec3_length(triangle_area(polygon.triangles + 3 * i)) > 0.5);
    }
}

/* Random stars, in which every second corner may be a deep notch. */
static void random_stars(void **state) {
    (void)state;
    for (uint64_t seed = 0; seed < 400; seed++) {
        double p[60][2];
        int count = 4 + (int)(zt_random_key(seed, 0) % 57);
        for (int i = 0; i < count; i++) {
            double r = 0.05 + (double)(zt_random_key(seed, (uint64_t)i + 1) % 1000) / 1000;
            p[i][0] = r * cos(2 * pi * i / count);
            p[i][1] = r * sin(2 * pi * i / count);
        }
        polygon.count = 0;
        for (int i = 0; i < count; i++) add_corner(p[i][0], p[i][1]);
        assert_covered(shoelace(p, count));
    }
}

/* A spiral of two arms' width: hardly any corner is an ear. */
static void spiral(void **state) {
    (void)state;
    enum { TURN = 40, TURNS = 10, SIDE = TURN * TURNS };
    static double p[2 * SIDE][2];
    for (int i = 0; i < SIDE; i++) {
        double angle = 2 * pi * i / TURN, r = 1 + 1.0 * i / TURN;
        p[i][0] = (r + 0.5) * cos(angle);
        p[i][1] = (r + 0.5) * sin(angle);
        p[2 * SIDE - 1 - i][0] = r * cos(angle);
        p[2 * SIDE - 1 - i][1] = r * sin(angle);
    }
    polygon.count = 0;
    for (int i = 0; i < 2 * SIDE; i++) add_corner(p[i][0], p[i][1]);
    assert_covered(shoelace(p, 2 * SIDE));
}

/* What has no area, or crosses itself, still becomes the right number of triangles of its own
 * corners. */
static void degenerate_polygons(void **state) {
    (void)state;
    const double bow[4][2] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, point[5][2] = {{0}},
                 line[6][2] = {{0, 0}, {3, 3}, {1, 1}, {2, 2}, {-1, -1}, {0, 0}};
    const struct {
        const double (*p)[2];
        int count;
    } all[] = {{bow, 4}, {point, 5}, {line, 6}};
    for (int k = 0; k < 3; k++) {
        polygon.count = 0;
        for (int i = 0; i < all[k].count; i++) add_corner(all[k].p[i][0], all[k].p[i][1]);
        for (int i = 0; i < 3 * all[k].count; i++) polygon.triangles[i] = 77;
        triangulate();
        for (int i = 0; i < 3 * (all[k].count - 2); i++)
            assert_true(polygon.triangles[i] < (uint32_t)all[k].count);
        assert_int_equal(polygon.triangles[3 * (all[k].count - 2)], 77);
    }
}

/* Polygons made to take long are given up, within bounded time, and counted. */
static void bounded_time(void **state) {
    (void)state;
    for (int count = 60000; count <= MOST; count += MOST - 60000) {
        polygon.count = 0;
        for (int i = 0; i < count; i++) {
            uint64_t r = zt_random_key(7, (uint64_t)i);
            add_corner((double)(r % 1000), (double)(r / 1000 % 1000));
        }
        double begin_s = computed_s();
        zt_triangulator t = triangulate();
        assert_int_equal(t.given_up, 1);
        assert_within(begin_s, 100);
        for (int i = 0; i < 3 * (count - 2); i++)
            assert_true(polygon.triangles[i] < (uint32_t)count);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(convex_becomes_a_fan), cmocka_unit_test(concave_quads),
        cmocka_unit_test(known_shapes),         cmocka_unit_test(straight_corners_are_kept),
        cmocka_unit_test(random_stars),         cmocka_unit_test(spiral),
        cmocka_unit_test(degenerate_polygons),  cmocka_unit_test(bounded_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
