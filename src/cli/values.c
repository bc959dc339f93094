/* Single values of options. */
#include "cli/values.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PARTS_MAX = 1000000 };
static const int64_t frame_max = INT64_C(1) << 40;

bool zt_value_digits(int64_t *number, const char **text, int64_t max) {
    const char *c = *text;
    for (*number = 0; *c >= '0' && *c <= '9'; c++) {
        *number = *number * 10 + (*c - '0');
        if (*number > max) return false;
    }
    bool some = c > *text;
    *text = c;
    return some;
}

bool zt_value_count(int *count, zt_option option, const char *text, int max,
                    zt_report *report) {
    const char *rest = text;
    int64_t number = 0;
    bool good = zt_value_digits(&number, &rest, max) && !*rest && number > 0;
    if (!good)
        zt_report_say(report, ZT_ERROR, "--%s %s: must be a number from 1 to %d",
                      zt_options_known[option].name, text, max);
    *count = (int)number;
    return good;
}

bool zt_value_size(zt_render_settings *settings, const char *text, zt_report *report) {
    const char *rest = text;
    int64_t width = 0, height = 0;
    bool good = zt_value_digits(&width, &rest, ZT_IMAGE_SIDE_MAX) && *rest++ == 'x' &&
                zt_value_digits(&height, &rest, ZT_IMAGE_SIDE_MAX) && !*rest && width > 0 &&
                height > 0;
    if (!good)
        zt_report_say(report, ZT_ERROR,
                      "--size %s: must be width and height, such as 640x360, each from 1 to %d",
                      text, ZT_IMAGE_SIDE_MAX);
    settings->width = (int)width;
    settings->height = (int)height;
    return good;
}

bool zt_value_precision(zt_render_settings *settings, const char *text, zt_report *report) {
    for (int i = ZT_PRECISION_AUTO; i <= ZT_PRECISION_DOUBLE; i++) {
        if (strcmp(text, zt_precision_name((zt_precision)i)) != 0) continue;
        settings->precision = (zt_precision)i;
        return true;
    }
    zt_report_say(report, ZT_ERROR, "--precision %s: must be single, double or auto", text);
    return false;
}

bool zt_value_aovs(unsigned *aovs, const char *text, zt_report *report) {
    for (const char *name = text; name; name = strchr(name, ',')) {
        char single[32];
        unsigned found;
        name += *name == ',';
        snprintf(single, sizeof single, "%.*s", (int)strcspn(name, ","), name);
        if (!zt_aov_find(&found, single)) {
            zt_report_say(report, ZT_ERROR, "--aovs %s: there is no \"%s\"; there are %s", text,
                          single, zt_aov_names());
            return false;
        }
        *aovs |= found;
    }
    return true;
}

bool zt_value_view(const char *text, zt_report *report) {
    char names[128] = "";
    for (int v = 0; v < ZT_VIEW_COUNT; v++) {
        const char *name = zt_view_name((zt_view)v);
        size_t used = strlen(names);
        if (strcmp(text, name) == 0) return true;
        snprintf(names + used, sizeof names - used, "%s%s", v ? ", " : "", name);
    }
    zt_report_say(report, ZT_ERROR, "--view %s: there are %s", text, names);
    return false;
}

typedef struct unit {
    const char *name;
    double of;
} unit;

/* A number and one of the units, which end with one without a name, maybe with blanks between
 * the two. */
static bool read_quantity(double *quantity, const char *text, const unit *units) {
    size_t length = strspn(text, "0123456789.");
    char *end;
    double number = strtod(text, &end);
    const char *name = text + length + strspn(text + length, " ");
    if (length == 0 || end != text + length) return false;
    while (units->name && strcmp(name, units->name) != 0) units++;
    *quantity = number * units->of;
    return units->name;
}

bool zt_value_duration(double *seconds, zt_option option, const char *text, zt_report *report) {
    static const unit units[] = {{"ms", 1e-3}, {"s", 1}, {"min", 60}, {"h", 3600}, {NULL, 0}};
    if (read_quantity(seconds, text, units) && *seconds > 0 && *seconds < 1e10) return true;
    zt_report_say(report, ZT_ERROR,
                  "--%s %s: must be a time, such as 500 ms, 2 s, 20 min or 8 h",
                  zt_options_known[option].name, text);
    return false;
}

