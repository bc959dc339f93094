/* How far a sequence is, how fast it goes, when it will be done. */
#ifndef ZT_CLI_PROGRESS_H
#define ZT_CLI_PROGRESS_H

#include <stdint.h>

#include "cli/report.h"

typedef struct zt_progress {
    zt_report *report;
    double begun_s, shown_s; /* when the sequence began, when a line was last shown */
    int64_t done_count, total_count;
} zt_progress;

zt_progress zt_progress_begin(zt_report *report, int64_t total_count);

/* To be called after each frame; says so now and then. */
void zt_progress_frame(zt_progress *progress, int64_t done_count, int64_t frame);

/* The last line: what is in `target` now, and how long that took. */
void zt_progress_end(const zt_progress *progress, const char *target);

#endif
