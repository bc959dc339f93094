/* Shows that normals and colors of vertices come out of PLY files as these mean them, and that
 * normals which are not there follow from the angles of the triangles. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "description/normals.h"
#include "ply_reading.h"

static const char *const type_names[] = {"char", "uchar", "short", "ushort",
                                         "int",  "uint",  "float", "double"};

static void assert_near(const float *found, const double *expected, double tolerance,
                        const char *what) {
    for (int i = 0; i < 3; i++)
        if (!(fabs((double)found[i] - expected[i]) <= tolerance))
            fail_msg("%s: (%.9g %.9g %.9g), not (%.9g %.9g %.9g)", what, (double)found[0],
                     (double)found[1], (double)found[2], expected[0], expected[1], expected[2]);
}

/* sRGB to light: IEC 61966-2-1. */
static double light_of(double display) {
    return display <= 0.04045 ? display / 12.92 : pow((display + 0.055) / 1.055, 2.4);
}

/* ---- from files -----------------------------------------------------------------------------
 */

/* Normals of each type in each format, between other properties; their length is 1 then. */
static void normals_of_every_type(void **state) {
    (void)state;
    const double given[3][3] = {{3, 4, 0}, {0, 100, 0}, {2, 6, 9}};
    const double expected[3][3] = {{0.6, 0.8, 0}, {0, 1, 0}, {2 / 11., 6 / 11., 9 / 11.}};
    for (int format = 0; format < 3; format++)
        for (int type = 0; type < 8; type++) {
            const char *name = type_names[type];
            begin(format);
            put_text("element vertex 3\nproperty %s nz\nproperty float x\nproperty %s ny\n"
                     "property uchar gap\nproperty float y\nproperty %s nx\nproperty float z\n",
                     name, name, name);
            put_text(FACES(1) "end_header\n");
            for (int i = 0; i < 3; i++) {
                put(type, given[i][2]), put(6, i), put(type, given[i][1]), put(1, 77);
                put(6, i * i), put(type, given[i][0]), put(6, 0);
            }
            put(1, 3), put(4, 0), put(4, 1), put(4, 2);
            reading r;
            read_file(&r);
            const zt_mesh *m = mesh_of(&r);
            assert_non_null(m->normals);
            assert_null(m->colors);
            for (int i = 0; i < 3; i++)
                assert_near(m->normals + 3 * i, expected[i], 1e-7, name);
            forget(&r);
        }
}

/* Far too long, or far too short for a float's square, they still point somewhere. */
static void normals_of_any_length(void **state) {
    (void)state;
    static const char text[] =
        ASCII_HEADER "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                     "property double nx\nproperty double ny\nproperty double nz\n" FACES(
                         1) "end_header\n0 0 0 3e300 0 -4e300\n1 0 0 -3e-310 0 4e-310\n"
                            "0 1 0 0 1e-45 0\n3 0 1 2";
    const double expected[3][3] = {{0.6, 0, -0.8}, {-0.6, 0, 0.8}, {0, 1, 0}};
    reading r;
    read_text(&r, text);
    for (int i = 0; i < 3; i++)
        assert_near(mesh_of(&r)->normals + 3 * i, expected[i], 1e-7, "length");
    forget(&r);
}

/* What is zero or no number is worked out; the others stay as they are, wrong as they may be.
 */
