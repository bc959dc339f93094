/* What two lists have in common is paired in order, whatever came, went or stands elsewhere;
 * and a small edit costs what it changes, wherever it is. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "draw.h"
#include "tracer/pairing.h"

enum { MOST = 40 };

/* Lists of letters; as rows that hold more than their hashes. */
typedef struct row {
    int64_t other;
    zt_hash hash;
} row;

typedef struct list {
    int count;
    row rows[MOST];
} list;

/* All hashes stand in few places of a table, so that they are in each other's way there. */
static row row_of(int letter) { return (row){-1, {(uint64_t)letter % 3, (uint64_t)letter}}; }

static list list_of(const char *letters) {
    list l = {0};
    for (; *letters; letters++) l.rows[l.count++] = row_of(*letters);
    return l;
}

static bool equal(const row *a, const row *b) { return zt_hash_equal(a->hash, b->hash); }

static bool is_among(const row *it, const list *l, int begin, int end) {
    bool among = false;
    for (int i = begin; i < end; i++) among |= equal(&l->rows[i], it);
    return among;
}

/* How many pairs of equals come, each list being told completely and in order. Those that are
 * paired and not equal are not further on in the other list, but for what both end with. */
static int count_pairs(const list *a, const list *b) {
    zt_arena arena = {0};
    zt_pairing p = {.before = {&a->rows->hash, sizeof(row), a->count},
                    .now = {&b->rows->hash, sizeof(row), b->count}};
    int32_t i, k, before = 0, now = 0;
    int pairs = 0, ending = 0;
    while (ending < a->count && ending < b->count &&
           equal(&a->rows[a->count - 1 - ending], &b->rows[b->count - 1 - ending]))
        ending++;
    assert_int_equal(zt_pairing_begin(&p, &arena), ZT_OK);
    while (zt_pairing_next(&i, &k, &p)) {
        assert_true(i >= 0 || k >= 0);
        if (i >= 0) assert_int_equal(i, before++);
        if (k >= 0) assert_int_equal(k, now++);
        bool same = i >= 0 && k >= 0 && equal(&a->rows[i], &b->rows[k]);
        pairs += same;
        if (same || i < 0 || k < 0) continue;
        assert_false(is_among(&b->rows[k], a, i + 1, a->count - ending));
        assert_false(is_among(&a->rows[i], b, k + 1, b->count - ending));
    }
    assert_int_equal(before, a->count);
    assert_int_equal(now, b->count);
    zt_arena_free(&arena);
    return pairs;
}

static int pairs_of(const char *a, const char *b) {
    list before = list_of(a), now = list_of(b);
    return count_pairs(&before, &now);
}

/* Of each example, how many are paired is plain to see. */
static void edits_cost_what_they_change(void **state) {
    (void)state;
    assert_int_equal(pairs_of("", ""), 0);
    assert_int_equal(pairs_of("", "ab"), 0);
    assert_int_equal(pairs_of("ab", ""), 0);
    assert_int_equal(pairs_of("abcdefgh", "abcdefgh"), 8);
    assert_int_equal(pairs_of("abcdefgh", "abcdXefgh"), 8);
    assert_int_equal(pairs_of("abcdefgh", "abdefgh"), 7);
    assert_int_equal(pairs_of("abcdefgh", "abXdefgh"), 7);
    assert_int_equal(pairs_of("abcdefgh", "bcdefgha"), 7); /* the first becomes the last, */
    assert_int_equal(pairs_of("abcdefgh", "habcdefg"), 7); /* the last the first; */
    assert_int_equal(pairs_of("abcdefgh", "ahcdefgb"), 6); /* two change places */
    assert_int_equal(pairs_of("abcdefgh", "XabcdYefghZ"), 8);
    assert_int_equal(pairs_of("abcdefgh", "cdfh"), 4);
    assert_int_equal(pairs_of("aaaa", "aa"), 2);
    assert_int_equal(pairs_of("aaXaa", "aaaa"), 4);
    assert_int_equal(pairs_of("XaYbX", "bXZa"), 2);
}

/* One thing comes or goes, anywhere among others of which many are alike: all others are
 * paired. And any two lists are told completely. */
static void random_lists(void **state) {
    (void)state;
    draw d = {3, 0};
    for (int n = 0; n < 20000; n++) {
        list a = {0}, b;
        int alphabet = 1 + draw_below(&d, 12);
        a.count = draw_below(&d, MOST);
        for (int i = 0; i < a.count; i++) a.rows[i] = row_of(draw_below(&d, alphabet));
        b = a;
        int at = draw_below(&d, a.count + 1);
        for (int i = b.count++; i > at; i--) b.rows[i] = b.rows[i - 1];
        b.rows[at] = row_of(draw_below(&d, alphabet + 1));
        assert_int_equal(count_pairs(&a, &b), a.count);
        assert_int_equal(count_pairs(&b, &a), a.count);
        for (int i = draw_below(&d, 8); i > 0; i--)
            b.rows[draw_below(&d, b.count)] = row_of(draw_below(&d, alphabet));
        b.count -= draw_below(&d, b.count + 1);
        int pairs = count_pairs(&a, &b);
        assert_in_range(pairs, 0, a.count < b.count ? a.count : b.count);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edits_cost_what_they_change),
        cmocka_unit_test(random_lists),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
