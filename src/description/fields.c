#include "description/fields.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- mappings -------------------------------------------------------------------------------
 */

static int name_index(const zt_fields *fields, const char *name) {
    for (int i = 0; i < fields->name_count; i++)
        if (zt_text_equal(fields->names[i], name)) return i;
    return -1;
}

static void tell_unknown(zt_fields *fields, zt_mistakes *mistakes, const zt_node *key) {
    zt_nearest nearest = zt_nearest_to(key->text);
    for (int i = 0; i < fields->name_count && !zt_mistakes_full(mistakes); i++)
        zt_nearest_try(&nearest, fields->names[i]);
    if (nearest.best) fields->suggested |= UINT32_C(1) << name_index(fields, nearest.best);
    zt_mistake(mistakes, &key->place, "unknown key \"%s\"%s", zt_show(key->text).text,
               zt_suggest(&nearest).text);
}

bool zt_fields_open(zt_fields *fields, zt_mistakes *mistakes, const zt_node *node,
                    const char *what, const char *const *names, int name_count) {
    *fields = (zt_fields){.mapping = node, .names = names, .name_count = name_count};
    if (node->kind != ZT_NODE_MAPPING) {
        zt_expected(mistakes, node, what, "a mapping of keys to values");
        return false;
    }
    for (int32_t i = 0; i < node->count; i++)
        if (name_index(fields, zt_node_key(node, i)->text) < 0)
            tell_unknown(fields, mistakes, zt_node_key(node, i));
    return true;
}

const zt_node *zt_field(const zt_fields *fields, const char *name) {
    for (int32_t i = 0; i < fields->mapping->count; i++)
        if (zt_text_equal(zt_node_key(fields->mapping, i)->text, name))
            return zt_node_value(fields->mapping, i);
    return NULL;
}

const zt_node *zt_field_required(const zt_fields *fields, zt_mistakes *mistakes,
                                 const char *name, const zt_place *place) {
    const zt_node *value = zt_field(fields, name);
    bool suggested = fields->suggested >> name_index(fields, name) & 1;
    if (!value && !suggested) zt_mistake(mistakes, place, "\"%s\" is missing", name);
    return value;
}

void zt_expected(zt_mistakes *mistakes, const zt_node *node, const char *what,
                 const char *expected) {
    if (zt_node_empty(node))
        zt_mistake(mistakes, &node->place, "\"%s\" is empty; it must be %s", what, expected);
    else if (node->kind == ZT_NODE_TEXT)
        zt_mistake(mistakes, &node->place, "\"%s\" must be %s, not %s\"%s\"", what, expected,
                   node->quoted ? "the text " : "", zt_show(node->text).text);
    else if (node->kind == ZT_NODE_LIST)
        zt_mistake(mistakes, &node->place, "\"%s\" must be %s, not a list of %d", what,
                   expected, (int)node->count);
    else if (node->kind == ZT_NODE_MAPPING)
        zt_mistake(mistakes, &node->place, "\"%s\" must be %s, not %s", what, expected,
                   node->count ? "a mapping" : "an empty mapping");
}

/* ---- numbers --------------------------------------------------------------------------------
 */

/* Whether `value` is in range; the node's own words are shown when it is not. */
static bool in_range(zt_mistakes *mistakes, const zt_node *node, const char *what, double value,
                     zt_range range) {
    if (value >= range.min && value <= range.max) return true;
    char limits[80];
    if (isinf(range.max))
        snprintf(limits, sizeof limits, "at least %.10g", range.min);
    else if (isinf(range.min))
        snprintf(limits, sizeof limits, "at most %.10g", range.max);
    else
        snprintf(limits, sizeof limits, "between %.10g and %.10g", range.min, range.max);
    zt_mistake(mistakes, &node->place, "\"%s\" is %s; it must be %s%s%s", what,
               zt_show(node->text).text, limits, range.unit ? " " : "",
               range.unit ? range.unit : "");
    return false;
}

/* Where the number that a text begins with ends: its "e" belongs to it only before digits. */
static const char *number_end(const char *text) {
    text += strspn(text, "+-.0123456789");
    if (*text != 'e' && *text != 'E') return text;
    const char *digits = text + 1 + (text[1] == '+' || text[1] == '-');
    return isdigit((unsigned char)*digits) ? digits + strspn(digits, "0123456789") : text;
}

bool zt_read_quantity(double *number, const char **unit, const zt_node *node) {
    if (node->kind != ZT_NODE_TEXT) return false;
    const char *end = number_end(node->text);
    *unit = end + strspn(end, " ");
    return zt_text_number(number, node->text, end);
}

/* A number without quotes and nothing behind it. */
static bool plain_number(double *value, const zt_node *node) {
    return node->kind == ZT_NODE_TEXT && !node->quoted &&
           zt_text_number(value, node->text, node->text + strlen(node->text));
}

/* "50 mm", where that is the unit. */
static bool number_with_unit(double *value, const zt_node *node, const char *unit) {
    const char *written;
    return unit && zt_read_quantity(value, &written, node) && zt_text_equal(written, unit);
}

