#include "description/objects.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "description/materials.h"
#include "description/models.h"
#include "description/motion.h"

typedef struct things {
    zt_reading *reading;
    zt_materials materials;
    zt_models models;
    const zt_node **names; /* of lights and objects, as they come */
    int64_t name_count;
    int counts[ZT_OWNER_COUNT]; /* how many there were of each */
} things;

/* One item of a list: its kind, the word that says it, and its properties. */
typedef struct item {
    zt_owner owner;
    const zt_node *word;
    zt_fields fields;
    const char *names[ZT_FIELD_NAMES_MAX];
    const char *name; /* how its tracks are called */
} item;

/* ---- items ----------------------------------------------------------------------------------
 */

static void tell_unknown_kind(zt_mistakes *mistakes, const zt_node *word, const char *what,
                              zt_owner first, zt_owner last) {
    zt_nearest nearest = zt_nearest_to(word->text);
    char kinds[128] = "";
    for (zt_owner owner = first; owner <= last; owner++) {
        const char *kind = zt_owner_name(owner);
        zt_nearest_try(&nearest, kind);
        size_t used = strlen(kinds);
        snprintf(kinds + used, sizeof kinds - used, "%s%s", used ? ", " : "", kind);
    }
    if (nearest.best)
        zt_mistake(mistakes, &word->place, "unknown %s \"%s\"%s", what,
                   zt_show(word->text).text, zt_suggest(&nearest).text);
    else
        zt_mistake(mistakes, &word->place, "unknown %s \"%s\"; there are: %s", what,
                   zt_show(word->text).text, kinds);
}

/* The kind of an item that is a mapping with one entry, "sphere: {...}". */
static bool read_kind(zt_owner *owner, zt_mistakes *mistakes, const zt_node *node,
                      const char *what, zt_owner first, zt_owner last) {
    if (node->kind == ZT_NODE_MISTAKE) return false;
    if (node->kind != ZT_NODE_MAPPING || node->count == 0) {
        zt_mistake(mistakes, &node->place, "each %s is its kind and a mapping: \"%s: {...}\"",
                   what, zt_owner_name(first));
        return false;
    }
    const zt_node *word = zt_node_key(node, 0);
    if (node->count > 1) {
        zt_mistake(mistakes, &zt_node_key(node, 1)->place,
                   "\"%s\" cannot stand beside \"%s\"; is it indented enough?",
                   zt_show(zt_node_key(node, 1)->text).text, zt_show(word->text).text);
        return false;
    }
    for (*owner = first; *owner <= last; (*owner)++)
        if (zt_text_equal(zt_owner_name(*owner), word->text)) return true;
    tell_unknown_kind(mistakes, word, what, first, last);
    return false;
}

/* What its tracks are called: by its name, or by its kind and its number among that. */
static zt_status read_name(item *it, things *t, const zt_node *mapping) {
    char numbered[32];
    snprintf(numbered, sizeof numbered, "%s %d", zt_owner_name(it->owner),
             t->counts[it->owner]);
    const zt_node *node = mapping->kind == ZT_NODE_MAPPING
                              ? zt_field(&(zt_fields){.mapping = mapping}, "name")
                              : NULL;
    it->name = node ? zt_read_text(&t->reading->mistakes, node, "name") : NULL;
    if (it->name)
        t->names[t->name_count++] = node;
    else
        it->name = zt_arena_push_text(t->reading->temporary, numbered, strlen(numbered));
    return it->name ? ZT_OK : ZT_EMEMORY;
}

/* Opens an item of a list; `good` is false when it cannot be read. The further names that it
 * may have besides its properties and "name" end with a NULL. */
static zt_status open_item(item *it, bool *good, things *t, const zt_node *node,
                           const char *const *further) {
    const zt_node *mapping = zt_node_value(node, 0);
    it->word = zt_node_key(node, 0);
    int name_count = zt_motion_names(it->names, it->owner);
    while (*further) it->names[name_count++] = *further++;
    t->counts[it->owner]++;
    ZT_TRY(read_name(it, t, mapping));
    ZT_TRY(zt_override_in(&mapping, t->reading, it->name, it->names, name_count));
    it->names[name_count++] = "name"; /* which cannot be overridden: it is what is named */
    *good = zt_fields_open(&it->fields, &t->reading->mistakes, mapping, it->word->text,
                           it->names, name_count);
    return ZT_OK;
}

/* The items of a list, or none where there is no list. */
static int32_t item_count(zt_mistakes *mistakes, const zt_node *node, const char *what) {
    if (!node || zt_node_empty(node)) return 0;
    if (node->kind == ZT_NODE_LIST) return node->count;
    zt_expected(mistakes, node, what, "a list");
    return 0;
}

/* ---- lights ---------------------------------------------------------------------------------
 */

