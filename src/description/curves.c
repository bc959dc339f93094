#include "description/curves.h"

#include "description/doubts.h"
#include "description/keys.h"
#include "description/times.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

/* What a mapping may say; a named one all but the last. */
static const char *const names[] = {"keys",   "at", "values", "curve", "before", "after",
                                    "spring", "in", "delay",  "speed", "scale",  "use"};

/* The named mapping that a node uses; NULL where there is none, or where the keys that are used
 * again and again, up to here, are too many to be held. */
static const zt_node *find_used(zt_reading *reading, const zt_node *use) {
    enum { USED_KEY_COUNT_MAX = 1000 * 1000 };
    zt_mistakes *mistakes = &reading->mistakes;
    if (!zt_read_text(mistakes, use, "use")) return NULL;
    const zt_node *shared = zt_named(reading, &reading->curves, use, "curve");
    if (!shared || shared->kind != ZT_NODE_MAPPING) return NULL; /* told */
    zt_fields fields = {.mapping = shared};
    const zt_node *keys = zt_field(&fields, "keys"), *values = zt_field(&fields, "values");
    const zt_node *used = keys ? keys : values;
    if (used && used->kind != ZT_NODE_TEXT) reading->used_key_count += used->count;
    if (reading->used_key_count <= USED_KEY_COUNT_MAX) return shared;
    zt_mistake(mistakes, &use->place, "too many keys are used up to here: more than %d",
               USED_KEY_COUNT_MAX);
    return NULL;
}

/* Opens the mapping and the one that it uses. */
static bool open_said(zt_said *said, zt_reading *reading, const zt_node *node) {
    if (!zt_fields_open(&said->own, &reading->mistakes, node, said->property->name, names,
                        COUNT(names)))
        return false;
    const zt_node *use = zt_field(&said->own, "use");
    if (!use) return true;
    said->shared = find_used(reading, use);
    return said->shared != NULL;
}

/* "curve", or what is usual; springs have none. */
static zt_status read_usual(zt_way *way, bool *good, zt_reading *reading, const zt_said *said,
                            bool springs) {
    zt_mistakes *mistakes = &reading->mistakes;
    bool is_switch = said->property->kind == ZT_VALUE_SWITCH;
    const zt_node *node = zt_said_field(said, "curve");
    *way = (zt_way){.kind = is_switch ? ZT_CURVE_HOLD : ZT_CURVE_SMOOTH};
    if (!node) return ZT_OK;
    bool known;
    ZT_TRY(zt_read_way(way, &known, reading, node, "curve"));
    *good &= known && zt_suits(reading, node, *way, said->property);
    if (springs && zt_field(&said->own, "curve")) {
        zt_mistake(mistakes, &node->place, "a spring finds its own way: it has no \"curve\"");
        *good = false;
    }
    return ZT_OK;
}

/* "in: oklab" or "in: turns"; NULL where nothing is said. */
static const zt_curve_space *read_space(zt_curve_space *space, bool *good, zt_reading *reading,
                                        const zt_said *said) {
    static const char *const spaces[] = {"oklab", "turns"};
    const zt_node *node = zt_said_field(said, "in");
    int index;
    if (!node) return NULL;
    if (!zt_read_choice(&index, &reading->mistakes, node, "in", spaces, COUNT(spaces))) {
        *good = false;
        return NULL;
    }
    *space = index == 0 ? ZT_SPACE_OKLAB : ZT_SPACE_TURNS;
    if (said->property->kind == (index == 0 ? ZT_VALUE_COLOR : ZT_VALUE_ROTATION)) return space;
    zt_mistake(&reading->mistakes, &node->place, "only %s can move in %s",
               index == 0 ? "colors" : "rotations", spaces[index]);
    *good = false;
    return NULL;
}

static bool can_be_scaled(zt_value_kind kind) {
    return kind == ZT_VALUE_NUMBER || kind == ZT_VALUE_ANGLE || kind == ZT_VALUE_VECTOR ||
           kind == ZT_VALUE_SCALE;
}

