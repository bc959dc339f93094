#include "render/filter.h"

#include <math.h>

#include "tracer/isa.h"

/* Cells of the table of places, and of the integral that it is made from. */
enum { CELLS = 1024, STEPS = 4096 };

/* A number u of [0, 1) stands for the share v = 1 - |2 u - 1| of the filter's magnitude that
 * lies further out than its place, on its side; `places` has the distances for the roots of v,
 * i / CELLS: even where the filter ends in zero, they fall nearly evenly. */
struct zt_warp {
    float width;
    bool is_box;
    float negative_from; /* the distance beyond which it is below zero; infinite for most */
    float places[CELLS + 2];
};

/* B = C = 1/3, over four steps. */
static double mitchell(double x) {
    x = fabs(x);
    if (x < 1) return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
    return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
}

static double blackman_harris(double turn) {
    return 0.35875 + 0.48829 * cos(turn) + 0.14128 * cos(2 * turn) + 0.01168 * cos(3 * turn);
}

double zt_filter_eval(zt_filter filter, double width, double x) {
    double share = x / width; /* of the width, -1/2 .. 1/2 */
    if (fabs(share) > 0.5) return 0;
    switch (filter) {
    case ZT_FILTER_TENT:
        return 1 - 2 * fabs(share);
    case ZT_FILTER_GAUSSIAN:
        return exp(-8 * share * share);
    case ZT_FILTER_MITCHELL:
        return mitchell(4 * share);
    case ZT_FILTER_BLACKMAN_HARRIS:
        return blackman_harris(2 * 3.14159265358979323846 * share);
    default:
        return 1;
    }
}

double zt_filter_width(const zt_sampling *sampling) {
    static const double own[ZT_FILTER_COUNT] = {1, 2, 2, 4, 4};
    return sampling->filter_width > 0 ? sampling->filter_width : own[sampling->filter];
}

/* The distances by the magnitude that lies beyond them, which is added up from the end inwards,
 * in steps by the rule of Gauss with two points. */
static void fill_places(zt_warp *warp, zt_filter filter, double width) {
    double step = width / 2 / STEPS, between = step / (2 * sqrt(3.0)), sum = 0;
    double sums[STEPS + 1]; /* of step i from the end */
    sums[0] = 0;
    for (int i = 0; i < STEPS; i++) {
        double middle = width / 2 - (i + 0.5) * step;
        sum += fabs(zt_filter_eval(filter, width, middle - between)) +
               fabs(zt_filter_eval(filter, width, middle + between));
        sums[i + 1] = sum;
    }
    int at = 0;
    for (int i = 0; i <= CELLS; i++) {
        double root = (double)i / CELLS, wanted = root * root * sum;
        while (at < STEPS - 1 && sums[at + 1] < wanted) at++;
        double rise = sums[at + 1] - sums[at];
        double part = rise > 0 ? fmin((wanted - sums[at]) / rise, 1) : 0;
        warp->places[i] = (float)(width / 2 - (at + part) * step);
    }
    warp->places[CELLS + 1] = warp->places[CELLS];
}

/* Where the filter falls below zero, by halving. */
static double find_negative(zt_filter filter, double width) {
    if (filter != ZT_FILTER_MITCHELL) return INFINITY;
    double low = width / 4, high = width * 3 / 8;
    for (int i = 0; i < 60; i++) {
        double middle = (low + high) / 2;
        *(zt_filter_eval(filter, width, middle) > 0 ? &low : &high) = middle;
    }
    return low;
}

zt_status zt_warp_prepare(const zt_warp **out, const zt_sampling *sampling, zt_arena *arena) {
    *out = NULL;
    double width = zt_filter_width(sampling);
    bool is_box = sampling->filter == ZT_FILTER_BOX;
    if (is_box && width == 1) return ZT_OK;
    zt_warp *warp = ZT_PUSH(arena, zt_warp, 1);
    if (!warp) return ZT_EMEMORY;
    warp->width = (float)width;
    warp->is_box = is_box;
    warp->negative_from = (float)find_negative(sampling->filter, width);
    if (!is_box) fill_places(warp, sampling->filter, width);
    *out = warp;
    return ZT_OK;
}

bool zt_warp_is_signed(const zt_warp *warp) { return warp && isfinite(warp->negative_from); }

/* From a number of [0, 1) to the distance from the middle that it stands for. */
static inline float distance_of(const zt_warp *warp, float u) {
    float cell = sqrtf(1 - fabsf(2 * u - 1)) * CELLS;
    int32_t i = (int32_t)cell;
    float low = warp->places[i];
    return low + (cell - (float)i) * (warp->places[i + 1] - low);
}

ZT_CLONES void zt_warp_places(float *restrict x, float *restrict y, float *restrict weight,
                              const zt_warp *restrict warp, int count) {
    float width = warp->width, negative_from = warp->negative_from;
    for (int i = 0; warp->is_box && i < count; i++) {
        x[i] = 0.5f + (x[i] - 0.5f) * width;
        y[i] = 0.5f + (y[i] - 0.5f) * width;
        weight[i] = 1;
    }
    for (int i = 0; !warp->is_box && i < count; i++) {
        /* Numbers of comparisons in place of branches, which would keep it narrow. */
        float dx = distance_of(warp, x[i]), dy = distance_of(warp, y[i]);
        int32_t left = x[i] < 0.5f, above = y[i] < 0.5f;
        int32_t dark_x = dx > negative_from, dark_y = dy > negative_from;
        x[i] = 0.5f + dx * (float)(1 - 2 * left);
        y[i] = 0.5f + dy * (float)(1 - 2 * above);
        weight[i] = (float)(1 - 2 * (dark_x ^ dark_y));
    }
}
