/* How places on lamps are sampled: against the densities that they claim, closed forms and
 * quadrature; and towards the point that a lamp shrinks to. In single and in double precision.
 *
 * The random numbers are fixed, so a test either always fails or never. Were they drawn anew, a
 * chi-square test (limit: 4 standard deviations) would fail by chance once in 30,000 times, a
 * comparison with a mean (limit: 3 standard errors) once in 370; there are about 40 of the
 * first and 60 of the second. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define ZT_ISA base
#include "chance.h"
#include "scenes.h"
#include "tracer/lamps.h"

#define PI 3.14159265358979323846

enum { DRAWS = 1 << 16, SAMPLES = 4096, SIDE = 16 };

/* cmocka's own takes floats. */
#define assert_near(a, b, room) near_or_fail((double)(a), (double)(b), (double)(room), __LINE__)
static void near_or_fail(double a, double b, double room, int line) {
    if (fabs(a - b) <= room) return;
    print_error("line %d: %.17g is not %.17g within %g\n", line, a, b, room);
    fail();
}

static float unit_random(uint64_t *seed) {
    return (float)(int32_t)(test_random(seed) * 0x1p24) * 0x1p-24f;
}

/* ---- numbers --------------------------------------------------------------------------------
 */

/* Sines and angles against the C library's, to two units of the last place of a double. */
static void test_numbers(void **state) {
    (void)state;
    for (int i = 0; i <= 4096; i++) {
        double s, c, turns = i / 4096.0;
        zt_turn(&s, &c, turns);
        assert_near(s, sinl(2 * 3.14159265358979323846L * turns), 3e-16);
        assert_near(c, cosl(2 * 3.14159265358979323846L * turns), 3e-16);
        double angle = PI * i / 4096;
        assert_near(zt_angle(3 * cos(angle), 3 * sin(angle)), angle, 1e-15);
    }
    for (double y = 1; y > 1e-300; y /= 7) assert_near(zt_angle(2, y) / atan2(y, 2), 1, 5e-16);
    assert_near(zt_angle(-1, 0), PI, 1e-15);
    assert_near(zt_angle(1, 0), 0, 0);
}

/* ---- densities ------------------------------------------------------------------------------
 */

static int cell_of(double share) {
    int cell = (int)(share * SIDE);
    return cell < 0 ? 0 : cell >= SIDE ? SIDE - 1 : cell;
}

static void assert_even(const int *counts, int draws) {
    double statistic = chi_square(counts, SIDE * SIDE, (double)draws / (SIDE * SIDE));
    assert_true(statistic < chi_square_limit(SIDE * SIDE - 1, 4));
}

/* Directions to a ball are spread evenly over the cone that it fills: by 1 - cos and by the
 * angle around it. So they are for balls near and far, in all directions. The shadow ray ends
 * on the ball, but for its skin. */
static void test_ball_density(void **state) {
    (void)state;
    uint64_t seed = 1;
    const double radii[] = {.001, .1, .5, .9, .998};
    for (int round = 0; round < 10; round++) {
        double r = radii[round % 5];
        vec3 w = round == 0   ? (vec3){0, 0, 1}
                 : round == 1 ? (vec3){0, 0, -1}
                              : test_direction(&seed);
        vec3 t =
            vec3_normalize(vec3_cross(w, fabs(w.x) < .5 ? (vec3){1, 0, 0} : (vec3){0, 1, 0}));
        vec3 b = vec3_cross(w, t);
        zt_lamp_pose lamp = {.position = {(real)w.x, (real)w.y, (real)w.z}, .a = (real)r};
        int counts[SIDE * SIDE] = {0};
        for (int i = 0; i < DRAWS; i++) {
            float u = unit_random(&seed), v = unit_random(&seed);
            zt_lamp_way way =
                zt_ball_way(&lamp, 0, 0, 0, (real)w.x, (real)w.y, (real)w.z, u, v);
            vec3 d = {(double)way.x, (double)way.y, (double)way.z};
            double x = vec3_dot(d, t), y = vec3_dot(d, b), sine2 = x * x + y * y;
            double least = vec3_dot(d, w);
            double off = sine2 / (1 + least), most = r * r / (1 + sqrt(1 - r * r));
            counts[SIDE * cell_of(off / most) + cell_of(atan2(y, x) / (2 * PI) + .5)]++;
            assert_near(vec3_length(d), 1, 8 * REAL_ROUNDING);
            vec3 end = vec3_sub(vec3_scale(d, (double)way.distance + r * 0x1p-10), w);
            double rim = sqrt(fmax(1 - off / most, 0)); /* roundings are large at the rim */
            assert_near(vec3_length(end), r, 1e-3 * r + 20 * REAL_ROUNDING / (rim + 1e-3));
        }
        assert_even(counts, DRAWS);
    }
}

