/* Shows that PLY files by many hands load with the counts their makers gave them, that hostile
 * ones are refused in good time and little memory, and that our own model is a closed surface.
 */
#include <ftw.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <cmocka.h>

#include "patience.h"
#include "ply_reading.h"

static void read_data(reading *r, const char *folder, const char *name) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s/%s", ZT_TEST_DATA_DIR, folder, name);
    read_path(r, path, NULL);
}

static int found_count;
static int count_file(const char *path, const struct stat *about, int type, struct FTW *at) {
    (void)path, (void)about, (void)at;
    found_count += type == FTW_F;
    return 0;
}

/* How many files are there below a folder of the test data. Skips the test where there is none.
 */
static int count_files(const char *folder) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", ZT_TEST_DATA_DIR, folder);
    if (access(path, R_OK) != 0) skip();
    found_count = 0;
    nftw(path, count_file, 16, FTW_PHYS);
    return found_count;
}

/* As counted by others (SOURCES.md beside the data): vertices and triangles, or why not. */
static const struct {
    const char *name;
    int vertices, triangles;
    const char *refusal;
} files[] = {
    {"assimp/Wuson.ply", 11184, 3732, NULL},
    {"assimp/cube.ply", 8, 12, NULL},
    {"assimp/cube_binary_header_with_RN_newline.ply", 8, 12, NULL},
    {"assimp/float-color.ply", 3, 1, NULL},
    {"draco/cube_att.ply", 24, 12, NULL},
    {"draco/cube_quads.ply", 8, 12, NULL},
    {"draco/int_point_cloud.ply", 0, 0,
     "there are 16 points but no faces: nothing that could be rendered"},
    {"draco/test_more_datatypes.ply", 3, 1, NULL},
    {"draco/test_pos_color.ply", 114, 224, NULL},
    {"geometry-central/bob_small.ply", 250, 500, NULL},
    {"geometry-central/sphere_small.ply", 162, 320, NULL},
    {"geometry-central/spot.ply", 2930, 5856, NULL},
    {"happly/platonic_shelf.ply", 50, 80, NULL},
    {"happly/platonic_shelf_ascii.ply", 50, 80, NULL},
    {"jply/simple-bigendian.ply", 3, 1, NULL},
    {"jply/simple-littleendian.ply", 3, 1, NULL},
    {"loaders.gl/ripple_bin.ply", 0, 0,
     "there are 10201 points but no faces: nothing that could be rendered"},
    {"magnum/ascii.ply", 3, 1, NULL},
    {"magnum/custom-components-be.ply", 5, 3, NULL},
    {"magnum/custom-components.ply", 5, 3, NULL},
    {"magnum/per-face-colors-be.ply", 5, 3, NULL},
    {"magnum/positions-char-colors4-ushort-texcoords-uchar-indices-short-be.ply", 5, 3, NULL},
    {"magnum/positions-colors-normals-texcoords-float-objectid-uint-indices-int.ply", 5, 3,
     NULL},
    {"magnum/positions-colors4-normals-texcoords-float-indices-int-be-unaligned.ply", 5, 3,
     NULL},
    {"magnum/positions-short-colors-uchar-texcoords-ushort-indices-char.ply", 5, 3, NULL},
    {"magnum/positions-ushort-normals-short-objectid-uchar-indices-uchar-be.ply", 5, 3, NULL},
    {"magnum/whitespace.ply", 5, 3, NULL},
    {"ply-rs/all_atomic_types_ok_ascii.ply", 0, 0, "there is no element \"vertex\""},
    {"ply-rs/empty_ok_ascii.ply", 0, 0, "there are no vertices"},
    {"ply-rs/exponent_values_ok_ascii.ply", 0, 0, "there is no element \"vertex\""},
    {"ply-rs/greg_turk_example2_ok_ascii.ply", 8, 12, NULL},
    {"ply-rs/house_2_ok_little_endian.ply", 5, 3, NULL},
    {"ply-rs/leading_spaces_ok_ascii.ply", 0, 0, "there is no element \"vertex\""},
    {"rply/input.ply", 3, 1, NULL},
    {"stanford/bun_zipper.ply", 35947, 69451, NULL},
    {"stanford/bun_zipper_res3_smooth.ply", 1889, 3851, NULL},
    {"tinyply/icosahedron.ply", 12, 20, NULL},
    {"tinyply/icosahedron_ascii.ply", 12, 20, NULL},
    {"tinyply/sofa.ply", 12103, 24104, NULL},
    {"trimesh/cube_blender_uv_meshlab.ply", 24, 12, NULL},
    {"trimesh/fuze.ply", 502, 1000, NULL},
    {"trimesh/metadata.ply", 4, 2, NULL},
    {"trimesh/multi.ply", 4, 2, NULL},
    {"trimesh/plane.ply", 4, 2, NULL},
    {"trimesh/points_ascii.ply", 0, 0,
     "there are 5 points but no faces: nothing that could be rendered"},
    {"trimesh/reference.ply", 845, 1610, NULL},
    {"trimesh/sphere.ply", 642, 1280, NULL},
    {"trimesh/suzanne.ply", 1966, 968, NULL},
    {"trimesh/tet.ply", 4, 4, NULL},
};
enum { FILE_COUNT = sizeof files / sizeof files[0] };

