/* Each shape, in whatever group it is, becomes a primitive in the space relative to the camera.
 * Compiled once for each precision. */
#include "tracer/shapes.h"

#include <math.h>

#include "tracer/wide.h"

/* How far a transform may be from turning and scaling alike in all directions for a sphere to
 * stay a sphere: well above what products of a few rotations round to, and far below a pixel.
 */
#define SIMILARITY_TOLERANCE 1e-12

/* Things in groups that stretch no more than this one way than another are met on their right
 * sides however thin they are. */
#define PLAIN 2

/* Triangles with a smaller sine of an angle are slivers. */
#define SLIVER 0x1p-7

double ZT_REAL_NAME(zt_similarity_scale)(const xform *m) {
    double xx = vec3_dot(m->x, m->x), yy = vec3_dot(m->y, m->y), zz = vec3_dot(m->z, m->z);
    double largest = fmax(xx, fmax(yy, zz)), off = SIMILARITY_TOLERANCE * largest;
    bool similar = largest - fmin(xx, fmin(yy, zz)) <= off &&
                   fabs(vec3_dot(m->x, m->y)) <= off && fabs(vec3_dot(m->y, m->z)) <= off &&
                   fabs(vec3_dot(m->z, m->x)) <= off;
    return similar ? sqrt(xx) : -1;
}

void ZT_REAL_NAME(zt_set_bounds)(zt_making *m, vec3 low, vec3 high) {
    m->extent->low = low;
    m->extent->high = high;
    m->extent->size = fmax(vec3_max_abs(low), vec3_max_abs(high));
    /* Rounded outwards: what is made of rounded numbers may reach as far. */
    double room = 2 * (double)REAL_ROUNDING * m->extent->size;
    vec3 grow = {room, room, room};
    m->primitive->box = (zt_box){to_real3(vec3_sub(low, grow)), to_real3(vec3_add(high, grow))};
}

/* Each of the following makes one primitive and its surface; false where there is nothing to
 * hit. */

/* A plane n . p = d by way of its groups, one after the other: the normal of any length. */
typedef struct wide_plane {
    wide3 n;
    wide d;
} wide_plane;

static wide_plane plane_of_groups(const zt_making *m, vec3 normal, double distance) {
    wide_plane p = {widen(normal), distance};
    const zt_object *objects = m->scene->objects;
    for (int32_t i = m->object->parent; i >= 0; i = objects[i].parent) {
        const zt_placement *at = &objects[i].placement;
        wide_axes place = wide_placed(at->rotation, at->scale), back = wide_cofactors(place);
        wide determinant = wide_dot(back.x, place.x), side = determinant < 0 ? -1 : 1;
        wide3 n = {side * p.n.x, side * p.n.y, side * p.n.z};
        p.n = wide_combine(back, n);
        p.d = wide_abs(determinant) * p.d + wide_dot(p.n, widen(at->position));
    }
    p.d -= wide_dot(p.n, widen(m->origin));
    return p;
}

/* Of groups that stretch and turn by turns no digit can be spared: a plane is seen where its
 * own space's numbers are the largest. */
static double plane_at(vec3 *normal, const zt_making *m) {
    const zt_plane *plane = &m->object->plane;
    vec3 given = vec3_normalize(plane->normal), across = xform_normal(m->world, given);
    *normal = vec3_normalize(across);
    xform back = xform_inverse(m->world);
    if (wide_is_askew(m->world, &back)) {
        wide_plane p = plane_of_groups(m, given, plane->distance);
        wide scale = 1 / wide_max_abs(p.n);
        across = wide_narrow(p.n, scale);
        *normal = vec3_normalize(across);
        return (double)(p.d * scale) / vec3_length(across);
    }
    /* Not by way of a point of it, which a group may take far along it. */
    return plane->distance * fabs(xform_determinant(m->world)) / vec3_length(across) +
           vec3_dot(*normal, m->world->shift);
}

static bool prepare_plane(zt_making *m) {
    vec3 normal;
    double distance = plane_at(&normal, m);
    if (vec3_max_abs(normal) == 0 || !finite3(normal) || !isfinite(distance)) return false;
    zt_primitive *p = m->primitive;
    p->kind = ZT_PRIMITIVE_PLANE;
    p->plane.normal = to_real3(normal);
    p->plane.distance = (real)distance;
    m->surface->normal = p->plane.normal;
    m->surface->level = p->plane.distance;
    zt_extent *e = m->extent;
    e->flat = true;
    e->normal = normal;
    e->distance = distance;
    e->low = (vec3){-INFINITY, -INFINITY, -INFINITY};
    e->high = (vec3){INFINITY, INFINITY, INFINITY};
    e->size = fabs(distance);
    return true;
}

