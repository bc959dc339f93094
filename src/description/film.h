/* Reading the film: size, rate, duration, shutter, samples. */
#ifndef ZT_DESCRIPTION_FILM_H
#define ZT_DESCRIPTION_FILM_H

#include "description/reading.h"

/* Sets what a film is where the description says nothing of it. */
void zt_film_rest(zt_animation *animation);

/* Reads "film"; tells what is wrong. Files are named relative to `directory`, which is empty or
 * ends with a slash. ZT_EMEMORY. */
zt_status zt_film_read(zt_reading *reading, const zt_node *node, const char *directory);

#endif
