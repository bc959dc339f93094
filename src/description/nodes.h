/* Building nodes bottom up, in the order in which a parser meets them. What a text can cost is
 * bounded before it is paid: depth, number of nodes, and what aliases expand to. */
#ifndef ZT_DESCRIPTION_NODES_H
#define ZT_DESCRIPTION_NODES_H

#include <stddef.h>

#include "base/arena.h"
#include "description/mistakes.h"
#include "description/node.h"

typedef struct zt_nodes zt_nodes;

/* The nodes go to the arena and outlive the builder, which the caller frees. */
zt_status zt_nodes_create(zt_nodes **nodes, zt_arena *arena, zt_mistakes *mistakes);
void zt_nodes_free(zt_nodes **nodes);

/* What YAML may write before a node; both NULL as a rule. */
typedef struct zt_node_marks {
    const char *anchor, *tag;
} zt_node_marks;

/* All of these tell what is wrong. ZT_EDESCRIPTION: nothing more can be taken; ZT_EMEMORY. */
zt_status zt_nodes_text(zt_nodes *nodes, const zt_place *place, zt_node_marks marks,
                        const char *text, size_t length, bool quoted);
zt_status zt_nodes_alias(zt_nodes *nodes, const zt_place *place, const char *anchor);
/* A list or a mapping, whose items (of a mapping: keys and values in turn) come before its end.
 */
zt_status zt_nodes_begin(zt_nodes *nodes, const zt_place *place, zt_node_marks marks,
                         zt_node_kind kind);
zt_status zt_nodes_end(zt_nodes *nodes, int end_line, int end_column);

/* The node around all others; NULL before it is finished. */
const zt_node *zt_nodes_root(const zt_nodes *nodes);

#endif