bool zt_value_bytes(int64_t *bytes, zt_option option, const char *text, zt_report *report) {
    static const unit units[] = {{"MB", 1e6}, {"GB", 1e9}, {"TB", 1e12}, {NULL, 0}};
    double number = 0;
    bool good = strcmp(text, "0") == 0 ||
                (read_quantity(&number, text, units) && number >= 0 && number < 1e15);
    if (!good)
        zt_report_say(report, ZT_ERROR,
                      "--%s %s: must be so many bytes, such as 500 MB or 2GB, or 0",
                      zt_options_known[option].name, text);
    *bytes = good ? (int64_t)number : 0;
    return good;
}

/* Two whole numbers up to `most`, and nothing but the mark between them. */
static bool read_pair(int64_t *one, int64_t *other, const char *text, char mark, int64_t most) {
    const char *rest = text;
    return zt_value_digits(one, &rest, most) && *rest++ == mark &&
           zt_value_digits(other, &rest, most) && !*rest;
}

bool zt_value_pixel(int *column, int *row, const char *text, zt_report *report) {
    int64_t x = 0, y = 0;
    bool good = read_pair(&x, &y, text, ',', ZT_IMAGE_SIDE_MAX - 1);
    if (!good)
        zt_report_say(
            report, ZT_ERROR,
            "--pixel %s: must be column and row, counted from 0 at the top left, such "
            "as 200,120",
            text);
    *column = (int)x;
    *row = (int)y;
    return good;
}

bool zt_value_sample(int *sample, const char *text, zt_report *report) {
    const char *rest = text;
    int64_t number = 0;
    bool good = zt_value_digits(&number, &rest, ZT_SAMPLES_MAX - 1) && !*rest;
    if (!good)
        zt_report_say(report, ZT_ERROR, "--sample %s: must be a number from 0 to %d", text,
                      ZT_SAMPLES_MAX - 1);
    *sample = (int)number;
    return good;
}

bool zt_value_range(int64_t *first, int64_t *last, const char *text) {
    const char *rest = text;
    bool good = zt_value_digits(first, &rest, frame_max);
    *last = *first;
    if (good && *rest == '-') {
        rest++;
        good = zt_value_digits(last, &rest, frame_max);
    }
    return good && !*rest && *first <= *last;
}

bool zt_value_part(int64_t *part, int64_t *count, const char *text, zt_report *report) {
    bool good = read_pair(part, count, text, '/', PARTS_MAX) && *part >= 1 && *part <= *count;
    if (!good)
        zt_report_say(report, ZT_ERROR,
                      "--chunk %s: must be a part and how many there are, such as 3/8; the "
                      "first is 1",
                      text);
    return good;
}

bool zt_value_rate(zt_rate *rate, const char *text, zt_report *report) {
    const char *rest = text;
    int64_t num = 0, den = 1;
    bool good = zt_value_digits(&num, &rest, INT32_MAX);
    if (good && *rest == '/') {
        rest++;
        good = zt_value_digits(&den, &rest, INT32_MAX);
    }
    good = good && !*rest && num > 0 && den > 0;
    if (!good)
        zt_report_say(report, ZT_ERROR,
                      "--rate %s: must be frames a second, such as 24 or 30000/1001", text);
    *rate = (zt_rate){(int32_t)num, (int32_t)den};
    return good;
}

bool zt_value_samples(int64_t *min, int64_t *max, const char *text, const char *error,
                      zt_report *report) {
    const char *rest = text;
    bool good = zt_value_digits(max, &rest, ZT_SAMPLES_MAX) && *max > 0;
    *min = 0;
    if (good && *rest == '-') {
        *min = *max;
        rest++;
        good = *min > 0 && zt_value_digits(max, &rest, ZT_SAMPLES_MAX) && *min <= *max;
    }
    good = good && !*rest;
    if (!good)
        zt_report_say(report, ZT_ERROR,
                      "--samples %s: must be a number from 1 to %d, or a range, such as 4-64",
                      text, ZT_SAMPLES_MAX);
    else if (*min && !error)
        zt_report_say(report, ZT_ERROR, "--samples %s needs --error, such as --error=0.002",
                      text);
    return good && (!*min || error);
}
