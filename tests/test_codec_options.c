/* What may be asked of a movie's codec and container is what they do and tell; what makes no
 * sense is refused before the first frame. */
#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "cards.h"
#include "encode/video_codecs.h"

/* What makes no sense is refused before the first frame, with what there is instead; nothing is
 * left. */
static void refusals(void **state) {
    (void)state;
    const struct {
        const char *target, *name, *value, *words;
        int width, height, rate;
    } cases[] = {
        {"a.mp4", "codec", "h266", "no codec \"h266\" for .mp4; did you mean \"h264\"?", 64, 64,
         24},
        {"a.mp4", "codec", "theora", "there are h264 h265 av1 vp9", 64, 64, 24},
        {"a.mp4", "codec", "prores", "prores does not go into .mp4, but into .mov .mkv", 64, 64,
         24},
        {"a.gif", "codec", "h264", "h264 does not go into .gif", 64, 64, 24},
        {"a.webm", "codec", "h264", "h264 does not go into .webm, but into .mp4 .mov .mkv", 64,
         64, 24},
        {"a.mp4", "pixel-format", "yuv420p12",
         "no pixel format \"yuv420p12\" for h264; did you mean", 64, 64, 24},
        {"a.mp4", "pixel-format", "rgb24", "there are yuv420p yuv420p10le", 64, 64, 24},
        {"a.mp4", "pixel-format", "", "there are yuv420p yuv420p10le", 64, 64, 24},
        {"a.mp4", "crf", "52", "from 0 (best) to 51", 64, 64, 24},
        {"a.mp4", "crf", "-1", "from 0 (best) to 51", 64, 64, 24},
        {"a.mp4", "crf", "good", "from 0 (best) to 51", 64, 64, 24},
        {"a.webm", "crf", "64", "from 0 (best) to 63", 64, 64, 24},
        {"a.gif", "crf", "10", "gif has no crf", 64, 64, 24},
        {"a.apng", "bitrate", "1M", "apng takes no bitrate", 64, 64, 24},
        {"a.mp4", "bitrate", "fast", "such as 8M or 800k", 64, 64, 24},
        {"a.mp4", "bitrate", "0", "such as 8M or 800k", 64, 64, 24},
        {"a.mp4", "bitrate", "1e30", "such as 8M or 800k", 64, 64, 24},
        {"a.mp4", "preset", "fats", "did you mean \"fast\"?", 64, 64, 24},
        {"a.webm", "preset", "9", "there are 8 7 6 5 4 3 2 1 0", 64, 64, 24},
        {"a.gif", "preset", "fast", "gif has no presets", 64, 64, 24},
        {"a.mp4", "encoder-option", "crf", "must be a name and a value", 64, 64, 24},
        {"a.mp4", "encoder-option", "=3", "must be a name and a value", 64, 64, 24},
        {"a.mp4", "encoder-option", "aqmode=1",
         "no encoder-option \"aqmode\" for libx264; did you mean \"aq-mode\"?", 64, 64, 24},
        {"a.mp4", "encoder-option", "aq-mode=seven", "encoder-option aq-mode=seven: ", 64, 64,
         24},
        {"a.mp4", "audio", "none.wav", "its sound, none.wav: No such file", 64, 64, 24},
        {"a.gif", "title", "x", "at most 50 frames a second", 64, 64, 60},
        {"a.mkv", "codec", "dnxhr", "dnxhr has at least 256x120 pixels, and 64x64 is less", 64,
         64, 24},
        {"a.webm", "codec", "av1", "av1 has at least 64x64", 62, 64, 24},
        {"a.mov", "codec", "prores", "an even width, and 65x64 is not; 64x64 would be", 65, 64,
         24},
        {"a.mp4", "title", "x", "an even width and height, and 64x63 is not; 64x62 would be",
         64, 63, 24},
        {"a.mp4", "codec", "H264", "did you mean \"h264\"?", 64, 64, 24},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char target[64];
        snprintf(target, sizeof target, "no/%s", cases[i].target);
        const zt_output_option options[] = {{cases[i].name, cases[i].value}, {NULL, NULL}};
        zt_output_format wrong = {.width = cases[i].width,
                                  .height = cases[i].height,
                                  .rate = {cases[i].rate, 1},
                                  .view = ZT_VIEW_SRGB};
        heard h;
        zt_output *output;
        assert_int_not_equal(zt_output_open(&output, target, &wrong, options, listener_of(&h)),
                             ZT_OK);
        assert_null(output);
        assert_told(&h, cases[i].words);
        if (exists("no")) assert_int_equal(entry_count("no"), 0);
    }
    const zt_output_option both[] = {{"crf", "20"}, {"bitrate", "1M"}, {NULL, NULL}};
    heard h;
    zt_output *output;
    assert_int_equal(zt_output_open(&output, "no/a.mp4", &format, both, listener_of(&h)),
                     ZT_EARGUMENT);
    assert_told(&h, "crf and bitrate do not go together");
}

