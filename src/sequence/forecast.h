/* What a picture takes, and what it would take with other errors: from what was seen of it, or
 * of a smaller one. Knows no clock: it is told the time. */
#ifndef ZT_SEQUENCE_FORECAST_H
#define ZT_SEQUENCE_FORECAST_H

#include "render/expect.h"

/* Errors have numbers, as in render/expect.h. */
enum { ZT_FORECAST_LAST = ZT_EXPECT_COUNT - 1 };

/* Of samples or their time, what is too few to tell. */
#define ZT_FORECAST_SEEN 0.05

/* Samples are those of the whole picture; seconds are of rendering, once all is made that
 * lasts. */
typedef struct zt_forecast {
    double many;   /* times more pixels than the picture the frame has */
    double least;  /* samples with an error of 1 */
    double growth; /* their time grows by pixels to this power */
    int known;     /* number of the smallest error that this or a smaller one was seen with; */
    int error;     /* of the one that this was seen with last, */
    double samples, all_s; /* and what it took */
    double sample_s;       /* what each further one takes */
    double times;          /* as many as are expected come true */
    zt_expected expected;
} zt_forecast;

/* With an error: how many samples, and how long they take. */
double zt_forecast_samples(const zt_forecast *forecast, int error);
double zt_forecast_seconds(const zt_forecast *forecast, int error);

/* How long the least samples take. */
double zt_forecast_least_s(const zt_forecast *forecast);

/* The smallest error that takes no longer than so. */
int zt_forecast_error(const zt_forecast *forecast, double most_s);

/* Of a picture of so many times more pixels. Edges, of which there is the most to be had, grow
 * as sides do; random light is everywhere. */
zt_forecast zt_forecast_larger(const zt_forecast *forecast, double many);

/* What was seen after `old`, with a smaller error, tells more of further samples: how many of
 * those that were expected came, where light is random at least as many; and what each took,
 * which is more than at first, as they are where most is met. */
void zt_forecast_learn(zt_forecast *forecast, const zt_forecast *old);

#endif
