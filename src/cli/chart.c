#include "cli/chart.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/svg.h"

enum { TOP = 46, BELOW = 44, ROW = 17, WIDE = 560, SERIES_MAX = 16 };

/* Rungs of one kind. */
typedef struct series {
    char name[48];
    const char *hue;
    const zt_rung *rungs;
    int count;
} series;

typedef struct chart {
    FILE *out;
    const zt_findings *f;
    series series[SERIES_MAX];
    int series_count;
    int width, height;
    double left, right, top, bottom; /* of the plot */
    double low[2], high[2];          /* logarithms at its edges: of time, of error */
} chart;

/* ---- what is shown -------------------------------------------------------------------------
 */

static void name_series(series *s, const zt_rung *rung, const zt_rung *first) {
    const char *precision = zt_precision_name(rung->precision);
    if (rung->kind == ZT_RUNG_ADAPTIVE)
        snprintf(s->name, sizeof s->name, "adaptive");
    else if (rung->kind == ZT_RUNG_EDGES)
        snprintf(s->name, sizeof s->name, "edges");
    else if (rung->reference > 0)
        snprintf(s->name, sizeof s->name, "%s filter", zt_filter_name(rung->sampling.filter));
    else if (rung == first)
        snprintf(s->name, sizeof s->name, "even samples");
    else
        snprintf(s->name, sizeof s->name, "%s precision", precision);
}

static bool same_series(const zt_rung *a, const zt_rung *b) {
    return a->kind == b->kind && a->other_precision == b->other_precision &&
           a->reference == b->reference;
}

static void collect(chart *c) {
    const zt_ladder *ladder = c->f->ladder;
    static const int order[] = {2, 0, 1, 5, 3, 4, 7, 6, 8};
    for (int i = 0; i < ladder->rung_count && c->series_count < SERIES_MAX;) {
        series *s = &c->series[c->series_count];
        s->rungs = &ladder->rungs[i];
        s->hue = zt_svg_hues[order[c->series_count++ % ZT_SVG_HUE_COUNT]];
        name_series(s, s->rungs, ladder->rungs);
        while (i < ladder->rung_count && same_series(&ladder->rungs[i], s->rungs))
            s->count++, i++;
    }
}

/* The range of all points, and of the reference's error where that is not far below. */
static void choose_range(chart *c) {
    const zt_ladder *ladder = c->f->ladder;
    for (int axis = 0; axis < 2; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (int i = 0; i < ladder->rung_count; i++) {
            const zt_rung *rung = &ladder->rungs[i];
            double value = axis == 0 ? rung->frame_s : rung->error.rmse;
            if (!(value > 0)) continue;
            low = fmin(low, log10(value));
            high = fmax(high, log10(value));
        }
        if (!(low <= high)) low = high = -3;
        double floor = ladder->references[0].error;
        if (axis == 1 && floor > 0) low = fmin(low, fmax(log10(floor), low - 1));
        double air = fmax(0.08 * (high - low), 0.1);
        c->low[axis] = low - air * (axis == 1 ? 1.6 : 1);
        c->high[axis] = high + air;
    }
}

static double x_of(const chart *c, double time_s) {
    double share = (log10(time_s) - c->low[0]) / (c->high[0] - c->low[0]);
    return c->left + (c->right - c->left) * share;
}

static double y_of(const chart *c, double error) {
    double share = (log10(error) - c->low[1]) / (c->high[1] - c->low[1]);
    return c->bottom - (c->bottom - c->top) * share;
}

/* ---- pieces --------------------------------------------------------------------------------
 */

static void print_text(const chart *c, double x, double y, const char *class,
                       const char *text) {
    fputs("<text x=\"", c->out);
    zt_svg_number(c->out, x);
    fputs("\" y=\"", c->out);
    zt_svg_number(c->out, y);
    fprintf(c->out, "\" class=\"%s\">", class);
    zt_svg_words(c->out, text, 200);
    fputs("</text>\n", c->out);
}

/* A number where its name has room: all of 1, 2 and 5, or powers of ten alone. */
static bool is_named(const chart *c, int axis, int digit) {
    double decades = c->high[axis] - c->low[axis];
    double room = (axis == 0 ? c->right - c->left : 2 * (c->bottom - c->top)) / decades;
    return digit == 1 || ((digit == 2 || digit == 5) && room > 120);
}

