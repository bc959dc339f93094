/* Manifests: what is noted is known again, whatever ended a run, however many processes note
 * things at once, and whatever a file holds instead. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/wait.h>

#include <cmocka.h>

#include "files.h"
#include "scenes.h"
#include "sequence/manifest.h"

enum { COUNT = 300 };

static const zt_manifest_line header = {.kind = ZT_LINE_HEADER,
                                        .width = 1280,
                                        .height = 720,
                                        .precision = ZT_PRECISION_DOUBLE,
                                        .description = "a \"b\"\\\n\x01.yaml",
                                        .written = "codec=h265"};

static void open_notes(zt_notes *notes, bool alone) {
    assert_int_equal(zt_notes_open(notes, "x", &header, false, alone, (zt_listener){0}), ZT_OK);
}

static void add(zt_notes *notes, zt_manifest_line line) {
    assert_int_equal(zt_notes_add(notes, &line), ZT_OK);
}

static uint64_t any_bits(uint64_t *random) {
    return (uint64_t)test_between(random, 0, 0x1p53) * 2047 + 1;
}

/* A frame and its image, `version` of it. */
static zt_manifest_line image_line(int64_t frame, int version) {
    uint64_t random = (uint64_t)(frame * 1000 + version);
    zt_manifest_line line = {.kind = ZT_LINE_FRAME};
    line.frame = (zt_manifest_frame){.frame = frame,
                                     .key = {any_bits(&random), any_bits(&random)},
                                     .pixels = {any_bits(&random), any_bits(&random)},
                                     .render_s = test_random(&random)};
    if (version % 3 == 1)
        line.frame.min = line.frame.max = (int32_t)test_between(&random, 1, 65536);
    if (version % 3 == 2) {
        line.frame.min = (int32_t)test_between(&random, 1, 1000);
        line.frame.max = line.frame.min + 7;
        line.frame.error = test_random(&random);
        line.frame.mean_max = version % 2 ? 12 : 0;
    }
    if (line.frame.max) line.frame.budget.film_s = test_between(&random, 0.1, 1e5);
    line.record = (zt_output_record){.kind = ZT_RECORD_IMAGE,
                                     .first = frame,
                                     .count = 1,
                                     .key = {any_bits(&random), 3},
                                     .checksum = {7, any_bits(&random)},
                                     .bytes = (int64_t)test_between(&random, 1, 9e15),
                                     .render_s = line.frame.render_s,
                                     .file = "f \"1\".png"};
    return line;
}

static void assert_same_frame(const zt_manifest_frame *a, const zt_manifest_frame *b) {
    assert_non_null(a);
    assert_true(zt_hash_equal(a->key, b->key) && zt_hash_equal(a->pixels, b->pixels));
    assert_true(a->render_s == b->render_s && a->min == b->min && a->max == b->max);
    assert_true(a->error == b->error && a->mean_max == b->mean_max);
    assert_true(a->budget.film_s == b->budget.film_s && a->budget.frame_s == 0);
}

static void assert_same_record(const zt_output_record *a, const zt_output_record *b) {
    assert_true(a->kind == b->kind && a->first == b->first && a->count == b->count);
    assert_true(zt_hash_equal(a->key, b->key) && zt_hash_equal(a->checksum, b->checksum));
    assert_true(a->bytes == b->bytes && a->render_s == b->render_s);
    if (b->file) assert_string_equal(a->file, b->file);
}

/* Of each frame the version that it should have, and its record. */
static void assert_known(const zt_manifest *m, int version) {
    assert_int_equal(m->frame_count, COUNT);
    for (int i = 0; i < COUNT; i++) {
        zt_manifest_line line = image_line(3 * i + 10, version);
        assert_same_frame(zt_manifest_find(m, 3 * i + 10), &line.frame);
        assert_same_record(&m->records[i], &line.record);
        assert_null(zt_manifest_find(m, 3 * i + 11));
    }
}

static const zt_output_record piece = {ZT_RECORD_PIECE, 48,     24,  {1, 2},
                                       1234567,         {3, 4}, 9.1, NULL},
                              whole = {ZT_RECORD_FILM, 0,      72, {5, 6},
                                       7654321,        {7, 8}, 28, NULL};

/* What was noted is known again, to the last bit, the later lines counting; what is asked of it
 * is answered. */