static void bad_normals(void **state) {
    (void)state;
    static const char *const bad[] = {"0 0 0",           "nan 0 1",       "0 -nan 1",
                                      "1 inf 0",         "0 0 -Infinity", "0 0 NaN(7)",
                                      "-nan(ind) 0 1.5", "0 1e999 0"};
    const double up[3] = {0, 0, 1}, aside[3] = {1, 0, 0};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        file.format = ASCII;
        file.size = 0;
        put_text(
            ASCII_HEADER VERTICES(3) "property float nx\nproperty float ny\nproperty float "
                                     "nz\n" FACES(1) "end_header\n0 0 0 %s\n1 0 0 5 0 0\n"
                                                     "0 1 0 %s\n3 0 1 2",
            bad[i], bad[i]);
        reading r;
        read_file(&r);
        assert_near(mesh_of(&r)->normals, up, 0, bad[i]);
        assert_near(r.mesh.normals + 3, aside, 0, bad[i]);
        assert_near(r.mesh.normals + 6, up, 0, bad[i]);
        forget(&r);
    }
    reading turned; /* the others stand on the other side than the triangle winds */
    read_text(&turned, ASCII_HEADER VERTICES(
                           3) "property float nx\nproperty float ny\nproperty "
                              "float nz\n" FACES(1) "end_header\n0 0 0 0 0 -1\n1 0 0 0 0 0\n"
                                                    "0 1 0 0 0 -1\n3 0 1 2");
    for (int v = 0; v < 3; v++)
        assert_near(mesh_of(&turned)->normals + 3 * v, (double[3]){0, 0, -1}, 0, "turned");
    forget(&turned);
    const double numbers[] = {NAN, INFINITY, -INFINITY};
    for (int format = LITTLE; format <= BIG; format++)
        for (int i = 0; i < 3; i++) {
            begin(format);
            put_text("element vertex 3\nproperty char x\nproperty char y\nproperty char z\n"
                     "property float nx\nproperty double ny\nproperty char nz\n" FACES(
                         1) "end_header\n");
            for (int v = 0; v < 3; v++) {
                put(0, v == 1), put(0, v == 2), put(0, 0);
                put(6, numbers[i]), put(7, v), put(0, 1);
            }
            put(1, 3), put(4, 0), put(4, 1), put(4, 2);
            reading r;
            read_file(&r);
            for (int v = 0; v < 3; v++)
                assert_near(mesh_of(&r)->normals + 3 * v, up, 0, "binary");
            forget(&r);
        }
}

/* Colors as displays show them, or as light; what is below 0 is 0, what is above 1 stays. */
static void colors_of_every_type(void **state) {
    (void)state;
    const struct {
        int type;
        double given[3][3], most;
    } cases[] = {{1, {{0, 255, 128}, {1, 2, 10}, {11, 254, 77}}, 255},
                 {3, {{0, 65535, 32768}, {1, 2652, 2651}, {65534, 256, 9}}, 65535},
                 {6, {{0, 1, 0.5}, {-0.25, 7.5, 0.125}, {1, 1, 1024}}, 0},
                 {7, {{0, 1, 0.5}, {-0.25, 7.5, 0.125}, {1, 1, 1024}}, 0}};
    for (int format = 0; format < 3; format++)
        for (int k = 0; k < 4; k++) {
            const char *name = type_names[cases[k].type];
            begin(format);
            put_text("element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                     "property uchar alpha\nproperty %s blue\nproperty %s green\nproperty %s "
                     "red\n" FACES(1) "property uchar red\nend_header\n",
                     name, name, name);
            for (int i = 0; i < 3; i++) {
                put(6, i == 0), put(6, i == 1), put(6, 0), put(1, 3);
                for (int c = 2; c >= 0; c--) put(cases[k].type, cases[k].given[i][c]);
            }
            put(1, 3), put(4, 0), put(4, 1), put(4, 2), put(1, 9);
            reading r;
            read_file(&r);
            const zt_mesh *m = mesh_of(&r);
            assert_non_null(m->colors);
            assert_null(m->normals);
            for (int i = 0; i < 3; i++) {
                double expected[3];
                for (int c = 0; c < 3; c++) {
                    double number = cases[k].given[i][c], most = cases[k].most;
                    expected[c] = most > 0 ? light_of(number / most) : fmax(number, 0);
                }
                assert_near(m->colors + 3 * i, expected, 1e-7, name);
            }
            forget(&r);
        }
}