/* Transparent films have alpha without being asked, with no fewer bits than else, where codec
 * and container can; where not, that is said, and refused if it was asked for. */
static void alpha_by_itself(void **state) {
    (void)state;
    static const struct {
        const char *target, *codec, *pixels, *opaque_pixels;
    } cases[] = {{"a.mov", "prores4444", "yuva444p10le", "yuv444p10le"},
                 {"a.webm", "vp9", "yuva420p", "yuv420p"},
                 {"a.mkv", "vp9", "yuva420p", "yuv420p"},
                 {"a.mp4", "vp9", "yuv420p", "yuv420p"},
                 {"a.mkv", "ffv1", "gbrap16le", "gbrp10le"},
                 {"a.apng", "apng", "rgba", "rgb24"},
                 {"a.gif", "gif", "bgra", "pal8"},
                 {"a.mp4", "h264", "yuv420p", "yuv420p"},
                 {"a.mov", "prores", "yuv422p10le", "yuv422p10le"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const zt_output_option options[] = {{"codec", cases[i].codec}, {NULL, NULL}};
        for (int transparent = 0; transparent < 2; transparent++) {
            zt_output_format own = format;
            zt_video_choice choice;
            heard h;
            const zt_video_ear ear = {cases[i].target, listener_of(&h)};
            own.transparent = transparent;
            assert_int_equal(zt_video_choose(&choice, &own, options, &ear), ZT_OK);
            assert_string_equal(av_get_pix_fmt_name(choice.pixels),
                                transparent ? cases[i].pixels : cases[i].opaque_pixels);
            bool lost = transparent && strcmp(cases[i].pixels, cases[i].opaque_pixels) == 0;
            assert_true((strstr(h.text, "what is transparent becomes black") != NULL) == lost);
        }
    }
    const zt_output_option asked[] = {
        {"codec", "vp9"}, {"pixel-format", "yuva420p"}, {NULL, NULL}};
    zt_video_choice choice;
    heard h;
    const zt_video_ear ear = {"a.mp4", listener_of(&h)};
    assert_int_equal(zt_video_choose(&choice, &format, asked, &ear), ZT_EUNSUPPORTED);
    assert_told(&h, ".mp4 has no place for the alpha of VP9");
}

/* A film for which there is clearly no room is refused before its first frame. */
static void no_room(void **state) {
    (void)state;
    const char *const targets[] = {"room/a.mp4", "room/a.gif", "room/a.apng"};
    for (int i = 0; i < 3; i++) {
        zt_output_format endless = {.width = 3840,
                                    .height = 2160,
                                    .rate = {24, 1},
                                    .view = ZT_VIEW_SRGB,
                                    .frame_count = INT64_C(1) << 40};
        heard h;
        zt_output *output;
        assert_int_equal(zt_output_open(&output, targets[i], &endless, NULL, listener_of(&h)),
                         ZT_EFILE);
        assert_told(&h, "GB, and the disk has room for");
        assert_int_equal(entry_count("room"), 0);
    }
}

static bool file_has(const char *path, const char *text) {
    size_t size;
    char *bytes = file_bytes(path, &size);
    bool found = memmem(bytes, size, text, strlen(text)) != NULL;
    free(bytes);
    return found;
}

static int64_t file_size(const char *path) {
    struct stat s;
    assert_int_equal(stat(path, &s), 0);
    return s.st_size;
}

/* Options reach the encoder: x264 writes its own into the stream; sizes follow quality. */
static void options_count(void **state) {
    (void)state;
    const zt_output_option own[] = {{"encoder-option", "x264-params=me=tesa:subme=9"},
                                    {"encoder-option", "refs=2"},
                                    {"crf", "23.5"},
                                    {NULL, NULL}};
    write_movie_by("own.mp4", &format, own, 10);
    assert_true(file_has("own.mp4", "me=tesa") && file_has("own.mp4", "subme=9"));
    assert_true(file_has("own.mp4", "ref=2") && file_has("own.mp4", "crf=23.5"));
    const char *const files[] = {"q.mp4", "q.mkv", "q.webm"};
    const char *const codecs[] = {"h264", "h265", "vp9"};
    for (int i = 0; i < 3; i++) {
        const zt_output_option fine[] = {{"codec", codecs[i]}, {"crf", "10"}, {NULL, NULL}},
                               rough[] = {{"codec", codecs[i]}, {"crf", "40"}, {NULL, NULL}},
                               slow[] = {
                                   {"codec", codecs[i]}, {"bitrate", "150k"}, {NULL, NULL}};
        write_movie_by(files[i], &format, fine, 24);
        int64_t fine_size = file_size(files[i]);
        write_movie_by(files[i], &format, rough, 24);
        int64_t rough_size = file_size(files[i]);
        write_movie_by(files[i], &format, slow, 24);
        if (rough_size * 2 > fine_size)
            fail_msg("%s: %" PRId64 " and %" PRId64, files[i], fine_size, rough_size);
        /* A second at 150 kbit, within a factor of three for so short a film. */
        assert_in_range(file_size(files[i]), 150000 / 8 / 3, 3 * 150000 / 8);
    }
}

/* Title, comment, how it was encoded and how it was rendered are in the container. */
static void metadata(void **state) {
    (void)state;
    const char *const files[] = {"meta.mp4", "meta.mov", "meta.mkv", "meta.webm"};
    const zt_output_option options[] = {
        {"title", "für – 日本"}, {"comment", "a; b = \"c\""}, {"crf", "21"}, {NULL, NULL}};
    const char *const rendered[] = {"synopsis", "encoder", "settings", "settings"};
    zt_output_format told = format;
    told.settings = "{\"zoetrope\": 1, \"samples\": 4}";
    for (int i = 0; i < 4; i++) {
        write_movie_by(files[i], &told, options, 3);
        film m = film_open(files[i]);
        AVDictionary *tags = m.container->metadata;
        const char *settings = i == 1 ? "encoder" : "description";
        assert_string_equal(av_dict_get(tags, "title", NULL, 0)->value, options[0].value);
        assert_string_equal(av_dict_get(tags, "comment", NULL, 0)->value, options[1].value);
        assert_non_null(av_dict_get(tags, settings, NULL, 0));
        assert_non_null(
            strstr(av_dict_get(tags, settings, NULL, 0)->value, "yuv420p, crf 21, preset "));
        const AVDictionaryEntry *how = av_dict_get(tags, rendered[i], NULL, 0);
        if (!how) fail_msg("%s has no %s", files[i], rendered[i]);
        assert_non_null(strstr(how->value, told.settings));
        film_close(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refusals), cmocka_unit_test(alpha_by_itself),
        cmocka_unit_test(no_room),  cmocka_unit_test(options_count),
        cmocka_unit_test(metadata),
    };
    return cmocka_run_group_tests(tests, files_begin, files_end);
}
