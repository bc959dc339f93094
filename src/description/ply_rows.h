/* The rows of a PLY file's elements, gone through number by number: text or bytes. */
#ifndef ZT_DESCRIPTION_PLY_ROWS_H
#define ZT_DESCRIPTION_PLY_ROWS_H

#include <stdbool.h>
#include <stdint.h>

#include "description/ply_header.h"

typedef struct zt_ply_rows {
    const zt_ply_source *source;
    const zt_ply_header *header;
    const char *at;                /* the next byte of data */
    const char *last;              /* the first byte of the number that was read last */
    const zt_ply_element *element; /* being gone through, and which of its rows: */
    int32_t row;
} zt_ply_rows;

static inline bool zt_ply_is_ascii(const zt_ply_rows *r) {
    return r->header->format == ZT_PLY_ASCII;
}

/* A mistake in the row being read: in its last number, where that is text. */
#define ZT_PLY_REFUSE_ROW(r, format, ...)                                                      \
    zt_ply_refuse((r)->source, zt_ply_is_ascii(r) ? (r)->last : NULL,                          \
                  (size_t)((r)->at - (r)->last), "%.*s %d: " format,                           \
                  (r)->element->name_length, (r)->element->at, (r)->row, __VA_ARGS__)

/* Reads or skips a property's `count` values, of a list or one. */
typedef zt_status zt_ply_take(void *user, const zt_ply_property *property, int32_t count);

/* Goes through an element's rows, from the place in the data on; skips what has no role. All of
 * these tell what is wrong: ZT_EDESCRIPTION. */
zt_status zt_ply_go_through(zt_ply_rows *r, const zt_ply_element *element, zt_ply_take *take,
                            void *user);

zt_status zt_ply_read_number(zt_ply_rows *r, zt_ply_type type, double *value);
zt_status zt_ply_skip(zt_ply_rows *r, zt_ply_type type, int32_t count);

/* Goes behind the next piece of text between blanks; false at the end of the file. */
bool zt_ply_next_word(zt_ply_rows *r);

#endif
