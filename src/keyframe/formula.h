/* A formula: an expression in place of a property's value, and what it refers to. Numbers are
 * as they are written: angles in degrees, a rotation as [x, y, z] degrees; but a rotation that
 * is referred to is its quaternion x, y, z, w. */
#ifndef ZT_KEYFRAME_FORMULA_H
#define ZT_KEYFRAME_FORMULA_H

#include <zoetrope/rate.h>

#include "base/diag.h"
#include "keyframe/constraint.h"
#include "keyframe/expression.h"

/* What one reference of the expression means: a property, or a number that has a name. */
typedef struct zt_term {
    zt_reference reference;
    double number; /* without a reference */
} zt_term;

typedef struct zt_formula {
    const zt_expression *expression;
    const zt_term *terms; /* one for each of the expression's references */
    int32_t term_count;
    zt_place text;      /* of what is compiled: the first character after "=" */
    bool text_is_plain; /* whether its characters are those of the source line */
} zt_formula;

/* The widths that an expression has for a property: of its result, and as a reference. */
int zt_formula_result_width(zt_value_kind kind);
int zt_formula_reference_width(zt_value_kind kind);

/* Whether one number may stand for all of a property's. */
static inline bool zt_formula_spreads(zt_value_kind kind) {
    return kind == ZT_VALUE_SCALE || kind == ZT_VALUE_COLOR;
}

/* What a formula calls frame: exactly a whole number at the time of a whole one. */
double zt_formula_frame(zt_rate rate, double time_s);

/* Where in the description a mistake in the formula's text is. */
zt_place zt_formula_place(const zt_formula *formula, const zt_expression_mistake *mistake);

/* What evaluates the formulas of an animation. */
typedef struct zt_formulas {
    const zt_expression_door *door;
    zt_expressions *expressions; /* NULL where there is no formula */
} zt_formulas;

/* The value of a property of that kind, from what the scene holds. ZT_EDESCRIPTION: *mistake
 * says why there is none; ZT_EMEMORY. */
zt_status zt_formula_eval(double *value, const zt_formula *formula, const zt_formulas *formulas,
                          zt_value_kind kind, const zt_scene *scene, zt_rate rate,
                          double time_s, zt_expression_mistake *mistake);

#endif
