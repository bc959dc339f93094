/* Shows what the program does as a person meets it: what it prints where, how it ends, what it
 * leaves behind. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "program.h"

/* Help and version are results: on standard output, successful. */
static void help_and_version(void **state) {
    (void)state;
    run *r = zoetrope("--version");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->out, "zoetrope 0.1.0\n");
    r = zoetrope("--help");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    const char *words[] = {"render",  "frame",  "preview", "check",
                           "explain", "curves", "--size",  "--version"};
    for (int i = 0; i < 8; i++) assert_contains(r->out, words[i]);
    r = zoetrope("check -h");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "zoetrope check FILE");
    assert_null(strstr(r->out, "--size")); /* which check does not take */
    r = zoetrope("render film.yaml --help");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "frames.####.png");
    r = zoetrope("");
    assert_int_equal(r->code, 2);
    assert_string_equal(r->out, "");
    assert_contains(r->err, "Usage: zoetrope");
}

/* Each misuse is told in a sentence that helps on, ends with 2, and leaves nothing behind. */
static void misuse(void **state) {
    (void)state;
    static const refusal cases[] = {
        {"rendr film.yaml", "did you mean render?", 2},
        {"film.yaml", "did you mean render film.yaml?", 2},
        {"paint film.yaml", "unknown command paint", 2},
        {"render film.yaml --sise=4x4", "did you mean --size?", 2},
        {"render film.yaml --sam 4", "did you mean --samples?", 2},
        {"render film.yaml -x", "unknown option -x", 2},
        {"render", "render needs FILE", 2},
        {"frame film.yaml", "frame needs FILE N", 2},
        {"frame film.yaml x", "x is not the number of a frame", 2},
        {"frame film.yaml 1x", "1x is not the number of a frame", 2},
        {"frame film.yaml 6", "no frame 6: the film has frames 0 to 5", 2},
        {"frame film.yaml 99999999999999999999", "is not the number of a frame", 2},
        {"render film.yaml other.yaml", "one word too many: other.yaml", 2},
        {"render film.yaml -- --quiet", "one word too many: --quiet", 2},
        {"check film.yaml --size=4x4", "check takes no --size", 2},
        {"frame film.yaml 1 --frames 1-2", "frame takes no --frames", 2},
        {"render film.yaml --quiet=yes", "--quiet takes no value", 2},
        {"render film.yaml -o", "--output needs a value", 2},
        {"render film.yaml --output=", "--output needs a value", 2},
        {"render film.yaml --size 640", "--size 640: must be", 2},
        {"render film.yaml --size 0x4", "--size 0x4: must be", 2},
        {"render film.yaml --size 4x4x4", "--size 4x4x4: must be", 2},
        {"render film.yaml --size 65537x4", "65536", 2},
        {"render film.yaml --threads 0", "--threads 0: must be a number from 1", 2},
        {"render film.yaml --samples -4", "--samples -4: must be a number from 1", 2},
        {"render film.yaml --samples 4.5", "--samples 4.5: must be a number from 1", 2},
        {"render film.yaml --samples 4-64", "--samples 4-64 needs --error", 2},
        {"render film.yaml --samples 64-4 --error 0.1", "--samples 64-4: must be a number", 2},
        {"preview film.yaml --quality edges", "preview takes no --quality", 2},
        {"explain film.yaml --frames 3-2", "--frames 3-2: must be", 2},
        {"explain film.yaml --frames 3-", "--frames 3-: must be", 2},
        {"explain film.yaml --frames -3", "--frames -3: must be", 2},
        {"render film.yaml --frames 3-", "frames 3-: at \"\": a frame's number belongs here",
         2},
        {"render film.yaml --frames 0,7", "there is no frame 7: the film has frames 0 to 5", 2},
        {"render film.yaml --chunk 0/3", "--chunk 0/3: must be a part", 2},
        {"render film.yaml --chunk 4/3", "--chunk 4/3: must be a part", 2},
        {"render film.yaml --chunk 3", "--chunk 3: must be a part", 2},
        {"check film.yaml --overwrite", "check takes no --overwrite", 2},
        {"render film.yaml --frames 4-6", "no frame 6: the film has frames 0 to 5", 2},
        {"render film.yaml --size 33x18 -o film.mp4", "33", 2},
        {"render film.yaml --preset quick -o film.mp4", "ultrafast superfast veryfast faster",
         2},
        {"preview film.yaml --preset 3", "no preset \"3\"", 2},
        {"render film.yaml --preset fast -o film.hash", "no option \"preset\" for checksums",
         2},
        {"frame film.yaml 1 --preset fast", "no option \"preset\" for images", 2},
        {"check film.yaml --preset fast", "check takes no --preset", 2},
        {"render film.yaml --precision half",
         "--precision half: must be single, double or auto", 2},
        {"check film.yaml --precision single", "check takes no --precision", 2},
        {"explain film.yaml --precision double", "explain takes no --precision", 2},
        {"explain film.yaml ball.center@1 ball", "one word too many: ball", 2},
        {"explain film.yaml ball.center@1 --frames 1", "--frames or a property, not both", 2},
        {"explain film.yaml --frames 6", "no frame 6: the film has frames 0 to 5", 2},
        {"render film.yaml --aovs Z,q", "--aovs Z,q: there is no \"q\"; there are Z, P, N", 2},
        {"render film.yaml --aovs Z,", "--aovs Z,: there is no \"\"; there are Z, P, N", 2},
        {"preview film.yaml --aovs Z", "preview takes no --aovs", 2},
        {"render film.yaml --view blue", "--view blue: there are raw, srgb", 2},
        {"check film.yaml --view srgb", "check takes no --view", 2},
        {"render film.yaml --verify 0", "--verify 0: must be a number from 1", 2},
        {"frame film.yaml 1 --verify 1", "frame takes no --verify", 2},
        {"diff film.yaml", "diff needs OLD NEW", 2},
        {"diff film.yaml film.yaml --frames 1", "diff takes no --frames", 2},
        {"reproduce", "reproduce needs IMAGE", 2},
        {"reproduce a.exr film.yaml b", "one word too many: b", 2},
        {"reproduce a.exr --set a=1", "reproduce takes no --set", 2},
    };
    assert_refused(cases, sizeof cases / sizeof *cases);
    assert_int_equal(entry_count("."), 1); /* film.yaml alone */
}

