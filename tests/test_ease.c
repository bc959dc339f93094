/* Shows that easings are what CSS and Penner define, exact at both ends, and that cubic-bezier
 * is solved as exactly as doubles allow, also where its curve stands still. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "draw.h"
#include "keyframe/ease.h"
#include "real.h"

static zt_arena arena;

static zt_ease parse(const char *text) {
    zt_ease ease;
    const char *mistake = zt_ease_parse(&ease, &arena, text);
    if (mistake) fail_msg("%s: %s", text, mistake);
    return ease;
}

static double at(const char *text, double u) {
    zt_ease ease = parse(text);
    return zt_ease_eval(&ease, u);
}

static void assert_at(const char *text, double u, double expected, double tolerance) {
    double found = at(text, u);
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%s at %g is %.17g, not %.17g", text, u, found, expected);
}

/* ---- cubic-bezier --------------------------------------------------------------------------
 */

static real cubic(double p1, double p2, real s) {
    return 3 * (real)p1 * s * (1 - s) * (1 - s) + 3 * (real)p2 * s * s * (1 - s) + s * s * s;
}

/* By halving alone, to the last bit of the higher precision. That alone is too little at the
 * very end, where the curve may arrive at 1 long before its parameter does. */
static real bezier_reference(double x1, double y1, double x2, double y2, double x) {
    real low = x == 1, high = 1;
    for (int i = 0; i < 120; i++) {
        real middle = (low + high) / 2;
        if (cubic(x1, x2, middle) < x)
            low = middle;
        else
            high = middle;
    }
    return cubic(y1, y2, (low + high) / 2);
}

/* A handle's time: any, at an end, or as near to an end as can be told apart. */
static double draw_handle(draw *d) {
    switch (draw_below(d, 6)) {
    case 0:
        return 0;
    case 1:
        return 1;
    case 2:
        return draw_magnitude(d, 1e-18, 1e-2);
    case 3:
        return 1 - draw_magnitude(d, 1e-16, 1e-2);
    default:
        return draw_unit(d);
    }
}

/* Within 1e-12 for all handles in range, those included that make the curve stand still. */
static void bezier_is_exact(void **state) {
    (void)state;
    if (!REAL_IS_QUAD) skip();
    draw d = {1, 0};
    double worst = 0;
    for (int round = 0; round < 60000; round++) {
        double x1 = draw_handle(&d), x2 = draw_handle(&d), u = draw_handle(&d);
        if (round % 8 == 0) {
            double off = draw_below(&d, 3) ? draw_magnitude(&d, 1e-12, 1e-6) : 0;
            x1 = 1 - off * draw_below(&d, 2);
            x2 = off * draw_below(&d, 2);
        }
        if (round % 4 == 0)
            u = 0.5 + (draw_below(&d, 2) ? 1 : -1) * draw_magnitude(&d, 1e-16, 0.5);
        double y1 = draw_between(&d, -2, 3), y2 = draw_between(&d, -2, 3);
        zt_ease ease = {ZT_EASE_BEZIER, .x1 = x1, .y1 = y1, .x2 = x2, .y2 = y2};
        double error =
            fabs((double)(zt_ease_eval(&ease, u) - bezier_reference(x1, y1, x2, y2, u)));
        if (!(error <= 1e-12))
            fail_msg("cubic-bezier(%.17g, %g, %.17g, %g) at %.17g is off by %g", x1, y1, x2, y2,
                     u, error);
        worst = fmax(worst, error);
    }
    printf("  cubic-bezier: worst error %.2g\n", worst);
}

/* Time never runs back: the curve's parameter rises with its time. */
static void bezier_rises(void **state) {
    (void)state;
    draw d = {2, 0};
    for (int round = 0; round < 2000; round++) {
        double x1 = draw_handle(&d), x2 = draw_handle(&d), last = 0;
        for (int i = 0; i <= 200; i++) {
            double s = zt_ease_bezier_parameter(x1, x2, i / 200.0);
            if (!(s >= last && s <= 1)) fail_msg("%.17g after %.17g", s, last);
            last = s;
        }
        assert_true(last == 1);
    }
}

