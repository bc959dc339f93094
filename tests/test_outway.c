/* The way out: images that several threads make ready are written in the order in which they
 * were sent, and failures come back to the one who sends. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "files.h"
#include "sequence/outway.h"
#include <zoetrope/aov.h>

enum { WIDTH = 16, HEIGHT = 12 };
static const zt_output_format format = {
    .width = WIDTH, .height = HEIGHT, .rate = {24, 1}, .view = ZT_VIEW_SRGB};
static const int thread_counts[] = {1, 2, 8};
enum { THREAD_COUNTS = sizeof thread_counts / sizeof *thread_counts };

static zt_output *open_output(const char *target, const zt_output_format *its_format,
                              heard *h) {
    zt_output *output;
    if (zt_output_open(&output, target, its_format, NULL, listener_of(h)) != ZT_OK)
        fail_msg("%s", h->text);
    return output;
}

static zt_outway *open_way(zt_output *output, int thread_count) {
    zt_outway *way;
    assert_int_equal(zt_outway_open(&way, WIDTH, HEIGHT, 0, thread_count), ZT_OK);
    zt_outway_lead(way, output);
    return way;
}

/* Renders, as it were: the picture of a frame. */
static void fill(zt_image *image, int frame) {
    zt_image *from = picture(image->width, image->height, frame);
    size_t count = (size_t)image->width * (size_t)image->height * 4;
    memcpy(image->pixels, from->pixels, count * sizeof *from->pixels);
    zt_image_free(&from);
}

static zt_image_info info_of(int64_t frame) {
    return (zt_image_info){.known = true, .frame = frame, .rate = {24, 1}};
}

/* Sends the frames from `first`, each `held` times under numbers that follow. */
static zt_status send_frames(zt_outway *way, int first, int count, int held) {
    zt_status status = ZT_OK;
    for (int i = 0; i < count && status == ZT_OK; i++) {
        zt_image *image;
        status = zt_outway_lend(&image, way);
        if (status != ZT_OK) break;
        fill(image, first + i);
        for (int k = 0; k < held && status == ZT_OK; k++) {
            zt_image_info info = info_of(first + i * held + k);
            status = zt_outway_send(way, image, &info);
        }
        zt_outway_release(way, image);
    }
    return status;
}

static void write_by_threads(const char *target, int count, int held, int thread_count) {
    heard h;
    zt_output *output = open_output(target, &format, &h);
    zt_outway *way = open_way(output, thread_count);
    assert_int_equal(send_frames(way, 0, count, held), ZT_OK);
    assert_true(zt_outway_waited_s(way) >= 0);
    assert_int_equal(zt_outway_close(&way), ZT_OK);
    assert_null(way);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_int_equal(h.error_count, 0);
}

