#include "description/constraints.h"

#include "description/curves.h"
#include "description/formulas.h"
#include "description/motion.h"
#include "description/times.h"
#include "description/trial.h"
#include "description/values.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

/* A track that is complete but for what a name means. */
typedef struct zt_pending {
    zt_track track;
    int32_t position;     /* among the animation's tracks */
    const zt_node *named; /* the thing, the property or the expression; NULL for none */
    const zt_node *by;    /* of "offset", or NULL */
    struct zt_pending *next;
} pending;

static zt_status keep(zt_reading *reading, const pending *read, const char *thing) {
    pending *p = ZT_PUSH(reading->temporary, pending, 1);
    if (!p) return ZT_EMEMORY;
    *p = *read;
    p->position = reading->animation->track_count;
    if (reading->last_pending)
        reading->last_pending->next = p;
    else
        reading->first_pending = p;
    reading->last_pending = p;
    return zt_motion_add(reading, &p->track, thing);
}

/* ---- parts ----------------------------------------------------------------------------------
 */

/* A point, or the name of a thing, which is looked up later. */
static bool read_anchor(zt_anchor *anchor, pending *p, zt_mistakes *mistakes,
                        const zt_node *node, const char *what) {
    double point[3];
    if (node->kind == ZT_NODE_TEXT && !zt_node_empty(node)) {
        p->named = node;
        return true;
    }
    if (node->kind != ZT_NODE_LIST) {
        zt_expected(mistakes, node, what, "a point [x, y, z] or a thing's name");
        return false;
    }
    if (!zt_read_numbers(point, 3, mistakes, node, what, zt_any_number)) return false;
    anchor->point = (vec3){point[0], point[1], point[2]};
    return true;
}

/* A direction, of unit length; `usual` where nothing is said. */
static bool read_direction(vec3 *direction, zt_mistakes *mistakes, const zt_node *node,
                           const char *what, vec3 usual) {
    double v[3];
    *direction = usual;
    if (!node) return true;
    if (!zt_read_numbers(v, 3, mistakes, node, what, zt_any_number)) return false;
    *direction = vec3_normalize((vec3){v[0], v[1], v[2]});
    if (vec3_max_abs(*direction) > 0) return true;
    zt_mistake(mistakes, &node->place, "\"%s\" must not be zero", what);
    return false;
}

static const vec3 upwards = {0, 1, 0};

static bool is_of_kind(const zt_track *track, zt_mistakes *mistakes, const zt_node *node,
                       const char *word, zt_value_kind kind) {
    if (track->property->kind == kind) return true;
    zt_mistake(mistakes, &node->place, "\"%s\" gives %s, and \"%s\" is none", word,
               kind == ZT_VALUE_ROTATION ? "a rotation" : "a place", track->property->name);
    return false;
}

/* ---- orbit ----------------------------------------------------------------------------------
 */

static bool read_period(double *period_s, zt_reading *reading, const zt_node *node) {
    zt_mistakes *mistakes = &reading->mistakes;
    if (!zt_read_time(period_s, mistakes, node, "period", &reading->animation->film))
        return false;
    if (*period_s != 0) return true;
    zt_mistake(mistakes, &node->place, "\"period\" must not be zero");
    return false;
}

static bool read_orbit(pending *p, zt_reading *reading, const zt_node *node) {
    static const char *const names[] = {"around", "radius", "axis", "period", "phase"};
    zt_mistakes *mistakes = &reading->mistakes;
    zt_fields fields;
    zt_orbit *orbit = &p->track.orbit;
    p->track.kind = ZT_TRACK_ORBIT;
    if (!zt_fields_open(&fields, mistakes, node, "orbit", names, COUNT(names))) return false;
    const zt_node *around = zt_field_required(&fields, mistakes, "around", &node->place),
                  *radius = zt_field_required(&fields, mistakes, "radius", &node->place),
                  *period = zt_field_required(&fields, mistakes, "period", &node->place),
                  *axis = zt_field(&fields, "axis"), *phase = zt_field(&fields, "phase");
    const zt_range not_negative = {0, INFINITY, NULL};
    bool good = around && radius && period;
    if (around) good &= read_anchor(&orbit->around, p, mistakes, around, "around");
    if (radius)
        good &= zt_read_number(&orbit->radius, mistakes, radius, "radius", not_negative);
    if (period) good &= read_period(&orbit->period_s, reading, period);
    if (phase) good &= zt_read_angle(&orbit->phase, mistakes, phase, "phase", zt_any_number);
    return read_direction(&orbit->axis, mistakes, axis, "axis", upwards) && good;
}

/* ---- follow ---------------------------------------------------------------------------------
 */

