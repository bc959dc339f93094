/* Shows that solids are met where they are, for rays that are drawn to be nasty, by an error
 * that a few roundings of the ray or of the solid explain: nothing escapes, is missed or met
 * twice. A number given to the program is how many rays there are of each kind. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <cmocka.h>

#include "draw.h"
#include "solids_exact.h"
#include "tracer/solids_torus.h"

#if defined ZT_REAL_IS_DOUBLE
static const double bound = 1e-12;
#else
static const double bound = 1e-6;
#endif

static int rays = 100000;

enum { WIDE = 256 };

/* As a kernel has them. */
typedef struct batch {
    real fx[WIDE], fy[WIDE], fz[WIDE], ex[WIDE], ey[WIDE], ez[WIDE], t[WIDE];
    int32_t leaving[WIDE];
    real nx[WIDE], ny[WIDE], nz[WIDE], off[WIDE];
} batch;

static const zt_rows own = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

#define LOOPS(kind)                                                                            \
    __attribute__((noinline)) static void meet_##kind(batch *restrict b, real p0, real p1) {   \
        for (int i = 0; i < WIDE; i++)                                                         \
            b->t[i] = zt_##kind##_meet(b->fx[i], b->fy[i], b->fz[i], b->ex[i], b->ey[i],       \
                                       b->ez[i], p0, p1, b->leaving[i], 0);                    \
    }                                                                                          \
    static void surface_##kind(batch *restrict b, real p0, real p1) {                          \
        for (int i = 0; i < WIDE; i++) {                                                       \
            zt_face f = zt_##kind##_surface(b->fx[i], b->fy[i], b->fz[i], p0, p1, &own);       \
            b->nx[i] = f.nx, b->ny[i] = f.ny, b->nz[i] = f.nz, b->off[i] = f.off;              \
        }                                                                                      \
    }
LOOPS(disk)
LOOPS(box)
LOOPS(ball)
LOOPS(cylinder)
LOOPS(cone)
LOOPS(capsule)
LOOPS(torus)

static const struct {
    const char *name;
    void (*meet)(batch *restrict, real, real);
    void (*surface)(batch *restrict, real, real);
} kinds[SOLIDS] = {
    {"disk", meet_disk, surface_disk},    {"box", meet_box, surface_box},
    {"ball", meet_ball, surface_ball},    {"cylinder", meet_cylinder, surface_cylinder},
    {"cone", meet_cone, surface_cone},    {"capsule", meet_capsule, surface_capsule},
    {"torus", meet_torus, surface_torus},
};

typedef struct point {
    double x, y, z;
} point;

static point along(point p, double s, point d) {
    return (point){p.x + s * d.x, p.y + s * d.y, p.z + s * d.z};
}
static double dot(point a, point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* ---- what is drawn ---- */

static double draw_sign(draw *d) { return draw_below(d, 2) ? 1 : -1; }

/* Parameters that fit into `real`, at their ends and close to them as often as between. */
static void draw_parameters(draw *d, solid kind, real *p0, real *p1) {
    double unit[] = {1, draw_unit(d), draw_magnitude(d, 1e-6, 1),
                     1 - draw_magnitude(d, 1e-7, 1e-2)};
    *p0 = *p1 = 0;
    if (kind == CONE) {
        bool wide = draw_below(d, 2);
        real other = draw_below(d, 4) ? (real)unit[draw_below(d, 4)] : 0;
        *p0 = wide ? 1 : other, *p1 = wide ? other : 1;
    }
    if (kind == CAPSULE) {
        double lengths[] = {0, 1, 1e6, draw_magnitude(d, 1e-6, 1e6), draw_unit(d) * 4};
        *p0 = (real)lengths[draw_below(d, 5)];
    }
    if (kind == TORUS) *p0 = (real)unit[draw_below(d, 4)];
}

/* A direction: any, along an axis, across one, nearly along or across one. */
static point draw_direction(draw *d) {
    double v[3], odd = draw_magnitude(d, 1e-20, 1e-2);
    for (int i = 0; i < 3; i++) v[i] = draw_between(d, -1, 1);
    int how = draw_below(d, 6), axis = draw_below(d, 3);
    for (int i = 0; i < 3; i++) {
        if (how == 0) v[i] *= i == axis;
        if (how == 1) v[i] *= i != axis;
        if (how == 2) v[i] *= i == axis ? 1 : odd;
        if (how == 3) v[i] *= i != axis ? 1 : odd;
    }
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(length > 0)) return (point){0, 0, 1};
    return (point){v[0] / length, v[1] / length, v[2] / length};
}

