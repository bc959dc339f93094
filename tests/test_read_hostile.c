/* Shows that no file makes reading crash, hang, or take memory without bound, that what cannot
 * be read is always told of, and that telling itself ends. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"
#include "draw.h"
#include "patience.h"

/* A bit of everything. */
static const char good[] =
    "zoetrope: 1\n"
    "film: { size: [64, 36], rate: 24, duration: 2 s, view: raw, samples: 2 } # a comment\n"
    "camera: { position: [0, 1.5, 6], look_at: [0, 1, 0], fov: { keys: { 0: 40 deg, 9: 0.7 rad "
    "} } }\n"
    "variables: { big: 1.5, left: [-1, $big, 0], start: 0 s }\n"
    "timings: { beat: [0 s, 25 %, 00:00:01:12] }\n"
    "curves: { hop: { after: loop, keys: { $start: 1, 1 s: { value: 2, curve: steps(3) } } } "
    "}\n"
    "materials:\n"
    "  wall: &wall { color: [0.8, 0.8, 0.75], reflectivity: 0.3 }\n"
    "  clay: { <<: *wall, color: \"#c8553d\" }\n"
    "lights:\n"
    "  - ambient: { color: { in: oklab, keys: { 0: red, 9: white } }, intensity: 0.2 }\n"
    "  - point: { name: \"l\\u00e4mp\", position: [2, 4, 2], shadows: true,\n"
    "             intensity: { at: beat, values: [1, 2, 3], curve: \"cubic-bezier(0, 1, 1, "
    "0)\" "
    "} }\n"
    "objects:\n"
    "  - plane: { normal: [0, 1, 0], distance: \"= big + 0.1 * ball.center.x\", material: wall "
    "}\n"
    "  - sphere: { radius: 1, center: { orbit: { around: ball, radius: 2, period: 1 s } } }\n"
    "  - group: { position: { follow: { path: [[0, 0, 0], $left, [0, 0, 3]] } "
    "},\n"
    "             rotation: { look_at: ball, roll: 3 }, objects: [] }\n"
    "  - sphere:\n"
    "      name: ball\n"
    "      radius: { use: hop, delay: 3, speed: 0.5, scale: $big }\n"
    "      material: clay\n"
    "      center:\n"
    "        curve: smooth\n"
    "        keys: { 0 s: $left, 500 ms: &here [0, 2.2, 0], 36: [2, 1, 0], 48: *here }\n"
    "  - sphere: { radius: 1, center: { keys: {\n"
    "      0: { value: [0, 0, 0], curve: bezier, out: { time: 3, value: [1, 0, 0] } },\n"
    "      12: { value: [0, 1, 0], curve: hermite, in: { time: -3 }, out: [0, 1, 0] },\n"
    "      24: { value: [0, 1, 1], curve: tcb, in: [0, 0, 1], tension: 0.5, bias: -1 },\n"
    "      36: { value: [0, 0, 0], curve: catmull-rom }, 48: [0, 1, 0] } } }\n"
    "  - triangle: { vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], material: { color: red } }\n"
    "  - group:\n"
    "      rotation: { keys: { 0: [0, 0, 0], 24: { axis: [0, 1, 0], angle: 90 },\n"
    "                          36: { euler: [1, 2, 3], order: zyx } } }\n"
    "      scale: { spring: { stiffness: 9, damping: 1 }, keys: { 0: 1, 12: 2 } }\n"
    "      objects: [ sphere: { center: [0, 0, 0], radius: 1 } ]\n"
    "  - mesh: { rotation: { keys: { 0: { quaternion: [1, 0, 0, 0] }, 9: { direction: [1, 0, "
    "0] "
    "} } },\n"
    "            position: { spring: { frequency: 2 }, keys: { 0: [0, 0, 0], 9: $left } }, "
    "file: "
    "one.ply }\n";

