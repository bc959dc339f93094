/* Shows that expressions have the values that their formulas have, that what they refer to is
 * found, and that mistakes are told at their places. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "base/clock.h"
#include "expressions.h"
#include "files.h"

static const double pi = 3.14159265358979323846;

static bool is_loaded(const char *library) {
    char line[4096];
    bool found = false;
    FILE *maps = fopen("/proc/self/maps", "r");
    assert_non_null(maps);
    while (fgets(line, sizeof line, maps)) found = found || strstr(line, library);
    fclose(maps);
    return found;
}

/* Without an expression there is no Lua in the process; the door brings it. */
static void loaded_when_needed(void **state) {
    (void)state;
    assert_true(is_loaded("libc"));
    assert_false(is_loaded("lua"));
    assert_false(is_loaded("zoetrope-expression"));
    assert_int_equal(open_film(NULL), 0);
    assert_true(is_loaded("liblua5.4"));
    assert_true(is_loaded("zoetrope-expression.so"));
    assert_ptr_equal(zt_expression_door_open((zt_listener){NULL, NULL}), door);
}

/* A module that is not there is told by its file's name, and with what needs it. */
static void missing_module(void **state) {
    (void)state;
    heard h;
    assert_null(zt_module_door("hologram", "holograms", listener_of(&h)));
    assert_told(&h, "holograms cannot be had, as zoetrope-hologram.so cannot be loaded: ");
    assert_told(&h, "No such file");
    assert_null(zt_module_door("hologram", "holograms", (zt_listener){NULL, NULL}));
}

/* To the last bit where the formula has one rounding order, else within a few ulp. */
static void assert_near(const char *text, double found, double expected) {
    if (fabs(found - expected) <= 4e-16 * fmax(1, fabs(expected))) return;
    fail_msg("%s is %.17g and should be %.17g", text, found, expected);
}

/* Formulas against the same ones in C, at times of either sign. */
static void formulas(void **state) {
    (void)state;
    const double times[] = {0, 0.125, 1.0 / 3, 2, 9.75, -1.7, 1e6};
    for (int i = 0; i < 7; i++) {
        double t = times[i];
        const struct {
            const char *text;
            double expected;
        } cases[] = {
            {"1 + 0.2*sin(2*pi*t)", 1 + 0.2 * sin(2 * pi * t)},
            {" t ", t},
            {"frame", t * 24},
            {"fps", 24},
            {"duration", 10},
            {"tau", 2 * pi},
            {"-t^2", -(t * t)},
            {"2^-1^2", 0.5},
            {"2^3^2", 512},
            {"(1 + t)*3 - t/4", (1 + t) * 3 - t / 4},
            {"7 // 2 + 7 / 2", 6.5},
            {"-7 // 2", -4},
            {"-7 % 3", 2},
            {"7 % -3", -2},
            {"1e3 + .5 + 2.", 1002.5},
            {"0.1 + 0.2", 0.1 + 0.2},
            {"9007199254740993", 9007199254740992.0},
            {"9223372036854775807 + 1", 9223372036854775808.0},
            {"4.9e-324", 4.9e-324},
            {"1.7976931348623157e308", 1.7976931348623157e308},
            {"t < 2 and 10 or t == 2 and 20 or 30", t < 2    ? 10
                                                    : t == 2 ? 20
                                                             : 30},
            {"not (t >= 2) and 1 or 0", !(t >= 2)},
            {"t ~= 2 and t <= 2 and 1 or 0", t < 2},
            {"true and 4", 4},
            {"abs(sin(\n\tt )\r\n)", fabs(sin(t))},
            {"- -t - -1", t + 1},
        };
        for (size_t k = 0; k < sizeof cases / sizeof *cases; k++)
            assert_near(cases[k].text, number_of(cases[k].text, t), cases[k].expected);
    }
}

