/* The faces of a primitive as seen from a point near it: how far they are, their normals, and
 * how sensitive those are. */
#include "reference.h"

/* To first order the face F = 0 is |F| / |grad F| away; the gradient in the world is M^T that
 * in the solid's own space. */
typedef struct own_face {
    real value;        /* F */
    real3 gradient;    /* of F, towards the outside */
    real beyond;       /* how far beyond the face's ends, in the units of ... */
    real3 beyond_grad; /* ... this gradient; zero where it has no ends */
    real3 ways[2];     /* unit directions along it in which it bends, */
    real bends[2];     /* and how much: one over the radius */
} own_face;

static real3 to_own(const ref_primitive *p, real3 v) {
    return (real3){real3_dot(p->rows[0], v), real3_dot(p->rows[1], v),
                   real3_dot(p->rows[2], v)};
}

static real3 turn_back(const ref_primitive *p, real3 v) {
    return real3_add(real3_add(real3_scale(p->rows[0], v.x), real3_scale(p->rows[1], v.y)),
                     real3_scale(p->rows[2], v.z));
}

/* How much the world's normal along M^T g turns for a step to any side, off the face too. */
static real world_bend(const ref_primitive *p, const own_face *f, real3 normal, real length) {
    real3 x, y;
    real own = real3_length(f->gradient), sum = 0;
    if (f->bends[0] == 0 && f->bends[1] == 0) return 0;
    real3_frame(&x, &y, normal);
    for (int side = 0; side < 3; side++) {
        real3 step = side == 0 ? x : side == 1 ? y : normal, turned = {0, 0, 0};
        real3 s = to_own(p, step);
        for (int i = 0; i < 2; i++)
            turned =
                real3_along(turned, f->bends[i] * own * real3_dot(f->ways[i], s), f->ways[i]);
        real3 w = turn_back(p, turned);
        w = real3_along(w, -real3_dot(w, normal), normal);
        sum += real3_dot(w, w);
    }
    return REAL(sqrt)(sum) / length;
}

static ref_face to_world(const ref_primitive *p, const own_face *f) {
    real3 g = turn_back(p, f->gradient);
    real length = real3_length(g), rows = 0;
    real3 normal = real3_scale(g, 1 / length);
    real distance = real_abs(f->value) / length;
    real ends = f->beyond > 0 ? real3_length(turn_back(p, f->beyond_grad)) : 0;
    if (ends > 0) distance = real_max(distance, f->beyond / ends);
    const real by[3] = {f->gradient.x, f->gradient.y, f->gradient.z};
    for (int i = 0; i < 3; i++) rows += real_abs(by[i]) * p->lengths[i];
    return (ref_face){normal, distance, world_bend(p, f, normal, length),
                      p->askew * rows / length};
}

/* A ball around the own space's point (0, 0, z). */
static own_face ball(real3 q, real z) {
    q.z -= z;
    real r = real3_length(q);
    own_face f = {.value = r - 1, .gradient = real3_unit(q)};
    if (r == 0) f.gradient = (real3){0, 0, 1};
    real3_frame(&f.ways[0], &f.ways[1], f.gradient);
    f.bends[0] = f.bends[1] = r > 0 ? 1 / r : (real)1e300;
    return f;
}

/* A cap at height z of that radius, and the side r = a + k z between 0 and the height. */
static own_face cap(real3 q, real z, real radius, bool up) {
    real r = REAL(sqrt)(q.x * q.x + q.y * q.y);
    own_face f = {.value = q.z - z, .gradient = {0, 0, up ? 1 : -1}, .beyond = r - radius};
    f.beyond_grad = r > 0 ? (real3){q.x / r, q.y / r, 0} : (real3){1, 0, 0};
    return f;
}
static own_face side(real3 q, real a, real k, real height) {
    real r = REAL(sqrt)(q.x * q.x + q.y * q.y);
    real3 out = r > 0 ? (real3){q.x / r, q.y / r, 0} : (real3){1, 0, 0};
    own_face f = {.value = r - a - k * q.z, .gradient = {out.x, out.y, -k}};
    f.beyond = real_max(-q.z, q.z - height);
    f.beyond_grad = (real3){0, 0, 1};
    f.ways[0] = (real3){-out.y, out.x, 0};
    f.bends[0] = 1 / (real_max(r, (real)1e-300L) * REAL(sqrt)(1 + k * k));
    return f;
}

static own_face torus(real3 q, real tube) {
    real r = REAL(sqrt)(q.x * q.x + q.y * q.y);
    real3 out = r > 0 ? (real3){q.x / r, q.y / r, 0} : (real3){1, 0, 0};
    real3 from_ring = {q.x - out.x, q.y - out.y, q.z};
    real d = real3_length(from_ring);
    own_face f = {.value = d - tube, .gradient = real3_unit(from_ring)};
    if (d == 0) f.gradient = (real3){0, 0, 1};
    f.ways[0] = (real3){-out.y, out.x, 0};
    f.ways[1] = real3_cross(f.gradient, f.ways[0]);
    f.bends[0] = real3_dot(f.gradient, out) / real_max(r, (real)1e-300L);
    f.bends[1] = 1 / tube;
    return f;
}

