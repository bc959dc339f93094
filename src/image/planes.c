#include "image/planes.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "base/wide.h"

zt_kernel_1d zt_kernel_gaussian(double sigma, int radius) {
    zt_kernel_1d kernel = {.radius = radius};
    double sum = 0;
    for (int i = -radius; i <= radius; i++) sum += exp(-i * i / (2 * sigma * sigma));
    for (int i = -radius; i <= radius; i++)
        kernel.weights[i + radius] = exp(-i * i / (2 * sigma * sigma)) / sum;
    return kernel;
}

static int clamp_int(int i, int last) { return i < 0 ? 0 : i > last ? last : i; }

ZT_CLONES static void add_scaled(double *restrict to, const double *restrict from,
                                 double weight, int count) {
    for (int i = 0; i < count; i++) to[i] += weight * from[i];
}

/* Those pixels of a row whose neighbours reach beyond its ends. */
static void filter_ends(double *to, const double *from, int width, const zt_kernel_1d *kernel) {
    int r = kernel->radius;
    for (int x = 0; x < width; x++) {
        if (x == r && width > 2 * r) x = width - r;
        to[x] = 0;
        for (int k = -r; k <= r; k++)
            to[x] += kernel->weights[k + r] * from[clamp_int(x + k, width - 1)];
    }
}

static void filter_row(double *to, const double *from, int width, const zt_kernel_1d *kernel) {
    int r = kernel->radius;
    memset(to, 0, (size_t)width * sizeof *to);
    for (int k = 0; k <= 2 * r && width > 2 * r; k++)
        add_scaled(to + r, from + k, kernel->weights[k], width - 2 * r);
    filter_ends(to, from, width, kernel);
}

void zt_plane_filter(double *to, const double *from, double *rows, int width, int height,
                     const zt_kernel_1d *along_x, const zt_kernel_1d *along_y) {
    size_t stride = (size_t)width;
    for (int y = 0; y < height; y++)
        filter_row(rows + (size_t)y * stride, from + (size_t)y * stride, width, along_x);
    int r = along_y->radius;
    for (int y = 0; y < height; y++) {
        double *row = to + (size_t)y * stride;
        memset(row, 0, stride * sizeof *row);
        for (int k = -r; k <= r; k++)
            add_scaled(row, rows + (size_t)clamp_int(y + k, height - 1) * stride,
                       along_y->weights[k + r], width);
    }
}
