/* What `zoetrope explain` prints. */
#ifndef ZT_CLI_EXPLAIN_H
#define ZT_CLI_EXPLAIN_H

#include "cli/report.h"

/* Explains "lamp.position@37" on standard output. ZT_EARGUMENT, told, where there is no such
 * property or time. */
zt_status zt_explain(const zt_animation *animation, const char *question, zt_report *report);

/* Tells what is chosen for frames first .. last, and why: the precision, and how the shutter's
 * opening is divided. At once for frames of which the same is to say. Fails as rendering does.
 */
zt_status zt_explain_frames(const zt_animation *animation, int64_t first, int64_t last,
                            zt_report *report);

#endif
