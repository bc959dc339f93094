/* Luma and chroma: each is the nearest whole number to what BT.709's formulas give. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "image/develop.h"
#include "image/yuv.h"

enum { GAP = 5 }; /* bytes after each row that stay as they are */

typedef struct planes {
    uint8_t *rows[3];
    int strides[3], widths[3], heights[3];
} planes;

static planes develop(const zt_image *image, zt_view view) {
    planes p;
    for (int i = 0; i < 3; i++) {
        p.widths[i] = image->width / (i ? 2 : 1);
        p.heights[i] = image->height / (i ? 2 : 1);
        p.strides[i] = p.widths[i] + GAP;
        size_t size = (size_t)p.strides[i] * (size_t)p.heights[i];
        p.rows[i] = malloc(size);
        assert_non_null(p.rows[i]);
        memset(p.rows[i], 0xee, size);
    }
    zt_develop_yuv420(p.rows, p.strides, image, view);
    for (int i = 0; i < 3; i++)
        for (int y = 0; y < p.heights[i]; y++)
            for (int x = p.widths[i]; x < p.strides[i]; x++)
                assert_int_equal(p.rows[i][y * p.strides[i] + x], 0xee);
    return p;
}

static void free_planes(planes *p) {
    for (int i = 0; i < 3; i++) free(p->rows[i]);
}

/* R' G' B' of 0..1 of a pixel, as a display of 256 steps has it. */
static void display(double rgb[3], const zt_image *image, int x, int y, zt_view view) {
    if (x < 0) x = 0;
    for (int c = 0; c < 3; c++) {
        double linear = (double)image->pixels[4 * (y * image->width + x) + c];
        rgb[c] = floor(255 * zt_develop_value(linear, view) + 0.5) / 255;
    }
}

static double luma_of(const double rgb[3]) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

static void assert_nearest(uint8_t found, double exact, int x, int y, int plane) {
    /* The weights are rounded to 2^-17. */
    if (fabs(found - exact) > 0.5 + 255 * 0x1p-16)
        fail_msg("plane %d, %d %d: %d is not %g", plane, x, y, found, exact);
}

static void compare(const zt_image *image, zt_view view) {
    planes p = develop(image, view);
    double rgb[3];
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            display(rgb, image, x, y, view);
            assert_nearest(p.rows[0][y * p.strides[0] + x], 16 + 219 * luma_of(rgb), x, y, 0);
        }
    const double weights[3] = {0.25, 0.5, 0.25};
    for (int y = 0; y < image->height; y += 2)
        for (int x = 0; x < image->width; x += 2) {
            double mean[3] = {0};
            for (int i = 0; i < 6; i++) {
                display(rgb, image, x + i % 3 - 1, y + i / 3, view);
                for (int c = 0; c < 3; c++) mean[c] += weights[i % 3] / 2 * rgb[c];
            }
            double cb = (mean[2] - luma_of(mean)) / 1.8556;
            double cr = (mean[0] - luma_of(mean)) / 1.5748;
            assert_nearest(p.rows[1][y / 2 * p.strides[1] + x / 2], 128 + 224 * cb, x, y, 1);
            assert_nearest(p.rows[2][y / 2 * p.strides[2] + x / 2], 128 + 224 * cr, x, y, 2);
        }
    free_planes(&p);
}

/* Noise of colors within, above and below the range, at sizes around those of the pieces in
 * which a row is developed. */
static void formulas(void **state) {
    (void)state;
    const int widths[] = {2, 4, 6, 62, 254, 256, 258, 510, 512, 514, 1282};
    uint64_t random = 88172645463325252u;
    for (int i = 0; i < 11; i++)
        for (int view = ZT_VIEW_RAW; view <= ZT_VIEW_SRGB; view++) {
            zt_image *image;
            assert_int_equal(zt_image_create(&image, widths[i], 2 + i % 3 * 2), ZT_OK);
            for (int k = 0; k < 4 * image->width * image->height; k++) {
                random ^= random << 13, random ^= random >> 7, random ^= random << 17;
                image->pixels[k] = (float)(random % 1201) / 1000 - 0.1f;
            }
            image->pixels[0] = NAN;
            compare(image, (zt_view)view);
            zt_image_free(&image);
        }
}

/* The corners of the cube of colors: nothing wraps around, and greys have no color. */
static void corners(void **state) {
    (void)state;
    for (int corner = 0; corner < 8; corner++) {
        zt_image *image;
        assert_int_equal(zt_image_create(&image, 18, 4), ZT_OK);
        for (int k = 0; k < 18 * 4; k++)
            for (int c = 0; c < 3; c++) image->pixels[4 * k + c] = (float)(corner >> c & 1);
        compare(image, ZT_VIEW_SRGB);
        zt_image_free(&image);
    }
    for (int grey = 0; grey <= 255; grey++) {
        zt_image *image;
        assert_int_equal(zt_image_create(&image, 4, 2), ZT_OK);
        for (int k = 0; k < 8; k++)
            for (int c = 0; c < 3; c++) image->pixels[4 * k + c] = (float)grey / 255;
        planes p = develop(image, ZT_VIEW_RAW);
        assert_int_equal(p.rows[0][0], (int)floor(16 + 219 * (grey / 255.0) + 0.5));
        assert_int_equal(p.rows[1][1], 128);
        assert_int_equal(p.rows[2][1], 128);
        free_planes(&p);
        zt_image_free(&image);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(formulas), cmocka_unit_test(corners)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