/* Places on the disk are spread evenly over its area. */
static void test_disk_density(void **state) {
    (void)state;
    uint64_t seed = 2;
    int counts[SIDE * SIDE] = {0};
    for (int i = 0; i < DRAWS; i++) {
        double x, y;
        float u = unit_random(&seed), v = unit_random(&seed);
        zt_disk_sample(&x, &y, (double)u, (double)v);
        assert_true(x * x + y * y <= 1 + 1e-15);
        counts[SIDE * cell_of(x * x + y * y) + cell_of(atan2(y, x) / (2 * PI) + .5)]++;
    }
    assert_even(counts, DRAWS);
    double x, y;
    zt_disk_sample(&x, &y, .5, .5);
    assert_near(fabs(x) + fabs(y), 0, 0);
}

/* The solid angle of a rectangle that begins at the foot of the point: an arc tangent. */
static long double quadrant(long double x, long double y, long double z) {
    return atanl(x * y / (z * sqrtl(x * x + y * y + z * z)));
}
static long double solid_angle(long double x0, long double x1, long double y0, long double y1,
                               long double z) {
    return quadrant(x1, y1, z) - quadrant(x0, y1, z) - quadrant(x1, y0, z) +
           quadrant(x0, y0, z);
}

/* Rectangles as points may see them: x0, x1, y0, y1 and z. */
static const double sheets[][5] = {
    {-1, 1, -1, 1, 1},        {-1, 1, -1, 1, .01},       {-3, 5, -.2, .1, .3},
    {1, 2, 1, 3, .5},         {-2, -1, 4, 5, 2},         {-.01, .01, -.01, .01, 1},
    {.3, .31, -.7, -.69, 1},  {1, 2, -1, 1, .002},       {-1e-4, 1e-4, -5, 5, 1},
    {-5, 5, 1e-4, 2e-4, .5},  {-1e3, 1e3, -1e3, 1e3, 1}, {0, 1, 0, 1, 1},
    {-1, 0, -1, 0, .1},       {2, 2.1, 3, 3.1, 1e-2},    {-1, 1, -1, 1, 1e-8},
    {-1e5, 1e5, -1, 1, 1e-3}, {.7, .702, .7, .702, 1},   {-1, 1, -1, 1, 1e-20},
    {-1, 1, -1, 1, 1e10},     {1, 2, -1, 1, 1e-9},       {-3, -2.999, -4, 4, 2}};
enum { SHEETS = sizeof sheets / sizeof sheets[0] };

/* The solid angle, also of what is tiny, far, flat or all around, against arc tangents in long
 * double. */
static void test_solid_angle(void **state) {
    (void)state;
    for (int i = 0; i < SHEETS; i++) {
        const double *s = sheets[i];
        double wanted = (double)solid_angle(s[0], s[1], s[2], s[3], s[4]);
        double got = zt_sheet_of(s[0], s[1], s[2], s[3], s[4]).solid_angle;
        assert_near(got, wanted, wanted < 1e-14 ? 1e-14 : 2e-15);
    }
}

/* Places on a rectangle are spread evenly over the directions in which it is seen: cells of the
 * rectangle have as many as their solid angle asks for. */
