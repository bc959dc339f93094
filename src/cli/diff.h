/* The command "diff": which frames of a film change, because of what, and how long they take.
 */
#ifndef ZT_CLI_DIFF_H
#define ZT_CLI_DIFF_H

#include <stdbool.h>

#include "cli/options.h"
#include "cli/report.h"

/* Prints how the film of options->other differs from that of options->file. The time is that
 * which the manifest of the target tells, or that of the newer film's or the older one's own
 * target; else one or two frames are rendered to find out. */
zt_status zt_diff_films(const zt_options *options, bool (*stopped)(void *user),
                        zt_report *report);

#endif
