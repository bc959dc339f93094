#include "description/motion.h"

#include <stdlib.h>
#include <string.h>

#include "description/colors.h"
#include "description/times.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

/* A track on its way into the animation's array. */
typedef struct zt_track_link {
    zt_track track;
    struct zt_track_link *next;
} track_link;

typedef struct key {
    double time_s;
    const zt_node *when, *value;
    int32_t rank; /* in the text */
} key;

/* ---- one value ------------------------------------------------------------------------------
 */

/* [x, y, z] in degrees, or an axis and an angle, as a unit quaternion. */
static bool read_rotation(double value[4], zt_mistakes *mistakes, const zt_node *node,
                          const char *what, zt_range range) {
    static const char *const names[] = {"axis", "angle"};
    double v[3], angle;
    quat q;
    if (node->kind == ZT_NODE_MAPPING) {
        zt_fields fields;
        zt_fields_open(&fields, mistakes, node, what, names, COUNT(names));
        const zt_node *axis = zt_field_required(&fields, mistakes, "axis", &node->place);
        const zt_node *turn = zt_field_required(&fields, mistakes, "angle", &node->place);
        zt_range any = {-INFINITY, INFINITY, NULL};
        bool axis_read = axis && zt_read_vector(v, mistakes, axis, "axis", any);
        if (!turn || !zt_read_angle(&angle, mistakes, turn, "angle", range) || !axis_read)
            return false;
        if (vec3_max_abs((vec3){v[0], v[1], v[2]}) == 0) {
            zt_mistake(mistakes, &axis->place, "\"axis\" must not be zero");
            return false;
        }
        q = quat_axis_angle(vec3_normalize((vec3){v[0], v[1], v[2]}), angle);
    } else {
        if (!zt_read_angles(v, mistakes, node, what, range)) return false;
        q = quat_euler_xyz((vec3){v[0], v[1], v[2]});
    }
    q = quat_normalize(q);
    memcpy(value, (double[4]){q.w, q.x, q.y, q.z}, 4 * sizeof *value);
    return true;
}

static bool read_vertices(double value[9], zt_mistakes *mistakes, const zt_node *node,
                          const char *what, zt_range range) {
    if (node->kind != ZT_NODE_LIST || node->count != 3) {
        zt_expected(mistakes, node, what, "a list of 3 points [x, y, z]");
        return false;
    }
    bool good = true;
    for (int i = 0; i < 3; i++) {
        const zt_node *point = node->items[i];
        bool three = point->kind == ZT_NODE_LIST && point->count == 3;
        if (!three && point->kind != ZT_NODE_MISTAKE)
            zt_mistake(mistakes, &point->place,
                       "\"%s\" must be a list of 3 points [x, y, z], and this is none", what);
        good &= three && zt_read_vector(value + 3 * i, mistakes, point, what, range);
    }
    return good;
}

static bool read_value(double *value, zt_mistakes *mistakes, const zt_node *node,
                       const zt_property *property) {
    const char *what = property->name;
    zt_range range = {property->min, property->max, property->unit};
    switch (property->kind) {
    case ZT_VALUE_NUMBER:
        return zt_read_number(value, mistakes, node, what, range);
    case ZT_VALUE_ANGLE:
        return zt_read_angle(value, mistakes, node, what, range);
    case ZT_VALUE_VECTOR:
        return zt_read_vector(value, mistakes, node, what, range);
    case ZT_VALUE_COLOR:
        return zt_read_color(value, mistakes, node, what, range);
    case ZT_VALUE_ROTATION:
        return read_rotation(value, mistakes, node, what, range);
    case ZT_VALUE_VERTICES:
        return read_vertices(value, mistakes, node, what, range);
    case ZT_VALUE_SWITCH:
        return zt_read_switch(value, mistakes, node, what);
    case ZT_VALUE_SCALE:
        if (node->kind != ZT_NODE_TEXT)
            return zt_read_vector(value, mistakes, node, what, range);
        if (!zt_read_number(value, mistakes, node, what, range)) return false;
        value[1] = value[2] = value[0];
        return true;
    }
    return false;
}

