/* What this process takes of the machine: for measurements, and for what is worth while. */
#ifndef ZT_BASE_USAGE_H
#define ZT_BASE_USAGE_H

#include <stdint.h>

/* Seconds that all of its threads together have computed. */
double zt_usage_cpu_s(void);

/* The same of the calling thread: however busy the machine is with other work, about the wall
 * time that its work takes on an idle one. */
double zt_usage_own_s(void);

/* The most memory that it has had at a time since zt_usage_forget_peak, bytes; since it began
 * where the system cannot forget. */
int64_t zt_usage_peak(void);
void zt_usage_forget_peak(void);

#endif
