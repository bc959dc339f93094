/* Shows that images which are there become what rendering itself makes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "program.h"

/* Images of light, encoded, are the movie that rendering itself writes, byte for byte; from any
 * number on, whatever else the directory holds. */
static void linear(void **state) {
    (void)state;
    zoetrope_succeeds("render film.yaml -o film.mp4");
    zoetrope_succeeds("render film.yaml -o shots/film.####.exr --aovs Z,N");
    write_text("shots/film.5.exr", "too few digits");
    write_text("shots/film.00005.exr", "too many zeros");
    write_text("shots/film.0009.exr.part", "unfinished");
    write_text("shots/afilm.0009.exr", "another name");
    const char *patterns[] = {"####", "@@@@", "%04d"};
    for (int i = 0; i < 3; i++) {
        char arguments[128];
        snprintf(arguments, sizeof arguments, "encode shots/film.%s.exr --overwrite",
                 patterns[i]);
        run *r = zoetrope(arguments);
        assert_int_equal(r->code, 0);
        assert_contains(r->err, "output/film.mp4: 6 frames");
        assert_null(strstr(r->err, "missing"));
        assert_true(same_files("film.mp4", "output/film.mp4"));
    }
    zoetrope_succeeds("encode shots/film.####.exr --rate 30000/1001 -o ntsc.mp4");
    assert_false(same_files("film.mp4", "ntsc.mp4"));

    assert_int_equal(rename("shots/film.0004.exr", "shots/film.12345.exr"), 0);
    assert_int_equal(rename("shots/film.0005.exr", "shots/film.12346.exr"), 0);
    assert_int_equal(unlink("shots/film.0001.exr"), 0);
    run *r = zoetrope("encode shots/film.####.exr -o gaps.hash");
    assert_int_equal(r->code, 0);
    assert_contains(r->err, "number 1 is missing");
    assert_contains(r->err, "numbers 4 to 12344 are missing");
    char text[TEXT_MAX], line[256];
    read_text(text, "gaps.hash");
    assert_contains(line_of(line, text, 4), "12346");
    assert_string_equal(line_of(line, text, 5), "");
}

/* Light is shown as its film shows it, or as is asked for: both are what rendering makes of it.
 * What is there already is not replaced unasked. */
static void view(void **state) {
    (void)state;
    static const char *const views[] = {"raw", "srgb", "rec709", "filmic"};
    static const char *const commands[] = {
        "render film.yaml --frames 0-1 --view %s -o filmic.mp4%s",
        "render film.yaml --frames 0-1 --view %s -o film.####.exr%s",
        "encode film.####.exr -o again.mp4%.0s%s"};
    for (int v = 0; v < 4; v++) {
        for (int c = 0; c < 3; c++) {
            char arguments[128];
            snprintf(arguments, sizeof arguments, commands[c], views[v],
                     v > 0 ? " --overwrite" : "");
            zoetrope_succeeds(arguments);
        }
        assert_true(same_files("filmic.mp4", "again.mp4"));
    }
    run *r = zoetrope("encode film.####.exr -o again.mp4 --view srgb");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "again.mp4 exists; with --overwrite it is replaced");
    assert_true(same_files("filmic.mp4", "again.mp4"));
    zoetrope_succeeds("encode film.####.exr --view srgb -o b.####.png");
    zoetrope_succeeds("encode b.####.png -o b.hash");
    zoetrope_succeeds("frame film.yaml 0 -o a.####.png");
    zoetrope_succeeds("frame film.yaml 1 -o a.####.png");
    zoetrope_succeeds("encode a.####.png -o a.hash");
    assert_true(same_files("a.hash", "b.hash"));
}

/* So it is with a view of OpenColorIO, which counts until another one is asked for. */
static void color(void **state) {
    (void)state;
    write_text("a.ocio",
               "ocio_profile_version: 1\nroles: { scene_linear: light }\n"
               "displays: { screen: [ !<View> { name: plain, colorspace: dim } ] }\n"
               "colorspaces:\n  - !<ColorSpace> { name: light }\n"
               "  - !<ColorSpace>\n    name: dim\n    from_reference: !<ExponentTransform> "
               "{ value: [ 2, 2, 2, 1 ] }\n");
    zoetrope_succeeds(
        "render film.yaml --frames 0-1 --set film.color={\"config\":a.ocio} -o a.mp4");
    zoetrope_succeeds(
        "render film.yaml --frames 0-1 --set film.color={\"config\":a.ocio} -o film.####.exr");
    zoetrope_succeeds("encode film.####.exr -o b.mp4");
    assert_true(same_files("a.mp4", "b.mp4"));
    zoetrope_succeeds("encode film.####.exr --view raw -o c.mp4");
    assert_false(same_files("a.mp4", "c.mp4"));
}

