/* Shows that each mistake in a PLY file is told, at its place, and that no file, whatever was
 * done to it, does harm. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <time.h>

#include <cmocka.h>

#include "base/random.h"
#include "ply_reading.h"

/* Each mistake is told once, with its line and column where it has one. */
static void mistakes(void **state) {
    (void)state;
#define XYZ "property float x\nproperty float y\nproperty float z\n"
    static const struct {
        const char *text;
        int line, column;
        const char *message;
    } cases[] = {
        {"", 0, 0, "no PLY file: the first line is not \"ply\""},
        {"solid cube\n", 0, 0, "no PLY file: the first line is not \"ply\""},
        {"plywood\n" ASCII_HEADER, 0, 0, "no PLY file: the first line is not \"ply\""},
        {"ply", 0, 0, "the header does not end: there is no \"end_header\""},
        {ASCII_HEADER VERTICES(1) FACES(1), 0, 0,
         "the header does not end: there is no \"end_header\""},
        {"ply\nformat ascii 1.1\n", 2, 14, "\"1.1\" is no known version; there is only 1.0"},
        {"ply\nformat ascii\n", 2, 1,
         "\"format\" lacks something: the line should read \"format FORMAT 1.0\""},
        {"ply\nformat binary 1.0\n", 2, 8,
         "\"binary\" is none of ascii, binary_little_endian and binary_big_endian"},
        {ASCII_HEADER "format ascii 1.0\n", 3, 1, "\"format\" stands here for the second time"},
        {"ply\nelement vertex 1\n", 2, 1, "\"element\" stands before any \"format\" line"},
        {"ply\nfromat ascii 1.0\n", 2, 1, "\"fromat\" begins no line of a PLY header"},
        {ASCII_HEADER VERTICES(1) "elemnt face 1\n", 7, 1,
         "\"elemnt\" begins no line of a PLY header"},
        {ASCII_HEADER "property float x\n", 3, 1, "\"property\" stands before any element"},
        {ASCII_HEADER "element vertex many\n", 3, 16,
         "\"many\" is no whole number from 0 to 2147483647"},
        {ASCII_HEADER "element vertex 2147483648\n", 3, 16,
         "\"2147483648\" is no whole number from 0 to 2147483647"},
        {ASCII_HEADER "element vertex -1\n", 3, 16,
         "\"-1\" is no whole number from 0 to 2147483647"},
        {ASCII_HEADER "element vertex 1.5\n", 3, 16,
         "\"1.5\" is no whole number from 0 to 2147483647"},
        {ASCII_HEADER VERTICES(1) "element vertex 1\n", 7, 9,
         "\"vertex\" stands here for the second time"},
        {ASCII_HEADER VERTICES(1) "property double y\n", 7, 17,
         "\"y\" stands here for the second time"},
        {ASCII_HEADER FACES(1) "property list int int vertex_index\n", 5, 23,
         "\"vertex_index\" stands here for the second time"},
        {ASCII_HEADER "element vertex 1\nproperty flaot x\n", 4, 10,
         "unknown type \"flaot\"; did you mean \"float\"?"},
        {ASCII_HEADER "element vertex 1\nproperty list float int x\n", 4, 15,
         "\"float\" cannot count a list: that takes an integer type"},
        {ASCII_HEADER "element vertex 1\nproperty list int x\n", 4, 1,
         "\"property\" lacks something: the line should read "
         "\"property list COUNT_TYPE TYPE NAME\""},
        {ASCII_HEADER "element vertex 1\n\tproperty  float x y\n", 4, 20,
         "\"y\" is too much: the line should read \"property TYPE NAME\""},
        {ASCII_HEADER FACES(1) "end_header\n3 0 0 0", 0, 0, "there is no element \"vertex\""},
        {ASCII_HEADER "element vertex 1\nproperty int x\nproperty int z\n" FACES(
             1) "end_header\n0 0 3 0 0 0",
         3, 9, "vertices have no property \"y\""},
        {ASCII_HEADER "element vertex 1\n" XYZ "element face 1\nproperty list int float "
                      "vertex_indices\nend_header\n0 0 0 3 0 0 0",
         7, 9, "face has no list \"vertex_indices\" of integers"},
        {ASCII_HEADER "element vertex 0\n" XYZ FACES(0) "end_header\n", 3, 9,
         "there are no vertices"},
        {ASCII_HEADER VERTICES(2) "end_header\n0 0 0 1 1 1", 0, 0,
         "there are 2 points but no faces: nothing that could be rendered"},
        {ASCII_HEADER VERTICES(2) FACES(0) "end_header\n0 0 0 1 1 1", 0, 0,
         "there are 2 points but no faces: nothing that could be rendered"},
        {ASCII_HEADER VERTICES(4) FACES(1) SQUARE "2 0 1\n", 0, 0, "no face has three corners"},
        {ASCII_HEADER VERTICES(4) FACES(1) SQUARE "3 0 1 4\n", 14, 7,
         "face 0: there is no vertex 4; they are counted from 0 to 3"},
        {ASCII_HEADER VERTICES(4) FACES(1) SQUARE "3 0 -1 2\n", 14, 5,
         "face 0: there is no vertex -1; they are counted from 0 to 3"},
        {ASCII_HEADER VERTICES(4) FACES(1) SQUARE "3 0 1.5 2\n", 14, 5,
         "face 0: there is no vertex 1.5; they are counted from 0 to 3"},
        {ASCII_HEADER VERTICES(4) FACES(1) SQUARE "3 0 one 2\n", 14, 5,
         "face 0: \"one\" is no finite number"},
        {ASCII_HEADER VERTICES(4) FACES(2) SQUARE "3 0 1 2\n-3 0 1 2\n", 15, 1,
         "face 1: a list cannot have -3 items"},
        {ASCII_HEADER VERTICES(4) FACES(1) SQUARE "4000000000 0 1 2\n", 14, 1,
         "face 0: a list cannot have 4000000000 items"},
        {ASCII_HEADER VERTICES(4) FACES(1) SQUARE "4 0 1 2\n", 14, 1,
         "face 0: the file is too short for a list of 4 items"},
        {ASCII_HEADER VERTICES(4) FACES(2) SQUARE "3  0   1   2\n", 0, 0,
         "the file ends within face 1 of 2"},
        {ASCII_HEADER VERTICES(3) FACES(1) "end_header\n0 0 nan 1 1 1 2 2 2 3 0 1 2", 10, 5,
         "vertex 0: \"nan\" is no finite number"},
        {ASCII_HEADER VERTICES(3) FACES(1) "end_header\n0 0 0\n1 1e999 1\n2 2 2 3 0 1 2", 11, 3,
         "vertex 1: \"1e999\" is no finite number"},
        {ASCII_HEADER VERTICES(3) FACES(1) "end_header\n0 0 0\n1 1 -2e18\n2 2 2 3 0 1 2", 11, 5,
         "vertex 1: z is -2e+18, but must lie between -1e+18 and 1e+18"},
        {ASCII_HEADER VERTICES(3) FACES(1000000000) "end_header\n0 0 0 1 1 1 2 2 2 3 0 1 2", 7,
         9, "the file is too short for 1000000000 of these"},
        {ASCII_HEADER "element junk 2147483647\nproperty int a\n" VERTICES(3) FACES(1) SQUARE,
         3, 9, "the file is too short for 2147483647 of these"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        reading r;
        read_text(&r, cases[i].text);
        if (r.status != ZT_EDESCRIPTION || r.error_count != 1 || r.line != cases[i].line ||
            r.column != cases[i].column || strcmp(r.text, cases[i].message) != 0)
            fail_msg("%s\ntells: %d:%d: %s\nnot: %d:%d: %s", cases[i].text, r.line, r.column,
                     r.text, cases[i].line, cases[i].column, cases[i].message);
        assert_null(r.mesh.positions);
        forget(&r);
    }
}

/* Lines are counted as they end in the file, and letters, not bytes, make a column. */
static void places(void **state) {
    (void)state;
    reading r;
    read_text(&r, "ply\r\nformat ascii 1.0\r\ncomment\r\nelement \xC3\xA4\xC3\xB6 x\r\n");
    assert_int_equal(r.line, 4);
    assert_int_equal(r.column, 12);
    forget(&r);
    read_text(&r, "ply\rformat ascii 1.0\rcomment\relement e x\r");
    assert_int_equal(r.line, 4);
    assert_int_equal(r.column, 11);
    forget(&r);
}

/* What is wrong in binary data is told with its row. */
static void binary_mistakes(void **state) {
    (void)state;
    const double nowhere[] = {NAN, INFINITY, -INFINITY, 1e300};
    const char *const told[] = {"nan", "inf", "-inf", "1e+300"};
    for (int format = 1; format < 3; format++)
        for (int k = 0; k < 6; k++) {
            begin(format);
            put_text("element vertex 2\nproperty double x\nproperty double y\nproperty double "
                     "z\n" FACES(1) "end_header\n");
            for (int i = 0; i < 6; i++) put(7, k < 4 && i == 4 ? nowhere[k] : i);
            put(1, k == 4 ? 255 : 3);
            for (int i = 0; i < 3; i++) put(4, i);
            if (k == 5) put_text("the vertex 2 is one too far");
            reading r;
            read_file(&r);
            char text[128];
            snprintf(text, sizeof text,
                     "vertex 1: y is %s, but must lie between -1e+18 and 1e+18", told[k % 4]);
            assert_string_equal(
                r.text, k < 4 ? text
                        : k == 4
                            ? "face 0: the file is too short for a list of 255 items"
                            : "face 0: there is no vertex 2; they are counted from 0 to 1");
            assert_int_equal(r.status, ZT_EDESCRIPTION);
            assert_int_equal(r.line, 0);
            forget(&r);
        }
}

/* A file cut off anywhere is refused, but for the blank at the end of the text. */
static void cut_off_files(void **state) {
    (void)state;
    for (int format = 0; format < 3; format++) {
        begin(format);
        put_text(VERTICES(3)
                     FACES(1) "element edge 1\nproperty list ushort short a\nend_header\n");
        for (int i = 0; i < 9; i++) put(6, i * i % 5);
        put(1, 3), put(4, 0), put(4, 1), put(4, 2);
        put(3, 1), put(2, 7);
        size_t whole = file.size - (format == ASCII);
        for (file.size = 0; file.size < whole; file.size++) {
            reading r;
            read_file(&r);
            assert_int_equal(r.status, ZT_EDESCRIPTION);
            assert_int_equal(r.error_count, 1);
            forget(&r);
        }
        reading r;
        read_file(&r);
        mesh_of(&r);
        forget(&r);
    }
}

/* A file that cannot be read is told where it was asked for, one that makes no sense where it
 * is wrong, with a note of where it was asked for. A pipe is not waited for. */
static void files_and_places(void **state) {
    (void)state;
    const zt_place place = {
        .file = "film.yaml", .source_line = "mesh: x", .line = 7, .column = 3};
    reading r;
    read_path(&r, "no/such.ply", &place);
    assert_int_equal(r.status, ZT_EFILE);
    assert_int_equal(r.line, 7);
    assert_string_equal(r.text, "cannot read no/such.ply: No such file or directory");
    assert_int_equal(r.error_count, 1);
    assert_int_equal(r.note_count, 0);
    read_path(&r, "/", NULL);
    assert_int_equal(r.status, ZT_EFILE);
    assert_string_equal(r.text, "cannot read /: Is a directory");
    char path[] = "/tmp/zoetrope_ply_XXXXXX";
    assert_non_null(mkdtemp(path));
    char name[64];
    snprintf(name, sizeof name, "%s/pipe.ply", path);
    assert_int_equal(mkfifo(name, 0600), 0);
    read_path(&r, name, NULL);
    assert_int_equal(r.status, ZT_EFILE);
    unlink(name);
    FILE *f = fopen(name, "w");
    assert_non_null(f);
    fputs(ASCII_HEADER "element vertex x\n", f);
    fclose(f);
    read_path(&r, name, &place);
    assert_int_equal(r.status, ZT_EDESCRIPTION);
    assert_int_equal(r.line, 3);
    assert_int_equal(r.note_count, 1);
    assert_non_null(strstr(r.note, "film.yaml:7:3: note: "));
    unlink(name);
    rmdir(path);
}

/* What a mesh promises: every index names a vertex, every position is finite and within 1e18,
 * and the bounds are the vertices' in use. */
static void assert_sound(const zt_mesh *m) {
    assert_true(m->vertex_count > 0 && m->triangle_count > 0);
    for (int32_t i = 0; i < 3 * m->vertex_count; i++)
        assert_true(fabsf(m->positions[i]) <= 2.1e18f);
    vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    for (int32_t i = 0; i < m->triangle_count; i++)
        for (int k = 0; k < 3; k++) {
            assert_true(m->triangles[3 * i + k] < (uint32_t)m->vertex_count);
            low = vec3_min(low, zt_mesh_corner(m, i, k));
            high = vec3_max(high, zt_mesh_corner(m, i, k));
        }
    assert_true(low.x == m->low.x && low.y == m->low.y && low.z == m->low.z);
    assert_true(high.x == m->high.x && high.y == m->high.y && high.z == m->high.z);
}

/* A small file with all that can be in one, of one of the three formats. */
static void put_everything(int format) {
    begin(format);
    put_text("comment a small file\nelement vertex 6\nproperty double x\nproperty float y\n"
             "property list uchar char tags\nproperty short z\nelement extra 2\n"
             "property list int double a\nproperty uint b\nelement face 3\n"
             "property uchar flags\nproperty list uchar ushort vertex_indices\n"
             "element tristrips 1\nproperty list int int vertex_indices\nend_header\n");
    for (int i = 0; i < 6; i++) {
        put(7, cos(i)), put(6, sin(i)), put(1, i % 2);
        if (i % 2) put(0, -i);
        put(2, i * i);
    }
    for (int i = 0; i < 2; i++) {
        put(4, i);
        if (i) put(7, 1e9);
        put(5, 7);
    }
    for (int i = 0; i < 3; i++) {
        put(1, 0), put(1, 3 + i);
        for (int k = 0; k < 3 + i; k++) put(3, (k * 5 + i) % 6);
    }
    put(4, 7);
    for (int k = 0; k < 7; k++) put(4, k == 3 ? -1 : k % 6);
}

/* Changes the file somewhere: a byte, a number, a piece left out, doubled or cut off. */
static void mutate(uint64_t key) {
    static const char *const pieces[] = {"-1",     "99999999", "2147483647",   "nan",
                                         "1e400",  " ",        "\n",           "list",
                                         "vertex", "face",     "end_header\n", "\0\0\0\0"};
    size_t at = zt_random_key(key, 1) % file.size, rest = file.size - at;
    size_t length = zt_random_key(key, 2) % (rest < 40 ? rest : 40);
    const char *piece = pieces[zt_random_key(key, 3) % 12];
    size_t piece_length = *piece ? strlen(piece) : 4;
    switch (zt_random_key(key, 4) % 6) {
    case 0:
        file.bytes[at] = (char)zt_random_key(key, 5);
        break;
    case 1:
        file.bytes[at] = (char)(file.bytes[at] ^ 1 << zt_random_key(key, 5) % 8);
        break;
    case 2: /* in the place of others */
        memcpy(file.bytes + at, piece, piece_length < rest ? piece_length : rest);
        break;
    case 3: /* between others */
        memmove(file.bytes + at + piece_length, file.bytes + at, rest);
        memcpy(file.bytes + at, piece, piece_length);
        file.size += piece_length;
        break;
    case 4: /* left out */
        memmove(file.bytes + at, file.bytes + at + length, rest - length);
        file.size -= length;
        break;
    case 5: /* twice */
        memmove(file.bytes + at + length, file.bytes + at, rest);
        file.size += length;
        break;
    }
}

/* 24,000 files with up to four changes each: every one gives a sound mesh or is refused with
 * one error, at once. */
static void changed_files(void **state) {
    (void)state;
    int read_count = 0, file_count = 24000;
    for (int i = 0; i < file_count; i++) {
        put_everything(i % 3);
        uint64_t key = zt_random_key(2024, (uint64_t)i);
        for (uint64_t k = 0; k <= zt_random_key(key, 0) % 4; k++)
            mutate(zt_random_key(key, 1 + k));
        reading r;
        clock_t start = clock();
        read_file(&r);
        if (clock() - start > CLOCKS_PER_SEC / 2) fail_msg("file %d took too long", i);
        if (r.status == ZT_OK)
            assert_sound(&r.mesh);
        else if (r.status != ZT_EDESCRIPTION || r.error_count != 1)
            fail_msg("file %d: %s, %d errors", i, zt_status_text(r.status), r.error_count);
        read_count += r.status == ZT_OK;
        forget(&r);
    }
    /* Both must be frequent for this to show anything. */
    assert_in_range(read_count, file_count / 20, file_count - file_count / 5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mistakes),         cmocka_unit_test(places),
        cmocka_unit_test(binary_mistakes),  cmocka_unit_test(cut_off_files),
        cmocka_unit_test(files_and_places), cmocka_unit_test(changed_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