/* Text may say more than its type holds. */
static void colors_beyond_their_type(void **state) {
    (void)state;
    reading r;
    read_text(
        &r,
        ASCII_HEADER
            VERTICES(3) "property uchar red\nproperty uchar green\nproperty uchar blue\n" FACES(
                1) "end_header\n0 0 0 300 -4 1e9\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2");
    const double expected[3] = {1, 0, 1};
    assert_near(mesh_of(&r)->colors, expected, 0, "text");
    forget(&r);
}

/* Two thirds of a normal or a color are none, nor are numbers of which nobody knows what color
 * they mean; the mesh is as good without. */
static void parts_of_them(void **state) {
    (void)state;
    static const char *const headers[] = {
        "property float nx\nproperty float ny\nproperty float n\n",
        "property float ny\nproperty float nz\nproperty float w\n",
        "property uchar red\nproperty uchar green\nproperty uchar alpha\n",
        "property int red\nproperty int green\nproperty int blue\n",
        "property uchar red\nproperty char green\nproperty uchar blue\n"};
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        file.format = ASCII;
        file.size = 0;
        put_text(ASCII_HEADER VERTICES(3) "%s" FACES(
                     1) "end_header\n0 0 0 1 x 3\n1 0 0 4 5 6\n0 1 0 7 8 nan\n3 0 1 2",
                 headers[i]);
        reading r;
        read_file(&r);
        assert_null(mesh_of(&r)->normals);
        assert_null(r.mesh.colors);
        forget(&r);
    }
}

/* What nobody asks for is not judged, and takes no memory. */
static void not_asked_for(void **state) {
    (void)state;
    FILE *out = fopen("vertices.ply", "wb");
    assert_non_null(out);
    fputs(
        ASCII_HEADER VERTICES(
            3) "property float nx\nproperty float ny\nproperty float nz\nproperty float red\n"
               "property float green\nproperty float blue\n" FACES(
                   1) "end_header\n0 0 0 0 0 1 x y z\n1 0 0 0 0 1 1 2 3\n0 1 0 0 0 1 1 2 nan\n"
                      "3 0 1 2",
        out);
    assert_int_equal(fclose(out), 0);
    for (unsigned parts = 0; parts < 4; parts++) {
        zt_arena arena = {0};
        zt_mesh mesh;
        zt_status status =
            zt_ply_read(&mesh, &arena, "vertices.ply", parts, NULL, (zt_listener){0});
        assert_int_equal(status, parts & ZT_PLY_COLORS ? ZT_EDESCRIPTION : ZT_OK);
        if (status == ZT_OK) {
            assert_true(!mesh.normals == !(parts & ZT_PLY_NORMALS));
            assert_null(mesh.colors);
            assert_int_equal(mesh.vertex_count, 3);
        }
        zt_arena_free(&arena);
    }
    remove("vertices.ply");
}

/* Colors that are no numbers are told, with their place. */
static void mistakes(void **state) {
    (void)state;
    reading r;
    read_text(
        &r,
        ASCII_HEADER
            VERTICES(2) "property float red\nproperty float green\nproperty float blue\n" FACES(
                1) "end_header\n0 0 0 1 1 1\n1 0 0 1 1e31 1\n3 0 1 1");
    assert_int_equal(r.status, ZT_EDESCRIPTION);
    assert_string_equal(r.text, "vertex 1: green is 1e+31, but must be at most 1e+30");
    assert_int_equal(r.line, 14);
    assert_int_equal(r.column, 9);
    forget(&r);
    read_text(&r, ASCII_HEADER VERTICES(1) "property float nx\nproperty float nx\n");
    assert_int_equal(r.status, ZT_EDESCRIPTION);
    assert_string_equal(r.text, "\"nx\" stands here for the second time");
    forget(&r);
    read_text(&r,
              ASCII_HEADER
                  VERTICES(1) "property float nx\nproperty float ny\nproperty float nz\n" FACES(
                      1) "end_header\n0 0 0 1 up 1\n3 0 0 0");
    assert_int_equal(r.status, ZT_EDESCRIPTION);
    assert_string_equal(r.text, "vertex 0: \"up\" is no finite number");
    forget(&r);
    begin(LITTLE);
    put_text("element vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
             "property float red\nproperty float green\nproperty float blue\n" FACES(
                 1) "end_header\n");
    for (int i = 0; i < 6; i++) put(6, i == 5 ? NAN : 0);
    put(1, 3), put(4, 0), put(4, 0), put(4, 0);
    read_file(&r);
    assert_int_equal(r.status, ZT_EDESCRIPTION);
    assert_string_equal(r.text, "vertex 0: blue is nan, but must be at most 1e+30");
    forget(&r);
}

