/* How far away a primitive's surface is. Compiled once for each precision. */
#include <math.h>

#include "tracer/shapes.h"

static zt_face solid_face(const zt_primitive *p, const zt_rows *m, real x, real y, real z) {
    const real a = p->solid.a, b = p->solid.b;
    switch (p->kind) {
    case ZT_PRIMITIVE_BOX:
        return zt_box_surface(x, y, z, a, b, m);
    case ZT_PRIMITIVE_CYLINDER:
        return zt_cylinder_surface(x, y, z, a, b, m);
    case ZT_PRIMITIVE_CONE:
        return zt_cone_surface(x, y, z, a, b, m);
    case ZT_PRIMITIVE_CAPSULE:
        return zt_capsule_surface(x, y, z, a, b, m);
    case ZT_PRIMITIVE_TORUS:
        return zt_torus_surface(x, y, z, a, b, m);
    case ZT_PRIMITIVE_DISK:
        return zt_disk_surface(x, y, z, a, b, m);
    default:
        return zt_ball_surface(x, y, z, a, b, m);
    }
}

static double solid_distance(const zt_primitive *p, vec3 at) {
    const zt_rows m = {p->solid.rows[0], p->solid.rows[1], p->solid.rows[2]};
    real gx = (real)at.x - p->solid.center.x, gy = (real)at.y - p->solid.center.y,
         gz = (real)at.z - p->solid.center.z;
    zt_face f = solid_face(p, &m, real_dot(m.x.x, m.x.y, m.x.z, gx, gy, gz),
                           real_dot(m.y.x, m.y.y, m.y.z, gx, gy, gz),
                           real_dot(m.z.x, m.z.y, m.z.z, gx, gy, gz));
    real3 g = zt_gradient(&m, f.nx, f.ny, f.nz);
    return fabs((double)f.off) / vec3_length((vec3){(double)g.x, (double)g.y, (double)g.z});
}

double ZT_REAL_NAME(zt_shape_distance)(const zt_making *m, vec3 p) {
    const zt_extent *e = m->extent;
    if (m->primitive->kind == ZT_PRIMITIVE_PLANE)
        return fabs(vec3_dot(e->normal, p) - e->distance);
    if (m->primitive->kind == ZT_PRIMITIVE_SPHERE) {
        vec3 center = vec3_scale(vec3_add(e->low, e->high), 0.5);
        return fabs(vec3_length(vec3_sub(p, center)) - e->least);
    }
    vec3 away = vec3_max(vec3_max(vec3_sub(e->low, p), vec3_sub(p, e->high)), (vec3){0, 0, 0});
    double box = vec3_length(away);
    if (e->flat) return fmax(box, fabs(vec3_dot(e->normal, p) - e->distance));
    if (m->primitive->kind == ZT_PRIMITIVE_MESH) /* within, it may be anywhere */
        return fmax(box, vec3_max_abs(vec3_sub(e->high, e->low)) / 64);
    return box > 0 ? box : solid_distance(m->primitive, p);
}
