/* Shows that pictures are compared as the papers say: by closed forms, and by the same measures
 * written once more, in double precision and as slow as their definitions. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <zoetrope/compare.h>

#include "base/random.h"

static const double pi = 3.14159265358979323846;

static zt_image *image_of(int width, int height) {
    zt_image *image;
    assert_int_equal(zt_image_create(&image, width, height), ZT_OK);
    return image;
}

static zt_image *plain(int width, int height, float r, float g, float b) {
    zt_image *image = image_of(width, height);
    for (int i = 0; i < width * height; i++)
        memcpy(image->pixels + 4 * i, (float[3]){r, g, b}, 3 * sizeof(float));
    return image;
}

/* Numbers that eight bits hold, so that a raw view shows them as they are. */
static double noise(uint64_t seed, int i) {
    return (double)(zt_random_key(seed, (uint64_t)i) >> 56) / 255;
}

static zt_image *noisy(int width, int height, uint64_t seed) {
    zt_image *image = image_of(width, height);
    for (int i = 0; i < 4 * width * height; i++)
        if (i % 4 < 3) image->pixels[i] = (float)noise(seed, i);
    return image;
}

static zt_difference compare(const zt_image *a, const zt_image *b, zt_view view) {
    zt_difference d;
    assert_int_equal(zt_compare(&d, a, b, view), ZT_OK);
    return d;
}

static void assert_near(double is, double should, double tolerance) {
    if (!(fabs(is - should) <= tolerance)) fail_msg("%.9g should be %.9g", is, should);
}

/* Nothing differs from itself, whatever it is. */
static void the_same(void **state) {
    (void)state;
    zt_image *a = noisy(40, 30, 1);
    zt_difference d = compare(a, a, ZT_VIEW_SRGB);
    assert_true(d.rmse == 0 && d.relative_mse == 0 && d.p999 == 0 && d.not_finite == 0);
    assert_true(d.psnr_db == INFINITY && d.ssim == 1 && d.flip == 0);
    zt_image *small = image_of(1, 1);
    assert_int_equal(zt_compare(&d, a, small, ZT_VIEW_RAW), ZT_EARGUMENT);
    zt_image_free(&a);
    zt_image_free(&small);
}

/* Errors of linear light whose sums one can do by hand; none is cut to what a display shows. */
static void light(void **state) {
    (void)state;
    zt_image *a = plain(50, 40, 3, 2, 0.5f), *b = plain(50, 40, 1, 2, 0.25f);
    zt_difference d = compare(a, b, ZT_VIEW_SRGB);
    assert_near(d.rmse, sqrt((4 + 0 + 0.0625) / 3), 1e-12);
    assert_near(d.relative_mse, (4 / 1.01 + 0.0625 / (0.0625 + 0.01)) / 3, 1e-12);
    assert_near(d.p999, 2, 1e-12);
    assert_near(zt_compare_rmse(a, b), d.rmse, 1e-15);
    zt_image_free(&a);
    zt_image_free(&b);
}

/* Of 2,000 pixels the two worst are the 0.1 %: the third shows as the percentile, in whatever
 * order they come and however many are equal. */
static void percentile(void **state) {
    (void)state;
    for (uint64_t seed = 0; seed < 20; seed++) {
        zt_image *a = image_of(50, 40), *b = image_of(50, 40);
        for (int i = 0; i < 2000; i++)
            a->pixels[4 * i + i % 3] = seed % 2 ? (float)noise(seed, i) / 2 : 0.25f;
        const float worst[] = {9, 8, 0.75f};
        for (int i = 0; i < 3; i++)
            a->pixels[4 * ((zt_random_key(seed, 99) + 613 * (uint64_t)i) % 2000) + 1] =
                worst[i];
        assert_near(compare(a, b, ZT_VIEW_RAW).p999, 0.75, 0);
        zt_image_free(&a);
        zt_image_free(&b);
    }
}

/* What is not finite is counted, and else as black. */
static void not_finite(void **state) {
    (void)state;
    zt_image *a = plain(20, 10, 0.5f, 0.5f, 0.5f), *b = plain(20, 10, 0.5f, 0.5f, 0.5f);
    a->pixels[4 * 7] = NAN;
    a->pixels[4 * 9 + 2] = INFINITY;
    zt_difference d = compare(a, b, ZT_VIEW_RAW);
    assert_near(d.not_finite, 0.01, 1e-15);
    assert_near(d.rmse, sqrt(2 * 0.25 / 200), 1e-12);
    assert_true(isfinite(d.psnr_db) && isfinite(d.ssim) && isfinite(d.flip));
    zt_image_free(&a);
    zt_image_free(&b);
}

