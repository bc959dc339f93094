#include "sequence/pairs.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* ---- pairing -------------------------------------------------------------------------------
 */

static int by_kind_and_name(const void *pa, const void *pb) {
    const zt_thing *a = *(const zt_thing *const *)pa, *b = *(const zt_thing *const *)pb;
    if (a->owner != b->owner) return a->owner < b->owner ? -1 : 1;
    return strcmp(a->name, b->name);
}

static int by_kind_and_index(const void *pa, const void *pb) {
    const zt_thing *a = *(const zt_thing *const *)pa, *b = *(const zt_thing *const *)pb;
    if (a->owner != b->owner) return a->owner < b->owner ? -1 : 1;
    return (a->index > b->index) - (a->index < b->index);
}

typedef int comparison(const void *a, const void *b);

/* Things that are no pair yet. */
typedef struct lonely {
    const zt_thing **things;
    int32_t count;
} lonely;

static zt_status list_things(lonely *l, const zt_animation *animation, zt_arena *arena) {
    l->things = ZT_PUSH(arena, const zt_thing *, (size_t)animation->thing_count);
    l->count = animation->thing_count;
    for (int32_t i = 0; l->things && i < l->count; i++) l->things[i] = &animation->things[i];
    return l->things ? ZT_OK : ZT_EMEMORY;
}

static void push(zt_pairs *p, const zt_thing *older, const zt_thing *newer) {
    p->all[p->count++] = (zt_pair){.older = older, .newer = newer};
}

/* Makes pairs of those that compare equal, and leaves the others. */
static void pair_equal(zt_pairs *p, lonely *older, lonely *newer, comparison *compare) {
    int32_t o = 0, n = 0, older_left = 0, newer_left = 0;
    qsort(older->things, (size_t)older->count, sizeof *older->things, compare);
    qsort(newer->things, (size_t)newer->count, sizeof *newer->things, compare);
    while (o < older->count || n < newer->count) {
        int order = o == older->count   ? 1
                    : n == newer->count ? -1
                                        : compare(&older->things[o], &newer->things[n]);
        if (order == 0)
            push(p, older->things[o++], newer->things[n++]);
        else if (order < 0)
            older->things[older_left++] = older->things[o++];
        else
            newer->things[newer_left++] = newer->things[n++];
    }
    older->count = older_left;
    newer->count = newer_left;
}

static bool same_bytes(const void *a, const void *b, size_t size) {
    return (!a && !b) || (a && b && memcmp(a, b, size) == 0);
}

static bool same_model(const zt_mesh *a, const zt_mesh *b) {
    size_t points = (size_t)a->vertex_count * 3, corners = (size_t)a->triangle_count * 3;
    return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
           a->origin.x == b->origin.x && a->origin.y == b->origin.y &&
           a->origin.z == b->origin.z &&
           same_bytes(a->positions, b->positions, points * sizeof *a->positions) &&
           same_bytes(a->triangles, b->triangles, corners * sizeof *a->triangles) &&
           same_bytes(a->normals, b->normals, points * sizeof *a->normals) &&
           same_bytes(a->colors, b->colors, points * sizeof *a->colors);
}

static bool is_object(zt_owner owner) { return owner >= ZT_OWNER_PLANE; }

/* The pair of each material, or of each object; -1 of those that are no things. */
static const int32_t *index_pairs(const zt_pairs *p, bool newer, bool objects, int32_t count,
                                  zt_arena *arena) {
    int32_t *pairs = ZT_PUSH(arena, int32_t, (size_t)count);
    for (int32_t i = 0; pairs && i < count; i++) pairs[i] = -1;
    for (int32_t i = 0; pairs && i < p->count; i++) {
        const zt_thing *thing = newer ? p->all[i].newer : p->all[i].older;
        if (thing && (objects ? is_object(thing->owner) : thing->owner == ZT_OWNER_MATERIAL))
            pairs[thing->index] = i;
    }
    return pairs;
}

static zt_status index_all(zt_pairs *p, zt_arena *arena) {
    const zt_scene *older = &p->older->rest, *newer = &p->newer->rest;
    p->older_materials = index_pairs(p, false, false, older->material_count, arena);
    p->newer_materials = index_pairs(p, true, false, newer->material_count, arena);
    p->older_objects = index_pairs(p, false, true, older->object_count, arena);
    p->newer_objects = index_pairs(p, true, true, newer->object_count, arena);
    bool good =
        p->older_materials && p->newer_materials && p->older_objects && p->newer_objects;
    return good ? ZT_OK : ZT_EMEMORY;
}

static void compare_models(zt_pairs *p) {
    const zt_scene *older = &p->older->rest, *newer = &p->newer->rest;
    for (zt_pair *pair = p->all; pair < p->all + p->count; pair++)
        if (pair->older && pair->newer && pair->older->owner == ZT_OWNER_MESH)
            pair->other_model =
                !same_model(&older->meshes[older->objects[pair->older->index].mesh],
                            &newer->meshes[newer->objects[pair->newer->index].mesh]);
}

