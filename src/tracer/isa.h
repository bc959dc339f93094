/* Code for several widths of instructions and two precisions from one source: CMake compiles a
 * file once for each, with ZT_ISA in the ending of its public names. Without fused operations
 * and reordering, all widths give the same bits. */
#ifndef ZT_TRACER_ISA_H
#define ZT_TRACER_ISA_H

#include "base/wide.h"
#include "tracer/real.h"

#define ZT_ISA_PASTE_(name, isa) name##_##isa
#define ZT_ISA_PASTE(name, isa)  ZT_ISA_PASTE_(name, isa)
#define ZT_KERNEL_NAME(name)     ZT_ISA_PASTE(ZT_REAL_NAME(name), ZT_ISA)

/* Before a loop whose rounds do not depend on each other, though they seem to. */
#if defined __clang__
#define WIDE_LOOP _Pragma("clang loop vectorize(assume_safety)")
#else
#define WIDE_LOOP _Pragma("GCC ivdep")
#endif

#endif