/* Mistakes in the description: all told, each with its place; 1; nothing written. */
static void mistakes(void **state) {
    (void)state;
    write_text("wrong.yaml", "zoetrope: 1\n"
                             "film: { size: [64, 36], rate: 24, duration: 1 s }\n"
                             "camera: { position: [0, 1, 6] }\n"
                             "objects:\n"
                             "  - sphere: { raduis: 1, center: [0, 0, 0] }\n"
                             "  - spere: { radius: 1, center: [0, 0, 0] }\n");
    const char *commands[] = {"render wrong.yaml", "frame wrong.yaml 0", "preview wrong.yaml",
                              "check wrong.yaml", "render wrong.yaml --quiet -o new/x.png"};
    for (int i = 0; i < 5; i++) {
        run *r = zoetrope(commands[i]);
        assert_int_equal(r->code, 1);
        assert_contains(r->err, "wrong.yaml:5:15: error: ");
        assert_contains(r->err, "\"radius\"");
        assert_contains(r->err, "wrong.yaml:6:5: error: ");
        assert_contains(r->err, "      |               ^~~~~~");
        assert_string_equal(r->out, "");
    }
    assert_int_equal(entry_count("."), 2);
}

/* What the world refuses is told with its name, and ends with 3. */
static void refusals(void **state) {
    (void)state;
    run *r = zoetrope("render missing.yaml");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "missing.yaml");
    r = zoetrope("frame film.yaml 0 -o film.yaml/image.png");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "film.yaml/image.png");
    r = zoetrope("render film.yaml -o film.xyz");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "film.xyz");
    assert_int_equal(entry_count("."), 1);
}

/* Check prints what is in the film, on standard output. */
static void check(void **state) {
    (void)state;
    run *r = zoetrope("check film.yaml");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    assert_string_equal(r->out, "size       64 x 36\n"
                                "rate       6 frames a second\n"
                                "frames     6 (0 to 5)\n"
                                "duration   1 s\n"
                                "view       srgb\n"
                                "samples    1 a pixel\n"
                                "objects    1 plane, 1 sphere\n"
                                "triangles  0\n"
                                "lights     1 point\n"
                                "materials  1\n"
                                "moves      ball.center  smooth, 2 keys, 0 s to 1 s\n");
    assert_int_equal(entry_count("."), 1);
}

/* Checksums show that --frames chooses frames without changing them, that --threads changes
 * nothing, that --size and --samples do, and that preview is a quarter of the size. */
static void settings(void **state) {
    (void)state;
    char all[TEXT_MAX], some[TEXT_MAX], a[256], b[256];
    zoetrope_succeeds("render film.yaml -o all.hash");
    read_text(all, "all.hash");
    assert_string_not_equal(line_of(a, all, 5), "");
    assert_string_equal(line_of(a, all, 6), "");
    assert_contains(line_of(a, all, 0), "64x36");

    zoetrope_succeeds("render --frames=2-3 film.yaml --output some.hash --threads 3");
    read_text(some, "some.hash");
    assert_string_equal(line_of(a, some, 0), line_of(b, all, 2));
    assert_string_equal(line_of(a, some, 1), line_of(b, all, 3));
    assert_string_equal(line_of(a, some, 2), "");
    assert_string_not_equal(line_of(a, all, 2), line_of(b, all, 3));
    zoetrope_succeeds("render film.yaml --frames 5 --threads 1 -osome.hash");
    read_text(some, "some.hash");
    assert_string_equal(line_of(a, some, 0), line_of(b, all, 5));
    assert_string_equal(line_of(a, some, 1), "");
    zoetrope_succeeds("render film.yaml --frames -4--1 --chunk 2/2 -o chunk.hash");
    read_text(some, "chunk.hash");
    assert_string_equal(line_of(a, some, 0), line_of(b, all, 4));
    assert_string_equal(line_of(a, some, 1), line_of(b, all, 5));
    assert_string_equal(line_of(a, some, 2), "");
    zoetrope_succeeds("render film.yaml --frames 1-5x2,3 -o steps.hash");
    read_text(some, "steps.hash");
    for (int i = 0; i < 3; i++)
        assert_string_equal(line_of(a, some, i), line_of(b, all, 1 + 2 * i));
    assert_string_equal(line_of(a, some, 3), "");
    run *r = zoetrope("render film.yaml --frames 2 --chunk 1/2 -o none.hash");
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "part 1 of 2 has no frames");
    assert_int_equal(access("none.hash", F_OK), -1);
    zoetrope_succeeds("-q frame film.yaml 4 -o one.hash");
    read_text(some, "one.hash");
    assert_string_equal(line_of(a, some, 0), line_of(b, all, 4));

    zoetrope_succeeds("render film.yaml --frames 0 --samples 2 -o some.hash");
    read_text(some, "some.hash");
    assert_string_not_equal(line_of(a, some, 0), line_of(b, all, 0));
    zoetrope_succeeds("render film.yaml --frames 0 --size 31x17 -o some.hash");
    read_text(some, "some.hash");
    assert_contains(line_of(a, some, 0), "31x17");
    zoetrope_succeeds("preview film.yaml --frames 0 -o some.hash");
    read_text(some, "some.hash");
    assert_contains(line_of(a, some, 0), "16x10"); /* 9 rows made even */
}