/* The points of a path; *good is false where they cannot be one. */
static zt_status read_points(zt_path *path, bool *good, zt_reading *reading,
                             const zt_node *node, bool closed) {
    zt_mistakes *mistakes = &reading->mistakes;
    *good = node->kind == ZT_NODE_LIST && node->count >= (closed ? 3 : 2);
    if (!*good) {
        zt_expected(mistakes, node, "path",
                    closed ? "a list of at least 3 points" : "a list of at least 2 points");
        return ZT_OK;
    }
    vec3 *points = ZT_PUSH(&reading->animation->arena, vec3, (size_t)node->count);
    if (!points) return ZT_EMEMORY;
    for (int32_t i = 0; i < node->count; i++) {
        double v[3];
        *good &= zt_read_numbers(v, 3, mistakes, node->items[i], "point", zt_any_number);
        if (*good) points[i] = (vec3){v[0], v[1], v[2]};
    }
    if (!*good) return ZT_OK;
    return zt_path_through(path, &reading->animation->arena, points, node->count, closed);
}

/* The path that a named set of keys goes, whatever their times. */
static zt_status read_named_path(zt_path *path, bool *good, zt_reading *reading,
                                 const zt_node *node, const zt_property *property) {
    zt_track *shape = ZT_PUSH(&reading->animation->arena, zt_track, 1);
    if (!shape) return ZT_EMEMORY;
    shape->property = property;
    ZT_TRY(zt_curve_use(shape, good, reading, node));
    return *good ? zt_path_make(path, &reading->animation->arena, &shape->curve) : ZT_OK;
}

static zt_status read_path(zt_follow *follow, bool *good, zt_reading *reading,
                           const zt_fields *fields, const zt_property *property) {
    zt_mistakes *mistakes = &reading->mistakes;
    const zt_node *path = zt_field(fields, "path"), *use = zt_field(fields, "use"),
                  *closed = zt_field(fields, "closed"), *node = path ? path : use;
    double is_closed = 0;
    zt_path *own = ZT_PUSH(&reading->animation->arena, zt_path, 1);
    if (!own) return ZT_EMEMORY;
    follow->path = own;
    *good = !closed || zt_read_switch(&is_closed, mistakes, closed, "closed");
    if (!path == !use || (use && closed)) {
        zt_mistake(mistakes, &fields->mapping->place,
                   path  ? "\"follow\" has either \"path\" or \"use\""
                   : use ? "whether it is closed is for the keys of \"use\" to say"
                         : "\"path\" is missing");
        *good = false;
    }
    if (!*good) return ZT_OK;
    zt_status status = path ? read_points(own, good, reading, path, is_closed != 0)
                            : read_named_path(own, good, reading, use, property);
    if (status != ZT_EARGUMENT) return status;
    zt_mistake(mistakes, &node->place, "this is no path: it needs two points, and a length");
    *good = false;
    return ZT_OK;
}

static zt_status read_course(zt_follow *follow, bool *good, zt_reading *reading,
                             const zt_fields *fields) {
    zt_mistakes *mistakes = &reading->mistakes;
    const zt_film *film = &reading->animation->film;
    const zt_node *from = zt_field(fields, "from"), *to = zt_field(fields, "to"),
                  *ease = zt_field(fields, "ease");
    *good = true;
    follow->to_s = zt_rate_time(film->rate, film->frame_count);
    if (from) *good &= zt_read_time(&follow->from_s, mistakes, from, "from", film);
    if (to) *good &= zt_read_time(&follow->to_s, mistakes, to, "to", film);
    if (*good && !(follow->to_s > follow->from_s)) {
        zt_mistake(mistakes, to ? &to->place : &from->place, "\"to\" must be after \"from\"");
        *good = false;
    }
    bool ease_good = true;
    if (ease) ZT_TRY(zt_read_ease(&follow->ease, &ease_good, reading, ease, "ease"));
    *good &= ease_good;
    return ZT_OK;
}

