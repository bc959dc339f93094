#include "scene/clearance.h"

/* A point by its distance along an axis and from it. */
typedef struct turned {
    double along, off;
} turned;

/* `axis` is of unit length. */
static turned turn(vec3 point, vec3 origin, vec3 axis) {
    vec3 p = vec3_sub(point, origin);
    double along = vec3_dot(p, axis);
    return (turned){along, vec3_length(vec3_sub(p, vec3_scale(axis, along)))};
}

/* From a point to the straight way between two others. */
static double segment_distance(turned p, turned a, turned b) {
    double x = b.along - a.along, y = b.off - a.off, square = x * x + y * y;
    double s = square > 0 ? ((p.along - a.along) * x + (p.off - a.off) * y) / square : 0;
    s = fmin(fmax(s, 0), 1);
    return hypot(p.along - a.along - s * x, p.off - a.off - s * y);
}

static double plane_distance(const zt_plane *plane, vec3 point) {
    vec3 normal = vec3_normalize(plane->normal);
    if (vec3_max_abs(normal) == 0) return INFINITY;
    return fabs(vec3_dot(normal, point) - plane->distance);
}

static double disk_distance(const zt_disk *disk, vec3 point) {
    vec3 normal = vec3_normalize(disk->normal);
    if (vec3_max_abs(normal) == 0 || !(disk->radius > 0)) return INFINITY;
    turned p = turn(point, disk->center, normal);
    return hypot(p.along, fmax(p.off - disk->radius, 0));
}

static double box_distance(const zt_block *box, vec3 point) {
    if (!(fmin(box->size.x, fmin(box->size.y, box->size.z)) > 0)) return INFINITY;
    xform place = xform_place((vec3){0, 0, 0}, box->rotation, (vec3){1, 1, 1});
    vec3 q = vec3_sub(point, box->center);
    vec3 beyond = {fabs(vec3_dot(q, place.x)) - box->size.x / 2,
                   fabs(vec3_dot(q, place.y)) - box->size.y / 2,
                   fabs(vec3_dot(q, place.z)) - box->size.z / 2};
    double most = fmax(beyond.x, fmax(beyond.y, beyond.z));
    return most < 0 ? most : vec3_length(vec3_max(beyond, (vec3){0, 0, 0}));
}

/* Of cylinders and cones: what is around the axis is a polygon of two ends and a side. */
static double tube_distance(const zt_tube *tube, double end_radius, vec3 point) {
    vec3 way = vec3_sub(tube->to, tube->from);
    double length = vec3_length(way), radius = tube->radius;
    if (!(length > 0) || !(fmax(radius, end_radius) > 0)) return INFINITY;
    turned p = turn(point, tube->from, vec3_normalize(way));
    const turned corners[] = {{0, 0}, {0, radius}, {length, end_radius}, {length, 0}};
    double least = INFINITY;
    for (int i = 0; i < 3; i++)
        least = fmin(least, segment_distance(p, corners[i], corners[i + 1]));
    double side = radius + (end_radius - radius) * (p.along / length);
    bool within = p.along > 0 && p.along < length && p.off < side;
    return within ? -least : least;
}

static double capsule_distance(const zt_tube *capsule, vec3 point) {
    vec3 way = vec3_sub(capsule->to, capsule->from);
    if (!(capsule->radius > 0)) return INFINITY;
    turned p = turn(point, capsule->from, vec3_normalize(way));
    return segment_distance(p, (turned){0, 0}, (turned){vec3_length(way), 0}) - capsule->radius;
}

static double torus_distance(const zt_torus *torus, vec3 point) {
    vec3 axis = vec3_normalize(torus->axis);
    if (vec3_max_abs(axis) == 0 || !(torus->tube_radius > 0)) return INFINITY;
    turned p = turn(point, torus->center, axis);
    return hypot(p.along, p.off - torus->radius) - torus->tube_radius;
}

/* Christer Ericson, "Real-Time Collision Detection", 2005, section 5.1.5. */
static double triangle_distance(vec3 a, vec3 b, vec3 c, vec3 point) {
    vec3 ab = vec3_sub(b, a), ac = vec3_sub(c, a), ap = vec3_sub(point, a);
    vec3 bp = vec3_sub(point, b), cp = vec3_sub(point, c), bc = vec3_sub(c, b);
    double d1 = vec3_dot(ab, ap), d2 = vec3_dot(ac, ap), d3 = vec3_dot(ab, bp);
    double d4 = vec3_dot(ac, bp), d5 = vec3_dot(ab, cp), d6 = vec3_dot(ac, cp);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    vec3 from; /* the point, seen from the nearest one */
    if (d1 <= 0 && d2 <= 0)
        from = ap;
    else if (d3 >= 0 && d4 <= d3)
        from = bp;
    else if (d6 >= 0 && d5 <= d6)
        from = cp;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
        from = vec3_sub(ap, vec3_scale(ab, d1 / (d1 - d3)));
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
        from = vec3_sub(ap, vec3_scale(ac, d2 / (d2 - d6)));
    else if (va <= 0 && d4 >= d3 && d5 >= d6)
        from = vec3_sub(bp, vec3_scale(bc, (d4 - d3) / ((d4 - d3) + (d5 - d6))));
    else {
        vec3 normal = vec3_normalize(vec3_cross(ab, ac));
        from = vec3_scale(normal, vec3_dot(normal, ap));
    }
    return vec3_length(from);
}

double zt_clearance(const zt_object *object, vec3 point) {
    const zt_tube *tube = &object->tube;
    const vec3 *v = object->triangle.vertices;
    if (!isfinite(point.x) || !isfinite(point.y) || !isfinite(point.z)) return INFINITY;
    switch (object->shape) {
    case ZT_SHAPE_PLANE:
        return plane_distance(&object->plane, point);
    case ZT_SHAPE_SPHERE:
        if (!(object->sphere.radius > 0)) return INFINITY;
        return vec3_length(vec3_sub(point, object->sphere.center)) - object->sphere.radius;
    case ZT_SHAPE_TRIANGLE:
        return triangle_distance(v[0], v[1], v[2], point);
    case ZT_SHAPE_DISK:
        return disk_distance(&object->disk, point);
    case ZT_SHAPE_BOX:
        return box_distance(&object->box, point);
    case ZT_SHAPE_CYLINDER:
        return tube_distance(tube, tube->radius, point);
    case ZT_SHAPE_CONE:
        return tube_distance(tube, tube->end_radius, point);
    case ZT_SHAPE_TORUS:
        return torus_distance(&object->torus, point);
    case ZT_SHAPE_CAPSULE:
        return capsule_distance(tube, point);
    case ZT_SHAPE_MESH:
    case ZT_SHAPE_GROUP:
    case ZT_SHAPE_COUNT:
        break;
    }
    return INFINITY;
}

double zt_mesh_clearance(const zt_mesh *mesh, vec3 point) {
    double least = INFINITY;
    for (int32_t i = 0; i < mesh->triangle_count; i++)
        least = fmin(least,
                     triangle_distance(zt_mesh_corner(mesh, i, 0), zt_mesh_corner(mesh, i, 1),
                                       zt_mesh_corner(mesh, i, 2), point));
    return least;
}
