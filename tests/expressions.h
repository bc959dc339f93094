/* For tests of expressions: a film of ten seconds with a few things in it, and short ways to
 * compile and evaluate. cmocka.h comes first. */
#ifndef ZT_TESTS_EXPRESSIONS_H
#define ZT_TESTS_EXPRESSIONS_H

#include <string.h>

#include "keyframe/expression.h"

static const zt_expression_door *door;
static zt_expressions *all;

enum {
    BALL_CENTER,
    BALL_RADIUS,
    LAMP_SHADOWS,
    KEY_LIGHT,
    CAMERA,
    VERTICES,
    SPEED,
    TURN,
    THINGS
};

static const struct {
    const char *name;
    int width;
    double value[9];
} things[THINGS] = {
    {"ball.center", 3, {1.5, -2, 4}},
    {"ball.radius", 1, {0.25}},
    {"lamp.shadows", ZT_EXPRESSION_SWITCH, {0}},
    {"key light.position", 3, {10, 20, 30}},
    {"camera.position", 3, {0.1, 0.2, 0.3}},
    {"face.vertices", 9, {1, 2, 3, 4, 5, 6, 7, 8, 9}},
    {"speed", 1, {7}},
    {"k\xC3\xB6pfchen.\xC3\xA4hnlich.rotation", 4, {0.5, -0.5, 0.5, -0.5}},
};

static int find_thing(void *user, const char *name, int32_t *id) {
    (void)user;
    for (int i = 0; i < THINGS; i++)
        if (strcmp(name, things[i].name) == 0) {
            *id = i;
            return things[i].width;
        }
    return 0;
}

static void suggest_things(void *user, zt_nearest *nearest) {
    (void)user;
    for (int i = 0; i < THINGS; i++) zt_nearest_try(nearest, things[i].name);
}

static const zt_expression_names names = {find_thing, suggest_things, NULL};

static inline int open_film(void **state) {
    (void)state;
    door = zt_expression_door_open((zt_listener){NULL, NULL});
    return !door || door->open(&all, (zt_rate){24, 1}, 10) != ZT_OK;
}

static inline int close_film(void **state) {
    (void)state;
    door->close(&all);
    return all != NULL;
}

static inline zt_status compile(const zt_expression **x, const char *text, int width,
                                zt_expression_mistake *mistake) {
    *mistake = (zt_expression_mistake){0};
    return door->compile(x, all, text, width, false, &names, mistake);
}

/* Evaluates, with the things as they are above. */
static inline zt_status eval(double *value, const zt_expression *x, double time_s,
                             zt_expression_mistake *mistake) {
    double numbers[9 * THINGS];
    int count;
    const zt_expression_reference *r = door->references(x, &count);
    for (int i = 0; i < count; i++)
        memcpy(numbers + r[i].first, things[r[i].id].value,
               sizeof(double) * (size_t)(r[i].width < 0 ? 1 : r[i].width));
    *mistake = (zt_expression_mistake){0};
    return door->eval(value, all, x, time_s, time_s * 24, numbers, mistake);
}

/* The value of a text that has one. */
static inline void value_of(double *value, const char *text, int width, double time_s) {
    const zt_expression *x;
    zt_expression_mistake mistake;
    if (compile(&x, text, width, &mistake) != ZT_OK ||
        eval(value, x, time_s, &mistake) != ZT_OK)
        fail_msg("%s: %d: %s", text, mistake.column, mistake.text);
}

static inline double number_of(const char *text, double time_s) {
    double value;
    value_of(&value, text, 1, time_s);
    return value;
}

#endif
