/* Properties as people ask for them: by name, with the units and names of their numbers. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"
#include "image/develop.h"
#include "keyframe/explain.h"

static const char *const no_names[] = {"", NULL};
static const char *const xyz[] = {"x", "y", "z"};
static const char *const rgb[] = {"r", "g", "b"};
static const char *const wxyz[] = {"w", "x", "y", "z"};
static const char *const corners[] = {"x1", "y1", "z1", "x2", "y2", "z2", "x3", "y3", "z3"};

static const char *const *channel_names(zt_value_kind kind) {
    switch (kind) {
    case ZT_VALUE_COLOR:
        return rgb;
    case ZT_VALUE_ROTATION:
        return wxyz;
    case ZT_VALUE_VERTICES:
        return corners;
    case ZT_VALUE_VECTOR:
    case ZT_VALUE_SCALE:
        return xyz;
    case ZT_VALUE_NUMBER:
    case ZT_VALUE_ANGLE:
    case ZT_VALUE_SWITCH:
        break;
    }
    return no_names;
}

double zt_property_unit(const zt_property *property) {
    return property->unit ? 3.14159265358979323846 / 180 : 1; /* "deg" is the only one */
}

/* What moves a property; NULL where nothing does. */
static const zt_track *track_of(const zt_subject *subject) {
    return subject->movement < 0 ? NULL : &subject->film->tracks[subject->movement];
}

static void to_written(double *value, const zt_subject *subject) {
    double unit = *subject->unit ? zt_property_unit(subject->property) : 1;
    for (int c = 0; c < subject->channel_count; c++) value[c] /= unit;
}

/* ---- finding -------------------------------------------------------------------------------
 */

static zt_subject subject_of(const zt_animation *animation, const zt_property *property,
                             int32_t index) {
    bool angle = property->kind == ZT_VALUE_ANGLE;
    return (zt_subject){.meaning = property->meaning,
                        .unit = angle ? property->unit : "",
                        .channels = channel_names(property->kind),
                        .channel_count = zt_value_width(property->kind),
                        .is_color = property->kind == ZT_VALUE_COLOR,
                        .least = property->min,
                        .most = property->max,
                        .film = animation,
                        .property = property,
                        .index = index,
                        .movement = -1};
}

zt_subject zt_subject_of_movement(const zt_animation *animation, int index) {
    const zt_track *track = &animation->tracks[index];
    zt_movement movement = zt_animation_movement(animation, index);
    zt_subject subject = subject_of(animation, track->property, track->index);
    subject.name = track->name;
    subject.driver = movement.driver;
    subject.key_count = movement.key_count;
    subject.movement = index;
    return subject;
}

/* Whether `name` is that of a thing's property: the thing, a dot, the property. */
static bool is_property_of(const zt_thing *thing, const zt_property *property,
                           const char *name) {
    size_t length = strlen(thing->name);
    return property->owner == thing->owner && strncmp(name, thing->name, length) == 0 &&
           name[length] == '.' && zt_text_equal(name + length + 1, property->name);
}

/* A property that does not move. Its name is the caller's, as long as nothing keeps it. */
static bool find_constant(zt_subject *subject, const zt_animation *animation,
                          const char *name) {
    for (int32_t i = 0; i < animation->thing_count; i++)
        for (int p = 0; p < zt_property_count; p++) {
            const zt_thing *thing = &animation->things[i];
            if (!is_property_of(thing, &zt_properties[p], name)) continue;
            *subject = subject_of(animation, &zt_properties[p], thing->index);
            subject->name = name;
            subject->driver = "constant";
            return true;
        }
    return false;
}

/* Shows all names of properties, moving or not. */
static void suggest(zt_nearest *nearest, char *room, size_t size,
                    const zt_animation *animation) {
    char name[256];
    for (int i = 0; i < animation->track_count; i++) {
        zt_nearest_try(nearest, animation->tracks[i].name);
    }
    for (int32_t i = 0; i < animation->thing_count; i++)
        for (int p = 0; p < zt_property_count; p++) {
            const zt_thing *thing = &animation->things[i];
            if (zt_properties[p].owner != thing->owner) continue;
            snprintf(name, sizeof name, "%s.%s", thing->name, zt_properties[p].name);
            zt_nearest_try(nearest, name);
            if (nearest->best != name) continue;
            snprintf(room, size, "%s", name); /* the next one is written over it */
            nearest->best = room;
        }
}

zt_status zt_subject_find(zt_subject *subject, const zt_animation *animation, const char *name,
                          zt_listener listener) {
    for (int i = 0; i < animation->track_count; i++)
        if (zt_text_equal(animation->tracks[i].name, name)) {
            *subject = zt_subject_of_movement(animation, i);
            return ZT_OK;
        }
    if (find_constant(subject, animation, name)) return ZT_OK;
    char room[256];
    zt_nearest nearest = zt_nearest_to(name);
    suggest(&nearest, room, sizeof room, animation);
    if (nearest.best)
        zt_tell(listener, ZT_ERROR, "nothing is called %s; did you mean %s?", name,
                nearest.best);
    else
        zt_tell(listener, ZT_ERROR, "nothing is called %s; zoetrope check lists what moves",
                name);
    return ZT_EARGUMENT;
}

static zt_subject_place public_place(const zt_place *place) {
    return (zt_subject_place){place->file, place->line, place->column};
}

zt_subject_place zt_subject_stands_at(const zt_subject *subject) {
    const zt_track *track = track_of(subject);
    if (track) return public_place(&track->place);
    for (int32_t i = 0; i < subject->film->thing_count; i++) {
        const zt_thing *thing = &subject->film->things[i];
        if (thing->owner == subject->property->owner && thing->index == subject->index)
            return public_place(&thing->place);
    }
    return (zt_subject_place){NULL, 0, 0};
}

