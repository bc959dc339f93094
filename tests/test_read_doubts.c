/* Shows that what is legal in keys and probably not meant is warned of, once and at its place,
 * and that what is usual is not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"

#define FILM                                                                                   \
    "zoetrope: 1\nfilm: { duration: 2 s, rate: 24 }\ncamera: {}\nlights: [ambient: {}]\n"

/* What is told of a property of a group: the text of each line behind its place. */
static void assert_doubts(const char *property, const char *expected) {
    static told t;
    zt_animation *animation;
    char text[1024];
    snprintf(text, sizeof text, FILM "objects: [ group: { objects: [],\n%s } ]\n", property);
    assert_int_equal(read_told(&t, &animation, text), ZT_OK);
    if (strcmp(t.lines, expected) != 0)
        fail_msg("%s: told is\n%sinstead of\n%s", property, t.lines, expected);
    zt_animation_free(&animation);
}

/* What everybody writes. */
static void nothing(void **state) {
    (void)state;
    static const char *const properties[] = {
        "position: { keys: { 0 s: [0, 0, 0], 2 s: [1, 0, 0] } }",
        "position: { keys: { 0: [0, 0, 0], 47: [1, 0, 0], 100 %: [2, 0, 0] } }",
        "position: { keys: { 333.3333333 ms: [0, 0, 0], 1 s: [1, 0, 0] } }",
        "position: { after: loop, keys: { 0 s: [0, 0, 0], 3 s: [1, 0, 0] } }",
        "position: { before: linear, keys: { -1 s: [0, 0, 0], 1 s: [1, 0, 0] } }",
        "position: { curve: hold, keys: { 0 s: [0, 0, 0], 1: [1, 0, 0], 2: [5, 0, 0] } }",
        "rotation: { keys: { 0 s: [0, 0, 0], 1 s: [0, 178.9, 0] } }",
        "rotation: { keys: { 0 s: [0, 0, 0], 1 s: [0, 181.1, 0] } }",
        "rotation: { curve: hold, keys: { 0 s: [0, 0, 0], 1 s: [0, 180, 0] } }",
        "rotation: { in: turns, keys: { 0 s: [0, 0, 0], 1 s: [0, 180, 0] } }",
        "rotation: { keys: { 0: { axis: [0, 1, 0], angle: 0 }, 9: { axis: [0, 1, 0], angle: "
        "540 } } }",
        "position: { curve: bezier, keys: { 0 s: { value: [0, 0, 0], out: { time: 1 s } }, 1 "
        "s: "
        "{ value: [1, 0, 0], in: { time: -1 s } } } }",
    };
    for (size_t i = 0; i < sizeof properties / sizeof *properties; i++)
        assert_doubts(properties[i], "");
}

static void times(void **state) {
    (void)state;
    assert_doubts("position: { keys: { -2 s: [3, 0, 0], -1 s: [0, 0, 0], 1 s: [1, 0, 0] } }",
                  "6:38: warning: the key at \"-1 s\" is before the film\n");
    assert_doubts("position: { keys: { 0 s: [0, 0, 0], 49: [1, 0, 0], 50: [2, 0, 0] } }",
                  "6:37: warning: the key at \"49\" is after the film, which ends at 2 s\n");
    assert_doubts(
        "position: { keys: { 0 s: [0, 0, 0], 0.3 s: [1, 0, 0], 0.7 s: [2, 0, 0] } }",
        "6:37: warning: the key at \"0.3 s\" is between the frames 7 and 8: none shows "
        "it\n");
}

static void jumps(void **state) {
    (void)state;
    assert_doubts(
        "position: { keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0], 1.001 s: [9, 0, 0] } }",
        "6:53: warning: the key at \"1.001 s\" is between the frames 24 and 25: none shows it\n"
        "6:53: warning: \"1.001 s\" is 0.024 frames after the key before it, and the value "
        "jumps; \"curve: hold\" jumps at a key\n");
}

