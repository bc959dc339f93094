/* Time as the wall shows it, for measurements only: no image depends on it. */
#ifndef ZT_BASE_CLOCK_H
#define ZT_BASE_CLOCK_H

/* Seconds since an arbitrary moment; never goes back. */
double zt_clock_s(void);

#endif
