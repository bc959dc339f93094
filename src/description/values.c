#include "description/values.h"

#include <string.h>

#include "description/colors.h"
#include "description/rotations.h"

zt_range zt_property_range(const zt_property *property) {
    return (zt_range){property->min, property->max, property->unit};
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
        good &=
            three && zt_read_numbers(value + 3 * (ptrdiff_t)i, 3, mistakes, point, what, range);
    }
    return good;
}

/* One number for all three, or a list of them. */
static bool read_scale(double value[3], zt_mistakes *mistakes, const zt_node *node,
                       const char *what, zt_range range) {
    if (node->kind != ZT_NODE_TEXT)
        return zt_read_numbers(value, 3, mistakes, node, what, range);
    if (!zt_read_number(value, mistakes, node, what, range)) return false;
    value[1] = value[2] = value[0];
    return true;
}

/* What is made of numbers, the same for values and for differences of them. */
static bool read_made_of_numbers(double *value, zt_mistakes *mistakes, const zt_node *node,
                                 const char *what, zt_value_kind kind, zt_range range) {
    switch (kind) {
    case ZT_VALUE_NUMBER:
        return zt_read_number(value, mistakes, node, what, range);
    case ZT_VALUE_ANGLE:
        return zt_read_angle(value, mistakes, node, what, range);
    case ZT_VALUE_VECTOR:
    case ZT_VALUE_COLOR:
        return zt_read_numbers(value, 3, mistakes, node, what, range);
    case ZT_VALUE_SCALE:
        return read_scale(value, mistakes, node, what, range);
    case ZT_VALUE_VERTICES:
        return read_vertices(value, mistakes, node, what, range);
    case ZT_VALUE_ROTATION:
    case ZT_VALUE_SWITCH:
        break;
    }
    return false;
}

/* Whether a vector may be what a property says. */
static bool is_allowed(const double value[3], zt_mistakes *mistakes, const zt_node *node,
                       const zt_property *property) {
    bool direction = (property->flags & ZT_PROPERTY_DIRECTION) != 0;
    if (!direction || value[0] != 0 || value[1] != 0 || value[2] != 0) return true;
    zt_mistake(mistakes, &node->place, "\"%s\" must not be zero", property->name);
    return false;
}

bool zt_read_value(double *value, zt_mistakes *mistakes, const zt_node *node,
                   const zt_property *property) {
    const char *what = property->name;
    zt_range range = zt_property_range(property);
    zt_written_rotation rotation;
    switch (property->kind) {
    case ZT_VALUE_COLOR:
        return zt_read_color(value, mistakes, node, what, range);
    case ZT_VALUE_SWITCH:
        return zt_read_switch(value, mistakes, node, what);
    case ZT_VALUE_ROTATION:
        if (!zt_read_rotation(&rotation, mistakes, node, what, range)) return false;
        memcpy(value, &rotation.rotation, sizeof rotation.rotation);
        return true;
    default:
        return read_made_of_numbers(value, mistakes, node, what, property->kind, range) &&
               is_allowed(value, mistakes, node, property);
    }
}

bool zt_read_difference(double *value, zt_mistakes *mistakes, const zt_node *node,
                        const char *what, zt_value_kind kind) {
    return read_made_of_numbers(value, mistakes, node, what, kind, zt_any_number);
}
