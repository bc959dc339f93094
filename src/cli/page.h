/* The page of a report: one HTML file that needs nothing else. */
#ifndef ZT_CLI_PAGE_H
#define ZT_CLI_PAGE_H

#include <stdio.h>

#include "cli/findings.h"
#include "cli/pictures.h"

/* `wide` and `narrow` are the chart for wide and for narrow windows, SVG. `name` is what the
 * files beside it are called, but for their endings. */
void zt_page_print(FILE *out, const zt_findings *findings, const zt_pictures *pictures,
                   const char *wide, const char *narrow, const char *name);

#endif
