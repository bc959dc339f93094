/* Rotations: ways to write them, and ways between them on the sphere of unit quaternions. */
#ifndef ZT_KEYFRAME_ROTATION_H
#define ZT_KEYFRAME_ROTATION_H

#include <stdbool.h>

#include "base/quat.h"

/* ---- as they are written -------------------------------------------------------------------
 */

/* The unit quaternion along q, whatever its magnitude; zero becomes the identity. What is of
 * unit length already, but for rounding, keeps its bits. */
quat zt_rotation_unit(quat q);

/* Whether `order` is the letters x, y and z, each once. */
bool zt_rotation_order_is_sound(const char *order);

/* Turns around the fixed axes by angles.x, .y and .z radians, one after the other: "xyz" turns
 * around x first. */
quat zt_rotation_euler(vec3 angles, const char *order);

/* A turn around `turn` by its length in radians, more than once round included. */
quat zt_rotation_of_turn(vec3 turn);

/* Looks along `direction` as a camera does: -z points there, and y as far along `up` as can be;
 * then rolled counterclockwise by `roll` radians, seen from behind. Where direction and up are
 * the same, some right angle is chosen; without a direction, only the roll is left. */
quat zt_rotation_look(vec3 direction, vec3 up, double roll);

/* ---- between them --------------------------------------------------------------------------
 */

/* The angle of the turn that takes a to b the short way, 0..pi radians, exact for small ones.
 * At pi both ways are equally short. */
double zt_rotation_angle(quat a, quat b);

/* -1 where b must change its sign for the short way from a, else 1. Half turns, for which both
 * ways are equally short, keep the signs that the two were given with; so Euler angles of 0,
 * 180 and 360 degrees go round once. */
double zt_rotation_short_way(quat a, quat b);

/* From a to b along the great circle at constant speed, and on for u outside of 0..1; both of
 * unit length. Stable for any separation (half-chord angle: W. Kahan, "How Futile are Mindless
 * Assessments of Roundoff", 2006, section 12). */
quat zt_rotation_slerp(quat a, quat b, double u);

/* A turn as the logarithm of its quaternion, and back: unit axis times half the angle, of at
 * most pi, once round. */
vec3 zt_rotation_log(quat q);
quat zt_rotation_exp(vec3 half_turn);

/* A piece of a C1 curve through rotations: a cubic Bezier curve on the sphere as a product of
 * three turns (Kim, Kim and Shin, "A General Construction Scheme for Unit Quaternion Curves",
 * 1995). */
typedef struct zt_rotation_arc {
    vec3 half_turns[3];
} zt_rotation_arc;

/* From a to b. `leave` and `arrive` are the half turns that it would make at the speed of its
 * begin and of its end, around axes in the frame of a and of b. */
zt_rotation_arc zt_rotation_arc_make(quat a, quat b, vec3 leave, vec3 arrive);

/* The rotation at u in 0..1 of an arc that begins at a. */
quat zt_rotation_arc_eval(const zt_rotation_arc *arc, quat a, double u);

/* The angular velocity, in the turned frame, of a rotation whose turn (axis times angle) moves
 * at `turn_speed`, and back; back not where the turn is once round or more. J. Stuelpnagel,
 * "On the parametrization of the three-dimensional rotation group", 1964. */
vec3 zt_rotation_velocity(vec3 turn, vec3 turn_speed);
vec3 zt_rotation_turn_speed(vec3 turn, vec3 velocity);

#endif