/* Reads some bytes: an animation, or mistakes that were told with places in this file. */
static zt_status read_bytes(told *t, const char *bytes, size_t size) {
    zt_animation *animation;
    write_bytes("film.yaml", bytes, size);
    *t = (told){.file = "film.yaml"};
    zt_status status = zt_animation_read(&animation, "film.yaml", NULL, 0, told_to(t));
    assert_true(status == ZT_OK || status == ZT_EDESCRIPTION);
    assert_true((status == ZT_OK) == (animation != NULL));
    assert_true((status == ZT_OK) == (t->error_count == 0));
    assert_int_equal(t->foreign_count, 0);
    zt_animation_free(&animation);
    return status;
}

/* The file ends anywhere. */
static void every_beginning(void **state) {
    (void)state;
    static told t;
    write_model("one.ply");
    assert_int_equal(read_bytes(&t, good, sizeof good - 1), ZT_OK);
    assert_string_equal(t.lines, "");
    for (size_t size = 0; size < sizeof good; size++) read_bytes(&t, good, size);
}

/* One or two runs of bytes are changed, left out, doubled, or become something that YAML cares
 * about.
 */
static void random_changes(void **state) {
    (void)state;
    static told t;
    static const char special[] = "{}[]:,&*#!|>'\"%@`-?<~ \n\t\r\\\x80\xC2\x85\xE2\xFF\x01"
                                  "0123456789.eE+";
    draw d = {.key = 7};
    int ok_count = 0;
    for (int round = 0; round < 4000; round++) {
        char text[2 * sizeof good];
        size_t size = sizeof good - 1;
        memcpy(text, good, size);
        for (int i = draw_below(&d, 3) == 0; i >= 0; i--) {
            size_t at = (size_t)draw_below(&d, (int)size - 8);
            size_t run = 1 + (size_t)draw_below(&d, 7);
            switch (draw_below(&d, 4)) {
            case 0:
                text[at] = (char)draw_bits(&d);
                break;
            case 1:
                text[at] = special[draw_below(&d, sizeof special - 1)];
                break;
            case 2:
                memmove(text + at, text + at + run, size - at - run);
                size -= run;
                break;
            case 3:
                memmove(text + at + run, text + at, size - at);
                size += run;
                break;
            }
        }
        ok_count += read_bytes(&t, text, size) == ZT_OK;
    }
    /* Neither all nor none: the changes were neither idle nor all of them the end. */
    assert_in_range(ok_count, 100, 3900);
}

/* Text that grows: a beginning, many times a middle, an end. */
static char *grown(size_t *size, const char *begin, const char *middle, size_t count,
                   const char *end) {
    size_t begin_size = strlen(begin), middle_size = strlen(middle), end_size = strlen(end);
    *size = begin_size + count * middle_size + end_size;
    char *text = malloc(*size + 1), *at = text;
    assert_non_null(text);
    memcpy(at, begin, begin_size);
    at += begin_size;
    for (size_t i = 0; i < count; i++, at += middle_size) memcpy(at, middle, middle_size);
    memcpy(at, end, end_size + 1);
    return text;
}

static long peak_memory_mb(void) {
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss / 1024;
}

/* A hundred bytes that stand for 10^11 values cost nothing. */
static void alias_bomb(void **state) {
    (void)state;
    static told t;
    char text[4096] = HEAD "a: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int i = 1; i < 11; i++) {
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used,
                 "b%d: &a%d [*a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d, *a%d]\n", i,
                 i, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1, i - 1);
    }
    double begin_s = computed_s();
    long before_mb = peak_memory_mb();
    assert_int_equal(read_bytes(&t, text, strlen(text)), ZT_EDESCRIPTION);
    assert_int_equal(t.error_count, 1);
    assert_non_null(strstr(t.lines, "aliases"));
    assert_within(begin_s, 100);
    assert_true(peak_memory_mb() - before_mb < 64);
}

