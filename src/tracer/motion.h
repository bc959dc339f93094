/* What moves while the shutter is open: where it is at each moment of the exposure, as numbers
 * that go straight on from one moment to the next. Rays interpolate them, each at its own time.
 * Made with the tracer, in the frame's arena. */
#ifndef ZT_TRACER_MOTION_H
#define ZT_TRACER_MOTION_H

#include "tracer/shapes.h"

/* A primitive's pose is these numbers, in this order:
 *   plane      normal (of any length) and distance
 *   sphere     center and radius
 *   triangle   the three corners
 *   solids     the axes x, y and z of the transform out of the solid's own space, in units of
 *              zt_primitive.unit, and the center, where that space's origin comes to. It is
 * told forward, so that points go straight on, and inverted for each ray. Of those with two
 * sizes, p and q follow: cone       the radii at 0 and 1, by the larger of which x and y are
 * still to be multiplied capsule    its length and its radius; all axes are still to be
 * multiplied by the latter torus      the tube's radius and the circle's, likewise with the
 * largest that the multiplier ever is for 1, and the axes the longer for that. The table has,
 * for each moment but the last, the pose and then how much it changes up to the next one. */
enum { ZT_POSE_NUMBERS = 14, ZT_POSE_AXES = 12 };

static inline int zt_pose_size(zt_primitive_kind kind) {
    switch (kind) {
    case ZT_PRIMITIVE_PLANE:
    case ZT_PRIMITIVE_SPHERE:
        return 4;
    case ZT_PRIMITIVE_TRIANGLE:
        return 9;
    case ZT_PRIMITIVE_CONE:
    case ZT_PRIMITIVE_CAPSULE:
    case ZT_PRIMITIVE_TORUS:
        return ZT_POSE_NUMBERS;
    default:
        return ZT_POSE_AXES;
    }
}

/* What is known of the exposure when objects are prepared. */
typedef struct zt_course {
    const zt_exposure *exposure;
    xform *worlds; /* of each object, moment after moment: zt_scene_worlds */
    bool *moves;   /* of each object: it or a group that it is in is not always the same */
    double *poses; /* room for one object's at all moments */
    zt_arena *arena;
} zt_course;

/* Whether an object and all groups that it is in are the same at all moments is found out. */
zt_status ZT_REAL_NAME(zt_course_make)(zt_course *course, const zt_exposure *exposure,
                                       zt_arena *arena);

static inline xform *zt_course_worlds(const zt_course *c, int32_t moment) {
    return c->worlds + (size_t)moment * (size_t)c->exposure->moments->object_count;
}

/* Gives a primitive that was made at some moment its poses, and a box around all of them.
 * Clears `there` where it has nothing to hit at any time. Not for meshes. */
zt_status ZT_REAL_NAME(zt_prepare_motion)(bool *there, zt_making *making,
                                          const zt_course *course);

/* The same for a mesh. */
zt_status ZT_REAL_NAME(zt_prepare_mesh_motion)(bool *there, zt_making *making,
                                               zt_placed_mesh *placed, const zt_course *course);

/* ---- looks ----------------------------------------------------------------------------------
 */

/* A material at one moment, and where its pattern is: doubles all, so that they may be
 * interpolated one by one. */
typedef struct zt_looks {
    vec3 color;
    double reflectivity;
    vec3 other_color;
    xform place; /* out of the space of the pattern */
    vec3 across; /* of stripes: of unit length; else unused */
    double size;
} zt_looks;

/* Of a primitive. */
struct zt_change {
    const zt_looks *looks; /* at each moment; NULL: they stay the same */
    zt_pattern pattern;
};

/* Leaves `looks` NULL where they stay the same. */
zt_status ZT_REAL_NAME(zt_prepare_looks)(zt_change *change, const zt_object *object,
                                         int32_t index, const zt_course *course);

/* Where the pattern of an object's material is. */
xform ZT_REAL_NAME(zt_pattern_place)(const zt_object *object, const xform *world);

#endif
