/* The command line: what the values of options mean. Each reader returns whether the text is
 * such a value, and tells where it is not. */
#ifndef ZT_CLI_VALUES_H
#define ZT_CLI_VALUES_H

#include <stdbool.h>
#include <stdint.h>

#include <zoetrope/zoetrope.h>

#include "cli/commands.h"
#include "cli/report.h"

/* How many samples a pixel may be told to take. */
enum { ZT_SAMPLES_MAX = 65536 };

/* Reads decimal digits and moves `text` behind them; false without any, or beyond `max`; tells
 * nothing. */
bool zt_value_digits(int64_t *number, const char **text, int64_t max);

/* "10-40", or "7" alone; tells nothing. */
bool zt_value_range(int64_t *first, int64_t *last, const char *text);

/* 1 to max. */
bool zt_value_count(int *count, zt_option option, const char *text, int max, zt_report *report);

/* "640x360". */
bool zt_value_size(zt_render_settings *settings, const char *text, zt_report *report);

/* "double". */
bool zt_value_precision(zt_render_settings *settings, const char *text, zt_report *report);

/* "Z,N": bits of zt_aov. */
bool zt_value_aovs(unsigned *aovs, const char *text, zt_report *report);

/* "filmic". */
bool zt_value_view(const char *text, zt_report *report);

/* "2 s", "1.5 min": seconds. */
bool zt_value_duration(double *seconds, zt_option option, const char *text, zt_report *report);

/* "2GB", "500 MB", "0": bytes. */
bool zt_value_bytes(int64_t *bytes, zt_option option, const char *text, zt_report *report);

/* "200,120": column and row. */
bool zt_value_pixel(int *column, int *row, const char *text, zt_report *report);

/* The number of a pixel's sample, from 0. */
bool zt_value_sample(int *sample, const char *text, zt_report *report);

/* "64", or "4-64" where an error is given as well; else `min` is 0. */
bool zt_value_samples(int64_t *min, int64_t *max, const char *text, const char *error,
                      zt_report *report);

/* "3/8": 1 <= part <= count. */
bool zt_value_part(int64_t *part, int64_t *count, const char *text, zt_report *report);

/* "24", "30000/1001". */
bool zt_value_rate(zt_rate *rate, const char *text, zt_report *report);

#endif
