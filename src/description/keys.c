#include "description/keys.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "description/rotations.h"
#include "description/times.h"
#include "description/values.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

/* A key as it stands in the text. */
typedef struct written {
    double time_s;
    const zt_node *when, *value, *in, *out; /* the last two may be NULL */
    int32_t rank;
} written;

/* What the parts of reading share. */
typedef struct reader {
    zt_reading *reading;
    const zt_said *said;
    zt_change change;
    zt_way usual;
    int32_t count;
    written *written;
    zt_key *keys;
    bool good;
} reader;

const zt_node *zt_said_field(const zt_said *said, const char *name) {
    const zt_node *own = zt_field(&said->own, name);
    return own || !said->shared ? own : zt_field(&(zt_fields){.mapping = said->shared}, name);
}

bool zt_suits(zt_reading *reading, const zt_node *node, zt_way way,
              const zt_property *property) {
    if (property->kind != ZT_VALUE_SWITCH || way.kind == ZT_CURVE_HOLD) return true;
    zt_mistake(&reading->mistakes, &node->place,
               "\"%s\" is either true or false: its curve can only be %s", property->name,
               zt_curve_name(ZT_CURVE_HOLD));
    return false;
}

/* ---- times ----------------------------------------------------------------------------------
 */

static zt_status make_room(reader *r, int32_t count) {
    r->written = ZT_PUSH(r->reading->temporary, written, (size_t)count);
    r->keys = ZT_PUSH(r->reading->temporary, zt_key, (size_t)count);
    return r->written && r->keys ? ZT_OK : ZT_EMEMORY;
}

/* A key without a time is told and left out. `what` is NULL where `when` is itself a key. */
static void add_key(reader *r, const zt_node *when, const char *what, const zt_node *value) {
    double time_s;
    if (!zt_read_time(&time_s, &r->reading->mistakes, when, what,
                      &r->reading->animation->film)) {
        r->good = false;
        return;
    }
    time_s = r->change.delay_s + time_s / r->change.speed;
    r->written[r->count] = (written){time_s, when, value, NULL, NULL, r->count};
    r->count++;
}

static zt_status gather_keys(reader *r, const zt_node *mapping) {
    if (mapping->kind != ZT_NODE_MAPPING || mapping->count == 0) {
        zt_expected(&r->reading->mistakes, mapping, "keys", "a mapping of times to values");
        r->good = false;
        return ZT_OK;
    }
    ZT_TRY(make_room(r, mapping->count));
    for (int32_t i = 0; i < mapping->count; i++)
        add_key(r, zt_node_key(mapping, i), NULL, zt_node_value(mapping, i));
    return ZT_OK;
}

/* Values at the times of a list, which has a name or stands here. */
static zt_status gather_values(reader *r, const zt_node *at, const zt_node *values) {
    zt_mistakes *mistakes = &r->reading->mistakes;
    const zt_node *times = at;
    r->good = false;
    if (at->kind == ZT_NODE_TEXT) {
        times = zt_named(r->reading, &r->reading->timings, at, "timing");
        if (!times) return ZT_OK;
    }
    if (times->kind != ZT_NODE_LIST || times->count == 0) {
        zt_expected(mistakes, times, "at", "a timing's name or a list of times");
        return ZT_OK;
    }
    if (values->kind != ZT_NODE_LIST || values->count != times->count) {
        char expected[48];
        snprintf(expected, sizeof expected, "a list of %d, one for each time",
                 (int)times->count);
        zt_expected(mistakes, values, "values", expected);
        return ZT_OK;
    }
    r->good = true;
    ZT_TRY(make_room(r, times->count));
    for (int32_t i = 0; i < times->count; i++)
        add_key(r, times->items[i], "at", values->items[i]);
    return ZT_OK;
}

static int by_time(const void *pa, const void *pb) {
    const written *a = pa, *b = pb;
    if (a->time_s != b->time_s) return a->time_s < b->time_s ? -1 : 1;
    return a->rank - b->rank;
}

