/* What the header of a PLY file says: its elements, their properties, and where the data begin.
 */
#ifndef ZT_DESCRIPTION_PLY_HEADER_H
#define ZT_DESCRIPTION_PLY_HEADER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/arena.h"
#include "base/diag.h"

/* A file in memory. Its bytes are followed by a '\0' of our own, which belongs to no line. */
typedef struct zt_ply_source {
    const char *path, *bytes, *end;
    zt_listener listener;
    char newline; /* '\n', or '\r' where lines end in nothing else; set by reading the header */
} zt_ply_source;

/* Tells an error about `length` bytes at `at`, with line and column, or about the file as a
 * whole where `at` is NULL. Returns ZT_EDESCRIPTION, always. */
__attribute__((format(printf, 4, 5))) zt_status zt_ply_refuse(const zt_ply_source *source,
                                                              const char *at, size_t length,
                                                              const char *format, ...);

typedef enum zt_ply_format {
    ZT_PLY_ASCII,
    ZT_PLY_LITTLE_ENDIAN,
    ZT_PLY_BIG_ENDIAN
} zt_ply_format;

typedef enum zt_ply_type {
    ZT_PLY_INT8,
    ZT_PLY_UINT8,
    ZT_PLY_INT16,
    ZT_PLY_UINT16,
    ZT_PLY_INT32,
    ZT_PLY_UINT32,
    ZT_PLY_FLOAT,
    ZT_PLY_DOUBLE
} zt_ply_type;

/* Bytes of one value in a binary file. */
int zt_ply_type_size(zt_ply_type type);

/* What a property is to us. */
typedef enum zt_ply_role {
    ZT_PLY_X,
    ZT_PLY_Y,
    ZT_PLY_Z,
    ZT_PLY_NX, /* of a normal */
    ZT_PLY_NY,
    ZT_PLY_NZ,
    ZT_PLY_RED,
    ZT_PLY_GREEN,
    ZT_PLY_BLUE,
    ZT_PLY_CORNERS,
    ZT_PLY_SKIPPED
} zt_ply_role;

enum { ZT_PLY_VERTEX_ROLES = ZT_PLY_BLUE + 1 }; /* the first of the roles are a vertex's */

typedef struct zt_ply_property {
    struct zt_ply_property *next;
    zt_ply_role role;
    bool is_list;
    zt_ply_type count_type; /* of a list's length; always an integer */
    zt_ply_type type;       /* of the value or of a list's items */
} zt_ply_property;

typedef struct zt_ply_element {
    struct zt_ply_element *next;
    zt_ply_property *properties; /* in the order of the file */
    const char *at;              /* its name in the header, not terminated */
    int name_length;             /* as much of it as messages show */
    int32_t count;
    unsigned roles;    /* a bit for each role that one of its properties has */
    bool has_list;     /* if not, all rows of a binary file have the same size */
    int64_t row_bytes; /* the fewest that a row may have */
    const char *data;  /* its first row; NULL until the data are surveyed */
} zt_ply_element;

typedef struct zt_ply_header {
    zt_ply_format format;
    zt_ply_element *elements;               /* in the order of the file */
    zt_ply_element *vertex, *face, *strips; /* face or strips may be NULL, but never both */
    const char *data;                       /* the first byte behind the header */
} zt_ply_header;

/* Reads the header; its lists go to `scratch`. When it succeeds, vertices have x, y and z,
 * there is at least one vertex and one polygon or strip, these have corners, and no element
 * counts more rows than the bytes behind the header can hold. */
zt_status zt_ply_header_read(zt_ply_header *header, zt_arena *scratch, zt_ply_source *source);

#endif
