#include "description/motion.h"

#include <string.h>

#include "description/constraints.h"
#include "description/curves.h"
#include "description/rotations.h"
#include "description/values.h"

/* A track on its way into the animation's array. */
typedef struct zt_track_link {
    zt_track track;
    struct zt_track_link *next;
} track_link;

zt_status zt_motion_add(zt_reading *reading, const zt_track *track, const char *thing) {
    const char *property = track->property->name;
    track_link *link = ZT_PUSH(reading->temporary, track_link, 1);
    size_t thing_length = strlen(thing), size = thing_length + 1 + strlen(property) + 1;
    char *name = ZT_PUSH(&reading->animation->arena, char, size);
    if (!link || !name) return ZT_EMEMORY;
    memcpy(name, thing, thing_length);
    name[thing_length] = '.';
    memcpy(name + thing_length + 1, property, size - thing_length - 1);
    link->track = *track;
    link->track.name = name;
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
           zt_is_rotation(node);
}

static zt_status read_property(zt_reading *reading, const zt_node *node,
                               const zt_property *property, int32_t index, const char *name) {
    zt_scene *rest = &reading->animation->rest;
    double value[ZT_VALUE_WIDTH_MAX];
    bool taken;
    ZT_TRY(zt_constraint_read(&taken, reading, node, property, index, name));
    if (taken) return ZT_OK;
    if (node->kind != ZT_NODE_MAPPING || is_constant_mapping(node, property)) {
        if (zt_read_value(value, &reading->mistakes, node, property))
            zt_property_set(property, rest, index, value);
        return ZT_OK;
    }
    zt_track track = {.property = property, .index = index, .place = node->place};
    bool good;
    ZT_TRY(zt_curve_read(&track, &good, reading, node));
    if (!good) return ZT_OK;
    zt_curve_eval(value, &track.curve, 0);
    zt_property_set(property, rest, index, value);
    return zt_motion_add(reading, &track, name);
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
    ZT_TRY(zt_things_add(reading, owner, index, name, place));
    for (int i = 0; i < zt_property_count; i++) {
        const zt_property *property = &zt_properties[i];
        if (property->owner != owner) continue;
        bool required = (property->flags & ZT_PROPERTY_REQUIRED) != 0;
        const zt_node *node =
            required ? zt_field_required(fields, &reading->mistakes, property->name, place)
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
