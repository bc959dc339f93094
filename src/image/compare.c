#include <zoetrope/compare.h>

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/arena.h"
#include "base/diag.h"
#include "image/develop.h"
#include "image/flip.h"
#include "image/ssim.h"

static size_t pixel_count(const zt_image *image) {
    return (size_t)image->width * (size_t)image->height;
}

static bool is_finite(const float *pixel) {
    return isfinite(pixel[0]) && isfinite(pixel[1]) && isfinite(pixel[2]);
}

/* ---- linear light --------------------------------------------------------------------------
 */

/* The element that would be at `rank` if all were sorted (Hoare, "Find", 1961); reorders them.
 */
static float element_at(float *a, size_t count, size_t rank) {
    size_t low = 0, high = count - 1;
    while (low < high) {
        float pivot = a[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;; i++, j--) {
            while (a[i] < pivot) i++;
            while (pivot < a[j]) j--;
            if (i >= j) break;
            float swapped = a[i];
            a[i] = a[j];
            a[j] = swapped;
        }
        if (rank <= j)
            high = j;
        else
            low = j + 1;
    }
    return a[rank];
}

static zt_status compare_light(zt_difference *d, const zt_image *image,
                               const zt_image *reference, zt_arena *arena) {
    size_t count = pixel_count(image), not_finite = 0;
    float *largest = ZT_PUSH(arena, float, count);
    if (!largest) return ZT_EMEMORY;
    double squares = 0, relative = 0;
    for (size_t i = 0; i < count; i++) {
        const float *a = image->pixels + 4 * i, *b = reference->pixels + 4 * i;
        bool finite = is_finite(a), reference_finite = is_finite(b);
        not_finite += !finite;
        for (int c = 0; c < 3; c++) {
            double right = reference_finite ? (double)b[c] : 0;
            double wrong = (finite ? (double)a[c] : 0) - right;
            squares += wrong * wrong;
            relative += wrong * wrong / (right * right + 0.01);
            largest[i] = fmaxf(largest[i], (float)fabs(wrong));
        }
    }
    d->rmse = sqrt(squares / (3 * (double)count));
    d->relative_mse = relative / (3 * (double)count);
    d->not_finite = (double)not_finite / (double)count;
    d->p999 = (double)element_at(largest, count, count - 1 - count / 1000);
    return ZT_OK;
}

/* ---- what a display shows ------------------------------------------------------------------
 */

static uint8_t *develop(const zt_image *image, zt_view view, zt_arena *arena) {
    size_t stride = 3 * (size_t)image->width;
    const zt_developing how = {.view = view};
    uint8_t *bytes = ZT_PUSH(arena, uint8_t, stride * (size_t)image->height);
    if (bytes) zt_develop_8(bytes, stride, image, &how, 0, image->height);
    return bytes;
}

static double psnr_db(const uint8_t *a, const uint8_t *b, size_t count) {
    uint64_t squares = 0;
    for (size_t i = 0; i < count; i++) {
        int d = a[i] - b[i];
        squares += (uint64_t)(d * d);
    }
    return 10 * log10(255.0 * 255.0 * (double)count / (double)squares);
}

static zt_status compare_display(zt_difference *d, const zt_image *image,
                                 const zt_image *reference, zt_view view, zt_arena *arena) {
    const uint8_t *a = develop(image, view, arena), *b = develop(reference, view, arena);
    if (!a || !b) return ZT_EMEMORY;
    size_t count = 3 * pixel_count(image);
    d->psnr_db = psnr_db(a, b, count);
    d->ssim = 1;
    d->flip = 0;
    if (memcmp(a, b, count) == 0) return ZT_OK;
    ZT_TRY(zt_ssim(&d->ssim, a, b, image->width, image->height, arena));
    return zt_flip(&d->flip, a, b, image->width, image->height, arena);
}

zt_status zt_compare(zt_difference *difference, const zt_image *image,
                     const zt_image *reference, zt_view view) {
    if (image->width != reference->width || image->height != reference->height)
        return ZT_EARGUMENT;
    zt_arena arena = {0};
    zt_status status = compare_light(difference, image, reference, &arena);
    if (status == ZT_OK) status = compare_display(difference, image, reference, view, &arena);
    zt_arena_free(&arena);
    return status;
}

/* ---- alone ---------------------------------------------------------------------------------
 */

double zt_compare_rmse(const zt_image *image, const zt_image *reference) {
    double squares = 0;
    size_t count = pixel_count(image);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 4 * i; c < 4 * i + 3; c++) {
            double wrong = (double)image->pixels[c] - (double)reference->pixels[c];
            squares += wrong * wrong;
        }
    return sqrt(squares / (3 * (double)count));
}

double zt_compare_flicker(const zt_image *image, const zt_image *reference,
                          const zt_image *next_image, const zt_image *next_reference) {
    double squares = 0;
    size_t count = pixel_count(image);
    for (size_t i = 0; i < count; i++)
        for (size_t c = 4 * i; c < 4 * i + 3; c++) {
            double before = (double)image->pixels[c] - (double)reference->pixels[c];
            double after = (double)next_image->pixels[c] - (double)next_reference->pixels[c];
            squares += (after - before) * (after - before);
        }
    return sqrt(squares / (3 * (double)count));
}
