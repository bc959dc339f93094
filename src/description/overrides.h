/* What stands outside of the description and replaces something in it: "--set". */
#ifndef ZT_DESCRIPTION_OVERRIDES_H
#define ZT_DESCRIPTION_OVERRIDES_H

#include <zoetrope/animation.h>

#include "description/node.h"

struct zt_reading;

typedef struct zt_overrides {
    int count;
    struct zt_overridden *all;
    const zt_node **values; /* NULL where one has mistakes */
} zt_overrides;

/* Reads names and values; what is wrong with them is told at "--set" and counted. */
zt_status zt_overrides_open(struct zt_reading *reading, const zt_override *overrides,
                            int count);

/* Puts what is overridden of a thing into its mapping, where its key is one of the names: the
 * mapping becomes another one. `thing`, which must outlive the reading, is how the thing's
 * tracks are called, or the word at the top: "film". ZT_EMEMORY. */
zt_status zt_override_in(const zt_node **mapping, struct zt_reading *reading, const char *thing,
                         const char *const *names, int name_count);

/* Tells which of them met nothing. */
void zt_overrides_close(struct zt_reading *reading);

#endif