/* Images for a display go as they are: numbers that are developed once more would differ. */
static void display(void **state) {
    (void)state;
    zoetrope_succeeds("frame film.yaml 3 -o film.####.png");
    zoetrope_succeeds("encode film.####.png -o again.####.png");
    zoetrope_succeeds("encode film.####.png -o film.hash");
    zoetrope_succeeds("encode again.####.png -o again.hash");
    assert_true(same_files("film.hash", "again.hash"));
}

/* A Targa file of 2 x 2 pixels of one colour, not multiplied by its alpha. */
static void write_targa(const char *path, const unsigned char bgra[4]) {
    const unsigned char header[18] = {[2] = 2, [12] = 2, [14] = 2, [16] = 32, [17] = 8};
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(header, 1, sizeof header, file), sizeof header);
    for (int i = 0; i < 4; i++) assert_int_equal(fwrite(bgra, 1, 4, file), 4);
    assert_int_equal(fclose(file), 0);
}

/* What is not opaque stands before black where the target has no alpha, a fifth of each colour;
 * where it has, nothing changes. */
static void alpha(void **state) {
    (void)state;
    write_targa("glass.0001.tga", (const unsigned char[]){50, 100, 255, 51});
    write_targa("dark.0001.tga", (const unsigned char[]){10, 20, 51, 255});
    write_targa("light.0001.tga", (const unsigned char[]){50, 100, 255, 255});
    zoetrope_succeeds("encode glass.####.tga -o a/film.####.jpg");
    zoetrope_succeeds("encode dark.####.tga -o b/film.####.jpg");
    zoetrope_succeeds("encode light.####.tga -o c/film.####.jpg");
    assert_true(same_files("a/film.0001.jpg", "b/film.0001.jpg"));
    assert_false(same_files("a/film.0001.jpg", "c/film.0001.jpg"));
    zoetrope_succeeds("encode glass.####.tga -o first.####.png");
    zoetrope_succeeds("encode first.####.png -o first/first.####.png");
    zoetrope_succeeds("encode light.####.tga -o light.####.png");
    assert_true(same_files("first.0001.png", "first/first.0001.png"));
    assert_false(same_files("first.0001.png", "light.0001.png"));
}

/* What cannot be encoded is told, and leaves nothing behind. */
static void refusals(void **state) {
    (void)state;
    static const refusal cases[] = {
        {"encode film.####.exr", "there are no files film.####.exr", 3},
        {"encode film.####.exr -o film.mp4 --view blue", "--view blue: there are raw", 2},
        {"encode film.exr -o film.mp4", "must have the place of one number", 2},
        {"encode film.##.##.exr -o film.mp4", "must have the place of one number", 2},
        {"encode film.%04x.exr -o film.mp4", "must have the place of one number", 2},
        {"encode film.####.exr -o film.mp4", "there are no files film.####.exr", 3},
        {"encode none/film.####.exr -o film.mp4", "cannot read none/", 3},
        {"encode bad.####.exr -o film.mp4", "cannot read bad.0001.exr", 3},
        {"encode film.####.exr -o film.mp4 --rate 0", "--rate 0: must be", 2},
        {"encode film.####.exr -o film.mp4 --rate 30000/", "--rate 30000/: must be", 2},
        {"encode film.####.exr -o film.mp4 --rate 24x", "--rate 24x: must be", 2},
        {"encode film.####.exr -o film.mp4 --size 4x4", "encode takes no --size", 2},
        {"encode film.####.exr -o film.mp4 --set a=1", "encode takes no --set", 2},
        {"render film.yaml --rate 24", "render takes no --rate", 2},
    };
    write_text("bad.0001.exr", "not an image");
    assert_refused(cases, sizeof cases / sizeof *cases);
    assert_int_equal(entry_count("."), 2); /* film.yaml, and what is no image */
    zoetrope_succeeds("render film.yaml --frames 0 -o film.####.png");
    zoetrope_succeeds("render film.yaml --frames 1 --size 32x18 -o film.####.png");
    run *r = zoetrope("encode film.####.png -o film.hash");
    assert_int_equal(r->code, 3);
    assert_contains(r->err, "image 1 has 32 x 18 pixels, those before 64 x 36");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(linear),  IN_DIRECTORY(view),  IN_DIRECTORY(color),
        IN_DIRECTORY(display), IN_DIRECTORY(alpha), IN_DIRECTORY(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
