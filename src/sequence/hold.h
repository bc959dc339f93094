/* Holding a target: one process at a time, and what it has completed is remembered beside it,
 * in TARGET.done, a line for each thing. */
#ifndef ZT_SEQUENCE_HOLD_H
#define ZT_SEQUENCE_HOLD_H

#include <stdbool.h>

#include <zoetrope/output.h>

typedef struct zt_hold {
    char *lock_path, *done_path;
    int lock, done; /* files; -1: none */
    zt_listener listener;
    zt_output_record *records; /* of earlier runs; owned */
    int64_t record_count;
} zt_hold;

/* ZT_EFILE, told, where another process holds the target, and which. Without `locks` nothing
 * is held or remembered. */
zt_status zt_hold_open(zt_hold *hold, const char *target, bool locks, zt_listener listener);

/* Remembers what was completed, by one write at the end of the file; `user` is the hold. */
zt_status zt_hold_record(void *user, const zt_output_record *record);

zt_status zt_hold_close(zt_hold *hold);

#endif
