/* PLY files in tests: written number by number, read from the disk or from bytes, and what was
 * told meanwhile. */
#ifndef ZT_TESTS_PLY_READING_H
#define ZT_TESTS_PLY_READING_H

#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "description/ply.h"

/* A mesh read, or why not. */
typedef struct reading {
    zt_status status;
    zt_mesh mesh;
    zt_arena arena;
    int error_count, warning_count, note_count;
    int line, column;
    char text[512]; /* of the last error or warning */
    char note[256]; /* the last note as it would be printed */
} reading;

static inline void hear(void *user, const zt_message *message) {
    reading *r = user;
    if (message->severity == ZT_NOTE) {
        r->note_count++;
        zt_message_format(r->note, sizeof r->note, message);
        return;
    }
    *(message->severity == ZT_ERROR ? &r->error_count : &r->warning_count) += 1;
    r->line = message->line;
    r->column = message->column;
    snprintf(r->text, sizeof r->text, "%s", message->text);
}

static inline void read_path(reading *r, const char *path, const zt_place *place) {
    *r = (reading){0};
    r->status = zt_ply_read(&r->mesh, &r->arena, path, ZT_PLY_NORMALS | ZT_PLY_COLORS, place,
                            (zt_listener){hear, r});
}

static inline void read_bytes(reading *r, const void *bytes, size_t size) {
    static int file = -1; /* in memory, written anew each time */
    static char path[64];
    if (file < 0) file = memfd_create("ply", MFD_CLOEXEC);
    snprintf(path, sizeof path, "/proc/self/fd/%d", file);
    assert_int_equal(ftruncate(file, 0), 0);
    assert_int_equal(pwrite(file, bytes, size, 0), (ssize_t)size);
    read_path(r, path, NULL);
}

static inline void read_text(reading *r, const char *text) {
    read_bytes(r, text, strlen(text));
}

/* The mesh of a reading that must have succeeded, in silence. */
static inline const zt_mesh *mesh_of(const reading *r) {
    if (r->status != ZT_OK || r->error_count || r->warning_count || r->note_count)
        fail_msg("%s; line %d: %s", zt_status_text(r->status), r->line, r->text);
    return &r->mesh;
}

static inline void forget(reading *r) { zt_arena_free(&r->arena); }

/* A PLY file being written by the test itself, number by number. */
static struct file {
    enum { ASCII, LITTLE, BIG } format;
    char bytes[4096];
    size_t size;
} file;

static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};

__attribute__((format(printf, 1, 2))) static inline void put_text(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    file.size += (size_t)vsnprintf(file.bytes + file.size, sizeof file.bytes - file.size,
                                   format, arguments);
    va_end(arguments);
}

static inline void begin(int format) {
    file.format = format;
    file.size = 0;
    put_text("ply\nformat %s 1.0\n", formats[format]);
}

/* A number as one of eight types: char, uchar, short, ushort, int, uint, float, double; then
 * the same again. */
static inline void put(int type, double number) {
    static const int sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    if (file.format == ASCII) {
        put_text("%.17g ", number);
        return;
    }
    union {
        int64_t whole;
        float single;
        double number;
        unsigned char bytes[8]; /* the tests run on little-endian machines */
    } as = {.whole = (int64_t)number};
    if (type % 8 == 6) as.single = (float)number;
    if (type % 8 == 7) as.number = number;
    int size = sizes[type % 8];
    for (int i = 0; i < size; i++)
        file.bytes[file.size++] = (char)as.bytes[file.format == BIG ? size - 1 - i : i];
}

static inline void read_file(reading *r) { read_bytes(r, file.bytes, file.size); }

#define ASCII_HEADER "ply\nformat ascii 1.0\n"
#define VERTICES(count)                                                                        \
    "element vertex " #count "\nproperty float x\nproperty float y\nproperty float z\n"
#define FACES(count) "element face " #count "\nproperty list uchar int vertex_indices\n"
#define SQUARE       "end_header\n0 0 0\n2 0 0\n2 2 0\n0 2 0\n"

#endif
