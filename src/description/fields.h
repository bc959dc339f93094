/* Values of one kind each, read from nodes: what is wrong with them is told where it stands.
 * All readers return whether they could read; `what` is the key that the value belongs to. */
#ifndef ZT_DESCRIPTION_FIELDS_H
#define ZT_DESCRIPTION_FIELDS_H

#include <math.h>

#include "description/mistakes.h"
#include "description/node.h"

/* A mapping whose keys are known. */
typedef struct zt_fields {
    const zt_node *mapping;
    const char *const *names;
    int name_count;
    uint32_t suggested; /* bit i: names[i] was told to be meant by an unknown key */
} zt_fields;

enum { ZT_FIELD_NAMES_MAX = 32 };

/* Tells the keys that are not among the names; false when the node is no mapping. */
bool zt_fields_open(zt_fields *fields, zt_mistakes *mistakes, const zt_node *node,
                    const char *what, const char *const *names, int name_count);

/* The value of a key, or NULL. The second one tells, at `place`, when a key is missing, unless
 * it has been told already how its name is spelled. */
const zt_node *zt_field(const zt_fields *fields, const char *name);
const zt_node *zt_field_required(const zt_fields *fields, zt_mistakes *mistakes,
                                 const char *name, const zt_place *place);

/* Tells that a node is not what it must be: "a number". */
void zt_expected(zt_mistakes *mistakes, const zt_node *node, const char *what,
                 const char *expected);

/* What a number may be, as written, both ends allowed; +-INFINITY for no end. */
typedef struct zt_range {
    double min, max;
    const char *unit; /* or NULL */
} zt_range;

static const zt_range zt_any_number = {-INFINITY, INFINITY, NULL};

/* The range's unit may stand behind it. */
bool zt_read_number(double *value, zt_mistakes *mistakes, const zt_node *node, const char *what,
                    zt_range range);
bool zt_read_integer(int64_t *value, zt_mistakes *mistakes, const zt_node *node,
                     const char *what, int64_t min, int64_t max);

/* Splits "1.5 s" into its number and its unit, which is "" where there is none and points into
 * the node's text. Tells nothing. */
bool zt_read_quantity(double *number, const char **unit, const zt_node *node);

/* "40", "40 deg" or "0.7 rad", in radians; the range is in degrees. */
bool zt_read_angle(double *radians, zt_mistakes *mistakes, const zt_node *node,
                   const char *what, zt_range range);

/* A list of just so many numbers, or of three angles. */
bool zt_read_numbers(double *value, int count, zt_mistakes *mistakes, const zt_node *node,
                     const char *what, zt_range range);
bool zt_read_angles(double radians[3], zt_mistakes *mistakes, const zt_node *node,
                    const char *what, zt_range range);

/* Some text that is not empty; NULL when it is not. */
const char *zt_read_text(zt_mistakes *mistakes, const zt_node *node, const char *what);
bool zt_read_choice(int *index, zt_mistakes *mistakes, const zt_node *node, const char *what,
                    const char *const *choices, int choice_count);
bool zt_read_switch(double *value, zt_mistakes *mistakes, const zt_node *node,
                    const char *what);

#endif
