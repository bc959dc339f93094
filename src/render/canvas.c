#include "render/canvas.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include <zoetrope/image.h>

#include "base/diag.h"

static_assert(ZT_IMAGE_SIDE_MAX - 1 <= UINT16_MAX, "columns and rows are numbers of 16 bits");

enum { NO_ESTIMATE = -1, NOT_YET = -2 }; /* of pixels without slots, and with new ones */

/* Large pieces of zeros cost nothing until they are touched. */
static zt_status allocate(zt_canvas *canvas, size_t count) {
    canvas->slots = calloc(count, sizeof *canvas->slots);
    canvas->waiting = calloc(count, sizeof *canvas->waiting);
    canvas->round = calloc(count, sizeof *canvas->round);
    canvas->goes_on = calloc(count, sizeof *canvas->goes_on);
    canvas->error = calloc(count, sizeof *canvas->error);
    canvas->step = calloc(count, sizeof *canvas->step);
    canvas->path = calloc(count, sizeof *canvas->path);
    canvas->least = calloc(count, sizeof *canvas->least);
    canvas->edge = calloc(count, sizeof *canvas->edge);
    bool all = canvas->slots && canvas->waiting && canvas->round && canvas->goes_on &&
               canvas->error && canvas->step && canvas->path && canvas->least && canvas->edge;
    for (size_t i = 0; all && i < count; i++) canvas->error[i] = NO_ESTIMATE;
    return all ? ZT_OK : ZT_EMEMORY;
}

zt_status zt_canvas_open(zt_canvas *canvas, int width, int height, bool is_signed) {
    size_t count = (size_t)width * (size_t)height;
    if (count > INT32_MAX) return ZT_EMEMORY;
    if (canvas->width != width || canvas->height != height) {
        zt_canvas_close(canvas);
        ZT_TRY(allocate(canvas, count));
        canvas->width = width;
        canvas->height = height;
    }
    if (is_signed && !canvas->negative) {
        canvas->negative = calloc(count, sizeof *canvas->negative);
        if (!canvas->negative) return ZT_EMEMORY;
    } else if (!is_signed) { /* as it is, there are such samples */
        free(canvas->negative);
        canvas->negative = NULL;
    }
    bool few = canvas->slot_count < INT32_MAX / 8 && 8 * (size_t)canvas->slot_count < count;
    for (int32_t i = 0; few && i < canvas->slot_count; i++) {
        const zt_slot *s = &canvas->slots[i];
        canvas->error[zt_canvas_pixel(canvas, s->column, s->row)] = NO_ESTIMATE;
    }
    for (size_t i = 0; !few && i < count; i++) canvas->error[i] = NO_ESTIMATE;
    canvas->slot_count = canvas->waiting_count = canvas->round_count = 0;
    return ZT_OK;
}

void zt_canvas_close(zt_canvas *canvas) {
    free(canvas->slots);
    free(canvas->negative);
    free(canvas->waiting);
    free(canvas->round);
    free(canvas->goes_on);
    free(canvas->error);
    free(canvas->step);
    free(canvas->path);
    free(canvas->least);
    free(canvas->edge);
    *canvas = (zt_canvas){0};
}

static void make_slot(zt_canvas *canvas, int32_t slot, int32_t column, int32_t row,
                      bool hidden) {
    canvas->error[zt_canvas_pixel(canvas, column, row)] = NOT_YET;
    if (canvas->negative) canvas->negative[slot] = (zt_canvas_sum){0};
    canvas->slots[slot] =
        (zt_slot){.column = (uint16_t)column, .row = (uint16_t)row, .hidden = hidden};
}

void zt_canvas_add_as(zt_canvas *canvas, int32_t slot, int32_t column, int32_t row,
                      bool hidden) {
    make_slot(canvas, slot, column, row, hidden);
    canvas->waiting[slot] = (zt_waiting){slot, 0};
}

void zt_canvas_added(zt_canvas *canvas, int32_t count) {
    canvas->slot_count = canvas->waiting_count = count;
}

