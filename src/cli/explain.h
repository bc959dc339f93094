/* What `zoetrope explain` prints. */
#ifndef ZT_CLI_EXPLAIN_H
#define ZT_CLI_EXPLAIN_H

#include "cli/report.h"

/* Explains "lamp.position@37" on standard output. ZT_EARGUMENT, told, where there is no such
 * property or time. */
zt_status zt_explain(const zt_animation *animation, const char *question, zt_report *report);

#endif