/* The same, without a way: one image after the other. */
static void write_in_turn(const char *target, int count, int held) {
    heard h;
    zt_output *output = open_output(target, &format, &h);
    for (int i = 0; i < count * held; i++) {
        zt_image *image = picture(WIDTH, HEIGHT, i / held);
        image->info = info_of(i);
        assert_int_equal(zt_output_write(output, image, i), ZT_OK);
        zt_image_free(&image);
    }
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* Thousands of tiny images, on any number of threads: a line for each, in their order, the same
 * as without threads. An image out of its turn would be refused by the output, too. */
static void thousands_in_order(void **state) {
    (void)state;
    write_in_turn("turn.hash", 3000, 1);
    for (int t = 0; t < THREAD_COUNTS; t++) {
        write_by_threads("threads.hash", 3000, 1, thread_counts[t]);
        assert_true(same_files("threads.hash", "turn.hash"));
    }
}

/* Images that are written as files, with what is said of each of them, are the same to the
 * byte. */
static void same_bytes(void **state) {
    (void)state;
    write_in_turn("turn/f.####.png", 12, 1);
    for (int t = 0; t < THREAD_COUNTS; t++) {
        char target[64];
        snprintf(target, sizeof target, "threads%d/f.####.png", thread_counts[t]);
        write_by_threads(target, 12, 1, thread_counts[t]);
        for (int i = 0; i < 12; i++) {
            char a[64], b[64];
            snprintf(a, sizeof a, "turn/f.%04d.png", i);
            snprintf(b, sizeof b, "threads%d/f.%04d.png", thread_counts[t], i);
            assert_true(same_files(a, b));
        }
    }
}

/* A held image goes out under many numbers, more than can be under way at once, and is not
 * lent to others before the last of them is made. */
static void held_images(void **state) {
    (void)state;
    write_in_turn("held_turn.hash", 20, 50);
    write_in_turn("held_turn/f.####.exr", 2, 5);
    for (int t = 0; t < THREAD_COUNTS; t++) {
        write_by_threads("held.hash", 20, 50, thread_counts[t]);
        assert_true(same_files("held.hash", "held_turn.hash"));
        write_by_threads("held/f.####.exr", 2, 5, thread_counts[t]);
        for (int i = 0; i < 10; i++) {
            char a[64], b[64];
            snprintf(a, sizeof a, "held_turn/f.%04d.exr", i);
            snprintf(b, sizeof b, "held/f.%04d.exr", i);
            assert_true(same_files(a, b));
        }
    }
}

/* A frame kept by the caller while others go out is sent again, unharmed. */
static void kept_image(void **state) {
    (void)state;
    heard h;
    zt_output *output = open_output("kept.hash", &format, &h);
    zt_outway *way = open_way(output, 1);
    zt_image *kept;
    assert_int_equal(zt_outway_lend(&kept, way), ZT_OK);
    fill(kept, 0);
    for (int i = 0; i < 100; i += 2) {
        zt_image_info info = info_of(i);
        assert_int_equal(zt_outway_send(way, kept, &info), ZT_OK);
        assert_int_equal(send_frames(way, i + 1, 1, 1), ZT_OK);
    }
    zt_outway_release(way, kept);
    assert_int_equal(zt_outway_close(&way), ZT_OK);
    assert_int_equal(zt_output_close(&output), ZT_OK);

    output = open_output("kept_turn.hash", &format, &h);
    for (int i = 0; i < 100; i++) {
        zt_image *image = picture(WIDTH, HEIGHT, i % 2 ? i : 0);
        assert_int_equal(zt_output_write(output, image, i), ZT_OK);
        zt_image_free(&image);
    }
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_true(same_files("kept.hash", "kept_turn.hash"));
}

/* No more images than two more than there are threads, however many are lent; released ones
 * come again, unsent as well. */
static void few_images(void **state) {
    (void)state;
    heard h;
    zt_output *output = open_output("few.hash", &format, &h);
    zt_outway *way = open_way(output, 2);
    zt_image *lent[4], *seen;
    for (int i = 0; i < 4; i++) {
        assert_int_equal(zt_outway_lend(&lent[i], way), ZT_OK);
        assert_int_equal(lent[i]->width, WIDTH);
        assert_int_equal(lent[i]->height, HEIGHT);
        for (int k = 0; k < i; k++) assert_ptr_not_equal(lent[k], lent[i]);
    }
    for (int i = 0; i < 8; i++) {
        zt_outway_release(way, lent[i % 4]);
        assert_int_equal(zt_outway_lend(&seen, way), ZT_OK);
        assert_ptr_equal(seen, lent[i % 4]);
    }
    assert_int_equal(zt_outway_close(&way), ZT_OK); /* takes back what was not released */
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* Images have the channels that were asked for, and no others. */
static void channels(void **state) {
    (void)state;
    heard h;
    zt_output *output = open_output("channels.hash", &format, &h);
    zt_outway *way;
    unsigned aovs = ZT_AOV_Z | ZT_AOV_N;
    assert_int_equal(zt_outway_open(&way, WIDTH, HEIGHT, aovs, 1), ZT_OK);
    zt_outway_lead(way, output);
    zt_image *image;
    assert_int_equal(zt_outway_lend(&image, way), ZT_OK);
    assert_non_null(zt_image_channel(image, "Z"));
    assert_non_null(zt_image_channel(image, "N.Y"));
    assert_int_equal(image->channel_count, 4);
    zt_outway_release(way, image);
    assert_int_equal(zt_outway_close(&way), ZT_OK);
    assert_int_equal(zt_outway_close(&way), ZT_OK);
    assert_int_equal(zt_outway_open(&way, WIDTH, HEIGHT, 0, 0), ZT_EARGUMENT);
    assert_null(way);
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* Sends frames from `first` on until it is told of the failure, which it has to be before long;
 * then lend, send and close all say so. */
static void assert_fails(zt_output *output, int first, int thread_count, zt_status expected) {
    zt_outway *way = open_way(output, thread_count);
    zt_image *kept;
    assert_int_equal(zt_outway_lend(&kept, way), ZT_OK);
    assert_int_equal(send_frames(way, first, 1000, 1), expected);
    zt_image *image = (zt_image *)way;
    assert_int_equal(zt_outway_lend(&image, way), expected);
    assert_null(image);
    zt_image_info info = info_of(2000);
    assert_int_equal(zt_outway_send(way, kept, &info), expected);
    zt_outway_release(way, kept);
    assert_int_equal(zt_outway_close(&way), expected);
}

/* A second image for a name that holds one: told once, and the first stays. */
static void too_many_images(void **state) {
    (void)state;
    for (int t = 0; t < THREAD_COUNTS; t++) {
        heard h;
        zt_output *output = open_output("one/image.png", &format, &h);
        assert_fails(output, 0, thread_counts[t], ZT_EARGUMENT);
        assert_int_equal(zt_output_close(&output), ZT_OK);
        assert_told(&h, "####");
        assert_int_equal(entry_count("one"), 1);
        write_in_turn("one_turn/image.png", 1, 1);
        assert_true(same_files("one/image.png", "one_turn/image.png"));
    }
}

/* A disk that becomes full: told once, and what had been written until then is there, no more
 * and nothing half. */
static void full_disk(void **state) {
    (void)state;
    for (int t = 0; t < THREAD_COUNTS; t++) {
        heard h;
        char target[96], directory[64];
        snprintf(directory, sizeof directory, "full%d", thread_counts[t]);
        snprintf(target, sizeof target, "%s/f.####.png", directory);
        zt_output *output = open_output(target, &format, &h);
        zt_outway *way = open_way(output, thread_counts[t]);
        assert_int_equal(send_frames(way, 0, 5, 1), ZT_OK);
        assert_int_equal(zt_outway_close(&way), ZT_OK);
        disk_has(20);
        assert_fails(output, 5, thread_counts[t], ZT_EFILE);
        disk_has(0);
        assert_told(&h, "File too large");
        assert_int_equal(zt_output_close(&output), ZT_OK);
        assert_int_equal(entry_count(directory), 5);
    }
}

/* Images that cannot be made, as they have another size than the output. */
static void failing_makes(void **state) {
    (void)state;
    zt_output_format other = format;
    other.width *= 2;
    for (int t = 0; t < THREAD_COUNTS; t++) {
        zt_output *output;
        const zt_listener deaf = {NULL, NULL};
        assert_int_equal(zt_output_open(&output, "other.hash", &other, NULL, deaf), ZT_OK);
        assert_fails(output, 0, thread_counts[t], ZT_EARGUMENT);
        assert_int_equal(zt_output_close(&output), ZT_OK);
        assert_false(exists("other.hash"));
    }
}

/* A frame out of order fails by itself: those sent before it are written, those after it are
 * not, although they had been sent, whatever the threads were doing. */
static void all_before_a_failure(void **state) {
    (void)state;
    for (int t = 0; t < THREAD_COUNTS; t++) {
        for (int round = 0; round < 20; round++) {
            heard h;
            char target[96], directory[64];
            snprintf(directory, sizeof directory, "before%d.%d", thread_counts[t], round);
            snprintf(target, sizeof target, "%s/#.png", directory);
            zt_output *output = open_output(target, &format, &h);
            zt_outway *way = open_way(output, thread_counts[t]);
            const int64_t frames[] = {1, 2, 3, 4, 5, 4, 6, 7};
            zt_image *image;
            assert_int_equal(zt_outway_lend(&image, way), ZT_OK);
            fill(image, 0);
            for (int i = 0; i < 8; i++) {
                zt_image_info info = info_of(frames[i]);
                zt_status status = zt_outway_send(way, image, &info);
                assert_true(status == ZT_OK || (i > 5 && status == ZT_EARGUMENT));
            }
            zt_outway_release(way, image);
            assert_int_equal(zt_outway_close(&way), ZT_EARGUMENT);
            assert_told(&h, "frame 4 came after frame 5");
            assert_int_equal(zt_output_close(&output), ZT_OK);
            assert_int_equal(entry_count(directory), 5);
        }
    }
}

/* The same where it is in the midst that an image cannot be made, as its size is wrong: those
 * after it, which may be made already, are dropped. */
static void all_before_a_failing_make(void **state) {
    (void)state;
    for (int t = 0; t < THREAD_COUNTS; t++) {
        heard h;
        zt_output *output = open_output("midst.hash", &format, &h);
        zt_outway *way = open_way(output, thread_counts[t]);
        zt_image *good, *bad;
        assert_int_equal(zt_outway_lend(&good, way), ZT_OK);
        assert_int_equal(zt_outway_lend(&bad, way), ZT_OK);
        fill(good, 0);
        bad->width--;
        for (int i = 0; i < 8; i++) {
            zt_image_info info = info_of(i);
            zt_status status = zt_outway_send(way, i == 5 ? bad : good, &info);
            assert_true(status == ZT_OK || (i > 5 && status == ZT_EARGUMENT));
        }
        assert_int_equal(zt_outway_close(&way), ZT_EARGUMENT);
        assert_told(&h, "15x12");
        assert_int_equal(zt_output_close(&output), ZT_OK);
        size_t size;
        free(file_bytes("midst.hash", &size));
        assert_int_equal(size, 5 * 58); /* lines of frames 0 to 4 */
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thousands_in_order),
        cmocka_unit_test(same_bytes),
        cmocka_unit_test(held_images),
        cmocka_unit_test(kept_image),
        cmocka_unit_test(few_images),
        cmocka_unit_test(channels),
        cmocka_unit_test(too_many_images),
        cmocka_unit_test(full_disk),
        cmocka_unit_test(failing_makes),
        cmocka_unit_test(all_before_a_failure),
        cmocka_unit_test(all_before_a_failing_make),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
