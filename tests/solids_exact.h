/* Rays and solids in numbers of 113 bits: how far off a claimed hit is. Shares no method with
 * src/tracer/solids.h: solids are what lies beneath all of their faces, and crossings of single
 * faces count where they lie on the solid. */
#ifndef ZT_TESTS_SOLIDS_EXACT_H
#define ZT_TESTS_SOLIDS_EXACT_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#if defined(__SIZEOF_FLOAT128__) && __has_include(<quadmath.h>)
#include <quadmath.h>
typedef __float128 exact;
#define EXACT(name)   name##q
#define EXACT_IS_QUAD 1
#else
typedef long double exact;
#define EXACT(name)   name##l
#define EXACT_IS_QUAD (LDBL_MANT_DIG >= 113)
#endif

typedef enum solid { DISK, BOX, BALL, CYLINDER, CONE, CAPSULE, TORUS, SOLIDS } solid;

typedef struct exact3 {
    exact x, y, z;
} exact3;

/* A ray with a unit direction, g its point nearest to the origin, from s = `start` on. */
typedef struct exact_ray {
    exact3 g, e;
    exact start;
    exact length; /* of the direction as it was given */
    exact a, b;   /* parameters of the solid */
    solid kind;
} exact_ray;

static inline exact exact_dot(exact3 a, exact3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline exact exact_max(exact a, exact b) { return a > b ? a : b; }
static inline exact exact_min(exact a, exact b) { return a < b ? a : b; }
static inline exact3 exact_at(const exact_ray *r, exact s) {
    return (exact3){r->g.x + s * r->e.x, r->g.y + s * r->e.y, r->g.z + s * r->e.z};
}

static inline exact_ray exact_ray_of(solid kind, exact3 f, exact3 e, double p0, double p1) {
    exact length = EXACT(sqrt)(exact_dot(e, e));
    exact_ray r = {f, {e.x / length, e.y / length, e.z / length}, 0, length, p0, p1, kind};
    r.start = exact_dot(f, r.e);
    r.g = exact_at(&r, -r.start);
    return r;
}

/* How far a point is above the highest of all faces; the height of a disk is that above its
 * plane. A face moved outward by as much would touch the point. */
static inline exact exact_height(const exact_ray *r, exact3 p) {
    exact around = EXACT(sqrt)(p.x * p.x + p.y * p.y), slope = r->b - r->a;
    exact caps = exact_max(-p.z, p.z - 1);
    exact beyond = p.z < 0 ? p.z : p.z > r->a ? p.z - r->a : 0;
    switch (r->kind) {
    case DISK:
        return p.z;
    case BOX:
        return exact_max(exact_max(EXACT(fabs)(p.x), EXACT(fabs)(p.y)), EXACT(fabs)(p.z)) - 1;
    case BALL:
        return EXACT(sqrt)(exact_dot(p, p)) - 1;
    case CYLINDER:
        return exact_max(around - 1, caps);
    case CONE:
        return exact_max((around - r->a - slope * p.z) / EXACT(sqrt)(1 + slope * slope), caps);
    case CAPSULE:
        return EXACT(sqrt)(around * around + beyond * beyond) - 1;
    default:
        return EXACT(sqrt)((around - 1) * (around - 1) + p.z * p.z) - r->a;
    }
}

static inline exact exact_height_at(const exact_ray *r, exact s) {
    return exact_height(r, exact_at(r, s));
}

/* ---- convex solids ---- */

/* From where to where the ray is in a solid, where it is at all. */
typedef struct exact_chord {
    exact in, out;
    bool some;
} exact_chord;

/* A crossing of one face counts where no other face is lower. */
static inline void chord_add(exact_chord *c, const exact_ray *r, exact s) {
    if (!(EXACT(fabs)(s) < 1e30) || !(EXACT(fabs)(exact_height_at(r, s)) < 1e-19)) return;
    c->in = c->some ? exact_min(c->in, s) : s;
    c->out = c->some ? exact_max(c->out, s) : s;
    c->some = true;
}

/* Both roots of a s^2 + 2 b s + c. */
static inline void chord_add_roots(exact_chord *chord, const exact_ray *r, exact a, exact b,
                                   exact c) {
    exact square = b * b - a * c;
    if (square < 0) return;
    exact q = b < 0 ? EXACT(sqrt)(square) - b : -EXACT(sqrt)(square) - b;
    if (q != 0) chord_add(chord, r, c / q);
    if (a != 0) chord_add(chord, r, q / a);
}

static inline exact_chord exact_chord_of(const exact_ray *r) {
    exact_chord c = {0, 0, false};
    exact3 g = r->g, e = r->e;
    exact slope = r->kind == CONE ? r->b - r->a : 0, a = r->kind == CONE ? r->a : 1;
    exact w0 = a + slope * g.z, w1 = slope * e.z;
    switch (r->kind) {
    case BOX:
        for (int side = -1; side < 2; side += 2) {
            if (e.x != 0) chord_add(&c, r, (side - g.x) / e.x);
            if (e.y != 0) chord_add(&c, r, (side - g.y) / e.y);
            if (e.z != 0) chord_add(&c, r, (side - g.z) / e.z);
        }
        break;
    case CAPSULE:
        chord_add_roots(&c, r, 1, exact_dot(g, e) - r->a * e.z,
                        exact_dot(g, g) - 2 * r->a * g.z + r->a * r->a - 1);
        /* fall through */
    case BALL:
        chord_add_roots(&c, r, 1, exact_dot(g, e), exact_dot(g, g) - 1);
        if (r->kind == BALL) break;
        /* fall through */
    default:
        chord_add_roots(&c, r, e.x * e.x + e.y * e.y - w1 * w1, g.x * e.x + g.y * e.y - w0 * w1,
                        g.x * g.x + g.y * g.y - w0 * w0);
        if (r->kind == CAPSULE) break;
        if (e.z != 0) chord_add(&c, r, -g.z / e.z);
        if (e.z != 0) chord_add(&c, r, (1 - g.z) / e.z);
    }
    return c;
}

/* The least height of a convex solid's surface from `low` to `high`, by golden sections. */
static inline exact exact_depth(const exact_ray *r, exact low, exact high) {
    for (int i = 0; i < 60; i++) {
        exact third = (high - low) * (exact)0.381966;
        if (exact_height_at(r, low + third) < exact_height_at(r, high - third))
            high -= third;
        else
            low += third;
    }
    return exact_height_at(r, (low + high) / 2);
}

/* ---- torus ---- */

/* The turning points of the quartic along the ray: least, greatest, least, or one only. */
typedef struct exact_turns {
    exact at[3], height[3];
    int count;
} exact_turns;

static inline exact_turns exact_turns_of(const exact_ray *r) {
    /* s^3 + p s + q, by the closed form with cosines, then Newton's steps. */
    exact p = exact_dot(r->g, r->g) - 1 - r->a * r->a + 2 * r->e.z * r->e.z,
          q = 2 * r->g.z * r->e.z;
    double dp = (double)p / 3, dq = (double)q / 2, d = dq * dq + dp * dp * dp;
    exact_turns t = {{0}, {0}, d < 0 ? 3 : 1};
    if (d < 0) {
        double angle = acos(fmax(-1, fmin(1, -dq / sqrt(-dp * dp * dp)))) / 3;
        for (int i = 0; i < 3; i++)
            t.at[i] = 2 * sqrt(-dp) * cos(angle + (i + 1) * 2.0943951023931957);
    } else {
        double u = cbrt(fabs(dq) + sqrt(d));
        t.at[0] = (dq > 0 ? -1 : 1) * (u - (u > 0 ? dp / u : 0));
    }
    for (int i = 0; i < t.count; i++) {
        for (int step = 0; step < 4; step++) {
            exact s = t.at[i], slope = 3 * s * s + p;
            if (slope != 0) t.at[i] -= (s * s * s + p * s + q) / slope;
        }
        t.height[i] = exact_height_at(r, t.at[i]);
    }
    return t;
}

/* ---- how far off a claim is ---- */

/* Half the slope of the square of the distance to the middle of a torus' tube. */
static inline exact torus_slope(const exact_ray *r, exact s) {
    exact3 p = exact_at(r, s);
    exact around = EXACT(sqrt)(p.x * p.x + p.y * p.y);
    return around == 0 ? p.z * r->e.z
                       : (p.x * r->e.x + p.y * r->e.y) * (1 - 1 / around) + p.z * r->e.z;
}

/* By how much the surface must move for a ray that begins outside (sign 1) or inside (-1) not
 * to pass it before s, and for what it does at s, if `ends`, to be a crossing to the other
 * side. */
static inline exact torus_wrong(const exact_ray *r, int sign, exact s, bool ends, exact least) {
    exact_turns t = exact_turns_of(r);
    exact wrong = ends ? EXACT(fabs)(exact_height_at(r, s)) : 0;
    if (!ends && sign < 0) return INFINITY;
    bool turned = false;
    exact next = INFINITY;
    for (int i = t.count - 1; i >= 0; i--) {
        bool least = i != 1;
        if (t.at[i] > s) next = sign * t.height[i];
        if (t.at[i] > r->start && t.at[i] < s && least == (sign > 0)) {
            wrong = exact_max(wrong, -sign * t.height[i]);
            turned = true;
        }
    }
    if (ends && sign * torus_slope(r, s) > least && !turned) wrong = exact_max(wrong, next);
    return wrong;
}

static inline exact convex_wrong(const exact_ray *r, int sign, exact s, bool ends) {
    exact_chord c = exact_chord_of(r);
    exact wrong = ends ? EXACT(fabs)(exact_height_at(r, s)) : 0;
    if (sign < 0 && !ends) return INFINITY;
    if (!c.some) return wrong;
    exact from = sign > 0 ? exact_max(c.in, r->start) : s;
    exact to = sign > 0 && ends ? exact_min(s, c.out) : c.out;
    if (from >= to) return wrong;
    /* Heights are convex along the ray: mostly, the end by s is the lowest. */
    exact end = sign < 0 ? from : to, aside = end - sign * (to - from) / 1024;
    exact least = exact_height_at(r, end);
    exact depth = ends && exact_height_at(r, aside) >= least ? least : exact_depth(r, from, to);
    return exact_max(wrong, -depth);
}

/* Of a disk: what is met or missed at its edge, or behind the ray's beginning. */
static inline exact disk_wrong(const exact_ray *r, exact s, bool ends) {
    exact meets = -r->g.z / r->e.z;
    exact3 p = exact_at(r, ends ? s : meets);
    exact beyond = EXACT(sqrt)(p.x * p.x + p.y * p.y) - 1;
    if (ends) return exact_max(EXACT(fabs)(p.z), beyond);
    if (r->e.z == 0 || !(meets > r->start) || beyond > 0) return 0;
    return exact_min(-beyond, EXACT(fabs)(r->g.z + r->start * r->e.z));
}

/* The backward error of t as the first crossing of a ray that begins outside or inside:
 * relative to the numbers of the ray and a size of 1. */
static inline double exact_wrong(const exact_ray *r, int sign, double t, double bound) {
    bool ends = isfinite(t);
    exact s = ends ? r->start + t * r->length : INFINITY;
    exact3 f = exact_at(r, r->start);
    exact scale = exact_max(1, EXACT(sqrt)(exact_dot(f, f)));
    if (ends) scale = exact_max(scale, t * r->length);
    exact wrong = r->kind == DISK    ? disk_wrong(r, s, ends)
                  : r->kind == TORUS ? torus_wrong(r, sign, s, ends, bound * scale)
                                     : convex_wrong(r, sign, s, ends);
    return (double)(wrong / scale);
}

#endif
