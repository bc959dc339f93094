/* Small things that are done to text. */
#ifndef ZT_BASE_TEXT_H
#define ZT_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* True where both texts are the same, letter for letter. */
bool zt_text_equal(const char *a, const char *b);
bool zt_text_ends_with(const char *text, const char *ending, bool ignore_case);

/* How many letters must be put in, left out, changed or swapped with their neighbour to make b
 * out of a (optimal string alignment: Damerau 1964, Levenshtein 1966). Texts longer than 63
 * letters are taken to be as far apart as the longer one is long. */
int zt_text_distance(const char *a, const char *b);

/* Remembers the nearest of the candidates shown to it. */
typedef struct zt_nearest {
    const char *wanted;
    const char *best; /* NULL while none is near enough: a third of the letters, at least one */
    int best_distance;
} zt_nearest;

zt_nearest zt_nearest_to(const char *wanted);
void zt_nearest_try(zt_nearest *nearest, const char *candidate);

/* Reads all of a number, as strtod in the C locale does but whatever locale is set; false where
 * `text` up to `end` is not wholly a finite decimal number. */
bool zt_text_number(double *value, const char *text, const char *end);

/* A new text by printf's rules, of the caller to free; NULL when out of memory. */
__attribute__((format(printf, 1, 2))) char *zt_text_print(const char *format, ...);

#endif
