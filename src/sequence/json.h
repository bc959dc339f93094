/* Reads JSON whose shape is known beforehand, piece by piece: each call takes the next piece,
 * or tells at its place that something else stands there, and returns ZT_EFILE. Nothing nests
 * but by the caller's own calls. Writes what it consists of. */
#ifndef ZT_SEQUENCE_JSON_H
#define ZT_SEQUENCE_JSON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <zoetrope/status.h>

typedef struct zt_json {
    char *text;        /* the whole file, ended by 0; owned */
    const char *at;    /* what has not been read yet */
    const char *taken; /* where the piece that was read last began */
    const char *path;
    int lines_before; /* the text, in what it is a part of */
    zt_listener listener;
} zt_json;

/* Reads the file. ZT_EFILE, told, where that cannot be done; `path` must outlive the reader. */
zt_status zt_json_open(zt_json *json, const char *path, zt_listener listener);

/* The same of a text, which is copied; `path` is what messages call it. ZT_EMEMORY. */
zt_status zt_json_open_text(zt_json *json, const char *text, const char *path,
                            zt_listener listener);
void zt_json_close(zt_json *json);

/* One of { } [ ] , : */
zt_status zt_json_mark(zt_json *json, char mark);

/* After an element: a comma, and so another one; or what closes the list. */
zt_status zt_json_more(zt_json *json, bool *more, char closing);

/* A key and its colon; which of `names`, ended by NULL. */
zt_status zt_json_key(zt_json *json, int *key, const char *const *names);

/* A number within a range, both ends included; an integer is written as digits alone. */
zt_status zt_json_number(zt_json *json, double *number, double low, double high);
zt_status zt_json_integer(zt_json *json, int64_t *number, int64_t low, int64_t high);

/* A text, in UTF-8, of which `size` bytes with the end are kept; none where `text` is NULL. */
zt_status zt_json_text(zt_json *json, char *text, size_t size);

/* Nothing but blanks is left. */
zt_status zt_json_end(zt_json *json);

/* Tells what is wrong with the piece that was read last; returns ZT_EFILE. */
__attribute__((format(printf, 2, 3))) zt_status zt_json_refuse(zt_json *json,
                                                               const char *format, ...);

/* A text in quotes, by letters of ASCII alone. */
void zt_json_print_text(FILE *file, const char *text);

/* With as many digits as tell it from all others, three at least. */
void zt_json_print_number(FILE *file, double number);

#endif
