/* Names for what is used in several places: variables, and the mappings of other names. */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "description/reading.h"

enum {
    EXPANDED_COUNT_MAX = 1000 * 1000, /* nodes that variables stand for */
    DEPTH_MAX = 100                   /* of lists and mappings */
};

typedef struct replacing {
    zt_reading *reading;
    int32_t defined_count; /* of the variables that may be used yet */
    int64_t expanded_count;
} replacing;

/* ---- names ----------------------------------------------------------------------------------
 */

static int by_name(const void *pa, const void *pb) {
    return strcmp(((const zt_name *)pa)->text, ((const zt_name *)pb)->text);
}

zt_status zt_names_open(zt_names *names, zt_reading *reading, const zt_node *mapping,
                        const char *what, const char *expected) {
    *names = (zt_names){0};
    if (!mapping || zt_node_empty(mapping)) return ZT_OK;
    if (mapping->kind != ZT_NODE_MAPPING) {
        zt_expected(&reading->mistakes, mapping, what, expected);
        return ZT_OK;
    }
    zt_name *sorted = ZT_PUSH(reading->temporary, zt_name, (size_t)mapping->count);
    if (!sorted) return ZT_EMEMORY;
    for (int32_t i = 0; i < mapping->count; i++)
        sorted[i] = (zt_name){zt_node_key(mapping, i)->text, i};
    qsort(sorted, (size_t)mapping->count, sizeof *sorted, by_name);
    *names = (zt_names){mapping, sorted};
    return ZT_OK;
}

/* The entry of a name among the first `count`, or -1. */
static int32_t find(const zt_names *names, const char *text, int32_t count) {
    zt_name wanted = {.text = text};
    const zt_name *found = count
                               ? bsearch(&wanted, names->sorted, (size_t)names->mapping->count,
                                         sizeof wanted, by_name)
                               : NULL;
    return found && found->entry < count ? found->entry : -1;
}

static void tell_unknown(zt_mistakes *mistakes, const zt_names *names, const zt_node *node,
                         const char *text, int32_t count, const char *what) {
    enum { TRIED_MAX = 1000 };
    zt_nearest nearest = zt_nearest_to(text);
    for (int32_t i = 0; i < count && i < TRIED_MAX && !zt_mistakes_full(mistakes); i++)
        zt_nearest_try(&nearest, zt_node_key(names->mapping, i)->text);
    zt_mistake(mistakes, &node->place, "no %s is named \"%s\"%s", what, zt_show(text).text,
               zt_suggest(&nearest).text);
}

const zt_node *zt_name_find(const zt_names *names, const char *text) {
    int32_t entry = find(names, text, names->mapping ? names->mapping->count : 0);
    return entry >= 0 ? zt_node_value(names->mapping, entry) : NULL;
}

const zt_node *zt_named(zt_reading *reading, const zt_names *names, const zt_node *node,
                        const char *what) {
    const char *text = zt_read_text(&reading->mistakes, node, what);
    const zt_node *found = text ? zt_name_find(names, text) : NULL;
    if (text && !found)
        tell_unknown(&reading->mistakes, names, node, text,
                     names->mapping ? names->mapping->count : 0, what);
    return found;
}

/* ---- variables ------------------------------------------------------------------------------
 */

static bool is_use(const zt_node *node) {
    return node->kind == ZT_NODE_TEXT && !node->quoted && node->text[0] == '$' && node->text[1];
}

static zt_status replace_below(replacing *r, const zt_node *node, int depth, bool expanded);

/* What stands where a variable is used: its value, at the place of the use. */
static zt_status replace_use(zt_node **out, replacing *r, const zt_node *use) {
    const zt_names *variables = &r->reading->variables;
    const char *name = use->text + 1;
    zt_node *copy = *out = ZT_PUSH(r->reading->temporary, zt_node, 1);
    if (!copy) return ZT_EMEMORY;
    int32_t entry = find(variables, name, r->defined_count);
    if (entry < 0) {
        tell_unknown(&r->reading->mistakes, variables, use, name, r->defined_count, "variable");
        *copy = (zt_node){.kind = ZT_NODE_MISTAKE, .text = use->text};
    } else
        *copy = *zt_node_value(variables->mapping, entry);
    copy->place = use->place;
    return ZT_OK;
}

/* Replaces a value that is a use, and what is used in it. */
static zt_status replace_value(const zt_node **value, replacing *r, int depth, bool expanded) {
    if (is_use(*value)) {
        zt_node *copy;
        ZT_TRY(replace_use(&copy, r, *value));
        *value = copy;
        expanded = true;
    }
    r->expanded_count += expanded;
    return replace_below(r, *value, depth, expanded);
}

