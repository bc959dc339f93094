/* The canvas: what the samples of pixels add up to where not all take as many, and how far off
 * these still are. */
#ifndef ZT_RENDER_CANVAS_H
#define ZT_RENDER_CANVAS_H

#include <stdalign.h>
#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/status.h>

#include "tracer/kernel.h"

/* Light that samples add up to, and how many they are. In double precision, in which any number
 * of equal samples adds up to exactly so many times one of them. */
typedef struct zt_canvas_sum {
    double r, g, b;
    double a;      /* where alpha is asked for: how many met something; else 0 */
    double square; /* the sum of r^2 + g^2 + b^2 + 3 a^2 */
    int32_t taken;
} zt_canvas_sum;

/* A pixel that takes samples. */
typedef struct zt_slot {
    zt_canvas_sum sum; /* of the samples that count positively */
    uint16_t column, row;
    int32_t asked;  /* how many samples were taken, those that are left out too */
    uint32_t known; /* the last of its rounds (render/rounds.h), 0: none */
    bool strange;   /* a sample saw what none of the pixels around sees in its middle */
    bool hidden;    /* there for its neighbours' sake: it does not become the image's */
} zt_slot;

/* A slot that takes further samples, and how many it has. */
typedef struct zt_waiting {
    int32_t slot, asked;
} zt_waiting;

/* Planes are of a number for each pixel; slots and lists have room for all pixels. */
typedef struct zt_canvas {
    int width, height;
    zt_slot *slots;
    zt_canvas_sum *negative; /* for each slot, of samples that count negatively; or NULL */
    zt_waiting *waiting;     /* the slots that take further samples */
    int32_t *round;          /* those that do so now */
    bool *goes_on;           /* for each of the round */
    /* Planes: the squared error as a pixel's own samples have it, negative: not known; and what
     * it would be of a step through the pixel. */
    float *error, *step;
    /* Where edges were looked for: planes of what a ray through the pixel's middle saw; of
     * whether it is at an edge; and of the number of samples that a pixel takes at least, as
     * its logarithm, 0 for that one. */
    uint32_t *path;
    uint8_t *edge, *least;
    int32_t slot_count, waiting_count, round_count;
    bool at_edges;  /* these are the canvas's pixels */
    bool is_random; /* what samples meet is, not only where in pixels they are taken */
} zt_canvas;

/* What a thread adds up for the slots that it works on: of the samples so far or the first half
 * of them, and of those that are new; and likewise of those that count negatively. */
typedef struct zt_canvas_sums {
    struct zt_canvas_half {
        alignas(64) double r[ZT_BATCH];
        alignas(64) double g[ZT_BATCH];
        alignas(64) double b[ZT_BATCH];
        alignas(64) double a[ZT_BATCH];
        alignas(64) double square[ZT_BATCH];
        alignas(64) int32_t taken[ZT_BATCH];
    } positive[2], negative[2];
} zt_canvas_sums;

/* Makes an empty canvas for pictures of a size; what there is of that size is used again. A
 * canvas of zeros is closed. ZT_EMEMORY. */
zt_status zt_canvas_open(zt_canvas *canvas, int width, int height, bool is_signed);
void zt_canvas_close(zt_canvas *canvas);

static inline size_t zt_canvas_pixel(const zt_canvas *canvas, int32_t column, int32_t row) {
    return (size_t)row * (size_t)canvas->width + (size_t)column;
}

/* A pixel gets a slot, and waits; nothing happens where it has one. */
void zt_canvas_add(zt_canvas *canvas, int32_t column, int32_t row);

/* A pixel gets slot number `slot`, and waits; from any thread, each number and pixel once. The
 * canvas must be empty; slots 0 .. count - 1 count once zt_canvas_added() says so. */
void zt_canvas_add_as(zt_canvas *canvas, int32_t slot, int32_t column, int32_t row,
                      bool hidden);
void zt_canvas_added(zt_canvas *canvas, int32_t count);

/* How many of the samples that a slot has taken were not finite. */
static inline int32_t zt_slot_left_out(const zt_canvas *canvas, int32_t slot) {
    const zt_slot *s = &canvas->slots[slot];
    return s->asked - s->sum.taken - (canvas->negative ? canvas->negative[slot].taken : 0);
}

/* The mean of some samples, R G B A, of which those of `negative` (may be NULL) count
 * negatively; all 0 without any. Where what is left of the count is so little that noise would
 * explode, all count alike. */
void zt_canvas_mean(double mean[4], const zt_canvas_sum *positive,
                    const zt_canvas_sum *negative);

/* The squared standard error of the mean of all samples of two independent sets, on average of
 * red, green and blue, with that of alpha, which is one of each over white: from the difference
 * of their means; but no less than `step`, what the points of samples, which are well spread,
 * leave of a step's variance: a share of n^(-3/2) for n samples. Halves that are both well
 * spread often agree on a step through the pixel, and both be wrong. */
float zt_canvas_estimate(float *step, const zt_canvas_sum positive[2],
                         const zt_canvas_sum negative[2]);

/* The squared error of a slot's pixel. How much larger errors are than those of steps is that
 * of all pixels around, so that two halves that agree by luck do not count for much. How much
 * its samples differ is its own in part, as they may all have missed what is next to it: the
 * more, the more they are; at edges, where pixels that have what is around begin with enough
 * (render/edges.c), by three quarters. Negative where there is none. */
float zt_canvas_error(const zt_canvas *canvas, const zt_slot *slot);

/* The squared error that a pixel with so many samples is to have, over that asked for. At edges
 * it is as the number is, up to that: a picture has the least error for its time where each
 * further sample of a pixel gains as much (Neyman, "On the two different aspects of the
 * representative method", 1934). */
static inline float zt_canvas_share(const zt_canvas *canvas, int64_t asked) {
    enum { AS_ASKED = 100 };
    return canvas->at_edges && asked < AS_ASKED ? (float)asked / AS_ASKED : 1;
}

#endif
