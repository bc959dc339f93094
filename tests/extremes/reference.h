/* A ray tracer by brute force in the reference's numbers (113 bits where the compiler has
 * them): what the tracer under test is held against. Each object is asked about each ray; no
 * hierarchy, no batch, no rounding that matters. The doubles of the scene are the truth.
 *
 * Space is relative to the camera, as rays are given. */
#ifndef ZT_TESTS_REFERENCE_H
#define ZT_TESTS_REFERENCE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/arena.h"
#include "real3.h"
#include "scene/scene.h"

typedef struct ref_triangle {
    real3 v[3];
    real3 normal;  /* unit; zero where it has no area */
    vec3 around;   /* the middle of a ball around it */
    double reach;  /* and how large that is, rounded up */
    real smallest; /* its smallest height: how sensitive the normal is */
} ref_triangle;

/* What one object is to rays. Solids and disks live in a space of their own, where f = M (p -
 * center), M given by rows: sphere: the unit sphere. Box: -1 to 1. Cylinder: radius 1 around z
 * from 0 to 1. Cone: likewise, radius a at 0 and b at 1. Torus: the ring of radius 1 around z,
 * its tube's radius a. Capsule: radius 1 around z from 0 to a. Disk: radius 1 in z = 0. */
typedef struct ref_primitive {
    zt_shape shape;
    int32_t object; /* its index in the scene */
    bool present;   /* false where it is degenerate: nothing to hit */
    real3 rows[3];
    real lengths[3]; /* of the rows */
    real3 center;
    real a, b;
    real askew; /* the condition number of its groups' transform, 1 where that is a rotation */
    affine place; /* from its own space to the world, */
    real3 middle; /* and a ball around it there */
    real round;
    real3 normal; /* of a plane: unit, normal . p = level */
    real level;
    ref_triangle *triangles; /* of a triangle or mesh */
    int32_t triangle_count;
    real extent; /* how far its reference point is from the origin, and its size */
    real grain;  /* of a plane far from the world's origin: what doubles can say of it */
    vec3 around; /* a ball around it in the world; of a plane: endless */
    double reach;
} ref_primitive;

typedef struct ref_scene {
    const zt_scene *scene;
    ref_primitive *primitives; /* one for each object, groups too */
    real3 *lights;             /* positions of the scene's lights */
} ref_scene;

/* A ray that leaves a surface carries which: that surface is not met again where it leaves. */
typedef struct ref_ray {
    real3 o, d;
    int32_t source_object, source_part; /* or -1 */
} ref_ray;

typedef struct ref_hit {
    int32_t object, part; /* -1 where nothing is hit; part is the triangle of a mesh */
    real t;
} ref_hit;

/* Makes a scene ready; false when out of memory. The scene must outlive the result. */
bool ref_prepare(ref_scene *ref, const zt_scene *scene, zt_arena *arena);

/* The first crossing of one primitive in (from, to), the ray's source left out where the ray
 * leaves it. */
bool ref_first(ref_hit *hit, const ref_primitive *p, const ref_ray *ray, real from, real to);

/* The same for solids and disks: a part of the above. */
bool ref_solid_first(real *t, const ref_primitive *p, const ref_ray *ray, real from, real to);

/* Real roots of s^4 + a s^2 + b s + c within [-limit, limit], ascending; how many. */
int ref_quartic(real roots[4], real a, real b, real c, real limit);

/* The nearest hit of the scene; of equally near ones the object of the lowest index. */
ref_hit ref_nearest(const ref_scene *ref, const ref_ray *ray);

/* Whether anything is met in (0, to), and whether that is beyond doubt: `sure` is set where it
 * stays so when the ray is moved, to any side, by `tolerance` of the numbers that go into it.
 * `only` asks about one object, -1 about all. */
bool ref_blocked(bool *sure, const ref_scene *ref, const ref_ray *ray, real to, real tolerance,
                 int32_t only);

/* A face of a primitive near a point. */
typedef struct ref_face {
    real3 normal;  /* unit, outward; of what is flat: as given */
    real distance; /* of the point to it */
    real bend;     /* how much the normal turns for a step of one */
    real twist;    /* and how much for a relative change of one of the primitive's numbers */
} ref_face;
enum { REF_FACES_MAX = 6 };

/* The faces of a primitive as seen from a point; part is a mesh's triangle. */
int ref_faces(ref_face faces[REF_FACES_MAX], const ref_primitive *p, int32_t part, real3 point);

/* The face nearest to the point. */
ref_face ref_nearest_face(const ref_primitive *p, int32_t part, real3 point);

/* The size of the numbers that go into meeting a primitive: what relative errors refer to. */
static inline real ref_scale(const ref_primitive *p, const ref_ray *ray, real t) {
    return real3_length(ray->o) + real_abs(t) * real3_length(ray->d) + p->extent;
}

/* How much the face nearest to a point bends along a unit direction: one over the radius. */
real ref_curve(const ref_primitive *p, real3 point, real3 direction);

/* The light seen along a ray in the model of src/tracer/classic.h. */
void ref_trace(real light[3], const ref_scene *ref, const ref_ray *ray);

#endif
