/* Where a ray is within a solid, in the solid's own space: convex ones between two distances,
 * the torus between up to two pairs. */
#include "reference.h"

typedef struct span {
    real from, to; /* empty where from > to */
} span;

#define FAR ((real)1e4000L)

static span meet(span a, span b) {
    return (span){real_max(a.from, b.from), real_min(a.to, b.to)};
}
static span join(span a, span b) { /* of two parts of one convex thing */
    if (a.from > a.to) return b;
    if (b.from > b.to) return a;
    return (span){real_min(a.from, b.from), real_max(a.to, b.to)};
}

/* low <= o + t d <= high */
static span slab(real o, real d, real low, real high) {
    if (d == 0) return o < low || o > high ? (span){1, 0} : (span){-FAR, FAR};
    real a = (low - o) / d, b = (high - o) / d;
    return (span){real_min(a, b), real_max(a, b)};
}

/* Where a t^2 + 2 b t + c <= 0, which is one stretch within `within`. */
static span quadratic(real a, real b, real c, span within) {
    const span all = {-FAR, FAR}, none = {1, 0};
    if (a == 0) {
        if (b == 0) return c <= 0 ? within : none;
        return meet(within, b > 0 ? (span){-FAR, -c / (2 * b)} : (span){-c / (2 * b), FAR});
    }
    real inside = b * b - a * c;
    if (inside < 0) return a > 0 ? none : meet(within, all);
    real root = REAL(sqrt)(inside), q = b < 0 ? root - b : -b - root;
    real t0 = q / a, t1 = q == 0 ? t0 : c / q;
    span between = {real_min(t0, t1), real_max(t0, t1)};
    if (a > 0) return meet(within, between);
    /* The two nappes of a double cone; the solid is in one of them. */
    span before = meet(within, (span){-FAR, between.from});
    span after = meet(within, (span){between.to, FAR});
    return before.to - before.from >= after.to - after.from ? before : after;
}

static span ball(real3 o, real3 d, real z) {
    o.z -= z;
    return quadratic(real3_dot(d, d), real3_dot(o, d), real3_dot(o, o) - 1, (span){-FAR, FAR});
}

/* Where a convex solid is met. */
static span convex(const ref_primitive *p, real3 o, real3 d) {
    real a = d.x * d.x + d.y * d.y, b = o.x * d.x + o.y * d.y, c = o.x * o.x + o.y * o.y;
    switch (p->shape) {
    case ZT_SHAPE_SPHERE:
        return ball(o, d, 0);
    case ZT_SHAPE_BOX:
        return meet(slab(o.x, d.x, -1, 1), meet(slab(o.y, d.y, -1, 1), slab(o.z, d.z, -1, 1)));
    case ZT_SHAPE_CYLINDER:
        return quadratic(a, b, c - 1, slab(o.z, d.z, 0, 1));
    case ZT_SHAPE_CAPSULE:
        return join(join(ball(o, d, 0), ball(o, d, p->a)),
                    quadratic(a, b, c - 1, slab(o.z, d.z, 0, p->a)));
    default: { /* the cone: x^2 + y^2 <= (radius a + k z)^2 */
        real k = p->b - p->a, r = p->a + k * o.z;
        return quadratic(a - k * d.z * k * d.z, b - r * k * d.z, c - r * r,
                         slab(o.z, d.z, 0, 1));
    }
    }
}

/* x^2 + y^2 + z^2 + 1 - a^2 is squared and held against 4 (x^2 + y^2), from the place on the
 * ray nearest to the middle. Whether the source is left out is settled here: its own root is
 * the nearest to the ray's beginning of those where the ray goes to the side that it leaves to.
 */
static bool torus_first(real *t, const ref_primitive *p, real3 o, real3 d, bool leaves,
                        real from, real to) {
    real length = real3_length(d), shift = -real3_dot(o, d) / (length * length);
    real3 m = real3_along(o, shift, d), u = real3_scale(d, 1 / length);
    real k = real3_dot(m, m) + 1 - p->a * p->a, flat = u.x * u.x + u.y * u.y;
    real cross = m.x * u.x + m.y * u.y, limit = (real)1.01 * (1 + p->a);
    if (real3_dot(m, m) > limit * limit) return false;
    real roots[4];
    int count = ref_quartic(roots, 2 * k - 4 * flat, -8 * cross,
                            k * k - 4 * (m.x * m.x + m.y * m.y), limit);
    real from_ring = 1 - 1 / REAL(sqrt)(o.x * o.x + o.y * o.y);
    bool outward = from_ring * (o.x * d.x + o.y * d.y) + o.z * d.z > 0;
    int own = -1;
    for (int i = 0; i < count; i++) {
        roots[i] = shift + roots[i] / length;
        bool goes_out = i % 2; /* in, out, in, out */
        if (leaves && goes_out == outward &&
            (own < 0 || real_abs(roots[i]) < real_abs(roots[own])))
            own = i;
    }
    for (int i = 0; i < count; i++)
        if (i != own && roots[i] > from && roots[i] < to) {
            *t = roots[i];
            return true;
        }
    return false;
}

static real3 to_own(const ref_primitive *p, real3 v) {
    return (real3){real3_dot(p->rows[0], v), real3_dot(p->rows[1], v),
                   real3_dot(p->rows[2], v)};
}

static bool disk_first(real *t, real3 o, real3 d, real from, real to) {
    if (d.z == 0) return false;
    *t = -o.z / d.z;
    real3 at = real3_along(o, *t, d);
    return at.x * at.x + at.y * at.y <= 1 && *t > from && *t < to;
}

bool ref_solid_first(real *t, const ref_primitive *p, const ref_ray *ray, real from, real to) {
    bool leaves = ray->source_object == p->object;
    real3 o = to_own(p, real3_sub(ray->o, p->center)), d = to_own(p, ray->d);
    if (p->shape == ZT_SHAPE_DISK) return !leaves && disk_first(t, o, d, from, to);
    if (p->shape == ZT_SHAPE_TORUS) return torus_first(t, p, o, d, leaves, from, to);
    /* From the place on the ray nearest to the middle less cancels. */
    real shift = -real3_dot(o, d) / real3_dot(d, d);
    span in = convex(p, real3_along(o, shift, d), d);
    if (!(in.from < in.to)) return false;
    in = (span){in.from + shift, in.to + shift};
    if (leaves) { /* outward: never again; inward, as the face says: at the far end */
        bool inward = real3_dot(ref_nearest_face(p, -1, ray->o).normal, ray->d) < 0;
        *t = in.to;
        return inward && in.to > from && in.to < to;
    }
    *t = in.from > from ? in.from : in.to;
    return *t > from && *t < to;
}
