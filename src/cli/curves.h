/* What `zoetrope curves` does: plots go to a file. */
#ifndef ZT_CLI_CURVES_H
#define ZT_CLI_CURVES_H

#include "cli/options.h"

/* Plots the properties that are named, or all that move. ZT_EARGUMENT, told, where there is no
 * such property, or nothing moves. */
zt_status zt_curves(const zt_options *options, const zt_animation *animation,
                    zt_report *report);

#endif
