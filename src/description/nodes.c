/* Finished nodes wait on a stack until the list or mapping around them ends and takes them.
 * Nothing recurses. */
#include "description/nodes.h"

#include <stdlib.h>
#include <string.h>

enum {
    NODE_COUNT_MAX = 10 * 1000 * 1000,
    EXPANDED_COUNT_MAX = 1000 * 1000, /* nodes met again through aliases */
    DEPTH_MAX = 100,                  /* of lists and mappings, those behind aliases included */
    ANCHOR_COUNT_MAX = 1000,
    BLOCK_SIZE = 64 * 1024
};

/* How much a node stands for, aliases expanded. */
typedef struct extent {
    int64_t size; /* nodes, itself included */
    int depth;    /* of lists and mappings, itself included */
} extent;

/* A list or mapping whose end has not come yet. */
typedef struct frame {
    zt_node *node;
    size_t first_item; /* on the stack of waiting nodes */
    int anchor;        /* or -1 */
    extent extent;     /* so far */
} frame;

typedef struct anchor {
    const char *name;
    const zt_node *node;
    bool open; /* its node has not ended yet */
    extent extent;
} anchor;

/* An entry of a mapping on its way to become one. */
typedef struct entry {
    const zt_node *key, *value;
    size_t rank; /* own entries in their order, then merged ones in theirs */
    bool merged;
} entry;

struct zt_nodes {
    zt_arena *arena;
    zt_mistakes *mistakes;
    char *block; /* memory for small pieces */
    size_t block_left;
    frame frames[DEPTH_MAX];
    int depth;
    anchor anchors[ANCHOR_COUNT_MAX];
    int anchor_count;
    const zt_node **waiting;
    size_t waiting_count, waiting_capacity;
    entry *entries;
    size_t entry_count, entry_capacity;
    int64_t node_count, expanded_count;
    const zt_node *root;
};

zt_status zt_nodes_create(zt_nodes **nodes, zt_arena *arena, zt_mistakes *mistakes) {
    *nodes = calloc(1, sizeof **nodes);
    if (!*nodes) return ZT_EMEMORY;
    (*nodes)->arena = arena;
    (*nodes)->mistakes = mistakes;
    return ZT_OK;
}

void zt_nodes_free(zt_nodes **nodes) {
    if (!*nodes) return;
    free((*nodes)->waiting);
    free((*nodes)->entries);
    free(*nodes);
    *nodes = NULL;
}

const zt_node *zt_nodes_root(const zt_nodes *nodes) { return nodes->root; }

/* Zeroed memory of the arena. Small pieces share a block: there are very many of them. */
static void *push(zt_nodes *n, size_t size) {
    size = (size + 7) / 8 * 8;
    if (size > BLOCK_SIZE / 16) return zt_arena_push(n->arena, size);
    if (size > n->block_left) {
        n->block = zt_arena_push(n->arena, BLOCK_SIZE);
        if (!n->block) return NULL;
        n->block_left = BLOCK_SIZE;
    }
    char *piece = n->block;
    n->block += size;
    n->block_left -= size;
    return piece;
}

static char *push_text(zt_nodes *n, const char *text, size_t length) {
    char *copy = push(n, length + 1);
    if (copy) memcpy(copy, text, length);
    return copy;
}

/* Room for one more element at the end of a growing array. */
static bool reserve(void **array, size_t *capacity, size_t count, size_t element_size) {
    if (count < *capacity) return true;
    size_t wanted = *capacity ? 2 * *capacity : 256;
    void *grown = realloc(*array, wanted * element_size);
    if (!grown) return false;
    *array = grown;
    *capacity = wanted;
    return true;
}

static zt_status too_much(zt_nodes *n, const zt_place *place, const char *what, int most) {
    zt_mistake(n->mistakes, place, "%s: more than %d; nothing after this is read", what, most);
    return ZT_EDESCRIPTION;
}

/* Hands a finished node to the list or mapping around it. */
static zt_status hand_over(zt_nodes *n, const zt_node *node, extent extent) {
    if (n->depth == 0) {
        n->root = node;
        return ZT_OK;
    }
    frame *around = &n->frames[n->depth - 1];
    around->extent.size += extent.size;
    if (around->extent.depth < extent.depth + 1) around->extent.depth = extent.depth + 1;
    if (!reserve((void **)&n->waiting, &n->waiting_capacity, n->waiting_count,
                 sizeof *n->waiting))
        return ZT_EMEMORY;
    n->waiting[n->waiting_count++] = node;
    return ZT_OK;
}

/* YAML's own tags change nothing, but that !!str makes a text of a number. */
static void apply_tag(zt_nodes *n, zt_node *node, const char *tag) {
    static const char own[] = "tag:yaml.org,2002:";
    static const char *const kinds[] = {"str", "int", "float", "bool", "null", "map", "seq"};
    if (zt_text_equal(tag, "!")) return;
    if (strncmp(tag, own, sizeof own - 1) == 0)
        for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
            if (zt_text_equal(tag + sizeof own - 1, kinds[i])) {
                if (i == 0) node->quoted = true;
                return;
            }
    zt_mistake(n->mistakes, &node->place, "the tag \"%s\" means nothing here",
               zt_show(tag).text);
}