/* Nor do variables: each stands for ten of the one before, or for a deeper list. */
static void variable_bombs(void **state) {
    (void)state;
    static told t;
    static const char *const forms[] = {"$v%d, $v%d, $v%d, $v%d, $v%d, $v%d, $v%d, $v%d, $v%d",
                                        "$v%d"};
    for (int form = 0; form < 2; form++) {
        char text[16 * 1024] = HEAD "variables:\n  v0: [x, x, x, x, x, x, x, x, x, x]\n";
        for (int i = 1; i < 150; i++) {
            size_t used = strlen(text);
            int n = i - 1;
            used += (size_t)snprintf(text + used, sizeof text - used, "  v%d: [", i);
            used += (size_t)snprintf(text + used, sizeof text - used, forms[form], n, n, n, n,
                                     n, n, n, n, n);
            snprintf(text + used, sizeof text - used, "]\n");
        }
        double begin_s = computed_s();
        long before_mb = peak_memory_mb();
        assert_int_equal(read_bytes(&t, text, strlen(text)), ZT_EDESCRIPTION);
        assert_int_equal(t.error_count, 1);
        assert_non_null(strstr(t.lines, "too many values"));
        assert_within(begin_s, 200);
        assert_true(peak_memory_mb() - before_mb < 200);
    }
}

/* Keys that are used by very many things do not take all memory. */
static void many_uses(void **state) {
    (void)state;
    static told t;
    size_t size;
    static char begin[400 * 1024] = HEAD "lights: [ambient: {}]\ncurves: { c: { keys: {";
    for (int i = 0; i < 20000; i++) snprintf(begin + strlen(begin), 16, "%d: 1, ", i);
    strcat(begin, "} } }\nobjects:\n");
    char *text = grown(&size, begin, "  - sphere: { center: [0, 0, 0], radius: { use: c } }\n",
                       20000, "");
    double begin_s = computed_s();
    assert_int_equal(read_bytes(&t, text, size), ZT_EDESCRIPTION);
    assert_non_null(strstr(t.lines, "too many keys are used up to here"));
    assert_within(begin_s, 500);
    assert_true(peak_memory_mb() < 2000);
    free(text);
}

/* Numbers of any size in any place give finite values, or are told. */
static void extremes(void **state) {
    (void)state;
    static told t;
    static const char *const numbers[] = {"1e308", "-1e308", "5e-324", "-1e-300",
                                          "1e154", "0",      "1"};
    static const char *const properties[] = {
        "position: { curve: hermite, scale: %s, speed: 1e9, keys: { 0: { value: [%s, 0, 1], "
        "out: "
        "[%s, 1, 2] }, 9: [0, %s, 0] } }",
        "position: { curve: bezier, scale: %s, keys: { 0: { value: [%s, 0, 1], out: { value: "
        "[%s, "
        "0, 0] } }, 9: [0, %s, 0] } }",
        "position: { curve: tcb, after: linear, keys: { 0: [%s, %s, 0], 9: [0, %s, 0], 18: "
        "[%s, "
        "0, 0] } }",
        "position: { curve: catmull-rom, after: loop-with-offset, keys: { 0: [%s, %s, 0], 9: "
        "[0, "
        "%s, 0], 18: [%s, 0, 0] } }",
        "position: { spring: { stiffness: %s, damping: %s }, keys: { 0: [%s, 0, 0], 9: [%s, 0, "
        "0] } }",
        "rotation: { curve: linear, after: linear, keys: { 0: { axis: [%s, %s, 0], angle: %s "
        "}, "
        "9: { axis: [1, %s, 0], angle: 0 } } }",
        "rotation: { keys: { 0: { quaternion: [%s, %s, 0, 0] }, 9: [%s, %s, 0] } }",
        "rotation: { in: turns, curve: hermite, keys: { 0: { value: { direction: [%s, %s, 1] "
        "}, "
        "out: [%s, 0, %s] }, 9: [0, 0, 0] } }",
        "rotation: { curve: hermite, keys: { 0: { value: [0, 0, 0], out: [%s, %s, %s, %s] }, "
        "9: "
        "[0, 1, 0] } }",
        "scale: { curve: \"back-out(%s)\", keys: { 0: %s, 9: %s, 12: %s } }",
        "scale: { curve: \"elastic-in(%s, %s)\", keys: { 0: %s, 9: %s } }",
        "scale: { keys: { %s s: %s, %s ms: %s, 3: 1 } }",
    };
    enum { NUMBER_COUNT = sizeof numbers / sizeof *numbers };
    draw d = {.key = 3};
    for (size_t p = 0; p < sizeof properties / sizeof *properties; p++)
        for (int round = 0; round < 150; round++) {
            char text[2048], property[1024];
            const char *n[4];
            for (int i = 0; i < 4; i++) n[i] = numbers[draw_below(&d, NUMBER_COUNT)];
            snprintf(property, sizeof property, properties[p], n[0], n[1], n[2], n[3]);
            snprintf(text, sizeof text, HEAD "objects: [ group: { objects: [],\n%s } ]\n",
                     property);
            write_bytes("film.yaml", text, strlen(text));
            t = (told){0};
            zt_animation *animation;
            zt_status status = zt_animation_read(&animation, "film.yaml", NULL, 0, told_to(&t));
            if (status != ZT_OK && (status != ZT_EDESCRIPTION || t.error_count == 0))
                fail_msg("%s: %d", property, status);
            for (int i = -30; animation && i < 60; i++) {
                double value[ZT_VALUE_WIDTH_MAX] = {0};
                zt_curve_eval(value, &animation->tracks[0].curve, i / 48.);
                for (int c = 0; c < 4; c++)
                    if (!isfinite(value[c])) fail_msg("%s at %g", property, i / 48.);
            }
            zt_animation_free(&animation);
        }
}

