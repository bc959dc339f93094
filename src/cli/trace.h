/* A property followed over a stretch of time, closely where it bends or jumps. */
#ifndef ZT_CLI_TRACE_H
#define ZT_CLI_TRACE_H

#include <zoetrope/zoetrope.h>

/* Points in the order of time; each is its time in seconds, then a number for each channel. */
typedef struct zt_trace {
    double *points; /* owned */
    int count, capacity;
    int width;        /* doubles a point: 1 + channels */
    double low, high; /* of all numbers */
} zt_trace;

/* How fine: differences of less are not seen. */
typedef struct zt_trace_grain {
    double time_s;
    double share; /* of the range of the values */
} zt_trace_grain;

/* From first_s to last_s. The caller frees the trace, whatever is returned. */
zt_status zt_trace_make(zt_trace *trace, const zt_subject *subject, double first_s,
                        double last_s, zt_trace_grain grain, zt_listener listener);
void zt_trace_free(zt_trace *trace);

static inline double zt_trace_time(const zt_trace *trace, int point) {
    return trace->points[(size_t)point * (size_t)trace->width];
}
static inline double zt_trace_value(const zt_trace *trace, int point, int channel) {
    return trace->points[(size_t)point * (size_t)trace->width + 1 + (size_t)channel];
}

#endif