/* The ratio of a peak of 255 to the difference in whole steps of eight bits. */
static void psnr(void **state) {
    (void)state;
    zt_image *a = plain(30, 30, 100 / 255.0f, 0, 1), *b = plain(30, 30, 103 / 255.0f, 0, 1);
    assert_near(compare(a, b, ZT_VIEW_RAW).psnr_db, 20 * log10(255 / sqrt(9 / 3.0)), 1e-9);
    zt_image_free(&a);
    zt_image_free(&b);
}

/* Flicker is the change of the error: a steady error has none, nor has what moves in both;
 * independent errors have the root of the sum of their squares. */
static void flicker(void **state) {
    (void)state;
    zt_image *first = noisy(40, 30, 1), *second = noisy(40, 30, 2);
    zt_image *first_off = noisy(40, 30, 1), *second_off = noisy(40, 30, 2);
    for (int i = 0; i < 4 * 40 * 30; i++) {
        first_off->pixels[i] += 0.125f;
        second_off->pixels[i] += 0.125f;
    }
    assert_near(zt_compare_flicker(first_off, first, second_off, second), 0, 1e-7);
    for (int i = 0; i < 4 * 40 * 30; i++) second_off->pixels[i] -= i % 8 < 4 ? 0.25f : 0;
    assert_near(zt_compare_flicker(first_off, first, second_off, second), 0.25 * sqrt(0.5),
                1e-7);
    zt_image_free(&first);
    zt_image_free(&second);
    zt_image_free(&first_off);
    zt_image_free(&second_off);
}

/* ---- structural similarity -----------------------------------------------------------------
 */

static double luma(const zt_image *image, int x, int y) {
    const float *p = image->pixels + 4 * (y * image->width + x);
    return 0.2126 * (double)p[0] + 0.7152 * (double)p[1] + 0.0722 * (double)p[2];
}

/* Around each pixel that is five or more from all edges: the weighted moments about the means.
 */
static double slow_ssim(const zt_image *a, const zt_image *b) {
    double sum = 0, c1 = 1e-4, c2 = 9e-4;
    int count = 0;
    for (int y = 5; y < a->height - 5; y++)
        for (int x = 5; x < a->width - 5; x++, count++) {
            double w = 0, ma = 0, mb = 0, va = 0, vb = 0, vab = 0;
            for (int pass = 0; pass < 2; pass++) {
                for (int j = -5; j <= 5; j++)
                    for (int i = -5; i <= 5; i++) {
                        double g = exp(-(i * i + j * j) / (2 * 1.5 * 1.5));
                        double la = luma(a, x + i, y + j), lb = luma(b, x + i, y + j);
                        if (pass == 0) w += g, ma += g * la, mb += g * lb;
                        if (pass == 1) va += g / w * (la - ma) * (la - ma);
                        if (pass == 1) vb += g / w * (lb - mb) * (lb - mb);
                        if (pass == 1) vab += g / w * (la - ma) * (lb - mb);
                    }
                if (pass == 0) ma /= w, mb /= w;
            }
            sum += (2 * ma * mb + c1) * (2 * vab + c2) /
                   ((ma * ma + mb * mb + c1) * (va + vb + c2));
        }
    return sum / count;
}

static void ssim(void **state) {
    (void)state;
    zt_image *a = plain(20, 20, 0.2f, 0.2f, 0.2f), *b = plain(20, 20, 0.6f, 0.6f, 0.6f);
    assert_near(compare(a, b, ZT_VIEW_RAW).ssim, (2 * 0.2 * 0.6 + 1e-4) / (0.04 + 0.36 + 1e-4),
                1e-5);
    zt_image_free(&a);
    zt_image_free(&b);
    const int sizes[][2] = {{11, 11}, {40, 23}, {17, 64}};
    for (uint64_t i = 0; i < 3; i++) {
        a = noisy(sizes[i][0], sizes[i][1], i);
        b = noisy(sizes[i][0], sizes[i][1], i + 10);
        for (int k = 0; i > 0 && k < 4 * a->width * a->height; k++)
            b->pixels[k] =
                (float)(int)(255 * (0.8f * a->pixels[k] + 0.2f * b->pixels[k])) / 255;
        assert_near(compare(a, b, ZT_VIEW_RAW).ssim, slow_ssim(a, b), 1e-6);
        zt_image_free(&a);
        zt_image_free(&b);
    }
    a = plain(3, 7, 0.2f, 0.2f, 0.2f), b = plain(3, 7, 0.6f, 0.6f, 0.6f); /* below a window */
    assert_near(compare(a, b, ZT_VIEW_RAW).ssim, (2 * 0.2 * 0.6 + 1e-4) / (0.04 + 0.36 + 1e-4),
                1e-5);
    zt_image_free(&a);
    zt_image_free(&b);
}

/* ---- FLIP ----------------------------------------------------------------------------------
 */