static void sort_times(reader *r) {
    zt_mistakes *mistakes = &r->reading->mistakes;
    const written *w = r->written;
    if (r->count) qsort(r->written, (size_t)r->count, sizeof *r->written, by_time);
    for (int32_t i = 1; i < r->count; i++) {
        if (w[i].time_s != w[i - 1].time_s) continue;
        r->good = false;
        zt_mistake(mistakes, &w[i].when->place, "\"%s\" is the same time as \"%s\"",
                   zt_show(w[i].when->text).text, zt_show(w[i - 1].when->text).text);
        zt_mistake_note(mistakes, &w[i - 1].when->place, "the other key is here");
    }
}

static zt_status gather(reader *r) {
    zt_mistakes *mistakes = &r->reading->mistakes;
    const zt_node *keys = zt_said_field(r->said, "keys"), *at = zt_said_field(r->said, "at"),
                  *values = zt_said_field(r->said, "values");
    if (keys && !at && !values) {
        ZT_TRY(gather_keys(r, keys));
    } else if (!keys && at && values) {
        ZT_TRY(gather_values(r, at, values));
    } else {
        const zt_fields *own = &r->said->own;
        r->good = false;
        if (keys)
            zt_mistake(mistakes, &(at ? at : values)->place,
                       "there are \"keys\", or values \"at\" times, but not both");
        else
            zt_field_required(own, mistakes,
                              at       ? "values"
                              : values ? "at"
                                       : "keys",
                              &own->mapping->place);
    }
    sort_times(r);
    return ZT_OK;
}

/* ---- what is written beside a value ---------------------------------------------------------
 */

/* Nothing is told where the kind of the way is not known. */
static void not_of_this_way(reader *r, const zt_node *node, const char *name,
                            zt_curve_kind kind, const char *kinds) {
    r->good = false;
    if (kind == ZT_CURVE_KIND_COUNT) return;
    zt_mistake(&r->reading->mistakes, &node->place, "\"%s\" belongs to %s curves", name, kinds);
}

/* The kind of the way that comes to a key; before the first one, as the way that leaves it. */
static zt_curve_kind kind_before(const reader *r, int32_t k) {
    return r->keys[k > 0 ? k - 1 : 0].kind;
}

static void read_tension(reader *r, int32_t k, const zt_fields *fields) {
    zt_key *key = &r->keys[k];
    const char *const names[] = {"tension", "continuity", "bias"};
    double *const values[] = {&key->tension, &key->continuity, &key->bias};
    for (int i = 0; i < COUNT(names); i++) {
        const zt_node *node = zt_field(fields, names[i]);
        if (!node) continue;
        if (key->kind != ZT_CURVE_TCB && kind_before(r, k) != ZT_CURVE_TCB)
            not_of_this_way(r, node, names[i], key->kind, "tcb");
        else
            r->good &= zt_read_number(values[i], &r->reading->mistakes, node, names[i],
                                      (zt_range){-1, 1, NULL});
    }
}

/* What may stand in a key. */
static const char *const key_names[] = {"value",   "curve",      "in",  "out",
                                        "tension", "continuity", "bias"};

static bool is_whole_value(const zt_node *node) {
    for (int i = 0; node->kind == ZT_NODE_MAPPING && i < COUNT(key_names); i++)
        if (zt_field(&(zt_fields){.mapping = node}, key_names[i])) return false;
    return true;
}

/* Splits "{ value: VALUE, curve: WORD, ... }", or takes what stands there for a value. */
static zt_status read_parts(reader *r, int32_t k) {
    written *w = &r->written[k];
    zt_way way = r->usual;
    zt_fields fields = {0};
    if (!is_whole_value(w->value)) {
        zt_mistakes *mistakes = &r->reading->mistakes;
        const zt_node *node = w->value;
        zt_fields_open(&fields, mistakes, node, r->said->property->name, key_names,
                       COUNT(key_names));
        const zt_node *curve = zt_field(&fields, "curve");
        bool good = true;
        if (curve) ZT_TRY(zt_read_way(&way, &good, r->reading, curve, "curve"));
        w->value = zt_field_required(&fields, mistakes, "value", &node->place);
        w->in = zt_field(&fields, "in");
        w->out = zt_field(&fields, "out");
        r->good &= good && w->value;
        if (curve && good) r->good &= zt_suits(r->reading, curve, way, r->said->property);
    }
    r->keys[k] = (zt_key){.time_s = w->time_s, .kind = way.kind, .ease = way.ease};
    if (fields.mapping) read_tension(r, k, &fields);
    return ZT_OK;
}

