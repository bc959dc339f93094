/* What rendering did, and what it was spared. */
#ifndef ZT_CLI_STATS_H
#define ZT_CLI_STATS_H

#include <zoetrope/zoetrope.h>

/* Prints it, after `wall_s` seconds in all. */
void zt_stats_print(const zt_renderer *renderer, const zt_film_result *result, double wall_s);

#endif