/* All files by other programs load with the right counts, but for triangles without area; those
 * without faces say so. */
static void files_by_others(void **state) {
    (void)state;
    assert_int_equal(count_files("ply"), FILE_COUNT);
    for (int i = 0; i < FILE_COUNT; i++) {
        reading r;
        read_data(&r, "ply", files[i].name);
        if (files[i].refusal) {
            assert_int_equal(r.status, ZT_EDESCRIPTION);
            assert_string_equal(r.text, files[i].refusal);
        } else if (mesh_of(&r)->vertex_count != files[i].vertices ||
                   r.mesh.triangle_count != files[i].triangles)
            fail_msg("%s: %d vertices, %d triangles", files[i].name, r.mesh.vertex_count,
                     r.mesh.triangle_count);
        forget(&r);
    }
}

/* The same mesh in several formats is the same mesh. */
static void same_meshes(void **state) {
    (void)state;
    static const char *const pairs[][2] = {
        {"happly/platonic_shelf.ply", "happly/platonic_shelf_ascii.ply"},
        {"tinyply/icosahedron.ply", "tinyply/icosahedron_ascii.ply"},
        {"jply/simple-bigendian.ply", "jply/simple-littleendian.ply"},
        {"magnum/whitespace.ply", "magnum/custom-components.ply"},
        {"magnum/whitespace.ply", "magnum/custom-components-be.ply"},
        {"magnum/whitespace.ply", "magnum/per-face-colors-be.ply"},
        {"magnum/whitespace.ply",
         "magnum/positions-char-colors4-ushort-texcoords-uchar-indices-short-be.ply"},
        {"magnum/whitespace.ply",
         "magnum/positions-colors-normals-texcoords-float-objectid-uint-indices-int.ply"},
        {"magnum/whitespace.ply",
         "magnum/positions-colors4-normals-texcoords-float-indices-int-be-unaligned.ply"},
        {"magnum/whitespace.ply",
         "magnum/positions-short-colors-uchar-texcoords-ushort-indices-char.ply"},
        {"magnum/whitespace.ply",
         "magnum/positions-ushort-normals-short-objectid-uchar-indices-uchar-be.ply"}};
    count_files("ply");
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        reading a, b;
        read_data(&a, "ply", pairs[i][0]);
        read_data(&b, "ply", pairs[i][1]);
        const zt_mesh *m = mesh_of(&a), *n = mesh_of(&b);
        assert_int_equal(m->vertex_count, n->vertex_count);
        assert_int_equal(m->triangle_count, n->triangle_count);
        assert_memory_equal(m->triangles, n->triangles, 12 * (size_t)m->triangle_count);
        for (int k = 0; k < 3 * m->vertex_count; k++)
            assert_true(fabsf(m->positions[k] - n->positions[k]) < 1e-5f);
        forget(&a);
        forget(&b);
    }
}

/* The Stanford bunny has the bounds that are known of it, to the last digit. */
static void the_bunny(void **state) {
    (void)state;
    count_files("ply");
    reading r;
    read_data(&r, "ply", "stanford/bun_zipper.ply");
    const zt_mesh *m = mesh_of(&r);
    assert_true((float)m->low.x == -0.0946899f && (float)m->high.x == 0.0610091f);
    assert_true((float)m->low.y == 0.0329874f && (float)m->high.y == 0.187321f);
    assert_true((float)m->low.z == -0.0618736f && (float)m->high.z == 0.0587997f);
    forget(&r);
}

