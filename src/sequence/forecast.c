#include "sequence/forecast.h"

#include <math.h>

/* Of the least samples, what weighs as much as what was expected of more; and of those before,
 * what tells how long others take. */
#define FEW 0.25

/* To this power of what was expected samples grow, as measured: the more there are, the more
 * pixels go on that seemed good enough by luck. */
#define JOIN 1.12

/* Where it was seen with a smaller error, further samples are thought to be as errors are. */
double zt_forecast_samples(const zt_forecast *v, int error) {
    const double *further = v->expected.further;
    if (error < v->error)
        return v->least +
               (v->samples - v->least) * zt_expect_error(v->error) / zt_expect_error(error);
    double more = v->times * (further[error] - further[v->error]);
    return v->samples * pow(1 + more / v->samples, JOIN);
}

double zt_forecast_seconds(const zt_forecast *v, int error) {
    return v->all_s + v->sample_s * (zt_forecast_samples(v, error) - v->samples);
}

double zt_forecast_least_s(const zt_forecast *v) {
    return fmax(v->all_s - v->sample_s * (v->samples - v->least), ZT_FORECAST_SEEN * v->all_s);
}

int zt_forecast_error(const zt_forecast *v, double most_s) {
    int error = 0;
    while (error < ZT_FORECAST_LAST && zt_forecast_seconds(v, error + 1) <= most_s) error++;
    return error;
}

zt_forecast zt_forecast_larger(const zt_forecast *v, double many) {
    zt_forecast large = *v;
    double more = v->expected.is_random ? many : sqrt(many), least_s = zt_forecast_least_s(v);
    large.many = v->many / many;
    large.least = many * v->least;
    large.samples = large.least + more * (v->samples - v->least);
    large.all_s = pow(many, v->growth) * least_s + more * (v->all_s - least_s);
    for (int i = 0; i < ZT_EXPECT_COUNT; i++) large.expected.further[i] *= more;
    return large;
}

void zt_forecast_learn(zt_forecast *v, const zt_forecast *old) {
    double few = FEW * old->least, samples = fmax(v->samples - old->samples, 0);
    double expected = old->expected.further[v->error] - old->expected.further[old->error];
    v->times = (samples + few) / (expected + few);
    if (v->expected.is_random) v->times = fmax(v->times, 1);
    if (samples > FEW * old->samples)
        v->sample_s = fmax(v->sample_s, (v->all_s - old->all_s) / samples);
}