/* The paper's matrix, and its inverse by Cramer's rule. */
static const double to_xyz[3][3] = {
    {10135552 / 24577794.0, 8788810 / 24577794.0, 4435075 / 24577794.0},
    {2613072 / 12288897.0, 8788810 / 12288897.0, 887015 / 12288897.0},
    {1425312 / 73733382.0, 8788810 / 73733382.0, 70074185 / 73733382.0}};

static void multiply(double to[3], const double m[3][3], const double v[3]) {
    for (int i = 0; i < 3; i++) to[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
}

static void solve(double to[3], const double m[3][3], const double v[3]) {
    double c[3][3], det = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c[i][j] = m[(j + 1) % 3][(i + 1) % 3] * m[(j + 2) % 3][(i + 2) % 3] -
                      m[(j + 1) % 3][(i + 2) % 3] * m[(j + 2) % 3][(i + 1) % 3];
    for (int j = 0; j < 3; j++) det += m[0][j] * c[j][0];
    for (int i = 0; i < 3; i++)
        to[i] = (c[i][0] * v[0] + c[i][1] * v[1] + c[i][2] * v[2]) / det;
}

static double linear(double v) {
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static void white(double to[3]) {
    const double ones[3] = {1, 1, 1};
    multiply(to, to_xyz, ones);
}

static void opponent(double to[3], const double rgb[3]) {
    double xyz[3], w[3];
    white(w);
    multiply(xyz, to_xyz, rgb);
    for (int i = 0; i < 3; i++) xyz[i] /= w[i];
    to[0] = 116 * xyz[1] - 16;
    to[1] = 500 * (xyz[0] - xyz[1]);
    to[2] = 200 * (xyz[1] - xyz[2]);
}

static void from_opponent(double rgb[3], const double c[3]) {
    double w[3], y = (c[0] + 16) / 116;
    white(w);
    double xyz[3] = {(y + c[1] / 500) * w[0], y * w[1], (y - c[2] / 200) * w[2]};
    solve(rgb, to_xyz, xyz);
    for (int i = 0; i < 3; i++) rgb[i] = fmin(fmax(rgb[i], 0), 1);
}

static void hunt(double to[3], const double rgb[3]) {
    double xyz[3], w[3], d = 6 / 29.0;
    white(w);
    multiply(xyz, to_xyz, rgb);
    for (int i = 0; i < 3; i++) {
        double t = xyz[i] / w[i];
        xyz[i] = t > d * d * d ? cbrt(t) : t / (3 * d * d) + 4 / 29.0;
    }
    to[0] = 116 * xyz[1] - 16;
    to[1] = 0.01 * to[0] * 500 * (xyz[0] - xyz[1]);
    to[2] = 0.01 * to[0] * 200 * (xyz[1] - xyz[2]);
}

static double color_error(const double a[3], const double b[3]) {
    const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    double ha[3], hb[3], hg[3], hl[3];
    hunt(ha, a), hunt(hb, b), hunt(hg, green), hunt(hl, blue);
    double e = pow(fabs(ha[0] - hb[0]) + hypot(ha[1] - hb[1], ha[2] - hb[2]), 0.7);
    double most = pow(fabs(hg[0] - hl[0]) + hypot(hg[1] - hl[1], hg[2] - hl[2]), 0.7);
    double bend = 0.4 * most;
    return e < bend ? 0.95 / bend * e : 0.95 + (e - bend) / (most - bend) * 0.05;
}

typedef enum kernel { LIGHT, RED_GREEN, BLUE_YELLOW, SMOOTH, EDGE, POINT } kernel;

static const double ppd = 3840 * pi / 180;

static double weight(kernel k, int x, int y) {
    const double a1[] = {1, 1, 34.1}, b1[] = {0.0047, 0.0053, 0.04}, a2[] = {0, 0, 13.5},
                 b2[] = {1e-5, 1e-5, 0.025};
    double z = (x * x + y * y) / (ppd * ppd), s = 0.5 * 0.082 * ppd;
    double g = exp(-(x * x + y * y) / (2 * s * s));
    if (k == EDGE) return -x * g;
    if (k == POINT) return (x * x / (s * s) - 1) * g;
    return a1[k] * sqrt(pi / b1[k]) * exp(-pi * pi * z / b1[k]) +
           a2[k] * sqrt(pi / b2[k]) * exp(-pi * pi * z / b2[k]);
}

static int limit(int i, int size) { return i < 0 ? 0 : i >= size ? size - 1 : i; }

/* One channel of the opponent colours around a pixel; `turned` swaps the kernel's x and y. */
static double filtered(const zt_image *image, int channel, kernel k, int turned, int x, int y) {
    double above = 0, below = 0, plus = 0, minus = 0;
    double s = 0.5 * 0.082 * ppd;
    int r = (int)ceil(k < SMOOTH ? 3 * sqrt(0.04 / (2 * pi * pi)) * ppd : 3 * s);
    for (int j = -r; j <= r; j++)
        for (int i = -r; i <= r; i++) {
            const float *p = image->pixels + 4 * (limit(y + j, image->height) * image->width +
                                                  limit(x + i, image->width));
            const double rgb[3] = {linear((double)p[0]), linear((double)p[1]),
                                   linear((double)p[2])};
            double c[3], w = turned ? weight(k, j, i) : weight(k, i, j);
            opponent(c, rgb);
            double v = k < SMOOTH ? c[channel] : (c[0] + 16) / 116;
            *(w > 0 ? &above : &below) += fabs(w);
            *(w > 0 ? &plus : &minus) += fabs(w) * v;
        }
    return k < SMOOTH ? plus / above : plus / above - minus / below;
}

static double slow_flip(const zt_image *a, const zt_image *b) {
    const zt_image *images[2] = {a, b};
    double sum = 0;
    for (int y = 0; y < a->height; y++)
        for (int x = 0; x < a->width; x++) {
            double rgb[2][3], feature[2][2];
            for (int i = 0; i < 2; i++) {
                double c[3];
                for (int k = 0; k < 3; k++) c[k] = filtered(images[i], k, (kernel)k, 0, x, y);
                from_opponent(rgb[i], c);
                for (int f = 0; f < 2; f++)
                    feature[i][f] = hypot(filtered(images[i], 0, (kernel)(EDGE + f), 0, x, y),
                                          filtered(images[i], 0, (kernel)(EDGE + f), 1, x, y));
            }
            double most =
                fmax(fabs(feature[0][0] - feature[1][0]), fabs(feature[0][1] - feature[1][1]));
            sum += pow(color_error(rgb[0], rgb[1]), 1 - sqrt(most / sqrt(2)));
        }
    return sum / (a->width * a->height);
}

/* Plain pictures have no features, and their colours stay what they are: FLIP is the paper's
 * difference of colours. Green against blue is what that is scaled to: 1. */
static void flip_plain(void **state) {
    (void)state;
    const float colors[][3] = {{0, 0, 0}, {1, 1, 1}, {0, 1, 0},          {0, 0, 1},
                               {1, 0, 0}, {1, 1, 0}, {0.2f, 0.4f, 0.6f}, {0.2f, 0.4f, 0.8f}};
    enum { COUNT = sizeof colors / sizeof *colors };
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < COUNT; k++) {
            zt_image *a = plain(5, 4, colors[i][0], colors[i][1], colors[i][2]);
            zt_image *b = plain(5, 4, colors[k][0], colors[k][1], colors[k][2]);
            double la[3], lb[3];
            for (int c = 0; c < 3; c++) {
                la[c] = linear((double)colors[i][c]);
                lb[c] = linear((double)colors[k][c]);
            }
            assert_near(compare(a, b, ZT_VIEW_RAW).flip, color_error(la, lb), 1e-6);
            zt_image_free(&a);
            zt_image_free(&b);
        }
    zt_image *green = plain(5, 4, 0, 1, 0), *blue = plain(5, 4, 0, 0, 1);
    assert_near(compare(green, blue, ZT_VIEW_SRGB).flip, 1, 1e-4);
    zt_image_free(&green);
    zt_image_free(&blue);
}

/* Noise, a single bright pixel, an edge: as the definition has it, and the same both ways. */
static void flip_definition(void **state) {
    (void)state;
    enum { WIDTH = 26, HEIGHT = 15 };
    for (int i = 0; i < 4; i++) {
        zt_image *a = noisy(WIDTH, HEIGHT, 1), *b = noisy(WIDTH, HEIGHT, 2);
        for (int k = 0; i > 0 && k < 4 * WIDTH * HEIGHT; k++) {
            float grey = 64 / 255.0f;
            a->pixels[k] = i == 3 ? (k / 4 % WIDTH < 13 ? 1 : grey) : grey;
            b->pixels[k] = i == 2 ? b->pixels[k] : grey;
        }
        if (i == 1) memset(a->pixels + 4 * (7 * WIDTH + 12), 0, 2 * sizeof(float));
        double flip = compare(a, b, ZT_VIEW_RAW).flip;
        assert_near(flip, slow_flip(a, b), 1e-6);
        assert_near(compare(b, a, ZT_VIEW_RAW).flip, flip, 1e-12);
        assert_true(flip > 0.001 && flip < 1);
        zt_image_free(&a);
        zt_image_free(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same),
        cmocka_unit_test(light),
        cmocka_unit_test(percentile),
        cmocka_unit_test(not_finite),
        cmocka_unit_test(psnr),
        cmocka_unit_test(flicker),
        cmocka_unit_test(ssim),
        cmocka_unit_test(flip_plain),
        cmocka_unit_test(flip_definition),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
