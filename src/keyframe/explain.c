#include "keyframe/explain.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "keyframe/rotation.h"
#include "keyframe/velocity.h"

static const char *const axes[] = {"x", "y", "z"};
static const double degrees = 180 / 3.14159265358979323846;

/* ---- times ---------------------------------------------------------------------------------
 */

/* "hh:mm:ss:ff" at a rate; false where it is none. */
static bool read_timecode(double *time_s, zt_rate rate, const char *text) {
    int64_t fields[4];
    for (int i = 0; i < 4; i++) {
        size_t digits = strspn(text, "0123456789");
        if (digits < 1 || digits > 6 || text[digits] != (i < 3 ? ':' : '\0')) return false;
        fields[i] = strtol(text, NULL, 10);
        text += digits + 1;
    }
    int64_t per_s =
        ((int64_t)rate.num + rate.den - 1) / rate.den; /* frames are counted in whole ones */
    if (fields[1] > 59 || fields[2] > 59 || fields[3] >= per_s) return false;
    int64_t seconds = (fields[0] * 60 + fields[1]) * 60 + fields[2];
    *time_s = zt_rate_time(rate, seconds * per_s + fields[3]);
    return true;
}

zt_status zt_subject_time(double *time_s, const zt_animation *animation, const char *text,
                          zt_listener listener) {
    static const struct {
        const char *unit;
        double factor;
    } units[] = {{"s", 1}, {"ms", 1e-3}, {"%", 1e-2}, {"", 1}};
    const zt_film *film = &animation->film;
    double spf = (double)film->rate.den / film->rate.num, number;
    if (read_timecode(time_s, film->rate, text)) return ZT_OK;
    size_t length = strspn(text, "+-.0123456789");
    const char *unit = text + length;
    while (isblank((unsigned char)*unit)) unit++;
    for (int i = 0; i < 4; i++) {
        if (!zt_text_equal(unit, units[i].unit)) continue;
        if (!zt_text_number(&number, text, text + length) || fabs(number) > 1e9) break;
        *time_s = number * units[i].factor;
        if (*unit == '%') *time_s *= zt_rate_time(film->rate, film->frame_count);
        if (!*unit)
            *time_s = number == rint(number) ? zt_rate_time(film->rate, (int64_t)number)
                                             : number * spf;
        return ZT_OK;
    }
    zt_tell(listener, ZT_ERROR,
            "\"%s\" is no time: a frame's number, 1.5 s, 500 ms, 00:00:01:12 or 25 %%", text);
    return ZT_EARGUMENT;
}

zt_moment_words zt_moment_in_words(zt_rate rate, double time_s) {
    zt_moment_words words;
    double frame = zt_formula_frame(rate, time_s);
    if (frame == rint(frame))
        snprintf(words.text, sizeof words.text, "frame %.0f", frame);
    else
        snprintf(words.text, sizeof words.text, "%.6g s (frame %.2f)", time_s, frame);
    return words;
}

/* ---- velocity ------------------------------------------------------------------------------
 */

/* The curve of a property with keys, else NULL. */
static const zt_curve *curve_of(const zt_subject *subject) {
    if (subject->key_count == 0) return NULL;
    return &subject->film->tracks[subject->movement].curve;
}

/* What changed from one time to another: numbers, or a turn around the axes in radians. */
static zt_status change(double *way, const zt_subject *subject, double from_s, double to_s,
                        zt_listener listener) {
    double a[ZT_SUBJECT_CHANNELS_MAX], b[ZT_SUBJECT_CHANNELS_MAX];
    ZT_TRY(zt_subject_eval(a, subject, from_s, listener));
    ZT_TRY(zt_subject_eval(b, subject, to_s, listener));
    if (subject->property->kind == ZT_VALUE_ROTATION) {
        quat qa = {a[0], a[1], a[2], a[3]}, qb = {b[0], b[1], b[2], b[3]};
        if (quat_dot(qa, qb) < 0) qb = quat_scale(qb, -1);
        vec3 turn = vec3_scale(zt_rotation_log(quat_mul(qb, quat_conjugate(qa))), 2);
        memcpy(way, &turn, sizeof turn);
    } else
        for (int c = 0; c < subject->channel_count; c++) way[c] = b[c] - a[c];
    return ZT_OK;
}

