/* A value over time, given by keys. Evaluation is pure: any time, in any order, from any
 * thread, gives the same bits. */
#ifndef ZT_KEYFRAME_CURVE_H
#define ZT_KEYFRAME_CURVE_H

#include <stdint.h>

#include <zoetrope/status.h>

#include "base/arena.h"
#include "keyframe/property.h"

typedef enum zt_curve_kind {
    ZT_CURVE_HOLD,   /* each key's value until the next */
    ZT_CURVE_LINEAR, /* straight on; rotations by slerp */
    ZT_CURVE_SMOOTH, /* C1, no overshoot: each channel stays between its two keys */
    ZT_CURVE_COUNT
} zt_curve_kind;

/* "hold", "linear", "smooth". */
const char *zt_curve_name(zt_curve_kind kind);

/* Before the first key the first value holds, after the last key the last. The arrays belong to
 * an arena. */
typedef struct zt_curve {
    zt_curve_kind kind;
    zt_value_kind value_kind;
    int32_t width;        /* doubles a value */
    int32_t key_count;    /* at least 1 */
    const double *times;  /* seconds, rising strictly */
    const double *values; /* key_count * width */
    const double *slopes; /* what the kind needs besides, made by zt_curve_make; may be NULL */
} zt_curve;

/* Prepares a curve over keys: copies them to the arena and works out what evaluation needs.
 * Rotations are aligned along the chain so that each step takes the short way. Times must be
 * finite and rise strictly, values finite (ZT_EARGUMENT). */
zt_status zt_curve_make(zt_curve *curve, zt_arena *arena, zt_curve_kind kind,
                        zt_value_kind value_kind, int32_t key_count, const double *times,
                        const double *values);

/* The value at a time in seconds, `width` doubles; exactly a key's value at its time. */
void zt_curve_eval(double *value, const zt_curve *curve, double time_s);

#endif