/* ---- handles --------------------------------------------------------------------------------
 */

/* A difference of values, or a speed of them, in the numbers of the curve's space. */
static bool read_difference(double *value, reader *r, const zt_node *node, const char *what,
                            zt_curve_kind kind, zt_curve_space space) {
    const zt_property *property = r->said->property;
    zt_mistakes *mistakes = &r->reading->mistakes;
    if (property->kind != ZT_VALUE_ROTATION)
        return zt_read_difference(value, mistakes, node, what, property->kind);
    if (kind == ZT_CURVE_HERMITE && space == ZT_SPACE_VALUES)
        return zt_read_numbers(value, 4, mistakes, node, what, zt_any_number);
    return zt_read_angles(value, mistakes, node, what, zt_any_number);
}

/* The same, times a factor. */
static void read_scaled(const double **value, double *room, double factor, reader *r,
                        const zt_node *node, const char *what, zt_curve_kind kind,
                        zt_curve_space space) {
    bool finite = true;
    *value = room;
    r->good &= read_difference(room, r, node, what, kind, space);
    for (int c = 0; c < ZT_VALUE_WIDTH_MAX; c++) {
        room[c] *= factor;
        finite &= isfinite(room[c]);
    }
    if (finite) return;
    zt_mistake(&r->reading->mistakes, &node->place,
               "\"%s\" times %g, by \"scale\" and \"speed\", is too large", what, factor);
    r->good = false;
}

/* "{ time: 0.2 s, value: VALUE }" from the key; `time_s` counts away from it. */
static void read_bezier_handle(double *time_s, const double **value, double *room, reader *r,
                               const zt_node *node, bool leaving, zt_curve_space space) {
    static const char *const names[] = {"time", "value"};
    zt_mistakes *mistakes = &r->reading->mistakes;
    zt_fields fields;
    if (!zt_fields_open(&fields, mistakes, node, leaving ? "out" : "in", names, COUNT(names))) {
        r->good = false;
        return;
    }
    const zt_node *time = zt_field(&fields, "time"), *offset = zt_field(&fields, "value");
    if (time) {
        if (!zt_read_time(time_s, mistakes, time, "time", &r->reading->animation->film))
            r->good = false;
        *time_s *= (leaving ? 1 : -1) / r->change.speed;
        if (*time_s < 0) {
            zt_doubt(mistakes, &time->place,
                     "time runs backwards here: an \"%s\" handle is %s its key; 0 s is taken",
                     leaving ? "out" : "in", leaving ? "after" : "before");
            *time_s = 0;
        }
    }
    if (offset)
        read_scaled(value, room, r->change.scale, r, offset, "value", ZT_CURVE_BEZIER, space);
}

/* "in" or "out" of a key. */
static zt_status read_handle(reader *r, int32_t k, bool leaving, zt_curve_space space) {
    const zt_node *node = leaving ? r->written[k].out : r->written[k].in;
    if (!node) return ZT_OK;
    double *room = ZT_PUSH(r->reading->temporary, double, ZT_VALUE_WIDTH_MAX);
    if (!room) return ZT_EMEMORY;
    zt_key *key = &r->keys[k];
    const char *name = leaving ? "out" : "in";
    zt_curve_kind kind = leaving ? key->kind : kind_before(r, k);
    if (kind == ZT_CURVE_BEZIER)
        read_bezier_handle(leaving ? &key->after_s : &key->before_s,
                           leaving ? &key->after : &key->before, room, r, node, leaving, space);
    else if (kind == ZT_CURVE_HERMITE)
        read_scaled(leaving ? &key->after : &key->before, room,
                    r->change.scale * r->change.speed, r, node, name, kind, space);
    else
        not_of_this_way(r, node, name, kind, "bezier and hermite");
    return ZT_OK;
}

/* ---- values ---------------------------------------------------------------------------------
 */

/* Whether the rotations are turns around one axis, and one of them is more than half round:
 * then what is meant is how far to turn, not where to end. */
