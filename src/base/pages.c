#include "base/pages.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

enum { LINE = 64, LARGE_PAGE = 1 << 21 };

void *zt_pages_alloc(size_t size) {
    if (size > SIZE_MAX - LINE) return NULL;
    size_t align = size < 2 * (size_t)LARGE_PAGE ? LINE : LARGE_PAGE;
    void *memory;
    if (posix_memalign(&memory, align, (size + LINE - 1) / LINE * LINE) != 0) return NULL;
#ifdef MADV_HUGEPAGE
    if (align == LARGE_PAGE) (void)madvise(memory, size, MADV_HUGEPAGE);
#endif
    return memory;
}
