/* What follows from a ladder, and the words for it: the same in the page, the chart and the
 * tables. */
#ifndef ZT_CLI_FINDINGS_H
#define ZT_CLI_FINDINGS_H

#include <zoetrope/zoetrope.h>

enum { ZT_ADVICE_COUNT = 6 };

/* For an error, what to use. */
typedef struct zt_advice {
    double rmse;
    int rung; /* -1: nothing on the ladder is known to be as good */
} zt_advice;

typedef struct zt_findings {
    const zt_ladder *ladder;
    const zt_animation *animation;
    const char *file; /* the description */
    const int64_t *frames;
    int frame_count;
    /* The rungs of even samples in the film's own precision and filter come first. */
    int even_count;
    int first_fitted, fitted_count;   /* of them, those that the slopes are fitted to */
    double slope_time, slope_samples; /* of error against either; NAN for too few */
    int knee;                         /* one of them, or -1 */
    zt_advice advice[ZT_ADVICE_COUNT];
    int best; /* of the advice: what is recommended first; -1 where there is none */
} zt_findings;

zt_findings zt_findings_of(const zt_ladder *ladder, const zt_animation *animation);

/* Short words, in a struct so that they can be handed on. */
typedef struct zt_words {
    char text[96];
} zt_words;

zt_words zt_words_of_rung(const zt_rung *rung);    /* "48 samples" */
zt_words zt_words_of_setting(const zt_rung *rung); /* "samples: 48", as in a description */
zt_words zt_words_of_time(double seconds);         /* "1.9 s", "3 min 20 s" */
zt_words zt_words_of_bytes(double bytes);          /* "12 MB" */
zt_words zt_words_of_error(const zt_findings *findings, const zt_rung *rung); /* its RMSE */

/* How long the whole film takes with a rung's setting, seconds. */
double zt_findings_film_s(const zt_findings *findings, const zt_rung *rung);

#endif
