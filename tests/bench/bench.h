/* The groups of measurements, each in a file of its own. They print; nothing is asserted. */
#ifndef ZT_BENCH_BENCH_H
#define ZT_BENCH_BENCH_H

#include <stdbool.h>

void bench_duels(void);             /* against POV-Ray and Tachyon, which must be installed */
void bench_starts(bool with_peers); /* whole processes that render next to nothing */
void bench_ways(void);              /* threads, widths of instructions, precisions, sizes */
void bench_floors(void);            /* the kernels in a bare loop */
void bench_features(void);          /* filters, shutters, lenses, lamps with a size */
void bench_growth(void);            /* ten times as much in the scene */
void bench_movie(void);             /* a whole film to MP4, against encoding alone */

#endif
