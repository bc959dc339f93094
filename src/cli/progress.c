#include "cli/progress.h"

#include <inttypes.h>
#include <stdio.h>
#include <time.h>

/* Seconds between two lines: rewritten on a terminal, one below the other elsewhere. */
static const double terminal_pause_s = 0.2, plain_pause_s = 5;

enum { TEXT_SIZE = 48 };

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* "41.3 frames a second", or "2.5 s a frame" where one takes longer than a second. */
static void print_rate(char text[TEXT_SIZE], double frames_per_s) {
    if (frames_per_s >= 1)
        snprintf(text, TEXT_SIZE, "%.1f frames a second", frames_per_s);
    else
        snprintf(text, TEXT_SIZE, "%.1f s a frame", 1 / frames_per_s);
}

static void print_duration(char text[TEXT_SIZE], double duration_s) {
    int64_t s = (int64_t)(duration_s + 0.5);
    if (s < 60)
        snprintf(text, TEXT_SIZE, "%" PRId64 " s", s);
    else if (s < 3600)
        snprintf(text, TEXT_SIZE, "%" PRId64 " min %" PRId64 " s", s / 60, s % 60);
    else
        snprintf(text, TEXT_SIZE, "%" PRId64 " h %" PRId64 " min", s / 3600, s / 60 % 60);
}

zt_progress zt_progress_begin(zt_report *report, int64_t total_count) {
    if (report->terminal)
        zt_report_line(report, false, "frames to render: %" PRId64, total_count);
    double now = now_s();
    return (zt_progress){
        .report = report, .begun_s = now, .shown_s = now, .total_count = total_count};
}

void zt_progress_frame(zt_progress *progress, int64_t done_count, int64_t frame) {
    progress->done_count = done_count;
    double now = now_s();
    double pause = progress->report->terminal ? terminal_pause_s : plain_pause_s;
    if (now - progress->shown_s < pause) return;
    progress->shown_s = now;
    double frames_per_s = (double)done_count / (now - progress->begun_s);
    char rate[TEXT_SIZE], left[TEXT_SIZE];
    print_rate(rate, frames_per_s);
    print_duration(left, (double)(progress->total_count - done_count) / frames_per_s);
    zt_report_line(progress->report, false,
                   "frame %" PRId64 ": %" PRId64 " of %" PRId64 ", %s, %s left", frame,
                   done_count, progress->total_count, rate, left);
}

void zt_progress_end(const zt_progress *progress, const char *target) {
    double elapsed_s = now_s() - progress->begun_s;
    char rate[TEXT_SIZE];
    print_rate(rate, (double)progress->done_count / elapsed_s);
    zt_report_line(progress->report, true, "%s: %" PRId64 " frame%s in %.1f s, %s", target,
                   progress->done_count, progress->done_count == 1 ? "" : "s", elapsed_s, rate);
}
