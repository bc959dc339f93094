/* Holding a target: one process at a time, or one for each of its parts, and what it has
 * completed is remembered beside it, in TARGET.done, a line for each thing. */
#ifndef ZT_SEQUENCE_HOLD_H
#define ZT_SEQUENCE_HOLD_H

#include <stdbool.h>

#include <zoetrope/output.h>

/* A file that is locked while a process is at work, and says which one that is. */
typedef struct zt_lock {
    char *path; /* NULL: there is none */
    int file;   /* -1: not locked */
} zt_lock;

typedef struct zt_hold {
    zt_lock whole, part; /* the target's, shared by its parts; and that of a part */
    char *done_path;
    int done;               /* a file; -1: none */
    size_t existing_length; /* of the path's beginning that was there before */
    zt_listener listener;
    zt_output_record *records; /* of earlier runs; owned */
    int64_t record_count;
} zt_hold;

/* Part `part` of `part_count`; 0, 0: all of it. ZT_EFILE, told, where another process holds the
 * target or this part of it, and which. */
zt_status zt_hold_open(zt_hold *hold, const char *target, int64_t part, int64_t part_count,
                       zt_listener listener);

/* Remembers what was completed, by one write at the end of the file; `user` is the hold. */
zt_status zt_hold_record(void *user, const zt_output_record *record);

/* Lets go, and removes directories that were made for it and are empty. Nothing happens to a
 * hold of zeros. */
zt_status zt_hold_close(zt_hold *hold);

#endif
