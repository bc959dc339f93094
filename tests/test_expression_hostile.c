/* Shows that no expression gets out, hangs, takes the memory or remembers anything: escapes,
 * bombs, random bytes, any order of frames, many threads. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

#include <cmocka.h>

#include "draw.h"
#include "expressions.h"

/* What people try in a sandbox of Lua: none of it compiles, all of it is told. */
static void escapes(void **state) {
    (void)state;
    const char *texts[] = {
        "1 end do",
        "1; os.exit()",
        "1 return 2",
        "(function() return 1 end)()",
        "(function() while true do end end)()",
        "os.execute('id')",
        "io.open('/etc/passwd')",
        "require('os')",
        "package.loadlib('libc.so.6', '*')",
        "debug.getregistry()",
        "load('return 1')()",
        "dofile('/etc/passwd')",
        "string.rep('x', 1e9)",
        "('x'):rep(1e9)",
        "(\"\").format('%99999d', 1)",
        "[[x]]",
        "[==[x]==]",
        "'a' .. 'b'",
        "#'abc'",
        "getmetatable('').__index",
        "setmetatable({}, {})",
        "({1, 2}).__index",
        "({1, 2}).__index.__gc",
        "{1, 2}['__index']",
        "rawset(_G, 'x', 1)",
        "_G",
        "_G.os",
        "_ENV",
        "_ENV.x",
        "_0",
        "_0.x",
        "{x = 1}",
        "{[1] = 2}",
        "{1, 2; 3}",
        "pcall(sin)",
        "error()",
        "coroutine.wrap(sin)",
        "next({1, 2})",
        "pairs({1, 2})",
        "select(2, 1, 2)",
        "tostring(sin)",
        "collectgarbage()",
        "math.random()",
        "...",
        "t, frame",
        "sin{1, 2} 'x'",
        "sin 'x'",
        "t -- a comment",
        "--[[ x ]] 1",
        "goto a ::a::",
        "local t = 1",
        "t = 5",
        "frame == 1 = 2",
        "1) or (2",
        "1) end (function() return 2 end)(",
        "\x1bLua",
        "\x1bLuaS\x01",
        "nil",
        "0 & 1",
        "~0",
        "1 << 2",
        "`id`",
        "$(id)",
        "\\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        const zt_expression *x;
        zt_expression_mistake mistake;
        if (compile(&x, texts[i], 1, &mistake) != ZT_EDESCRIPTION)
            fail_msg("this compiles: %s", texts[i]);
        assert_true(mistake.text[0] && mistake.column >= 1 && mistake.length >= 1);
    }
}

/* `before`, then `count` times `piece`, then `after`, of the caller to free. */
static char *repeated(const char *before, const char *piece, size_t count, const char *after) {
    size_t length = strlen(piece);
    char *text = malloc(strlen(before) + count * length + strlen(after) + 1);
    assert_non_null(text);
    char *at = stpcpy(text, before);
    for (size_t i = 0; i < count; i++) at = stpcpy(at, piece);
    strcpy(at, after);
    return text;
}

