#include "description/rotations.h"

#define COUNT(array) (int)(sizeof(array) / sizeof *(array))

/* The ways to write a rotation as a mapping: keys of the first kind are required. */
enum { EULER, AXIS, QUATERNION, DIRECTION, FORM_COUNT };
static const char *const names[] = {"euler",      "order",     "axis", "angle",
                                    "quaternion", "direction", "up"};
static const struct {
    int first, count; /* of its names */
} forms[FORM_COUNT] = {{0, 2}, {2, 2}, {4, 1}, {5, 2}};

/* The form that a mapping's keys belong to, or FORM_COUNT. */
static int form_of(const zt_node *mapping) {
    for (int form = 0; form < FORM_COUNT; form++)
        for (int i = 0; i < forms[form].count; i++)
            if (zt_field(&(zt_fields){.mapping = mapping}, names[forms[form].first + i]))
                return form;
    return FORM_COUNT;
}

/* Whether there are no keys of other forms. */
static bool is_of_form(zt_mistakes *mistakes, const zt_fields *fields, int form) {
    int first = forms[form].first, end = first + forms[form].count;
    for (int i = end; i < COUNT(names); i++) {
        const zt_node *other = zt_field(fields, names[i]);
        if (!other) continue;
        zt_mistake(mistakes, &other->place, "\"%s\" cannot stand beside \"%s\"", names[i],
                   zt_field(fields, names[first]) ? names[first] : names[first + 1]);
        return false;
    }
    return true;
}

bool zt_is_rotation(const zt_node *mapping) { return form_of(mapping) < FORM_COUNT; }

/* Turns around the fixed axes, one after the other. */
static void set_angles(zt_written_rotation *rotation, const double angles[3],
                       const char *order) {
    vec3 v = {angles[0], angles[1], angles[2]};
    rotation->rotation = zt_rotation_euler(v, order);
    bool one_axis = (v.x != 0) + (v.y != 0) + (v.z != 0) <= 1;
    rotation->turn = one_axis ? v : vec3_scale(zt_rotation_log(rotation->rotation), 2);
}

static bool is_zero(const double *numbers, int count, zt_mistakes *mistakes,
                    const zt_node *node, const char *what) {
    for (int i = 0; i < count; i++)
        if (numbers[i] != 0) return false;
    zt_mistake(mistakes, &node->place, "\"%s\" must not be zero", what);
    return true;
}

static bool read_euler(zt_written_rotation *rotation, zt_mistakes *mistakes,
                       const zt_fields *fields, zt_range range) {
    const zt_node *euler =
                      zt_field_required(fields, mistakes, "euler", &fields->mapping->place),
                  *node = zt_field(fields, "order");
    double angles[3];
    const char *order = node ? zt_read_text(mistakes, node, "order") : "xyz";
    if (!euler || !zt_read_angles(angles, mistakes, euler, "euler", range) || !order)
        return false;
    if (!zt_rotation_order_is_sound(order)) {
        zt_expected(mistakes, node, "order", "the letters x, y and z, the first turn first");
        return false;
    }
    set_angles(rotation, angles, order);
    return true;
}

static bool read_axis(zt_written_rotation *rotation, zt_mistakes *mistakes,
                      const zt_fields *fields, zt_range range) {
    const zt_node *axis = zt_field_required(fields, mistakes, "axis", &fields->mapping->place),
                  *turn = zt_field_required(fields, mistakes, "angle", &fields->mapping->place);
    double v[3], angle;
    bool read = axis && zt_read_numbers(v, 3, mistakes, axis, "axis", zt_any_number);
    if (!turn || !zt_read_angle(&angle, mistakes, turn, "angle", range) || !read ||
        is_zero(v, 3, mistakes, axis, "axis"))
        return false;
    vec3 unit = vec3_normalize((vec3){v[0], v[1], v[2]});
    rotation->turn = vec3_scale(unit, angle);
    rotation->rotation = zt_rotation_unit(quat_axis_angle(unit, angle));
    rotation->has_axis = true;
    return true;
}

static bool read_quaternion(zt_written_rotation *rotation, zt_mistakes *mistakes,
                            const zt_fields *fields) {
    const zt_node *node = zt_field(fields, "quaternion");
    double q[4];
    if (!zt_read_numbers(q, 4, mistakes, node, "quaternion", zt_any_number) ||
        is_zero(q, 4, mistakes, node, "quaternion"))
        return false;
    rotation->rotation = zt_rotation_unit((quat){q[0], q[1], q[2], q[3]});
    rotation->turn = vec3_scale(zt_rotation_log(rotation->rotation), 2);
    return true;
}

static bool read_direction(zt_written_rotation *rotation, zt_mistakes *mistakes,
                           const zt_fields *fields) {
    const zt_node *direction =
                      zt_field_required(fields, mistakes, "direction", &fields->mapping->place),
                  *up = zt_field(fields, "up");
    double d[3], u[3] = {0, 1, 0};
    bool read = direction &&
                zt_read_numbers(d, 3, mistakes, direction, "direction", zt_any_number) &&
                !is_zero(d, 3, mistakes, direction, "direction");
    if (up && (!zt_read_numbers(u, 3, mistakes, up, "up", zt_any_number) ||
               is_zero(u, 3, mistakes, up, "up")))
        return false;
    if (!read) return false;
    rotation->rotation =
        zt_rotation_look((vec3){d[0], d[1], d[2]}, (vec3){u[0], u[1], u[2]}, 0);
    rotation->turn = vec3_scale(zt_rotation_log(rotation->rotation), 2);
    return true;
}

bool zt_read_rotation(zt_written_rotation *rotation, zt_mistakes *mistakes, const zt_node *node,
                      const char *what, zt_range range) {
    *rotation = (zt_written_rotation){.rotation = {1, 0, 0, 0}};
    if (node->kind != ZT_NODE_MAPPING) {
        double angles[3];
        if (!zt_read_angles(angles, mistakes, node, what, range)) return false;
        set_angles(rotation, angles, "xyz");
        return true;
    }
    int form = form_of(node);
    zt_fields fields;
    zt_fields_open(&fields, mistakes, node, what, names, COUNT(names));
    if (form == FORM_COUNT) {
        zt_mistake(mistakes, &node->place,
                   "\"%s\" must be a list of 3 angles, or have an axis and an angle, euler, "
                   "quaternion or direction",
                   what);
        return false;
    }
    if (!is_of_form(mistakes, &fields, form)) return false;
    switch (form) {
    case EULER:
        return read_euler(rotation, mistakes, &fields, range);
    case AXIS:
        return read_axis(rotation, mistakes, &fields, range);
    case QUATERNION:
        return read_quaternion(rotation, mistakes, &fields);
    default:
        return read_direction(rotation, mistakes, &fields);
    }
}
