/* What the making and the evaluation of curves share. */
#ifndef ZT_KEYFRAME_CURVE_INSIDE_H
#define ZT_KEYFRAME_CURVE_INSIDE_H

#include <float.h>

#include "keyframe/curve.h"
#include "keyframe/rotation.h"

/* Whether points are unit quaternions. */
static inline bool zt_curve_is_on_sphere(const zt_curve *curve) {
    return curve->value_kind == ZT_VALUE_ROTATION && curve->space == ZT_SPACE_VALUES;
}

static inline quat zt_curve_quat(const double *p) { return (quat){p[0], p[1], p[2], p[3]}; }

/* The largest doubles for infinities, zero for what is no number. */
static inline double zt_curve_finite(double x) {
    if (x >= -DBL_MAX && x <= DBL_MAX) return x;
    return x > 0 ? DBL_MAX : x < 0 ? -DBL_MAX : 0;
}

/* The same, which the curve then remembers. */
static inline double zt_curve_clip(zt_curve *curve, double x) {
    double finite = zt_curve_finite(x);
    if (finite != x) curve->clipped = true;
    return finite;
}

/* Writes `controls`, and `handle_times` where a way is ZT_CURVE_BEZIER; nothing where no way is
 * curved. The rest of the curve is there already. ZT_EMEMORY. */
zt_status zt_curve_make_controls(zt_curve *curve, zt_arena *arena, const zt_key *keys);

/* Doubles per key in zt_curve.motions: position from rest and speed; of rotations as turns. */
static inline int32_t zt_curve_motion_width(const zt_curve *curve) {
    return 2 * (zt_curve_is_on_sphere(curve) ? 3 : curve->point_width);
}

/* Where and how fast the curve's spring is at each key, from the keys before. */
void zt_curve_spring_motions(double *motions, const zt_curve *curve);

/* The point at a time, at or after that of `key`. */
void zt_curve_spring_eval(double *point, const zt_curve *curve, int32_t key, double time_s);

#endif
