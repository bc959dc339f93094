/* Which frames a text names, and in which order. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>
#include <zoetrope/frames.h>

#include "told.h"

/* The numbers as a text: "1 6 11". */
static const char *listed(const zt_frames *frames) {
    static char text[4096];
    int length = 0;
    text[0] = 0;
    for (int64_t i = 0; i < frames->count; i++)
        length += snprintf(text + length, sizeof text - (size_t)length, "%s%lld", i ? " " : "",
                           (long long)frames->numbers[i]);
    return text;
}

static void assert_frames(const char *text, const char *expected) {
    static told t;
    zt_frames frames;
    t = (told){.file = ""};
    if (zt_frames_read(&frames, text, 100, told_to(&t)) != ZT_OK) fail_msg("%s", t.lines);
    assert_string_equal(listed(&frames), expected);
    zt_frames_free(&frames);
    assert_null(frames.numbers);
}

static void assert_refused(const char *text, const char *why) {
    static told t;
    zt_frames frames;
    t = (told){.file = ""};
    assert_int_equal(zt_frames_read(&frames, text, 100, told_to(&t)), ZT_EARGUMENT);
    assert_null(frames.numbers);
    if (!strstr(t.lines, why)) fail_msg("\"%s\", not \"%s\"", t.lines, why);
}

static void ranges(void **state) {
    (void)state;
    assert_frames("7", "7");
    assert_frames("0", "0");
    assert_frames("1-5", "1 2 3 4 5");
    assert_frames("5-1", "5 4 3 2 1");
    assert_frames("1-20x5", "1 6 11 16");
    assert_frames("20-1x5", "20 15 10 5");
    assert_frames(" 1 - 3 , 9 ", "1 2 3 9");
    assert_frames("1,5,9-12", "1 5 9 10 11 12");
    assert_frames("-1", "99");
    assert_frames("-3--1", "97 98 99");
    assert_frames("98--1", "98 99");
    assert_frames("-100", "0");
    assert_frames("3,1-5,4", "3 1 2 4 5");
    assert_frames("1-5x1000000000000", "1");
}

/* Every tenth first, and at each moment what is there covers the range evenly; none is left
 * out, none comes twice. */
static void spread(void **state) {
    (void)state;
    zt_frames frames;
    assert_frames("0-9:4", "0 4 8 2 6 1 5 9 3 7");
    assert_frames("9-0:4", "9 5 1 7 3 8 4 0 6 2");
    assert_frames("0-4:1", "0 1 2 3 4");
    assert_frames("0-4:100", "0 4 2 1 3");
    assert_int_equal(zt_frames_read(&frames, "0-99:10", 100, (zt_listener){0}), ZT_OK);
    assert_int_equal(frames.count, 100);
    for (int i = 0; i < 10; i++) assert_int_equal(frames.numbers[i], 10 * i);
    zt_frames_sort(&frames);
    for (int i = 0; i < 100; i++) assert_int_equal(frames.numbers[i], i);
    zt_frames_free(&frames);
}

static void mistakes(void **state) {
    (void)state;
    assert_refused("", "a frame's number belongs here");
    assert_refused("1-", "a frame's number belongs here");
    assert_refused("1,,2", "at \",2\": a frame's number belongs here");
    assert_refused("1-5y2", "at \"y2\"");
    assert_refused("1-5x", "a frame's number belongs here");
    assert_refused("1-5x0", "at least 1");
    assert_refused("1-5:-2", "at least 1");
    assert_refused("100", "there is no frame 100: the film has frames 0 to 99");
    assert_refused("-101", "there is no frame -101");
    assert_refused("0-99999999999999999999999", "there is no frame");
    assert_refused("all", "at \"all\"");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(ranges), cmocka_unit_test(spread),
                                       cmocka_unit_test(mistakes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
