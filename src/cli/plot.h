/* Plots of properties over time, as SVG: one panel for each, a line for each of its numbers. */
#ifndef ZT_CLI_PLOT_H
#define ZT_CLI_PLOT_H

#include <zoetrope/zoetrope.h>

/* Draws frames first .. last of the film, to the end of the last one, one panel below the
 * other. *svg, of *length bytes and terminated, is of the caller to free. At least one subject.
 * A value that cannot be had is told. The same bytes for the same description. */
zt_status zt_plot_draw(char **svg, size_t *length, const zt_subject *subjects, int count,
                       int64_t first, int64_t last, zt_listener listener);

#endif
