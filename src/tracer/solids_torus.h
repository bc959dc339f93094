/* The torus of solids.h, and its quartic. */
#ifndef ZT_TRACER_SOLIDS_TORUS_H
#define ZT_TRACER_SOLIDS_TORUS_H

#include "tracer/solids.h"

enum { TORUS_CUBIC_STEPS = 4, TORUS_ROOT_STEPS = 7 + 2 * (sizeof(real) == sizeof(double)) };

/* A unit direction, and the point of the ray nearest to the origin. */
typedef struct torus_ray {
    real gx, gy, gz, ex, ey, ez;
} torus_ray;

/* How far outside the tube the ray is at s, and half the change of that by s: for d, the
 * distance from the circle, d^2 - q^2. In this form it is right to a rounding in d, not only in
 * d^2: thin tubes need that. */
typedef struct torus_height {
    real h, slope;
} torus_height;

static inline torus_height torus_height_at(const torus_ray *r, real q, real s) {
    real x = r->gx + s * r->ex, y = r->gy + s * r->ey, z = r->gz + s * r->ez;
    real around = real_sqrt(x * x + y * y), aside = around - 1;
    real slope = (x * r->ex + y * r->ey) * (aside / around) + z * r->ez;
    return (torus_height){aside * aside + (z - q) * (z + q), slope};
}

/* Where along the ray its quartic is least, greatest and least again: the roots of
 * s^3 + p s + q, the derivative over 4. The outermost of them by Newton's steps from beyond it,
 * which cannot pass it, the others by the quadratic that is left. If there are no others, all
 * are the same. */
typedef struct torus_extremes {
    real low0, high, low1;
} torus_extremes;

static inline torus_extremes torus_extremes_of(real p, real q) {
    real size = real_abs(q);
    real root = real_sqrt(size), cube2 = root * real_sqrt(real_sqrt(root)); /* about q^(2/3) */
    real x = p > 0 ? size / (p + cube2) : real_sqrt(cube2 - p);
#pragma GCC unroll 16
    for (int i = 0; i < TORUS_CUBIC_STEPS; i++)
        x = (2 * x * x * x + size) / (3 * x * x + p + REAL_LEAST);
    real square = -p - (real)0.75 * x * x, half = real_sqrt(real_max(square, 0));
    real middle = half > 0 ? (real)0.5 * x : -x;
    bool turned = q < 0;
    torus_extremes e;
    e.low0 = turned ? -middle - half : -x;
    e.high = turned ? half - middle : middle - half;
    e.low1 = turned ? x : middle + half;
    return e;
}

static inline real zt_torus_meet(real fx, real fy, real fz, real ex, real ey, real ez, real p0,
                                 real p1, int32_t leaving) {
    (void)p1;
    real tube = p0;
    real scale = 1 / real_sqrt(real_dot(ex, ey, ez, ex, ey, ez));
    torus_ray r = {0, 0, 0, ex * scale, ey * scale, ez * scale};
    real k = -real_dot(fx, fy, fz, r.ex, r.ey, r.ez);
    r.gx = fx + k * r.ex, r.gy = fy + k * r.ey, r.gz = fz + k * r.ez;
    /* Within the ball around it. */
    real g2 = real_dot(r.gx, r.gy, r.gz, r.gx, r.gy, r.gz), g = real_sqrt(g2);
    real reach2 = (1 + tube - g) * (1 + tube + g);
    real reach = real_sqrt(real_max(reach2, 0));
    bool far = k > reach;
    real low = far ? -reach : -k;
    torus_extremes e =
        torus_extremes_of(g2 - 1 - tube * tube + 2 * r.ez * r.ez, 2 * r.gz * r.ez);
    real h_low = torus_height_at(&r, tube, low).h, h0 = torus_height_at(&r, tube, e.low0).h,
         h1 = torus_height_at(&r, tube, e.high).h, h2 = torus_height_at(&r, tube, e.low1).h,
         h_end = torus_height_at(&r, tube, reach).h;
    /* Of a ray that begins on the surface, which crossing that is shows by the extremes around;
     * what penetrates or sticks out by rounding only does not count. */
    bool elsewhere = leaving == 0;
    bool inside = (leaving < 0) | (elsewhere & (k <= reach) & (h_low < 0));
    real half = elsewhere ? 0 : (real)0.5, rounding = half * 16 * REAL_ROUNDING * tube;
    real end1 = e.high - half * (e.high - e.low0), end2 = e.low1 - half * (e.low1 - e.high);
    bool at0 = elsewhere & (low < e.low0) & (h0 < 0);
    bool at1 = (low < end1) & (h1 > rounding);
    bool at2 = (low < end2) & (h2 < -rounding);
    /* It enters before low0 or low1, it leaves before high or at last. */
    real in_a = at0 ? low : e.high, in_ha = at0 ? h_low : h1;
    real in_b = at0 ? e.low0 : e.low1, in_hb = at0 ? h0 : h2;
    real out_a = at1 ? e.low0 : e.low1, out_ha = at1 ? h0 : h2;
    real out_b = at1 ? e.high : reach, out_hb = at1 ? h1 : h_end;
    real a = inside ? out_a : in_a, ha = inside ? out_ha : in_ha;
    real b = inside ? out_b : in_b, hb = inside ? out_hb : in_hb;
    ha = real_abs(a > low ? ha : h_low), a = real_max(a, low);
    hb = real_abs(hb), b = real_max(a, b);
    real sign = inside ? -1 : 1;
    /* As of a parabola about the end that is nearer to the surface. */
    bool nearer_a = ha < hb;
    real from = nearer_a ? a : b, to = nearer_a ? b : a, h_from = nearer_a ? ha : hb;
    real s = from + (to - from) * real_sqrt(h_from / (ha + hb));
#pragma GCC unroll 16
    for (int i = 0; i < TORUS_ROOT_STEPS; i++) {
        torus_height at = torus_height_at(&r, tube, s);
        bool before = sign * at.h > 0;
        a = before ? s : a;
        b = before ? b : s;
        real next = s - at.h / (2 * at.slope);
        s = (next >= a) & (next <= b) ? next : (real)0.5 * (a + b);
    }
    bool meets = inside | ((at0 | at2) & (reach2 > 0) & (k > -reach));
    return real_max((k + s) * scale, REAL_LEAST) + (meets ? 0 : REAL_INFINITY);
}

static inline zt_face zt_torus_surface(real x, real y, real z, real p0, real p1) {
    (void)p1;
    real around = real_sqrt(x * x + y * y), aside = around - 1;
    bool axis = around == 0;
    real scale = aside / (axis ? 1 : around);
    zt_face face = round_face(axis ? aside : x * scale, y * scale, z);
    return (zt_face){face.nx, face.ny, face.nz, face.off + 1 - p0};
}

#endif
