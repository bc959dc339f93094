/* How fast a curve goes, by formulas. */
#ifndef ZT_KEYFRAME_VELOCITY_H
#define ZT_KEYFRAME_VELOCITY_H

#include "keyframe/curve.h"

/* The derivative by time, a second, just after a moment: one number for each of the value; of
 * rotations the angular velocity in radians around the three axes. False, with nothing written,
 * where there is no formula here: on eased ways, in Oklab, between turns, on arcs of rotations,
 * and where a loop goes back. */
bool zt_curve_velocity(double *velocity, const zt_curve *curve, double time_s);

#endif