/* Whether a time is on the same way between two keys as another. */
static bool same_way(const zt_curve *curve, double a_s, double b_s) {
    zt_curve_spot a = zt_curve_find(curve, a_s), b = zt_curve_find(curve, b_s);
    return a.key == b.key && a.round == b.round &&
           (a_s < curve->times[0]) == (b_s < curve->times[0]);
}

static double way_duration_s(const zt_curve *curve, double time_s) {
    int32_t key = zt_curve_find(curve, time_s).key, last = curve->key_count - 1;
    if (key == last) key = last > 0 ? last - 1 : 0;
    return last > 0 ? curve->times[key + 1] - curve->times[key] : 1;
}

/* By a difference of second order: central, or to the one side that has no key in between. Of
 * what has no keys it is what comes next: it may jump at this moment, or have no value before.
 */
static zt_status difference(zt_explanation *e, const zt_subject *subject,
                            zt_listener listener) {
    const zt_curve *curve = curve_of(subject);
    double way_s = curve ? way_duration_s(curve, e->time_s) : 0.1;
    double h = fmax(1e-5 * way_s, 1e4 * DBL_EPSILON * fabs(e->time_s)), t = e->time_s;
    double one[ZT_SUBJECT_CHANNELS_MAX] = {0}, two[ZT_SUBJECT_CHANNELS_MAX] = {0};
    bool ahead = !curve || same_way(curve, t, t + 2 * h);
    bool behind = curve && same_way(curve, t - h, t);
    bool central = behind && ahead;
    if (!ahead && behind) h = -h;
    ZT_TRY(change(one, subject, central ? t - h : t, t + h, listener));
    if (!central) ZT_TRY(change(two, subject, t, t + 2 * h, listener));
    for (int c = 0; c < e->velocity_count; c++)
        e->velocity[c] = (central ? one[c] : 4 * one[c] - two[c]) / (2 * h);
    return ZT_OK;
}

static zt_status explain_velocity(zt_explanation *e, const zt_subject *subject,
                                  zt_listener listener) {
    const zt_curve *curve = curve_of(subject);
    bool turns = subject->property->kind == ZT_VALUE_ROTATION;
    e->velocity_channels = turns ? axes : subject->channels;
    e->velocity_count = turns ? 3 : subject->channel_count;
    double unit = turns || *subject->unit ? degrees : 1;
    /* What does not move keeps the velocity of zero. */
    e->velocity_exact =
        subject->movement < 0 || (curve && zt_curve_velocity(e->velocity, curve, e->time_s));
    if (e->velocity_exact)
        for (int c = 0; c < e->velocity_count; c++) e->velocity[c] *= unit;
    else {
        ZT_TRY(difference(e, subject, listener));
        for (int c = 0; turns && c < 3; c++) e->velocity[c] *= degrees;
    }
    return ZT_OK;
}

/* ---- all of it -----------------------------------------------------------------------------
 */

static void explain_keys(zt_explanation *e, const zt_curve *curve) {
    zt_curve_spot spot = zt_curve_find(curve, e->time_s);
    int32_t last = curve->key_count - 1;
    double first_s = curve->times[0], last_s = curve->times[last];
    bool before = e->time_s<first_s, after = e->time_s> last_s;
    e->key_before = before && spot.round == 0 ? -1 : spot.key;
    e->key_after = spot.key < last ? spot.key + 1 : -1;
    if (before && spot.round == 0) e->key_after = 0;
    e->u = spot.u;
    e->s = spot.s;
    e->round = spot.round;
    zt_curve_end end = before ? curve->before : curve->after;
    bool swings_on = after && curve->spring && end == ZT_END_HOLD;
    if ((before || after) && !swings_on) e->end = zt_curve_end_name(end);
    e->beyond_s = before ? e->time_s - first_s : after ? e->time_s - last_s : 0;
}

zt_status zt_subject_explain(zt_explanation *explanation, const zt_subject *subject,
                             double time_s, zt_listener listener) {
    const zt_animation *animation = subject->film;
    *explanation = (zt_explanation){.time_s = time_s,
                                    .frame = zt_formula_frame(animation->film.rate, time_s),
                                    .key_before = -1,
                                    .key_after = -1};
    ZT_TRY(zt_subject_eval(explanation->value, subject, time_s, listener));
    for (int c = 0; c < subject->channel_count; c++)
        explanation->cut |=
            explanation->value[c] < subject->least || explanation->value[c] > subject->most;
    ZT_TRY(explain_velocity(explanation, subject, listener));
    if (subject->key_count > 0) explain_keys(explanation, curve_of(subject));
    return ZT_OK;
}
