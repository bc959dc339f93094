/* Chooses the widest compiled version of the integrator that this machine can run. */
#include <stdlib.h>

#include "base/text.h"
#include "tracer/classic.h"

zt_classic_trace zt_classic_trace_base;
#if defined __x86_64__
zt_classic_trace zt_classic_trace_avx2, zt_classic_trace_avx512;
#endif

zt_classic_trace *zt_classic_select(void) {
    const char *wanted = getenv("ZOETROPE_ISA");
#if defined __x86_64__
    bool any = !wanted || !*wanted;
    bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
    if (has_avx512 && (any || zt_text_equal(wanted, "avx512"))) return zt_classic_trace_avx512;
    if (__builtin_cpu_supports("avx2") && (any || zt_text_equal(wanted, "avx2")))
        return zt_classic_trace_avx2;
#else
    (void)wanted;
#endif
    return zt_classic_trace_base;
}
