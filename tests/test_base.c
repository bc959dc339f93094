/* Shows that memory, text, checksums and messages do what their headers promise. */
#include <limits.h>
#include <locale.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/arena.h"
#include "base/diag.h"
#include "base/hash.h"
#include "base/pages.h"
#include "base/text.h"

/* XXH3's checksum of nothing, from its specification. */
static void checksums(void **state) {
    (void)state;
    zt_hash nothing = zt_hash_bytes("", 0);
    assert_true(nothing.high == UINT64_C(0x99AA06D3014798D8));
    assert_true(nothing.low == UINT64_C(0x6001C324468D497F));
    zt_hash other = zt_hash_bytes("\0", 1);
    assert_true(other.high != nothing.high && other.low != nothing.low);
}

/* Digits as they are printed are read, all 64 bits of each half, and nothing else is. */
static void checksums_are_read(void **state) {
    static const char *const refused[] = {"",
                                          "0123456789abcdeffedcba987654321",
                                          "0123456789abcdeffedcba98765432100",
                                          "0123456789abcdeffedcba987654321F",
                                          " 123456789abcdeffedcba9876543210",
                                          "0123456789abcdef-edcba9876543210",
                                          "0x23456789abcdeffedcba9876543210"};
    (void)state;
    zt_hash hash;
    assert_true(zt_hash_read(&hash, "ffffffffffffffff0123456789abcdef"));
    assert_true(hash.high == UINT64_MAX && hash.low == UINT64_C(0x0123456789abcdef));
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        assert_false(zt_hash_read(&hash, refused[i]));
}

/* Pieces are zero, aligned and apart from each other, in the first round and in the next. */
static void arena_pieces(void **state) {
    (void)state;
    enum { COUNT = 300 };
    zt_arena arena = {0};
    unsigned char *pieces[COUNT], *first_round[COUNT];
    for (int round = 0; round < 2; round++) {
        for (int i = 0; i < COUNT; i++) {
            size_t size = (size_t)i * 37;
            pieces[i] = zt_arena_push(&arena, size);
            assert_non_null(pieces[i]);
            assert_int_equal((uintptr_t)pieces[i] % 64, 0);
            for (size_t k = 0; k < size; k++) assert_int_equal(pieces[i][k], 0);
            memset(pieces[i], i % 255 + 1, size);
            if (round == 0)
                first_round[i] = pieces[i];
            else
                assert_ptr_equal(pieces[i], first_round[i]); /* the same memory serves again */
        }
        for (int i = 0; i < COUNT; i++)
            for (size_t k = 0; k < (size_t)i * 37; k++)
                assert_int_equal(pieces[i][k], i % 255 + 1);
        zt_arena_reset(&arena);
    }
    zt_arena_free(&arena);
    assert_null(arena.first);
    zt_arena_free(&arena);
}

/* A piece larger than any chunk fits, chunks too small for it are passed over and used again,
 * and sizes beyond all memory are refused. */
static void arena_large_and_absurd(void **state) {
    (void)state;
    zt_arena arena = {0};
    void *small = zt_arena_push(&arena, 100);
    assert_non_null(small);
    char *large = zt_arena_push(&arena, 5 * 1000 * 1000);
    assert_non_null(large);
    large[5 * 1000 * 1000 - 1] = 1;
    zt_arena_reset(&arena);
    assert_ptr_equal(zt_arena_push(&arena, 5 * 1000 * 1000), large);
    zt_arena_reset(&arena);
    assert_ptr_equal(zt_arena_push(&arena, 100), small);

    assert_null(zt_arena_push(&arena, SIZE_MAX));
    assert_null(zt_arena_push(&arena, SIZE_MAX / 2));
    assert_null(ZT_PUSH(&arena, double, SIZE_MAX / 8 + 1));
    assert_non_null(ZT_PUSH(&arena, double, 0));
    assert_string_equal(zt_arena_push_text(&arena, "keyframe", 3), "key");
    zt_arena_free(&arena);
}

/* Distances counted by hand; the longest texts that are compared, and those beyond. */
static void text_distances(void **state) {
    (void)state;
    const struct {
        const char *a, *b;
        int distance;
    } pairs[] = {
        {"", "", 0},
        {"", "abc", 3},
        {"abc", "", 3},
        {"color", "color", 0},
        {"colr", "color", 1},
        {"colour", "color", 1},
        {"clor", "color", 1},
        {"cloor", "color", 1},
        {"ocler", "color", 2},
        {"center", "centre", 1},
        {"kitten", "sitting", 3},
        {"ab", "ba", 1},
        {"abc", "xyz", 3},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        assert_int_equal(zt_text_distance(pairs[i].a, pairs[i].b), pairs[i].distance);
        assert_int_equal(zt_text_distance(pairs[i].b, pairs[i].a), pairs[i].distance);
    }
    char as[65], bs[65];
    memset(as, 'a', 64), memset(bs, 'b', 64);
    as[64] = bs[64] = '\0';
    assert_int_equal(zt_text_distance(as, bs), 64);
    assert_int_equal(zt_text_distance(as, "a"), 64);
    assert_int_equal(zt_text_distance(as + 1, bs + 1), 63);
    assert_int_equal(zt_text_distance(as + 1, as + 2), 1);
}