/* "orient", with "up" and "bank": a second track, for the rotation. */
static zt_status read_orient(zt_reading *reading, const zt_fields *fields, const pending *p,
                             const char *thing) {
    zt_mistakes *mistakes = &reading->mistakes;
    const zt_node *orient = zt_field(fields, "orient"), *bank = zt_field(fields, "bank"),
                  *up = zt_field(fields, "up");
    zt_owner owner = p->track.property->owner;
    pending rotation = *p;
    double is_oriented = 0;
    bool good = read_direction(&rotation.track.follow.up, mistakes, up, "up", upwards);
    if (orient) good &= zt_read_switch(&is_oriented, mistakes, orient, "orient");
    if (bank)
        good &= zt_read_angle(&rotation.track.follow.bank, mistakes, bank, "bank",
                              (zt_range){-180, 180, "deg"});
    if (!good) return ZT_OK;
    if (!orient || is_oriented == 0) {
        if (bank || up)
            zt_mistake(mistakes, bank ? &bank->place : &up->place,
                       "\"%s\" is for \"orient: true\"", bank ? "bank" : "up");
        return ZT_OK;
    }
    rotation.track.property = zt_property_find(owner, "rotation");
    if (!rotation.track.property || p->track.property != zt_place_property(owner)) {
        zt_mistake(mistakes, &orient->place,
                   "there is no rotation that goes with \"%s\" of a %s",
                   p->track.property->name, zt_owner_name(owner));
        return ZT_OK;
    }
    rotation.track.place = orient->place;
    reading->oriented = (zt_reference){rotation.track.property, p->track.index};
    return keep(reading, &rotation, thing);
}

static zt_status read_follow(pending *p, zt_reading *reading, const zt_node *node,
                             const char *thing) {
    static const char *const names[] = {"path",   "use",    "from", "to", "ease",
                                        "closed", "orient", "bank", "up"};
    zt_fields fields;
    bool path_good, course_good;
    p->track.kind = ZT_TRACK_FOLLOW;
    if (!zt_fields_open(&fields, &reading->mistakes, node, "follow", names, COUNT(names)))
        return ZT_OK;
    ZT_TRY(read_path(&p->track.follow, &path_good, reading, &fields, p->track.property));
    ZT_TRY(read_course(&p->track.follow, &course_good, reading, &fields));
    if (!path_good || !course_good) return ZT_OK;
    ZT_TRY(keep(reading, p, thing));
    return read_orient(reading, &fields, p, thing);
}

/* ---- the others -----------------------------------------------------------------------------
 */

static bool read_offset(pending *p, zt_reading *reading, const zt_node *node) {
    static const char *const names[] = {"from", "by"};
    zt_mistakes *mistakes = &reading->mistakes;
    zt_fields fields;
    p->track.kind = ZT_TRACK_OFFSET;
    if (!zt_fields_open(&fields, mistakes, node, "offset", names, COUNT(names))) return false;
    p->named = zt_field_required(&fields, mistakes, "from", &node->place);
    p->by = zt_field(&fields, "by");
    return p->named != NULL;
}

/* `fields` are those beside "look_at". */
static bool read_look_at(pending *p, zt_reading *reading, const zt_node *node,
                         const zt_fields *fields) {
    zt_mistakes *mistakes = &reading->mistakes;
    zt_look_at *look_at = &p->track.look_at;
    const zt_node *roll = zt_field(fields, "roll");
    zt_owner owner = p->track.property->owner;
    p->track.kind = ZT_TRACK_LOOK_AT;
    look_at->from = (zt_reference){zt_place_property(owner), p->track.index};
    bool good = read_anchor(&look_at->target, p, mistakes, node, "look_at");
    if (roll) good &= zt_read_angle(&look_at->roll, mistakes, roll, "roll", zt_any_number);
    return read_direction(&look_at->up, mistakes, zt_field(fields, "up"), "up", upwards) &&
           good;
}

/* A point that a camera turns to, or focuses on, by the name of the thing that is there. */
static bool is_name_of_point(const zt_node *node, const zt_property *property) {
    return node->kind == ZT_NODE_TEXT && !zt_node_empty(node) &&
           (property == zt_property_find(ZT_OWNER_CAMERA, "look_at") ||
            property == zt_property_find(ZT_OWNER_CAMERA, "focus_on"));
}

/* The words for them, each before what may stand beside it. */
enum { FOLLOW, ORBIT, OFFSET, LOOK_AT, WORD_COUNT };
static const struct {
    const char *names[3];
    int name_count;
} words[WORD_COUNT] = {[FOLLOW] = {{"follow"}, 1},
                       [ORBIT] = {{"orbit"}, 1},
                       [OFFSET] = {{"offset"}, 1},
                       [LOOK_AT] = {{"look_at", "roll", "up"}, 3}};

/* What a mapping with one of the words says by it; NULL where it has none. */
static const zt_node *find_word(int *word, const zt_node *node) {
    const zt_node *value = NULL;
    for (*word = 0; *word < WORD_COUNT && node->kind == ZT_NODE_MAPPING; ++*word) {
        value = zt_field(&(zt_fields){.mapping = node}, words[*word].names[0]);
        if (value) break;
    }
    return value;
}

