/* The command "reproduce": an image is rendered again by what its file says, and compared. */
#ifndef ZT_CLI_REPRODUCE_H
#define ZT_CLI_REPRODUCE_H

#include <stdbool.h>

#include "cli/options.h"
#include "cli/report.h"

/* Prints whether the image options->file comes out the same: of the description
 * options->other, or else the one that the image names, where that is, or beside the image.
 * Sets `differs` where it does not. */
zt_status zt_reproduce_image(bool *differs, const zt_options *options,
                             bool (*stopped)(void *user), zt_report *report);

#endif
