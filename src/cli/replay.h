/* `zoetrope frame FILE N --pixel X,Y`: how a pixel's samples come about, in print. */
#ifndef ZT_CLI_REPLAY_H
#define ZT_CLI_REPLAY_H

#include "cli/options.h"
#include "cli/report.h"

/* Prints the samples of the pixel that the options name, of their first frame, or one of them.
 */
zt_status zt_replay_pixel(zt_renderer *renderer, const zt_options *options,
                          const zt_watcher *watcher, zt_report *report);

#endif