static int own_faces(own_face *f, const ref_primitive *p, real3 q) {
    switch (p->shape) {
    case ZT_SHAPE_SPHERE:
        f[0] = ball(q, 0);
        return 1;
    case ZT_SHAPE_CAPSULE:
        f[0] = q.z < 0 ? ball(q, 0) : q.z > p->a ? ball(q, p->a) : side(q, 1, 0, p->a);
        return 1;
    case ZT_SHAPE_TORUS:
        f[0] = torus(q, p->a);
        return 1;
    case ZT_SHAPE_DISK:
        f[0] = cap(q, 0, 1, true);
        return 1;
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE: {
        real end = p->shape == ZT_SHAPE_CONE ? p->b : 1,
             begin = p->shape == ZT_SHAPE_CONE ? p->a : 1;
        f[0] = side(q, begin, end - begin, 1);
        f[1] = cap(q, 0, begin, false);
        f[2] = cap(q, 1, end, true);
        return 3;
    }
    default: { /* a box: of each pair of faces both; beyond the further one of their ends */
        const real at[3] = {q.x, q.y, q.z};
        const real3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        for (int i = 0; i < 6; i++) {
            int axis = i / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
            real sign = i % 2 ? 1 : -1, over_u = real_abs(at[u]) - 1,
                 over_v = real_abs(at[v]) - 1;
            f[i] = (own_face){.value = at[axis] - sign,
                              .gradient = real3_scale(axes[axis], sign),
                              .beyond = real_max(over_u, over_v),
                              .beyond_grad = over_u > over_v ? axes[u] : axes[v]};
        }
        return 6;
    }
    }
}

static int solid_faces(own_face *f, const ref_primitive *p, real3 point) {
    return own_faces(f, p, to_own(p, real3_sub(point, p->center)));
}

static real segment_distance(real3 p, real3 a, real3 b) {
    real3 way = real3_sub(b, a);
    real square = real3_dot(way, way);
    real s = square > 0 ? real3_dot(real3_sub(p, a), way) / square : 0;
    s = real_max(0, real_min(1, s));
    return real3_length(real3_sub(p, real3_along(a, s, way)));
}

static ref_face triangle_face(const ref_triangle *t, real3 p) {
    real distance = real_abs(real3_dot(t->normal, real3_sub(p, t->v[0])));
    bool inside = true;
    real nearest = (real)INFINITY;
    for (int i = 0; i < 3; i++) {
        real3 a = t->v[i], b = t->v[(i + 1) % 3];
        inside &= real3_dot(real3_cross(t->normal, real3_sub(b, a)), real3_sub(p, a)) >= 0;
        nearest = real_min(nearest, segment_distance(p, a, b));
    }
    /* A needle's normal turns with the roundings of its corners. */
    return (ref_face){t->normal, inside ? distance : nearest, 1 / t->smallest, 1};
}

int ref_faces(ref_face faces[REF_FACES_MAX], const ref_primitive *p, int32_t part,
              real3 point) {
    if (p->shape == ZT_SHAPE_PLANE) {
        real distance = real_abs(real3_dot(p->normal, point) - p->level) - p->grain;
        faces[0] = (ref_face){p->normal, real_max(distance, 0), 0, 1};
        return 1;
    }
    if (p->triangle_count > 0) {
        faces[0] = triangle_face(&p->triangles[part < 0 ? 0 : part], point);
        return 1;
    }
    own_face own[REF_FACES_MAX];
    int count = solid_faces(own, p, point);
    for (int i = 0; i < count; i++) faces[i] = to_world(p, &own[i]);
    return count;
}

static int nearest(const ref_face *faces, int count) {
    int best = 0;
    for (int i = 1; i < count; i++)
        if (faces[i].distance < faces[best].distance) best = i;
    return best;
}

ref_face ref_nearest_face(const ref_primitive *p, int32_t part, real3 point) {
    ref_face faces[REF_FACES_MAX];
    int count = ref_faces(faces, p, part, point);
    return faces[nearest(faces, count)];
}

real ref_curve(const ref_primitive *p, real3 point, real3 direction) {
    if (p->shape == ZT_SHAPE_PLANE || p->triangle_count > 0) return 0;
    own_face own[REF_FACES_MAX];
    ref_face faces[REF_FACES_MAX];
    int count = solid_faces(own, p, point);
    for (int i = 0; i < count; i++) faces[i] = to_world(p, &own[i]);
    const own_face *f = &own[nearest(faces, count)];
    real3 step = to_own(p, direction);
    real sum = 0, length = real3_length(f->gradient);
    for (int i = 0; i < 2; i++) {
        real along = real3_dot(f->ways[i], step);
        sum += f->bends[i] * length * along * along;
    }
    return real_abs(sum) / real3_length(turn_back(p, f->gradient));
}
