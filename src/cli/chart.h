/* The chart of error against run time, as SVG. */
#ifndef ZT_CLI_CHART_H
#define ZT_CLI_CHART_H

#include <stddef.h>

#include "cli/findings.h"

/* Both axes are logarithmic. A drawing `width` units wide, which letters do not shrink with: at
 * least 320. *svg, of *length bytes and terminated, is of the caller to free. */
zt_status zt_chart_draw(char **svg, size_t *length, const zt_findings *findings, int width);

#endif
