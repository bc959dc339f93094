#include "cli/plot.h"

#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/svg.h"
#include "cli/trace.h"

/* All in units of the drawing: pixels of a plain display. */
enum {
    WIDTH = 760,
    LEFT = 76, /* of the plot itself */
    RIGHT = 738,
    TOP = 38, /* of the plot below the top of its panel */
    PLOT_HEIGHT = 150,
    STRIP_HEIGHT = 10, /* of the colours below a plot */
    BELOW = 34,        /* for the numbers of the time axis */
    FOOT = 26,
    LEGEND_SLOT = 38,
    STRIP_STEPS = 64,
    MARKS_MAX = 20, /* numbers along an axis */
    DOTS_MAX = 500,
    FRAME_TICKS_MAX = 130
};

/* A panel on its way into the drawing. */
typedef struct panel {
    FILE *out;
    const zt_subject *subject;
    zt_trace trace;
    double first_s, last_s;
    zt_listener listener;
    double low, high; /* at the lower and the upper edge of the plot */
    double top;       /* of the plot */
} panel;

/* The colour of a channel. Those of rotations begin with w, so that x y z stay what they are.
 */
static const char *hue(const zt_subject *subject, int channel) {
    if (subject->channel_count == 1) return zt_svg_hues[2];
    return zt_svg_hues[subject->channel_count == 4 ? (channel + 3) % 4 : channel];
}

/* ---- numbers and words ---------------------------------------------------------------------
 */

/* 1, 2 or 5 times a power of ten, whichever is nearest to a `count`-th of the range. */
static double nice_step(double range, int count) {
    double raw = range / count, power = pow(10, floor(log10(raw))), share = raw / power;
    return power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
}

static double x_of(const panel *p, double time_s) {
    return LEFT + (RIGHT - LEFT) * ((time_s - p->first_s) / (p->last_s - p->first_s));
}

static double y_of(const panel *p, double value) {
    double share = (value / 2 - p->low / 2) / (p->high / 2 - p->low / 2);
    return p->top + PLOT_HEIGHT * (1 - share);
}

/* ---- axes ----------------------------------------------------------------------------------
 */

/* The range of the values and of the keys, a little wider; of what stands still, some range
 * around it. */
static void choose_range(panel *p) {
    for (int k = 0; k < p->subject->key_count; k++) {
        zt_subject_key key = zt_subject_key_at(p->subject, k);
        if (key.time_s < p->first_s || key.time_s > p->last_s) continue;
        for (int c = 0; c < p->subject->channel_count; c++) {
            p->trace.low = fmin(p->trace.low, key.value[c]);
            p->trace.high = fmax(p->trace.high, key.value[c]);
        }
    }
    double half = p->trace.high / 2 - p->trace.low / 2;
    double size = fmax(fabs(p->trace.low), fabs(p->trace.high));
    double air = half > 1e-9 * size ? 0.14 * half : size > 0 ? 0.25 * size : 1;
    p->low = fmax(p->trace.low - air, -1.7e308);
    p->high = fmin(p->trace.high + air, 1.7e308);
}

static void print_value_axis(const panel *p) {
    double step = nice_step((p->high / 2 - p->low / 2) * 2, 5);
    if (!isfinite(step) || !(step > 0)) step = p->high / 2 - p->low / 2;
    double begin = ceil(p->low / step), end = floor(p->high / step);
    for (int i = 0; i <= end - begin && i <= MARKS_MAX; i++) {
        bool zero = begin + i == 0;
        double value = zero ? 0 : (begin + i) * step, y = y_of(p, value);
        zt_svg_line(p->out, LEFT, y, RIGHT, y, zero ? "zero" : "grid");
        fprintf(p->out, "<text x=\"%d\" y=\"", LEFT - 8);
        zt_svg_number(p->out, y + 4);
        fprintf(p->out, "\" class=\"n end\">%.6g</text>\n", value);
    }
}

static void print_time_axis(const panel *p, double bottom) {
    const zt_film *film = zt_animation_film(p->subject->film);
    double step = nice_step(p->last_s - p->first_s, 8);
    double begin = ceil(p->first_s / step - 1e-9), end = floor(p->last_s / step + 1e-9);
    for (int i = 0; i <= end - begin && i <= MARKS_MAX; i++) {
        double time_s = begin + i == 0 ? 0 : (begin + i) * step, x = x_of(p, time_s);
        zt_svg_line(p->out, x, p->top, x, p->top + PLOT_HEIGHT, "grid");
        fputs("<text x=\"", p->out);
        zt_svg_number(p->out, x);
        fputs("\" y=\"", p->out);
        zt_svg_number(p->out, bottom + 18);
        fprintf(p->out, "\" class=\"n mid\">%.6g s</text>\n", time_s);
    }
    int64_t first = (int64_t)ceil(p->first_s * film->rate.num / film->rate.den - 1e-6);
    int64_t last = (int64_t)floor(p->last_s * film->rate.num / film->rate.den - 1e-6);
    if (last - first <= FRAME_TICKS_MAX) {
        fputs("<path class=\"tick\" d=\"", p->out);
        for (int64_t frame = first; frame <= last; frame++) {
            fputc('M', p->out);
            zt_svg_number(p->out, x_of(p, zt_rate_time(film->rate, frame)));
            fprintf(p->out, " %gv-4", p->top + PLOT_HEIGHT);
        }
        fputs("\"/>\n", p->out);
    }
    zt_svg_line(p->out, LEFT, p->top + PLOT_HEIGHT, RIGHT, p->top + PLOT_HEIGHT, "axis");
}