static void manifests_come_back(void **state) {
    (void)state;
    zt_notes notes;
    zt_manifest *m;
    open_notes(&notes, true);
    assert_false(exists("x.manifest")); /* nothing has been completed */
    for (int version = 0; version < 3; version++)
        for (int i = 0; i < COUNT; i++)
            add(&notes, image_line(3 * (i * 7 % COUNT) + 10, version));
    add(&notes,
        (zt_manifest_line){.kind = ZT_LINE_PIECE,
                           .record = {.kind = ZT_RECORD_PIECE, .first = 48, .count = 3}});
    add(&notes, (zt_manifest_line){.kind = ZT_LINE_PIECE, .record = piece});
    add(&notes, (zt_manifest_line){.kind = ZT_LINE_PIECE, .record = whole});
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
    assert_int_equal(zt_manifest_read(&m, "x.manifest", (zt_listener){0}), ZT_OK);
    assert_known(m, 2);
    assert_int_equal(m->record_count, COUNT + 2);
    assert_same_record(&m->records[COUNT], &piece);
    assert_same_record(&m->records[COUNT + 1], &whole);
    int64_t first, last;
    zt_manifest_range(&first, &last, m);
    assert_true(first == 10 && last == 3 * (COUNT - 1) + 10);
    zt_hash key;
    assert_true(zt_manifest_key(&key, m, 10) && !zt_manifest_key(&key, m, 11));
    assert_true(zt_manifest_time(m, 10) >= 0 && zt_manifest_time(m, 11) < 0);
    zt_render_settings open = {0},
                       set = {.width = 8, .height = 4, .precision = ZT_PRECISION_SINGLE};
    zt_manifest_settings(&open, m);
    zt_manifest_settings(&set, m);
    assert_true(open.width == 1280 && open.height == 720 &&
                open.precision == ZT_PRECISION_DOUBLE);
    assert_true(set.width == 8 && set.height == 4 && set.precision == ZT_PRECISION_SINGLE);
    zt_manifest_free(&m);
}

static long size_of(const char *path) {
    struct stat there;
    assert_int_equal(stat(path, &there), 0);
    return (long)there.st_size;
}

/* Where most lines do not count any more, a run that is alone writes the others again, and
 * knows the same; one that shares the file never does. */
static void stale_lines_go(void **state) {
    (void)state;
    zt_notes notes;
    long all = size_of("x.manifest"); /* of the test before: three versions of each */
    open_notes(&notes, false);
    assert_int_equal(size_of("x.manifest"), all);
    for (int i = 0; i < COUNT; i++) add(&notes, image_line(3 * i + 10, 1));
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
    open_notes(&notes, false);
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
    assert_true(size_of("x.manifest") > all);
    open_notes(&notes, true);
    assert_true(size_of("x.manifest") < all / 2);
    assert_known(notes.known, 1);
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
    open_notes(&notes, true);
    assert_known(notes.known, 1);
    assert_same_record(&notes.known->records[COUNT], &piece);
    assert_int_equal(notes.known->line_count, COUNT + 3);
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
    assert_int_equal(entry_count("."), 2); /* and what the tests print */
}

/* A process that is killed while it writes leaves half a line, which costs what it told of, and
 * nothing else. */
static void half_lines_cost_their_own(void **state) {
    (void)state;
    zt_notes notes;
    heard h;
    zt_manifest *m;
    long full = size_of("x.manifest");
    for (int cut = 2; cut < 150; cut += 3) {
        assert_int_equal(truncate("x.manifest", full - cut), 0);
        assert_int_equal(zt_notes_open(&notes, "x", &header, false, false, listener_of(&h)),
                         ZT_OK);
        assert_string_equal(h.text, "");
        assert_int_equal(notes.known->record_count, COUNT + 1);
        add(&notes, (zt_manifest_line){.kind = ZT_LINE_PIECE, .record = whole});
        assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
        assert_int_equal(zt_manifest_read(&m, "x.manifest", listener_of(&h)), ZT_OK);
        assert_int_equal(m->record_count, COUNT + 2);
        zt_manifest_free(&m);
        full = size_of("x.manifest");
    }
}

/* Several processes add to one file, and no line is lost or torn. */
static void processes_share(void **state) {
    (void)state;
    enum { PROCESSES = 4 };
    zt_notes notes;
    pid_t pids[PROCESSES];
    assert_int_equal(unlink("x.manifest"), 0);
    for (int p = 0; p < PROCESSES; p++) {
        pids[p] = fork();
        assert_true(pids[p] >= 0);
        if (pids[p] > 0) continue;
        bool good =
            zt_notes_open(&notes, "x", &header, false, false, (zt_listener){0}) == ZT_OK;
        for (int i = p; i < COUNT && good; i += PROCESSES) {
            zt_manifest_line line = image_line(3 * i + 10, 2);
            good = zt_notes_add(&notes, &line) == ZT_OK;
        }
        _exit(good ? 0 : 1);
    }
    for (int p = 0; p < PROCESSES; p++) {
        int code;
        assert_true(waitpid(pids[p], &code, 0) == pids[p] && code == 0);
    }
    heard h;
    assert_int_equal(zt_notes_open(&notes, "x", &header, false, true, listener_of(&h)), ZT_OK);
    assert_string_equal(h.text, "");
    assert_known(notes.known, 2);
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
}