/* The nearest name is offered where it is near, and nothing where all are far. */
static void nearest_names(void **state) {
    (void)state;
    const struct {
        const char *wanted, *nearest;
    } pairs[] = {
        {"colr", "color"},    {"reflectivty", "reflectivity"},
        {"center", "center"}, {"xyz", NULL},
        {"", NULL},           {"q", NULL},
        {"raduis", "radius"},
    };
    const char *const names[] = {"color", "reflectivity", "radius", "center", "x"};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        zt_nearest nearest = zt_nearest_to(pairs[i].wanted);
        for (int k = 0; k < 5; k++) zt_nearest_try(&nearest, names[k]);
        if (pairs[i].nearest)
            assert_string_equal(nearest.best, pairs[i].nearest);
        else
            assert_null(nearest.best);
    }
}

/* Decimal numbers and nothing else, whatever the locale's decimal point. */
static void numbers(void **state) {
    (void)state;
    const struct {
        const char *text;
        double value;
    } good[] = {{"0", 0},  {"-1.5", -1.5}, {"+.5", 0.5}, {"1e3", 1000},
                {"2.", 2}, {"1E-2", 0.01}, {"0.1", 0.1}, {"1e-999", 0}};
    const char *bad[] = {"",    "-",  ".",  "e5",  "1e",    "1e999", "0x10",  "nan",
                         "inf", " 1", "1 ", "1,5", "1.2.3", "--1",   "1_000", "infinity"};
    const char *locales[] = {"C",
                             "de_DE.UTF-8"}; /* the second one only where it is installed */
    for (int l = 0; l < 2; l++) {
        setlocale(LC_ALL, locales[l]);
        for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
            double value = 77;
            assert_true(zt_text_number(&value, good[i].text, strchr(good[i].text, '\0')));
            assert_true(value == good[i].value);
        }
        for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
            double value = 77;
            if (zt_text_number(&value, bad[i], strchr(bad[i], '\0')))
                fail_msg("\"%s\" was taken for %g", bad[i], value);
            assert_true(value == 77);
        }
    }
    setlocale(LC_ALL, "C");
    double value;
    const char inside[] = "12\0"
                          "34";
    assert_false(zt_text_number(&value, inside, inside + 5));
    assert_true(zt_text_number(&value, "125", "125" + 2) && value == 12);
    char digits[500];
    memset(digits, '1', sizeof digits);
    assert_false(zt_text_number(&value, digits, digits + sizeof digits));
}

static void text_helpers(void **state) {
    (void)state;
    assert_true(zt_text_ends_with("film.MP4", ".mp4", true));
    assert_false(zt_text_ends_with("film.MP4", ".mp4", false));
    assert_false(zt_text_ends_with("mp4", ".mp4", true));
    assert_true(zt_text_equal("a", "a") && !zt_text_equal("a", "A"));
    char *text = zt_text_print("%s.%04d", "frame", 7);
    assert_string_equal(text, "frame.0007");
    free(text);
}

/* Keeps what was told, formatted. */
typedef struct notebook {
    char text[32 * 1024];
    zt_severity severity;
    int count;
} notebook;

static void note(void *user, const zt_message *message) {
    notebook *book = user;
    size_t length = zt_message_format(book->text, sizeof book->text, message);
    assert_int_equal(length, strlen(book->text));
    book->severity = message->severity;
    book->count++;
}

/* Messages look as compilers' do, with the caret below its character: after tabs, after letters
 * of more than one byte, at the end of the line, far out on a long line. */
