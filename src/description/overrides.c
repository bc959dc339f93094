#include "description/overrides.h"

#include <string.h>

#include "description/document.h"
#include "description/reading.h"

typedef struct zt_overridden {
    const char *thing, *key;
    const zt_node *key_node;
    bool met; /* something was overridden, or it is useless */
    bool thing_met;
    zt_nearest near_thing, near_key;
    zt_place place; /* of thing and key */
} overridden;

/* "lamp.intensity=40" as a text with places. */
static zt_status make_source(zt_source *source, zt_arena *arena, const zt_override *given) {
    size_t first = strlen(given->name) + 1, length = strlen(given->value);
    char *text = ZT_PUSH(arena, char, first + length + 1);
    *source =
        (zt_source){.file = "--set", .text = text, .size = first + length, .first = first};
    if (!text) return ZT_EMEMORY;
    memcpy(text, given->name, first - 1);
    text[first - 1] = '=';
    memcpy(text + first, given->value, length);
    return ZT_OK;
}

/* The value as YAML; a text where it begins with "#", which would be a comment. */
static zt_status read_override_value(const zt_node **value, const overridden *o,
                                     zt_reading *reading, const zt_source *source) {
    zt_mistakes *mistakes = &reading->mistakes;
    const char *written = source->text + source->first;
    const zt_node *root = NULL;
    if (*written == '#') {
        zt_node *node = ZT_PUSH(reading->temporary, zt_node, 1);
        if (!node) return ZT_EMEMORY;
        *node = (zt_node){.place = o->place, .quoted = true, .text = written};
        node->place.column += node->place.length + 1;
        node->place.length = (int)strlen(written);
        *value = node;
        return ZT_OK;
    }
    zt_status status = zt_document_read(&root, reading->temporary, source, mistakes);
    if (status != ZT_OK) return status == ZT_EDESCRIPTION ? ZT_OK : status;
    if (!root) zt_mistake(mistakes, &o->place, "there is no value behind the \"=\"");
    *value = root;
    return ZT_OK;
}

/* "lamp.intensity", or "$big" for "variables.big". */
static zt_status read_override(overridden *o, const zt_node **value, zt_reading *reading,
                               const zt_override *given) {
    zt_source source;
    ZT_TRY(make_source(&source, &reading->animation->arena, given));
    const char *dot = strrchr(given->name, '.');
    bool variable = *given->name == '$';
    int length = 0;
    for (const char *c = given->name; *c; c++) length += ((unsigned char)*c & 0xC0) != 0x80;
    o->place = (zt_place){source.file, source.text, 1, 1, length};
    if (!variable && (!dot || dot == given->name || !dot[1])) {
        zt_mistake(&reading->mistakes, &o->place,
                   "\"%s\" names no property; one is written as lamp.intensity, a variable as "
                   "$name",
                   zt_show(given->name).text);
        o->met = true;
        return ZT_OK;
    }
    zt_node *key = ZT_PUSH(reading->temporary, zt_node, 1);
    o->thing = variable ? "variables"
                        : zt_arena_push_text(reading->temporary, given->name,
                                             (size_t)(dot - given->name));
    o->key = variable ? given->name + 1 : dot + 1;
    if (!key || !o->thing) return ZT_EMEMORY;
    *key = (zt_node){.place = o->place, .text = o->key};
    o->key_node = key;
    o->near_thing = zt_nearest_to(o->thing);
    o->near_key = zt_nearest_to(o->key);
    return read_override_value(value, o, reading, &source);
}

zt_status zt_overrides_open(zt_reading *reading, const zt_override *given, int count) {
    overridden *all = ZT_PUSH(reading->temporary, overridden, (size_t)count);
    const zt_node **values = ZT_PUSH(reading->temporary, const zt_node *, (size_t)count);
    if (!all || !values) return ZT_EMEMORY;
    reading->overrides = (zt_overrides){count, all, values};
    for (int i = 0; i < count; i++)
        ZT_TRY(read_override(&all[i], &values[i], reading, &given[i]));
    return ZT_OK;
}

/* A copy of a mapping in which a key has another value. */
static zt_status replace(const zt_node **mapping, zt_reading *reading, const overridden *o,
                         const zt_node *value) {
    const zt_node *from = *mapping;
    zt_node *to = ZT_PUSH(reading->temporary, zt_node, 1);
    size_t item_count = 2 * ((size_t)from->count + 1);
    const zt_node **items = ZT_PUSH(reading->temporary, const zt_node *, item_count);
    if (!to || !items) return ZT_EMEMORY;
    if (from->count) memcpy(items, from->items, (item_count - 2) * sizeof *items);
    int32_t entry = 0;
    while (entry < from->count && !zt_text_equal(zt_node_key(from, entry)->text, o->key))
        entry++;
    items[2 * (size_t)entry] = o->key_node;
    items[2 * (size_t)entry + 1] = value;
    *to = *from;
    to->count = entry < from->count ? from->count : from->count + 1;
    to->items = items;
    *mapping = to;
    return ZT_OK;
}

zt_status zt_override_in(const zt_node **mapping, zt_reading *reading, const char *thing,
                         const char *const *names, int name_count) {
    for (int i = 0; i < reading->overrides.count; i++) {
        overridden *o = &reading->overrides.all[i];
        if (!o->thing) continue;
        zt_nearest_try(&o->near_thing, thing);
        if (!zt_text_equal(o->thing, thing)) continue;
        o->thing_met = true;
        for (int n = 0; n < name_count; n++) {
            zt_nearest_try(&o->near_key, names[n]);
            if (!zt_text_equal(o->key, names[n])) continue;
            o->met = true;
            const zt_node *value = reading->overrides.values[i];
            if (value && (*mapping)->kind == ZT_NODE_MAPPING)
                ZT_TRY(replace(mapping, reading, o, value));
        }
    }
    return ZT_OK;
}

void zt_overrides_close(zt_reading *reading) {
    for (int i = 0; i < reading->overrides.count; i++) {
        const overridden *o = &reading->overrides.all[i];
        if (o->met) continue;
        if (o->thing_met)
            zt_mistake(&reading->mistakes, &o->place, "\"%s\" has no \"%s\"%s",
                       zt_show(o->thing).text, zt_show(o->key).text,
                       zt_suggest(&o->near_key).text);
        else
            zt_mistake(&reading->mistakes, &o->place, "nothing is named \"%s\"%s",
                       zt_show(o->thing).text, zt_suggest(&o->near_thing).text);
    }
}
