/* What `zoetrope explain` prints. */
#ifndef ZT_CLI_EXPLAIN_H
#define ZT_CLI_EXPLAIN_H

#include "cli/report.h"

/* Explains "lamp.position@37" on standard output. ZT_EARGUMENT, told, where there is no such
 * property or time. */
zt_status zt_explain(const zt_animation *animation, const char *question, zt_report *report);

/* Tells in which precision frames first .. last are rendered and why, on one line as long as
 * there is the same to say. Fails as rendering does. */
zt_status zt_explain_precision(const zt_animation *animation, int64_t first, int64_t last,
                               zt_report *report);

#endif