/* The times of keys may be variables; other keys are words. */
static zt_status replace_keys(replacing *r, const zt_node *mapping) {
    const zt_node **items = (const zt_node **)mapping->items;
    for (int32_t i = 0; i < mapping->count; i++) {
        const zt_node **key = &items[2 * (size_t)i], *use = *key;
        if (!is_use(use)) continue;
        zt_node *copy;
        ZT_TRY(replace_use(&copy, r, use));
        if (copy->kind == ZT_NODE_LIST || copy->kind == ZT_NODE_MAPPING) {
            zt_mistake(&r->reading->mistakes, &use->place, "\"%s\" is no time",
                       zt_show(use->text).text);
            copy->kind = ZT_NODE_MISTAKE;
            copy->text = use->text;
        }
        *key = copy;
    }
    return ZT_OK;
}

/* Replaces what is used in a node that is not itself a use. The nodes are those that the parser
 * made for this reading: no others point to their items. What an alias shares is met again, and
 * then there is nothing left to replace. */
static zt_status replace_below(replacing *r, const zt_node *node, int depth, bool expanded) {
    if (node->kind != ZT_NODE_LIST && node->kind != ZT_NODE_MAPPING) return ZT_OK;
    if (depth > DEPTH_MAX || r->expanded_count > EXPANDED_COUNT_MAX) {
        zt_mistake(&r->reading->mistakes, &node->place,
                   "the variables up to here stand for too many values");
        return ZT_EDESCRIPTION;
    }
    bool mapping = node->kind == ZT_NODE_MAPPING;
    const zt_node **items = (const zt_node **)node->items;
    size_t step = mapping ? 2 : 1;
    for (size_t i = mapping ? 1 : 0; i < step * (size_t)node->count; i += step) {
        if (mapping && zt_text_equal(items[i - 1]->text, "keys") &&
            items[i]->kind == ZT_NODE_MAPPING)
            ZT_TRY(replace_keys(r, items[i]));
        ZT_TRY(replace_value(&items[i], r, depth + 1, expanded));
    }
    return ZT_OK;
}

/* Letters, digits and "_", so that expressions can use it. */
static bool is_name(const char *text) {
    if (!isalpha((unsigned char)*text) && *text != '_') return false;
    while (isalnum((unsigned char)*text) || *text == '_') text++;
    return !*text;
}

/* The mapping of variables, with those that are set from outside, and each with those before it
 * in place. */
static zt_status read_variables(replacing *r, const zt_node *mapping) {
    zt_reading *reading = r->reading;
    size_t count = (size_t)mapping->count;
    const char **names = ZT_PUSH(reading->temporary, const char *, count);
    if (!names) return ZT_EMEMORY;
    for (size_t i = 0; i < count; i++) {
        const zt_node *key = zt_node_key(mapping, (int32_t)i);
        names[i] = key->text;
        if (!is_name(names[i]))
            zt_mistake(&reading->mistakes, &key->place,
                       "\"%s\" is no name for a variable: letters, digits and _",
                       zt_show(names[i]).text);
    }
    ZT_TRY(zt_override_in(&mapping, reading, "variables", names, mapping->count));
    ZT_TRY(zt_names_open(&reading->variables, reading, mapping, "variables", ""));
    const zt_node **items = (const zt_node **)mapping->items;
    for (; r->defined_count < mapping->count; r->defined_count++) {
        const zt_node **value = &items[2 * (size_t)r->defined_count + 1];
        ZT_TRY(replace_value(value, r, 1, false));
    }
    return ZT_OK;
}

zt_status zt_variables_apply(zt_reading *reading, const zt_node *root) {
    replacing r = {.reading = reading};
    if (root->kind != ZT_NODE_MAPPING) return ZT_OK;
    const zt_node *variables = zt_field(&(zt_fields){.mapping = root}, "variables");
    if (variables && variables->kind == ZT_NODE_MAPPING)
        ZT_TRY(read_variables(&r, variables));
    else if (variables && !zt_node_empty(variables))
        zt_expected(&reading->mistakes, variables, "variables", "a mapping of names to values");
    for (int i = 0; i < reading->overrides.count; i++) {
        const zt_node **value = &reading->overrides.values[i];
        if (*value) ZT_TRY(replace_value(value, &r, 1, false));
    }
    return replace_below(&r, root, 0, false);
}