/* A new node with its tag applied; its anchor, or -1. */
static zt_status make(zt_node **out, int *anchor_index, zt_nodes *n, const zt_place *place,
                      zt_node_marks marks, zt_node_kind kind) {
    zt_node *node = *out = push(n, sizeof *node);
    *anchor_index = -1;
    if (!node) return ZT_EMEMORY;
    *node = (zt_node){.place = *place, .kind = kind};
    if (++n->node_count > NODE_COUNT_MAX)
        return too_much(n, place, "too many values", NODE_COUNT_MAX);
    if (marks.tag) apply_tag(n, node, marks.tag);
    if (!marks.anchor) return ZT_OK;
    if (n->anchor_count == ANCHOR_COUNT_MAX)
        return too_much(n, place, "too many anchors", ANCHOR_COUNT_MAX);
    const char *name = push_text(n, marks.anchor, strlen(marks.anchor));
    if (!name) return ZT_EMEMORY;
    *anchor_index = n->anchor_count++;
    n->anchors[*anchor_index] =
        (anchor){.name = name, .node = node, .open = true, .extent = {1, 0}};
    return ZT_OK;
}

/* The key whose value comes next, or NULL. */
static const zt_node *waiting_key(const zt_nodes *n) {
    if (n->depth == 0) return NULL;
    const frame *around = &n->frames[n->depth - 1];
    bool value_next = (n->waiting_count - around->first_item) % 2 == 1;
    return around->node->kind == ZT_NODE_MAPPING && value_next
               ? n->waiting[n->waiting_count - 1]
               : NULL;
}

zt_status zt_nodes_text(zt_nodes *n, const zt_place *place, zt_node_marks marks,
                        const char *text, size_t length, bool quoted) {
    zt_node *node;
    int anchor_index;
    ZT_TRY(make(&node, &anchor_index, n, place, marks, ZT_NODE_TEXT));
    if (anchor_index >= 0) n->anchors[anchor_index].open = false;
    const zt_node *key = length == 0 && !quoted ? waiting_key(n) : NULL;
    if (key) node->place = key->place; /* where nothing is written, nothing can be shown */
    if (quoted) node->quoted = true;
    node->text = push_text(n, text, length);
    if (!node->text) return ZT_EMEMORY;
    if (memchr(text, 0, length)) {
        zt_mistake(n->mistakes, place, "a text cannot hold the character \"\\0\"");
        node->kind = ZT_NODE_MISTAKE;
    }
    return hand_over(n, node, (extent){1, 0});
}

/* The anchor of a name that was set last, or NULL. */
static const anchor *find_anchor(const zt_nodes *n, const char *name) {
    for (int i = n->anchor_count - 1; i >= 0; i--)
        if (zt_text_equal(n->anchors[i].name, name)) return &n->anchors[i];
    return NULL;
}

/* Tells of an alias that leads nowhere and puts a mistake in its place. */
static zt_status bad_alias(zt_nodes *n, const zt_place *place, const char *name, bool open) {
    zt_nearest nearest = zt_nearest_to(name);
    for (int i = 0; i < n->anchor_count && !zt_mistakes_full(n->mistakes); i++)
        zt_nearest_try(&nearest, n->anchors[i].name);
    if (open)
        zt_mistake(n->mistakes, place, "\"%s\" is used within itself", zt_show(name).text);
    else
        zt_mistake(n->mistakes, place, "no anchor is named \"%s\"%s", zt_show(name).text,
                   zt_suggest(&nearest).text);
    zt_node *node;
    int anchor_index;
    ZT_TRY(make(&node, &anchor_index, n, place, (zt_node_marks){0}, ZT_NODE_MISTAKE));
    return hand_over(n, node, (extent){1, 0});
}

zt_status zt_nodes_alias(zt_nodes *n, const zt_place *place, const char *name) {
    const anchor *found = find_anchor(n, name);
    if (!found || found->open) return bad_alias(n, place, name, found != NULL);
    n->expanded_count += found->extent.size;
    if (n->expanded_count > EXPANDED_COUNT_MAX)
        return too_much(n, place, "the aliases up to here stand for too many values",
                        EXPANDED_COUNT_MAX);
    if (n->depth + found->extent.depth > DEPTH_MAX)
        return too_much(n, place, "lists and mappings are nested too deep", DEPTH_MAX);
    return hand_over(n, found->node, found->extent);
}

zt_status zt_nodes_begin(zt_nodes *n, const zt_place *place, zt_node_marks marks,
                         zt_node_kind kind) {
    frame f = {.first_item = n->waiting_count, .extent = {1, 1}};
    ZT_TRY(make(&f.node, &f.anchor, n, place, marks, kind));
    if (n->depth == DEPTH_MAX)
        return too_much(n, place, "lists and mappings are nested too deep", DEPTH_MAX);
    n->frames[n->depth++] = f;
    return ZT_OK;
}

