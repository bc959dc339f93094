#include "image/ssim.h"

#include <stddef.h>

#include "image/planes.h"

enum { RADIUS = 5, PLANE_COUNT = 6 };
static const double sigma = 1.5;

/* The paper's C1 and C2, for values of 0 to 1. */
static const double steady_mean = 0.01 * 0.01, steady_variance = 0.03 * 0.03;

static double luma(const uint8_t *p) {
    return (0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2]) / 255;
}

/* Of a window's means of a, b, a^2, b^2 and a b. */
static double similarity(double a, double b, double aa, double bb, double ab) {
    double mean = (2 * a * b + steady_mean) / (a * a + b * b + steady_mean);
    return mean * (2 * (ab - a * b) + steady_variance) /
           (aa - a * a + (bb - b * b) + steady_variance);
}

zt_status zt_ssim(double *mean, const uint8_t *image, const uint8_t *reference, int width,
                  int height, zt_arena *arena) {
    size_t count = (size_t)width * (size_t)height;
    double *planes = ZT_PUSH(arena, double, PLANE_COUNT *count);
    if (!planes) return ZT_EMEMORY;
    double *a = planes, *b = a + count, *aa = b + count, *bb = aa + count, *ab = bb + count;
    for (size_t i = 0; i < count; i++) {
        a[i] = luma(image + 3 * i);
        b[i] = luma(reference + 3 * i);
        aa[i] = a[i] * a[i];
        bb[i] = b[i] * b[i];
        ab[i] = a[i] * b[i];
    }
    zt_kernel_1d window = zt_kernel_gaussian(sigma, RADIUS);
    for (int p = 0; p < PLANE_COUNT - 1; p++) {
        double *plane = planes + (size_t)p * count;
        zt_plane_filter(plane, plane, ab + count, width, height, &window, &window);
    }
    int x0 = width > 2 * RADIUS ? RADIUS : 0, y0 = height > 2 * RADIUS ? RADIUS : 0;
    double sum = 0;
    for (int y = y0; y < height - y0; y++)
        for (int x = x0; x < width - x0; x++) {
            size_t i = (size_t)y * (size_t)width + (size_t)x;
            sum += similarity(a[i], b[i], aa[i], bb[i], ab[i]);
        }
    *mean = sum / ((width - 2 * x0) * (height - 2 * y0));
    return ZT_OK;
}