/* The unit normal; zero where there is no area. Of slivers the double's cross product has few
 * right digits. */
static vec3 triangle_normal(const vec3 *v) {
    vec3 plain =
        vec3_cross(vec3_normalize(vec3_sub(v[1], v[0])), vec3_normalize(vec3_sub(v[2], v[0])));
    if (vec3_max_abs(plain) > SLIVER) return vec3_normalize(plain);
    wide3 corner = widen(v[0]);
    wide3 across = wide_cross(wide_sub(widen(v[1]), corner), wide_sub(widen(v[2]), corner));
    wide longest = wide_max_abs(across);
    return longest > 0 ? vec3_normalize(wide_narrow(across, 1 / longest)) : (vec3){0, 0, 0};
}

static bool prepare_triangle(zt_making *m) {
    vec3 v[3];
    for (int i = 0; i < 3; i++) {
        v[i] = xform_point(m->world, m->object->triangle.vertices[i]);
        if (!finite3(v[i])) return false;
        m->primitive->triangle.vertices[i] = to_real3(v[i]);
    }
    vec3 normal = triangle_normal(v);
    if (vec3_max_abs(normal) == 0) return false;
    m->primitive->kind = ZT_PRIMITIVE_TRIANGLE;
    m->surface->normal = to_real3(normal);
    m->surface->center = m->primitive->triangle.vertices[0];
    ZT_REAL_NAME(zt_set_bounds)
    (m, vec3_min(v[0], vec3_min(v[1], v[2])), vec3_max(v[0], vec3_max(v[1], v[2])));
    zt_extent *e = m->extent;
    e->flat = true;
    e->normal = normal;
    e->distance = vec3_dot(normal, v[0]);
    return true;
}

static vec3 axis_of(const xform *place, int i) {
    return i == 0 ? place->x : i == 1 ? place->y : place->z;
}

/* A solid whose own space `place` takes to the space relative to the camera; there it reaches
 * `round` from its axis z in each direction across (or `square` along x and y), and from `low`
 * to `high` along the axis. */
static bool make_solid(zt_making *m, zt_primitive_kind kind, const xform *place, double round,
                       double square, double low, double high, double ball) {
    xform back = wide_inverse(place);
    if (!finite3(place->shift)) return false;
    vec3 rows[3], reach, middle = xform_point(place, (vec3){0, 0, (low + high) / 2});
    double half = (high - low) / 2, longest = 0, longest_back = 0;
    double reaches[3], thin = INFINITY;
    for (int i = 0; i < 3; i++) {
        rows[i] = zt_xform_row(&back, i);
        if (!finite3(rows[i])) return false;
        vec3 r = zt_xform_row(place, i);
        reaches[i] = round * hypot(r.x, r.y) + square * (fabs(r.x) + fabs(r.y)) +
                     ball * vec3_length(r) + half * fabs(r.z);
        longest = fmax(longest, vec3_length(r));
        double back_length = vec3_length(rows[i]);
        longest_back = fmax(longest_back, back_length);
        thin = fmin(thin, (i == 2 && half > 0 ? half + ball : 1) / back_length);
        m->extent->askew = fmax(m->extent->askew, vec3_length(axis_of(place, i)) * back_length);
        m->primitive->solid.rows[i] = to_real3(rows[i]);
    }
    reach = (vec3){reaches[0], reaches[1], reaches[2]};
    if (!finite3(middle) || !finite3(reach)) return false;
    m->primitive->kind = kind;
    m->surface->closed = kind != ZT_PRIMITIVE_DISK;
    m->primitive->solid.center = to_real3(place->shift);
    ZT_REAL_NAME(zt_set_bounds)(m, vec3_sub(middle, reach), vec3_add(middle, reach));
    m->primitive->stretch = (real)(longest * longest_back);
    m->extent->stretch = longest * longest_back;
    m->extent->middle = middle;
    m->extent->ways[0] = place->x;
    m->extent->ways[1] = place->y;
    m->extent->ways[2] = vec3_scale(place->z, half);
    m->extent->faces = square > 0 ? 7 : round > 0 && half > 0 ? 4 : 0;
    m->extent->least =
        fmin(vec3_length(place->x), fmin(vec3_length(place->y), vec3_length(place->z)));
    xform undone = xform_inverse(m->world);
    if (wide_longest(m->world) * wide_longest(&undone) > PLAIN) m->extent->thin = thin;
    return true;
}