/* Rays of one precision or the other, and single where nothing asks for more, as explain says;
 * it says so of the frames that it is asked for. */
static void precision(void **state) {
    (void)state;
    char chosen[TEXT_MAX], alone[TEXT_MAX], twice[TEXT_MAX];
    zoetrope_succeeds("render film.yaml -o auto.hash");
    zoetrope_succeeds("render film.yaml -o single.hash --precision single");
    zoetrope_succeeds("render film.yaml -o double.hash --precision=double");
    zoetrope_succeeds("render film.yaml -o again.hash --precision=auto");
    read_text(chosen, "auto.hash");
    read_text(alone, "single.hash");
    read_text(twice, "double.hash");
    assert_string_equal(chosen, alone);
    assert_string_not_equal(chosen, twice);
    read_text(alone, "again.hash");
    assert_string_equal(chosen, alone);
    run *r = zoetrope("explain film.yaml");
    assert_int_equal(r->code, 0);
    assert_contains(
        r->out, "frames 0 to 5: single precision: its roundings stay below what can be seen\n");
    r = zoetrope("explain film.yaml --frames 3");
    assert_contains(r->out, "frame 3: single precision");
    /* So large that it is a ground, from afar and from near. */
    r = zoetrope("explain film.yaml --set ball.radius=1e4 --set camera.position=[0,1.5e4,0]");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "single");
    r = zoetrope("explain film.yaml --set ball.radius=1e4 --set camera.position=[0,10002,0]");
    assert_contains(r->out, "double precision: the camera is 1 from ball");
    r = zoetrope("frame film.yaml 2 --precision=single -ox.png --set ball.radius=1e4 "
                 "--set camera.position=[0,10002,0]");
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "warning: frame 2 asks for double precision: the camera is 1 from");
}

/* Where images go by default; what is told of it, and what is not when quiet. */
static void default_targets(void **state) {
    (void)state;
    run *r = zoetrope("render film.yaml --keep 0"); /* however long frames take */
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "output/film.mp4: 6 frames in ");
    assert_null(strpbrk(r->err, "\r\033")); /* which are for terminals */
    assert_true(exists("output/film.mp4"));
    r = zoetrope("frame film.yaml 3 --quiet");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    assert_string_equal(r->out, "");
    assert_true(exists("output/film.0003.png"));
    zoetrope_succeeds("preview ./film.yaml --keep 0");
    assert_true(exists("output/film.preview.mp4"));
    assert_int_equal(entry_count("output"), 5); /* and what is known of the two films */
    zoetrope_succeeds("render film.yaml -o stills/f.###.png --keep 0");
    assert_true(exists("stills/f.000.png") && exists("stills/f.005.png"));
    assert_int_equal(entry_count("stills"), 7); /* and what is known of them */
}

/* Names come into the places that a target has for them; another place is a misuse. */
static void target_places(void **state) {
    (void)state;
    zoetrope_succeeds(
        "render film.yaml --frames 1 --aovs Z -o places/{name}.{camera}.{layer}.##.exr");
    assert_true(exists("places/film.camera.rgba.01.exr"));
    assert_true(exists("places/film.camera.depth.01.exr"));
    run *r = zoetrope("render film.yaml -o places/{shot}.png");
    assert_int_equal(r->code, 2);
    assert_contains(r->err,
                    "no {shot} for places/{shot}.png: there is {name}, {camera} and {layer}");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(help_and_version),
        IN_DIRECTORY(misuse),
        IN_DIRECTORY(mistakes),
        IN_DIRECTORY(refusals),
        IN_DIRECTORY(check),
        IN_DIRECTORY(settings),
        IN_DIRECTORY(precision),
        IN_DIRECTORY(default_targets),
        IN_DIRECTORY(target_places),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
