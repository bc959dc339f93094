#include "description/things.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "description/reading.h"

enum { NEAREST_TRIED_MAX = 1000 };

zt_status zt_things_add(zt_reading *reading, zt_owner owner, int32_t index, const char *name,
                        const zt_place *place) {
    zt_things *things = &reading->things;
    if (things->count == things->room) {
        int32_t room = things->room ? 2 * things->room : 64;
        zt_thing *all = ZT_PUSH(reading->temporary, zt_thing, (size_t)room);
        if (!all) return ZT_EMEMORY;
        if (things->count) memcpy(all, things->all, (size_t)things->count * sizeof *all);
        things->all = all;
        things->room = room;
    }
    things->all[things->count++] = (zt_thing){owner, index, name, *place};
    return ZT_OK;
}

/* A material and an object may have the same name; they stay in the order of their owners. */
static int by_name(const void *pa, const void *pb) {
    const zt_thing *a = pa, *b = pb;
    int order = strcmp(a->name, b->name);
    if (order) return order;
    if (a->owner != b->owner) return a->owner < b->owner ? -1 : 1;
    return (a->index > b->index) - (a->index < b->index);
}

zt_status zt_things_close(zt_reading *reading) {
    zt_things *things = &reading->things;
    zt_animation *animation = reading->animation;
    zt_thing *own = ZT_PUSH(&animation->arena, zt_thing, (size_t)things->count);
    if (!own) return ZT_EMEMORY;
    for (int32_t i = 0; i < things->count; i++) {
        const char *name = things->all[i].name;
        own[i] = things->all[i];
        own[i].name = zt_arena_push_text(&animation->arena, name, strlen(name));
        if (!own[i].name) return ZT_EMEMORY;
    }
    animation->things = own;
    animation->thing_count = things->count;
    if (things->count) qsort(things->all, (size_t)things->count, sizeof *own, by_name);
    return ZT_OK;
}

/* The first of the things with a name of so many bytes; *end is after the last. */
static const zt_thing *named(const zt_thing **end, const zt_things *things, const char *name,
                             size_t length) {
    const zt_thing *last = things->all + things->count;
    int32_t low = 0, high = things->count;
    while (low < high) {
        int32_t middle = low + (high - low) / 2;
        const char *other = things->all[middle].name;
        int order = strncmp(other, name, length);
        if (order < 0)
            low = middle + 1;
        else
            high = middle; /* longer names that begin so come after it */
    }
    const zt_thing *first = things->all + low;
    *end = first;
    while (*end < last && strncmp((*end)->name, name, length) == 0 && !(*end)->name[length])
        ++*end;
    return first;
}

bool zt_find_property(zt_reference *reference, const zt_things *things, const char *name) {
    const char *dot = strrchr(name, '.');
    const zt_thing *end = NULL, *thing = NULL;
    if (dot) thing = named(&end, things, name, (size_t)(dot - name));
    for (; thing < end; thing++) {
        const zt_property *property = zt_property_find(thing->owner, dot + 1);
        *reference = (zt_reference){property, thing->index};
        if (property) return true;
    }
    return false;
}

void zt_suggest_properties(zt_reading *reading, zt_nearest *nearest) {
    int tried = 0;
    for (int32_t i = 0; i < reading->things.count; i++)
        for (int p = 0; p < zt_property_count; p++) {
            const zt_thing *thing = &reading->things.all[i];
            const zt_property *property = &zt_properties[p];
            if (property->owner != thing->owner) continue;
            char name[64]; /* longer ones are near nothing */
            int length = snprintf(name, sizeof name, "%s.%s", thing->name, property->name);
            if (length >= (int)sizeof name) continue;
            if (tried++ == NEAREST_TRIED_MAX || zt_mistakes_full(&reading->mistakes)) return;
            const char *kept = zt_arena_push_text(reading->temporary, name, (size_t)length);
            if (kept) zt_nearest_try(nearest, kept);
        }
}

bool zt_read_property(zt_reference *reference, zt_reading *reading, const zt_node *node,
                      const char *what) {
    zt_mistakes *mistakes = &reading->mistakes;
    const char *name = zt_read_text(mistakes, node, what);
    if (!name) return false;
    if (zt_find_property(reference, &reading->things, name)) return true;
    zt_nearest nearest = zt_nearest_to(name);
    zt_suggest_properties(reading, &nearest);
    zt_mistake(mistakes, &node->place, "no property is called \"%s\"%s", zt_show(name).text,
               zt_suggest(&nearest).text);
    return false;
}

bool zt_read_place(zt_reference *reference, zt_reading *reading, const zt_node *node,
                   const char *what) {
    zt_mistakes *mistakes = &reading->mistakes;
    const char *name = zt_read_text(mistakes, node, what);
    if (!name) return false;
    const zt_thing *end, *thing = named(&end, &reading->things, name, strlen(name));
    bool found = thing < end;
    for (; thing < end; thing++) {
        *reference = (zt_reference){zt_place_property(thing->owner), thing->index};
        if (reference->property) return true;
    }
    zt_nearest nearest = zt_nearest_to(name);
    for (int32_t i = 0; i < reading->things.count && i < NEAREST_TRIED_MAX && !found; i++)
        if (zt_place_property(reading->things.all[i].owner))
            zt_nearest_try(&nearest, reading->things.all[i].name);
    if (found)
        zt_mistake(mistakes, &node->place, "\"%s\" is nowhere in particular",
                   zt_show(name).text);
    else
        zt_mistake(mistakes, &node->place, "no thing is named \"%s\"%s", zt_show(name).text,
                   zt_suggest(&nearest).text);
    return false;
}