static const struct {
    const char *name;
    int line;
    const char *refusal;
} hostile_files[] = {
    {"empty.ply", 4, "there are no vertices"},
    {"magnum/colors-not-all.ply", 3, "there are no vertices"},
    {"magnum/colors-not-tightly-packed.ply", 3, "there are no vertices"},
    {"magnum/colors4-not-same-type.ply", 3, "there are no vertices"},
    {"magnum/extra-token-face-element.ply", 7,
     "\"extradata\" is too much: the line should read \"element NAME COUNT\""},
    {"magnum/extra-token-face-property.ply", 8,
     "\"extradata\" is too much: the line should read \"property TYPE NAME\""},
    {"magnum/extra-token-vertex-element.ply", 3,
     "\"extradata\" is too much: the line should read \"element NAME COUNT\""},
    {"magnum/format-missing.ply", 0, "the header does not end: there is no \"end_header\""},
    {"magnum/format-unsupported.ply", 2,
     "\"binary_mixed_endian\" is none of ascii, binary_little_endian and binary_big_endian"},
    {"magnum/integer-literal-at-file-end.ply", 0,
     "the header does not end: there is no \"end_header\""},
    {"magnum/integer-literal-too-large.ply", 4,
     "\"4294967295\" is no whole number from 0 to 2147483647"},
    {"magnum/invalid-face-property.ply", 4,
     "\"extradata\" is too much: the line should read \"property TYPE NAME\""},
    {"magnum/invalid-face-type.ply", 4, "unknown type \"float16\"; did you mean \"float\"?"},
    {"magnum/invalid-vertex-property.ply", 4,
     "\"extradata\" is too much: the line should read \"property TYPE NAME\""},
    {"magnum/normals-not-all.ply", 3, "there are no vertices"},
    {"magnum/normals-not-tightly-packed.ply", 3, "there are no vertices"},
    {"magnum/objectid-unsupported-type.ply", 3, "there are no vertices"},
    {"magnum/positions-not-all.ply", 3, "vertices have no property \"y\""},
    {"magnum/positions-not-tightly-packed.ply", 3, "there are no vertices"},
    {"magnum/texcoords-not-all.ply", 3, "there are no vertices"},
    {"magnum/texcoords-not-tightly-packed.ply", 3, "there are no vertices"},
    {"magnum/unexpected-property.ply", 3, "\"property\" stands before any element"},
    {"magnum/unknown-line.ply", 0, "the header does not end: there is no \"end_header\""},
    {"ply_empty_header.ply", 0, "there is no element \"vertex\""},
    {"single_elements_err_ascii.ply", 0, "there is no element \"vertex\""},
};
enum { HOSTILE_COUNT = sizeof hostile_files / sizeof hostile_files[0] };

/* The memory that may still be asked for, in all. Sanitizers need terabytes of addresses, so
 * that under them there is no limit. */
static void limit_memory(struct rlimit *before, rlim_t bytes) {
    getrlimit(RLIMIT_AS, before);
#ifndef __SANITIZE_ADDRESS__
    FILE *f = fopen("/proc/self/statm", "r");
    char line[128];
    assert_true(f && fgets(line, sizeof line, f));
    fclose(f);
    long pages = strtol(line, NULL, 10); /* of addresses in use: the first number */
    struct rlimit limit = {(rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE) + bytes,
                           before->rlim_max};
    assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
#else
    (void)bytes;
#endif
}

/* Each hostile file is refused with one message, within a second and 8 MB. */
static void hostile(void **state) {
    (void)state;
    assert_int_equal(count_files("hostile/ply"), HOSTILE_COUNT);
    for (int i = 0; i < HOSTILE_COUNT; i++) {
        reading r;
        struct rlimit before;
        limit_memory(&before, 8 << 20);
        double begin_s = computed_s();
        read_data(&r, "hostile/ply", hostile_files[i].name);
        setrlimit(RLIMIT_AS, &before);
        if (r.status != ZT_EDESCRIPTION || r.error_count != 1 ||
            r.line != hostile_files[i].line || strcmp(r.text, hostile_files[i].refusal) != 0)
            fail_msg("%s: %s, line %d: %s", hostile_files[i].name, zt_status_text(r.status),
                     r.line, r.text);
        assert_within(begin_s, 100);
        forget(&r);
    }
}

/* Files that promise more than they hold, where each promise alone would take gigabytes, are
 * refused within a second and 8 MB as well. */
