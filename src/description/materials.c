#include "description/materials.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "description/motion.h"

enum { NEAREST_TRIED_MAX = 1000 };

/* A pattern, and what is said of one that is not there. */
static void read_pattern(zt_reading *reading, const zt_fields *fields, zt_material *material) {
    static const char *const patterns[] = {[ZT_PATTERN_NONE] = "none",
                                           [ZT_PATTERN_CHECKER] = "checker",
                                           [ZT_PATTERN_STRIPES] = "stripes"};
    static const char *const keys[] = {"other_color", "pattern_size", "pattern_direction"};
    enum { DIRECTION = 2 }; /* the last of them is for stripes, the others are for both */
    zt_mistakes *mistakes = &reading->mistakes;
    const zt_node *node = zt_field(fields, "pattern");
    int pattern = ZT_PATTERN_NONE;
    if (node && !zt_read_choice(&pattern, mistakes, node, "pattern", patterns, 3)) return;
    material->pattern = (zt_pattern)pattern;
    if (pattern == ZT_PATTERN_STRIPES) return;
    for (int i = pattern == ZT_PATTERN_NONE ? 0 : DIRECTION; i <= DIRECTION; i++) {
        const zt_node *idle = zt_field(fields, keys[i]);
        if (idle)
            zt_doubt(mistakes, &idle->place, "\"%s\" does nothing without \"pattern: %s\"",
                     keys[i], i == DIRECTION ? "stripes" : "checker");
    }
}

static zt_status read_material(int32_t *index, zt_reading *reading, const zt_node *node,
                               const char *name) {
    const char *names[ZT_FIELD_NAMES_MAX];
    int name_count = zt_motion_names(names, ZT_OWNER_MATERIAL);
    names[name_count++] = "pattern";
    zt_fields fields;
    *index = -1;
    ZT_TRY(zt_override_in(&node, reading, name, names, name_count));
    if (!zt_fields_open(&fields, &reading->mistakes, node, zt_show(name).text, names,
                        name_count))
        return ZT_OK;
    *index = reading->animation->rest.material_count++;
    ZT_TRY(zt_motion_read(reading, &fields, ZT_OWNER_MATERIAL, *index, name, &node->place));
    read_pattern(reading, &fields, &reading->animation->rest.materials[*index]);
    return ZT_OK;
}

static int by_name(const void *pa, const void *pb) {
    return strcmp(((const zt_material_name *)pa)->name, ((const zt_material_name *)pb)->name);
}

zt_status zt_materials_open(zt_materials *materials, zt_reading *reading, const zt_node *node,
                            int64_t object_count) {
    *materials = (zt_materials){.reading = reading, .white = -1};
    if (node && node->kind != ZT_NODE_MAPPING) {
        if (!zt_node_empty(node))
            zt_expected(&reading->mistakes, node, "materials",
                        "a mapping of names to materials");
        node = NULL;
    }
    int32_t count = node ? node->count : 0;
    zt_scene *rest = &reading->animation->rest;
    rest->materials = ZT_PUSH(&reading->animation->arena, zt_material,
                              (size_t)count + (size_t)object_count + 1);
    materials->names = ZT_PUSH(reading->temporary, zt_material_name, (size_t)count);
    if (!rest->materials || !materials->names) return ZT_EMEMORY;
    for (int32_t i = 0; i < count; i++) {
        zt_material_name *name = &materials->names[i];
        name->name = zt_node_key(node, i)->text;
        ZT_TRY(read_material(&name->index, reading, zt_node_value(node, i), name->name));
    }
    qsort(materials->names, (size_t)count, sizeof *materials->names, by_name);
    materials->name_count = count;
    return ZT_OK;
}

static void tell_unknown(const zt_materials *materials, const zt_node *node) {
    zt_mistakes *mistakes = &materials->reading->mistakes;
    zt_nearest nearest = zt_nearest_to(node->text);
    for (int32_t i = 0; i < materials->name_count && i < NEAREST_TRIED_MAX; i++) {
        if (zt_mistakes_full(mistakes)) break;
        zt_nearest_try(&nearest, materials->names[i].name);
    }
    zt_mistake(mistakes, &node->place, "no material is named \"%s\"%s",
               zt_show(node->text).text, zt_suggest(&nearest).text);
}

zt_status zt_materials_find(int32_t *index, zt_materials *materials, const zt_node *node) {
    zt_reading *reading = materials->reading;
    zt_scene *rest = &reading->animation->rest;
    *index = -1;
    if (!node) {
        if (materials->white < 0) {
            materials->white = rest->material_count++;
            zt_property_rest(rest, ZT_OWNER_MATERIAL, materials->white);
        }
        *index = materials->white;
        return ZT_OK;
    }
    if (node->kind == ZT_NODE_MAPPING) {
        char numbered[32];
        snprintf(numbered, sizeof numbered, "material %d", (int)rest->material_count + 1);
        const char *name = zt_arena_push_text(reading->temporary, numbered, strlen(numbered));
        if (!name) return ZT_EMEMORY;
        return read_material(index, reading, node, name);
    }
    if (node->kind != ZT_NODE_TEXT || zt_node_empty(node)) {
        zt_expected(&reading->mistakes, node, "material", "a material's name or a mapping");
        return ZT_OK;
    }
    zt_material_name wanted = {.name = node->text};
    const zt_material_name *found = bsearch(
        &wanted, materials->names, (size_t)materials->name_count, sizeof wanted, by_name);
    if (found)
        *index = found->index;
    else
        tell_unknown(materials, node);
    return ZT_OK;
}