bool zt_read_number(double *value, zt_mistakes *mistakes, const zt_node *node, const char *what,
                    zt_range range) {
    if (plain_number(value, node) || number_with_unit(value, node, range.unit))
        return in_range(mistakes, node, what, *value, range);
    char expected[48] = "a number";
    if (range.unit) snprintf(expected, sizeof expected, "a number, of %s", range.unit);
    zt_expected(mistakes, node, what, expected);
    return false;
}

bool zt_read_integer(int64_t *value, zt_mistakes *mistakes, const zt_node *node,
                     const char *what, int64_t min, int64_t max) {
    double number;
    if (!plain_number(&number, node) || number != floor(number)) {
        zt_expected(mistakes, node, what, "a whole number");
        return false;
    }
    zt_range range = {(double)min, (double)max, NULL};
    if (!in_range(mistakes, node, what, number, range)) return false;
    *value = (int64_t)number;
    return true;
}

bool zt_read_angle(double *radians, zt_mistakes *mistakes, const zt_node *node,
                   const char *what, zt_range range) {
    static const double radian = 3.14159265358979323846 / 180; /* in a degree */
    double number;
    const char *unit;
    bool rad = false;
    bool read = zt_read_quantity(&number, &unit, node);
    if (read) rad = zt_text_equal(unit, "rad");
    if (!read || (*unit ? !rad && !zt_text_equal(unit, "deg") : node->quoted)) {
        zt_expected(mistakes, node, what, "an angle such as 40, 40 deg or 0.7 rad");
        return false;
    }
    *radians = rad ? number : number * radian;
    return in_range(mistakes, node, what, rad ? number / radian : number, range);
}

typedef bool number_reader(double *value, zt_mistakes *mistakes, const zt_node *node,
                           const char *what, zt_range range);

static bool read_list(double *value, int count, zt_mistakes *mistakes, const zt_node *node,
                      const char *what, zt_range range, const char *kind, number_reader *read) {
    char expected[48];
    snprintf(expected, sizeof expected, "a list of %d %s", count, kind);
    if (node->kind != ZT_NODE_LIST || node->count != count) {
        zt_expected(mistakes, node, what, expected);
        return false;
    }
    bool good = true;
    for (int i = 0; i < count; i++) {
        const zt_node *item = node->items[i];
        double number;
        const char *unit;
        if (zt_read_quantity(&number, &unit, item)) {
            good &= read(&value[i], mistakes, item, what, range);
            continue;
        }
        good = false;
        if (item->kind != ZT_NODE_MISTAKE)
            zt_mistake(mistakes, &item->place, "\"%s\" must be %s, and this is none", what,
                       expected);
    }
    return good;
}

bool zt_read_numbers(double *value, int count, zt_mistakes *mistakes, const zt_node *node,
                     const char *what, zt_range range) {
    return read_list(value, count, mistakes, node, what, range, "numbers", zt_read_number);
}

bool zt_read_angles(double radians[3], zt_mistakes *mistakes, const zt_node *node,
                    const char *what, zt_range range) {
    return read_list(radians, 3, mistakes, node, what, range, "angles", zt_read_angle);
}

/* ---- words ----------------------------------------------------------------------------------
 */

const char *zt_read_text(zt_mistakes *mistakes, const zt_node *node, const char *what) {
    if (node->kind == ZT_NODE_TEXT && !zt_node_empty(node) && *node->text) return node->text;
    zt_expected(mistakes, node, what, "a text");
    return NULL;
}

bool zt_read_choice(int *index, zt_mistakes *mistakes, const zt_node *node, const char *what,
                    const char *const *choices, int choice_count) {
    char expected[128] = "";
    zt_nearest nearest = zt_nearest_to(node->kind == ZT_NODE_TEXT ? node->text : "");
    for (int i = 0; i < choice_count; i++) {
        if (node->kind == ZT_NODE_TEXT && zt_text_equal(node->text, choices[i])) {
            *index = i;
            return true;
        }
        zt_nearest_try(&nearest, choices[i]);
        size_t used = strlen(expected);
        snprintf(expected + used, sizeof expected - used, "%s%s",
                 i == 0                  ? ""
                 : i == choice_count - 1 ? " or "
                                         : ", ",
                 choices[i]);
    }
    if (nearest.best)
        zt_mistake(mistakes, &node->place, "\"%s\" must be %s, not \"%s\"%s", what, expected,
                   zt_show(node->text).text, zt_suggest(&nearest).text);
    else
        zt_expected(mistakes, node, what, expected);
    return false;
}

bool zt_read_switch(double *value, zt_mistakes *mistakes, const zt_node *node,
                    const char *what) {
    static const char *const words[] = {"false", "true", "off", "on", "no", "yes"};
    for (int i = 0; i < 6; i++)
        if (node->kind == ZT_NODE_TEXT && !node->quoted &&
            zt_text_equal(node->text, words[i])) {
            *value = i % 2;
            return true;
        }
    zt_expected(mistakes, node, what, "true or false");
    return false;
}