/* A point of the surface, edges and poles among them, and the normal of a face there. */
static point draw_on(draw *d, solid kind, double p0, double p1, point *n) {
    double turns[] = {0, 0.25, 0.5, draw_unit(d), draw_unit(d)};
    double a = 2 * 3.14159265358979323846 * turns[draw_below(d, 5)], c = cos(a), s = sin(a);
    double places[] = {0,
                       1,
                       draw_unit(d),
                       draw_unit(d),
                       draw_magnitude(d, 1e-9, 1),
                       1 - draw_magnitude(d, 1e-9, 1)};
    double z = places[draw_below(d, 6)], slope = p1 - p0, side = draw_sign(d);
    int part = draw_below(d, 3);
    switch (kind) {
    case DISK:
        *n = (point){0, 0, 1};
        return (point){z * c, z * s, 0};
    case BOX: {
        double v[3] = {side, 2 * z - 1, draw_between(d, -1, 1)};
        *n = (point){part == 0 ? side : 0, part == 1 ? side : 0, part == 2 ? side : 0};
        return (point){v[(3 - part) % 3], v[(4 - part) % 3], v[(5 - part) % 3]};
    }
    case BALL:
        *n = draw_direction(d);
        return *n;
    case CYLINDER:
    case CONE: {
        if (kind == CYLINDER) p0 = 1, slope = 0;
        if (part == 0) {
            double r = z * (side < 0 ? p0 : p0 + slope);
            *n = (point){0, 0, side};
            return (point){r * c, r * s, side < 0 ? 0 : 1};
        }
        double h = sqrt(1 + slope * slope), r = p0 + slope * z;
        *n = (point){c / h, s / h, -slope / h};
        return (point){r * c, r * s, z};
    }
    case CAPSULE:
        *n = part == 0 ? (point){c, s, 0} : draw_direction(d);
        return along((point){0, 0, part == 0 ? z * p0 : n->z < 0 ? 0 : p0}, 1, *n);
    default: {
        double b = 2 * 3.14159265358979323846 * turns[draw_below(d, 5)];
        *n = (point){cos(b) * c, cos(b) * s, sin(b)};
        return along((point){c, s, 0}, p0, *n);
    }
    }
}

/* A ray from afar, near, inside or the axis, mostly to a point of the surface or past it; every
 * fourth one begins on the surface. */
static void draw_ray(draw *d, solid kind, real p0, real p1, batch *b, int i) {
    point n, p = draw_on(d, kind, (double)p0, (double)p1, &n), e = draw_direction(d);
    bool on = draw_below(d, 4) == 0;
    if (draw_below(d, 3) == 0) { /* tangent, or nearly */
        e = along(e, -dot(e, n) * (1 - draw_below(d, 2) * draw_magnitude(d, 1e-16, 1e-1)), n);
        double length = sqrt(dot(e, e));
        e = length > 1e-9 ? along((point){0, 0, 0}, 1 / length, e) : (point){0, 0, 1};
    }
    if (!on) {
        double past = draw_below(d, 2) ? draw_sign(d) * draw_magnitude(d, 1e-16, 1) : 0;
        p = along(p, past, n);
        double far[] = {draw_magnitude(d, 1e-9, 1e6), draw_magnitude(d, 1e-2, 1e2), 1e6,
                        draw_unit(d) * 2};
        int where = draw_below(d, 8);
        if (where < 6) {
            p = along(p, -far[draw_below(d, 4)], e);
        } else { /* from inside or about, or from the axis */
            double size = where == 6;
            point from = {draw_between(d, -size, size), draw_between(d, -size, size),
                          draw_between(d, -1, 1) * (kind == CAPSULE ? (double)p0 + 1 : 1.2)};
            e = along(p, -1, from), p = from;
            double length = sqrt(dot(e, e));
            e = length > 0 ? along((point){0, 0, 0}, 1 / length, e) : (point){1, 0, 0};
        }
    }
    double length = draw_below(d, 2) ? 1 : draw_magnitude(d, 1e-6, 1e6);
    b->fx[i] = (real)p.x, b->fy[i] = (real)p.y, b->fz[i] = (real)p.z;
    b->ex[i] = (real)(length * e.x), b->ey[i] = (real)(length * e.y);
    b->ez[i] = (real)(length * e.z);
    b->leaving[i] = on;
}