/* Samples that were chosen for images of another size do not count for those of this one. */
static void sizes_part_samples(void **state) {
    (void)state;
    zt_manifest_line other = header;
    other.width = 640;
    zt_notes notes;
    assert_int_equal(zt_notes_open(&notes, "y", &header, false, true, (zt_listener){0}), ZT_OK);
    for (int i = 0; i < 2; i++) add(&notes, image_line(i, 1));
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
    assert_int_equal(zt_notes_open(&notes, "y", &other, false, true, (zt_listener){0}), ZT_OK);
    add(&notes, image_line(1, 1));
    assert_int_equal(zt_notes_recall(&notes), ZT_OK);
    assert_int_equal(notes.known->width, 640);
    assert_int_equal(zt_manifest_find(notes.known, 0)->max, 0);
    assert_true(zt_manifest_find(notes.known, 1)->max > 0);
    assert_int_equal(zt_notes_close(&notes, false), ZT_OK);
}

/* ---- what is no manifest --------------------------------------------------------------------
 */

#define ZEROS "00000000000000000000000000000000"
static const char good[] =
    "{\"zoetrope\": 1, \"description\": \"f\", \"size\": [4, 2], \"precision\": \"auto\", "
    "\"written\": \"\"}\n"
    "{\"frame\": 1, \"samples\": 2, \"film_s\": 3}\n"
    "{\"frame\": 2, \"min\": 1, \"max\": 9, \"error\": 1e-3, \"mean_max\": 5}\n"
    "{\"frame\": 3, \"key\": \"" ZEROS
    "\", \"time\": 0.5, \"file\": \"../../up.png\", \"bytes\": "
    "77, \"checksum\": \"" ZEROS "\", \"record\": \"" ZEROS "\"}\n"
    "{\"piece\": 0, \"count\": 2, \"bytes\": 5, \"checksum\": \"" ZEROS
    "\", \"record\": \"" ZEROS "\", \"time\": 1}\n"
    "{\"split\": \"" ZEROS "\", \"ends\": [1, 1, 4]}\n";

typedef struct place_heard {
    int count, line, column;
    zt_severity severity;
    char text[256];
} place_heard;

static void hear_place(void *user, const zt_message *message) {
    place_heard *h = user;
    h->count++;
    h->line = message->line;
    h->column = message->column;
    h->severity = message->severity;
    snprintf(h->text, sizeof h->text, "%s", message->text);
}