/* ---- lines and keys ------------------------------------------------------------------------
 */

/* The points that are needed to stay within a twentieth of a pixel of all: from each point
 * kept, on as long as one straight line passes all that were left out. */
static int next_kept(const panel *p, int channel, int from) {
    const double tolerance = 0.05;
    double x0 = x_of(p, zt_trace_time(&p->trace, from));
    double y0 = y_of(p, zt_trace_value(&p->trace, from, channel));
    double least = -INFINITY, most = INFINITY;
    int i = from + 1;
    for (; i < p->trace.count; i++) {
        double dx = x_of(p, zt_trace_time(&p->trace, i)) - x0;
        double dy = y_of(p, zt_trace_value(&p->trace, i, channel)) - y0;
        if (!(dx > 0.01)) return i > from + 1 ? i - 1 : i;
        double slope = dy / dx;
        if (slope < least || slope > most) return i - 1;
        least = fmax(least, (dy - tolerance) / dx);
        most = fmin(most, (dy + tolerance) / dx);
    }
    return i - 1;
}

static void print_channel(const panel *p, int channel) {
    fprintf(p->out, "<path class=\"line\" stroke=\"%s\" d=\"", hue(p->subject, channel));
    for (int i = 0, before = -1; i != before && i < p->trace.count;) {
        fputc(before < 0 ? 'M' : 'L', p->out);
        zt_svg_number(p->out, x_of(p, zt_trace_time(&p->trace, i)));
        fputc(' ', p->out);
        zt_svg_number(p->out, y_of(p, zt_trace_value(&p->trace, i, channel)));
        before = i;
        if (i + 1 < p->trace.count) i = next_kept(p, channel, i);
    }
    fputs("\"/>\n", p->out);
}

static void print_keys(const panel *p) {
    const zt_subject *subject = p->subject;
    int shown = 0;
    for (int k = 0; k < subject->key_count; k++) {
        double time_s = zt_subject_key_at(subject, k).time_s;
        shown += time_s >= p->first_s && time_s <= p->last_s;
    }
    if (shown > DOTS_MAX) return;
    for (int k = 0; k < subject->key_count; k++) {
        zt_subject_key key = zt_subject_key_at(subject, k);
        if (key.time_s < p->first_s || key.time_s > p->last_s) continue;
        for (int c = 0; c < subject->channel_count; c++) {
            if (key.value[c] < p->low || key.value[c] > p->high) continue;
            fputs("<circle cx=\"", p->out);
            zt_svg_number(p->out, x_of(p, key.time_s));
            fputs("\" cy=\"", p->out);
            zt_svg_number(p->out, y_of(p, key.value[c]));
            fprintf(p->out, "\" r=\"%s\" fill=\"%s\"/>\n", shown > 60 ? "2" : "3.5",
                    hue(subject, c));
        }
    }
}

/* What the numbers of a colour look like, below their plot. */
static zt_status print_strip(const panel *p, double top) {
    double step_s = (p->last_s - p->first_s) / STRIP_STEPS, value[ZT_SUBJECT_CHANNELS_MAX];
    zt_subject_words before = {""};
    fputs("<g shape-rendering=\"crispEdges\">\n", p->out);
    for (int i = 0; i < STRIP_STEPS; i++) {
        double time_s = p->first_s + (i + 0.5) * step_s;
        zt_status status = zt_subject_eval(value, p->subject, time_s, p->listener);
        if (status != ZT_OK) return status;
        zt_subject_words words = zt_subject_in_words(p->subject, value);
        if (strcmp(words.text, before.text) == 0) continue;
        before = words;
        double x = x_of(p, p->first_s + i * step_s);
        fputs("<rect x=\"", p->out);
        zt_svg_number(p->out, x);
        fprintf(p->out, "\" y=\"%g\" width=\"", top);
        zt_svg_number(p->out, RIGHT - x); /* the next one covers the rest */
        fprintf(p->out, "\" height=\"%d\" fill=\"%s\"/>\n", STRIP_HEIGHT, words.text);
    }
    fprintf(p->out, "</g>\n<path class=\"tick\" d=\"M%d %gh%dv%dh-%dz\"/>\n", LEFT, top,
            RIGHT - LEFT, STRIP_HEIGHT, RIGHT - LEFT);
    return ZT_OK;
}

