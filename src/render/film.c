#include "render/film.h"

#include <math.h>
#include <stdlib.h>

enum { NO_ESTIMATE = -1, NOT_YET = -2 }; /* of pixels without slots, and with new ones */

/* Large pieces of zeros cost nothing until they are touched. */
static zt_status allocate(zt_film *film, size_t count) {
    film->slots = calloc(count, sizeof *film->slots);
    film->waiting = calloc(count, sizeof *film->waiting);
    film->round = calloc(count, sizeof *film->round);
    film->goes_on = calloc(count, sizeof *film->goes_on);
    film->error = calloc(count, sizeof *film->error);
    film->path = calloc(count, sizeof *film->path);
    film->least = calloc(count, sizeof *film->least);
    film->spread = calloc(count, sizeof *film->spread);
    bool all = film->slots && film->waiting && film->round && film->goes_on && film->error &&
               film->path && film->least && film->spread;
    for (size_t i = 0; all && i < count; i++) film->error[i] = NO_ESTIMATE;
    return all ? ZT_OK : ZT_EMEMORY;
}

zt_status zt_film_open(zt_film *film, int width, int height, bool is_signed) {
    size_t count = (size_t)width * (size_t)height;
    if (count > INT32_MAX) return ZT_EMEMORY;
    if (film->width != width || film->height != height) {
        zt_film_close(film);
        zt_status status = allocate(film, count);
        if (status != ZT_OK) {
            zt_film_close(film);
            return status;
        }
        film->width = width;
        film->height = height;
    }
    if (is_signed && !film->negative) {
        film->negative = calloc(count, sizeof *film->negative);
        if (!film->negative) return ZT_EMEMORY;
    }
    for (int32_t i = 0; i < film->slot_count; i++) {
        const zt_slot *s = &film->slots[i];
        film->error[zt_film_pixel(film, s->column, s->row)] = NO_ESTIMATE;
    }
    film->slot_count = film->waiting_count = film->round_count = 0;
    return ZT_OK;
}

void zt_film_close(zt_film *film) {
    free(film->slots);
    free(film->negative);
    free(film->waiting);
    free(film->round);
    free(film->goes_on);
    free(film->error);
    free(film->path);
    free(film->least);
    free(film->spread);
    *film = (zt_film){0};
}

void zt_film_add(zt_film *film, int32_t column, int32_t row) {
    float *error = &film->error[zt_film_pixel(film, column, row)];
    if (*error != NO_ESTIMATE) return;
    *error = NOT_YET;
    if (film->negative) film->negative[film->slot_count] = (zt_film_sum){0};
    film->slots[film->slot_count] = (zt_slot){.column = column, .row = row};
    film->waiting[film->waiting_count++] = film->slot_count++;
}

void zt_film_mean(double mean[3], const zt_film_sum *positive, const zt_film_sum *negative) {
    double sign = 1, r = positive->r, g = positive->g, b = positive->b;
    int32_t count = positive->taken;
    if (negative && negative->taken > 0) {
        int32_t all = count + negative->taken;
        sign = 4 * (count - negative->taken) < all ? 1 : -1;
        count = sign < 0 ? count - negative->taken : all;
        r += sign * negative->r;
        g += sign * negative->g;
        b += sign * negative->b;
    }
    mean[0] = count ? r / count : 0;
    mean[1] = count ? g / count : 0;
    mean[2] = count ? b / count : 0;
}

float zt_film_estimate(const zt_film_sum positive[2], const zt_film_sum negative[2]) {
    double mean[2][3], r = 0, g = 0, b = 0, square = 0, count[2];
    for (int i = 0; i < 2; i++) {
        const zt_film_sum *p = &positive[i], *n = &negative[i];
        zt_film_mean(mean[i], p, n);
        r += p->r + n->r;
        g += p->g + n->g;
        b += p->b + n->b;
        square += p->square + n->square;
        count[i] = p->taken + n->taken;
    }
    double all = count[0] + count[1], apart = 0;
    if (count[0] == 0 || count[1] == 0) return 0;
    for (int k = 0; k < 3; k++) apart += (mean[0][k] - mean[1][k]) * (mean[0][k] - mean[1][k]);
    apart *= count[0] * count[1] / (all * all);
    double spread = square - (r * r + g * g + b * b) / all; /* all - 1 times the variance */
    if (spread < 1e-12 * square) spread = 0;                /* roundings */
    double left = spread / ((all - 1) * all * sqrt(all));
    return (float)((apart > left ? apart : left) / 3);
}

float zt_film_error(const zt_film *film, int32_t column, int32_t row) {
    float sum = 0, weights = 0;
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++) {
            int x = column + dx, y = row + dy;
            if (x < 0 || y < 0 || x >= film->width || y >= film->height) continue;
            float error = film->error[zt_film_pixel(film, x, y)];
            float weight = (dx ? 1.0f : 2.0f) * (dy ? 1.0f : 2.0f);
            if (error < 0) continue;
            sum += weight * error;
            weights += weight;
        }
    return weights > 0 ? sum / weights : NO_ESTIMATE;
}
