/* Planes: one number a pixel, rows from the top. */
#ifndef ZT_IMAGE_PLANES_H
#define ZT_IMAGE_PLANES_H

enum { ZT_KERNEL_RADIUS_MAX = 64 };

/* Weights of the neighbours -radius .. radius along one axis. */
typedef struct zt_kernel_1d {
    int radius;
    double weights[2 * ZT_KERNEL_RADIUS_MAX + 1];
} zt_kernel_1d;

/* e^(-x^2 / (2 sigma^2)) for whole pixels, with a sum of 1. */
zt_kernel_1d zt_kernel_gaussian(double sigma, int radius);

/* Weighs each pixel's neighbours along x by one kernel and along y by another; beyond its edges
 * the plane goes on as it ends. `from` and `to` may be the same; `rows` is as large as they
 * are, and its contents are lost. */
void zt_plane_filter(double *to, const double *from, double *rows, int width, int height,
                     const zt_kernel_1d *along_x, const zt_kernel_1d *along_y);

#endif