static bool turn_on_one_axis(const zt_written_rotation *rotations, int32_t count) {
    const double half = 3.14159265358979323846 * (1 + 1e-12);
    vec3 axis = {0, 0, 0};
    bool far = false;
    for (int32_t k = 0; k < count; k++) {
        vec3 turn = rotations[k].turn;
        double angle = vec3_length(turn);
        if (!rotations[k].has_axis) return false;
        if (vec3_max_abs(axis) == 0) axis = vec3_normalize(turn);
        if (vec3_length(vec3_cross(axis, turn)) > 1e-9 * angle) return false;
        far |= angle > half;
    }
    return far;
}

static zt_status read_rotations(reader *r, zt_curve_space *space, bool space_is_said) {
    const zt_property *property = r->said->property;
    size_t count = (size_t)r->count;
    zt_written_rotation *rotations = ZT_PUSH(r->reading->temporary, zt_written_rotation, count);
    if (!rotations) return ZT_EMEMORY;
    for (size_t k = 0; k < count; k++)
        if (r->written[k].value)
            r->good &=
                zt_read_rotation(&rotations[k], &r->reading->mistakes, r->written[k].value,
                                 property->name, zt_property_range(property));
    if (r->good && !space_is_said && turn_on_one_axis(rotations, r->count))
        *space = ZT_SPACE_TURNS;
    for (size_t k = 0; k < count; k++)
        r->keys[k].value =
            *space == ZT_SPACE_TURNS ? &rotations[k].turn.x : &rotations[k].rotation.w;
    return ZT_OK;
}

/* A value times the scale must be what the property may be, as well. */
static void scale_value(reader *r, double *value, int width, const zt_node *node) {
    const zt_property *property = r->said->property;
    double unit = property->unit ? 3.14159265358979323846 / 180 : 1;
    bool inside = true;
    if (r->change.scale == 1) return;
    for (int c = 0; c < width; c++) {
        value[c] *= r->change.scale;
        inside &= value[c] >= property->min * unit && value[c] <= property->max * unit &&
                  isfinite(value[c]);
    }
    if (inside) return;
    zt_mistake(&r->reading->mistakes, &node->place,
               "\"%s\" times the \"scale\" %g is out of its range", property->name,
               r->change.scale);
    r->good = false;
}

static zt_status read_values(reader *r) {
    size_t width = (size_t)zt_value_width(r->said->property->kind);
    double *values = ZT_PUSH(r->reading->temporary, double, (size_t)r->count *width);
    if (!values) return ZT_EMEMORY;
    for (int32_t k = 0; k < r->count; k++) {
        double *value = values + (size_t)k * width;
        const zt_node *node = r->written[k].value;
        r->keys[k].value = value;
        if (!node) continue;
        if (zt_read_value(value, &r->reading->mistakes, node, r->said->property))
            scale_value(r, value, (int)width, node);
        else
            r->good = false;
    }
    return ZT_OK;
}

static zt_status keep_whens(zt_keys *keys, const reader *r) {
    const zt_node **whens = ZT_PUSH(r->reading->temporary, const zt_node *, (size_t)r->count);
    if (!whens) return ZT_EMEMORY;
    for (int32_t k = 0; k < r->count; k++) whens[k] = r->written[k].when;
    keys->count = r->count;
    keys->keys = r->keys;
    keys->whens = whens;
    return ZT_OK;
}

zt_status zt_keys_read(zt_keys *keys, bool *good, zt_reading *reading, const zt_said *said,
                       zt_change change, zt_way usual, const zt_curve_space *space) {
    reader r = {
        .reading = reading, .said = said, .change = change, .usual = usual, .good = true};
    *keys = (zt_keys){.space = space ? *space : ZT_SPACE_VALUES};
    *good = false;
    ZT_TRY(gather(&r));
    for (int32_t k = 0; k < r.count; k++) ZT_TRY(read_parts(&r, k));
    if (said->property->kind == ZT_VALUE_ROTATION)
        ZT_TRY(read_rotations(&r, &keys->space, space != NULL));
    else
        ZT_TRY(read_values(&r));
    for (int32_t k = 0; k < r.count; k++) {
        ZT_TRY(read_handle(&r, k, false, keys->space));
        ZT_TRY(read_handle(&r, k, true, keys->space));
    }
    *good = r.good && r.count > 0;
    return keep_whens(keys, &r);
}
