/* The command "encode": images that are there become a movie. */
#ifndef ZT_CLI_ENCODE_H
#define ZT_CLI_ENCODE_H

#include <stdbool.h>

#include "cli/options.h"
#include "cli/report.h"

/* Finds the files that options->file means, "frames.####.exr" or "frames.%04d.png", and writes
 * them in rising order to the target; numbers that are missing between two of them are told,
 * and left out. Files of floats are linear light, and developed by the view that was asked for,
 * or that of the film whose images they are; the numbers of others go as they are.
 * ZT_EARGUMENT, ZT_EFILE or ZT_ESTOPPED after telling. */
zt_status zt_encode(const zt_options *options, bool (*stopped)(void *user), zt_report *report);

#endif