static bool read_change(zt_change *change, zt_reading *reading, const zt_said *said) {
    const zt_node *delay = zt_said_field(said, "delay"), *speed = zt_said_field(said, "speed"),
                  *scale = zt_said_field(said, "scale");
    zt_mistakes *mistakes = &reading->mistakes;
    bool good = true;
    *change = (zt_change){0, 1, 1};
    if (delay)
        good &=
            zt_read_time(&change->delay_s, mistakes, delay, "delay", &reading->animation->film);
    if (speed)
        good &= zt_read_number(&change->speed, mistakes, speed, "speed",
                               (zt_range){1e-9, 1e9, NULL});
    if (scale) good &= zt_read_number(&change->scale, mistakes, scale, "scale", zt_any_number);
    if (!scale || can_be_scaled(said->property->kind)) return good;
    zt_mistake(mistakes, &scale->place, "\"%s\" cannot be scaled", said->property->name);
    return false;
}

static zt_status keep_places(zt_track *track, zt_reading *reading, const zt_keys *keys) {
    zt_place *places = ZT_PUSH(&reading->animation->arena, zt_place, (size_t)keys->count);
    if (!places) return ZT_EMEMORY;
    for (int32_t k = 0; k < keys->count; k++) places[k] = keys->whens[k]->place;
    track->key_places = places;
    return ZT_OK;
}

/* The curve and the places of a track from what is written about it. */
static zt_status read_said(zt_track *track, bool *good, zt_reading *reading,
                           const zt_said *said) {
    const zt_node *spring_node = zt_said_field(said, "spring"),
                  *before = zt_said_field(said, "before"),
                  *after = zt_said_field(said, "after");
    zt_curve_spec spec = {.value_kind = track->property->kind};
    zt_spring spring;
    if (spring_node) *good &= zt_read_spring(&spring, reading, spring_node);
    if (before) *good &= zt_read_end(&spec.before, reading, before, "before");
    if (after) *good &= zt_read_end(&spec.after, reading, after, "after");
    zt_way usual;
    ZT_TRY(read_usual(&usual, good, reading, said, spring_node != NULL));
    zt_change change;
    *good &= read_change(&change, reading, said);
    const zt_curve_space *space = read_space(&spec.space, good, reading, said);
    zt_keys keys;
    bool keys_good;
    ZT_TRY(zt_keys_read(&keys, &keys_good, reading, said, change, usual, space));
    *good &= keys_good;
    if (!*good) return ZT_OK;
    spec.space = keys.space;
    spec.keys = keys.keys;
    spec.key_count = keys.count;
    if (spring_node) spec.spring = &spring;
    ZT_TRY(zt_curve_from_keys(&track->curve, &reading->animation->arena, &spec));
    zt_doubts_tell(reading, track->property, &keys, &track->curve);
    return keep_places(track, reading, &keys);
}

zt_status zt_curve_read(zt_track *track, bool *good, zt_reading *reading, const zt_node *node) {
    zt_mistakes *mistakes = &reading->mistakes;
    zt_said said = {.property = track->property};
    *good = open_said(&said, reading, node);
    if (!*good) return ZT_OK;
    int64_t count = mistakes->count;
    ZT_TRY(read_said(track, good, reading, &said));
    if (said.shared && mistakes->count > count)
        zt_mistake_note(mistakes, &node->place, "\"%s\" uses it here", said.property->name);
    return ZT_OK;
}

zt_status zt_curve_use(zt_track *track, bool *good, zt_reading *reading, const zt_node *use) {
    const zt_node *shared = find_used(reading, use);
    *good = shared != NULL;
    return shared ? zt_curve_read(track, good, reading, shared) : ZT_OK;
}

void zt_curves_check(zt_reading *reading) {
    zt_mistakes *mistakes = &reading->mistakes;
    const zt_node *timings = reading->timings.mapping, *curves = reading->curves.mapping;
    for (int32_t i = 0; timings && i < timings->count; i++) {
        const zt_node *list = zt_node_value(timings, i);
        double time_s;
        if (list->kind != ZT_NODE_LIST)
            zt_expected(mistakes, list, zt_show(zt_node_key(timings, i)->text).text,
                        "a list of times");
        for (int32_t t = 0; list->kind == ZT_NODE_LIST && t < list->count; t++)
            zt_read_time(&time_s, mistakes, list->items[t], "at", &reading->animation->film);
    }
    for (int32_t i = 0; curves && i < curves->count; i++) {
        zt_fields fields;
        zt_fields_open(&fields, mistakes, zt_node_value(curves, i),
                       zt_show(zt_node_key(curves, i)->text).text, names, COUNT(names) - 1);
    }
}