/* ---- keys -----------------------------------------------------------------------------------
 */

static int by_time(const void *pa, const void *pb) {
    const key *a = pa, *b = pb;
    if (a->time_s != b->time_s) return a->time_s < b->time_s ? -1 : 1;
    return a->rank - b->rank;
}

static bool times_differ(zt_mistakes *mistakes, const key *keys, int32_t key_count) {
    bool differ = true;
    for (int32_t i = 1; i < key_count; i++) {
        if (keys[i].time_s != keys[i - 1].time_s) continue;
        differ = false;
        zt_mistake(mistakes, &keys[i].when->place, "\"%s\" is the same time as \"%s\"",
                   zt_show(keys[i].when->text).text, zt_show(keys[i - 1].when->text).text);
        zt_mistake_note(mistakes, &keys[i - 1].when->place, "the other key is here");
    }
    return differ;
}

/* The keys of a mapping in the order of time. Those without a time are told and left out, and
 * then, or when two are at the same time, `good` becomes false. */
static zt_status read_keys(key **out, int32_t *key_count, bool *good, zt_reading *reading,
                           const zt_node *mapping) {
    zt_mistakes *mistakes = &reading->mistakes;
    key *keys = *out = ZT_PUSH(reading->temporary, key, (size_t)mapping->count);
    if (!keys) return ZT_EMEMORY;
    int32_t count = 0;
    for (int32_t i = 0; i < mapping->count; i++) {
        const zt_node *when = zt_node_key(mapping, i);
        zt_moment moment;
        if (!zt_read_moment(&moment, mistakes, when, NULL)) continue;
        double time_s = zt_moment_s(moment, reading->animation->film.rate);
        keys[count++] = (key){time_s, when, zt_node_value(mapping, i), i};
    }
    qsort(keys, (size_t)count, sizeof *keys, by_time);
    if (!times_differ(mistakes, keys, count) || count < mapping->count) *good = false;
    *key_count = count;
    return ZT_OK;
}

static bool read_curve_kind(zt_curve_kind *kind, zt_mistakes *mistakes, const zt_node *node,
                            const zt_property *property) {
    bool is_switch = property->kind == ZT_VALUE_SWITCH;
    *kind = is_switch ? ZT_CURVE_HOLD : ZT_CURVE_SMOOTH;
    if (!node) return true;
    const char *names[ZT_CURVE_COUNT];
    int index;
    for (int i = 0; i < ZT_CURVE_COUNT; i++) names[i] = zt_curve_name((zt_curve_kind)i);
    if (!zt_read_choice(&index, mistakes, node, "curve", names, ZT_CURVE_COUNT)) return false;
    *kind = (zt_curve_kind)index;
    if (!is_switch || *kind == ZT_CURVE_HOLD) return true;
    zt_mistake(mistakes, &node->place,
               "\"%s\" is either true or false: its curve can only be %s", property->name,
               zt_curve_name(ZT_CURVE_HOLD));
    return false;
}

/* A curve from a mapping with "keys"; `good` says whether it could be made. */
static zt_status read_curve(zt_curve *curve, bool *good, zt_reading *reading,
                            const zt_node *node, const zt_property *property) {
    static const char *const names[] = {"keys", "curve"};
    zt_mistakes *mistakes = &reading->mistakes;
    zt_fields fields;
    *good = zt_fields_open(&fields, mistakes, node, property->name, names, COUNT(names));
    zt_curve_kind kind;
    *good &= read_curve_kind(&kind, mistakes, zt_field(&fields, "curve"), property);
    const zt_node *mapping = zt_field_required(&fields, mistakes, "keys", &node->place);
    if (!mapping || mapping->kind != ZT_NODE_MAPPING || mapping->count == 0) {
        if (mapping) zt_expected(mistakes, mapping, "keys", "a mapping of times to values");
        *good = false;
        return ZT_OK;
    }
    key *keys;
    int32_t key_count;
    ZT_TRY(read_keys(&keys, &key_count, good, reading, mapping));
    size_t width = (size_t)zt_value_width(property->kind);
    double *times = ZT_PUSH(reading->temporary, double, (size_t)key_count);
    double *values = ZT_PUSH(reading->temporary, double, (size_t)key_count *width);
    if (!times || !values) return ZT_EMEMORY;
    for (int32_t i = 0; i < key_count; i++) {
        times[i] = keys[i].time_s;
        *good &= read_value(values + (size_t)i * width, mistakes, keys[i].value, property);
    }
    if (!*good) return ZT_OK;
    return zt_curve_make(curve, &reading->animation->arena, kind, property->kind, key_count,
                         times, values);
}

