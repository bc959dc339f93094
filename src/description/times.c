#include "description/times.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "description/fields.h"

/* Frames times the rate's denominator must fit 64 bits. */
#define MOMENT_MAX 1e9

#define FORMS "a time such as 1.5 s, 500 ms or a frame's number"

bool zt_read_moment(zt_moment *moment, zt_mistakes *mistakes, const zt_node *node,
                    const char *what) {
    double number;
    const char *unit;
    bool is_number = zt_read_quantity(&number, &unit, node);
    bool seconds = is_number && zt_text_equal(unit, "s");
    bool milliseconds = is_number && zt_text_equal(unit, "ms");
    if (!seconds && !milliseconds && (!is_number || *unit)) {
        if (what)
            zt_expected(mistakes, node, what, FORMS);
        else
            zt_mistake(mistakes, &node->place, "\"%s\" is not " FORMS,
                       zt_show(node->text).text);
        return false;
    }
    *moment = (zt_moment){.is_frame = !*unit, .seconds = milliseconds ? number / 1000 : number};
    if (fabs(moment->seconds) > MOMENT_MAX) {
        zt_mistake(mistakes, &node->place, "\"%s\" is further than any film goes",
                   zt_show(node->text).text);
        return false;
    }
    if (!moment->is_frame) return true;
    moment->frame = (int64_t)number;
    if ((double)moment->frame == number) return true;
    zt_mistake(mistakes, &node->place, "\"%s\" is no whole frame; for seconds, write \"%s s\"",
               zt_show(node->text).text, zt_show(node->text).text);
    return false;
}

double zt_moment_s(zt_moment moment, zt_rate rate) {
    return moment.is_frame ? zt_rate_time(rate, moment.frame) : moment.seconds;
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
