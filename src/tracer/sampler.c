#include "tracer/sampler.h"

#include "tracer/isa.h"

ZT_CLONES void zt_sample_points(float *restrict u, float *restrict v,
                                const uint32_t *restrict key, uint32_t dimension,
                                uint32_t sample, int count) {
    for (int i = 0; i < count; i++) zt_sample_point(&u[i], &v[i], key[i], dimension, sample);
}
