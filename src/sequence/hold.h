/* Holding a target: one process at a time, or one for each of its parts. */
#ifndef ZT_SEQUENCE_HOLD_H
#define ZT_SEQUENCE_HOLD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <zoetrope/status.h>

/* A file that is locked while a process is at work, and says which one that is. */
typedef struct zt_lock {
    char *path; /* NULL: there is none */
    int file;   /* -1: not locked */
} zt_lock;

typedef struct zt_hold {
    zt_lock whole, part;    /* the target's, shared by its parts; and that of a part */
    size_t existing_length; /* of the path's beginning that was there before */
    zt_listener listener;
} zt_hold;

/* Part `part` of `part_count`; 0, 0: all of it. ZT_EFILE, told, where another process holds the
 * target or this part of it, and which. */
zt_status zt_hold_open(zt_hold *hold, const char *target, int64_t part, int64_t part_count,
                       zt_listener listener);

/* Whether no other process has a part of it; and none gets one any more. */
bool zt_hold_alone(const zt_hold *hold);

/* Lets go, and removes directories that were made for it and are empty. Nothing happens to a
 * hold of zeros. */
void zt_hold_close(zt_hold *hold);

#endif
