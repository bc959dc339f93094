#include "description/ways.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "description/reading.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

/* ---- easings --------------------------------------------------------------------------------
 */

typedef struct zt_known_ease {
    const zt_node *node; /* NULL: the slot is free */
    const zt_ease *ease;
} known_ease;

/* The slot of a node in a table that is never full, whose size is a power of 2. */
static known_ease *slot_of(known_ease *slots, size_t capacity, const zt_node *node) {
    size_t at = (size_t)((uintptr_t)node / sizeof *node * UINT64_C(0x9E3779B97F4A7C15) >> 20);
    while (slots[at &= capacity - 1].node && slots[at].node != node) at++;
    return &slots[at];
}

static zt_status grow(zt_eases *eases, zt_arena *arena) {
    size_t capacity = eases->capacity ? 2 * eases->capacity : 64;
    known_ease *slots = ZT_PUSH(arena, known_ease, capacity);
    if (!slots) return ZT_EMEMORY;
    for (size_t i = 0; i < eases->capacity; i++)
        if (eases->slots[i].node)
            *slot_of(slots, capacity, eases->slots[i].node) = eases->slots[i];
    eases->slots = slots;
    eases->capacity = capacity;
    return ZT_OK;
}

/* Tells what is wrong with a text that is no easing, nor, with `kinds`, a kind of curve. */
static void tell_no_ease(zt_mistakes *mistakes, const zt_node *node, const char *what,
                         const char *wrong, bool kinds) {
    size_t length = strcspn(node->text, "( ");
    zt_nearest nearest = zt_nearest_to(node->text);
    const char *word;
    for (int i = 0; (word = zt_ease_word(i)); i++) {
        if (strlen(word) == length && strncmp(node->text, word, length) == 0) {
            zt_mistake(mistakes, &node->place, "\"%s\" is %s: %s", what,
                       zt_show(node->text).text, wrong);
            return;
        }
        zt_nearest_try(&nearest, word);
    }
    for (int i = 0; kinds && i < ZT_CURVE_KIND_COUNT; i++)
        zt_nearest_try(&nearest, zt_curve_name((zt_curve_kind)i));
    if (zt_text_equal(node->text, "spring"))
        zt_mistake(mistakes, &node->place,
                   "a spring is written \"spring: { frequency: 2, damping_ratio: 0.5 }\", in "
                   "place of \"%s\"",
                   what);
    else
        zt_mistake(mistakes, &node->place, "\"%s\" is \"%s\", and there is no such %s%s", what,
                   zt_show(node->text).text, kinds ? "curve" : "easing",
                   zt_suggest(&nearest).text);
}

static zt_status read_ease(const zt_ease **ease, bool *good, zt_reading *reading,
                           const zt_node *node, const char *what, bool kinds) {
    zt_eases *eases = &reading->eases;
    if (2 * eases->count >= eases->capacity) ZT_TRY(grow(eases, reading->temporary));
    known_ease *slot = slot_of(eases->slots, eases->capacity, node);
    if (!slot->node) {
        zt_ease *fresh = ZT_PUSH(&reading->animation->arena, zt_ease, 1);
        if (!fresh) return ZT_EMEMORY;
        const char *wrong = zt_ease_parse(fresh, &reading->animation->arena, node->text);
        if (wrong) tell_no_ease(&reading->mistakes, node, what, wrong, kinds);
        *slot = (known_ease){node, wrong ? NULL : fresh};
        eases->count++;
    }
    *ease = slot->ease;
    *good = slot->ease != NULL;
    return ZT_OK;
}

zt_status zt_read_ease(const zt_ease **ease, bool *good, zt_reading *reading,
                       const zt_node *node, const char *what) {
    *ease = NULL;
    *good = zt_read_text(&reading->mistakes, node, what);
    if (!*good || zt_text_equal(node->text, zt_curve_name(ZT_CURVE_LINEAR))) return ZT_OK;
    return read_ease(ease, good, reading, node, what, false);
}

