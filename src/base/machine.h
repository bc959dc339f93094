/* The architecture that this is compiled for. The same floating-point code gives the same bits
 * on all machines of one, and numbers lie in memory the same way: on another one neither is
 * said. */
#ifndef ZT_BASE_MACHINE_H
#define ZT_BASE_MACHINE_H

#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
#define ZT_MACHINE_ORDER ""
#else
#define ZT_MACHINE_ORDER "-big-endian"
#endif

#if defined __x86_64__
#define ZT_MACHINE "x86-64" ZT_MACHINE_ORDER
#elif defined __aarch64__
#define ZT_MACHINE "aarch64" ZT_MACHINE_ORDER
#elif defined __riscv && __riscv_xlen == 64
#define ZT_MACHINE "riscv64" ZT_MACHINE_ORDER
#elif defined __powerpc64__
#define ZT_MACHINE "powerpc64" ZT_MACHINE_ORDER
#elif defined __s390x__
#define ZT_MACHINE "s390x" ZT_MACHINE_ORDER
#else
#error "this architecture needs a name, so that its pixels are not taken for another one's"
#endif

#endif
