#include "keyframe/formula.h"

#include <math.h>
#include <string.h>

#include "keyframe/rotation.h"

static const double radian = 3.14159265358979323846 / 180; /* in a degree */

int zt_formula_result_width(zt_value_kind kind) {
    if (kind == ZT_VALUE_SWITCH) return ZT_EXPRESSION_SWITCH;
    return kind == ZT_VALUE_ROTATION ? 3 : zt_value_width(kind);
}

int zt_formula_reference_width(zt_value_kind kind) {
    return kind == ZT_VALUE_SWITCH ? ZT_EXPRESSION_SWITCH : zt_value_width(kind);
}

zt_place zt_formula_place(const zt_formula *formula, const zt_expression_mistake *mistake) {
    zt_place place = formula->text;
    if (!formula->text_is_plain) return place;
    place.column += mistake->column - 1;
    place.length = mistake->length;
    return place;
}

double zt_formula_frame(zt_rate rate, double time_s) {
    double frame = time_s * rate.num / rate.den, whole = round(frame);
    bool is_frame = fabs(whole) < 0x1p32 && zt_rate_time(rate, (int64_t)whole) == time_s;
    return is_frame ? whole : frame;
}

/* A property as an expression sees it. */
static void read_property(double *numbers, zt_reference reference, const zt_scene *scene) {
    zt_property_get(numbers, reference.property, scene, reference.index);
    if (reference.property->kind == ZT_VALUE_ANGLE) *numbers /= radian;
    if (reference.property->kind != ZT_VALUE_ROTATION) return;
    double w = numbers[0];
    memmove(numbers, numbers + 1, 3 * sizeof *numbers);
    numbers[3] = w;
}

zt_status zt_formula_eval(double *value, const zt_formula *formula, const zt_formulas *formulas,
                          zt_value_kind kind, const zt_scene *scene, zt_rate rate,
                          double time_s, zt_expression_mistake *mistake) {
    double numbers[ZT_EXPRESSION_REFERENCES_MAX * ZT_VALUE_WIDTH_MAX];
    int reference_count;
    const zt_expression_reference *references =
        formulas->door->references(formula->expression, &reference_count);
    for (int32_t i = 0; i < formula->term_count; i++)
        if (formula->terms[i].reference.property)
            read_property(numbers + references[i].first, formula->terms[i].reference, scene);
        else
            numbers[references[i].first] = formula->terms[i].number;
    ZT_TRY(formulas->door->eval(value, formulas->expressions, formula->expression, time_s,
                                zt_formula_frame(rate, time_s), numbers, mistake));
    if (kind == ZT_VALUE_ANGLE) *value *= radian;
    if (kind == ZT_VALUE_ROTATION) {
        vec3 degrees = {value[0], value[1], value[2]};
        quat q = zt_rotation_euler(vec3_scale(degrees, radian), "xyz");
        memcpy(value, (double[4]){q.w, q.x, q.y, q.z}, 4 * sizeof *value);
    }
    return ZT_OK;
}
