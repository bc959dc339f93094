/* Telling: how the library says what happened, to whoever listens. */
#ifndef ZT_BASE_DIAG_H
#define ZT_BASE_DIAG_H

#include <zoetrope/status.h>

/* Hands a failure up: if the call did not succeed, return its status. */
#define ZT_TRY(call)                                                                           \
    do {                                                                                       \
        zt_status zt_try_status = (call);                                                      \
        if (zt_try_status != ZT_OK) return zt_try_status;                                      \
    } while (0)

/* A place in a text file. Lines and columns count from 1. */
typedef struct zt_place {
    const char *file;
    const char *source_line; /* terminated by '\n' or '\0'; NULL where unknown */
    int line, column, length;
} zt_place;

/* Tells a sentence without a place. */
__attribute__((format(printf, 3, 4))) void zt_tell(zt_listener listener, zt_severity severity,
                                                   const char *format, ...);

/* Tells a sentence about a place; `place` may be NULL. */
__attribute__((format(printf, 4, 5))) void zt_tell_at(zt_listener listener,
                                                      zt_severity severity,
                                                      const zt_place *place, const char *format,
                                                      ...);

#endif