static void half_turns(void **state) {
    (void)state;
    static const char words[] = "half a turn from the key before it: both ways round are as "
                                "short; a key between them says which one\n";
    static const char *const keys[] = {"[0, 180, 0]", "[180, 0, 0]",
                                       "{ axis: [1, 2, 3], angle: -180 }",
                                       "{ quaternion: [0, 0, 3, 4] }", "[0, 179.99995, 0]"};
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        char property[256], expected[256];
        snprintf(property, sizeof property, "rotation: { keys: { 0 s: [0, 0, 0], 1 s: %s } }",
                 keys[i]);
        snprintf(expected, sizeof expected, "6:37: warning: %s", words);
        assert_doubts(property, expected);
    }
    static const char near[] =
        "6:37: warning: nearly half a turn from the key before it: a little "
        "more, and it goes the other way round; a key between them says "
        "which one\n";
    assert_doubts("rotation: { keys: { 0 s: [0, 0, 0], 1 s: [0, 179.1, 0] } }", near);
    assert_doubts("rotation: { keys: { 0 s: [0, 0, 0], 1 s: [0, 180.9, 0] } }", near);
}

static void handles(void **state) {
    (void)state;
    assert_doubts(
        "position: { curve: bezier, keys: { 0 s: { value: [0, 0, 0], out: { time: -3 } },\n"
        "  1 s: { value: [0, 0, 0], in: { time: 3 } } } }",
        "6:74: warning: time runs backwards here: an \"out\" handle is after its key; 0 "
        "s is taken\n"
        "7:40: warning: time runs backwards here: an \"in\" handle is before its key; 0 "
        "s is taken\n");
    assert_doubts(
        "position: { curve: bezier, keys: { 0 s: { value: [0, 0, 0], out: { time: 25 } },\n"
        "  1 s: { value: [0, 0, 0], in: { time: -30 } } } }",
        "6:36: warning: the \"out\" handle of this key is longer than the way, which "
        "would run backwards; it is shortened to it\n"
        "7:3: warning: the \"in\" handle of this key is longer than the way, which would "
        "run backwards; it is shortened to it\n");
}

/* What is too large for numbers is told, and finite. */
static void giants(void **state) {
    (void)state;
    assert_doubts(
        "position: { curve: hermite, keys: { 0 s: { value: [1e308, 0, 0], out: [1e308, 0, "
        "0] }, 2 s: [0, 0, 0] } }",
        "");
    assert_doubts(
        "position: { curve: hermite, keys: { 0 s: { value: [1.5e308, 0, 0], out: [1e308, "
        "0, 0] }, 2 s: [0, 0, 0] } }",
        "6:37: warning: \"position\" would move further than numbers reach; it goes as "
        "far as they do\n");
}

/* Things that share their keys share the warning; and there is an end to them. */
static void told_once(void **state) {
    (void)state;
    static told t;
    zt_animation *animation;
    static char text[64 * 1024] =
        FILM "curves: { turn: { keys: { 0 s: [0, 0, 0], 1 s: [0, 180, 0] } } }\nobjects:\n";
    for (int i = 0; i < 300; i++)
        strcat(text, "  - group: { objects: [], rotation: { use: turn } }\n");
    assert_int_equal(read_told(&t, &animation, text), ZT_OK);
    assert_int_equal(t.warning_count, 1);
    zt_animation_free(&animation);
    for (int i = 0; i < 150; i++)
        strcat(text, "  - group: { objects: [], scale: { keys: { 0.3 s: 1, 1 s: 1 } } }\n");
    assert_int_equal(read_told(&t, &animation, text), ZT_OK);
    assert_int_equal(t.warning_count, 100);
    assert_non_null(strstr(t.lines, "note: warnings that are not shown: 51\n"));
    zt_animation_free(&animation);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing),    cmocka_unit_test(times),   cmocka_unit_test(jumps),
        cmocka_unit_test(half_turns), cmocka_unit_test(handles), cmocka_unit_test(giants),
        cmocka_unit_test(told_once),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