/* Tells rays that begin on the surface which way they go, as a renderer would. */
static void turn_leaving(batch *b) {
    for (int i = 0; i < WIDE; i++) {
        real out = real_dot(b->nx[i], b->ny[i], b->nz[i], b->ex[i], b->ey[i], b->ez[i]);
        if (b->leaving[i]) b->leaving[i] = out >= 0 ? 1 : -1;
    }
}

/* ---- what is shown ---- */

typedef struct tally {
    double worst, worst_off, worst_normal;
    long wrong, missed, untrue;
} tally;

static exact_ray ray_of(solid kind, const batch *b, int i, real p0, real p1) {
    return exact_ray_of(kind, (exact3){b->fx[i], b->fy[i], b->fz[i]},
                        (exact3){b->ex[i], b->ey[i], b->ez[i]}, (double)p0, (double)p1);
}

static void judge(tally *sum, solid kind, const batch *b, int i, real p0, real p1) {
    exact_ray r = ray_of(kind, b, i, p0, p1);
    double t = (double)b->t[i], error;
    exact height = exact_height_at(&r, r.start);
    exact3 f = exact_at(&r, r.start);
    double near = bound * fmax(1, sqrt((double)exact_dot(f, f)));
    if (kind == DISK)
        error = b->leaving[i] ? (isfinite(t) ? INFINITY : 0) : exact_wrong(&r, 1, t, bound);
    else if (b->leaving[i])
        error = exact_wrong(&r, b->leaving[i], t, bound);
    else if (height > near || height < -near)
        error = exact_wrong(&r, height > 0 ? 1 : -1, t, bound);
    else
        error = fmin(exact_wrong(&r, 1, t, bound), exact_wrong(&r, -1, t, bound));
    bool convex_again = kind != TORUS && b->leaving[i] > 0 && isfinite(t);
    if (!(t > 0) || convex_again) error = INFINITY;
    if (!(error <= bound)) {
        long *count = !isfinite(t)                                          ? &sum->missed
                      : exact_height_at(&r, r.start + t * r.length) > bound ? &sum->untrue
                                                                            : &sum->wrong;
        if ((*count)++ < 3 && getenv("ZT_SOLIDS_SHOW"))
            printf("  %s(%.9g, %.9g): f %.17g %.17g %.17g e %.17g %.17g %.17g leaving %d: t "
                   "%.17g, off by %g\n",
                   kinds[kind].name, (double)p0, (double)p1, (double)b->fx[i], (double)b->fy[i],
                   (double)b->fz[i], (double)b->ex[i], (double)b->ey[i], (double)b->ez[i],
                   (int)b->leaving[i], t, error);
    } else {
        sum->worst = fmax(sum->worst, error);
    }
}