/* ---- all of it -----------------------------------------------------------------------------
 */

static void print_title(const panel *p, double panel_top) {
    const zt_subject *subject = p->subject;
    int legend = subject->channel_count > 1 ? subject->channel_count * LEGEND_SLOT : 0;
    int letters = (RIGHT - LEFT - legend - 240) / 9;
    fprintf(p->out, "<text x=\"%d\" y=\"%g\" class=\"title\">", LEFT, panel_top + 25);
    zt_svg_words(p->out, subject->name, letters > 12 ? letters : 12);
    fputs("<tspan class=\"n\" dx=\"10\">", p->out);
    zt_subject_key key = {.ease = ""};
    if (subject->key_count > 0) key = zt_subject_key_at(subject, 0);
    bool eased = strcmp(subject->driver, "eased") == 0; /* by one easing for all */
    zt_svg_words(p->out, eased ? key.ease : subject->driver, 32);
    if (subject->key_count > 0)
        fprintf(p->out, ", %d key%s", subject->key_count, subject->key_count == 1 ? "" : "s");
    if (*subject->unit) fprintf(p->out, ", in %s", subject->unit);
    fputs("</tspan></text>\n", p->out);
    for (int c = 0; legend && c < subject->channel_count; c++) {
        int x = RIGHT - legend + c * LEGEND_SLOT + 6;
        fprintf(p->out,
                "<path class=\"line\" stroke=\"%s\" d=\"M%d %gh14\"/>"
                "<text x=\"%d\" y=\"%g\" class=\"n\">%s</text>\n",
                hue(subject, c), x, panel_top + 21, x + 18, panel_top + 25,
                subject->channels[c]);
    }
}

static int panel_height(const zt_subject *subject) {
    return TOP + PLOT_HEIGHT + (subject->is_color ? STRIP_HEIGHT : 0) + BELOW;
}

static zt_status print_panel(panel *p, double top) {
    const zt_subject *subject = p->subject;
    p->top = top + TOP;
    choose_range(p);
    double bottom = p->top + PLOT_HEIGHT + (subject->is_color ? STRIP_HEIGHT : 0);
    print_title(p, top);
    print_value_axis(p);
    print_time_axis(p, bottom);
    for (int c = 0; c < subject->channel_count; c++) print_channel(p, c);
    print_keys(p);
    return subject->is_color ? print_strip(p, p->top + PLOT_HEIGHT) : ZT_OK;
}

static void print_foot(FILE *out, const zt_film *film, int64_t first, int64_t last,
                       int height) {
    char rate[40];
    if (film->rate.den == 1)
        snprintf(rate, sizeof rate, "%d", film->rate.num);
    else
        snprintf(rate, sizeof rate, "%d/%d", film->rate.num, film->rate.den);
    fprintf(out,
            "<text x=\"%d\" y=\"%d\" class=\"n\">frames %" PRId64 " to %" PRId64
            ", %s a second%s; dots are keys</text>\n</svg>\n",
            LEFT, height - 12, first, last, rate,
            last - first <= FRAME_TICKS_MAX ? ", a tick each" : "");
}

static zt_status draw(FILE *out, const zt_subject *subjects, int count, int64_t first,
                      int64_t last, zt_listener listener) {
    const zt_film *film = zt_animation_film(subjects->film);
    int height = FOOT, top = 0;
    for (int i = 0; i < count; i++) height += panel_height(&subjects[i]);
    zt_svg_begin(out, WIDTH, height);
    zt_status status = ZT_OK;
    for (int i = 0; i < count && status == ZT_OK; i++) {
        panel p = {.out = out,
                   .subject = &subjects[i],
                   .listener = listener,
                   .first_s = zt_rate_time(film->rate, first),
                   .last_s = zt_rate_time(film->rate, last + 1)};
        double pixel_s = (p.last_s - p.first_s) / (RIGHT - LEFT);
        zt_trace_grain grain = {pixel_s / 64, 0.05 / PLOT_HEIGHT};
        status = zt_trace_make(&p.trace, p.subject, p.first_s, p.last_s, grain, listener);
        if (status == ZT_OK) status = print_panel(&p, top);
        zt_trace_free(&p.trace);
        top += panel_height(&subjects[i]);
    }
    print_foot(out, film, first, last, height);
    return status;
}

zt_status zt_plot_draw(char **svg, size_t *length, const zt_subject *subjects, int count,
                       int64_t first, int64_t last, zt_listener listener) {
    *svg = NULL;
    FILE *out = open_memstream(svg, length);
    if (!out) return ZT_EMEMORY;
    zt_status status = draw(out, subjects, count, first, last, listener);
    if (fclose(out) != 0 && status == ZT_OK) status = ZT_EMEMORY;
    if (status == ZT_OK) return ZT_OK;
    free(*svg);
    *svg = NULL;
    return status;
}
