/* Code for several widths of instructions from one source. */
#ifndef ZT_BASE_WIDE_H
#define ZT_BASE_WIDE_H

/* Before a function: it is compiled for each width, and the loader chooses. Without fused
 * operations and reordering, all widths give the same bits. */
#if defined __x86_64__
#define ZT_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define ZT_CLONES
#endif

#endif
