/* How a film's frames are divided, and those that show the same brought together. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "files.h"
#include "scenes.h"
#include "sequence/again.h"
#include "sequence/split.h"

/* Parts are all of the film, once; where all frames cost the same, none is longer than another
 * by more than one, and else none costs more than its share by more than the dearest frame. */
static void parts_are_alike(void **state) {
    (void)state;
    enum { FRAMES = 100 };
    uint64_t random = 5;
    for (int count = 1; count <= 130; count += 7)
        for (int kind = 0; kind < 3; kind++) {
            double costs[FRAMES], sum = 0, most = 0;
            int64_t ends[200];
            for (int i = 0; i < FRAMES; i++) {
                costs[i] = kind == 1 ? pow(test_random(&random), 4) : 0;
                sum += costs[i];
                most = fmax(most, costs[i]);
            }
            zt_split_ends(ends, count, kind ? costs : NULL, FRAMES);
            assert_int_equal(ends[count - 1], FRAMES);
            for (int p = 0; p < count; p++) {
                int64_t first = p ? ends[p - 1] : 0;
                double cost = 0;
                assert_true(ends[p] >= first);
                for (int64_t i = first; i < ends[p]; i++) cost += costs[i];
                if (kind == 1)
                    assert_true(cost <= sum / count + most + 1e-9);
                else
                    assert_in_range(ends[p] - first, FRAMES / count,
                                    (FRAMES + count - 1) / count);
            }
        }
}

/* Frames with equal keys stand together, the first of each where it was among the others. */
static void equal_frames_come_together(void **state) {
    (void)state;
    int64_t frames[] = {9, 8, 7, 6, 5, 4};
    zt_hash keys[] = {{0, 2}, {1, 1}, {0, 1}, {0, 2}, {1, 1}, {0, 2}};
    const int64_t wanted[] = {9, 6, 4, 8, 5, 7};
    assert_int_equal(zt_again_group(frames, keys, 6), ZT_OK);
    for (int i = 0; i < 6; i++) assert_int_equal(frames[i], wanted[i]);
    assert_true(keys[2].low == 2 && keys[4].high == 1 && keys[5].low == 1);
}

/* Images are kept while they come again, with all their numbers, and those that come soonest
 * where they are too many. */
static void images_come_again(void **state) {
    (void)state;
    enum { KINDS = 70, COUNT_ALL = 3 * KINDS };
    zt_hash keys[COUNT_ALL];
    bool wanted[COUNT_ALL];
    for (int i = 0; i < COUNT_ALL; i++) {
        keys[i] = (zt_hash){0, (uint64_t)(1 + i % KINDS)};
        wanted[i] = i != KINDS + 3 && i != 2 * KINDS + 3;
    }
    keys[5] = keys[KINDS + 5] = keys[2 * KINDS + 5] = (zt_hash){0};
    zt_again *again;
    int found = 0;
    assert_int_equal(zt_again_open(&again, keys, wanted, COUNT_ALL), ZT_OK);
    for (int i = 0; i < COUNT_ALL; i++) {
        if (!wanted[i]) continue;
        const zt_image *kept = zt_again_find(again, i);
        zt_image *image = picture(8, 4, i % KINDS);
        image->info.frame = i % KINDS;
        if (kept) {
            assert_memory_equal(kept->pixels, image->pixels, 8 * 4 * 4 * sizeof(float));
            assert_int_equal(kept->info.frame, i % KINDS);
            assert_true(i >= KINDS && i % KINDS != 5);
            found++;
        }
        assert_int_equal(zt_again_keep(again, i, image), ZT_OK);
        zt_image_free(&image);
    }
    assert_in_range(found, 2 * 64 - 8, 2 * 64 + 4); /* 64 are kept at a time */
    zt_again_close(&again);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(parts_are_alike),
                                       cmocka_unit_test(equal_frames_come_together),
                                       cmocka_unit_test(images_come_again)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