/* The CSS words stand for the curves that the standard gives them. */
static void bezier_words(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"ease", "cubic-bezier(0.25, 0.1, 0.25, 1)"},
        {"ease-in", "cubic-bezier(0.42, 0, 1, 1)"},
        {"ease-out", "cubic-bezier(0,0,0.58,1)"},
        {"ease-in-out", " cubic-bezier( .42 , 0, .58 , 1 ) "}};
    for (int i = 0; i < 4; i++)
        for (double u = 0; u <= 1; u += 0.0625)
            assert_true(at(pairs[i][0], u) == at(pairs[i][1], u));
    assert_at("ease-in-out", 0.5, 0.5, 1e-15);
}

/* ---- steps and linear() --------------------------------------------------------------------
 */

/* Each way to jump, in the middle of steps and on their edges, as the standard's figures show.
 */
static void steps(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double u, expected;
    } cases[] = {
        {"steps(4)", 0, 0},
        {"steps(4)", 0.2499, 0},
        {"steps(4, jump-end)", 0.25, 0.25},
        {"steps(4, end)", 0.99, 0.75},
        {"steps(4)", 1, 1},
        {"steps(4, jump-start)", 0, 0.25},
        {"steps(4, start)", 0.5, 0.75},
        {"steps(4, jump-start)", 0.8, 1},
        {"steps(4, jump-start)", 1, 1},
        {"steps(5, jump-none)", 0, 0},
        {"steps(5, jump-none)", 0.19, 0},
        {"steps(5, jump-none)", 0.5, 0.5},
        {"steps(5, jump-none)", 0.8, 1},
        {"steps(3, jump-both)", 0, 0.25},
        {"steps(3, jump-both)", 0.5, 0.5},
        {"steps(3, jump-both)", 1, 1},
        {"step-start", 0, 1},
        {"step-end", 0.999, 0},
        {"step-end", 1, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_at(cases[i].text, cases[i].u, cases[i].expected, 0);
    /* The frames of a film on the edges of steps: none is late by a rounding error. */
    for (int count = 1; count <= 240; count++) {
        zt_ease ease = {ZT_EASE_STEPS, .step_count = count, .jump = ZT_EASE_JUMP_END};
        for (int step = 0; step <= count; step++) {
            double begin = 10 / 3.0, end = begin + count / 24.0, t = begin + step / 24.0;
            assert_true(zt_ease_eval(&ease, (t - begin) / (end - begin)) ==
                        (double)step / count);
        }
    }
}

/* Stops with and without times, jumps, times that would fall, and lines that go on. */
static void stops(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double u, expected;
    } cases[] = {
        {"linear(0, 1)", 0.3, 0.3},
        {"linear(0, 0.5, 1)", 0.25, 0.25},
        {"linear(0, 0.8, 0.2, 1)", 1 / 3.0, 0.8},
        {"linear(0, 0.8, 0.2, 1)", 0.5, 0.5},
        {"linear(0, 0.25 75%, 1)", 0.375, 0.125},
        {"linear(0, 25% 0.5 75%, 1)", 0.6, 0.5},
        {"linear(0, 0.5 25% 75%, 1)", 0.125, 0.25},
        {"linear(0 0%, 0.2 50%, 0.9 50%, 1 100%)", 0.5, 0.9},
        {"linear(0 0%, 0.2 50%, 0.9 50%, 1 100%)", 0.25, 0.1},
        {"linear(0, 1 60%, 0.5 40%, 0)", 0.6, 0.5}, /* 40% becomes 60% */
        {"linear(0, 1 60%, 0.5 40%, 0)", 0.8, 0.25},
        {"linear(0.7)", 0.1, 0.7},
        {"linear(0 20%, 1 60%)", 0.1, -0.25},
        {"linear(0 20%, 1 60%)", 0.8, 1.5},
        {"linear(0, 0.1, 0.2, 0.3 90%, 1)", 0.45, 0.15},
        {"linear(0, 1)", 1, 1},
        {"linear(0.2, 0.8)", 0, 0.2},
        {"linear(0, -1, 2, 1)", 2 / 3.0, 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        assert_at(cases[i].text, cases[i].u, cases[i].expected, 1e-15);
}

/* ---- Penner's families ---------------------------------------------------------------------
 */

static real expo_reference(real u) {
    return (REAL(pow)(2, 10 * (u - 1)) - REAL(pow)(2, -10)) / (1 - REAL(pow)(2, -10));
}

/* Each family's first half as its textbook prints it. */
static real in_reference(int family, real u) {
    switch (family) {
    case 0:
        return 1 - REAL(cos)(u * REAL_PI / 2);
    case 1:
        return u * u;
    case 2:
        return u * u * u;
    case 3:
        return u * u * u * u;
    case 4:
        return u * u * u * u * u;
    case 5:
        return expo_reference(u);
    case 6:
        return 1 - REAL(sqrt)(1 - u * u);
    case 7:
        return u * u * ((real)1.70158 * u + u - (real)1.70158);
    case 8:
        return expo_reference(u) * REAL(sin)(REAL_PI / 2 + (1 - u) * 2 * REAL_PI / (real)0.3);
    default: {
        real v = 1 - u, k = (real)121 / 16, out;
        if (v < (real)4 / 11)
            out = k * v * v;
        else if (v < (real)8 / 11)
            v -= (real)6 / 11, out = k * v * v + (real)3 / 4;
        else if (v < (real)10 / 11)
            v -= (real)9 / 11, out = k * v * v + (real)15 / 16;
        else
            v -= (real)21 / 22, out = k * v * v + (real)63 / 64;
        return 1 - out;
    }
    }
}

static real family_reference(int family, int way, real u) {
    if (way == 0) return in_reference(family, u);
    if (way == 1) return 1 - in_reference(family, 1 - u);
    return u < (real)0.5 ? in_reference(family, 2 * u) / 2
                         : 1 - in_reference(family, 2 - 2 * u) / 2;
}

static const char *const family_names[] = {"sine", "quad", "cubic", "quart",   "quint",
                                           "expo", "circ", "back",  "elastic", "bounce"};
static const char *const way_names[] = {"in", "out", "in-out"};

/* All thirty: 0 and 1 exactly at the ends, and the textbook's curve in between. */
static void families(void **state) {
    (void)state;
    double worst = 0;
    for (int family = 0; family < 10; family++)
        for (int way = 0; way < 3; way++) {
            char name[32];
            snprintf(name, sizeof name, "%s-%s", family_names[family], way_names[way]);
            zt_ease ease = parse(name);
            assert_true(zt_ease_eval(&ease, 0) == 0);
            assert_true(zt_ease_eval(&ease, 1) == 1);
            for (int i = 1; i < 1000; i++) {
                double u = i / 1000.0, value = zt_ease_eval(&ease, u);
                double error = fabs((double)(value - family_reference(family, way, u)));
                if (!(error <= 1e-14)) fail_msg("%s at %g is off by %g", name, u, error);
                worst = fmax(worst, error);
            }
        }
    printf("  Penner's families: worst error %.2g\n", worst);
}

/* Parameters change what they say: how far back, how high and how often. */
static void parameters(void **state) {
    (void)state;
    assert_at("back-in(0)", 0.5, 0.125, 1e-16);
    assert_at("back-in(3)", 0.5, 0.25 * (4 * 0.5 - 3), 1e-16);
    assert_true(at("back-out(1.70158)", 0.3) == at("back-out", 0.3));
    assert_true(at("elastic-in-out(1, 0.3)", 0.7) == at("elastic-in-out", 0.7));
    assert_at("elastic-in(2, 0.5)", 0.5,
              2 * 31 / 1023.0 * sin(asin(0.5) + 0.5 * 4 * 3.14159265358979323846), 1e-15);
    assert_at("elastic-out(1e3, 1e-3)", 1, 1, 0);
}

/* ---- text ----------------------------------------------------------------------------------
 */

/* What is no easing is refused, with words. */
static void refused(void **state) {
    (void)state;
    static const char *const texts[] = {"",
                                        "eas",
                                        "ease(1)",
                                        "quad",
                                        "in-quad",
                                        "quad-in(2)",
                                        "cubic-bezier",
                                        "cubic-bezier()",
                                        "cubic-bezier(0,0,1)",
                                        "cubic-bezier(0,0,1,1,1)",
                                        "cubic-bezier(0,0,1,x)",
                                        "cubic-bezier(-0.1,0,1,1)",
                                        "cubic-bezier(0,0,1.01,1)",
                                        "cubic-bezier(0,0,nan,1)",
                                        "cubic-bezier(0,0,1,1",
                                        "steps",
                                        "steps()",
                                        "steps(0)",
                                        "steps(-1)",
                                        "steps(1.5)",
                                        "steps(1e300)",
                                        "steps(4, jump)",
                                        "steps(4, jump-end, 1)",
                                        "steps(1, jump-none)",
                                        "linear",
                                        "linear()",
                                        "linear(0,)",
                                        "linear(0, 50%)",
                                        "linear(0 1)",
                                        "linear(0 10% 20% 30%)",
                                        "linear(a)",
                                        "back-in(1,2)",
                                        "elastic-in(1)",
                                        "elastic-in(0.5, 1)",
                                        "elastic-in(1, 0)",
                                        "step-end(1)",
                                        ")",
                                        "(",
                                        "(1)"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        zt_ease ease;
        const char *mistake = zt_ease_parse(&ease, &arena, texts[i]);
        if (!mistake) fail_msg("\"%s\" was taken", texts[i]);
        assert_true(strlen(mistake) > 10);
    }
}

/* Every word of the list is known, alone or with arguments, and comes once. */
static void words(void **state) {
    (void)state;
    int count = 0;
    for (const char *word; (word = zt_ease_word(count)); count++) {
        zt_ease ease;
        const char *mistake = zt_ease_parse(&ease, &arena, word);
        bool is_function = strcmp(word, "cubic-bezier") == 0 || strcmp(word, "steps") == 0 ||
                           strcmp(word, "linear") == 0;
        if ((mistake != NULL) != is_function)
            fail_msg("%s: %s", word, mistake ? mistake : "taken");
        for (int other = 0; other < count; other++)
            assert_string_not_equal(word, zt_ease_word(other));
    }
    assert_int_equal(count, 6 + 3 + 30);
}

/* ---- data of others ------------------------------------------------------------------------
 */

/* Opens a table of the test data and steps over its two head lines. */
static FILE *open_table(const char *name) {
    char path[4096], line[512];
    snprintf(path, sizeof path, "%s/curves/easing/%s", ZT_TEST_DATA_DIR, name);
    FILE *file = fopen(path, "r");
    if (file)
        for (int i = 0; i < 2; i++) assert_non_null(fgets(line, sizeof line, file));
    return file;
}

/* The values that Chromium's tests of cubic-bezier expect. */
static void chromiums_values(void **state) {
    (void)state;
    FILE *file = open_table("cubic_bezier.csv");
    if (!file) skip();
    int count = 0;
    double x1, y1, x2, y2, x, y, tolerance;
    while (fscanf(file, "%lf,%lf,%lf,%lf,%lf,%lf,%lf", &x1, &y1, &x2, &y2, &x, &y,
                  &tolerance) == 7) {
        count++;
        zt_ease ease = {ZT_EASE_BEZIER, .x1 = x1, .y1 = y1, .x2 = x2, .y2 = y2};
        double found = zt_ease_eval(&ease, x);
        if (!(fabs(found - y) <= tolerance))
            fail_msg("cubic-bezier(%g,%g,%g,%g) at %g is %g, not %g", x1, y1, x2, y2, x, found,
                     y);
    }
    fclose(file);
    assert_int_equal(count, 58);
}

/* The values that d3-ease's tests expect. */
static void d3s_values(void **state) {
    (void)state;
    static const char *const names[][2] = {{"SinIn", "sine-in"},
                                           {"QuadIn", "quad-in"},
                                           {"CubicIn", "cubic-in"},
                                           {"PolyIn", "cubic-in"},
                                           {"Linear", "linear(0, 1)"}};
    FILE *file = open_table("penner.csv");
    if (!file) skip();
    int count = 0;
    char name[32];
    double x, y;
    while (fscanf(file, " %31[^,],%lf,%lf", name, &x, &y) == 3) {
        int i = 0;
        while (i < 5 && strcmp(name, names[i][0]) != 0) i++;
        assert_true(i < 5);
        assert_at(names[i][1], x, y, 0.0005 + 1e-12);
        count++;
    }
    fclose(file);
    assert_int_equal(count, 55);
}

static int free_arena(void **state) {
    (void)state;
    zt_arena_free(&arena);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bezier_is_exact), cmocka_unit_test(bezier_rises),
        cmocka_unit_test(bezier_words),    cmocka_unit_test(steps),
        cmocka_unit_test(stops),           cmocka_unit_test(families),
        cmocka_unit_test(parameters),      cmocka_unit_test(refused),
        cmocka_unit_test(words),           cmocka_unit_test(chromiums_values),
        cmocka_unit_test(d3s_values),
    };
    return cmocka_run_group_tests(tests, NULL, free_arena);
}
