/* Expressions: values that a formula of the time and of other properties gives. The door to
 * Lua, a module that is loaded when a description first holds an expression (base/module.h).
 *
 * An expression is one formula: numbers, names, the operators + - * / // % ^ == ~= < <= > >=
 * and or not, brackets, calls. There are no statements, assignments, functions of one's own,
 * texts or comments, so it cannot loop, nor remember anything: its value depends on what it is
 * given, whichever frames were asked for before. All numbers are doubles.
 *
 * Names: t (seconds), frame (may be fractional), fps, duration (seconds), pi, tau, true, false;
 *   the functions of keyframe/functions.h, of numbers or, channel by channel, of vectors; other
 *   properties and variables, as the caller knows them: ball.center, ball.center.x, speed, and
 *   prop("key light.position") for names that are more than letters, digits and _.
 * Vectors: {1, 2, 3} or vec(1, 2, 3), of 2 to 16 numbers; one within another adds its numbers.
 *   Channels are .x .y .z .w, or .r .g .b .a, or [1] to [n]. + - * / // % ^ go channel by
 *   channel, a number beside a vector standing for each of its channels; == and ~= compare
 *   whole ones. dot(a, b), length(a), normalize(a) (zero stays zero); cross(a, b) of 3 and 3.
 * Choosing: `t < 2 and 1 or 5`. */
#ifndef ZT_KEYFRAME_EXPRESSION_H
#define ZT_KEYFRAME_EXPRESSION_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/rate.h>
#include <zoetrope/status.h>

#include "base/module.h"
#include "base/text.h"
#include "keyframe/functions.h"

enum {
    ZT_EXPRESSION_WIDTH_MAX = ZT_CHANNELS_MAX,
    ZT_EXPRESSION_SWITCH =
        -1, /* instead of a width: one number that is read as "at least 0.5" */
    ZT_EXPRESSION_REFERENCES_MAX = 100,
    ZT_EXPRESSION_LENGTH_MAX = 512 * 1024,      /* bytes of text */
    ZT_EXPRESSION_MEMORY_MAX = 4 * 1024 * 1024, /* bytes that Lua may take in one call */
    ZT_EXPRESSION_STEPS_MAX = 100 * 1000        /* Lua's instructions in one evaluation */
};

/* What the caller knows by name. Called while a text is compiled, from the same thread; must
 * not call into the same zt_expressions. */
typedef struct zt_expression_names {
    /* The width (1 to ZT_EXPRESSION_WIDTH_MAX, or ZT_EXPRESSION_SWITCH) of what is called
     * `name`
     * ("ball.center"), and a number of the caller's own for it; 0 where nothing is. */
    int (*find)(void *user, const char *name, int32_t *id);
    /* Shows all names, or those worth suggesting; may be NULL. */
    void (*suggest)(void *user, zt_nearest *nearest);
    void *user;
} zt_expression_names;

/* One of the things that an expression refers to, each once, in the order of their first places
 * in the text. */
typedef struct zt_expression_reference {
    int32_t id;         /* as zt_expression_names.find gave it */
    int32_t width;      /* numbers that eval() takes for it */
    int32_t first;      /* how many numbers come before these: the sum of the widths so far */
    int column, length; /* where it is first referred to, as in zt_expression_mistake */
} zt_expression_reference;

/* What is wrong with an expression, and where: characters of its text (of UTF-8, not bytes),
 * counted from 1; the whole text where no better place is known. */
typedef struct zt_expression_mistake {
    int column, length;
    char text[256];
} zt_expression_mistake;

typedef struct zt_expressions zt_expressions; /* one Lua state; owns all that was compiled */
typedef struct zt_expression zt_expression;

/* The calls. All but open and close may be made by several threads at once: a lock within lets
 * one after the other in. */
typedef struct zt_expression_door {
    /* For an animation of `duration_s` seconds. ZT_EMEMORY. */
    zt_status (*open)(zt_expressions **out, zt_rate rate, double duration_s);
    void (*close)(zt_expressions **expressions);

    /* Compiles what comes after the "=" in the description, to give values of `width` numbers
     * (or ZT_EXPRESSION_SWITCH: true or false, or a number). With `spread`, one number may
     * stand for all of them. `names` may be NULL: then there are only the words above. The
     * result is valid until `expressions` is closed. ZT_EDESCRIPTION: *mistake says what is
     * wrong; ZT_EMEMORY. */
    zt_status (*compile)(const zt_expression **out, zt_expressions *expressions,
                         const char *text, int width, bool spread,
                         const zt_expression_names *names, zt_expression_mistake *mistake);

    /* What an expression refers to, for the order of evaluation and to find cycles; as long
     * valid as the expression. */
    const zt_expression_reference *(*references)(const zt_expression *expression, int *count);

    /* Writes the value, `width` finite numbers (a switch: 0 or 1), from the numbers of the
     * references, one after the other in their order; NULL where there is none. The same bits
     * for the same arguments, in any order of calls. ZT_EDESCRIPTION: the value cannot be had,
     * is not finite or not of that width, and *mistake says so; ZT_EMEMORY. Then *value is not
     * to be used. */
    zt_status (*eval)(double *value, zt_expressions *expressions,
                      const zt_expression *expression, double time_s, double frame,
                      const double *references, zt_expression_mistake *mistake);
} zt_expression_door;

/* The door, loaded with the first call; NULL where it cannot be, which is told. */
static inline const zt_expression_door *zt_expression_door_open(zt_listener listener) {
    return zt_module_door("expression", "expressions", listener);
}

#endif
