/* What a film says of its shutter and its samples becomes the numbers that are meant; what it
 * does not say is as it was before films had such things. Mistakes: tests/wrong/film-*.yaml. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "descriptions.h"

/* Each view by its name, and sRGB's where none is named. */
static void views(void **state) {
    (void)state;
    assert_int_equal(film_of_words("").view, ZT_VIEW_SRGB);
    assert_int_equal(film_of_words(", view: raw").view, ZT_VIEW_RAW);
    assert_int_equal(film_of_words(", view: srgb").view, ZT_VIEW_SRGB);
    assert_int_equal(film_of_words(", view: rec709").view, ZT_VIEW_REC709);
    assert_int_equal(film_of_words(", view: filmic").view, ZT_VIEW_FILMIC);
}

/* A view of OpenColorIO is wished for by what is said of it, and a file is beside the
 * description.
 */
static void assert_color(const char *words, bool wished, const char *config,
                         const char *display, const char *view) {
    char text[512];
    snprintf(text, sizeof text,
             "zoetrope: 1\nfilm: { duration: 1 s%s }\ncamera: { position: [0, 0, 5] }\n",
             words);
    zt_animation *animation = animation_of(text);
    zt_color_wish color = zt_animation_film(animation)->color;
    const char *found[3] = {color.config, color.display, color.view},
               *expected[3] = {config, display, view};
    assert_int_equal(color.wished, wished);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(found[i] != NULL, expected[i] != NULL);
        if (expected[i]) assert_string_equal(found[i], expected[i]);
    }
    zt_animation_free(&animation);
}

static void colors(void **state) {
    (void)state;
    assert_color("", false, NULL, NULL, NULL);
    assert_color(", color: {}", true, NULL, NULL, NULL);
    assert_color(", color: { config: /a/b.ocio, display: sRGB, view: Film 2 }", true,
                 "/a/b.ocio", "sRGB", "Film 2");
    assert_color(", color: { view: Film }", true, NULL, NULL, "Film");
}