static void test_rectangle_density(void **state) {
    (void)state;
    uint64_t seed = 3;
    enum { CELLS = 8 };
    for (int i = 0; i < SHEETS; i++) {
        const double *s = sheets[i];
        zt_sheet sheet = zt_sheet_of(s[0], s[1], s[2], s[3], s[4]);
        if (sheet.solid_angle < SHEET_LEAST) continue;
        /* Borders by equal steps of the angle as seen from the point, so that none is empty. */
        double x[CELLS + 1], y[CELLS + 1];
        double depth = s[4] + 1e-3 * fmin(s[1] - s[0], s[3] - s[2]);
        for (int k = 0; k <= CELLS; k++) {
            double x0 = asinh(s[0] / depth), x1 = asinh(s[1] / depth);
            double y0 = asinh(s[2] / depth), y1 = asinh(s[3] / depth);
            x[k] = depth * sinh(x0 + (x1 - x0) * k / CELLS);
            y[k] = depth * sinh(y0 + (y1 - y0) * k / CELLS);
        }
        x[0] = s[0], x[CELLS] = s[1], y[0] = s[2], y[CELLS] = s[3];
        int counts[CELLS * CELLS] = {0};
        for (int k = 0; k < DRAWS; k++) {
            double px, py;
            float u = unit_random(&seed), v = unit_random(&seed);
            zt_sheet_sample(&px, &py, &sheet, (double)u, (double)v);
            assert_true(px >= s[0] && px <= s[1] && py >= s[2] && py <= s[3]);
            int a = 0, b = 0;
            while (a < CELLS - 1 && px > x[a + 1]) a++;
            while (b < CELLS - 1 && py > y[b + 1]) b++;
            counts[CELLS * a + b]++;
        }
        double statistic = 0, rest = 0, rest_count = 0;
        int freedom = -1;
        for (int c = 0; c < CELLS * CELLS; c++) {
            int a = c / CELLS, b = c % CELLS;
            double expected = DRAWS / sheet.solid_angle *
                              (double)solid_angle(x[a], x[a + 1], y[b], y[b + 1], s[4]);
            rest += expected;
            rest_count += counts[c];
            if (rest < 20) continue; /* cells that expect little are counted together */
            statistic += (rest_count - rest) * (rest_count - rest) / rest;
            freedom++;
            rest = rest_count = 0;
        }
        assert_true(freedom > 0);
        assert_true(statistic < chi_square_limit(freedom, 4));
    }
}

/* ---- what arrives ---------------------------------------------------------------------------
 */

typedef enum kind { BALL, DISK, RECTANGLE } kind;

static zt_lamp_way way_to(kind kind, const zt_lamp_pose *l, vec3 n, float u, float v) {
    real x = (real)n.x, y = (real)n.y, z = (real)n.z;
    return kind == BALL   ? zt_ball_way(l, 0, 0, 0, x, y, z, u, v)
           : kind == DISK ? zt_disk_way(l, 0, 0, 0, x, y, z, u, v, true)
                          : zt_rectangle_way(l, 0, 0, 0, x, y, z, u, v);
}

/* A lamp as its sizes and axes in doubles; the point that it is seen from is the origin. */
typedef struct lamp {
    kind kind;
    vec3 at, x, y, z;
    double a, b;
} lamp;

static real3 to_real(vec3 v) { return (real3){(real)v.x, (real)v.y, (real)v.z}; }

static lamp lamp_at(kind kind, vec3 at, vec3 direction, double a, double b) {
    vec3 z = vec3_scale(vec3_normalize(direction), -1);
    vec3 x = vec3_normalize(vec3_cross(fabs(z.y) < .9 ? (vec3){0, 1, 0} : (vec3){1, 0, 0}, z));
    return (lamp){kind, at, x, vec3_cross(z, x), z, a, b};
}

static zt_lamp_pose pose_of(const lamp *l) {
    return (zt_lamp_pose){.position = to_real(l->at),
                          .x = to_real(l->x),
                          .y = to_real(l->y),
                          .z = to_real(l->z),
                          .a = (real)l->a,
                          .b = (real)l->b};
}

/* What arrives of power 1 on a surface with normal n, by a midpoint rule in long double: over
 * the lamp's own surface, whatever the tracer samples by. */
static double arriving(const lamp *l, vec3 n) {
    enum { GRID = 700 };
    long double sum = 0, area = 0;
    for (int i = 0; i < GRID; i++)
        for (int k = 0; k < GRID; k++) {
            long double u = (i + .5L) / GRID, v = (k + .5L) / GRID, weight = 1;
            long double p[3], m[3]; /* on the lamp, and the way that it shines there */
            const double *at = &l->at.x, *x = &l->x.x, *y = &l->y.x, *z = &l->z.x;
            if (l->kind == RECTANGLE) {
                for (int c = 0; c < 3; c++) {
                    p[c] = at[c] + (2 * u - 1) * l->a * x[c] + (2 * v - 1) * l->b * y[c];
                    m[c] = -z[c];
                }
            } else {
                long double across = sqrtl(u), angle = 2 * PI * v, depth = 0;
                if (l->kind == BALL) { /* evenly over its surface */
                    depth = 2 * u - 1;
                    across = sqrtl(1 - depth * depth);
                    weight = 4;
                }
                for (int c = 0; c < 3; c++) {
                    m[c] = across * (cosl(angle) * x[c] + sinl(angle) * y[c]) + depth * z[c];
                    p[c] = at[c] + l->a * m[c];
                    if (l->kind == DISK) m[c] = -z[c];
                }
            }
            long double d2 = p[0] * p[0] + p[1] * p[1] + p[2] * p[2];
            long double here = (p[0] * n.x + p[1] * n.y + p[2] * n.z),
                        there = -(p[0] * m[0] + p[1] * m[1] + p[2] * m[2]);
            if (here > 0 && there > 0) sum += weight * here * there / (d2 * d2);
            area += 1;
        }
    return (double)(sum / area); /* power / area, of all the area */
}