/* As a small program of another language has read them (the vertex in the middle of each). */
static const struct {
    const char *name;
    int vertex;
    double normal[3], color[3], most; /* all zero: none */
} files[] = {
    {"draco/cube_att.ply", 12, {1, 0, 0}, {0}, 0},
    {"tinyply/icosahedron.ply",
     6,
     {-3.0107991695404053, -2.187471389770508, 1.8607769012451172},
     {0},
     0},
    {"tinyply/icosahedron_ascii.ply", 6, {-3.0108, -2.18747, 1.86078}, {0}, 0},
    {"magnum/positions-colors-normals-texcoords-float-objectid-uint-indices-int.ply",
     2,
     {-0.6, -0.8, -0.2},
     {0, 0.0666666701, 0.9333333373},
     0},
    {"magnum/positions-colors4-normals-texcoords-float-indices-int-be-unaligned.ply",
     2,
     {-0.6, -0.8, -0.2},
     {0, 0.0666666701, 0.9333333373},
     0},
    {"magnum/positions-ushort-normals-short-objectid-uchar-indices-uchar-be.ply",
     2,
     {-19660, -26213, -6553},
     {0},
     0},
    {"magnum/positions-char-colors4-ushort-texcoords-uchar-indices-short-be.ply",
     2,
     {0},
     {0, 4369, 61166},
     65535},
    {"magnum/positions-short-colors-uchar-texcoords-ushort-indices-char.ply",
     2,
     {0},
     {0, 17, 238},
     255},
    {"assimp/Wuson.ply", 5592, {-0.498584, -0.807441, 0.315361}, {0}, 0},
    {"assimp/float-color.ply", 1, {0}, {0, 0, 1}, 0},
    {"trimesh/plane.ply", 2, {0, 0, 1}, {0}, 0},
    {"trimesh/suzanne.ply", 983, {-0.244586, 0.867516, -0.433121}, {0}, 0},
    {"trimesh/reference.ply", 422, {0}, {192, 192, 192}, 255},
    {"trimesh/multi.ply", 2, {0}, {0, 0, 255}, 255},
    {"trimesh/fuze.ply", 251, {0}, {192, 192, 192}, 255},
    {"stanford/bun_zipper_res3_smooth.ply", 944, {3.42317, -1.230175, 5.088418}, {0}, 0},
    {"draco/test_more_datatypes.ply", 1, {0}, {77, 0, 205}, 255},
    {"draco/test_pos_color.ply", 57, {0}, {235, 0, 106}, 255},
    {"tinyply/sofa.ply", 6051, {0}, {192, 192, 192}, 255},
    {"ply-rs/greg_turk_example2_ok_ascii.ply", 4, {0}, {0, 0, 255}, 255},
    {"geometry-central/spot.ply", 0, {0}, {0}, 0},
    {"magnum/per-face-colors-be.ply", 0, {0}, {0}, 0},
};

