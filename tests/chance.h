/* What may be asked of numbers that are drawn: statistics with a stated chance of failing where
 * all is right. */
#ifndef ZT_TESTS_CHANCE_H
#define ZT_TESTS_CHANCE_H

#include <math.h>

/* What a chi-square statistic of perfect samples stays below, but for a chance of so many
 * standard deviations (E. B. Wilson and M. M. Hilferty, "The distribution of chi-square",
 * 1931). */
static inline double chi_square_limit(int freedom, double deviations) {
    double share = 2.0 / (9.0 * freedom), root = 1 - share + deviations * sqrt(share);
    return freedom * root * root * root;
}

static inline double chi_square(const int *counts, int cell_count, double expected) {
    double sum = 0;
    for (int i = 0; i < cell_count; i++)
        sum += (counts[i] - expected) * (counts[i] - expected) / expected;
    return sum;
}

#endif
