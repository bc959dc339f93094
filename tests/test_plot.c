/* Shows that explaining and plotting do what they say when a person runs them: what is printed,
 * what the drawing holds, and that lines go where the curve is. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "image/file.h"
#include "program.h"

static const char moving[] =
    "zoetrope: 1\n"
    "film: { rate: 10, duration: 4 s }\n"
    "camera: { position: [0, 0, 9], fov: { curve: linear, keys: { 0 s: 20 deg, 4 s: 60 deg } } "
    "}\n"
    "lights:\n"
    "  - point: { name: \"a <b> & c\", position: [2, 4, 2], intensity: \"= 5 + t\" }\n"
    "materials:\n"
    "  clay: { color: { curve: linear, keys: { 0 s: \"#000000\", 4 s: \"#c8553d\" } } }\n"
    "objects:\n"
    "  - sphere: { name: stair, radius: { curve: hold, keys: { 0 s: 1, 2 s: 3 } },\n"
    "              center: [1, 2, 3] }\n"
    "  - sphere: { name: spring, center: [0, 0, 0],\n"
    "              radius: { spring: { frequency: 5, damping_ratio: 0 },\n"
    "                        keys: { 0 s: 2, 1 s: 3 } } }\n";

/* The points of the n-th line of a drawing; returns their number. */
static int line_points(double points[][2], int most, const char *svg, int n) {
    for (int i = 0; i <= n; i++) {
        svg = strstr(svg, "<path class=\"line\" stroke=");
        assert_non_null(svg);
        svg = strstr(svg + 1, " d=\"M");
    }
    int count = 0, length;
    for (svg += 5; count < most &&
                   sscanf(svg, "%lf %lf%n", &points[count][0], &points[count][1], &length) == 2;
         svg += length + (svg[length] == 'L'))
        count++;
    return count;
}

static char *drawing_of(const char *arguments) {
    size_t size;
    zoetrope_succeeds(arguments);
    return file_bytes("c.svg", &size);
}

/* All that explain prints of a moment between two keys. */
static void explain(void **state) {
    (void)state;
    write_text("moving.yaml", moving);
    run *r = zoetrope("explain moving.yaml camera.fov@30");
    assert_int_equal(r->code, 0);
    assert_string_equal(r->err, "");
    assert_string_equal(
        r->out, "camera.fov at frame 30, 3 s: the angle that the picture's height spans\n"
                "driven by  linear, 2 keys  moving.yaml:3:37\n"
                "value                50 deg\n"
                "velocity             10 deg a second\n"
                "key 1                20 deg  at frame 0, 0 s  moving.yaml:3:62\n"
                "key 2                60 deg  at frame 40, 4 s  moving.yaml:3:75\n"
                "way        linear: u = 0.75 of its time\n");
    r = zoetrope("explain moving.yaml stair.center@1.5s");
    assert_contains(r->out, "stair.center at frame 15, 1.5 s: the middle\n");
    assert_contains(r->out, "driven by  constant  moving.yaml:9:5\n");
    assert_contains(r->out, "value                 1            2            3\n");
    r = zoetrope("explain moving.yaml clay.color@40");
    assert_contains(r->out, "= #c8553d");
    r = zoetrope("explain moving.yaml --set stair.center.x=4 stair.center@1");
    assert_int_equal(r->code, 1);
    r = zoetrope("explain moving.yaml --set camera.fov=33 camera.fov@1");
    assert_contains(r->out, "33 deg\n");
}

/* What is no property, no time, no target. */
static void misuse(void **state) {
    (void)state;
    write_text("moving.yaml", moving);
    const struct {
        const char *arguments, *told;
    } cases[] = {
        {"explain moving.yaml camera.fov", "lamp.position@37"},
        {"explain moving.yaml @3", "lamp.position@37"},
        {"explain moving.yaml camera.fov@", "lamp.position@37"},
        {"explain moving.yaml camera.fv@3", "did you mean camera.fov?"},
        {"explain moving.yaml camera.fov@soon", "\"soon\" is no time"},
        {"explain moving.yaml camera.fov@3 -o x.svg", "explain takes no --output"},
        {"curves moving.yaml stair.radios -o x.svg", "did you mean stair.radius?"},
        {"curves moving.yaml -o x.pdf", "x.pdf: a drawing can be written as .svg or .png"},
        {"curves moving.yaml --frames 30-40", "no frame 40"},
        {"curves still.yaml", "nothing moves"},
    };
    write_text("still.yaml", "zoetrope: 1\nfilm: { duration: 1 s }\n"
                             "camera: { position: [0, 0, 9] }\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        run *r = zoetrope(cases[i].arguments);
        if (r->code != 2) fail_msg("zoetrope %s ended with %d", cases[i].arguments, r->code);
        assert_contains(r->err, cases[i].told);
        assert_string_equal(r->out, "");
    }
    assert_int_equal(entry_count("."), 3); /* the descriptions alone */
    run *r = zoetrope("curves moving.yaml -o film.yaml/x.svg");
    assert_int_equal(r->code, 3);
}

/* A panel for each property, by default for all that move; names are safe within XML. The same
 * bytes each time, by default under output/. */