static void files_by_others(void **state) {
    (void)state;
    if (access(ZT_TEST_DATA_DIR "/ply", R_OK) != 0) skip();
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const double *n = files[i].normal, *c = files[i].color;
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        char path[512];
        snprintf(path, sizeof path, "%s/ply/%s", ZT_TEST_DATA_DIR, files[i].name);
        reading r;
        read_path(&r, path, NULL);
        const zt_mesh *m = mesh_of(&r);
        assert_true(!m->normals == !(length > 0));
        assert_true(!m->colors == !(c[0] + c[1] + c[2] > 0));
        double normal[3], color[3];
        for (int k = 0; k < 3; k++) {
            normal[k] = n[k] / length;
            color[k] = files[i].most > 0 ? light_of(c[k] / files[i].most) : c[k];
        }
        if (m->normals)
            assert_near(m->normals + 3 * files[i].vertex, normal, 1e-6, files[i].name);
        if (m->colors) assert_near(m->colors + 3 * files[i].vertex, color, 1e-7, files[i].name);
        for (int v = 0; m->normals && v < m->vertex_count; v++) {
            const float *a = m->normals + 3 * (ptrdiff_t)v;
            assert_true(fabsf(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] - 1) < 1e-6f);
        }
        forget(&r);
    }
}

/* ---- by angles ------------------------------------------------------------------------------
 */

/* Makes the normals of a mesh that is given as text behind the header. */
static const float *make_normals(reading *r, const char *vertices, int vertex_count,
                                 const char *faces, int face_count) {
    file.format = ASCII;
    file.size = 0;
    put_text(ASCII_HEADER
             "element vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
             "element face %d\nproperty list uchar int vertex_indices\nend_header\n%s\n%s",
             vertex_count, face_count, vertices, faces);
    read_file(r);
    assert_null(mesh_of(r)->normals);
    assert_int_equal(zt_normals_make(&r->mesh, &r->arena), ZT_OK);
    return r->mesh.normals;
}

#define CUBE "-1 -1 -1 1 -1 -1 -1 1 -1 1 1 -1 -1 -1 1 1 -1 1 -1 1 1 1 1 1"

/* At the corners of a cube they point along its diagonals, however its faces are cut: weighing
 * triangles alike, or by area, would favor the faces that are cut there. */
static void corners_of_a_cube(void **state) {
    (void)state;
    static const struct {
        const char *faces;
        int count;
    } cuts[] = {
        {"4 0 2 3 1 4 4 5 7 6 4 0 1 5 4 4 2 6 7 3 4 0 4 6 2 4 1 3 7 5", 6},
        {"4 2 3 1 0 4 5 7 6 4 4 0 1 5 4 4 6 7 3 2 4 0 4 6 2 4 3 7 5 1", 6},
        {"3 0 2 3 3 0 3 1 3 4 5 6 3 5 7 6 3 0 1 4 3 1 5 4 3 2 6 7 3 2 7 3 3 0 4 6 3 0 6 "
         "2 3 1 3 7 3 1 7 5",
         12}};
    for (int cut = 0; cut < 3; cut++) {
        reading r;
        const float *n = make_normals(&r, CUBE, 8, cuts[cut].faces, cuts[cut].count);
        for (int i = 0; i < 8; i++) {
            double third = sqrt(1. / 3);
            const double expected[3] = {i & 1 ? third : -third, i & 2 ? third : -third,
                                        i & 4 ? third : -third};
            assert_near(n + 3 * i, expected, 1e-7, "cube");
        }
        forget(&r);
    }
}

/* They are those of a sphere at the vertices of a body that is as regular, and near it on one
 * that is not. */