/* Every function against its definition. */
static void functions(void **state) {
    (void)state;
    const struct {
        const char *text;
        double expected;
    } cases[] = {
        {"sin(0.7)", sin(0.7)},
        {"cos(0.7)", cos(0.7)},
        {"tan(0.7)", tan(0.7)},
        {"asin(0.7)", asin(0.7)},
        {"acos(0.7)", acos(0.7)},
        {"atan(0.7)", atan(0.7)},
        {"atan2(-1, -1)", -0.75 * pi},
        {"sqrt(2)", sqrt(2)},
        {"exp(1.5)", exp(1.5)},
        {"log(5)", log(5)},
        {"abs(-3)", 3},
        {"sign(-2) + 10*sign(0) + 100*sign(5)", 99},
        {"floor(-1.5)", -2},
        {"ceil(-1.5)", -1},
        {"round(2.5) + 10*round(-2.5)", -27},
        {"fract(-0.25)", 0.75},
        {"deg(pi)", 180},
        {"rad(90)", pi / 2},
        {"min(3, 1, 2)", 1},
        {"max(3, 1, 4, 2)", 4},
        {"clamp(5, 0, 1) + 10*clamp(-5, 0, 1) + 100*clamp(0.5, 0, 1)", 51},
        {"mix(3, 7, 0.25)", 4},
        {"mix(0.1, 0.3, 1) == 0.3 and mix(0.1, 0.3, 0) == 0.1 and 1 or 0", 1},
        {"step(2, 1.9) + 10*step(2, 2)", 10},
        {"smoothstep(1, 3, 0)", 0},
        {"smoothstep(1, 3, 1.5)", 0.15625},
        {"smoothstep(1, 3, 5)", 1},
        {"smoothstep(3, 1, 1.5)", 0.84375},
        {"smoothstep(2, 2, 1.9) + 10*smoothstep(2, 2, 2)", 10},
        {"remap(3, 2, 6, 10, 30)", 15},
        {"mod(-7, 3) + 10*mod(7, -3)", -18},
        {"dot({1, 2, 3}, {4, 5, 6})", 32},
        {"length({3, 4})", 5},
        {"length({3e-200, 0, 4e-200})", 5e-200},
        {"length({0, 3e300, 4e300})", 5e300},
        {"length({0, 0, 0})", 0},
        {"dot(cross({1, 2, 3}, {-2, 1, 5}), {1, 2, 3})", 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double found = number_of(cases[i].text, 0), expected = cases[i].expected;
        if (fabs(found - expected) > 4e-16 * fabs(expected))
            fail_msg("%s is %.17g and should be %.17g", cases[i].text, found, expected);
    }
}

/* Vectors go channel by channel; a number stands for each channel. */
static void vectors(void **state) {
    (void)state;
    const struct {
        const char *text;
        int width;
        double expected[9];
    } cases[] = {
        {"{1, 2, 3}", 3, {1, 2, 3}},
        {"vec(1, 2)", 2, {1, 2}},
        {"{1, 2, 3} + {10, 20, 30}", 3, {11, 22, 33}},
        {"{1, 2, 3} - 1", 3, {0, 1, 2}},
        {"2 * {1, 2, 3}", 3, {2, 4, 6}},
        {"{2, 4} / {1, 8}", 2, {2, 0.5}},
        {"-{1, 2, 3}", 3, {-1, -2, -3}},
        {"{7, -7} // 2", 2, {3, -4}},
        {"{7, -7} % 3", 2, {1, 2}},
        {"{2, 3} ^ 2", 2, {4, 9}},
        {"2 ^ {2, 3}", 2, {4, 8}},
        {"{{1, 2}, 3}", 3, {1, 2, 3}},
        {"{{0, 0, 1}, {1, 0, 2}, {0, 1, 3}}", 9, {0, 0, 1, 1, 0, 2, 0, 1, 3}},
        {"cross({1, 0, 0}, {0, 1, 0})", 3, {0, 0, 1}},
        {"normalize({0, 3e-200, 4e-200})", 3, {0, 0.6, 0.8}},
        {"normalize({0, 0})", 2, {0, 0}},
        {"max({1, 5, 3}, 2, {0, 0, 9})", 3, {2, 5, 9}},
        {"mix({0, 10}, {1, 20}, 0.5)", 2, {0.5, 15}},
        {"floor({1.5, -1.5})", 2, {1, -2}},
        {"{{1, 2, 3}.z, {1, 2, 3}.g, ({1, 2, 3})[1], vec(1, 2, 3, 4).a}", 4, {3, 2, 1, 4}},
        {"{1, 2, 3}[1 + 1] * {1, 1}", 2, {2, 2}},
        {"{1, 2} == {1, 2} and {1, 0} or {0, 1}", 2, {1, 0}},
        {"{1, 2} ~= {1, 2, 3} and {1, 0} or {0, 1}", 2, {1, 0}},
        {"ball.center * {2, 3, 4}", 3, {3, -6, 16}},
        {"face.vertices + 1", 9, {2, 3, 4, 5, 6, 7, 8, 9, 10}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double found[9];
        value_of(found, cases[i].text, cases[i].width, 0);
        for (int c = 0; c < cases[i].width; c++)
            if (fabs(found[c] - cases[i].expected[c]) > 1e-15)
                fail_msg("%s: %d is %g", cases[i].text, c, found[c]);
    }
    /* The same bits as for numbers alone. */
    const char *operators[] = {"+", "-", "*", "/", "//", "%", "^"};
    for (int i = 0; i < 7; i++) {
        char text[100];
        double pair[2];
        snprintf(text, sizeof text, "{0.7, 5.3} %s {0.3, t}", operators[i]);
        value_of(pair, text, 2, 1.9);
        snprintf(text, sizeof text, "5.3 %s t", operators[i]);
        assert_true(number_of(text, 1.9) == pair[1]);
    }
}

/* Noise and random numbers are these, on every machine: from a program in another language. */
static void noise_and_random(void **state) {
    (void)state;
    const struct {
        const char *text;
        double expected;
    } cases[] = {
        {"noise(0)", 0x1.3836e97a68cbcp-2},          {"noise(0.25)", 0x1.ec7d08e42e190p-3},
        {"noise(-3.7)", -0x1.bbebbd4b280afp-1},      {"noise(12345.678)", 0x1.10495f74ad537p-4},
        {"noise(0.5, 7)", -0x1.8d79327ff5ae9p-1},    {"noise(1e300)", -0x1.d4540158948a0p-4},
        {"noise(1e15 + 0.5)", 0x1.20945d0ac1898p-3}, {"random(0)", 0x1.c4415072f63b9p-1},
        {"random(-0)", 0x1.c4415072f63b9p-1},        {"random(1, 2)", 0x1.804c9face7000p-4},
        {"random(2, 1)", 0x1.dab61d005f206p-2},      {"random(-0.5)", 0x1.cefb643c5df88p-1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        if (number_of(cases[i].text, 0) != cases[i].expected)
            fail_msg("%s is %a", cases[i].text, number_of(cases[i].text, 0));
    const zt_expression *x;
    zt_expression_mistake mistake;
    assert_int_equal(compile(&x, "noise(t)", 1, &mistake), ZT_OK);
    double least = 1, most = -1, before, value;
    assert_int_equal(eval(&before, x, -50, &mistake), ZT_OK);
    for (int i = -50 * 256 + 1; i < 50 * 256; i++) {
        assert_int_equal(eval(&value, x, i / 256.0, &mistake), ZT_OK);
        assert_true(fabs(value - before) < 2 * 1.875 / 256); /* its steepest: 15/8 of a step */
        least = fmin(least, value);
        most = fmax(most, value);
        before = value;
    }
    assert_true(least >= -1 && least < -0.9 && most <= 1 && most > 0.9);
}

static void assert_references(const char *text, int count, const int *ids, double expected) {
    const zt_expression *x;
    zt_expression_mistake mistake;
    double value;
    int found_count, first = 0;
    if (compile(&x, text, 1, &mistake) != ZT_OK) fail_msg("%s: %s", text, mistake.text);
    const zt_expression_reference *r = door->references(x, &found_count);
    assert_int_equal(found_count, count);
    for (int i = 0; i < count; i++) {
        assert_int_equal(r[i].id, ids[i]);
        assert_int_equal(r[i].width, things[ids[i]].width);
        assert_int_equal(r[i].first, first);
        first += r[i].width < 0 ? 1 : r[i].width;
    }
    assert_int_equal(eval(&value, x, 1, &mistake), ZT_OK);
    assert_near(text, value, expected);
}

/* References are found without evaluating, each once, in order; the longest known name is
 * meant, in quotes as well. */
static void references(void **state) {
    (void)state;
    assert_references("t", 0, NULL, 1);
    assert_references("ball.center.x", 1, (int[]){BALL_CENTER}, 1.5);
    assert_references("ball.center.z + ball.radius + ball.center[2]", 2,
                      (int[]){BALL_CENTER, BALL_RADIUS}, 2.25);
    assert_references("ball.radius * ball.center[ 3 ] + dot(ball.center, ball.center)", 2,
                      (int[]){BALL_RADIUS, BALL_CENTER}, 1 + 2.25 + 4 + 16);
    assert_references("camera.position[1] + camera.position.b", 1, (int[]){CAMERA}, 0.1 + 0.3);
    assert_references("speed * t", 1, (int[]){SPEED}, 7);
    assert_references("prop(\"key light.position\").y", 1, (int[]){KEY_LIGHT}, 20);
    assert_references("prop( 'key light.position' )[3]", 1, (int[]){KEY_LIGHT}, 30);
    assert_references("prop('key light.position.x') + speed", 2, (int[]){KEY_LIGHT, SPEED}, 17);
    assert_references("prop('ball.center').x + ball.center.y", 1, (int[]){BALL_CENTER}, -0.5);
    assert_references("length(prop(\"key light.position\"))", 1, (int[]){KEY_LIGHT},
                      sqrt(1400));
    assert_references("lamp.shadows and 1 or 2", 1, (int[]){LAMP_SHADOWS}, 2);
    assert_references("face.vertices[9] + face.vertices[t + 1]", 1, (int[]){VERTICES}, 11);
    assert_references("k\xC3\xB6pfchen.\xC3\xA4hnlich.rotation.w", 1, (int[]){TURN}, -0.5);
}

typedef struct wrong_case {
    const char *text;
    int width, column, length;
    const char *words;
} wrong_case;

static void assert_wrong(const wrong_case *w, zt_status status, zt_expression_mistake mistake) {
    if (status != ZT_EDESCRIPTION || mistake.column != w->column ||
        mistake.length != w->length || !strstr(mistake.text, w->words))
        fail_msg("\"%s\": %d, %d+%d: %s", w->text, status, mistake.column, mistake.length,
                 mistake.text);
}

/* What is wrong in the text is told when it is compiled, at its place. */
static void mistakes_of_texts(void **state) {
    (void)state;
    const wrong_case cases[] = {
        {"", 1, 1, 1, "missing"},
        {" \n ", 1, 1, 1, "missing"},
        {"1 +", 1, 3, 1, "breaks off"},
        {"1 2", 1, 3, 1, "does not fit"},
        {"2t", 1, 2, 1, "does not fit"},
        {"* 2", 1, 1, 1, "does not fit"},
        {"sin(t", 1, 4, 1, "\"(\" is never closed"},
        {"sin t)", 1, 6, 1, "no open bracket"},
        {"(1, 2}", 1, 6, 1, "no open bracket"},
        {"1, 2", 1, 2, 1, "{x, y, z}"},
        {"(1, 2)", 1, 3, 1, "does not fit"},
        {"1 + sinn(t)", 1, 5, 4, "did you mean \"sin\"?"},
        {"1 + ball.centre.x", 3, 5, 11, "\"ball.centre\"; did you mean \"ball.center\"?"},
        {"\xC3\xA9 + 1", 1, 1, 1, "nothing is called"},
        {"'\xC3\xA9\xC3\xA9' .. sin", 1, 1, 1, "prop"},
        {"k\xC3\xB6pfchen.\xC3\xA4hnlich.rotation.w + xyzzy", 1, 31, 5, "nothing is called"},
        {"ball.radius.x", 1, 13, 1, "no channels"},
        {"t.x", 1, 3, 1, "\"t\" has no channels"},
        {"sin.x", 1, 5, 1, "\"sin\" has no channels"},
        {"ball.center.w", 1, 13, 1, "3 channels"},
        {"ball.center[4]", 1, 13, 1, "3 channels"},
        {"ball.center[0]", 1, 13, 1, "3 channels"},
        {"ball.center.size", 1, 13, 4, "no \"size\""},
        {"(t).size", 1, 5, 4, "no channel"},
        {"prop(ball.center)", 1, 1, 4, "quotes"},
        {"prop('ball.center)", 1, 1, 4, "quotes"},
        {"prop 'speed'", 1, 1, 4, "quotes"},
        {"prop('nothing here')", 1, 7, 12, "nothing is called \"nothing here\""},
        {"prop('ball.center.x.y')", 1, 7, 13, "nothing is called"},
        {"t = 1", 1, 3, 1, "write =="},
        {"t--1", 1, 2, 2, "space"},
        {"t != 1", 1, 3, 2, "~="},
        {"t > 1 && t < 2", 1, 7, 2, "write and"},
        {"!t", 1, 1, 1, "write not"},
        {"1e999", 1, 1, 5, "no number"},
        {"0x10", 1, 2, 3, "nothing is called"},
        {"t @ 2", 1, 3, 1, "@ has no place"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const zt_expression *x;
        zt_expression_mistake mistake;
        zt_status status = compile(&x, cases[i].text, cases[i].width, &mistake);
        assert_wrong(&cases[i], status, mistake);
        assert_null(x);
    }
}

/* What only a value shows is told when there is one, at its operator or call; at
 * the end of what is compared. */
static void mistakes_of_values(void **state) {
    (void)state;
    const wrong_case cases[] = {
        {"1/(t - t)", 1, 1, 9, "not finite"},
        {"sqrt(-1) + 1", 1, 1, 12, "not finite"},
        {"clamp(sqrt(-1), 0, 1)", 1, 1, 21, "not finite"},
        {"{1, log(0)}", 2, 1, 11, "not finite"},
        {"{1, 2}", 3, 1, 6, "2 numbers instead of 3"},
        {"{1, 2}", 1, 1, 6, "2 numbers instead of 1"},
        {"t", 3, 1, 1, "a number instead of 3"},
        {"t > 1", 1, 1, 5, "true or false instead of 1"},
        {"sin", 1, 1, 3, "a function instead of 1"},
        {"1 + (t > 1)", 1, 3, 1, "arithmetic on a boolean"},
        {"1 + 2 * sin", 1, 7, 1, "arithmetic on a function"},
        {"1 +\n(3)(4)", 1, 5, 1, "call a number"},
        {"(t).x", 1, 4, 2, "index a number"},
        {"t < {1, 2}", 1, 10, 1, "compare number with vector"},
        {"1 + sin(1, 2)", 1, 5, 3, "wrong number of values for sin: 2 instead of 1"},
        {"min(1)", 1, 1, 3, "2 to 16"},
        {"sin(t > 1)", 1, 1, 3, "true or false"},
        {"{1, 2} + {1, 2, 3}", 2, 8, 1, "2 and 3 numbers"},
        {"cross({1, 2}, {3, 4})", 3, 1, 5, "of 3"},
        {"dot({1, 2}, 3)", 1, 1, 3, "vectors"},
        {"{1, 2}.z", 1, 7, 2, "from 1 to 2"},
        {"{1, 2}[0.5]", 1, 11, 1, "from 1 to 2"},
        {"{1, 2}[sin]", 1, 11, 1, "from 1 to 2"},
        {"{1}", 2, 1, 1, "2 numbers at least"},
        {"{{1,2,3,4,5,6,7,8},{1,2,3,4,5,6,7,8},1}", 9, 1, 1, "16 numbers at most"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const zt_expression *x;
        zt_expression_mistake mistake;
        double value[9];
        if (compile(&x, cases[i].text, cases[i].width, &mistake) != ZT_OK)
            fail_msg("\"%s\": %s", cases[i].text, mistake.text);
        assert_wrong(&cases[i], eval(value, x, 1, &mistake), mistake);
    }
}

/* One number stands for all channels where the caller says so, and only there; switches are
 * true, false or a number. */
static void widths(void **state) {
    (void)state;
    const zt_expression *x;
    zt_expression_mistake mistake;
    double value[3];
    assert_int_equal(door->compile(&x, all, "2 + t", 3, true, NULL, &mistake), ZT_OK);
    assert_int_equal(door->eval(value, all, x, 1, 24, NULL, &mistake), ZT_OK);
    assert_true(value[0] == 3 && value[1] == 3 && value[2] == 3);
    const struct {
        const char *text;
        double expected;
    } switches[] = {{"t > 0.5", 1},    {"t > 1", 0},        {"0.4", 0},
                    {"step(1, t)", 1}, {"lamp.shadows", 0}, {"not lamp.shadows", 1}};
    for (int i = 0; i < 6; i++) {
        value_of(value, switches[i].text, ZT_EXPRESSION_SWITCH, 1);
        assert_true(value[0] == switches[i].expected);
    }
    assert_int_equal(compile(&x, "{1, 2}", ZT_EXPRESSION_SWITCH, &mistake), ZT_OK);
    assert_int_equal(eval(value, x, 1, &mistake), ZT_EDESCRIPTION);
    for (int width = -3; width < 20; width++)
        assert_int_equal(compile(&x, "1", width, &mistake),
                         width == ZT_EXPRESSION_SWITCH || (width >= 1 && width <= 16)
                             ? ZT_OK
                             : ZT_EARGUMENT);
}

static int find_words(void *user, const char *name, int32_t *id) {
    (void)user, *id = 0;
    return strcmp(name, "pi") == 0 || strcmp(name, "end") == 0;
}

/* A name that would hide one of the expressions' own is told; Lua's other words are free. */
static void names_that_clash(void **state) {
    (void)state;
    const zt_expression_names clash = {find_words, NULL, NULL};
    const zt_expression *x;
    zt_expression_mistake mistake;
    double value, five = 5;
    assert_int_equal(door->compile(&x, all, "1 + pi", 1, false, &clash, &mistake),
                     ZT_EDESCRIPTION);
    assert_int_equal(mistake.column, 5);
    assert_non_null(strstr(mistake.text, "\"pi\""));
    assert_int_equal(door->compile(&x, all, "1 + end", 1, false, &clash, &mistake), ZT_OK);
    assert_int_equal(door->eval(&value, all, x, 1, 24, &five, &mistake), ZT_OK);
    assert_true(value == 6);
}

/* How long it takes: to read, not to pass or fail. */
static void cost(void **state) {
    (void)state;
    const char *texts[] = {"1 + 0.2*sin(2*pi*t)", "ball.center.x + 0.3*noise(4*t)",
                           "ball.center + {sin(t), cos(t), 0}"};
    for (int i = 0; i < 3; i++) {
        enum { ROUNDS = 100000 };
        int width = i == 2 ? 3 : 1;
        const zt_expression *x;
        zt_expression_mistake mistake;
        double value[3];
        assert_int_equal(compile(&x, texts[i], width, &mistake), ZT_OK);
        double start_s = zt_clock_s();
        for (int k = 0; k < ROUNDS; k++)
            assert_int_equal(
                door->eval(value, all, x, k, 24 * k, things[BALL_CENTER].value, &mistake),
                ZT_OK);
        printf("  %.2f million a second: %s\n", ROUNDS / (zt_clock_s() - start_s) / 1e6,
               texts[i]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loaded_when_needed), /* first */
        cmocka_unit_test(missing_module),
        cmocka_unit_test(formulas),
        cmocka_unit_test(functions),
        cmocka_unit_test(vectors),
        cmocka_unit_test(noise_and_random),
        cmocka_unit_test(references),
        cmocka_unit_test(mistakes_of_texts),
        cmocka_unit_test(mistakes_of_values),
        cmocka_unit_test(widths),
        cmocka_unit_test(names_that_clash),
        cmocka_unit_test(cost),
    };
    return cmocka_run_group_tests(tests, NULL, close_film);
}
