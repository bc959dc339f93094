/* What the program tells about what frames need, and what was left out of them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "program.h"

/* A lamp below a ceiling and an attic above it; what moves stands still from frame 4 on. */
static const char house[] =
    "zoetrope: 1\n"
    "film: { size: [64, 48], rate: 24, duration: 10 }\n"
    "camera: { position: [0, 1, 6], look_at: [0, 1, 0], fov: 60 deg }\n"
    "materials: { gray: { color: [0.5, 0.5, 0.5] } }\n"
    "lights:\n"
    "  - point: { name: lamp, position: [0, 2, 2], intensity: 5 }\n"
    "  - point: { name: spare, position: [1, 2, 2], intensity: 0 }\n"
    "  - point: { name: glow, position: [1, 2, 2], intensity: 1, shadows: false }\n"
    "objects:\n"
    "  - plane: { name: ceiling, normal: [0, 1, 0], distance: 3, material: gray }\n"
    "  - plane: { name: ground, normal: [0, 1, 0], distance: 0, material: gray }\n"
    "  - box: { name: attic, center: [0, 5, 0], size: [1, 1, 1], material: gray }\n"
    "  - sphere:\n"
    "      name: ball\n"
    "      center: { curve: linear, keys: { 0: [0, 1, 0], 4: [1, 1, 0] } }\n"
    "      radius: 0.5\n"
    "      material: gray\n";

static const char mirror[] = "zoetrope: 1\n"
                             "film: { size: [64, 48], rate: 24, duration: 1 }\n"
                             "camera: { position: [0, 1, 6], look_at: [0, 0, 0] }\n"
                             "materials: { glass: { color: [1, 1, 1], reflectivity: 0.5 } }\n"
                             "lights: [ point: { name: lamp, position: [0, 2, 2] } ]\n"
                             "objects:\n"
                             "  - plane: { name: lake, normal: [0, 1, 0], distance: 0, "
                             "material: glass }\n";

/* What is left out is told with its names, and which frames are rendered once. */
static void test_explain(void **state) {
    (void)state;
    write_text("house.yaml", house);
    const run *r = zoetrope("explain house.yaml");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "no mirrors: secondary rays left out\n");
    assert_contains(r->out, "lamp never reaches \"attic\": its shadow rays left out\n");
    assert_contains(r->out, "spare gives no light: its rays left out\n");
    assert_contains(r->out, "glow casts no shadows: its shadow rays left out\n");
    assert_contains(r->out, "frames 4 to 9 hold still: rendered once\n");
    r = zoetrope("explain house.yaml --frame 2");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "frame 2 needs\n");
    assert_null(strstr(r->out, "hold still"));
    write_text("mirror.yaml", mirror);
    r = zoetrope("explain mirror.yaml");
    assert_contains(r->out, "lake mirrors nothing, as all there is lies behind it");
}

/* The number of digits and commas after `before`. */
static long number_after(const char *text, const char *before) {
    const char *at = strstr(text, before);
    long number = 0;
    if (!at) fail_msg("no \"%s\" in \"%s\"", before, text);
    for (at += strlen(before); strchr(", 0123456789", *at) && *at; at++) {
        if (*at == ' ' && number > 0) break;
        if (*at >= '0' && *at <= '9') number = 10 * number + (*at - '0');
    }
    return number;
}

/* Rays are counted by kind: each pixel's primary one; held frames are none; and no library is
 * loaded for checksums of what is analytic. */
static void test_stats(void **state) {
    (void)state;
    write_text("house.yaml", house);
    const run *r = zoetrope("render house.yaml --samples 1 --stats -o house.hash");
    assert_int_equal(r->code, 0);
    assert_contains(r->out, "frames         5 rendered, 5 held");
    assert_int_equal(number_after(r->out, "mirrored rays"), 0);
    assert_true(number_after(r->out, "shadow rays") > 0);
    assert_contains(r->out, "not loaded     OpenImageIO (image files), FFmpeg (movies), Embree "
                            "(meshes and crowds), Lua (expressions), librsvg");
    r = zoetrope("frame house.yaml 0 --samples 4 --stats -o house.hash --overwrite");
    assert_int_equal(number_after(r->out, "primary rays"), 64 * 48 * 4);
    r = zoetrope("frame house.yaml 0 --stats -o house.png");
    assert_contains(r->out, "libraries      OpenImageIO (image files)\n");
}

/* What a film's images share is neither converted nor added up again; and rays that meet
 * nothing take a short way. */
static void test_spared(void **state) {
    (void)state;
    write_text("house.yaml", house);
    const run *r = zoetrope("render house.yaml --stats -o house.mp4");
    assert_int_equal(r->code, 0);
    const int64_t tiles = 10 * (64 / 16) * (48 / 16);
    assert_int_equal(number_after(r->out, "way out        of"), tiles);
    const int64_t unconverted = number_after(strstr(r->out, "way out"), "tiles "),
                  unsummed = number_after(r->out, "not converted again, ");
    /* Of ten frames five are held. An encoder that has not done with an image leaves nothing of
     * it for the next one. */
    assert_in_range(unconverted, 1, tiles - 1);
    assert_in_range(unsummed, tiles / 4, tiles - tiles / 10);
    assert_true(number_after(r->out, "batches of rays meet nothing, ") >= 0);
    r = zoetrope("render house.yaml --stats -o house.hash");
    assert_null(strstr(r->out, "way out"));
    assert_true(number_after(r->out, "short ways") >= 0);
}

/* A mesh that is nowhere near a ray is not built; but one that a mirror shows is. */
static void test_unmet(void **state) {
    (void)state;
    static const char model[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                                "property float y\nproperty float z\nelement face 4\n"
                                "property list uchar int vertex_indices\nend_header\n"
                                "0 0 0\n%d 0 0\n0 1 0\n0 0 1\n"
                                "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    static const char scene[] =
        "zoetrope: 1\nfilm: { size: [64, 48], rate: 10, duration: 1, reflections: 2 }\n"
        "camera: { position: [0, 1, 6], look_at: [0, 1, 0] }\n"
        "lights: [ { point: { position: [2, 4, 3] } } ]\n"
        "objects:\n  - plane: { normal: [0, 1, 0] }\n"
        "  - sphere: { name: ball, radius: 1, center: [-1, 1, 0], material: { reflectivity: %s "
        "} }\n"
        "  - mesh: { name: before, file: tetrahedron.ply }\n"
        "  - mesh: { name: behind, file: other.ply, position: [-8, 1, 30], scale: 9 }\n";
    for (int i = 0; i < 2; i++) {
        char text[512];
        snprintf(text, sizeof text, model, 1 + i);
        write_text(i ? "other.ply" : "tetrahedron.ply", text);
    }
    for (int mirrors = 0; mirrors < 2; mirrors++) {
        char text[1024];
        snprintf(text, sizeof text, scene, mirrors ? "0.5" : "0");
        write_text("mesh.yaml", text);
        const run *r = zoetrope("frame mesh.yaml 0 --stats --overwrite -o mesh.hash");
        assert_int_equal(r->code, 0);
        assert_null(strstr(r->out, "\"before\" is never met"));
        bool told = strstr(r->out, "left out       mesh \"behind\" is never met: not built\n");
        assert_int_equal(told, !mirrors);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unmet),
        cmocka_unit_test(test_explain),
        cmocka_unit_test(test_stats),
        cmocka_unit_test(test_spared),
    };
    return cmocka_run_group_tests(tests, enter_directory, leave_directory);
}