/* The places of the solids: which way their axis runs, and how long a unit is across it. */
static xform place_along(const xform *world, vec3 center, vec3 axis, double across) {
    vec3 z = vec3_normalize(axis), a = {fabs(z.x), fabs(z.y), fabs(z.z)};
    vec3 least = a.x <= a.y && a.x <= a.z ? (vec3){1, 0, 0}
                 : a.y <= a.z             ? (vec3){0, 1, 0}
                                          : (vec3){0, 0, 1};
    vec3 x = vec3_normalize(vec3_cross(least, z)), y = vec3_cross(z, x);
    xform own = {vec3_scale(x, across), vec3_scale(y, across), axis, center};
    return xform_mul(world, &own);
}

static bool prepare_sphere(zt_making *m) {
    const zt_sphere *sphere = &m->object->sphere;
    double scale = ZT_REAL_NAME(zt_similarity_scale)(m->world);
    vec3 center = xform_point(m->world, sphere->center);
    if (scale < 0) {
        xform place = {vec3_scale(m->world->x, sphere->radius),
                       vec3_scale(m->world->y, sphere->radius),
                       vec3_scale(m->world->z, sphere->radius), center};
        return make_solid(m, ZT_PRIMITIVE_BALL, &place, 0, 0, 0, 0, 1);
    }
    double radius = sphere->radius * scale;
    if (!(radius > 0) || !isfinite(radius) || !finite3(center)) return false;
    zt_primitive *p = m->primitive;
    p->kind = ZT_PRIMITIVE_SPHERE;
    p->sphere.center = to_real3(center);
    p->sphere.radius = (real)radius;
    vec3 reach = {radius, radius, radius};
    ZT_REAL_NAME(zt_set_bounds)(m, vec3_sub(center, reach), vec3_add(center, reach));
    m->surface->bend = (real)(1 / radius);
    m->surface->center = p->sphere.center;
    m->surface->level = p->sphere.radius;
    m->surface->closed = 1;
    m->extent->least = radius;
    return true;
}

static bool prepare_disk(zt_making *m) {
    const zt_disk *disk = &m->object->disk;
    vec3 axis = vec3_scale(vec3_normalize(disk->normal), disk->radius);
    xform place = place_along(m->world, disk->center, axis, disk->radius);
    if (!make_solid(m, ZT_PRIMITIVE_DISK, &place, 1, 0, 0, 0, 0)) return false;
    zt_extent *e = m->extent;
    e->flat = true;
    e->normal = vec3_normalize(vec3_cross(place.x, place.y));
    e->distance = vec3_dot(e->normal, place.shift);
    return true;
}

static bool prepare_box(zt_making *m) {
    const zt_block *box = &m->object->box;
    xform own = xform_place(box->center, box->rotation, vec3_scale(box->size, 0.5));
    xform place = xform_mul(m->world, &own);
    return make_solid(m, ZT_PRIMITIVE_BOX, &place, 0, 1, -1, 1, 0);
}

static bool prepare_tube(zt_making *m) {
    const zt_tube *tube = &m->object->tube;
    bool cone = m->object->shape == ZT_SHAPE_CONE;
    double wide = cone ? fmax(tube->radius, tube->end_radius) : tube->radius;
    xform place = place_along(m->world, tube->from, vec3_sub(tube->to, tube->from), wide);
    m->primitive->solid.a = cone ? (real)(tube->radius / wide) : 1;
    m->primitive->solid.b = cone ? (real)(tube->end_radius / wide) : 1;
    if (m->primitive->solid.a == m->primitive->solid.b)
        return make_solid(m, ZT_PRIMITIVE_CYLINDER, &place, 1, 0, 0, 1, 0);
    if (!make_solid(m, ZT_PRIMITIVE_CONE, &place, 1, 0, 0, 1, 0)) return false;
    /* At its rim its two faces are the nearer to each other the flatter it is. */
    m->extent->thin = fmin(m->extent->thin, 0.5 * vec3_length(axis_of(&place, 2)));
    return true;
}

static bool prepare_capsule(zt_making *m) {
    const zt_tube *tube = &m->object->tube;
    vec3 way = vec3_sub(tube->to, tube->from);
    double length = vec3_length(way) / tube->radius;
    vec3 axis =
        length > 0 ? vec3_scale(vec3_normalize(way), tube->radius) : (vec3){0, 0, tube->radius};
    xform place = place_along(m->world, tube->from, axis, tube->radius);
    m->primitive->solid.a = (real)length;
    return isfinite(length) && make_solid(m, ZT_PRIMITIVE_CAPSULE, &place, 0, 0, 0, length, 1);
}