/* How far `off` is from the height, and the normal from the direction in which that grows. */
static void judge_face(tally *sum, solid kind, const batch *b, int i, real p0, real p1) {
    exact_ray r = ray_of(kind, b, i, p0, p1);
    exact3 f = {b->fx[i], b->fy[i], b->fz[i]}, n = {b->nx[i], b->ny[i], b->nz[i]};
    exact length = EXACT(sqrt)(exact_dot(n, n)), step = 1e-5;
    double size = fmax(1, sqrt((double)exact_dot(f, f)));
    exact height = exact_height(&r, f);
    sum->worst_off = fmax(sum->worst_off, fabs((double)(height - b->off[i])) / size);
    sum->worst_normal = fmax(sum->worst_normal, fabs((double)length - 1));
    /* Of a torus, normals know the tube's thickness no better than a rounding of 1, and at its
     * middle there are many. */
    double sure = kind == TORUS ? (double)p0 : 1;
    if (kind == TORUS && f.x * f.x + f.y * f.y < 1e-4) return;
    /* First away from where two faces are as near as rounding can tell. */
    exact up = 4 * bound * size / length, on = up + step / length;
    exact3 from = {f.x + up * n.x, f.y + up * n.y, f.z + up * n.z};
    exact3 to = {f.x + on * n.x, f.y + on * n.y, f.z + on * n.z};
    double grows = (double)((exact_height(&r, to) - exact_height(&r, from)) / step);
    double angle = sqrt(2 * fmax(0, 1 - grows));
    sum->worst_normal = fmax(sum->worst_normal, angle * sure / size);
}

static tally survey(solid kind) {
    static batch b;
    draw d = {(uint64_t)kind + 1, 0};
    tally sum = {0, 0, 0, 0, 0, 0};
    for (int first = 0; first < rays; first += WIDE) {
        real p0, p1;
        draw_parameters(&d, kind, &p0, &p1);
        for (int i = 0; i < WIDE; i++) draw_ray(&d, kind, p0, p1, &b, i);
        kinds[kind].surface(&b, p0, p1);
        turn_leaving(&b);
        kinds[kind].meet(&b, p0, p1);
        for (int i = 0; i < WIDE; i++) {
            judge(&sum, kind, &b, i, p0, p1);
            if (b.leaving[i]) judge_face(&sum, kind, &b, i, p0, p1);
        }
    }
    return sum;
}

/* The time of one ray of many at once, in nanoseconds: the best of a few. */
static double nanoseconds(solid kind) {
    static batch b;
    draw d = {7, 0};
    for (int i = 0; i < WIDE; i++) draw_ray(&d, kind, (real)0.5, 1, &b, i);
    for (int i = 0; i < WIDE; i++) b.leaving[i] = 0;
    double best = INFINITY;
    for (int round = 0; round < 20; round++) {
        struct timespec from, to;
        clock_gettime(CLOCK_MONOTONIC, &from);
        for (int i = 0; i < 40; i++) kinds[kind].meet(&b, (real)0.5, 1);
        clock_gettime(CLOCK_MONOTONIC, &to);
        double t =
            (double)(to.tv_sec - from.tv_sec) * 1e9 + (double)(to.tv_nsec - from.tv_nsec);
        best = fmin(best, t / (40 * WIDE));
    }
    return best;
}

static void show(solid kind) {
    if (!EXACT_IS_QUAD) skip();
    tally sum = survey(kind);
    printf("%-8s  backward error %.2e  wrong %ld  missed %ld  false %ld  "
           "off %.1e  normal %.1e  %.2f ns\n",
           kinds[kind].name, sum.worst, sum.wrong, sum.missed, sum.untrue, sum.worst_off,
           sum.worst_normal, nanoseconds(kind));
    assert_int_equal(sum.wrong, 0);
    assert_int_equal(sum.missed, 0);
    assert_int_equal(sum.untrue, 0);
    assert_true(sum.worst_off <= bound);
    assert_true(sum.worst_normal <= bound);
}

static void disks_are_met(void **state) { (void)state, show(DISK); }
static void boxes_are_met(void **state) { (void)state, show(BOX); }
static void balls_are_met(void **state) { (void)state, show(BALL); }
static void cylinders_are_met(void **state) { (void)state, show(CYLINDER); }
static void cones_are_met(void **state) { (void)state, show(CONE); }
static void capsules_are_met(void **state) { (void)state, show(CAPSULE); }
static void tori_are_met(void **state) { (void)state, show(TORUS); }

int main(int argc, char **argv) {
    if (argc > 1) rays = (int)strtol(argv[1], NULL, 10);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(disks_are_met), cmocka_unit_test(boxes_are_met),
        cmocka_unit_test(balls_are_met), cmocka_unit_test(cylinders_are_met),
        cmocka_unit_test(cones_are_met), cmocka_unit_test(capsules_are_met),
        cmocka_unit_test(tori_are_met),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
