/* Memory for what is large and read here and there. */
#ifndef ZT_BASE_PAGES_H
#define ZT_BASE_PAGES_H

#include <stddef.h>

/* Memory whose contents mean nothing, of whole lines of a cache, and in large pages where it is
 * large and the system has them; for free(). NULL when out of memory. */
void *zt_pages_alloc(size_t size);

#endif