static bool prepare_torus(zt_making *m) {
    const zt_torus *torus = &m->object->torus;
    vec3 axis = vec3_scale(vec3_normalize(torus->axis), torus->radius);
    xform place = place_along(m->world, torus->center, axis, torus->radius);
    double tube = torus->tube_radius / torus->radius;
    if (!(tube > 0) || !isfinite(tube)) return false;
    m->primitive->solid.a = (real)fmin(tube, 1);
    bool there = make_solid(m, ZT_PRIMITIVE_TORUS, &place, 1, 0, 0, 0, fmin(tube, 1));
    m->extent->thin *= fmin(tube, 1);
    return there;
}

/* ---- from shapes to primitives --------------------------------------------------------------
 */

bool ZT_REAL_NAME(zt_prepare_shape)(zt_making *m) {
    switch (m->object->shape) {
    case ZT_SHAPE_PLANE:
        return prepare_plane(m);
    case ZT_SHAPE_SPHERE:
        return prepare_sphere(m);
    case ZT_SHAPE_TRIANGLE:
        return prepare_triangle(m);
    case ZT_SHAPE_DISK:
        return prepare_disk(m);
    case ZT_SHAPE_BOX:
        return prepare_box(m);
    case ZT_SHAPE_CYLINDER:
    case ZT_SHAPE_CONE:
        return prepare_tube(m);
    case ZT_SHAPE_TORUS:
        return prepare_torus(m);
    case ZT_SHAPE_CAPSULE:
        return prepare_capsule(m);
    case ZT_SHAPE_MESH:
    case ZT_SHAPE_GROUP:
    case ZT_SHAPE_COUNT:
        break;
    }
    return false;
}

bool ZT_REAL_NAME(zt_prepare_mesh)(zt_making *m, zt_placed_mesh *placed, const zt_mesh *mesh) {
    const zt_placement *p = &m->object->placement;
    xform own = xform_place(p->position, p->rotation, p->scale);
    xform place = xform_mul(m->world, &own);
    double determinant = xform_determinant(&place);
    if (determinant == 0 || !isfinite(determinant) || !finite3(place.shift)) return false;
    vec3 half = vec3_scale(vec3_sub(mesh->high, mesh->low), 0.5);
    vec3 middle = xform_point(&place, vec3_add(mesh->low, half));
    place.shift = xform_point(&place, mesh->origin);
    xform back = wide_inverse(&place);
    double reach = 0, across = 0, across_back = 0;
    double reaches[3];
    for (int i = 0; i < 3; i++) {
        placed->rows[i] = zt_xform_row(&back, i);
        vec3 r = zt_xform_row(&place, i);
        reaches[i] = fabs(r.x) * half.x + fabs(r.y) * half.y + fabs(r.z) * half.z;
        reach = fmax(reach, 3 * vec3_max_abs(placed->rows[i]));
        across = fmax(across, vec3_length(r));
        double back_length = vec3_length(placed->rows[i]);
        across_back = fmax(across_back, back_length);
        m->extent->askew =
            fmax(m->extent->askew, vec3_length(axis_of(&place, i)) * back_length);
    }
    vec3 around = {reaches[0], reaches[1], reaches[2]};
    placed->at = back.shift;
    placed->place = place;
    placed->places = NULL;
    placed->smooth = m->object->smooth && mesh->normals;
    placed->vertex_colors = m->object->vertex_colors && mesh->colors;
    m->primitive->kind = ZT_PRIMITIVE_MESH;
    m->surface->closed = -1;
    ZT_REAL_NAME(zt_set_bounds)(m, vec3_sub(middle, around), vec3_add(middle, around));
    m->extent->middle = middle;
    m->extent->ways[0] = vec3_scale(place.x, half.x);
    m->extent->ways[1] = vec3_scale(place.y, half.y);
    m->extent->ways[2] = vec3_scale(place.z, half.z);
    m->extent->faces = 7;
    m->extent->perhaps = true;
    double inner = fmax(vec3_max_abs(vec3_sub(mesh->low, mesh->origin)),
                        vec3_max_abs(vec3_sub(mesh->high, mesh->origin)));
    m->extent->stretch = across * across_back;
    if (m->extent->stretch > PLAIN) m->extent->thin = inner / across_back;
    placed->reach = (real)reach;
    placed->inner = (real)inner;
    placed->room = (real)(reach * vec3_max_abs(place.shift) + inner);
    double longest =
        fmax(vec3_max_abs(place.x), fmax(vec3_max_abs(place.y), vec3_max_abs(place.z)));
    placed->extent = (real)(vec3_max_abs(place.shift) + 3 * longest * inner);
    return finite3(middle) && finite3(around) && finite3(placed->at);
}