static zt_status add_entry(zt_nodes *n, const zt_node *key, const zt_node *value, bool merged) {
    if (!reserve((void **)&n->entries, &n->entry_capacity, n->entry_count, sizeof *n->entries))
        return ZT_EMEMORY;
    n->entries[n->entry_count] = (entry){key, value, n->entry_count, merged};
    n->entry_count++;
    return ZT_OK;
}

/* The entries of a mapping, or of a list of mappings, that "<<" brings in. */
static zt_status add_merged(zt_nodes *n, const zt_node *value) {
    bool list = value->kind == ZT_NODE_LIST;
    for (int32_t i = 0; i < (list ? value->count : 1); i++) {
        const zt_node *source = list ? value->items[i] : value;
        if (source->kind != ZT_NODE_MAPPING && source->kind != ZT_NODE_MISTAKE)
            zt_mistake(n->mistakes, &source->place,
                       "\"<<\" takes in a mapping or a list of mappings, and this is none");
        if (source->kind != ZT_NODE_MAPPING) continue;
        for (int32_t e = 0; e < source->count; e++)
            ZT_TRY(add_entry(n, zt_node_key(source, e), zt_node_value(source, e), true));
    }
    return ZT_OK;
}

static bool is_merge(const zt_node *key) {
    return key->kind == ZT_NODE_TEXT && !key->quoted && zt_text_equal(key->text, "<<");
}

static zt_status gather_entries(zt_nodes *n, const zt_node *const *items, size_t count) {
    n->entry_count = 0;
    for (size_t i = 0; i < count; i += 2) {
        if (items[i]->kind == ZT_NODE_LIST || items[i]->kind == ZT_NODE_MAPPING)
            zt_mistake(n->mistakes, &items[i]->place, "a key must be a text");
        else if (items[i]->kind == ZT_NODE_TEXT && !is_merge(items[i]))
            ZT_TRY(add_entry(n, items[i], items[i + 1], false));
    }
    for (size_t i = 0; i < count; i += 2)
        if (is_merge(items[i])) ZT_TRY(add_merged(n, items[i + 1]));
    return ZT_OK;
}

static int by_rank(const void *pa, const void *pb) {
    const entry *a = pa, *b = pb;
    return (a->rank > b->rank) - (a->rank < b->rank);
}

static int by_key(const void *pa, const void *pb) {
    int order = strcmp(((const entry *)pa)->key->text, ((const entry *)pb)->key->text);
    return order ? order : by_rank(pa, pb);
}

/* Of entries with the same key the first stays: a mapping's own before a merged one. A second
 * one of its own is a mistake. */
static void unify_entries(zt_nodes *n) {
    entry *entries = n->entries;
    size_t kept = 0;
    qsort(entries, n->entry_count, sizeof *entries, by_key);
    for (size_t i = 0; i < n->entry_count; i++) {
        const entry *last = kept ? &entries[kept - 1] : NULL;
        if (!last || !zt_text_equal(last->key->text, entries[i].key->text)) {
            entries[kept++] = entries[i];
        } else if (!entries[i].merged) {
            zt_mistake(n->mistakes, &entries[i].key->place, "\"%s\" is given twice",
                       zt_show(last->key->text).text);
            zt_mistake_note(n->mistakes, &last->key->place, "it is given here first");
        }
    }
    n->entry_count = kept;
    qsort(entries, kept, sizeof *entries, by_rank);
}

/* Turns the waiting items into what the node keeps. */
static zt_status fill(zt_nodes *n, zt_node *node, const zt_node *const *items, size_t count) {
    bool mapping = node->kind == ZT_NODE_MAPPING;
    if (mapping) {
        ZT_TRY(gather_entries(n, items, count));
        if (n->entry_count > 1) unify_entries(n);
        count = 2 * n->entry_count;
    }
    const zt_node **own = push(n, count * sizeof *own);
    if (!own) return ZT_EMEMORY;
    for (size_t i = 0; i < count; i++)
        own[i] = !mapping ? items[i] : i % 2 ? n->entries[i / 2].value : n->entries[i / 2].key;
    node->count = (int32_t)(mapping ? n->entry_count : count);
    node->items = own;
    return ZT_OK;
}

zt_status zt_nodes_end(zt_nodes *n, int end_line, int end_column) {
    const frame *f = &n->frames[--n->depth];
    zt_place *place = &f->node->place;
    if (end_line == place->line) place->length = end_column - place->column;
    ZT_TRY(fill(n, f->node, n->waiting + f->first_item, n->waiting_count - f->first_item));
    n->waiting_count = f->first_item;
    if (f->anchor >= 0) {
        n->anchors[f->anchor].open = false;
        n->anchors[f->anchor].extent = f->extent;
    }
    return hand_over(n, f->node, f->extent);
}
