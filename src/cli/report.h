/* What the program says: messages and progress on standard error, results on standard output.
 */
#ifndef ZT_CLI_REPORT_H
#define ZT_CLI_REPORT_H

#include <stdbool.h>

#include <zoetrope/zoetrope.h>

typedef struct zt_report {
    bool quiet;    /* nothing but errors */
    bool terminal; /* standard error is one, so lines can be rewritten */
    bool colors;
    bool line_open;  /* a line that can be rewritten stands there */
    int error_count; /* told so far */
} zt_report;

zt_report zt_report_create(void);

/* Prints all that the library tells; safe from any thread. The report must outlive it. */
zt_listener zt_report_listener(zt_report *report);

/* Says something of the program's own, in the form of the library's messages. */
__attribute__((format(printf, 3, 4))) void
zt_report_say(zt_report *report, zt_severity severity, const char *format, ...);

/* Prints a line of progress; on a terminal it takes the place of the one before, and the next
 * one its own, unless it is the last. */
__attribute__((format(printf, 3, 4))) void zt_report_line(zt_report *report, bool last,
                                                          const char *format, ...);

/* What `zoetrope check` prints: how large and long the film is, what is in it, what moves. */
void zt_report_contents(const zt_animation *animation);

/* Makes sure that what was printed on standard output arrived there: in the end of all that
 * succeeds (main.c), and before what ends with another code. */
zt_status zt_report_finish(zt_report *report);

#endif