static zt_status read_light(things *t, const zt_node *node) {
    static const char *const further[] = {NULL};
    zt_mistakes *mistakes = &t->reading->mistakes;
    item it;
    bool good;
    if (!read_kind(&it.owner, mistakes, node, "light", ZT_OWNER_AMBIENT,
                   ZT_OWNER_RECTANGLE_LIGHT))
        return ZT_OK;
    ZT_TRY(open_item(&it, &good, t, node, further));
    if (!good) return ZT_OK;
    int32_t index = t->reading->animation->rest.light_count++;
    return zt_motion_read(t->reading, &it.fields, it.owner, index, it.name, &it.word->place);
}

/* ---- objects --------------------------------------------------------------------------------
 */

static zt_status read_objects(things *t, const zt_node *list, int32_t parent);

static zt_status read_object(things *t, const zt_node *node, int32_t parent) {
    static const char *const shape_keys[] = {"material", NULL};
    static const char *const mesh_keys[] = {"file", "material", NULL};
    static const char *const group_keys[] = {"objects", NULL};
    zt_mistakes *mistakes = &t->reading->mistakes;
    item it;
    bool good;
    if (!read_kind(&it.owner, mistakes, node, "object", ZT_OWNER_PLANE, ZT_OWNER_GROUP))
        return ZT_OK;
    bool mesh = it.owner == ZT_OWNER_MESH, group = it.owner == ZT_OWNER_GROUP;
    ZT_TRY(open_item(&it, &good, t, node, mesh ? mesh_keys : group ? group_keys : shape_keys));
    if (!good) return ZT_OK;
    const zt_place *place = &it.word->place;
    zt_scene *rest = &t->reading->animation->rest;
    int32_t index = rest->object_count++;
    zt_object *object = &rest->objects[index];
    ZT_TRY(zt_motion_read(t->reading, &it.fields, it.owner, index, it.name, place));
    object->parent = parent;
    if (group) {
        const zt_node *members = zt_field_required(&it.fields, mistakes, "objects", place);
        return members ? read_objects(t, members, index) : ZT_OK;
    }
    if (mesh) {
        const zt_node *file = zt_field_required(&it.fields, mistakes, "file", place);
        if (file) ZT_TRY(zt_models_note(&t->models, index, &it.fields, file));
    }
    return zt_materials_find(&object->material, &t->materials,
                             zt_field(&it.fields, "material"));
}

static zt_status read_objects(things *t, const zt_node *list, int32_t parent) {
    int32_t count = item_count(&t->reading->mistakes, list, "objects");
    for (int32_t i = 0; i < count; i++) ZT_TRY(read_object(t, list->items[i], parent));
    return ZT_OK;
}

/* No fewer than there are objects in the list, members of groups included. */
static int64_t count_objects(const zt_node *list) {
    if (!list || list->kind != ZT_NODE_LIST) return 0;
    int64_t count = list->count;
    for (int32_t i = 0; i < list->count; i++) {
        const zt_node *node = list->items[i];
        if (node->kind != ZT_NODE_MAPPING || node->count != 1) continue;
        zt_fields fields = {.mapping = zt_node_value(node, 0)};
        if (fields.mapping->kind == ZT_NODE_MAPPING)
            count += count_objects(zt_field(&fields, "objects"));
    }
    return count;
}

/* ---- all of it ------------------------------------------------------------------------------
 */

static int by_name(const void *pa, const void *pb) {
    const zt_node *a = *(const zt_node *const *)pa, *b = *(const zt_node *const *)pb;
    int order = strcmp(a->text, b->text);
    if (order) return order;
    if (a->place.line != b->place.line) return a->place.line - b->place.line;
    return a->place.column - b->place.column;
}

static void check_names(things *t) {
    zt_mistakes *mistakes = &t->reading->mistakes;
    qsort(t->names, (size_t)t->name_count, sizeof *t->names, by_name);
    for (int64_t i = 1; i < t->name_count; i++) {
        const zt_node *before = t->names[i - 1], *name = t->names[i];
        if (!zt_text_equal(before->text, name->text)) continue;
        zt_mistake(mistakes, &name->place, "the name \"%s\" is given twice",
                   zt_show(name->text).text);
        zt_mistake_note(mistakes, &before->place, "it is given here first");
    }
}

zt_status zt_objects_read(zt_reading *reading, const char *directory, const zt_node *materials,
                          const zt_node *lights, const zt_node *objects) {
    things t = {.reading = reading, .models = {.reading = reading, .directory = directory}};
    zt_scene *rest = &reading->animation->rest;
    int32_t light_count = item_count(&reading->mistakes, lights, "lights");
    int64_t object_count = count_objects(objects);
    rest->lights = ZT_PUSH(&reading->animation->arena, zt_light, (size_t)light_count);
    rest->objects = ZT_PUSH(&reading->animation->arena, zt_object, (size_t)object_count);
    t.names =
        ZT_PUSH(reading->temporary, const zt_node *, (size_t)(light_count + object_count));
    if (!rest->lights || !rest->objects || !t.names) return ZT_EMEMORY;
    ZT_TRY(zt_materials_open(&t.materials, reading, materials, object_count));
    for (int32_t i = 0; i < light_count; i++) ZT_TRY(read_light(&t, lights->items[i]));
    ZT_TRY(read_objects(&t, objects, -1));
    check_names(&t);
    return zt_models_read(&t.models);
}
