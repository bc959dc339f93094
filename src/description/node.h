/* What a description is made of, whatever it says: texts, lists and mappings that know their
 * place. */
#ifndef ZT_DESCRIPTION_NODE_H
#define ZT_DESCRIPTION_NODE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/diag.h"
#include "base/text.h"

typedef enum zt_node_kind {
    ZT_NODE_TEXT,
    ZT_NODE_LIST,
    ZT_NODE_MAPPING,
    ZT_NODE_MISTAKE /* stands where something was told already: to be passed over silently */
} zt_node_kind;

/* An alias is the very node that its anchor names, so nodes are shared; there are no cycles. */
typedef struct zt_node {
    zt_place place;
    zt_node_kind kind;
    bool quoted;   /* of a text: it stands in quotes, so it is no number and not empty */
    int32_t count; /* items of a list, entries of a mapping */
    union {
        const char *text;
        const struct zt_node *const *items; /* of a mapping: key, value, key, value ...; the
                                             * keys are texts, each of them once */
    };
} zt_node;

static inline const zt_node *zt_node_key(const zt_node *mapping, int32_t entry) {
    return mapping->items[2 * (int64_t)entry];
}
static inline const zt_node *zt_node_value(const zt_node *mapping, int32_t entry) {
    return mapping->items[2 * (int64_t)entry + 1];
}

/* Whether nothing is written where the node stands: "key:", "key: ~" or "key: null". */
static inline bool zt_node_empty(const zt_node *node) {
    return node->kind == ZT_NODE_TEXT && !node->quoted &&
           (zt_text_equal(node->text, "") || zt_text_equal(node->text, "~") ||
            zt_text_equal(node->text, "null"));
}

#endif
