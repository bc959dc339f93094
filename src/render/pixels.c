#include "render/pixels.h"

#include <string.h>
#if defined __SSE__
#include <xmmintrin.h>
#endif

#include "render/work.h"
#include "tracer/isa.h"

/* Pixels side by side that are written at once. */
enum { RUN = 4 };

/* Adds a sample of each pixel, from `first` in the batch on, to the sums; returns how many were
 * not finite. */
ZT_CLONES static int add_samples(zt_radiance *restrict sum, int32_t *restrict taken,
                                 const zt_radiance *restrict light, int first, int count) {
    int left_out = 0;
    for (int i = 0; i < count; i++) {
        float r = light->r[first + i], g = light->g[first + i], b = light->b[first + i];
        bool finite = zt_finite3(r, g, b);
        sum->r[i] += finite ? r : 0;
        sum->g[i] += finite ? g : 0;
        sum->b[i] += finite ? b : 0;
        taken[i] += finite;
        left_out += !finite;
    }
    return left_out;
}

/* Adds which of those samples met something. */
ZT_CLONES static void add_cover(zt_radiance *restrict sum, const zt_radiance *restrict light,
                                int first, int count) {
    for (int i = 0; i < count; i++) {
        bool finite = zt_finite3(light->r[first + i], light->g[first + i], light->b[first + i]);
        sum->a[i] += finite ? light->a[first + i] : 0;
    }
}

ZT_CLONES static void average(zt_radiance *restrict sum, const int32_t *restrict taken,
                              int count) {
    for (int i = 0; i < count; i++) {
        float share = taken[i] ? 1 / (float)taken[i] : 0;
        sum->r[i] *= share;
        sum->g[i] *= share;
        sum->b[i] *= share;
    }
}

/* The mean of what was added, 1 where all samples met something. */
static void find_alpha(float *restrict alpha, const int32_t *restrict taken, int count,
                       bool transparent) {
    for (int i = 0; i < count; i++)
        alpha[i] = !transparent ? 1 : taken[i] ? alpha[i] / (float)taken[i] : 0;
}

ZT_CLONES int zt_pixels_settle(zt_radiance *restrict light, int count, bool transparent) {
    int left_out = 0;
    for (int i = 0; i < count; i++) {
        bool finite = zt_finite3(light->r[i], light->g[i], light->b[i]);
        light->r[i] = finite ? light->r[i] : 0;
        light->g[i] = finite ? light->g[i] : 0;
        light->b[i] = finite ? light->b[i] : 0;
        light->a[i] = transparent ? finite ? light->a[i] : 0 : 1;
        left_out += !finite;
    }
    return left_out;
}

int zt_pixels_add(zt_radiance *sum, int32_t *taken, const zt_radiance *light, int first,
                  int count, bool transparent) {
    if (transparent) add_cover(sum, light, first, count);
    return add_samples(sum, taken, light, first, count);
}

void zt_pixels_average(zt_radiance *sum, const int32_t *taken, int count, bool transparent) {
    average(sum, taken, count);
    find_alpha(sum->a, taken, count, transparent);
}

/* Four pixels, a line of a cache, past the caches: a picture that does not fit there is written
 * without being read before. */
static inline void stream_run(float *to, const float *r, const float *g, const float *b,
                              const float *a) {
#if defined __SSE__
    __m128 x = _mm_load_ps(r), y = _mm_load_ps(g), z = _mm_load_ps(b), w = _mm_load_ps(a);
    _MM_TRANSPOSE4_PS(x, y, z, w);
    _mm_stream_ps(to, x);
    _mm_stream_ps(to + 4, y);
    _mm_stream_ps(to + 8, z);
    _mm_stream_ps(to + 12, w);
#else
    for (int k = 0; k < RUN; k++)
        memcpy(to + 4 * k, (float[4]){r[k], g[k], b[k], a[k]}, 4 * sizeof(float));
#endif
}

void zt_pixels_clear(float *pixels, int count, bool transparent) {
    const float bare[4] = {0, 0, 0, transparent ? 0 : 1};
    for (int i = 0; i < count; i++) memcpy(pixels + 4 * (size_t)i, bare, sizeof bare);
}

void zt_pixels_fill(float *restrict pixels, int width, const zt_radiance *restrict sum,
                    const int32_t *restrict column, const int32_t *restrict row, int count,
                    bool whole) {
    bool runs = whole && width % RUN == 0;
    for (int i = 0; runs && i < count; i += RUN)
        stream_run(pixels + 4 * ((size_t)row[i] * (size_t)width + (size_t)column[i]),
                   sum->r + i, sum->g + i, sum->b + i, sum->a + i);
    for (int i = 0; !runs && i < count; i++) {
        float *to = pixels + 4 * ((size_t)row[i] * (size_t)width + (size_t)column[i]);
        memcpy(to, (float[4]){sum->r[i], sum->g[i], sum->b[i], sum->a[i]}, 4 * sizeof(float));
    }
}

void zt_pixels_fill_paths(uint32_t *restrict paths, int width, const uint32_t *restrict path,
                          const int32_t *restrict column, const int32_t *restrict row,
                          int count, bool whole) {
    int run = whole ? RUN : 1;
    for (int i = 0; i < count; i += run)
        memcpy(paths + (size_t)row[i] * (size_t)width + (size_t)column[i], path + i,
               whole ? RUN * sizeof *path : sizeof *path);
}
