/* Files are written aside, as "<name>.part" in the same directory, and get their name when they
 * are complete: nobody ever sees half a file, and an older one is there until the new one is.
 */
#ifndef ZT_ENCODE_ASIDE_H
#define ZT_ENCODE_ASIDE_H

#include <zoetrope/status.h>

/* Zeroed: nothing is under way. */
typedef struct zt_aside {
    char *path;   /* where to write */
    char *target; /* what it will be called */
} zt_aside;

/* Makes missing directories and a file at aside->path, which shows that it can be written; what
 * a file of this name holds, it still holds. ZT_EFILE after telling why not; then nothing is
 * under way. */
zt_status zt_aside_open(zt_aside *aside, const char *target, zt_listener listener);

/* The same with another ending than ".part". */
zt_status zt_aside_open_as(zt_aside *aside, const char *target, const char *suffix,
                           zt_listener listener);

/* Gives the file its name, and forgets about it. Where that fails, which is told, removes it.
 */
zt_status zt_aside_keep(zt_aside *aside, zt_listener listener);

/* Asks for room on the disk for `bytes`, at a guess. ZT_EFILE, told, where there is not even a
 * quarter of it; where there is less, a warning. */
zt_status zt_aside_room(const zt_aside *aside, double bytes, zt_listener listener);

/* Forgets about the file, which stays under the name that it has; and tells that as a note. */
void zt_aside_forget(zt_aside *aside);
void zt_aside_leave(zt_aside *aside, zt_listener listener);

/* Removes the file, if one is under way. */
void zt_aside_drop(zt_aside *aside);

#endif
