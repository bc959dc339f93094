/* Movies: what a player finds in the file is what was sent. Read again with libavformat and
 * libavcodec; the boxes of the container and the colours are read here, without them. */
#include <inttypes.h>
#include <sched.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "files.h"
#include "movies.h"

static const zt_output_format small = {
    .width = 64, .height = 48, .rate = {24, 1}, .view = ZT_VIEW_SRGB};

/* time_base * ticks == count / rate, as rationals. */
static void assert_time(int64_t ticks, AVRational time_base, int64_t count, zt_rate rate) {
    if (ticks * time_base.num * rate.num != count * rate.den * time_base.den)
        fail_msg("%" PRId64 " * %d/%d s is not frame %" PRId64 " at %d/%d", ticks,
                 time_base.num, time_base.den, count, rate.num, rate.den);
}

/* The content of the first box of this type below `from`, ISO/IEC 14496-12; NULL where there is
 * none. `position` is where the box begins. */
static const uint8_t *find_box(const uint8_t *from, size_t size, const char *type,
                               size_t *found_size, size_t *position) {
    for (size_t at = 0; at + 8 <= size;) {
        size_t box = (size_t)from[at] << 24 | (size_t)from[at + 1] << 16 |
                     (size_t)from[at + 2] << 8 | from[at + 3];
        assert_in_range(box, 8, size - at);
        if (memcmp(from + at + 4, type, 4) == 0) {
            *found_size = box - 8;
            if (position) *position = at;
            return from + at + 8;
        }
        at += box;
    }
    return NULL;
}