void zt_canvas_add(zt_canvas *canvas, int32_t column, int32_t row) {
    if (canvas->error[zt_canvas_pixel(canvas, column, row)] != NO_ESTIMATE) return;
    int32_t slot = canvas->slot_count++;
    make_slot(canvas, slot, column, row, false);
    canvas->waiting[canvas->waiting_count++] = (zt_waiting){slot, 0};
}

void zt_canvas_mean(double mean[4], const zt_canvas_sum *positive,
                    const zt_canvas_sum *negative) {
    double sign = 1, r = positive->r, g = positive->g, b = positive->b, a = positive->a;
    int32_t count = positive->taken;
    if (negative && negative->taken > 0) {
        int32_t all = count + negative->taken;
        sign = 4 * (count - negative->taken) < all ? 1 : -1;
        count = sign < 0 ? count - negative->taken : all;
        r += sign * negative->r;
        g += sign * negative->g;
        b += sign * negative->b;
        a += sign * negative->a;
    }
    mean[0] = count ? r / count : 0;
    mean[1] = count ? g / count : 0;
    mean[2] = count ? b / count : 0;
    mean[3] = count ? a / count : 0;
}

float zt_canvas_estimate(float *step, const zt_canvas_sum positive[2],
                         const zt_canvas_sum negative[2]) {
    double r = 0, g = 0, b = 0, a = 0, square = 0, count[2], mean[2][4];
    for (int i = 0; i < 2; i++) {
        const zt_canvas_sum *p = &positive[i], *n = &negative[i];
        r += p->r + n->r;
        g += p->g + n->g;
        b += p->b + n->b;
        a += p->a + n->a;
        square += p->square + n->square;
        count[i] = p->taken + n->taken;
    }
    *step = 0;
    if (count[0] == 0 || count[1] == 0) return 0;
    double all = count[0] + count[1];
    /* all - 1 times the variance */
    double spread = square - (r * r + g * g + b * b + 3 * a * a) / all;
    if (spread < 1e-12 * square) return 0; /* all are the same, but for roundings here */
    for (int i = 0; i < 2; i++) zt_canvas_mean(mean[i], &positive[i], &negative[i]);
    double apart = 0;
    for (int k = 0; k < 4; k++)
        apart += (k < 3 ? 1 : 3) * (mean[0][k] - mean[1][k]) * (mean[0][k] - mean[1][k]);
    apart *= count[0] * count[1] / (all * all);
    double left = spread / ((all - 1) * all * sqrt(all));
    *step = (float)(left / 3);
    return (float)((apart > left ? apart : left) / 3);
}

/* Of pixels around one, by their weights 1 2 1. */
typedef struct around {
    float error, step, weight;
} around;

static void add_pixel(around *sum, const zt_canvas *canvas, size_t pixel, float weight) {
    bool counts = canvas->error[pixel] >= 0;
    sum->error += counts ? weight * canvas->error[pixel] : 0;
    sum->step += counts ? weight * canvas->step[pixel] : 0;
    sum->weight += counts ? weight : 0;
}

float zt_canvas_error(const zt_canvas *canvas, const zt_slot *slot) {
    const int32_t x = slot->column, y = slot->row;
    around sum = {0, 0, 0};
    for (int32_t row = y - 1; row <= y + 1; row++) {
        if (row < 0 || row >= canvas->height) continue;
        float weight = row == y ? 2 : 1;
        size_t pixel = zt_canvas_pixel(canvas, x, row);
        if (x > 0) add_pixel(&sum, canvas, pixel - 1, weight);
        add_pixel(&sum, canvas, pixel, 2 * weight);
        if (x + 1 < canvas->width) add_pixel(&sum, canvas, pixel + 1, weight);
    }
    if (!(sum.weight > 0)) return NO_ESTIMATE;
    if (!(sum.step > 0)) return 0;
    if (isinf(sum.error)) return sum.error;
    float shared = canvas->at_edges ? 0.25f : fminf(2 / sqrtf((float)slot->asked), 1);
    float own = canvas->step[zt_canvas_pixel(canvas, x, y)] / sum.step;
    return sum.error * ((1 - shared) * own + shared / sum.weight);
}
