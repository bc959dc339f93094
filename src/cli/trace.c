#include "cli/trace.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FIRST_LOOKS = 512, /* evenly spaced, so that no swing of a spring is missed */
    POINT_WIDTH_MAX = 1 + ZT_SUBJECT_CHANNELS_MAX,
    POINTS_MAX = 1 << 20
};

typedef struct point {
    double numbers[POINT_WIDTH_MAX];
} point;

/* A subject that is being followed. */
typedef struct tracer {
    zt_trace *trace;
    const zt_subject *subject;
    zt_listener listener;
    double least_s, tolerance; /* what is not seen: a time, and half a difference */
} tracer;

static zt_status look(point *p, const tracer *t, double time_s) {
    p->numbers[0] = time_s;
    return zt_subject_eval(p->numbers + 1, t->subject, time_s, t->listener);
}

static zt_status add(zt_trace *trace, const point *p) {
    if (trace->count == trace->capacity) {
        int capacity = trace->capacity ? 2 * trace->capacity : 2 * FIRST_LOOKS;
        if (capacity > POINTS_MAX) return ZT_EMEMORY;
        double *points =
            realloc(trace->points, (size_t)capacity * (size_t)trace->width * sizeof *points);
        if (!points) return ZT_EMEMORY;
        trace->points = points;
        trace->capacity = capacity;
    }
    memcpy(trace->points + (size_t)trace->count++ * (size_t)trace->width, p->numbers,
           (size_t)trace->width * sizeof *p->numbers);
    for (int c = 1; c < trace->width; c++) {
        trace->low = fmin(trace->low, p->numbers[c]);
        trace->high = fmax(trace->high, p->numbers[c]);
    }
    return ZT_OK;
}

/* Whether the middle is on the line between both, but for twice the tolerance. */
static bool is_straight(const zt_trace *trace, const point *a, const point *middle,
                        const point *b, double tolerance) {
    for (int c = 1; c < trace->width; c++)
        if (fabs(middle->numbers[c] / 2 - (a->numbers[c] / 4 + b->numbers[c] / 4)) > tolerance)
            return false;
    return true;
}

/* Adds what is between two points, without them. */
static zt_status refine(const tracer *t, const point *a, const point *b) {
    double middle_s = a->numbers[0] + (b->numbers[0] - a->numbers[0]) / 2;
    if (b->numbers[0] - a->numbers[0] <= t->least_s || middle_s <= a->numbers[0] ||
        middle_s >= b->numbers[0])
        return ZT_OK;
    point middle;
    zt_status status = look(&middle, t, middle_s);
    if (status != ZT_OK || is_straight(t->trace, a, &middle, b, t->tolerance)) return status;
    status = refine(t, a, &middle);
    if (status == ZT_OK) status = add(t->trace, &middle);
    if (status == ZT_OK) status = refine(t, &middle, b);
    return status;
}

/* The times that are looked at first, keys among them; `key` is the next one. */
static double next_time(const zt_subject *subject, int *key, int *look_number, double first_s,
                        double last_s) {
    double even_s = first_s + (last_s - first_s) * *look_number / FIRST_LOOKS;
    double key_s = INFINITY;
    while (*key < subject->key_count &&
           (key_s = zt_subject_key_at(subject, *key).time_s) <= first_s)
        ++*key, key_s = INFINITY;
    if (key_s < even_s) {
        ++*key;
        return key_s;
    }
    if (key_s == even_s) ++*key;
    ++*look_number;
    return even_s;
}

/* All points, from the first time to the last. */
static zt_status walk(const tracer *t, double first_s, double last_s) {
    point before, next;
    int key = 0, look_number = 1;
    t->trace->count = 0;
    zt_status status = look(&before, t, first_s);
    if (status == ZT_OK) status = add(t->trace, &before);
    while (status == ZT_OK && look_number <= FIRST_LOOKS) {
        double time_s = next_time(t->subject, &key, &look_number, first_s, last_s);
        status = look(&next, t, time_s);
        if (status == ZT_OK) status = refine(t, &before, &next);
        if (status == ZT_OK) status = add(t->trace, &next);
        before = next;
    }
    return status;
}

zt_status zt_trace_make(zt_trace *trace, const zt_subject *subject, double first_s,
                        double last_s, zt_trace_grain grain, zt_listener listener) {
    *trace = (zt_trace){.width = 1 + subject->channel_count, .low = DBL_MAX, .high = -DBL_MAX};
    tracer t = {trace, subject, listener, INFINITY, 0};
    zt_status status = walk(&t, first_s, last_s); /* coarsely, for the range of the values */
    if (status != ZT_OK) return status;
    t.least_s = grain.time_s;
    t.tolerance = grain.share * (trace->high / 2 - trace->low / 2);
    return walk(&t, first_s, last_s);
}

void zt_trace_free(zt_trace *trace) {
    free(trace->points);
    *trace = (zt_trace){0};
}
