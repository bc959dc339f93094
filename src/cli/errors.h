/* What `zoetrope report` does: error against run time, as a page and what goes beside it. */
#ifndef ZT_CLI_ERRORS_H
#define ZT_CLI_ERRORS_H

#include "cli/options.h"

/* Climbs a ladder of settings and writes the page to `target`, which ends in .html, and beside
 * it the chart and the tables. `frames` as zt_frames_read takes them; NULL: the middle one. */
zt_status zt_errors_report(const zt_options *options, const zt_animation *animation,
                           bool (*stopped)(void *user), zt_report *report);

#endif