/* The mean of what samples say, within three standard errors of what is known: `off` is what
 * the quadrature may be wrong. */
static void assert_mean(const lamp *l, vec3 n, double wanted, double off, uint64_t *seed) {
    zt_lamp_pose pose = pose_of(l);
    double sum = 0, squares = 0;
    for (int i = 0; i < SAMPLES; i++) {
        float u = unit_random(seed), v = unit_random(seed);
        double fade = (double)way_to(l->kind, &pose, n, u, v).fade;
        assert_true(isfinite(fade) && fade >= 0);
        sum += fade;
        squares += fade * fade;
    }
    double mean = sum / SAMPLES,
           spread = sqrt(fmax(squares / SAMPLES - mean * mean, 0) / SAMPLES);
    assert_near(mean, wanted, 3 * spread + (off + 64 * REAL_ROUNDING) * wanted);
}

/* A ball above the horizon lights as the point in its middle, cos / d^2, exactly. */
static void test_ball_above(void **state) {
    (void)state;
    uint64_t seed = 4;
    for (int i = 0; i < 12; i++) {
        vec3 w = test_direction(&seed);
        double d = exp(test_between(&seed, -5, 5)), r = d * test_between(&seed, 0, .7);
        vec3 n = vec3_normalize(vec3_add(w, vec3_scale(test_direction(&seed), .4)));
        double height = d * vec3_dot(n, w);
        if (height < r) continue;
        lamp l = lamp_at(BALL, vec3_scale(w, d), w, r, 0);
        assert_mean(&l, n, height / (d * d * d), 0, &seed);
    }
}

/* Balls partly below the horizon, disks and rectangles near and far, seen at all angles. */
static void test_against_quadrature(void **state) {
    (void)state;
    uint64_t seed = 5;
    for (int i = 0; i < 27; i++) {
        kind kind = (enum kind)(i % 3);
        vec3 at = vec3_scale(test_direction(&seed), 1 + .5 * (i % 4));
        vec3 n = vec3_normalize(vec3_add(at, vec3_scale(test_direction(&seed), 1.5)));
        vec3 shines = vec3_sub(vec3_scale(test_direction(&seed), .8), at);
        lamp l = lamp_at(kind, at, shines, .05 + .11 * (i % 7), .8 - .05 * (i % 5));
        assert_mean(&l, n, arriving(&l, n), 1e-3, &seed);
    }
}

/* On the axis of a disk that faces it: power / (pi r^2) * pi r^2 / (r^2 + d^2). From far to so
 * near that distances differ by a factor of 1000. */
static void test_disk_on_axis(void **state) {
    (void)state;
    uint64_t seed = 6;
    for (double d = 10; d > 1e-3; d /= 2.7) {
        lamp l = lamp_at(DISK, (vec3){0, d, 0}, (vec3){0, -1, 0}, 1, 0);
        assert_mean(&l, (vec3){0, 1, 0}, 1 / (1 + d * d), 0, &seed);
        assert_mean(&l, (vec3){0, -1, 0}, 0, 0, &seed); /* from behind the surface */
        l = lamp_at(DISK, (vec3){0, d, 0}, (vec3){0, 1, 0}, 1, 0);
        assert_mean(&l, (vec3){0, 1, 0}, 0, 0, &seed); /* from behind the lamp */
    }
}

/* The light of a polygon above the horizon: Lambert's sum over its edges (1760). */
static double polygon_light(const vec3 *corners, int count, vec3 n) {
    double sum = 0;
    for (int i = 0; i < count; i++) {
        vec3 a = vec3_normalize(corners[i]), b = vec3_normalize(corners[(i + 1) % count]);
        vec3 across = vec3_cross(a, b);
        sum += acos(vec3_dot(a, b)) * vec3_dot(vec3_normalize(across), n);
    }
    return fabs(sum) / 2;
}