static void print_axis(const chart *c, int axis) {
    for (int power = (int)floor(c->low[axis]); power <= c->high[axis]; power++)
        for (int digit = 1; digit < 10; digit++) {
            double value = digit * pow(10, power);
            if (log10(value) < c->low[axis] || log10(value) > c->high[axis]) continue;
            const char *class = digit == 1 ? "zero" : "grid";
            char text[32];
            snprintf(text, sizeof text, "%.4g", value);
            if (axis == 0) {
                double x = x_of(c, value);
                zt_svg_line(c->out, x, c->top, x, c->bottom, class);
                if (is_named(c, axis, digit))
                    print_text(c, x, c->bottom + 16, "n mid", zt_words_of_time(value).text);
            } else {
                double y = y_of(c, value);
                zt_svg_line(c->out, c->left, y, c->right, y, class);
                if (is_named(c, axis, digit)) print_text(c, c->left - 7, y + 4, "n end", text);
            }
        }
}

/* Where nothing is claimed: below what the reference itself is wrong by. */
static void print_floor(const chart *c) {
    double floor = c->f->ladder->references[0].error;
    if (!(floor > 0) || log10(floor) < c->low[1]) return;
    double y = y_of(c, floor);
    fprintf(c->out, "<rect x=\"%g\" y=\"", c->left);
    zt_svg_number(c->out, y);
    fprintf(c->out, "\" width=\"%g\" height=\"", c->right - c->left);
    zt_svg_number(c->out, c->bottom - y);
    fputs("\" fill=\"#f3eee8\"/>\n", c->out);
    char text[80];
    snprintf(text, sizeof text, "below the reference's own error, %.2g", floor);
    print_text(c, c->left + 8, fmin(y + 14, c->bottom - 4), "n", text);
}

static void print_power(const chart *c, double x, double y, double slope, double to_x,
                        const char *style) {
    double to_y = y * pow(to_x / x, slope);
    fputs("<path d=\"M", c->out);
    zt_svg_number(c->out, x_of(c, x));
    fputc(' ', c->out);
    zt_svg_number(c->out, y_of(c, y));
    fputc('L', c->out);
    zt_svg_number(c->out, x_of(c, to_x));
    fputc(' ', c->out);
    zt_svg_number(c->out, y_of(c, to_y));
    fprintf(c->out, "\" %s/>\n", style);
}

/* The fitted line, and beside it how white noise would fall from the same beginning. */
static void print_fit(const chart *c) {
    const zt_findings *f = c->f;
    if (!isfinite(f->slope_time)) return;
    const zt_rung *rungs = f->ladder->rungs + f->first_fitted;
    int last = f->fitted_count - 1;
    double x = 0, y = 0;
    for (int i = 0; i <= last; i++) {
        x += log(rungs[i].frame_s) / f->fitted_count;
        y += log(rungs[i].error.rmse) / f->fitted_count;
    }
    double begin = rungs[0].frame_s, end = rungs[last].frame_s;
    double at_begin = exp(y + f->slope_time * (log(begin) - x));
    print_power(c, begin, at_begin, f->slope_time, end,
                "stroke=\"#1f2328\" stroke-width=\"1\" stroke-dasharray=\"5 4\"");
    print_power(c, begin, at_begin, -0.5, end,
                "stroke=\"#8b949e\" stroke-width=\"1\" stroke-dasharray=\"1.5 3\"");
}

static void print_series(const chart *c, const series *s) {
    fprintf(c->out, "<path class=\"line\" stroke=\"%s\" d=\"", s->hue);
    for (int i = 0, begun = 0; i < s->count; i++) {
        if (!(s->rungs[i].error.rmse > 0)) continue;
        fputc(begun++ ? 'L' : 'M', c->out);
        zt_svg_number(c->out, x_of(c, s->rungs[i].frame_s));
        fputc(' ', c->out);
        zt_svg_number(c->out, y_of(c, s->rungs[i].error.rmse));
    }
    fputs("\"/>\n", c->out);
    for (int i = 0; i < s->count; i++) {
        const zt_rung *rung = &s->rungs[i];
        if (!(rung->error.rmse > 0)) continue;
        bool known = zt_ladder_knows(c->f->ladder, rung);
        fputs("<circle cx=\"", c->out);
        zt_svg_number(c->out, x_of(c, rung->frame_s));
        fputs("\" cy=\"", c->out);
        zt_svg_number(c->out, y_of(c, rung->error.rmse));
        fprintf(c->out, "\" r=\"3.6\" fill=\"%s\" style=\"stroke:%s\"><title>",
                known ? s->hue : "#fff", known ? "#fff" : s->hue);
        zt_svg_words(c->out, zt_words_of_rung(rung).text, 90);
        fprintf(c->out, ": RMSE %s, %s a frame</title></circle>\n",
                zt_words_of_error(c->f, rung).text, zt_words_of_time(rung->frame_s).text);
    }
}