static zt_status read_bytes(place_heard *h, const char *bytes, size_t size) {
    FILE *file = fopen("z.manifest", "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
    zt_manifest *m;
    *h = (place_heard){0};
    zt_status status = zt_manifest_read(&m, "z.manifest", (zt_listener){hear_place, h});
    assert_true((status == ZT_OK) == (m != NULL));
    assert_int_equal(h->count, status == ZT_OK ? 0 : 1);
    zt_manifest_free(&m);
    /* A film goes on by it, whatever it holds: with a warning at most. */
    place_heard recalled = {0};
    assert_int_equal(zt_manifest_recall(&m, "z.manifest", (zt_listener){hear_place, &recalled}),
                     ZT_OK);
    assert_true(recalled.count == 0 ||
                (recalled.count == 1 && recalled.severity == ZT_WARNING));
    zt_manifest_free(&m);
    return status;
}

/* What is no manifest is refused with one sentence at its place. */
static void hostile_manifests_are_refused(void **state) {
    (void)state;
    const struct {
        const char *from, *to; /* what is changed in the good one */
        int line, column;
        const char *told;
    } cases[] = {
        {"{\"zoe", "[\"zoe", 1, 1, "here must be a {"},
        {"\"zoetrope\": 1", "\"zoetrope\": 2", 1, 14, "whole number from 1 to 1"},
        {"\"zoetrope\": 1, ", "", 1, 0, "these keys make no line"},
        {"zoetrope", "zoetrop", 1, 2, "did you mean \"zoetrope\"?"},
        {"\"description\"", "\"zoetrope\"", 1, 17, "\"zoetrope\" is there twice"},
        {"\"f\"", "f", 1, 32, "text in quotes"},
        {"[4, 2]", "[4]", 1, 0, "must be a ,"},
        {"[4, 2]", "[4, 0]", 1, 0, "from 1 to 65536"},
        {"[4, 2]", "[4, 1e3]", 1, 0, "whole number"},
        {"[4, 2]", "[4, 65537]", 1, 0, "from 1 to 65536"},
        {"auto", "half", 1, 0, "\"precision\" must be"},
        {"{\"zoe", "{\"frame\": 1}\n{\"zoe", 1, 0, "begins with its header"},
        {"\"frame\": 1", "\"frame\": -1", 2, 11, "whole number"},
        {"\"frame\": 1", "\"frame\": 99999999999999999999", 2, 11, "whole number"},
        {"\"frame\": 1, ", "", 2, 0, "these keys make no line"},
        {"\"samples\": 2", "\"samples\": 0", 2, 25, "from 1 to 65536"},
        {"\"samples\": 2", "\"min\": 2", 2, 0, "either \"samples\" or"},
        {"\"max\": 9", "\"samples\": 9", 3, 0, "either \"samples\" or"},
        {"\"min\": 1", "\"min\": 10", 3, 0, "\"max\" is below \"min\""},
        {"1e-3", "nan", 3, 0, "number from 0 to 1"},
        {"1e-3", "1e-3x", 3, 0, "a comma or a }"},
        {"1e-3", "2", 3, 0, "number from 0 to 1"},
        {"1e-3", "0x1", 3, 0, "a comma or a }"},
        {"\"" ZEROS, "\"1" ZEROS, 4, 0, "32 hexadecimal digits"},
        {"\"" ZEROS, "\"F", 4, 0, "32 hexadecimal digits"},
        {"\"bytes\": 77, ", "", 4, 0, "an image has \"file\", \"bytes\""},
        {"\"bytes\": 77", "\"bytes\": 9007199254740993", 4, 0, "whole number"},
        {"\"count\": 2", "\"count\": 0", 5, 0, "whole number"},
        {"\"count\": 2", "\"frame\": 2", 5, 0, "these keys make no line"},
        {"[1, 1, 4]", "[1, 0, 4]", 6, 0, "whole number from 1"},
        {"[1, 1, 4]", "[]", 6, 0, "whole number"},
        {"4]}\n", "4]} x", 6, 0, "here must be the end"},
    };
    place_heard h;
    assert_int_equal(read_bytes(&h, good, strlen(good)), ZT_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        const char *at = strstr(good, cases[i].from);
        assert_non_null(at);
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - good), good, cases[i].to,
                 at + strlen(cases[i].from));
        if (read_bytes(&h, text, strlen(text)) != ZT_EFILE) fail_msg("%zu is read", i);
        if (!strstr(h.text, cases[i].told))
            fail_msg("%zu: \"%s\", not \"%s\"", i, h.text, cases[i].told);
        if (h.line != cases[i].line || (cases[i].column && h.column != cases[i].column))
            fail_msg("%zu: %d:%d: %s", i, h.line, h.column, h.text);
    }
}

/* Cut off anywhere, with any byte changed, and made of nothing but brackets: refused or read,
 * never more than that; nothing is written anywhere. */
static void broken_manifests_do_no_harm(void **state) {
    (void)state;
    place_heard h;
    size_t header_length = (size_t)(strchr(good, '\n') - good) + 1;
    int entries = entry_count(".");
    for (size_t length = 0; length < sizeof good; length++) {
        zt_status status = read_bytes(&h, good, length);
        if (length < header_length) assert_int_equal(status, ZT_EFILE);
        if (length > header_length + 50) assert_int_equal(status, ZT_OK);
    }
    uint64_t random = 11;
    for (int i = 0; i < 1000; i++) {
        char bytes[sizeof good];
        memcpy(bytes, good, sizeof good);
        for (int k = 0; k < 1 + i % 3; k++)
            bytes[(size_t)(test_random(&random) * (sizeof good - 1))] =
                (char)(test_random(&random) * 256);
        read_bytes(&h, bytes, sizeof good - 1);
    }
    char *deep = malloc(1 << 20);
    assert_non_null(deep);
    memset(deep, '[', 1 << 20);
    assert_int_equal(read_bytes(&h, deep, 1 << 20), ZT_EFILE);
    memset(deep, 0, 1 << 20);
    assert_int_equal(read_bytes(&h, deep, 1 << 20), ZT_EFILE);
    free(deep);
    assert_int_equal(entry_count("."), entries);
    assert_false(exists("../../up.png"));
    zt_manifest *m;
    h = (place_heard){0};
    assert_int_equal(zt_manifest_read(&m, "missing", (zt_listener){hear_place, &h}), ZT_EFILE);
    assert_true(strstr(h.text, "cannot read missing") != NULL);
    assert_int_equal(zt_manifest_read(&m, ".", (zt_listener){hear_place, &h}), ZT_EFILE);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(manifests_come_back),
                                       cmocka_unit_test(stale_lines_go),
                                       cmocka_unit_test(half_lines_cost_their_own),
                                       cmocka_unit_test(processes_share),
                                       cmocka_unit_test(sizes_part_samples),
                                       cmocka_unit_test(hostile_manifests_are_refused),
                                       cmocka_unit_test(broken_manifests_do_no_harm)};
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