static uint32_t big_endian(const uint8_t *b) {
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

/* The boxes: moov before mdat, so that playing begins before all is there; one edit as long as
 * the film to the tick, beginning where the first picture is shown; the same duration for all.
 */
static void assert_boxes(const char *path, int frame_count, zt_rate rate) {
    size_t size, moov_at = 0, mdat_at = 0, n = 0, unused = 0;
    char *bytes = file_bytes(path, &size);
    const uint8_t *file = (const uint8_t *)bytes;
    const uint8_t *moov = find_box(file, size, "moov", &n, &moov_at);
    assert_non_null(moov);
    assert_non_null(find_box(file, size, "mdat", &unused, &mdat_at));
    assert_true(moov_at < mdat_at);
    size_t trak_size = 0, mdia_size = 0;
    const uint8_t *mvhd = find_box(moov, n, "mvhd", &unused, NULL);
    const uint8_t *trak = find_box(moov, n, "trak", &trak_size, NULL);
    const uint8_t *edts = find_box(trak, trak_size, "edts", &n, NULL);
    const uint8_t *elst = find_box(edts, n, "elst", &n, NULL);
    assert_int_equal(elst[0] | mvhd[0], 0);    /* versions with 32 bits */
    assert_int_equal(big_endian(elst + 4), 1); /* one edit */
    int movie_timescale = (int)big_endian(mvhd + 12);
    assert_time(big_endian(elst + 8), (AVRational){1, movie_timescale}, frame_count, rate);
    assert_time(big_endian(mvhd + 16), (AVRational){1, movie_timescale}, frame_count, rate);
    const uint8_t *mdia = find_box(trak, trak_size, "mdia", &mdia_size, NULL);
    const uint8_t *minf = find_box(mdia, mdia_size, "minf", &n, NULL);
    const uint8_t *stbl = find_box(minf, n, "stbl", &n, NULL);
    const uint8_t *ctts = find_box(stbl, n, "ctts", &unused, NULL);
    const uint8_t *stts = find_box(stbl, n, "stts", &unused, NULL);
    assert_int_equal(big_endian(stts + 4), 1); /* one run of equal durations */
    assert_int_equal(big_endian(stts + 8), frame_count);
    /* The edit begins at the first picture, which B-frames move from 0. */
    assert_int_equal(big_endian(elst + 12), ctts ? big_endian(ctts + 12) : 0);
    free(bytes);
}

/* The film has this many frames, each at its exact time and for as long as all others. */
static void assert_film(const char *path, int frame_count, zt_rate rate) {
    film m = film_open(path);
    AVFrame *frames[FRAMES_MAX] = {0};
    assert_int_equal(decode(&m, 0, m.packet_count, frames), frame_count);
    for (int f = 0; frames[f]; f++) assert_time(frames[f]->pts, m.stream->time_base, f, rate);
    for (int p = 0; p < m.packet_count; p++)
        assert_time(m.packets[p]->duration, m.stream->time_base, 1, rate);
    assert_time(m.stream->start_time, m.stream->time_base, 0, rate);
    assert_time(m.stream->duration, m.stream->time_base, frame_count, rate);
    assert_int_equal(m.stream->nb_frames, frame_count);
    AVRational exact = {rate.num, rate.den};
    assert_int_equal(av_cmp_q(m.stream->avg_frame_rate, exact), 0);
    assert_int_equal(av_cmp_q(m.stream->r_frame_rate, exact), 0);
    free_frames(frames, frame_count);
    film_close(&m);
    assert_boxes(path, frame_count, rate);
}

/* Frame n is shown at n * den / num, exactly, for the rates of cinema and television, a rate
 * that is not reduced, a very slow one and a very fast one. */
static void times_are_exact(void **state) {
    (void)state;
    const zt_rate rates[] = {{24, 1}, {25, 1}, {30000, 1001}, {24000, 1001},
                             {60, 2}, {1, 2},  {240, 1},      {1000003, 50021}};
    for (int i = 0; i < 8; i++) {
        zt_output_format format = small;
        format.rate = rates[i];
        write_movie("rate.mp4", &format, 53);
        assert_film("rate.mp4", 53, rates[i]);
    }
}

/* Size, codec and the tags that say what the numbers mean, in the stream and on every frame. */
static void tags(void **state) {
    (void)state;
    for (int view = 0; view < ZT_VIEW_COUNT; view++) {
        zt_output_format format = {.width = 322, .height = 178, .rate = {24, 1}, .view = view};
        write_movie("tags.mp4", &format, 5);
        film m = film_open("tags.mp4");
        const AVCodecParameters *p = m.stream->codecpar;
        assert_int_equal(p->codec_id, AV_CODEC_ID_H264);
        assert_int_equal(p->codec_tag, MKTAG('a', 'v', 'c', '1'));
        assert_int_equal(p->format, AV_PIX_FMT_YUV420P);
        assert_int_equal(p->width, 322);
        assert_int_equal(p->height, 178);
        assert_int_equal(p->color_primaries, AVCOL_PRI_BT709);
        assert_int_equal(p->color_trc, AVCOL_TRC_BT709);
        assert_int_equal(p->color_space, AVCOL_SPC_BT709);
        assert_int_equal(p->color_range, AVCOL_RANGE_MPEG);
        assert_int_equal(p->chroma_location, AVCHROMA_LOC_LEFT);
        AVFrame *frames[FRAMES_MAX] = {0};
        assert_int_equal(decode(&m, 0, m.packet_count, frames), 5);
        for (int f = 0; f < 5; f++) {
            assert_int_equal(frames[f]->width, 322);
            assert_int_equal(frames[f]->height, 178);
            assert_int_equal(frames[f]->color_primaries, AVCOL_PRI_BT709);
            assert_int_equal(frames[f]->color_trc, AVCOL_TRC_BT709);
            assert_int_equal(frames[f]->colorspace, AVCOL_SPC_BT709);
            assert_int_equal(frames[f]->color_range, AVCOL_RANGE_MPEG);
            assert_int_equal(frames[f]->chroma_location, AVCHROMA_LOC_LEFT);
            assert_false(frames[f]->interlaced_frame);
        }
        free_frames(frames, 5);
        film_close(&m);
        /* And in the container's own box, for players that look only there. */
        size_t size;
        char *bytes = file_bytes("tags.mp4", &size);
        assert_non_null(memmem(bytes, size, "colrnclx\0\1\0\1\0\1\0", 15));
        free(bytes);
    }
}

static bool same_luma(const AVFrame *a, const AVFrame *b) {
    for (int y = 0; y < a->height; y++)
        if (memcmp(a->data[0] + y * a->linesize[0], b->data[0] + y * b->linesize[0],
                   (size_t)a->width) != 0)
            return false;
    return true;
}

/* Each group of pictures can be played alone: a decoder that gets only its packets shows all of
 * its frames, and the same as in the whole film. At most two seconds lie between two key
 * frames. */
static void groups_are_closed(void **state) {
    (void)state;
    const int frame_count = 130;
    write_movie("groups.mp4", &small, frame_count);
    film m = film_open("groups.mp4");
    AVFrame *all[FRAMES_MAX] = {0}, *some[FRAMES_MAX] = {0};
    assert_int_equal(decode(&m, 0, m.packet_count, all), frame_count);
    assert_true(m.packets[0]->flags & AV_PKT_FLAG_KEY);
    int shown = 0, group_count = 0;
    for (int first = 0, last; first < m.packet_count; first = last, group_count++) {
        for (last = first + 1; last < m.packet_count; last++)
            if (m.packets[last]->flags & AV_PKT_FLAG_KEY) break;
        assert_true(last - first <= 48);
        assert_int_equal(decode(&m, first, last, some), last - first);
        for (int f = 0; f < last - first; f++, shown++) {
            assert_int_equal(some[f]->pts, all[shown]->pts);
            assert_true(same_luma(some[f], all[shown]));
        }
        free_frames(some, last - first);
    }
    assert_int_equal(shown, frame_count);
    assert_true(group_count >= 3);
    free_frames(all, frame_count);
    film_close(&m);
}

enum { PATCH = 64 };

/* R'G'B' of 0..255 from a yuv420p pixel, by ITU-R BT.709-6, items 3.2 to 3.5. */
static void yuv_to_rgb(double rgb[3], const AVFrame *frame, int x, int y) {
    int half_x = x / 2, half_y = y / 2;
    double luma = (frame->data[0][y * frame->linesize[0] + x] - 16) / 219.0;
    double cb = (frame->data[1][half_y * frame->linesize[1] + half_x] - 128) / 224.0;
    double cr = (frame->data[2][half_y * frame->linesize[2] + half_x] - 128) / 224.0;
    double r = luma + 1.5748 * cr, b = luma + 1.8556 * cb;
    double g = (luma - 0.2126 * r - 0.0722 * b) / 0.7152;
    const double values[] = {r, g, b};
    for (int c = 0; c < 3; c++) rgb[c] = 255 * fmin(1, fmax(0, values[c]));
}

/* The largest difference of a pixel in the middle of a patch, and in `mean` of a whole middle.
 */
static double worst_difference(double *mean, const AVFrame *frame, zt_view view) {
    const int margin = 16; /* the encoder and the chroma filter blur the edges */
    double worst = 0;
    *mean = 0;
    for (int p = 0; p < PATCH_COUNT; p++) {
        double sums[3] = {0};
        for (int y = margin; y < PATCH - margin; y++)
            for (int x = margin; x < PATCH - margin; x++) {
                double rgb[3];
                yuv_to_rgb(rgb, frame, p % PATCH_COLUMNS * PATCH + x,
                           p / PATCH_COLUMNS * PATCH + y);
                for (int c = 0; c < 3; c++) {
                    double off = rgb[c] - 255 * display_value((double)patches[p][c], view);
                    sums[c] += off;
                    worst = fmax(worst, fabs(off));
                }
            }
        for (int c = 0; c < 3; c++)
            *mean = fmax(*mean, fabs(sums[c]) / (PATCH - 2 * margin) / (PATCH - 2 * margin));
    }
    return worst;
}

/* The colours of a test card arrive, in key frames and all others: within 4 of 255 where
 * dithering added a step to each component, and within 1.5 in the mean. */
static void colours(void **state) {
    (void)state;
    const int frame_count = 30, width = PATCH_COLUMNS * PATCH;
    for (int view = ZT_VIEW_RAW; view <= ZT_VIEW_SRGB; view++) {
        zt_output_format format = {.width = width,
                                   .height = PATCH_COUNT / PATCH_COLUMNS * PATCH,
                                   .rate = {24, 1},
                                   .view = view};
        zt_image *card = test_card(PATCH);
        zt_output *output = open_movie("card.mp4", &format);
        for (int f = 0; f < frame_count; f++)
            assert_int_equal(zt_output_write(output, card, f), ZT_OK);
        assert_int_equal(zt_output_close(&output), ZT_OK);
        zt_image_free(&card);

        film m = film_open("card.mp4");
        AVFrame *frames[FRAMES_MAX] = {0};
        assert_int_equal(decode(&m, 0, m.packet_count, frames), frame_count);
        for (int f = 0; f < frame_count; f++) {
            double mean, worst = worst_difference(&mean, frames[f], view);
            if (worst > 4 || mean > 1.5)
                fail_msg("frame %d, view %d: off by %g of 255, %g in the mean", f, view, worst,
                         mean);
        }
        free_frames(frames, frame_count);
        film_close(&m);
    }
}

/* Chroma is where its tag says. Everything from column 24 on is red: a sample on column 24,
 * half a pixel from the edge, is mostly red; sited between columns 24 and 25 it would be wholly
 * so. */
static void chroma_is_left(void **state) {
    (void)state;
    zt_output_format format = {.width = 64, .height = 64, .rate = {24, 1}, .view = ZT_VIEW_RAW};
    zt_image *image;
    assert_int_equal(zt_image_create(&image, 64, 64), ZT_OK);
    for (int y = 0; y < 64; y++)
        for (int x = 24; x < 64; x++) image->pixels[4 * (64 * y + x)] = 1;
    zt_output *output = open_movie("left.mp4", &format);
    assert_int_equal(zt_output_write(output, image, 0), ZT_OK);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    zt_image_free(&image);
    film m = film_open("left.mp4");
    AVFrame *frame[FRAMES_MAX] = {0};
    assert_int_equal(decode(&m, 0, m.packet_count, frame), 1);
    const uint8_t *cr = frame[0]->data[2] + 16 * frame[0]->linesize[2];
    assert_in_range(cr[4], 126, 130);
    assert_in_range(cr[20], 238, 242);
    assert_in_range(cr[12], 128 + 0.6 * 112, 128 + 0.9 * 112);
    assert_in_range(cr[11], 120, 136);
    free_frames(frame, 1);
    film_close(&m);
}

/* Odd sizes are refused before the first picture, with a size that would do, and nothing is
 * left; so is what the encoder cannot do. */
static void impossible_sizes(void **state) {
    (void)state;
    const struct {
        int width, height;
        const char *words;
    } sizes[] = {{641, 360, "640x360 would be"},
                 {640, 361, "640x360 would be"},
                 {1, 1, "2x2 would be"},
                 {65536, 65536, "cannot write sizes/a.mp4"}};
    for (int i = 0; i < 4; i++) {
        heard h;
        zt_output *output;
        zt_output_format format = {.width = sizes[i].width,
                                   .height = sizes[i].height,
                                   .rate = {24, 1},
                                   .view = ZT_VIEW_SRGB};
        assert_int_not_equal(
            zt_output_open(&output, "sizes/a.mp4", &format, NULL, listener_of(&h)), ZT_OK);
        assert_null(output);
        assert_told(&h, sizes[i].words);
        assert_false(exists("sizes/a.mp4") || exists("sizes/a.mp4.part"));
    }
    zt_output_format least = {.width = 2, .height = 2, .rate = {24, 1}, .view = ZT_VIEW_SRGB};
    write_movie("least.mp4", &least, 3);
    film m = film_open("least.mp4");
    assert_int_equal(m.packet_count, 3);
    film_close(&m);
}

/* A movie by a preset; of two the later one counts. */
static void write_by_preset(const char *path, const char *first, const char *preset) {
    const zt_output_option options[] = {{"preset", first}, {"preset", preset}, {NULL, NULL}};
    zt_output *output = open_movie_by(path, &small, options);
    for (int f = 0; f < 9; f++) {
        zt_image *image = picture(small.width, small.height, f);
        assert_int_equal(zt_output_write(output, image, f), ZT_OK);
        zt_image_free(&image);
    }
    assert_int_equal(zt_output_close(&output), ZT_OK);
}

/* Each preset makes a film of its own, which names x264's search (ultrafast: dia, placebo:
 * tesa); without one it is veryfast's, to the bit. */
static void presets(void **state) {
    (void)state;
    const char *const names[] = {"ultrafast", "superfast", "veryfast", "faster",   "fast",
                                 "medium",    "slow",      "slower",   "veryslow", "placebo"};
    write_movie("without.mp4", &small, 9);
    for (int i = 0; i < 10; i++) {
        write_by_preset("by.mp4", "medium", names[i]);
        assert_film("by.mp4", 9, small.rate);
        size_t size;
        char *bytes = file_bytes("by.mp4", &size);
        const char *search = i < 2 ? "me=dia" : i < 7 ? "me=hex" : i < 9 ? "me=umh" : "me=tesa";
        if (!memmem(bytes, size, search, strlen(search)))
            fail_msg("%s: no %s", names[i], search);
        free(bytes);
    }
    write_by_preset("by.mp4", "slow", "veryfast");
    write_by_preset("slow.mp4", "veryfast", "slow");
    assert_false(same_files("by.mp4", "slow.mp4"));
    const char *const wrong[] = {"", "2", "Fast", "medium ", "veryfast,slow"};
    for (int i = 0; i < 5; i++) {
        const zt_output_option options[] = {{"preset", wrong[i]}, {NULL, NULL}};
        heard h;
        zt_output *output;
        assert_int_equal(zt_output_open(&output, "no/a.mp4", &small, options, listener_of(&h)),
                         ZT_EARGUMENT);
        assert_told(&h, "ultrafast superfast veryfast faster fast medium slow slower veryslow");
        assert_false(exists("no"));
    }
}

/* The film's name is a name: it is never taken for a protocol, a pattern or a format. */
static void names_are_names(void **state) {
    (void)state;
    const char *const names[] = {"http:film.mp4", "pipe:1.mp4", "%d%s%n####.mp4", "-y.mp4",
                                 "für – 日本.MP4"};
    for (int i = 0; i < 5; i++) {
        char path[64];
        snprintf(path, sizeof path, "./names/%s", names[i]);
        write_movie(path, &small, 2);
        assert_true(exists(path));
    }
    assert_int_equal(entry_count("names"), 5);
}

/* An older film stays until the new one is complete; a film of which nothing came is none. */
static void replaced_when_complete(void **state) {
    (void)state;
    write_movie("film.mp4", &small, 2);
    write_movie("copy.mp4", &small, 2);
    zt_output *output = open_movie("film.mp4", &small);
    zt_image *image = picture(small.width, small.height, 9);
    for (int f = 0; f < 20; f++) assert_int_equal(zt_output_write(output, image, f), ZT_OK);
    assert_true(same_files("film.mp4", "copy.mp4"));
    assert_true(exists("film.mp4.part"));
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_false(same_files("film.mp4", "copy.mp4"));
    assert_false(exists("film.mp4.part"));

    output = open_movie("copy.mp4", &small);
    assert_int_equal(zt_output_close(&output), ZT_OK);
    assert_true(exists("copy.mp4"));
    assert_false(exists("copy.mp4.part"));
    zt_image_free(&image);
}

/* Any number of frames, so also those that an interruption left, is a whole film. */
static void interrupted_anywhere(void **state) {
    (void)state;
    for (int frame_count = 1; frame_count < 60; frame_count += frame_count < 6 ? 1 : 13) {
        write_movie("cut.mp4", &small, frame_count);
        assert_film("cut.mp4", frame_count, small.rate);
    }
}

/* A full disk: told once, with the file's name; nothing more is written, nothing is left, and
 * an older film stays. With room for the pictures but not for the table at the end, too. */
static void full_disk(void **state) {
    (void)state;
    zt_output_format format = {
        .width = 320, .height = 240, .rate = {24, 1}, .view = ZT_VIEW_SRGB};
    write_movie("whole.mp4", &format, 100);
    struct stat whole;
    assert_int_equal(stat("whole.mp4", &whole), 0);
    assert_true(whole.st_size > 60000);
    const rlim_t sizes[] = {1000, 40000, (rlim_t)whole.st_size - 100,
                            (rlim_t)whole.st_size - 1};
    for (int i = 0; i < 4; i++) {
        write_movie("full.mp4", &small, 2);
        write_movie("older.mp4", &small, 2);
        heard h;
        zt_output *output;
        assert_int_equal(zt_output_open(&output, "full.mp4", &format, NULL, listener_of(&h)),
                         ZT_OK);
        disk_has(sizes[i]);
        zt_status status = ZT_OK;
        for (int f = 0; f < 100; f++) {
            zt_image *image = picture(format.width, format.height, f);
            zt_status now = zt_output_write(output, image, f);
            assert_true(status == ZT_OK || now == status);
            status = now;
            zt_image_free(&image);
        }
        zt_status closed = zt_output_close(&output);
        disk_has(0);
        assert_true((status == ZT_EFILE) != (closed == ZT_EFILE));
        assert_told(&h, "cannot write full.mp4: File too large");
        assert_true(same_files("full.mp4", "older.mp4"));
        assert_false(exists("full.mp4.part"));
    }
}

/* The same film is the same file, also where the process may use only one core. */
static void same_bits(void **state) {
    (void)state;
    zt_output_format format = {
        .width = 320, .height = 240, .rate = {24, 1}, .view = ZT_VIEW_SRGB};
    write_movie("a.mp4", &format, 60);
    write_movie("b.mp4", &format, 60);
    assert_true(same_files("a.mp4", "b.mp4"));
    cpu_set_t all, one;
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    CPU_ZERO(&one);
    for (int core = 0; core < CPU_SETSIZE && CPU_COUNT(&one) == 0; core++)
        if (CPU_ISSET(core, &all)) CPU_SET(core, &one);
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    write_movie("b.mp4", &format, 60);
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
    assert_true(same_files("a.mp4", "b.mp4"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(times_are_exact),
        cmocka_unit_test(tags),
        cmocka_unit_test(groups_are_closed),
        cmocka_unit_test(colours),
        cmocka_unit_test(chroma_is_left),
        cmocka_unit_test(impossible_sizes),
        cmocka_unit_test(presets),
        cmocka_unit_test(names_are_names),
        cmocka_unit_test(replaced_when_complete),
        cmocka_unit_test(interrupted_anywhere),
        cmocka_unit_test(full_disk),
        cmocka_unit_test(same_bits),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
