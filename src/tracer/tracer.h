/* The tracer: a scene made ready for rays. Lives for one frame, in the frame's arena. */
#ifndef ZT_TRACER_TRACER_H
#define ZT_TRACER_TRACER_H

#include <stdint.h>

#include <zoetrope/status.h>

#include "base/arena.h"
#include "scene/scene.h"
#include "tracer/meshes.h"
#include "tracer/primitives.h"
#include "tracer/ray.h"

/* The surface of a plane, sphere or triangle: of a point p near it, the normal n is the unit
 * vector along normal + bend (p - center), and n . (p - center) - level is the distance that p
 * still has to it. One form for all three, so that one loop without branches serves them. Rows
 * of other kinds are zero. */
typedef struct zt_surface {
    real3 normal;
    real bend;
    real3 center;
    real level;
    real extent; /* the largest coordinate or length in its arithmetic */
    real3 color;
    real reflectivity;
} zt_surface;

typedef struct zt_lamp {
    real3 position;
    real3 power; /* color * intensity */
    int32_t shadows;
} zt_lamp;

typedef struct zt_tracer {
    const zt_primitive *primitives;
    const zt_surface *surfaces; /* one for each primitive */
    int32_t primitive_count;
    const zt_lamp *lamps; /* the point lights, in order */
    int32_t lamp_count;
    real3 ambient; /* the sum of the ambient lights */
    int32_t reflection_depth;
    const zt_meshes *meshes; /* NULL where the scene has none */
    bool has_other_surfaces; /* some primitives need more than their zt_surface */
} zt_tracer;

/* Makes a scene ready. Things that are degenerate (a radius of zero, a flattening scale,
 * numbers that are not finite) have nothing to hit and are left out. */
zt_status zt_tracer_prepare(zt_tracer *tracer, const zt_scene *scene, zt_meshes *meshes,
                            zt_arena *arena);

#endif