static void test_rectangle_light(void **state) {
    (void)state;
    uint64_t seed = 7;
    for (int i = 0; i < 16; i++) {
        double d = exp(test_between(&seed, -3, 3)), a = test_between(&seed, .1, 2),
               b = test_between(&seed, .1, 2);
        lamp l = lamp_at(RECTANGLE,
                         (vec3){test_between(&seed, -3, 3), d, test_between(&seed, -3, 3)},
                         (vec3){0, -1, 0}, a, b);
        vec3 u = vec3_scale(l.x, a), v = vec3_scale(l.y, b), n = {0, 1, 0};
        vec3 corners[4] = {vec3_add(l.at, vec3_add(u, v)), vec3_add(l.at, vec3_sub(u, v)),
                           vec3_sub(l.at, vec3_add(u, v)), vec3_sub(l.at, vec3_sub(u, v))};
        assert_mean(&l, n, polygon_light(corners, 4, n) / (4 * a * b), 1e-7, &seed);
    }
}

/* ---- shrinking ------------------------------------------------------------------------------
 */

/* Every single sample of a lamp that shrinks goes to what a point gives, of a flat one times
 * the cosine at which it shines: as the size over the distance, down to roundings. Of no size
 * it is that; of balls, to the last bit. */
static void test_shrinking(void **state) {
    (void)state;
    uint64_t seed = 8;
    for (int i = 0; i < 300; i++) {
        kind kind = (enum kind)(i % 3);
        double d = exp(test_between(&seed, -8, 8));
        vec3 w = test_direction(&seed), n = test_direction(&seed);
        vec3 shines = vec3_sub(test_direction(&seed), w);
        lamp l = lamp_at(kind, vec3_scale(w, d), shines, 0, 0);
        double cosine = vec3_dot(w, l.z), turn = exp(test_between(&seed, -3, 0));
        zt_lamp_pose pose = pose_of(&l);
        zt_lamp_way point = zt_point_way(&pose, 0, 0, 0, (real)n.x, (real)n.y, (real)n.z, 0, 0);
        double wanted = (double)point.fade * (kind == BALL ? 1 : fmax(cosine, 0));
        for (double size = d / 10; size >= d * .9e-12; size /= 10) {
            l.a = size;
            l.b = size * turn;
            pose = pose_of(&l);
            for (int k = 0; k < 16; k++) {
                float u = unit_random(&seed), v = unit_random(&seed);
                zt_lamp_way way = way_to(kind, &pose, n, u, v);
                double room = 8 * size / d + 16 * REAL_ROUNDING;
                assert_near((double)way.fade * d * d, wanted * d * d, room);
                assert_near((double)way.distance, d, room * d);
                assert_near(way.x, point.x, room);
                assert_near(way.y, point.y, room);
                assert_near(way.z, point.z, room);
            }
        }
        pose.a = pose.b = 0;
        zt_lamp_way none = way_to(kind, &pose, n, .3f, .8f);
        assert_true(none.x == point.x && none.y == point.y && none.z == point.z);
        assert_true(none.distance == point.distance);
        if (kind == BALL) assert_true(none.fade == point.fade);
        assert_near((double)none.fade * d * d, wanted * d * d, 16 * REAL_ROUNDING);
    }
}

/* Inside of a ball its light is all around: power / r^2, whichever way a surface faces; and
 * nothing is in between. */
static void test_inside_ball(void **state) {
    (void)state;
    uint64_t seed = 9;
    for (int i = 0; i < 200; i++) {
        vec3 at = vec3_scale(test_direction(&seed), i % 5 ? test_random(&seed) * .999 : 0);
        lamp l = lamp_at(BALL, at, (vec3){0, 0, 1}, 1, 0);
        zt_lamp_pose pose = pose_of(&l);
        zt_lamp_way way = way_to(BALL, &pose, test_direction(&seed), unit_random(&seed), .5f);
        assert_near((double)way.fade, 1, 0);
        assert_near((double)way.distance, 0, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_ball_density),
        cmocka_unit_test(test_disk_density),
        cmocka_unit_test(test_solid_angle),
        cmocka_unit_test(test_rectangle_density),
        cmocka_unit_test(test_ball_above),
        cmocka_unit_test(test_against_quadrature),
        cmocka_unit_test(test_disk_on_axis),
        cmocka_unit_test(test_rectangle_light),
        cmocka_unit_test(test_shrinking),
        cmocka_unit_test(test_inside_ball),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