static zt_status read_mapping(pending *p, zt_reading *reading, const zt_node *node, int word,
                              const zt_node *value, const char *thing) {
    zt_mistakes *mistakes = &reading->mistakes;
    const char *const *names = words[word].names;
    zt_value_kind kind = word == LOOK_AT ? ZT_VALUE_ROTATION : ZT_VALUE_VECTOR;
    zt_fields fields;
    zt_fields_open(&fields, mistakes, node, p->track.property->name, names,
                   words[word].name_count);
    if (word != OFFSET && !is_of_kind(&p->track, mistakes, node, names[0], kind)) return ZT_OK;
    if (word == FOLLOW) return read_follow(p, reading, value, thing);
    bool good = word == ORBIT    ? read_orbit(p, reading, value)
                : word == OFFSET ? read_offset(p, reading, value)
                                 : read_look_at(p, reading, value, &fields);
    return good ? keep(reading, p, thing) : ZT_OK;
}

/* Whether a path turns what this property would turn as well, which is told. */
static bool is_turned_twice(zt_reading *reading, const zt_node *node,
                            const zt_property *property, int32_t index) {
    const zt_property *turned = reading->oriented.property;
    if (!turned || turned->owner != property->owner || reading->oriented.index != index)
        return false;
    if (property != turned && property != zt_property_find(ZT_OWNER_CAMERA, "look_at"))
        return false;
    zt_mistake(&reading->mistakes, &node->place,
               "\"%s\" stands beside a path with \"orient: true\", which turns it already",
               property->name);
    return true;
}

zt_status zt_constraint_read(bool *taken, zt_reading *reading, const zt_node *node,
                             const zt_property *property, int32_t index, const char *thing) {
    pending p = {.track = {.property = property, .index = index, .place = node->place}};
    int word;
    const zt_node *value = find_word(&word, node);
    bool formula = node->kind == ZT_NODE_TEXT && node->text[0] == '=';
    bool point = is_name_of_point(node, property);
    bool twice = is_turned_twice(reading, node, property, index);
    *taken = twice || value || formula || point;
    if (!*taken || twice) return ZT_OK;
    if (value) return read_mapping(&p, reading, node, word, value, thing);
    p.named = node;
    p.track.kind = formula ? ZT_TRACK_FORMULA : ZT_TRACK_LOOK_AT;
    return keep(reading, &p, thing);
}

/* ---- names ----------------------------------------------------------------------------------
 */

static void close_offset(pending *p, zt_reading *reading) {
    zt_mistakes *mistakes = &reading->mistakes;
    const zt_property *own = p->track.property;
    zt_offset *offset = &p->track.offset;
    if (!zt_read_property(&offset->from, reading, p->named, "from")) return;
    zt_value_kind kind = offset->from.property->kind;
    if (kind != own->kind) {
        zt_mistake(mistakes, &p->named->place, "\"%s\" is of another kind than \"%s\"",
                   zt_show(p->named->text).text, own->name);
    } else if (kind == ZT_VALUE_ROTATION) {
        offset->by[0] = 1;
        if (p->by) zt_read_value(offset->by, mistakes, p->by, own);
    } else if (kind == ZT_VALUE_SWITCH && p->by)
        zt_mistake(mistakes, &p->by->place, "nothing can be added to true and false");
    else if (p->by)
        zt_read_difference(offset->by, mistakes, p->by, "by", kind);
}

static zt_status close_pending(pending *p, zt_reading *reading) {
    zt_track *track = &p->track;
    switch (p->named ? track->kind : ZT_TRACK_CURVE) {
    case ZT_TRACK_FORMULA:
        return zt_formula_read(&track->formula, reading, p->named, track->property);
    case ZT_TRACK_ORBIT:
        zt_read_place(&track->orbit.around.thing, reading, p->named, "around");
        break;
    case ZT_TRACK_LOOK_AT:
        zt_read_place(&track->look_at.target.thing, reading, p->named, track->property->name);
        break;
    case ZT_TRACK_OFFSET:
        close_offset(p, reading);
        break;
    case ZT_TRACK_CURVE:
    case ZT_TRACK_FOLLOW:
    case ZT_TRACK_KIND_COUNT:
        break;
    }
    return ZT_OK;
}

zt_status zt_constraints_close(zt_reading *reading) {
    zt_animation *animation = reading->animation;
    ZT_TRY(zt_things_close(reading));
    if (!reading->first_pending) return ZT_OK;
    zt_track *tracks = (zt_track *)animation->tracks; /* of the reading until it ends */
    for (pending *p = reading->first_pending; p; p = p->next) {
        ZT_TRY(close_pending(p, reading));
        p->track.name = tracks[p->position].name;
        tracks[p->position] = p->track;
    }
    return zt_trial(reading);
}
