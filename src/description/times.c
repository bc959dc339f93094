#include "description/times.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "description/fields.h"

/* Frames times the rate's denominator must fit 64 bits. */
#define MOMENT_MAX 1e9

#define FORMS "a time such as 1.5 s, 500 ms, 25 %, 00:00:02:12 or a frame's number"

/* The fields of "00:00:02:12"; false where the text is nothing like it. */
static bool split_timecode(int64_t fields[4], const char *text) {
    for (int i = 0; i < 4; i++) {
        size_t digits = strspn(text, "0123456789");
        if (digits < 1 || digits > 6 || text[digits] != (i < 3 ? ':' : '\0')) return false;
        fields[i] = strtol(text, NULL, 10);
        text += digits + 1;
    }
    return true;
}

static bool read_timecode(zt_moment *moment, zt_mistakes *mistakes, const zt_node *node,
                          const int64_t fields[4], zt_rate rate) {
    int64_t frames_per_s = ((int64_t)rate.num + rate.den - 1) / rate.den;
    zt_shown shown = zt_show(node->text);
    if (fields[1] > 59 || fields[2] > 59) {
        zt_mistake(mistakes, &node->place,
                   "\"%s\" has more than 59 minutes or seconds; it is hh:mm:ss:ff", shown.text);
        return false;
    }
    if (fields[3] >= frames_per_s) {
        zt_mistake(mistakes, &node->place,
                   "\"%s\" has the frame %d, and a second has only the frames 0 to %d",
                   shown.text, (int)fields[3], (int)frames_per_s - 1);
        return false;
    }
    int64_t seconds = (fields[0] * 60 + fields[1]) * 60 + fields[2];
    moment->unit = ZT_TIME_FRAMES;
    moment->frame = seconds * frames_per_s + fields[3];
    return true;
}

/* A number and its unit. */
static bool read_measure(zt_moment *moment, zt_mistakes *mistakes, const zt_node *node,
                         double number, const char *unit) {
    moment->number = zt_text_equal(unit, "ms") ? number / 1000 : number;
    if (fabs(moment->number) > MOMENT_MAX) {
        zt_mistake(mistakes, &node->place, "\"%s\" is further than any film goes",
                   zt_show(node->text).text);
        return false;
    }
    moment->unit = zt_text_equal(unit, "%") ? ZT_TIME_PERCENT
                   : *unit                  ? ZT_TIME_SECONDS
                                            : ZT_TIME_FRAMES;
    if (moment->unit != ZT_TIME_FRAMES) return true;
    moment->frame = (int64_t)number;
    if ((double)moment->frame == number) return true;
    zt_mistake(mistakes, &node->place, "\"%s\" is no whole frame; for seconds, write \"%s s\"",
               zt_show(node->text).text, zt_show(node->text).text);
    return false;
}

bool zt_read_moment(zt_moment *moment, zt_mistakes *mistakes, const zt_node *node,
                    const char *what, zt_rate rate) {
    static const char *const units[] = {"", "s", "ms", "%"};
    double number;
    const char *unit;
    int64_t fields[4];
    *moment = (zt_moment){0};
    if (node->kind == ZT_NODE_MISTAKE) return false;
    if (node->kind == ZT_NODE_TEXT && split_timecode(fields, node->text))
        return read_timecode(moment, mistakes, node, fields, rate);
    if (zt_read_quantity(&number, &unit, node))
        for (size_t i = 0; i < sizeof units / sizeof *units; i++)
            if (zt_text_equal(unit, units[i]))
                return read_measure(moment, mistakes, node, number, unit);
    if (what)
        zt_expected(mistakes, node, what, FORMS);
    else
        zt_mistake(mistakes, &node->place, "\"%s\" is not %s", zt_show(node->text).text, FORMS);
    return false;
}

bool zt_read_time(double *time_s, zt_mistakes *mistakes, const zt_node *node, const char *what,
                  const zt_film *film) {
    zt_moment moment;
    if (!zt_read_moment(&moment, mistakes, node, what, film->rate)) return false;
    zt_rate rate = film->rate;
    *time_s = moment.number;
    if (moment.unit == ZT_TIME_FRAMES) *time_s = zt_rate_time(rate, moment.frame);
    if (moment.unit == ZT_TIME_PERCENT) /* of the film, in one division as zt_rate_time */
        *time_s = moment.number * (double)(film->frame_count * rate.den) / (100.0 * rate.num);
    return true;
}

/* At most nine digits and their end, with at most one point among them, as digits / 10^places.
 */
static const char *decimal(int64_t *digits, int64_t *power, const char *text) {
    int digit_count = 0;
    bool point = false;
    *digits = 0;
    *power = 1;
    for (;; text++) {
        if (*text == '.' && !point) {
            point = true;
        } else if (isdigit((unsigned char)*text) && digit_count++ < 9) {
            *digits = 10 * *digits + (*text - '0');
            if (point) *power *= 10;
        } else {
            return text;
        }
    }
}

static int64_t common_divisor(int64_t a, int64_t b) { return b ? common_divisor(b, a % b) : a; }

static void warn_of_television(const zt_mistakes *mistakes, const zt_node *node, zt_rate rate) {
    double written = (double)rate.num / rate.den, whole = round(written * 1.001);
    double meant = whole / 1.001;
    if (rate.den == 1 || whole < 1 || fabs(written - meant) > 0.005) return;
    zt_tell_at(mistakes->listener, ZT_WARNING, &node->place,
               "%s is taken as %d/%d; the rate of television is %.0f/1001",
               zt_show(node->text).text, (int)rate.num, (int)rate.den, 1000 * whole);
}

bool zt_read_rate(zt_rate *rate, zt_mistakes *mistakes, const zt_node *node, const char *what) {
    int64_t num = 0, den = 0, num_power, den_power = 1;
    const char *end = NULL;
    bool fraction = false;
    if (node->kind == ZT_NODE_TEXT) {
        end = decimal(&num, &num_power, node->text);
        fraction = *end == '/';
        if (fraction && num_power == 1)
            end = decimal(&den, &den_power, end + 1);
        else
            den = num_power;
    }
    if (!end || *end || num <= 0 || den <= 0 || den_power != 1) {
        zt_expected(mistakes, node, what,
                    "a number of frames a second such as 24 or 30000/1001");
        return false;
    }
    int64_t divisor = common_divisor(num, den);
    *rate = (zt_rate){(int32_t)(num / divisor), (int32_t)(den / divisor)};
    if (!fraction) warn_of_television(mistakes, node, *rate);
    return true;
}
