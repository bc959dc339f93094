/* From an object of the scene to a primitive. */
#ifndef ZT_TRACER_SHAPES_H
#define ZT_TRACER_SHAPES_H

#include "tracer/tracer.h"

static inline real3 to_real3(vec3 v) { return (real3){(real)v.x, (real)v.y, (real)v.z}; }

static inline bool finite3(vec3 v) { return isfinite(v.x) && isfinite(v.y) && isfinite(v.z); }

static inline vec3 zt_xform_row(const xform *m, int i) {
    return i == 0   ? (vec3){m->x.x, m->y.x, m->z.x}
           : i == 1 ? (vec3){m->x.y, m->y.y, m->z.y}
                    : (vec3){m->x.z, m->y.z, m->z.z};
}

/* One object on its way: what it is made into, and the transform of its group to the space
 * relative to the camera. */
typedef struct zt_making {
    zt_primitive *primitive;
    zt_surface *surface;
    zt_extent *extent;
    const zt_scene *scene;
    const zt_object *object;
    const xform *world;
    vec3 origin; /* of space */
} zt_making;

/* Each makes the primitive, the form of its surface and its extent; false where there is
 * nothing to hit: a radius of zero, a flattening scale, numbers that are not finite. */
bool ZT_REAL_NAME(zt_prepare_shape)(zt_making *making);
bool ZT_REAL_NAME(zt_prepare_mesh)(zt_making *making, zt_placed_mesh *placed,
                                   const zt_mesh *mesh);

/* The factor of a transform that scales alike in all directions, or -1 for another one. */
double ZT_REAL_NAME(zt_similarity_scale)(const xform *m);

/* Gives an extent and a primitive their bounds. */
void ZT_REAL_NAME(zt_set_bounds)(zt_making *making, vec3 low, vec3 high);

/* How far a point is from the surface of what was made, about: no more for a point outside of
 * its box, to first order within. */
double ZT_REAL_NAME(zt_shape_distance)(const zt_making *making, vec3 point);

#endif