/* How many samples, at those rungs of even samples that are powers of four. */
static void print_counts(const chart *c) {
    for (int i = 0; i < c->f->even_count; i++) {
        const zt_rung *rung = &c->f->ladder->rungs[i];
        int samples = rung->sampling.max;
        bool power = (samples & (samples - 1)) == 0 && (samples & 0x55555555) != 0;
        if (!power || !(rung->error.rmse > 0)) continue;
        char text[16];
        snprintf(text, sizeof text, "%d", samples);
        print_text(c, x_of(c, rung->frame_s) + 6, y_of(c, rung->error.rmse) - 6, "n", text);
    }
}

static void print_knee(const chart *c) {
    if (c->f->knee < 0) return;
    const zt_rung *rung = &c->f->ladder->rungs[c->f->knee];
    double x = x_of(c, rung->frame_s), y = y_of(c, rung->error.rmse);
    fputs("<circle cx=\"", c->out);
    zt_svg_number(c->out, x);
    fputs("\" cy=\"", c->out);
    zt_svg_number(c->out, y);
    fputs("\" r=\"8\" fill=\"none\" style=\"stroke:#1f2328;stroke-width:1.5\"/>\n", c->out);
    char text[128];
    snprintf(text, sizeof text, "knee: %s", zt_words_of_rung(rung).text);
    bool room = y + 26 < c->bottom;
    print_text(c, fmax(x - 10, c->left + 60), room ? y + 24 : y - 16, "n end", text);
}

/* Names of the series, in as many rows as they need; returns how many. Without `print`, only
 * counts. */
static int legend(const chart *c, bool print) {
    char fit[64] = "";
    if (isfinite(c->f->slope_time))
        snprintf(fit, sizeof fit, "fitted: slope %s%.2f", c->f->slope_time < 0 ? "−" : "",
                 fabs(c->f->slope_time));
    double x = c->left;
    int row = 0, entries = c->series_count + (*fit ? 2 : 0);
    for (int i = 0; i < entries; i++) {
        const char *name = i < c->series_count    ? c->series[i].name
                           : i == c->series_count ? fit
                                                  : "white noise: −0.5";
        double width = 24 + 6.7 * zt_svg_letter_count(name) + 16;
        if (x + width > c->right + 16 && x > c->left) x = c->left, row++;
        double y = TOP + ROW * row;
        if (print) {
            fputs("<path class=\"line\" d=\"M", c->out);
            zt_svg_number(c->out, x);
            fprintf(c->out, " %gh16\" %s%s%s/>\n", y - 4,
                    i < c->series_count ? "stroke=\""
                                        : "stroke-width=\"1\" stroke=\"#1f2328\" ",
                    i < c->series_count ? c->series[i].hue : "",
                    i < c->series_count    ? "\""
                    : i == c->series_count ? "stroke-dasharray=\"5 4\""
                                           : "stroke-dasharray=\"1.5 3\"");
            print_text(c, x + 21, y, "n", name);
        }
        x += width;
    }
    return row + 1;
}

/* ---- all of it -----------------------------------------------------------------------------
 */

static void print_titles(const chart *c) {
    print_text(c, c->left, 22, "title", "Error against run time");
    print_text(c, (c->left + c->right) / 2, c->height - 8, "n mid",
               c->width < WIDE ? "time a frame" : "time a frame: freeze, prepare, render");
    fprintf(c->out,
            "<text class=\"n mid\" transform=\"translate(13 %g) rotate(-90)\">RMSE of "
            "linear light</text>\n",
            (c->top + c->bottom) / 2);
}

static void draw(chart *c) {
    collect(c);
    choose_range(c);
    c->left = 62;
    c->right = c->width - 18;
    int rows = legend(c, false);
    c->top = TOP + ROW * rows - 4;
    c->bottom = c->top + fmin(380, fmax(0.62 * (c->right - c->left), 240));
    c->height = (int)c->bottom + BELOW;
    zt_svg_begin(c->out, c->width, c->height);
    print_titles(c);
    legend(c, true);
    print_axis(c, 0);
    print_axis(c, 1);
    print_floor(c);
    zt_svg_line(c->out, c->left, c->bottom, c->right, c->bottom, "axis");
    print_fit(c);
    for (int i = c->series_count - 1; i >= 0; i--) print_series(c, &c->series[i]);
    print_counts(c);
    print_knee(c);
    fputs("</svg>\n", c->out);
}

zt_status zt_chart_draw(char **svg, size_t *length, const zt_findings *findings, int width) {
    chart c = {.out = open_memstream(svg, length), .f = findings, .width = width};
    if (!c.out) return ZT_EMEMORY;
    draw(&c);
    if (fclose(c.out) == 0) return ZT_OK;
    free(*svg);
    *svg = NULL;
    return ZT_EMEMORY;
}