zt_status zt_read_way(zt_way *way, bool *good, zt_reading *reading, const zt_node *node,
                      const char *what) {
    *way = (zt_way){.kind = ZT_CURVE_KIND_COUNT};
    *good = zt_read_text(&reading->mistakes, node, what);
    if (!*good) return ZT_OK;
    for (int i = 0; i < ZT_CURVE_KIND_COUNT; i++)
        if (zt_text_equal(node->text, zt_curve_name((zt_curve_kind)i))) {
            way->kind = (zt_curve_kind)i;
            return ZT_OK;
        }
    ZT_TRY(read_ease(&way->ease, good, reading, node, what, true));
    if (*good) way->kind = ZT_CURVE_LINEAR;
    return ZT_OK;
}

/* ---- ends and springs -----------------------------------------------------------------------
 */

bool zt_read_end(zt_curve_end *end, zt_reading *reading, const zt_node *node,
                 const char *what) {
    const char *names[ZT_END_COUNT];
    int index;
    for (int i = 0; i < ZT_END_COUNT; i++) names[i] = zt_curve_end_name((zt_curve_end)i);
    if (!zt_read_choice(&index, &reading->mistakes, node, what, names, ZT_END_COUNT))
        return false;
    *end = (zt_curve_end)index;
    return true;
}

/* One of a spring's numbers. */
typedef struct measure {
    const char *name;
    double min, usual; /* NAN: it must be said */
} measure;

enum { MEASURES_MAX = 3 };

static bool read_measures(double values[MEASURES_MAX], zt_mistakes *mistakes,
                          const zt_node *node, const measure *measures, int count) {
    const double max = 1e18;
    const char *names[MEASURES_MAX];
    for (int i = 0; i < count; i++) names[i] = measures[i].name;
    zt_fields fields;
    bool good = zt_fields_open(&fields, mistakes, node, "spring", names, count);
    for (int i = 0; good && i < count; i++) {
        bool required = isnan(measures[i].usual);
        const zt_node *value =
            required ? zt_field_required(&fields, mistakes, names[i], &node->place)
                     : zt_field(&fields, names[i]);
        values[i] = measures[i].usual;
        zt_range range = {measures[i].min, max, NULL};
        good = value ? zt_read_number(&values[i], mistakes, value, names[i], range) : !required;
    }
    return good;
}

static bool has_any(const zt_node *node, const measure *measures, int count) {
    for (int i = 0; node->kind == ZT_NODE_MAPPING && i < count; i++)
        if (zt_field(&(zt_fields){.mapping = node}, measures[i].name)) return true;
    return false;
}

bool zt_read_spring(zt_spring *spring, zt_reading *reading, const zt_node *node) {
    static const measure swings[] = {{"frequency", 1e-18, NAN}, {"damping_ratio", 0, 0.5}};
    static const measure forces[] = {
        {"stiffness", 1e-18, NAN}, {"damping", 0, NAN}, {"mass", 1e-18, 1}};
    const double tau = 6.283185307179586;
    zt_mistakes *mistakes = &reading->mistakes;
    double v[MEASURES_MAX];
    bool by_forces = has_any(node, forces, COUNT(forces));
    if (by_forces && has_any(node, swings, COUNT(swings))) {
        zt_mistake(
            mistakes, &node->place,
            "a spring has a frequency and a damping_ratio, or a stiffness, a damping and "
            "a mass, but not both");
        return false;
    }
    if (by_forces) {
        if (!read_measures(v, mistakes, node, forces, COUNT(forces))) return false;
        *spring = zt_spring_of(v[0], v[1], v[2]);
        return true;
    }
    if (!read_measures(v, mistakes, node, swings, COUNT(swings))) return false;
    *spring = zt_spring_make(v[0] * tau, v[1]);
    return true;
}
