/* What can go wrong, and how the library tells of it. The library itself never prints and never
 * exits: functions that can fail return a zt_status, and say what happened to a listener. */
#ifndef ZOETROPE_STATUS_H
#define ZOETROPE_STATUS_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum zt_status {
    ZT_OK = 0,
    ZT_EDESCRIPTION, /* the description has mistakes; each one has been told */
    ZT_EARGUMENT,    /* a call or an option that makes no sense */
    ZT_EMEMORY,      /* out of memory */
    ZT_EFILE,        /* a file cannot be opened, read, written or renamed */
    ZT_EUNSUPPORTED, /* this build or this file format cannot do what was asked */
    ZT_ESTOPPED      /* the caller asked to stop */
} zt_status;

/* A few plain words for a status ("out of memory"); never NULL. */
const char *zt_status_text(zt_status status);

typedef enum zt_severity { ZT_NOTE, ZT_WARNING, ZT_ERROR } zt_severity;

/* One thing told. All pointers are valid only during the call that tells it. */
typedef struct zt_message {
    zt_severity severity;
    const char *text;
    const char *file;        /* NULL where there is no place to point at */
    int line, column;        /* counted from 1; 0 where only the file is known */
    int length;              /* characters marked from `column` on; at least 1 */
    const char *source_line; /* the line itself without its newline, or NULL */
} zt_message;

/* Who listens. `tell` may be NULL: then nothing is heard, and only the status tells. It is
 * called from the thread that called the library, but for what is done behind it meanwhile,
 * such as writing, which may tell from a thread of its own; never from two threads at once
 * within one call. */
typedef struct zt_listener {
    void (*tell)(void *user, const zt_message *message);
    void *user;
} zt_listener;

/* Writes a message as compilers do, "file:line:column: error: text" with the source line and a
 * caret below where they are known, into `buffer` of `size` bytes, always terminated. Returns
 * the length of the whole text as snprintf does. */
size_t zt_message_format(char *buffer, size_t size, const zt_message *message);

#ifdef __cplusplus
}
#endif
#endif
