/* The torus of solids.h: all points within p0 of the circle of radius 1 about z.
 *
 * About the point of a unit ray that is nearest to the middle, its quartic in s has no cubic
 * term, and the derivative over 4 is s^3 + p s + q. The turning points, the roots of that, part
 * the roots of the quartic, so the signs there say which crossing comes first, and between
 * which two points it is the only one: isolation by derivatives, as in C. Yuksel,
 * "High-performance polynomial root finding for graphics", 2022. About a turning point, the
 * quartic is height + x^2 (c2 + c3 x + c4 x^2), and so a crossing close to it, where a ray
 * grazes or the tube is thin, is as well determined as any: it is found there by Newton's
 * steps, halving where they leave the bracket. All signs and heights, and the last steps, are
 * of d^2 - p0^2 with d the distance from the circle, whose rounding is one of d; that of the
 * polynomial is not. */
#ifndef ZT_TRACER_SOLIDS_TORUS_H
#define ZT_TRACER_SOLIDS_TORUS_H

#include "tracer/solids.h"

/* How many steps; measured by tests/test_solids.c. Constants, so that loops are unrolled and
 * the loop around them becomes wide. */
enum { TORUS_CUBIC_STEPS = 5, TORUS_QUARTIC_STEPS = 14, TORUS_LAST_STEPS = 2 };

/* A unit direction, and the point of the ray nearest to the middle. */
typedef struct torus_ray {
    real gx, gy, gz, ex, ey, ez;
    real tube;
} torus_ray;

/* At s: d^2 - tube^2, half its change by s, and the quartic, which has the same roots. */
typedef struct torus_height {
    real h, slope, quartic;
} torus_height;

static inline torus_height torus_height_at(const torus_ray *r, real s) {
    real x = r->gx + s * r->ex, y = r->gy + s * r->ey, z = r->gz + s * r->ez;
    real around = real_sqrt(x * x + y * y), aside = around - 1;
    real slope = (x * r->ex + y * r->ey) * (aside / around) + z * r->ez;
    real h = aside * aside + (z - r->tube) * (z + r->tube);
    return (torus_height){h, slope, h * (h + 4 * around)};
}

/* Where the quartic is least, greatest and least again; if it turns once only, all three. */
typedef struct torus_turns {
    real low0, high, low1;
} torus_turns;

/* The roots of s^3 + p s + q: the outermost one by Newton's steps from beyond it, the others by
 * the quadratic that is left. */
static inline torus_turns torus_turns_of(real p, real q) {
    real size = real_abs(q);
    real root = real_sqrt(size), cube2 = root * real_sqrt(real_sqrt(root)); /* about q^(2/3) */
    real x = p > 0 ? size / (p + cube2) : real_sqrt(cube2 - p);
#pragma GCC unroll 16
    for (int i = 0; i < TORUS_CUBIC_STEPS; i++)
        x = (2 * x * x * x + size) / (3 * x * x + p + REAL_LEAST);
    real half = real_sqrt(real_max(-p - (real)0.75 * x * x, 0));
    real middle = half > 0 ? (real)0.5 * x : -x;
    bool turned = q < 0;
    torus_turns t;
    t.low0 = turned ? -middle - half : -x;
    t.high = turned ? half - middle : middle - half;
    t.low1 = turned ? x : middle + half;
    return t;
}

/* A crossing: the only root from a to b, x away from the turning point m along `way` (1 or -1),
 * with x < span; `height` is the absolute value of the quartic at m, which is a maximum where
 * sign = -1, else a minimum. */
typedef struct torus_crossing {
    real a, b, m, way, sign, height, span;
} torus_crossing;

static inline real torus_root(const torus_ray *r, real p, torus_crossing c) {
    real m = c.m;
    real c2 = c.sign * (6 * m * m + 2 * p), c3 = c.sign * c.way * 4 * m, c4 = c.sign;
    real even = real_max(c2, 0); /* first without c3 */
    real x =
        real_sqrt(2 * c.height / (even + real_sqrt(even * even + 4 * c.height) + REAL_LEAST));
    real near = 0, far = c.span;
#pragma GCC unroll 16
    for (int i = 0; i < TORUS_QUARTIC_STEPS; i++) {
        real f = x * x * (c2 + x * (c3 + x * c4)) - c.height;
        real slope = x * (2 * c2 + x * (3 * c3 + x * 4 * c4));
        near = f < 0 ? x : near;
        far = f < 0 ? far : x;
        real next = x - f / slope;
        x = ((next >= near) & (next <= far)) ? next : (real)0.5 * (near + far);
    }
    real s = real_min(real_max(m + c.way * x, c.a), c.b);
#pragma GCC unroll 16
    for (int i = 0; i < TORUS_LAST_STEPS; i++) {
        torus_height at = torus_height_at(r, s);
        /* Right at a turning point the slope may be nothing but rounding. */
        real step = real_min(real_max(-at.h / (2 * at.slope), -x), x);
        s = real_min(real_max(s + step, c.a), c.b);
    }
    return s;
}