/* Texts without end are cut off where they would take too much, and the state works on. */
static void bombs(void **state) {
    (void)state;
    const struct {
        const char *before, *piece;
        size_t count;
        const char *after, *words; /* words in what is told; NULL where there is a value */
    } cases[] = {
        {"", "(", 101, "", "deep"},
        {"", "(", 1000000, "", "too long"},
        {"", "(", 100, "", "never closed"},
        {"", "-\t", 1000, "t", "overflow"},
        {"", "not ", 100000, "t", "overflow"},
        {"", "t^", 1000, "t", "overflow"},
        {"t", "^t", 150, "", NULL},
        {"t", "+t", 40000, "", NULL},
        {"t", "+t", 200000, "", "more than 100000 steps"},
        {"min(1", ",2", 100, ")", "2 to 16"},
        {"min(1", ",2", 300, ")", "too many registers"},
        {"{1", ",2", 100000, "}", "too many registers"},
        {"", "a.", 200000, "a", "nothing is called"},
        {"", "x", 500000, "", "nothing is called"},
        {"", "9", 500000, "", "no number"},
        {"prop('", "x", 500000, "')", "nothing is called"},
        {"prop('", "x", 500000, "", "quotes"},
        {"", "\n", 500000, "t", NULL},
        {"t+", "0.1 + ", 30000, "", "breaks off"},
        {"", "sin(", 90, "t", "never closed"},
        {"t", " + 1 *", 30000, " t", "fit"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *text = repeated(cases[i].before, cases[i].piece, cases[i].count, cases[i].after);
        const zt_expression *x;
        zt_expression_mistake mistake;
        double value;
        zt_status status = compile(&x, text, 1, &mistake);
        if (status == ZT_OK) status = eval(&value, x, 1, &mistake);
        if (status != (cases[i].words ? ZT_EDESCRIPTION : ZT_OK) ||
            (cases[i].words && !strstr(mistake.text, cases[i].words)))
            fail_msg("%s%s ...: %d %s", cases[i].before, cases[i].piece, status, mistake.text);
        free(text);
        assert_true(number_of("1 + t", 1) == 2);
    }
}

/* The limit of memory holds for one text; many may be more than that together. */
static void memory(void **state) {
    (void)state;
    enum { LENGTH = 500000 };
    char *text = malloc(LENGTH + 1), *at = text;
    assert_non_null(text);
    /* A new constant each time: that is what takes most. */
    for (int i = 100000; at < text + LENGTH - 10; i++) at += sprintf(at, "%d*t+", i);
    strcpy(at, "t");
    const zt_expression *x;
    zt_expression_mistake mistake;
    assert_int_equal(compile(&x, text, 1, &mistake), ZT_EDESCRIPTION);
    assert_non_null(strstr(mistake.text, "4 MiB"));
    free(text);
    double value;
    for (int i = 0; i < 20000; i++) {
        char piece[200];
        snprintf(piece, sizeof piece,
                 "%d + sin(t)*cos(2*t)*ball.radius + length(ball.center)*0", i);
        assert_int_equal(compile(&x, piece, 1, &mistake), ZT_OK);
        assert_int_equal(eval(&value, x, 0, &mistake), ZT_OK);
        assert_true(value == i);
    }
}

/* With hundreds of constants, each operator still has its own operands in their order. */
static void many_constants(void **state) {
    (void)state;
    char text[40000], *at = text + sprintf(text, "0");
    double expected = 0, t = 1.375;
    for (int i = 1; i <= 400; i++) {
        at += sprintf(at, " + %d.5*t - (%d.25 - t)/%d.125 + %d.75 %% 7.5 - %d.5^t", i, i + 1000,
                      i + 5000, i + 7000, i);
        expected = expected + (i + 0.5) * t - (i + 1000.25 - t) / (i + 5000.125) +
                   fmod(i + 7000.75, 7.5) - pow(i + 0.5, t);
    }
    assert_true(fabs(number_of(text, t) - expected) <= 1e-12 * fabs(expected));
}

/* Expressions that hold one of everything, as seeds. */
static const char *const seeds[] = {
    "1 + 0.2*sin(2*pi*t)",
    "{ball.center.x, -ball.radius, speed // 2} * 3 % 2",
    "mix(ball.center, prop(\"key light.position\"), smoothstep(0, duration, t))",
    "t < 2 and noise(frame, 3) or random(fps, frame)",
    "length(cross(camera.position, {1, 2e-3, .5})) ^ -0.5",
    "lamp.shadows and face.vertices[3] or normalize({t, 1})[1]",
    "not (t >= 1 or t ~= 3) == true and clamp(atan2(t, 1), 0, 1) or 2 ^ -t",
};
enum { SEED_COUNT = sizeof seeds / sizeof *seeds };

static void mutate(char *text, size_t size, draw *d) {
    static const char *const pieces[] = {
        "end", "function", "_ENV",   "(",  ")",  "{",  "}",  "[",    "]",           "..",
        "--",  "\"",       "prop('", "')", "1e", "0x", "\n", "sin(", "ball.center", ".x",
        "\\",  "\xff",     "\xc3",   "=",  "[[", ":",  "#",  "~",    ",",           "vec("};
    static const char *const alike[] = {"0123456789", "+-*/%^<>"};
    for (int n = 1 + draw_below(d, 3); n > 0; n--) {
        int length = (int)strlen(text), at = draw_below(d, length + 1);
        const char *piece = pieces[draw_below(d, sizeof pieces / sizeof *pieces)];
        int piece_length = (int)strlen(piece), cut = draw_below(d, 6);
        switch (draw_below(d, 12)) {
        case 0: /* another byte */
            if (at < length) text[at] = (char)(1 + draw_below(d, 255));
            break;
        case 1: /* something left out */
            if (at + cut <= length)
                memmove(text + at, text + at + cut, (size_t)(length - at - cut + 1));
            break;
        case 2: /* something put in */
            if ((size_t)(length + piece_length) < size) {
                memmove(text + at + piece_length, text + at, (size_t)(length - at + 1));
                memcpy(text + at, piece, (size_t)piece_length);
            }
            break;
        case 3: /* the end of another one */
            snprintf(text + at, size - (size_t)at, "%s",
                     seeds[draw_below(d, SEED_COUNT)] + draw_below(d, 20));
            break;
        default: /* another digit or sign of the same kind: this often still compiles */
            at += (int)strcspn(text + at, alike[0]);
            if (text[at]) text[at] = alike[0][draw_below(d, 10)];
            at = draw_below(d, length + 1);
            at += (int)strcspn(text + at, alike[1]);
            if (text[at]) text[at] = alike[1][draw_below(d, 8)];
        }
    }
}

/* Random changes of good expressions, and random bytes: each has a finite value or a mistake
 * with words and a place within the text. */
static void random_texts(void **state) {
    (void)state;
    draw d = {7, 0};
    int compiled = 0, valued = 0;
    for (int round = 0; round < 20000; round++) {
        char text[300];
        snprintf(text, sizeof text, "%s", seeds[round % SEED_COUNT]);
        if (round % 10 == 9) {
            int length = draw_below(&d, 60);
            for (int i = 0; i < length; i++) text[i] = (char)(1 + draw_below(&d, 255));
            text[length] = '\0';
        } else
            mutate(text, sizeof text, &d);
        int widths[] = {1, 2, 3, ZT_EXPRESSION_SWITCH}, width = widths[draw_below(&d, 4)];
        const zt_expression *x;
        zt_expression_mistake mistake;
        double value[3];
        zt_status status = compile(&x, text, width, &mistake);
        compiled += status == ZT_OK;
        if (status == ZT_OK) status = eval(value, x, draw_between(&d, -5, 5), &mistake);
        valued += status == ZT_OK;
        if (status == ZT_OK)
            for (int c = 0; c < width; c++) assert_true(isfinite(value[c]));
        else if (status != ZT_EDESCRIPTION || !mistake.text[0] || mistake.column < 1 ||
                 mistake.length < 1 ||
                 mistake.column + mistake.length > (int)fmax(2, (double)strlen(text) + 1))
            fail_msg("%s: %d, %d+%d: %s", text, status, mistake.column, mistake.length,
                     mistake.text);
    }
    printf("  %d of 20000 compile, %d have a value\n", compiled, valued);
    assert_in_range(compiled, 1000, 15000);
    assert_in_range(valued, 500, 15000);
}

enum { FRAMES = 300, EXPRESSIONS = 6 };

typedef struct film {
    const zt_expression *expressions[EXPRESSIONS];
    double values[EXPRESSIONS][FRAMES][3];
} film;

static const int film_widths[EXPRESSIONS] = {1, 3, 3, 1, 1, 1};

static void eval_frame(double *value, const film *f, int expression, int frame) {
    zt_expression_mistake mistake;
    if (eval(value, f->expressions[expression], (frame + 1) / 24.0, &mistake) != ZT_OK) abort();
}

static film *make_film(void) {
    film *f = calloc(1, sizeof *f);
    assert_non_null(f);
    for (int i = 0; i < EXPRESSIONS; i++) {
        zt_expression_mistake mistake;
        assert_int_equal(compile(&f->expressions[i], seeds[i], film_widths[i], &mistake),
                         ZT_OK);
        for (int frame = 0; frame < FRAMES; frame++)
            eval_frame(f->values[i][frame], f, i, frame);
    }
    return f;
}

static bool same_bits(const film *f, int expression, int frame) {
    double value[3];
    eval_frame(value, f, expression, frame);
    return memcmp(value, f->values[expression][frame],
                  (size_t)film_widths[expression] * sizeof *value) == 0;
}

/* Frames forwards, backwards and at random, with failures in between: the same bits. */
static void any_order(void **state) {
    (void)state;
    film *f = make_film();
    const zt_expression *bad;
    zt_expression_mistake mistake;
    assert_int_equal(compile(&bad, "{1, 2} + {ball.center, t > 1}", 3, &mistake), ZT_OK);
    draw d = {3, 0};
    for (int i = 0; i < EXPRESSIONS; i++)
        for (int frame = FRAMES - 1; frame >= 0; frame--) assert_true(same_bits(f, i, frame));
    for (int round = 0; round < 20000; round++) {
        double value[3];
        if (round % 7 == 0) assert_int_equal(eval(value, bad, 1, &mistake), ZT_EDESCRIPTION);
        assert_true(same_bits(f, draw_below(&d, EXPRESSIONS), draw_below(&d, FRAMES)));
    }
    /* Another state, as of another run, gives them too. */
    zt_expressions *first = all;
    assert_int_equal(door->open(&all, (zt_rate){24, 1}, 10), ZT_OK);
    film *again = make_film();
    assert_memory_equal(again->values, f->values, sizeof f->values);
    door->close(&all);
    all = first;
    free(again);
    free(f);
}

static int eval_many(void *user) {
    film *f = user;
    draw d = {(uint64_t)(uintptr_t)&d, 0};
    int different = 0;
    for (int round = 0; round < 10000; round++) {
        different += !same_bits(f, draw_below(&d, EXPRESSIONS), draw_below(&d, FRAMES));
        if (round % 100 == 0) {
            zt_expression_mistake mistake;
            const zt_expression *x;
            different += compile(&x, seeds[round / 100 % SEED_COUNT], 1, &mistake) != ZT_OK;
            different += compile(&x, "1 +", 1, &mistake) != ZT_EDESCRIPTION;
        }
    }
    return different;
}

/* From several threads at once, some of them compiling: the same bits. */
static void many_threads(void **state) {
    (void)state;
    enum { THREADS = 4 };
    film *f = make_film();
    thrd_t threads[THREADS];
    for (int i = 0; i < THREADS; i++)
        assert_int_equal(thrd_create(&threads[i], eval_many, f), thrd_success);
    for (int i = 0; i < THREADS; i++) {
        int different;
        thrd_join(threads[i], &different);
        assert_int_equal(different, 0);
    }
    free(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(escapes),      cmocka_unit_test(bombs),
        cmocka_unit_test(memory),       cmocka_unit_test(many_constants),
        cmocka_unit_test(random_texts), cmocka_unit_test(any_order),
        cmocka_unit_test(many_threads),
    };
    return cmocka_run_group_tests(tests, open_film, close_film);
}
