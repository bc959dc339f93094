/* Shows that meshes come out of PLY files exactly as these say, whatever their format, types
 * and order, and that each mistake is told, at its place. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "ply_reading.h"

static void assert_positions(const zt_mesh *mesh, int count, const double *expected) {
    assert_int_equal(mesh->vertex_count, count);
    const double origin[3] = {mesh->origin.x, mesh->origin.y, mesh->origin.z};
    for (int i = 0; i < 3 * count; i++)
        if (origin[i % 3] + (double)mesh->positions[i] != expected[i])
            fail_msg("number %d is %.17g", i, origin[i % 3] + (double)mesh->positions[i]);
}

static void assert_triangles(const zt_mesh *mesh, int count, const uint32_t *expected) {
    assert_int_equal(mesh->triangle_count, count);
    assert_memory_equal(mesh->triangles, expected, 3 * (size_t)count * sizeof *expected);
}

/* The types as put() counts them. */
static const char *const type_names[] = {
    "char", "uchar", "short", "ushort", "int",   "uint",   "float",   "double",
    "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};

/* Each format, each type of positions, of list lengths and of indices, by both of its names. */
static void every_type(void **state) {
    (void)state;
    const double positions[12] = {0, 0, 0, 100, 7, 0, 3, 99, 2, 5, 6, 101};
    const uint32_t triangles[6] = {0, 1, 2, 3, 2, 1};
    for (int format = 0; format < 3; format++)
        for (int type = 0; type < 16; type++)
            for (int length = 0; length < 16; length += length % 8 == 5 ? 3 : 1)
                for (int index = 0; index < 16; index += index % 8 == 5 ? 3 : 1) {
                    begin(format);
                    put_text("element vertex 4\nproperty %s x\nproperty %s y\nproperty %s z\n"
                             "element face 2\nproperty list %s %s vertex_%s\nend_header\n",
                             type_names[type], type_names[type], type_names[type],
                             type_names[length], type_names[index],
                             index < 8 ? "indices" : "index");
                    for (int i = 0; i < 12; i++) put(type, positions[i]);
                    for (int i = 0; i < 6; i++) {
                        if (i % 3 == 0) put(length, 3);
                        put(index, triangles[i]);
                    }
                    reading r;
                    read_file(&r);
                    assert_positions(mesh_of(&r), 4, positions);
                    assert_triangles(&r.mesh, 2, triangles);
                    forget(&r);
                }
}

/* Negative numbers, fractions and large numbers keep their value in each type that has them. */
static void extreme_values(void **state) {
    (void)state;
    const double values[8][3] = {{-128, 127, -1},
                                 {255, 128, 0},
                                 {-32768, 32767, -1},
                                 {65535, 32768, 0},
                                 {-16777216, 16777216, -1},
                                 {16777216, 0, 1},
                                 {-1.5, 0x1.fffffep58, -0x1p-149},
                                 {-1.5, 0x1.fffffep58, 0x1p-126}};
    const uint32_t triangle[3] = {0, 0, 0};
    for (int format = 0; format < 3; format++)
        for (int type = 0; type < 8; type++) {
            begin(format);
            put_text("element vertex 1\nproperty %s z\nproperty %s y\nproperty %s x\n"
                     "element face 1\nproperty list uint8 int vertex_indices\nend_header\n",
                     type_names[type], type_names[type], type_names[type]);
            for (int i = 2; i >= 0; i--) put(type, values[type][i]);
            put(1, 3);
            for (int i = 0; i < 3; i++) put(4, 0);
            reading r;
            read_file(&r);
            assert_positions(mesh_of(&r), 1, values[type]);
            assert_triangles(&r.mesh, 1, triangle);
            forget(&r);
        }
}

/* Elements and properties that mean nothing to us, lists among them, stand before, between and
 * behind those that do; the faces come before the vertices. */
static void all_else_is_skipped(void **state) {
    (void)state;
    const double positions[12] = {0, 0, 0, 2, 0, 0, 2, 2, 0, 0.5, 1, 0};
    const uint32_t corners[4] = {0, 1, 2, 3}, triangles[6] = {0, 1, 2, 0, 2, 3};
    for (int format = 0; format < 3; format++) {
        begin(format);
        put_text(
            "element camera 2\nproperty double x\nproperty list uchar float vertex_indices\n"
            "element nothing 1000000\n"
            "element face 1\nproperty list int double weights\nproperty char material\n"
            "property list char uchar vertex_indices\nproperty list ushort short more\n"
            "element middle 1\nproperty list uint char name\n"
            "element vertex 4\nproperty uchar gap\nproperty double z\nproperty uchar gap\n"
            "property float x\nproperty list uchar uint neighbours\nproperty double y\n"
            "property short gap\nelement edge 1\nproperty int vertex1\nend_header\n");
        for (int i = 0; i < 2; i++) {
            put(7, 9.5);
            put(1, i);
            if (i == 1) put(6, 0.25);
        }
        put(4, 2), put(7, 1.5), put(7, -2.5), put(0, -7);
        put(0, 4);
        for (int i = 0; i < 4; i++) put(1, corners[i]);
        put(3, 1), put(2, -300);
        put(5, 3), put(0, 'a'), put(0, 'b'), put(0, 'c');
        for (int i = 0; i < 4; i++) {
            put(1, 200), put(7, positions[3 * i + 2]), put(1, 201), put(6, positions[3 * i]);
            put(1, i);
            for (int k = 0; k < i; k++) put(5, 4e9);
            put(7, positions[3 * i + 1]), put(2, -1);
        }
        put(4, -1);
        reading r;
        read_file(&r);
        assert_positions(mesh_of(&r), 4, positions);
        assert_triangles(&r.mesh, 2, triangles);
        forget(&r);
    }
}

/* Lines end as on any system, blanks are free, and so are comments, blank lines and what an old
 * exporter wrote below the format. */
static void lines_and_blanks(void **state) {
    (void)state;
    const char *const text =
        "ply\ncomment before\n\n \t format \t ascii  1.0\t\nMade by an exporter of old\n"
        " element vertex\t3 \nobj_info property float w\ncomment\n\tproperty float x\n"
        "property float32 y\nproperty\tfloat z\n\n" FACES(
            1) " \tend_header  \n"
               "\n \t0 0 0 1e0\n+2 -.5e+1 .25 3. 1.5\n3 0 1 2";
    const double positions[9] = {0, 0, 0, 1, 2, -5, 0.25, 3, 1.5};
    const char *const ends[] = {"\n", "\r\n", "\r"};
    for (int k = 0; k < 3; k++) {
        file.size = 0;
        for (const char *c = text; *c; c++)
            *c == '\n' ? put_text("%s", ends[k]) : put_text("%c", *c);
        reading r;
        read_file(&r);
        assert_positions(mesh_of(&r), 3, positions);
        assert_triangles(&r.mesh, 1, (const uint32_t[]){0, 1, 2});
        forget(&r);
    }
}

/* Binary data begin right behind the header's last line end, be they blanks to the eye. */
static void binary_behind_any_line_end(void **state) {
    (void)state;
    const char *const ends[] = {"\n", "\r\n", "\r"}, first_bytes[] = "\n\r \t";
    for (int k = 0; k < 3; k++)
        for (int first = 0; first < 4; first++) {
            const char *n = ends[k];
            file.format = LITTLE;
            file.size = 0;
            put_text(
                "ply%sformat binary_little_endian 1.0%selement vertex 1%sproperty uchar x%s"
                "property uchar y%sproperty uchar z%selement face 1%s"
                "property list uchar uchar vertex_indices%send_header%s",
                n, n, n, n, n, n, n, n, n);
            const double position[3] = {first_bytes[first], '\n', '\r'};
            for (int i = 0; i < 3; i++) put(1, position[i]);
            put(1, 3), put(1, 0), put(1, 0), put(1, 0);
            put_text("and more behind all that the header speaks of");
            reading r;
            read_file(&r);
            assert_positions(mesh_of(&r), 1, position);
            forget(&r);
        }
}

/* Binary data behind a header whose last line ends as no other does. */
static void binary_behind_another_line_end(void **state) {
    (void)state;
    begin(BIG);
    put_text("element vertex 1\nproperty char x\nproperty char y\nproperty char z\n"
             "element face 1\nproperty list uchar uchar vertex_index\nend_header\r\n");
    const double position[3] = {1, 2, 3};
    for (int i = 0; i < 3; i++) put(0, position[i]);
    put(1, 3), put(1, 0), put(1, 0), put(1, 0);
    reading r;
    read_file(&r);
    assert_positions(mesh_of(&r), 1, position);
    forget(&r);
}

/* Points and lines among the faces are left out, and triangles without area; a concave polygon
 * is cut where it has to be. */
static void faces_of_all_sizes(void **state) {
    (void)state;
    reading r;
    read_text(&r, ASCII_HEADER VERTICES(5)
                      FACES(7) "end_header\n0 0 0 2 0 0 2 2 0 0 2 0 1 .5 0\n"
                               "0\n1 4\n2 0 1\n3 2 1 0\n4 0 1 2 3\n3 1 1 1\n4 1 2 4 0");
    const uint32_t triangles[] = {2, 1, 0, 0, 1, 2, 0, 2, 3};
    assert_int_equal(mesh_of(&r)->triangle_count, 5);
    assert_memory_equal(r.mesh.triangles, triangles, sizeof triangles);
    /* The arrowhead 1 2 4 0 bends inward at 4: that is where it must be cut. */
    for (int t = 3; t < 5; t++) {
        const uint32_t *c = r.mesh.triangles + 3 * t;
        assert_true(c[0] == 4 || c[1] == 4 || c[2] == 4);
    }
    forget(&r);
}

/* Strips turn every second triangle around, and begin anew at -1. */
static void strips(void **state) {
    (void)state;
    reading r;
    read_text(
        &r,
        ASCII_HEADER VERTICES(
            6) "element tristrips 2\nproperty list int int vertex_indices\nend_header\n"
               "0 0 0 1 0 0 0 1 0 1 1 0 0 2 0 1 2 0\n 12 0 1 2 3 4 -1 5 4 -1 3 2 1\n 2 0 1");
    const uint32_t triangles[] = {0, 1, 2, 2, 1, 3, 2, 3, 4, 3, 2, 1};
    assert_triangles(mesh_of(&r), 4, triangles);
    forget(&r);
    read_text(&r,
              ASCII_HEADER VERTICES(
                  1) "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                     "0 0 0 4 0 0 -1 0");
    assert_string_equal(r.text, "no strip has three corners");
    forget(&r);
}

/* Numbers that are floats stay as they are; those that are not keep their distances from each
 * other, far from the origin too. */
static void origins(void **state) {
    (void)state;
    const struct {
        const char *type, *numbers;
        double origin[3], positions[9];
    } cases[] = {
        {"float",
         "0.1 0 0  16777217 0 0  0 1 0",
         {0, 0, 0},
         {(double)0.1f, 0, 0, 16777216, 0, 0, 0, 1, 0}},
        {"double",
         "0.5 0 0  16777216 0 0  0 1 0",
         {0, 0, 0},
         {0.5, 0, 0, 16777216, 0, 0, 0, 1, 0}},
        {"double",
         "5000000.125 10 7  5000002.125 10 7  5000001 11 8.5",
         {5000001.125, 10.5, 7.75},
         {5000000.125, 10, 7, 5000002.125, 10, 7, 5000001, 11, 8.5}},
        {"int",
         "2000000001 0 0  2000000003 0 0  2000000002 1 0",
         {2000000002, 0.5, 0},
         {2000000001, 0, 0, 2000000003, 0, 0, 2000000002, 1, 0}},
        {"uint",
         "4294967295 0 0  4294967293 0 0  4294967293 1 0",
         {4294967294, 0.5, 0},
         {4294967295, 0, 0, 4294967293, 0, 0, 4294967293, 1, 0}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        file.size = 0;
        put_text(ASCII_HEADER
                 "element vertex 3\nproperty %s x\nproperty %s y\nproperty %s z\n" FACES(
                     1) "end_header\n%s 3 0 1 2",
                 cases[k].type, cases[k].type, cases[k].type, cases[k].numbers);
        reading r;
        read_file(&r);
        assert_positions(mesh_of(&r), 3, cases[k].positions);
        assert_true(r.mesh.origin.x == cases[k].origin[0] &&
                    r.mesh.origin.y == cases[k].origin[1] &&
                    r.mesh.origin.z == cases[k].origin[2]);
        forget(&r);
    }
}

/* Bounds hold the vertices that triangles use, and no others. */
static void bounds(void **state) {
    (void)state;
    reading r;
    read_text(&r, ASCII_HEADER VERTICES(5) FACES(
                      1) "end_header\n-900 0 0\n1 2 3\n-4 5 9\n0 7 -6\n0 0 1e17\n3 1 2 3");
    const zt_mesh *m = mesh_of(&r);
    assert_int_equal(m->vertex_count, 5);
    assert_true(m->low.x == -4 && m->low.y == 2 && m->low.z == -6);
    assert_true(m->high.x == 1 && m->high.y == 7 && m->high.z == 9);
    forget(&r);
}

/* Triangles without area are left out in silence, however thin others are; those that lose it
 * by rounding are told; where there are no others they stay. */
static void without_area(void **state) {
    (void)state;
    const struct {
        const char *type, *numbers, *faces;
        int count, kept, warnings;
    } cases[] = {
        {"float", "0 0 0  1 1 1  3 3 3  3 3 3.000001", "3 0 1 2 3 0 1 3", 2, 1, 0},
        {"float", "0 0 0  1e18 0 0  1e18 1e-20 0  3e17 0 0", "3 0 1 2 3 0 1 3", 2, 1, 0},
        {"float", "0 0 0  1 1 1  3 3 3  3 3 3", "3 0 1 2 3 1 2 3", 2, 2, 0},
        {"double", "0 0 0  1 0 0  0 1 0  1e-12 1e-12 0", "3 0 1 2 3 0 1 3", 2, 1, 1},
        {"double", "-1 0 0  1 0 0  0 1 0  0.5 0 0", "3 0 1 2 3 1 3 1", 2, 1, 0},
        {"double", "-1 0 0  1 0 0  0 1 0  -1 0 1e-12", "3 0 1 2 3 0 1 3", 2, 2, 0},
        {"double", "-1 0 0  1 0 0  0 1 0  1 1e-12 0", "3 0 1 2 3 0 1 3", 2, 1, 1},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        file.size = 0;
        put_text(ASCII_HEADER
                 "element vertex 4\nproperty %s x\nproperty %s y\nproperty %s z\n"
                 "element face %d\nproperty list uchar int vertex_indices\nend_header\n%s %s",
                 cases[k].type, cases[k].type, cases[k].type, cases[k].count, cases[k].numbers,
                 cases[k].faces);
        reading r;
        read_file(&r);
        if (r.status != ZT_OK) fail_msg("case %d: %s", (int)k, r.text);
        if (r.mesh.triangle_count != cases[k].kept || r.warning_count != cases[k].warnings)
            fail_msg("case %d: %d triangles, %d warnings", (int)k, (int)r.mesh.triangle_count,
                     r.warning_count);
        if (r.warning_count)
            assert_string_equal(r.text, "triangles too fine for 24 binary digits around the "
                                        "model's middle: 1; they are left out");
        forget(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_type),
        cmocka_unit_test(extreme_values),
        cmocka_unit_test(all_else_is_skipped),
        cmocka_unit_test(lines_and_blanks),
        cmocka_unit_test(binary_behind_any_line_end),
        cmocka_unit_test(binary_behind_another_line_end),
        cmocka_unit_test(faces_of_all_sizes),
        cmocka_unit_test(strips),
        cmocka_unit_test(origins),
        cmocka_unit_test(bounds),
        cmocka_unit_test(without_area),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
