/* What drawings are made of: numbers and words that SVG understands, colours, one style. */
#ifndef ZT_CLI_SVG_H
#define ZT_CLI_SVG_H

#include <stdio.h>

/* M. Okabe and K. Ito, "Color Universal Design", 2008: told apart by nearly all eyes; and two
 * more. */
enum { ZT_SVG_HUE_COUNT = 9 };
extern const char *const zt_svg_hues[ZT_SVG_HUE_COUNT];

/* The head of a white drawing of so many pixels, with its style: classes n (small words),
 * title, end and mid (where words stand), grid, zero, axis, tick, line. */
void zt_svg_begin(FILE *out, int width, int height);

/* A coordinate, to a hundredth, without zeros at its end. */
void zt_svg_number(FILE *out, double x);

/* At most `most` letters of a text, safe within XML. */
void zt_svg_words(FILE *out, const char *text, int most);

/* How many letters a text has, in UTF-8. */
int zt_svg_letter_count(const char *text);

void zt_svg_line(FILE *out, double x1, double y1, double x2, double y2, const char *class);

#endif
