/* What this process takes of the machine, for measurements only. */
#ifndef ZT_BASE_USAGE_H
#define ZT_BASE_USAGE_H

#include <stdint.h>

/* Seconds that all of its threads together have computed. */
double zt_usage_cpu_s(void);

/* The most memory that it has had at a time since zt_usage_forget_peak, bytes; since it began
 * where the system cannot forget. */
int64_t zt_usage_peak(void);
void zt_usage_forget_peak(void);

#endif