static void on_a_sphere(void **state) {
    (void)state;
    if (access(ZT_TEST_DATA_DIR "/ply", R_OK) != 0) skip();
    static const struct {
        const char *name;
        double tolerance;
    } spheres[] = {{"tinyply/icosahedron.ply", 1e-5}, {"trimesh/sphere.ply", 0.01}};
    for (int k = 0; k < 2; k++) {
        char path[512];
        snprintf(path, sizeof path, "%s/ply/%s", ZT_TEST_DATA_DIR, spheres[k].name);
        reading r;
        read_path(&r, path, NULL);
        zt_mesh mesh = *mesh_of(&r);
        assert_int_equal(zt_normals_make(&mesh, &r.arena), ZT_OK);
        for (int i = 0; i < mesh.vertex_count; i++) {
            const float *p = mesh.positions + 3 * (ptrdiff_t)i;
            vec3 out = vec3_normalize((vec3){(double)p[0], (double)p[1], (double)p[2]});
            assert_near(mesh.normals + 3 * (ptrdiff_t)i, (double[3]){out.x, out.y, out.z},
                        spheres[k].tolerance, spheres[k].name);
        }
        forget(&r);
    }
}

/* Slivers as thin as floats make them, and huge and tiny triangles, count by their angle. */
static void extremes(void **state) {
    (void)state;
    static const char *const scales[] = {"1e-18", "1", "1e17"};
    const double expected[3] = {0, sqrt(0.5), sqrt(0.5)};
    for (int i = 0; i < 3; i++) {
        char vertices[512];
        /* A right angle flat on the floor and one up a wall, which a sliver halves. */
        const char *s = scales[i];
        snprintf(vertices, sizeof vertices, "0 0 0  %s 0 0  0 0 %s  0 %s 0  -%s 0 0 1e-30 %s 0",
                 s, s, s, s, s);
        reading r;
        const float *n =
            make_normals(&r, vertices, 6, "3 0 2 1 3 0 4 2 3 0 1 5 3 0 5 3 3 0 3 4", 5);
        assert_near(n, expected, 1e-6, s);
        forget(&r);
    }
}

/* Where triangles cancel each other out one of them counts; where there is none with an area,
 * any unit vector does. */
static void nothing_to_go_by(void **state) {
    (void)state;
    reading r;
    const float *n = make_normals(&r, "0 0 0 1 0 0 0 1 0 5 5 5 6 6 6 9 9 9", 6,
                                  "3 0 1 2 3 0 2 1 3 3 3 4", 3);
    const double up[3] = {0, 0, 1};
    for (int i = 0; i < 3; i++) assert_near(n + 3 * i, up, 0, "cancelled");
    for (int i = 3; i < 6; i++)
        assert_true(fabsf(hypotf(hypotf(n[3 * i], n[3 * i + 1]), n[3 * i + 2]) - 1) < 1e-6f);
    forget(&r);
}

/* A mesh far from its origin has the normals that it has at home. */
static void far_away(void **state) {
    (void)state;
    reading r;
    read_text(
        &r, ASCII_HEADER
        "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n" FACES(
            3) "end_header\n500000000.25 0 0 500000001.25 0 0 500000000.25 1 0 500000000.25 "
               "0 1\n3 0 2 1 3 0 1 3 3 0 3 2");
    zt_mesh mesh = *mesh_of(&r);
    assert_int_equal(zt_normals_make(&mesh, &r.arena), ZT_OK);
    const double expected[3] = {-sqrt(1. / 3), -sqrt(1. / 3), -sqrt(1. / 3)};
    assert_near(mesh.normals, expected, 1e-7, "far");
    forget(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(normals_of_every_type),
        cmocka_unit_test(normals_of_any_length),
        cmocka_unit_test(bad_normals),
        cmocka_unit_test(colors_of_every_type),
        cmocka_unit_test(colors_beyond_their_type),
        cmocka_unit_test(parts_of_them),
        cmocka_unit_test(not_asked_for),
        cmocka_unit_test(mistakes),
        cmocka_unit_test(files_by_others),
        cmocka_unit_test(corners_of_a_cube),
        cmocka_unit_test(on_a_sphere),
        cmocka_unit_test(extremes),
        cmocka_unit_test(nothing_to_go_by),
        cmocka_unit_test(far_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
