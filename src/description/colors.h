/* Colors as people write them, as linear light. */
#ifndef ZT_DESCRIPTION_COLORS_H
#define ZT_DESCRIPTION_COLORS_H

#include "description/fields.h"

/* "[r, g, b]" in linear light, one such number for a grey, or what a display shows: "#rgb",
 * "#rrggbb", or a name of CSS Color Module Level 4 (W3C, 2022), which are decoded from sRGB.
 * Tells what is wrong; the range is that of each number. */
bool zt_read_color(double color[3], zt_mistakes *mistakes, const zt_node *node,
                   const char *what, zt_range range);

#endif
