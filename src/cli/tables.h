/* A ladder as CSV and as JSON. */
#ifndef ZT_CLI_TABLES_H
#define ZT_CLI_TABLES_H

#include <stdio.h>

#include "cli/findings.h"

/* A row for each rung, under a row of names with their units. */
void zt_table_csv(FILE *out, const zt_findings *findings);

/* All that the page says. What is no number is null. */
void zt_table_json(FILE *out, const zt_findings *findings);

#endif
