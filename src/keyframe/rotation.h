/* Rotations between keys: unit quaternions on their sphere. */
#ifndef ZT_KEYFRAME_ROTATION_H
#define ZT_KEYFRAME_ROTATION_H

#include <stdint.h>

#include "base/quat.h"

/* The unit quaternion along q, whatever its magnitude; zero becomes the identity. What is of
 * unit length already, but for rounding, keeps its bits. */
quat zt_rotation_unit(quat q);

/* Makes a chain of keys ready for interpolation: unit lengths, and signs such that each step
 * takes the short way. A half turn, for which both ways are equally short, keeps the sign that
 * the two keys were given with; so Euler angles of 0, 180 and 360 degrees go round once. */
void zt_rotation_align(quat *keys, int32_t count);

/* From a to b along the great circle at constant speed; both of unit length, not opposite to
 * each other. Stable for any separation (half-chord angle: W. Kahan, "How Futile are Mindless
 * Assessments of Roundoff", 2006, section 12). */
quat zt_rotation_slerp(quat a, quat b, double u);

/* One segment of a C1 curve through rotations: a cubic Bezier curve on the sphere as a product
 * of three turns (Kim, Kim and Shin, "A General Construction Scheme for Unit Quaternion
 * Curves", 1995). The turns are logarithms: unit axis times half the angle, in the frame of the
 * first key. */
typedef struct zt_rotation_arc {
    vec3 turns[3];
} zt_rotation_arc;

/* Works out the count - 1 arcs through aligned keys. The angular velocity at a key is the
 * limited mean of its two steps (Steffen 1990, carried over to turns), zero at both ends; turns
 * around one axis never overshoot. */
void zt_rotation_smooth(zt_rotation_arc *arcs, const quat *keys, const double *times,
                        int32_t count);

/* The rotation at u in 0..1 of an arc that begins at a. */
quat zt_rotation_arc_eval(const zt_rotation_arc *arc, quat a, double u);

#endif