/* Shares of the time from one frame to the next: a turn is all of it. */
static void shutter(void **state) {
    (void)state;
    const struct {
        const char *words;
        double open, close;
    } cases[] = {
        {"", 0, 0},
        {", shutter: 0", 0, 0},
        {", shutter: 180 deg", 0, 0.5},
        {", shutter: 180", 0, 0.5},
        {", shutter: 3.14159265358979323846 rad", 0, 0.5},
        {", shutter: 3600 deg", 0, 10},
        {", shutter: { angle: 172.8 deg }", 0, 0.48},
        {", shutter: { angle: 180 deg, phase: -90 deg }", -0.25, 0.25},
        {", shutter: { phase: 90, angle: 0 }", 0.25, 0.25},
        {", shutter: { phase: -3600, angle: 3600 }", -10, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_shutter s = film_of_words(cases[i].words).shutter;
        if (fabs(s.open - cases[i].open) > 1e-15 || fabs(s.close - cases[i].close) > 1e-15)
            fail_msg("%s: %.17g to %.17g", cases[i].words, s.open, s.close);
    }
}

static void samples(void **state) {
    (void)state;
    const struct {
        const char *words;
        int min, max;
        double error;
        bool edges;
    } cases[] = {
        {"", 1, 1, 0, false},
        {", samples: 64", 64, 64, 0, false},
        {", samples: 65536", 65536, 65536, 0, false},
        {", samples: { min: 8, max: 256, error: 0.002 }", 8, 256, 0.002, false},
        {", samples: { error: 0.01 }", 4, 64, 0.01, false},
        /* There is room to choose where only one of both is said. */
        {", samples: { min: 64, error: 0.01 }", 64, 256, 0.01, false},
        {", samples: { min: 65536, error: 0.01 }", 65536, 65536, 0, false},
        {", samples: { max: 2, error: 0.01 }", 2, 2, 0, false},
        /* As many for all is no choice. */
        {", samples: { min: 16, max: 16, error: 0.01 }", 16, 16, 0, false},
        {", quality: even", 1, 1, 0, false},
        {", quality: edges", 1, 64, 0.01, true},
        {", quality: edges, samples: 16", 1, 16, 0.01, true},
        {", samples: { max: 128 }, quality: edges", 1, 128, 0.01, true},
        {", samples: { min: 2, error: 0.02 }, quality: edges", 2, 64, 0.02, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_sampling s = film_of_words(cases[i].words).sampling;
        if (s.min != cases[i].min || s.max != cases[i].max || s.error != cases[i].error ||
            s.edges != cases[i].edges)
            fail_msg("%s: %d to %d, %g", cases[i].words, s.min, s.max, s.error);
    }
}

static void filters_and_seeds(void **state) {
    (void)state;
    const struct {
        const char *words;
        zt_filter filter;
        double width;
    } cases[] = {
        {"", ZT_FILTER_BOX, 0},
        {", filter: box", ZT_FILTER_BOX, 0},
        {", filter: tent", ZT_FILTER_TENT, 0},
        {", filter: gaussian", ZT_FILTER_GAUSSIAN, 0},
        {", filter: mitchell", ZT_FILTER_MITCHELL, 0},
        {", filter: blackman-harris", ZT_FILTER_BLACKMAN_HARRIS, 0},
        {", filter: { kind: tent }", ZT_FILTER_TENT, 0},
        {", filter: { kind: gaussian, width: 2.5 }", ZT_FILTER_GAUSSIAN, 2.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        zt_sampling s = film_of_words(cases[i].words).sampling;
        assert_int_equal(s.filter, cases[i].filter);
        assert_true(s.filter_width == cases[i].width);
        assert_true(s.seed == 0 && !s.seed_fixed);
    }
    zt_sampling plain = film_of_words(", seed: 4294967295").sampling,
                fixed = film_of_words(", quality: edges, seed: fixed").sampling;
    assert_true(plain.seed == UINT32_MAX && !plain.seed_fixed);
    assert_true(fixed.seed == 0 && fixed.seed_fixed);
}

/* All of it can be set from outside, too, and is checked as the text is. */
static void overrides(void **state) {
    (void)state;
    const zt_override good[] = {{"film.shutter", "{ angle: 90, phase: 45, error: 0.1 }"},
                                {"film.samples", "{ error: 0.1 }"},
                                {"film.seed", "fixed"},
                                {"film.filter", "tent"}},
                      bad[] = {{"film.shutter", "wide"}};
    static told t;
    zt_animation *animation;
    write_bytes("film.yaml", HEAD, sizeof HEAD - 1);
    t = (told){.file = NULL};
    assert_int_equal(zt_animation_read(&animation, "film.yaml", good, 4, told_to(&t)), ZT_OK);
    const zt_film *film = zt_animation_film(animation);
    assert_true(fabs(film->shutter.open - 0.125) < 1e-15);
    assert_true(fabs(film->shutter.close - 0.375) < 1e-15);
    assert_true(film->shutter.error == 0.1);
    assert_true(film->sampling.error == 0.1 && film->sampling.seed_fixed);
    assert_int_equal(film->sampling.filter, ZT_FILTER_TENT);
    zt_animation_free(&animation);
    assert_int_equal(zt_animation_read(&animation, "film.yaml", bad, 1, told_to(&t)),
                     ZT_EDESCRIPTION);
    assert_non_null(strstr(t.lines, "\"shutter\" must be an angle"));
}

/* A key between two frames is shown if the shutter is open then, and a jump is a blur. */
static void what_a_frame_shows(void **state) {
    (void)state;
    const struct {
        const char *shutter, *keys;
        int warning_count;
    } cases[] = {
        {"0", "{ 0: 1, 10.25: 2, 20: 3 }", 1},
        {"180 deg", "{ 0: 1, 10.25: 2, 20: 3 }", 0},
        {"180 deg", "{ 0: 1, 10.75: 2, 20: 3 }", 1},
        {"{ angle: 180, phase: -180 }", "{ 0: 1, 10.75: 2, 20: 3 }", 0},
        {"{ angle: 180, phase: -180 }", "{ 0: 1, 10.25: 2, 20: 3 }", 1},
        {"{ angle: 0, phase: 90 }", "{ 0: 1, 10.25: 2, 20: 3 }", 0},
        {"0", "{ 0: 1, 10: 1, 10.2: 20, 20: 20 }", 2},
        {"180 deg", "{ 0: 1, 10: 1, 10.2: 20, 20: 20 }", 0},
        {"180 deg", "{ 0: 1, 10.6: 1, 10.8: 20, 20: 20 }", 2},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        static char keys[128];
        size_t used = 0;
        /* Times as seconds: a frame is a second. */
        for (const char *c = cases[i].keys; *c; c++) {
            if (*c == ':') used += (size_t)sprintf(keys + used, " s");
            keys[used++] = *c;
        }
        keys[used] = '\0';
        char text[512];
        snprintf(text, sizeof text,
                 "zoetrope: 1\nfilm: { duration: 20 s, rate: 1, shutter: %s }\ncamera: { "
                 "position: [0, 0, 5] }\nlights: [ambient: {}]\nobjects:\n  - sphere: { "
                 "center: [0, 0, 0], radius: { "
                 "keys: %s }, material: {} }\n",
                 cases[i].shutter, keys);
        static told t;
        zt_animation *animation;
        assert_int_equal(read_told(&t, &animation, text), ZT_OK);
        zt_animation_free(&animation);
        if (t.warning_count != cases[i].warning_count)
            fail_msg("%s, %s: %s", cases[i].shutter, keys, t.lines);
    }
}

/* A file with sound is named relative to the description; none is no file. */
static void audio(void **state) {
    (void)state;
    const struct {
        const char *words, *ending;
    } cases[] = {{"", NULL},
                 {", audio: sound/track.wav", "sound/track.wav"},
                 {", audio: /sounds/track.wav", "/sounds/track.wav"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "zoetrope: 1\nfilm: { duration: 1 s%s }\ncamera: { position: [0, 0, 5] }\n",
                 cases[i].words);
        zt_animation *animation = animation_of(text);
        const char *path = zt_animation_film(animation)->audio;
        if (!cases[i].ending) assert_null(path);
        if (cases[i].ending) assert_string_equal(path, cases[i].ending);
        zt_animation_free(&animation);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views),
        cmocka_unit_test(colors),
        cmocka_unit_test(shutter),
        cmocka_unit_test(samples),
        cmocka_unit_test(filters_and_seeds),
        cmocka_unit_test(overrides),
        cmocka_unit_test(what_a_frame_shows),
        cmocka_unit_test(audio),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