/* An easing of many stops is read once, however often it is used, and many names are found
 * without looking at all of them each time. */
static void shared_words(void **state) {
    (void)state;
    static told t;
    size_t size, used = 0;
    char *ease = grown(&size,
                       "zoetrope: 1\nfilm: { duration: 2 s }\ncamera: {}\nlights: "
                       "[ambient: {}]\ncurves:\n  c: { curve: \"linear(0",
                       ", 0.5", 100000, ", 1)\", keys: { 0: 1, 24: 2 } }\nobjects:\n");
    char *text = malloc(size + 20000 * 100 + 1);
    assert_non_null(text);
    memcpy(text, ease, used = size);
    for (int i = 0; i < 5000; i++)
        used += (size_t)sprintf(text + used,
                                "  - sphere: { center: [0, 0, 0], radius: { use: c } }\n");
    double begin_s = computed_s();
    assert_int_equal(read_bytes(&t, text, used), ZT_OK);
    assert_within(begin_s, 300);
    free(ease);

    used = (size_t)sprintf(text, HEAD "lights: [ambient: {}]\nvariables:\n");
    for (int i = 0; i < 20000; i++) used += (size_t)sprintf(text + used, "  v%d: %d\n", i, i);
    used += (size_t)sprintf(text + used, "objects:\n");
    for (int i = 0; i < 20000; i++)
        used += (size_t)sprintf(text + used,
                                "  - sphere: { center: [0, 0, 0], radius: $v%d }\n", i);
    begin_s = computed_s();
    assert_int_equal(read_bytes(&t, text, used), ZT_OK);
    assert_within(begin_s, 300);
    free(text);
}

/* What aliases may still stand for is read in bounded time: groups within groups within groups.
 */
static void alias_groups(void **state) {
    (void)state;
    static told t;
    char text[4096] =
        HEAD "objects:\n  - group: { objects: &g0 [sphere: { radius: 1, colr: 1 }] }\n";
    for (int i = 1; i < 14; i++) {
        size_t used = strlen(text);
        snprintf(
            text + used, sizeof text - used,
            "  - group: { objects: &g%d [ group: { objects: *g%d }, group: { objects: *g%d "
            "} ] }\n",
            i, i - 1, i - 1);
    }
    double begin_s = computed_s();
    assert_int_equal(read_bytes(&t, text, strlen(text)), ZT_EDESCRIPTION);
    assert_int_equal(t.error_count, 2); /* the key and the missing center, once each */
    assert_within(begin_s, 500);
}