static void drawings(void **state) {
    (void)state;
    write_text("moving.yaml", moving);
    char *svg = drawing_of("curves moving.yaml -o c.svg -q");
    assert_true(strncmp(svg, "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"760\"", 50) ==
                0);
    const char *words[] = {"camera.fov",
                           "linear, 2 keys, in deg",
                           "a &lt;b> &amp; c.intensity",
                           "expression",
                           "clay.color",
                           ">r</text>",
                           "stair.radius",
                           "spring.radius",
                           "frames 0 to 39, 10 a second",
                           "fill=\"#c",
                           "</svg>"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) assert_contains(svg, words[i]);
    assert_null(strstr(svg, "nan"));
    assert_null(strstr(svg, "inf"));
    free(svg);
    zoetrope_succeeds("curves moving.yaml");
    assert_true(same_files("c.svg", "output/moving.curves.svg"));
    svg = drawing_of("curves moving.yaml stair.radius spring.radius -o c.svg");
    assert_null(strstr(svg, "camera.fov"));
    free(svg);
}

/* Straight lines take two points, steps are vertical, and a spring of twenty swings has all of
 * them at their full height. */
static void lines(void **state) {
    (void)state;
    enum { MOST = 4000 };
    static double points[MOST][2];
    write_text("moving.yaml", moving);
    char *svg = drawing_of("curves moving.yaml camera.fov stair.radius spring.radius -o c.svg");
    assert_int_equal(line_points(points, MOST, svg, 0), 2);
    assert_true(points[1][0] > points[0][0] + 600 && points[1][1] < points[0][1] - 100);

    int count = line_points(points, MOST, svg, 1);
    assert_in_range(count, 4, 5);
    double middle = (points[0][0] + points[count - 1][0]) / 2; /* 2 s of 4 s */
    assert_true(points[1][1] == points[0][1] && points[2][1] < points[1][1] - 100);
    assert_true(fabs(points[1][0] - middle) < 0.03 && fabs(points[2][0] - middle) < 0.03);
    assert_true(points[count - 1][1] == points[2][1]);

    count = line_points(points, MOST, svg, 2);
    double top = INFINITY, bottom = 0;
    for (int i = 0; i < count; i++) {
        top = fmin(top, points[i][1]);
        bottom = fmax(bottom, points[i][1]);
    }
    int tops = 0;
    for (int i = 1; i + 1 < count; i++)
        tops += points[i][1] < top + 0.3 && points[i][1] <= points[i - 1][1] &&
                points[i][1] < points[i + 1][1];
    assert_in_range(tops, 15, 16);        /* five a second, from 1 s on, and maybe the end */
    double middle_y = (top + bottom) / 2; /* of the swing from 2 to 4, its place to rest */
    for (int i = 0; i < count; i++) {
        double t = 4 * (points[i][0] - points[0][0]) / (points[count - 1][0] - points[0][0]);
        double swing = t < 1 ? 1 : cos(10 * 3.14159265358979323846 * (t - 1));
        double y = middle_y + (bottom - top) / 2 * swing;
        if (fabs(points[i][1] - y) > 0.6) fail_msg("%g s is at %g, not %g", t, points[i][1], y);
    }
    free(svg);
}

/* Numbers at the ends of what doubles hold are drawn, too. */
static void giants(void **state) {
    (void)state;
    write_text("giants.yaml", "zoetrope: 1\nfilm: { duration: 4 s }\n"
                              "camera: { position: { keys: { 0 s: [-1.7e308, 1e-300, 5], 1 s: "
                              "[1.7e308, 0, 5] } } }\n");
    char *svg = drawing_of("curves giants.yaml -o c.svg -q");
    assert_null(strstr(svg, "nan"));
    assert_null(strstr(svg, "inf"));
    assert_contains(svg, "e+308");
    free(svg);
}

/* A PNG is the same picture, two pixels for each unit: white paper, lines in their colours. */
static void png(void **state) {
    (void)state;
    write_text("moving.yaml", moving);
    zoetrope_succeeds("curves moving.yaml camera.fov -o c.png");
    heard h;
    zt_image *image;
    assert_int_equal(zt_image_file_read(&image, "c.png", listener_of(&h)), ZT_OK);
    assert_int_equal(image->width, 2 * 760);
    assert_int_equal(image->height, 2 * (38 + 150 + 34 + 26));
    for (int c = 0; c < 3; c++) assert_true(image->pixels[c] == 1);
    int blue_count = 0, other_count = 0;
    for (int i = 0; i < image->width * image->height; i++) {
        const float *p = image->pixels + 4 * (size_t)i;
        blue_count += p[0] < 0.02F && fabsf(p[1] - 0x72 / 255.F) < 0.02F &&
                      fabsf(p[2] - 0xB2 / 255.F) < 0.02F;
        other_count += p[0] > p[2] + 0.2F;
    }
    assert_true(blue_count > 1000); /* a line of 1300 pixels and some three wide */
    assert_int_equal(other_count, 0);
    zt_image_free(&image);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_DIRECTORY(explain), IN_DIRECTORY(misuse), IN_DIRECTORY(drawings),
        IN_DIRECTORY(lines),   IN_DIRECTORY(giants), IN_DIRECTORY(png),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
