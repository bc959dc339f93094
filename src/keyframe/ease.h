/* Easing: how the way from one key to the next is spread over its time. */
#ifndef ZT_KEYFRAME_EASE_H
#define ZT_KEYFRAME_EASE_H

#include <stdint.h>

#include "base/arena.h"

typedef enum zt_ease_kind {
    ZT_EASE_BEZIER, /* CSS cubic-bezier(x1, y1, x2, y2) */
    ZT_EASE_STEPS,  /* CSS steps(count, jump) */
    ZT_EASE_STOPS,  /* CSS linear(stop, stop, ...) */
    /* Robert Penner's families ("Motion, Tweening, and Easing", 2002), in the continuous forms
     * of d3-ease: expo and elastic begin at 0 exactly, and in-out is made of in and out. */
    ZT_EASE_SINE,
    ZT_EASE_QUAD,
    ZT_EASE_CUBIC,
    ZT_EASE_QUART,
    ZT_EASE_QUINT,
    ZT_EASE_EXPO,
    ZT_EASE_CIRC,
    ZT_EASE_BACK,
    ZT_EASE_ELASTIC,
    ZT_EASE_BOUNCE
} zt_ease_kind;

/* Where Penner's families are slow, or do what they are known for. */
typedef enum zt_ease_way { ZT_EASE_IN, ZT_EASE_OUT, ZT_EASE_IN_OUT } zt_ease_way;

/* At which ends of the time a staircase jumps. */
typedef enum zt_ease_jump {
    ZT_EASE_JUMP_START,
    ZT_EASE_JUMP_END,
    ZT_EASE_JUMP_NONE,
    ZT_EASE_JUMP_BOTH
} zt_ease_jump;

/* A corner of ZT_EASE_STOPS. Times never fall; two at the same time are a jump. */
typedef struct zt_ease_stop {
    double time, way;
} zt_ease_stop;

typedef struct zt_ease {
    zt_ease_kind kind;
    union {
        struct {
            double x1, y1, x2, y2; /* both x in 0..1 */
        };
        struct {
            int32_t step_count; /* at least 1, for ZT_EASE_JUMP_NONE 2 */
            zt_ease_jump jump;
        };
        struct {
            int32_t stop_count; /* at least 1 */
            const zt_ease_stop *stops;
        };
        struct {
            zt_ease_way way;
            double overshoot;         /* of ZT_EASE_BACK: 1.70158 goes back by a tenth */
            double amplitude, period; /* of ZT_EASE_ELASTIC: at least 1; above 0 */
        };
    };
} zt_ease;

/* The share of the way that is done after the share `u` of the time, 0..1; it may be outside of
 * 0..1 itself. 0 and 1 give exactly 0 and 1, but for staircases that jump there and for stops
 * that say otherwise. Outside of 0..1, CSS's curves go straight on, and Penner's are at rest.
 */
double zt_ease_eval(const zt_ease *ease, double u);

/* Where in s a cubic Bezier curve in one dimension from 0 to 1 with inner control points x1 and
 * x2 (both in 0..1) is at x (0..1): 3 x1 s (1-s)^2 + 3 x2 s^2 (1-s) + s^3 = x, within a few
 * units in the last place of the true s, also where the curve stands still. */
double zt_ease_bezier_parameter(double x1, double x2, double x);

/* Reads an easing as CSS writes it, or one of Penner's:
 *   ease  ease-in  ease-out  ease-in-out  step-start  step-end
 *   cubic-bezier(x1, y1, x2, y2)
 *   steps(count)  steps(count, jump-start | jump-end | jump-none | jump-both | start | end)
 *   linear(way time% time%, ...)
 *   sine-in  sine-out  sine-in-out, and so quad cubic quart quint expo circ back elastic bounce
 *   back-out(overshoot)  elastic-out(amplitude, period)
 * Stops go to the arena. Returns NULL, or what is wrong in a few words. */
const char *zt_ease_parse(zt_ease *ease, zt_arena *arena, const char *text);

/* The words that zt_ease_parse knows, for lists and for the nearest to a wrong one; NULL after
 * the last. */
const char *zt_ease_word(int index);

#endif
