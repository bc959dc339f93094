/* The judge lets pass what is right, and nothing else: a tracer that answers as the reference
 * does holds in every case, one that lies in any way fails. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "probe_mock.h"
#include "run.h"

static run_result result;

static void run(const char *name, mock_lie lie) {
    probe_mock_lie = lie;
    for (int list = 0; cases_all[list]; list++)
        for (const extreme_case *c = cases_all[list]; c->name; c++) {
            if (strcmp(c->name, name) != 0) continue;
            extreme_case less = *c;
            less.rays = c->rays < 32 ? c->rays : 32;
            less.bounces = c->bounces < 2 ? c->bounces : 2;
            assert_true(run_case(&result, &less, 0, 3, RUN_ALL_PRECISIONS,
                                 lie == MOCK_HONEST ? RUN_TOLD : RUN_JUDGED));
            return;
        }
    fail_msg("no case %s", name);
}

static void honest(void **state) {
    (void)state;
    int failed = 0;
    for (int list = 0; cases_all[list]; list++)
        for (const extreme_case *c = cases_all[list]; c->name; c++) {
            run(c->name, MOCK_HONEST);
            for (int i = 0; i < PROBE_AUTO; i++) {
                const tally *t = &result.tallies[i];
                if (t->hits > 0 && tally_holds(t, i == PROBE_SINGLE ? 1e-6 : 1e-12)) continue;
                failed++;
                print_message("%s, %d: %lld hits, errors %g %g %g, wrong %lld missed %lld "
                              "false %lld leaks %lld acne %lld not finite %lld\n",
                              c->name, i, (long long)t->hits, t->hit, t->normal, t->mirror,
                              (long long)t->wrong, (long long)t->missed,
                              (long long)t->false_hits, (long long)t->leaks, (long long)t->acne,
                              (long long)t->not_finite);
            }
        }
    assert_int_equal(failed, 0);
}

static void lies(void **state) {
    (void)state;
    const tally *t = &result.tallies[PROBE_DOUBLE];
    run("sphere", MOCK_MISSES);
    assert_true(t->missed > 5);
    run("mesh", MOCK_MISSES);
    assert_true(t->leaks > 5);
    run("box", MOCK_LATE);
    assert_true(t->hit > 1e-6 && t->wrong > 5);
    run("torus", MOCK_TURNED);
    assert_true(t->normal > 1e-7);
    run("sphere", MOCK_DARK);
    assert_true(t->acne > 5);
    run("sphere", MOCK_LIT);
    assert_true(t->leaks > 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(honest), cmocka_unit_test(lies)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