static void great_promises(void **state) {
    (void)state;
    static const char *const bodies[] = {
        VERTICES(2147483647) FACES(1) "end_header\n",
        VERTICES(1) FACES(2147483647) "end_header\n",
        VERTICES(1) "element face 1\nproperty list uint uint vertex_indices\nend_header\n"
                    "\1\1\1\1\2\2\2\2\3\3\3\3\x7F\x7F\x7F\x7F\1\1\1\1\2\2\2\2",
        "element junk 2147483647\nelement more 2147483647\n" VERTICES(2147483647)
            FACES(1) "end_header\n",
        "element junk 1\nproperty list uint double a\n" VERTICES(1)
            FACES(1) "end_header\n\xFE\xFF\xFF\xFE and no four thousand million numbers, that "
                     "is certain",
    };
    for (int format = 0; format < 3; format++)
        for (size_t i = 0; i < sizeof bodies / sizeof bodies[0]; i++) {
            begin(format);
            put_text("%s", bodies[i]);
            reading r;
            struct rlimit before;
            limit_memory(&before, 8 << 20);
            double begin_s = computed_s();
            read_file(&r);
            setrlimit(RLIMIT_AS, &before);
            assert_int_equal(r.status, ZT_EDESCRIPTION);
            assert_int_equal(r.error_count, 1);
            assert_within(begin_s, 100);
            forget(&r);
        }
}

static int compare_edges(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Every edge of the knot has one triangle on either side, which run along it in opposite
 * directions: the surface is closed, has no border and no seam, and one side is outside. */
static void the_knot_is_closed(void **state) {
    (void)state;
    reading r;
    read_path(&r, ZT_TEST_SOURCE_DIR "/animations/models/knot.ply", NULL);
    const zt_mesh *m = mesh_of(&r);
    assert_in_range(m->triangle_count, 65000, 75000);
    size_t edge_count = 3 * (size_t)m->triangle_count;
    uint64_t *edges = calloc(edge_count, sizeof *edges);
    assert_non_null(edges);
    for (size_t i = 0; i < edge_count; i++) {
        uint64_t a = m->triangles[i], b = m->triangles[i - i % 3 + (i + 1) % 3];
        edges[i] = a << 32 | b;
    }
    qsort(edges, edge_count, sizeof *edges, compare_edges);
    for (size_t i = 0; i < edge_count; i++) {
        assert_true(i == 0 || edges[i] != edges[i - 1]);
        uint64_t reverse = edges[i] << 32 | edges[i] >> 32;
        assert_non_null(bsearch(&reverse, edges, edge_count, sizeof *edges, compare_edges));
    }
    free(edges);
    /* A tube that closes is a torus: V - E + F = 0. */
    assert_int_equal(m->vertex_count, m->triangle_count / 2);
    forget(&r);
}

/* The knot's outside is outside, and its volume that of a tube of the same length: the cross
 * section's area by the length of its centre's path (Pappus). Two units wide, around the
 * origin. */
static void the_knot_is_a_tube(void **state) {
    (void)state;
    reading r;
    read_path(&r, ZT_TEST_SOURCE_DIR "/animations/models/knot.ply", NULL);
    const zt_mesh *m = mesh_of(&r);
    double volume = 0;
    for (int32_t i = 0; i < m->triangle_count; i++)
        volume += vec3_dot(zt_mesh_corner(m, i, 0),
                           vec3_cross(zt_mesh_corner(m, i, 1), zt_mesh_corner(m, i, 2))) /
                  6;
    const double pi = 3.14159265358979323846, scale = 1 / 3.5, radius = 0.5 * scale;
    double length = 0;
    for (int i = 0; i < 1000;
         i++) { /* |derivative| of the curve; exact to rounding, as it is periodic */
        double c = cos(3 * 2 * pi * i / 1000);
        length += scale * sqrt(17 + 8 * c + 9 * c * c) * 2 * pi / 1000;
    }
    assert_true(fabs(volume / (pi * radius * radius * length) - 1) < 0.01);
    double reach = 0;
    for (int32_t i = 0; i < m->vertex_count; i++)
        reach =
            fmax(reach, hypot((double)m->positions[3 * i], (double)m->positions[3 * i + 1]));
    assert_true(fabs(reach - 1) < 1e-4);
    assert_true(fabs(m->low.z + m->high.z) < 1e-4 && fabs(m->low.x + m->high.x) < 1e-4);
    forget(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(files_by_others),    cmocka_unit_test(same_meshes),
        cmocka_unit_test(the_bunny),          cmocka_unit_test(hostile),
        cmocka_unit_test(great_promises),     cmocka_unit_test(the_knot_is_closed),
        cmocka_unit_test(the_knot_is_a_tube),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