/* Selects are made of numbers, not of truths, where GCC 12 would not widen the latter. */
static inline real zt_torus_meet(real fx, real fy, real fz, real ex, real ey, real ez, real p0,
                                 real p1, int32_t leaving, real near) {
    (void)p1;
    real scale = 1 / real_sqrt(real_dot(ex, ey, ez, ex, ey, ez));
    torus_ray r = {0, 0, 0, ex * scale, ey * scale, ez * scale, p0};
    /* In two steps, since from afar the first one falls short by its rounding. */
    real jump = -real_dot(fx, fy, fz, r.ex, r.ey, r.ez);
    r.gx = fx + jump * r.ex, r.gy = fy + jump * r.ey, r.gz = fz + jump * r.ez;
    real rest = -real_dot(r.gx, r.gy, r.gz, r.ex, r.ey, r.ez), k = jump + rest;
    r.gx += rest * r.ex, r.gy += rest * r.ey, r.gz += rest * r.ez;
    /* From where it begins, or from the ball around it, to that ball's end. */
    bool elsewhere = leaving == 0;
    real g2 = real_dot(r.gx, r.gy, r.gz, r.gx, r.gy, r.gz), g = real_sqrt(g2);
    real reach2 = (1 + p0 - g) * (1 + p0 + g), reach = real_sqrt(real_max(reach2, 0));
    real begin = elsewhere ? near / scale - k : -k;
    real low = ((-begin > reach) & elsewhere) ? -reach : begin;
    /* Both are small for rays close to the axis, and then q is better known from across it. */
    real across2 = r.ex * r.ex + r.ey * r.ey, across = -(r.gx * r.ex + r.gy * r.ey);
    real p = g2 + (1 - p0) * (1 + p0) - 2 * across2;
    torus_turns t = torus_turns_of(p, 2 * (2 * across2 < 1 ? across : r.gz * r.ez));
    torus_height start = torus_height_at(&r, low), low0 = torus_height_at(&r, t.low0),
                 high = torus_height_at(&r, t.high), low1 = torus_height_at(&r, t.low1);
    /* Of a ray that begins on the surface, which crossing that is shows by the turns around;
     * what penetrates or sticks out by rounding only does not count. */
    real afar = elsewhere ? 1 : 0, half = elsewhere ? 0 : (real)0.5;
    bool inside = afar * real_max(start.h, k - reach) + (real)leaving < 0;
    real rounding = half * 16 * REAL_ROUNDING * p0;
    real end1 = t.high - half * (t.high - t.low0), end2 = t.low1 - half * (t.low1 - t.high);
    /* It enters before low0 or low1, or leaves before high or at last. */
    real known = half * (t.low1 - t.low0) - REAL_LEAST; /* >= 0: low0 is the one it is on */
    bool at0 = real_max(real_max(low - t.low0, low0.h + rounding), known) < 0;
    bool at1 = real_max(low - end1, rounding - high.h) < 0;
    real past = at0 ? -1 : real_max(low - end2, low1.h + rounding);
    real miss = real_max(past, real_max(-reach2, -k - reach)) < 0 ? 0 : REAL_INFINITY;
    miss = inside ? 0 : miss;
    real in_low = at0 ? t.low0 : t.low1, in_depth = at0 ? low0.quartic : low1.quartic;
    real in_top = at0 ? REAL_INFINITY : high.quartic, in_a = at0 ? low : t.high;
    real out_low = at1 ? t.low0 : t.low1, out_depth = at1 ? low0.quartic : low1.quartic;
    real out_top = at1 ? high.quartic : REAL_INFINITY, out_b = at1 ? t.high : reach;
    real bottom = inside ? out_low : in_low, depth = -(inside ? out_depth : in_depth);
    real top = inside ? out_top : in_top;
    /* From the turning point that is nearer to the surface. */
    torus_crossing c;
    bool from_top = top < depth;
    c.sign = from_top ? -1 : 1;
    c.way = inside ? c.sign : -c.sign;
    c.m = from_top ? t.high : bottom;
    c.height = real_max(from_top ? top : depth, 0);
    c.span = top < REAL_INFINITY ? real_abs(t.high - bottom) : reach + real_abs(bottom);
    c.a = real_max(low, inside ? out_low : in_a);
    c.b = real_max(c.a, inside ? out_b : in_low);
    return real_max((jump + (rest + torus_root(&r, p, c))) * scale, REAL_LEAST) + miss;
}

static inline zt_face zt_torus_surface(real x, real y, real z, real p0, real p1,
                                       const zt_rows *m) {
    (void)p1, (void)m;
    real around = real_sqrt(x * x + y * y), aside = around - 1;
    bool axis = around == 0;
    real scale = aside / (axis ? 1 : around);
    zt_face face = round_face(axis ? aside : x * scale, y * scale, z);
    return (zt_face){face.nx, face.ny, face.nz, face.off + 1 - p0};
}

#endif