static void messages(void **state) {
    (void)state;
    notebook book = {0};
    zt_listener listener = {note, &book};
    zt_tell(listener, ZT_WARNING, "%d of %s", 3, "these");
    assert_string_equal(book.text, "zoetrope: warning: 3 of these");
    assert_int_equal(book.severity, ZT_WARNING);

    zt_place place = {"lamp.yaml", "      colr: [1, 0.8, 0.6]\nnext", 12, 7, 4};
    zt_tell_at(listener, ZT_ERROR, &place, "unknown key \"%s\"", "colr");
    assert_string_equal(book.text, "lamp.yaml:12:7: error: unknown key \"colr\"\n"
                                   "   12 |       colr: [1, 0.8, 0.6]\n"
                                   "      |       ^~~~");
    place = (zt_place){"a.yaml", "\t\xC3\xA9\xE2\x82\xAC: x", 1234567, 3, 9};
    zt_tell_at(listener, ZT_NOTE, &place, "here");
    assert_string_equal(book.text, "a.yaml:1234567:3: note: here\n"
                                   "1234567 | \t\xC3\xA9\xE2\x82\xAC: x\n"
                                   "        | \t ^~~~");
    place = (zt_place){"a.yaml", "ab\r\n", 1, 3, 0};
    zt_tell_at(listener, ZT_ERROR, &place, "more is expected");
    assert_string_equal(book.text, "a.yaml:1:3: error: more is expected\n"
                                   "    1 | ab\n"
                                   "      |   ^");
    place = (zt_place){"a.yaml", NULL, 4, 2, 1};
    zt_tell_at(listener, ZT_ERROR, &place, "x");
    assert_string_equal(book.text, "a.yaml:4:2: error: x");
    place = (zt_place){"a.yaml", NULL, 0, 0, 0};
    zt_tell_at(listener, ZT_ERROR, &place, "x");
    assert_string_equal(book.text, "a.yaml: error: x");
    zt_tell_at(listener, ZT_ERROR, NULL, "x");
    assert_string_equal(book.text, "zoetrope: error: x");

    char line[5001];
    memset(line, '.', 5000);
    line[5000] = '\0';
    memcpy(line + 4000, "wrong", 5);
    place = (zt_place){"a.yaml", line, 1, 4001, 5};
    zt_tell_at(listener, ZT_ERROR, &place, "x");
    const char *shown = strstr(book.text, "wrong"), *caret = strstr(book.text, "^~~~~");
    assert_non_null(shown);
    assert_non_null(caret);
    const char *first = strchr(book.text, '\n') + 1, *second = strchr(first, '\n') + 1;
    assert_int_equal(shown - first, caret - second);
    assert_in_range(second - first, 60, 200);
    assert_int_equal(book.count, 8);
}

/* Nothing is heard without a listener; control characters do not reach a terminal; long
 * messages are cut at the buffer's end and their whole length is told. */
static void messages_at_the_edge(void **state) {
    (void)state;
    zt_tell((zt_listener){NULL, NULL}, ZT_ERROR, "unheard");
    notebook book = {0};
    zt_listener listener = {note, &book};
    zt_place place = {"a\x1b[2J.yaml", "key:\t\x1b]0;title\x07 \x7f", 1, 1, 1};
    zt_tell_at(listener, ZT_ERROR, &place, "no \x1b[31m colours");
    for (const char *c = book.text; *c; c++)
        assert_true((unsigned char)*c >= 0x20 ? *c != 0x7F : *c == '\n' || *c == '\t');

    char path[4096];
    memset(path, 'p', sizeof path);
    path[sizeof path - 1] = '\0';
    zt_tell(listener, ZT_ERROR, "cannot open %s: no such file", path);
    assert_non_null(strstr(book.text, ": no such file"));

    zt_message message = {.severity = ZT_ERROR, .text = "0123456789"};
    char small[8] = "xxxxxxx";
    assert_int_equal(zt_message_format(small, sizeof small, &message),
                     strlen("zoetrope: error: ") + 10);
    assert_string_equal(small, "zoetrop");
    assert_int_equal(zt_message_format(NULL, 0, &message), strlen("zoetrope: error: ") + 10);

    /* Numbers that make no sense, and bytes that are no UTF-8, do no harm. */
    message = (zt_message){ZT_ERROR, "x", "f", 1, INT_MAX, INT_MAX, "\x80\xff\xc3"};
    assert_true(zt_message_format(book.text, sizeof book.text, &message) > 0);
    message.column = -5;
    assert_true(zt_message_format(book.text, sizeof book.text, &message) > 0);
}

static void every_status_has_words(void **state) {
    (void)state;
    for (int i = ZT_OK; i <= ZT_ESTOPPED; i++)
        for (int k = ZT_OK; k < i; k++)
            assert_string_not_equal(zt_status_text((zt_status)i), zt_status_text((zt_status)k));
    assert_non_null(zt_status_text((zt_status)1000));
}

/* Memory of any size is all there, begins at a line of a cache, and is free()'s. */
static void pages_are_lines(void **state) {
    (void)state;
    const size_t sizes[] = {1, 64, 1000, (size_t)1 << 21, ((size_t)1 << 22) + 5};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        char *memory = zt_pages_alloc(sizes[i]);
        assert_non_null(memory);
        assert_int_equal((uintptr_t)memory % 64, 0);
        memset(memory, 7, sizes[i]);
        assert_int_equal(memory[sizes[i] - 1], 7);
        free(memory);
    }
    assert_null(zt_pages_alloc(SIZE_MAX / 2));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(checksums),
        cmocka_unit_test(checksums_are_read),
        cmocka_unit_test(arena_pieces),
        cmocka_unit_test(arena_large_and_absurd),
        cmocka_unit_test(text_distances),
        cmocka_unit_test(nearest_names),
        cmocka_unit_test(numbers),
        cmocka_unit_test(text_helpers),
        cmocka_unit_test(pages_are_lines),
        cmocka_unit_test(messages),
        cmocka_unit_test(messages_at_the_edge),
        cmocka_unit_test(every_status_has_words),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