zt_status zt_pairs_make(zt_pairs *p, const zt_animation *older, const zt_animation *newer,
                        zt_arena *arena) {
    lonely left, right;
    *p = (zt_pairs){.older = older, .newer = newer};
    p->all = ZT_PUSH(arena, zt_pair, (size_t)older->thing_count + (size_t)newer->thing_count);
    if (!p->all) return ZT_EMEMORY;
    ZT_TRY(list_things(&left, older, arena));
    ZT_TRY(list_things(&right, newer, arena));
    pair_equal(p, &left, &right, by_kind_and_name);
    pair_equal(p, &left, &right, by_kind_and_index);
    for (int32_t i = 0; i < left.count; i++) push(p, left.things[i], NULL);
    for (int32_t i = 0; i < right.count; i++) push(p, NULL, right.things[i]);
    compare_models(p);
    return index_all(p, arena);
}

/* ---- comparing -----------------------------------------------------------------------------
 */

static uint32_t bit(int way) { return UINT32_C(1) << way; }

/* The way that a property of the table is. */
static int way_of(zt_owner owner, const char *name) {
    int way = 0;
    for (int i = 0; i < zt_property_count; i++) {
        if (zt_properties[i].owner != owner) continue;
        if (zt_text_equal(zt_properties[i].name, name)) return way;
        way++;
    }
    assert(!"no such property");
    return 0;
}

static uint32_t compare_properties(const zt_pair *pair, const zt_scene *older,
                                   const zt_scene *newer) {
    uint32_t ways = 0;
    int way = 0;
    for (int i = 0; i < zt_property_count; i++) {
        const zt_property *property = &zt_properties[i];
        double was[ZT_VALUE_WIDTH_MAX], is[ZT_VALUE_WIDTH_MAX];
        if (property->owner != pair->older->owner) continue;
        zt_property_get(was, property, older, pair->older->index);
        zt_property_get(is, property, newer, pair->newer->index);
        for (int c = 0; c < zt_value_width(property->kind); c++)
            if (was[c] != is[c]) ways |= bit(way);
        way++;
    }
    assert(way <= ZT_WAY_MATERIAL);
    return ways;
}

static uint32_t compare_cameras(const zt_camera *was, const zt_camera *is) {
    uint32_t ways = 0;
    if (was->lens != is->lens) ways |= bit(ZT_WAY_LENS);
    if (was->blades != is->blades) ways |= bit(ZT_WAY_BLADES);
    if (was->aimed != is->aimed) ways |= bit(way_of(ZT_OWNER_CAMERA, "look_at"));
    if (was->focused != is->focused) ways |= bit(way_of(ZT_OWNER_CAMERA, "focus_on"));
    return ways;
}

static int32_t pair_of(const int32_t *pairs, int32_t index) {
    return index < 0 ? -1 : pairs[index];
}

static uint32_t compare_objects(const zt_pairs *p, const zt_pair *pair, const zt_scene *older,
                                const zt_scene *newer) {
    const zt_object *was = &older->objects[pair->older->index],
                    *is = &newer->objects[pair->newer->index];
    uint32_t ways = 0;
    if (pair_of(p->older_materials, was->material) != pair_of(p->newer_materials, is->material))
        ways |= bit(ZT_WAY_MATERIAL);
    if (pair_of(p->older_objects, was->parent) != pair_of(p->newer_objects, is->parent))
        ways |= bit(ZT_WAY_GROUP);
    if (pair->other_model) ways |= bit(ZT_WAY_FILE);
    return ways;
}

static uint32_t compare_pair(const zt_pairs *p, const zt_pair *pair, const zt_scene *older,
                             const zt_scene *newer) {
    if (!pair->older || !pair->newer) return bit(ZT_WAY_ALONE);
    zt_owner owner = pair->older->owner;
    int32_t was = pair->older->index, is = pair->newer->index;
    uint32_t ways = compare_properties(pair, older, newer);
    if (owner == ZT_OWNER_CAMERA) ways |= compare_cameras(&older->camera, &newer->camera);
    if (owner == ZT_OWNER_MATERIAL &&
        older->materials[was].pattern != newer->materials[is].pattern)
        ways |= bit(ZT_WAY_PATTERN);
    if (is_object(owner)) ways |= compare_objects(p, pair, older, newer);
    if (was != is) ways |= bit(ZT_WAY_ORDER);
    return ways;
}

void zt_pairs_compare(uint32_t *ways, const zt_pairs *p, const zt_scene *older,
                      const zt_scene *newer) {
    for (int32_t i = 0; i < p->count; i++) ways[i] |= compare_pair(p, &p->all[i], older, newer);
}

static const char *word_of(const zt_thing *thing, int way) {
    static const char *const words[ZT_WAY_COUNT - ZT_WAY_MATERIAL] = {
        "material", "group", "file", "pattern", "lens", "blades", "", "order"};
    if (way >= ZT_WAY_MATERIAL) return words[way - ZT_WAY_MATERIAL];
    for (int i = 0; i < zt_property_count; i++)
        if (zt_properties[i].owner == thing->owner && way-- == 0) return zt_properties[i].name;
    return "";
}

const char *zt_pairs_name(const zt_pairs *p, int32_t index, int way, zt_arena *arena) {
    const zt_pair *pair = &p->all[index];
    const zt_thing *thing = pair->newer ? pair->newer : pair->older;
    char *text = way == ZT_WAY_ALONE
                     ? zt_text_print("%s (%s)", thing->name, pair->newer ? "new" : "gone")
                     : zt_text_print("%s.%s", thing->name, word_of(thing, way));
    const char *own = text ? zt_arena_push_text(arena, text, strlen(text)) : NULL;
    free(text);
    return own;
}
