#include "base/text.h"

#include <ctype.h>
#include <locale.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

enum { DISTANCE_MAX = 63, NUMBER_MAX = 400 };

bool zt_text_equal(const char *a, const char *b) { return strcmp(a, b) == 0; }

bool zt_text_ends_with(const char *text, const char *ending, bool ignore_case) {
    size_t text_length = strlen(text), ending_length = strlen(ending);
    if (ending_length > text_length) return false;
    for (const char *t = text + text_length - ending_length; *t; t++, ending++) {
        int a = (unsigned char)*t, b = (unsigned char)*ending;
        if (ignore_case ? tolower(a) != tolower(b) : a != b) return false;
    }
    return true;
}

static int min2(int a, int b) { return a < b ? a : b; }

int zt_text_distance(const char *a, const char *b) {
    int a_length = (int)strnlen(a, 1 << 20), b_length = (int)strnlen(b, 1 << 20);
    if (a_length > DISTANCE_MAX || b_length > DISTANCE_MAX)
        return a_length > b_length ? a_length : b_length;
    /* Three rows of the table of distances between beginnings: two back, one back, this one. */
    int rows[3][DISTANCE_MAX + 1];
    for (int j = 0; j <= b_length; j++) rows[0][j] = j;
    for (int i = 1; i <= a_length; i++) {
        int *row = rows[i % 3], *above = rows[(i + 2) % 3], *above2 = rows[(i + 1) % 3];
        row[0] = i;
        for (int j = 1; j <= b_length; j++) {
            int change = above[j - 1] + (a[i - 1] != b[j - 1]);
            row[j] = min2(change, 1 + min2(above[j], row[j - 1]));
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = min2(row[j], above2[j - 2] + 1);
        }
    }
    return rows[a_length % 3][b_length];
}

zt_nearest zt_nearest_to(const char *wanted) {
    int letters = (int)strnlen(wanted, DISTANCE_MAX);
    return (zt_nearest){.wanted = wanted, .best_distance = letters < 6 ? 2 : letters / 3 + 1};
}

void zt_nearest_try(zt_nearest *nearest, const char *candidate) {
    int distance = zt_text_distance(nearest->wanted, candidate);
    if (distance >= nearest->best_distance || distance >= (int)strlen(candidate)) return;
    nearest->best = candidate;
    nearest->best_distance = distance;
}

static once_flag c_locale_once = ONCE_FLAG_INIT;
static locale_t c_locale;
static void make_c_locale(void) { c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0); }

bool zt_text_number(double *value, const char *text, const char *end) {
    size_t length = (size_t)(end - text);
    if (length == 0 || length > NUMBER_MAX) return false;
    char copy[NUMBER_MAX + 1];
    memcpy(copy, text, length);
    copy[length] = '\0';
    /* strtod also takes hexadecimal, "inf", "nan" and blanks, which are no decimal numbers. */
    if (strspn(copy, "+-.0123456789eE") != length) return false;
    call_once(&c_locale_once, make_c_locale);
    if (!c_locale) return false;
    char *rest;
    double number = strtod_l(copy, &rest, c_locale);
    if (*rest || rest == copy || !isfinite(number)) return false;
    *value = number;
    return true;
}

char *zt_text_print(const char *format, ...) {
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    char *text = length < 0 ? NULL : malloc((size_t)length + 1);
    if (text) vsnprintf(text, (size_t)length + 1, format, again);
    va_end(again);
    va_end(arguments);
    return text;
}
