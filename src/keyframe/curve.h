/* A value over time, given by keys. Evaluation is pure: any time, in any order, from any
 * thread, gives the same bits. */
#ifndef ZT_KEYFRAME_CURVE_H
#define ZT_KEYFRAME_CURVE_H

#include <stdint.h>

#include <zoetrope/status.h>

#include "base/arena.h"
#include "keyframe/ease.h"
#include "keyframe/property.h"
#include "keyframe/spring.h"

/* How a curve goes from a key to the next one. */
typedef enum zt_curve_kind {
    ZT_CURVE_HOLD,        /* the key's value until the next */
    ZT_CURVE_LINEAR,      /* straight on; rotations by slerp */
    ZT_CURVE_SMOOTH,      /* C1, no overshoot: each channel stays between its two keys */
    ZT_CURVE_CATMULL_ROM, /* round the corners of a path in space */
    ZT_CURVE_BEZIER,      /* handles in time and value, as F-curves have */
    ZT_CURVE_HERMITE,     /* tangents, as CUBICSPLINE of glTF 2.0 */
    ZT_CURVE_TCB,         /* Kochanek-Bartels */
    ZT_CURVE_KIND_COUNT
} zt_curve_kind;

/* "hold", "linear", "smooth", "catmull-rom", "bezier", "hermite", "tcb". */
const char *zt_curve_name(zt_curve_kind kind);

/* What a curve does before its first key or after its last one. */
typedef enum zt_curve_end {
    ZT_END_HOLD,
    ZT_END_LINEAR,           /* straight on at the speed of the end */
    ZT_END_LOOP,             /* the last key is the first one again: no frame is shown twice */
    ZT_END_PING_PONG,        /* there and back */
    ZT_END_LOOP_WITH_OFFSET, /* each round begins where the one before ended */
    ZT_END_COUNT
} zt_curve_end;

/* "hold", "linear", "loop", "ping-pong", "loop-with-offset". */
const char *zt_curve_end_name(zt_curve_end end);

/* In which numbers the way between keys is found. */
typedef enum zt_curve_space {
    ZT_SPACE_VALUES, /* the values themselves; rotations on their sphere, the short way */
    ZT_SPACE_OKLAB,  /* colours as Oklab */
    ZT_SPACE_TURNS   /* rotations as turns, axis times angle, channel by channel: a turn of 720
                        degrees is two rounds, and the long way is not cut short */
} zt_curve_space;

/* A key, and the way from it to the next one. All of it is only read while the curve is made,
 * but for `ease`. */
typedef struct zt_key {
    double time_s;
    const double *value; /* zt_value_width() doubles; in ZT_SPACE_TURNS 3, axis times radians */
    zt_curve_kind kind;
    const zt_ease *ease; /* or NULL; spreads the way over its time. Not of hold and bezier. Must
                            live as long as the curve */

    /* Of the way that comes to the key, `before`, and of the way that goes from it, `after`, in
     * the curve's space.
     *
     * ZT_CURVE_BEZIER: where the handles are, seen from the key, and how many seconds away, at
     * least 0; one that is longer than its way is shortened to it. Handles of rotations are
     * turns in the key's frame, 3 wide. NULL: as a smooth way has it; with 0 s, a third of the
     * way.
     *
     * ZT_CURVE_HERMITE: derivatives, a second; of quaternions componentwise. NULL: zero. */
    const double *before, *after;
    double before_s, after_s;

    double tension, continuity, bias; /* ZT_CURVE_TCB; 0, 0, 0 is a cubic through the keys */
} zt_key;

typedef struct zt_curve_spec {
    zt_value_kind value_kind; /* switches hold, whatever their keys say */
    zt_curve_space space;
    int32_t key_count;
    const zt_key *keys; /* times rise strictly */
    zt_curve_end before, after;
    const zt_spring *spring; /* or NULL. Each key is a new place to rest, and a spring carries
                                the value there from where, and as fast as, it was; it begins at
                                rest at the first key. Kinds and eases do not matter then. */
} zt_curve_spec;

/* The arrays belong to an arena. Those per way have key_count - 1 elements. */
typedef struct zt_curve {
    zt_value_kind value_kind;
    zt_curve_space space;
    zt_curve_end before, after;
    int32_t key_count;           /* at least 1 */
    int32_t width, point_width;  /* doubles a value, and a value in the curve's space */
    int32_t control_width;       /* doubles a way in `controls` */
    bool clipped;                /* something in its making was too large for a double, and is
                                    now the largest */
    double keys_per_s;           /* on the average */
    const double *times;         /* seconds */
    const double *values;        /* as they are given out */
    const double *points;        /* values in the curve's space */
    const uint8_t *kinds;        /* per way: zt_curve_kind */
    const zt_ease *const *eases; /* per way, or NULL */
    const double *controls;      /* per way: inner control points, or the arc of a rotation */
    const double (*handle_times)[2]; /* per way, 0..1, of ZT_CURVE_BEZIER */
    const double *end_speeds; /* a second: before the first key, then after the last one */
    const zt_spring *spring;  /* or NULL */
    const double *motions;    /* per key: the spring's position from rest, then its speed */
} zt_curve;

/* Makes a curve. Signs of rotations are aligned along the chain so that each step takes the
 * short way, but for ZT_CURVE_HERMITE, where they belong to what was given. ZT_EARGUMENT where
 * there is no key, where times do not rise, where a number is not finite, or where the space
 * does not suit the kind of value. */
zt_status zt_curve_from_keys(zt_curve *curve, zt_arena *arena, const zt_curve_spec *spec);

/* "smooth", "spring", "eased"; "mixed" where ways differ. */
const char *zt_curve_label(const zt_curve *curve);

/* Where a time falls on a curve. */
typedef struct zt_curve_spot {
    int32_t key;     /* the last key at or before it; the way goes from here */
    double time_s;   /* within the curve's keys, loops unrolled */
    double u;        /* share of the way's time, 0 at the key itself, below 1 */
    double s;        /* parameter of the way's curve: u, eased, or solved for a Bezier curve */
    double round;    /* which repetition of a loop: 0 for the keys as given */
    double beyond_s; /* seconds past the last key, or (negative) to the first, with
                        ZT_END_LINEAR; else 0 */
} zt_curve_spot;

zt_curve_spot zt_curve_find(const zt_curve *curve, double time_s);

/* The value at a time in seconds, `width` doubles; exactly a key's value at its time. Always
 * finite: what would be too large is the largest double. */
void zt_curve_eval(double *value, const zt_curve *curve, double time_s);

#endif