/* Large and deep files of each kind end, and soon. */
static void large_files(void **state) {
    (void)state;
    static told t;
    static const struct {
        const char *begin, *middle, *end, *words;
        size_t count;
    } cases[] = {
        {"a: ", "[", "", "nested too deep", 1000000},
        {"a: ", "{a: ", "", "nested too deep", 300000},
        {"", "- ", "", "nested too deep", 500000},
        {"", "? ", "", "nested too deep", 500000},
        {HEAD "objects: [", "&a 1, ", "]\n", "too many anchors", 200000},
        {HEAD "objects: [&a 1, ", "*a, ", "]\n", "too many values", 1100000},
        {HEAD "objects: [", "sphere: {}, ", "]\n", "not shown", 50000},
        {HEAD, "\n", "objcts: []\n", "objects", 1000000},
        {HEAD "# ", "#", "\nobjcts: []\n", "objects", 1000000},
        {HEAD "objcts: \"", "a\n \n", "\"\n", "objects", 300000},
        {HEAD "objects: [group: { name: \"", "x", "\" } ]\n", "missing", 1000000},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size_t size;
        char *text =
            grown(&size, cases[i].begin, cases[i].middle, cases[i].count, cases[i].end);
        double begin_s = computed_s();
        assert_int_equal(read_bytes(&t, text, size), ZT_EDESCRIPTION);
        if (!strstr(t.lines, cases[i].words)) fail_msg("case %zu: %.500s", i, t.lines);
        assert_within(begin_s, 500);
        free(text);
    }
}

/* After a hundred mistakes the others are counted. */
static void many_mistakes(void **state) {
    (void)state;
    static told t;
    size_t size;
    char *text =
        grown(&size, HEAD "lights:\n", "  - point: { position: [0, 0, x] }\n", 350, "");
    assert_int_equal(read_bytes(&t, text, size), ZT_EDESCRIPTION);
    assert_int_equal(t.error_count, 100);
    assert_int_equal(t.note_count, 1);
    assert_non_null(strstr(t.lines, "note: mistakes that are not shown: 250\n"));
    free(text);
}

/* Of very many models that are not there, a hundred are told, and no more looked for. */
static void many_absent_models(void **state) {
    (void)state;
    enum { MODEL_COUNT = 20000 };
    static told t;
    static char text[64 * MODEL_COUNT];
    size_t size = (size_t)snprintf(text, sizeof text, "%sobjects:\n", HEAD);
    for (int i = 0; i < MODEL_COUNT; i++)
        size += (size_t)snprintf(text + size, sizeof text - size,
                                 "  - mesh: { file: absent%d.ply }\n", i);
    double begin_s = computed_s();
    assert_int_equal(read_bytes(&t, text, size), ZT_EDESCRIPTION);
    assert_non_null(strstr(t.lines, "cannot read absent99.ply"));
    assert_null(strstr(t.lines, "absent100.ply"));
    assert_non_null(strstr(t.lines, "100 models cannot be read; no further ones are tried"));
    assert_int_equal(t.error_count, 101);
    assert_within(begin_s, 100);
}

/* A file that cannot be read is no mistake of the description. */
static void unreadable_files(void **state) {
    (void)state;
    static told t;
    static const char *const paths[] = {"absent.yaml", ".", "absent/film.yaml", ""};
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        t = (told){.file = paths[i]};
        zt_animation *animation;
        assert_int_equal(zt_animation_read(&animation, paths[i], NULL, 0, told_to(&t)),
                         ZT_EFILE);
        assert_null(animation);
        assert_int_equal(t.error_count, 1);
        assert_int_equal(t.foreign_count, 0);
    }
}

/* Nobody needs to listen. */
static void silent(void **state) {
    (void)state;
    zt_animation *animation;
    write_bytes("film.yaml", "a: b\n", 5);
    assert_int_equal(zt_animation_read(&animation, "film.yaml", NULL, 0, (zt_listener){0}),
                     ZT_EDESCRIPTION);
    assert_int_equal(zt_animation_read(&animation, "none.yaml", NULL, 0, (zt_listener){0}),
                     ZT_EFILE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_beginning),
        cmocka_unit_test(random_changes),
        cmocka_unit_test(alias_bomb),
        cmocka_unit_test(variable_bombs),
        cmocka_unit_test(shared_words),
        cmocka_unit_test(extremes),
        cmocka_unit_test(many_uses),
        cmocka_unit_test(alias_groups),
        cmocka_unit_test(large_files),
        cmocka_unit_test(many_mistakes),
        cmocka_unit_test(many_absent_models),
        cmocka_unit_test(unreadable_files),
        cmocka_unit_test(silent),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
