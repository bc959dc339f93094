#include "keyframe/ease.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* ---- cubic-bezier --------------------------------------------------------------------------
 */

/* The handles and what they lack to 1, each without loss where it is small: where the curve
 * nearly stands still, only 1 - x1 and x2 decide. */
typedef struct handles {
    double x1, lack1, x2, lack2;
} handles;

/* The curve at s less x, in the form whose rounding errors are small beside the curve's speed:
 * near the begin as it stands, else as a polynomial in the distance from the middle, where the
 * fastest slowdown (x1 = 1, x2 = 0) is 4 r^3 and nothing cancels. */
static double beyond(const handles *h, double s, double x) {
    double t = 1 - s;
    if (s <= 0.25) return s * (3 * h->x1 * t * t + s * (3 * h->x2 * t + s)) - x;
    double r = s - 0.5;
    return 4 * r * r * r + 3 * s * t * (h->x2 * s - h->lack1 * t) - (x - 0.5);
}

static double speed(const handles *h, double s) {
    double t = 1 - s;
    return 3 * (h->x1 * t * t + 2 * (h->x2 - h->x1) * s * t + h->lack2 * s * s);
}

/* For x up to 1/2: Newton's method, halving the bracket where it would leave it. At a triple
 * root, its slowest, it still takes a third off the error each time. */
static double parameter(const handles *h, double x) {
    enum { STEPS_MAX = 128 };
    double low = 0, high = 1, s = x;
    for (int i = 0; i < STEPS_MAX; i++) {
        double error = beyond(h, s, x);
        if (error == 0) break;
        if (error < 0)
            low = s;
        else
            high = s;
        double next = s - error / speed(h, s);
        if (!(next > low && next < high)) next = low + (high - low) / 2;
        double step = fabs(next - s);
        s = next;
        if (step <= 0x1p-54) break;
    }
    return s;
}

double zt_ease_bezier_parameter(double x1, double x2, double x) {
    if (x <= 0.5) return parameter(&(handles){x1, 1 - x1, x2, 1 - x2}, x);
    return 1 - parameter(&(handles){1 - x2, x2, 1 - x1, x1}, 1 - x);
}

/* The slope at the begin of a curve with these control points, as "CSS Easing Functions Level
 * 1" has it; the end's is that of the curve turned round. */
static double first_slope(double x1, double y1, double x2, double y2) {
    if (x1 > 0) return y1 / x1;
    return y1 == 0 && x2 > 0 ? y2 / x2 : 0;
}

static double bezier(const zt_ease *ease, double u) {
    double x1 = ease->x1, y1 = ease->y1, x2 = ease->x2, y2 = ease->y2;
    if (u <= 0) return u * first_slope(x1, y1, x2, y2);
    if (u >= 1) return 1 + (u - 1) * first_slope(1 - x2, 1 - y2, 1 - x1, 1 - y1);
    double s = zt_ease_bezier_parameter(x1, x2, u), t = 1 - s;
    return s * (3 * y1 * t * t + s * (3 * y2 * t + s));
}

/* ---- steps and stops -----------------------------------------------------------------------
 */

static double steps(const zt_ease *ease, double u) {
    /* A frame on the edge of a step belongs to the later one, also where the rounding of its
     * time puts it a little before the edge. */
    const double tolerance = 1e-9;
    double count = ease->step_count, step = floor(u * count + tolerance), jumps = count;
    if (ease->jump == ZT_EASE_JUMP_START || ease->jump == ZT_EASE_JUMP_BOTH) step++;
    if (ease->jump == ZT_EASE_JUMP_NONE) jumps--;
    if (ease->jump == ZT_EASE_JUMP_BOTH) jumps++;
    return fmin(step, jumps) / jumps;
}

/* As "CSS Easing Functions Level 2" has it: of stops at the same time the last one counts at
 * that time; before the first and after the last stop their lines go on. */
static double stops(const zt_ease *ease, double u) {
    const zt_ease_stop *stop = ease->stops;
    int32_t low = -1, high = ease->stop_count;
    while (high - low > 1) {
        int32_t middle = low + (high - low) / 2;
        if (stop[middle].time <= u)
            low = middle;
        else
            high = middle;
    }
    if (low >= 0 && stop[low].time == u) return stop[low].way;
    if (ease->stop_count == 1) return stop[0].way;
    if (low < 0) low = 0;
    if (low == ease->stop_count - 1) low--;
    const zt_ease_stop *a = &stop[low], *b = a + 1;
    if (a->time == b->time) return b->way;
    return a->way + (b->way - a->way) * ((u - a->time) / (b->time - a->time));
}

/* ---- Penner's families ---------------------------------------------------------------------
 */

static double expo_in(double u) { return expm1(u * (10 * 0.69314718055994530942)) / 1023; }

static double bounce_out(double u) {
    static const double begin[] = {0, 6.0 / 11, 9.0 / 11, 21.0 / 22};
    static const double end[] = {4.0 / 11, 8.0 / 11, 10.0 / 11, 1};
    static const double lowest[] = {0, 3.0 / 4, 15.0 / 16, 63.0 / 64};
    int i = 0;
    while (i < 3 && u >= end[i]) i++;
    return 121.0 / 16 * (u - begin[i]) * (u - begin[i]) + lowest[i];
}

static double ease_in(const zt_ease *ease, double u) {
    switch (ease->kind) {
    case ZT_EASE_SINE: {
        double half = sin(u * (pi / 4));
        return 2 * half * half;
    }
    case ZT_EASE_QUAD:
        return u * u;
    case ZT_EASE_CUBIC:
        return u * u * u;
    case ZT_EASE_QUART:
        return u * u * u * u;
    case ZT_EASE_QUINT:
        return u * u * u * u * u;
    case ZT_EASE_EXPO:
        return expo_in(u);
    case ZT_EASE_CIRC:
        return u * u / (1 + sqrt((1 - u) * (1 + u)));
    case ZT_EASE_BACK:
        return u * u * ((ease->overshoot + 1) * u - ease->overshoot);
    case ZT_EASE_ELASTIC: {
        double phase = asin(1 / ease->amplitude) + (1 - u) * (2 * pi / ease->period);
        return ease->amplitude * expo_in(u) * sin(phase);
    }
    case ZT_EASE_BOUNCE:
        return 1 - bounce_out(1 - u);
    default:
        return u;
    }
}

double zt_ease_eval(const zt_ease *ease, double u) {
    if (ease->kind == ZT_EASE_STEPS) return steps(ease, u);
    if (ease->kind == ZT_EASE_STOPS) return stops(ease, u);
    if (ease->kind == ZT_EASE_BEZIER) return bezier(ease, u);
    if (u <= 0) return 0;
    if (u >= 1) return 1;
    switch (ease->way) {
    case ZT_EASE_IN:
        return ease_in(ease, u);
    case ZT_EASE_OUT:
        return 1 - ease_in(ease, 1 - u);
    case ZT_EASE_IN_OUT:
        return u < 0.5 ? ease_in(ease, 2 * u) / 2 : 1 - ease_in(ease, 2 - 2 * u) / 2;
    }
    return u;
}