/* ---- tracks ---------------------------------------------------------------------------------
 */

static zt_status add_track(zt_reading *reading, const zt_property *property, int32_t index,
                           const char *name, const zt_curve *curve) {
    track_link *link = ZT_PUSH(reading->temporary, track_link, 1);
    size_t name_length = strlen(name), size = name_length + 1 + strlen(property->name) + 1;
    char *full_name = ZT_PUSH(&reading->animation->arena, char, size);
    if (!link || !full_name) return ZT_EMEMORY;
    memcpy(full_name, name, name_length);
    full_name[name_length] = '.';
    memcpy(full_name + name_length + 1, property->name, size - name_length - 1);
    link->track = (zt_track){
        .property = property, .index = index, .name = full_name, .curve = *curve};
    if (reading->last_track)
        reading->last_track->next = link;
    else
        reading->first_track = link;
    reading->last_track = link;
    reading->animation->track_count++;
    return ZT_OK;
}

/* Whether a mapping is a value of its own, and not one with keys. */
static bool is_constant_mapping(const zt_node *node, const zt_property *property) {
    zt_fields fields = {.mapping = node};
    return property->kind == ZT_VALUE_ROTATION && !zt_field(&fields, "keys") &&
           (zt_field(&fields, "axis") || zt_field(&fields, "angle"));
}

static zt_status read_property(zt_reading *reading, const zt_node *node,
                               const zt_property *property, int32_t index, const char *name) {
    zt_scene *rest = &reading->animation->rest;
    double value[ZT_VALUE_WIDTH_MAX];
    if (node->kind != ZT_NODE_MAPPING || is_constant_mapping(node, property)) {
        if (read_value(value, &reading->mistakes, node, property))
            zt_property_set(property, rest, index, value);
        return ZT_OK;
    }
    zt_curve curve;
    bool good;
    ZT_TRY(read_curve(&curve, &good, reading, node, property));
    if (!good) return ZT_OK;
    zt_curve_eval(value, &curve, 0);
    zt_property_set(property, rest, index, value);
    return add_track(reading, property, index, name, &curve);
}

int zt_motion_names(const char *names[ZT_FIELD_NAMES_MAX], zt_owner owner) {
    int count = 0;
    for (int i = 0; i < zt_property_count; i++)
        if (zt_properties[i].owner == owner) names[count++] = zt_properties[i].name;
    return count;
}

zt_status zt_motion_read(zt_reading *reading, const zt_fields *fields, zt_owner owner,
                         int32_t index, const char *name, const zt_place *place) {
    zt_property_rest(&reading->animation->rest, owner, index);
    for (int i = 0; i < zt_property_count; i++) {
        const zt_property *property = &zt_properties[i];
        if (property->owner != owner) continue;
        const zt_node *node = property->required ? zt_field_required(fields, &reading->mistakes,
                                                                     property->name, place)
                                                 : zt_field(fields, property->name);
        if (node) ZT_TRY(read_property(reading, node, property, index, name));
    }
    return ZT_OK;
}

zt_status zt_motion_close(zt_reading *reading) {
    zt_animation *animation = reading->animation;
    zt_track *tracks = ZT_PUSH(&animation->arena, zt_track, (size_t)animation->track_count);
    if (!tracks) return ZT_EMEMORY;
    animation->tracks = tracks;
    for (const track_link *link = reading->first_track; link; link = link->next)
        *tracks++ = link->track;
    return ZT_OK;
}