/* What depends on other things is worked out with all of them. */
static zt_status eval_in_scene(double *value, const zt_subject *subject, double time_s,
                               zt_listener listener) {
    zt_arena arena = {0};
    zt_scene scene;
    zt_status status = zt_animation_freeze(&scene, subject->film, time_s, &arena, listener);
    if (status == ZT_OK) zt_property_get(value, subject->property, &scene, subject->index);
    zt_arena_free(&arena);
    return status;
}

zt_status zt_subject_eval(double *value, const zt_subject *subject, double time_s,
                          zt_listener listener) {
    const zt_track *track = track_of(subject);
    if (!track)
        zt_property_get(value, subject->property, &subject->film->rest, subject->index);
    else if (track->kind == ZT_TRACK_CURVE)
        zt_curve_eval(value, &track->curve, time_s);
    else
        ZT_TRY(eval_in_scene(value, subject, time_s, listener));
    to_written(value, subject);
    return ZT_OK;
}

/* ---- keys ----------------------------------------------------------------------------------
 */

static void write_bezier(char *text, size_t size, const zt_ease *ease) {
    static const struct {
        const char *word;
        double x1, y1, x2, y2;
    } named[] = {{"ease", 0.25, 0.1, 0.25, 1},
                 {"ease-in", 0.42, 0, 1, 1},
                 {"ease-out", 0, 0, 0.58, 1},
                 {"ease-in-out", 0.42, 0, 0.58, 1}};
    for (int i = 0; i < 4; i++)
        if (ease->x1 == named[i].x1 && ease->y1 == named[i].y1 && ease->x2 == named[i].x2 &&
            ease->y2 == named[i].y2) {
            snprintf(text, size, "%s", named[i].word);
            return;
        }
    snprintf(text, size, "cubic-bezier(%g, %g, %g, %g)", ease->x1, ease->y1, ease->x2,
             ease->y2);
}

/* An easing as a description writes it, but for the stops of linear(). */
static void write_ease(char *text, size_t size, const zt_ease *ease) {
    static const char *const families[] = {"sine", "quad", "cubic", "quart",   "quint",
                                           "expo", "circ", "back",  "elastic", "bounce"};
    static const char *const ways[] = {"in", "out", "in-out"};
    static const char *const jumps[] = {"jump-start", "jump-end", "jump-none", "jump-both"};
    switch (ease->kind) {
    case ZT_EASE_BEZIER:
        write_bezier(text, size, ease);
        break;
    case ZT_EASE_STEPS:
        snprintf(text, size, "steps(%d, %s)", ease->step_count, jumps[ease->jump]);
        break;
    case ZT_EASE_STOPS:
        snprintf(text, size, "linear() of %d stops", ease->stop_count);
        break;
    default:
        snprintf(text, size, "%s-%s", families[ease->kind - ZT_EASE_SINE], ways[ease->way]);
    }
}

zt_subject_key zt_subject_key_at(const zt_subject *subject, int key) {
    const zt_track *track = track_of(subject);
    const zt_curve *curve = &track->curve;
    zt_subject_key out = {.time_s = curve->times[key]};
    memcpy(out.value, curve->values + (int64_t)key * curve->width,
           (size_t)curve->width * sizeof *out.value);
    to_written(out.value, subject);
    if (curve->spring)
        out.way = "spring";
    else if (key + 1 < curve->key_count) {
        const zt_ease *ease = curve->eases ? curve->eases[key] : NULL;
        out.way = zt_curve_name((zt_curve_kind)curve->kinds[key]);
        if (ease) write_ease(out.ease, sizeof out.ease, ease);
    }
    if (track->key_places) out.place = public_place(&track->key_places[key]);
    return out;
}

/* ---- words ---------------------------------------------------------------------------------
 */

/* The angles around the fixed axes x, then y, then z, in degrees. Where y is a right angle, x
 * and z turn around the same axis, and all of it is z's. */
static void angles_of(double angles[3], const double *wxyz_values) {
    quat q = {wxyz_values[0], wxyz_values[1], wxyz_values[2], wxyz_values[3]};
    xform m = xform_place((vec3){0, 0, 0}, q, (vec3){1, 1, 1});
    double level = hypot(m.x.x, m.x.y);
    angles[1] = atan2(-m.x.z, level);
    angles[0] = level > 1e-9 ? atan2(m.y.z, m.z.z) : 0;
    angles[2] = level > 1e-9 ? atan2(m.x.y, m.x.x) : atan2(-m.y.x, m.y.y);
    for (int i = 0; i < 3; i++) {
        angles[i] *= 180 / 3.14159265358979323846;
        if (fabs(angles[i]) < 1e-9) angles[i] = 0; /* not -0, nor what rounding has left */
    }
}

zt_subject_words zt_subject_in_words(const zt_subject *subject, const double *value) {
    zt_subject_words words = {""};
    zt_value_kind kind = subject->property->kind;
    if (kind == ZT_VALUE_COLOR) {
        int bytes[3];
        for (int c = 0; c < 3; c++)
            bytes[c] = (int)lround(255 * zt_develop_value(value[c], ZT_VIEW_SRGB));
        snprintf(words.text, sizeof words.text, "#%02x%02x%02x", bytes[0], bytes[1], bytes[2]);
    } else if (kind == ZT_VALUE_ROTATION) {
        double angles[3];
        angles_of(angles, value);
        snprintf(words.text, sizeof words.text, "[%.6g, %.6g, %.6g] deg", angles[0], angles[1],
                 angles[2]);
    } else if (kind == ZT_VALUE_SWITCH)
        snprintf(words.text, sizeof words.text, "%s", *value >= 0.5 ? "true" : "false");
    return words;
}
