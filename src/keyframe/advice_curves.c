/* What of a film's curves is likely not meant: values beyond their range, or too large for a
 * number, and movement between equal keys. */
#include "keyframe/advice.h"

#include <float.h>
#include <math.h>

#include "keyframe/curve_inside.h"

/* The place of the key before a moment, or of the whole property. */
static const zt_place *place_at(const zt_track *track, double time_s) {
    if (!track->key_places) return track->place.line > 0 ? &track->place : NULL;
    return &track->key_places[zt_curve_find(&track->curve, time_s).key];
}

/* ---- values that leave their range ---------------------------------------------------------
 */

/* How far the worst value that was met is outside of its range, and where that was. */
typedef struct worst {
    double beyond, value, bound, time_s;
} worst;

static void look_at(worst *w, const zt_track *track, double time_s) {
    const zt_property *property = track->property;
    double unit = zt_property_unit(property), value[ZT_VALUE_WIDTH_MAX];
    zt_curve_eval(value, &track->curve, time_s);
    for (int c = 0; c < zt_value_width(property->kind); c++) {
        double written = value[c] / unit;
        double bound = written < property->min ? property->min : property->max;
        double beyond = written < property->min   ? property->min - written
                        : written > property->max ? written - property->max
                                                  : 0;
        if (beyond > w->beyond) *w = (worst){beyond, written, bound, time_s};
    }
}

/* Whether all values of a curve are between those of its keys. */
static bool stays_between_keys(const zt_curve *curve) {
    if (curve->spring || curve->space != ZT_SPACE_VALUES) return false;
    if (curve->before == ZT_END_LINEAR || curve->before == ZT_END_LOOP_WITH_OFFSET ||
        curve->after == ZT_END_LINEAR || curve->after == ZT_END_LOOP_WITH_OFFSET)
        return false;
    for (int32_t k = 0; k + 1 < curve->key_count; k++)
        if (curve->kinds[k] > ZT_CURVE_SMOOTH || (curve->eases && curve->eases[k]))
            return false;
    return true;
}

/* Where a cubic with these control points turns round: up to two parameters within 0..1. */
static int turning_points(double s[2], const double p[4]) {
    double a = p[1] - p[0], b = p[2] - p[1], c = p[3] - p[2];
    /* a t^2 + 2 b s t + c s^2 = 0 with t = 1 - s: (a - 2b + c) s^2 + 2 (b - a) s + a = 0 */
    double square = a - 2 * b + c, half = b - a, root = half * half - square * a;
    int count = 0;
    if (!(root >= 0)) return 0;
    double q = -(half + copysign(sqrt(root), half)); /* without cancellation */
    double candidates[2] = {q / square, a / q};
    for (int i = 0; i < 2; i++)
        if (candidates[i] > 0 && candidates[i] < 1) s[count++] = candidates[i];
    return count;
}

static double way_time(const zt_curve *curve, int32_t way, double s) {
    if (curve->kinds[way] == ZT_CURVE_BEZIER) {
        const double *x = curve->handle_times[way];
        s = 3 * s * (1 - s) * (x[0] * (1 - s) + x[1] * s) + s * s * s;
    }
    return curve->times[way] + s * (curve->times[way + 1] - curve->times[way]);
}

/* Looks at the curve where a channel of a cubic way turns round, if the film shows it. */
static void look_at_turning_points(worst *w, const zt_track *track, int32_t way,
                                   double last_s) {
    const zt_curve *curve = &track->curve;
    int32_t width = curve->point_width;
    const double *a = curve->points + (int64_t)way * width;
    const double *controls = curve->controls + (int64_t)way * curve->control_width;
    for (int32_t c = 0; c < width; c++) {
        double s[2], points[4] = {a[c], controls[c], controls[width + c], a[width + c]};
        int count = turning_points(s, points);
        for (int i = 0; i < count; i++) {
            double time_s = way_time(curve, way, s[i]);
            if (time_s >= 0 && time_s <= last_s) look_at(w, track, time_s);
        }
    }
}

static void advise_range(const zt_animation *animation, const zt_track *track,
                         zt_listener listener) {
    const zt_property *property = track->property;
    const zt_curve *curve = &track->curve;
    const zt_film *film = &animation->film;
    if ((isinf(property->min) && isinf(property->max)) || stays_between_keys(curve)) return;
    worst w = {0};
    int64_t count = zt_advice_moment_count(film, ZT_ADVICE_MOMENTS_MAX);
    for (int64_t i = 0; i < count; i++) look_at(&w, track, zt_advice_moment_s(film, i, count));
    double last_s = zt_rate_time(film->rate, film->frame_count - 1);
    int32_t ways = curve->key_count - 1;
    for (int32_t way = 0; way < ways && way < ZT_ADVICE_MOMENTS_MAX; way++)
        if (!curve->spring && curve->kinds[way] > ZT_CURVE_LINEAR &&
            !(curve->eases && curve->eases[way]) && !zt_curve_is_on_sphere(curve))
            look_at_turning_points(&w, track, way, last_s);
    if (w.beyond <= 1e-9 * fmax(1, fabs(w.bound))) return;
    const char *unit = property->unit ? property->unit : "";
    const char *gap = property->unit ? " " : "";
    zt_tell_at(listener, ZT_WARNING, place_at(track, w.time_s),
               "%s reaches %.4g%s%s at %s; it is kept at %g%s%s, the %s it can be", track->name,
               w.value, gap, unit, zt_moment_in_words(film->rate, w.time_s).text, w.bound, gap,
               unit, w.value < w.bound ? "least" : "most");
}

/* ---- values too large for a number ---------------------------------------------------------
 */

/* Curves keep to finite numbers (zt_curve_finite); told where one had to. */
static void advise_overflow(const zt_animation *animation, const zt_track *track,
                            zt_listener listener) {
    if (track->curve.clipped || stays_between_keys(&track->curve))
        return; /* told, or cannot be */
    const zt_film *film = &animation->film;
    int64_t count = zt_advice_moment_count(film, ZT_ADVICE_MOMENTS_MAX);
    for (int64_t i = 0; i < count; i++) {
        double value[ZT_VALUE_WIDTH_MAX], time_s = zt_advice_moment_s(film, i, count);
        zt_curve_eval(value, &track->curve, time_s);
        for (int32_t c = 0; c < track->curve.width; c++) {
            if (fabs(value[c]) < DBL_MAX) continue;
            zt_tell_at(listener, ZT_WARNING, place_at(track, time_s),
                       "%s becomes too large for a number at %s; it is kept at %.4g",
                       track->name, zt_moment_in_words(film->rate, time_s).text, value[c]);
            return;
        }
    }
}

/* ---- movement between two equal keys -------------------------------------------------------
 */

/* How far a way goes from its first key's value, relative to the largest number of the track;
 * looked at in some places within. */
static double excursion(const zt_curve *curve, int32_t way, double size) {
    enum { PLACES = 16 };
    const double *key = curve->values + (int64_t)way * curve->width;
    double value[ZT_VALUE_WIDTH_MAX], most = 0;
    for (int i = 1; i < PLACES; i++) {
        zt_curve_eval(value, curve, way_time(curve, way, (double)i / PLACES));
        for (int32_t c = 0; c < curve->width; c++) most = fmax(most, fabs(value[c] - key[c]));
    }
    return size > 0 ? most / size : most;
}

static bool equal_keys(const zt_curve *curve, int32_t way) {
    const double *a = curve->values + (int64_t)way * curve->width;
    for (int32_t c = 0; c < curve->width; c++)
        if (a[c] != a[curve->width + c]) return false;
    return true;
}

/* Told once a track: where one way is meant, so are the others. */
static void advise_equal_keys(const zt_track *track, zt_listener listener) {
    const zt_curve *curve = &track->curve;
    if (curve->spring) return; /* it swings where its keys rest, as it should */
    double size = 0;
    for (int64_t i = 0; i < (int64_t)curve->key_count * curve->width; i++)
        size = fmax(size, fabs(curve->values[i]));
    for (int32_t way = 0; way + 1 < curve->key_count && way < ZT_ADVICE_MOMENTS_MAX; way++) {
        if (curve->kinds[way] <= ZT_CURVE_SMOOTH || !equal_keys(curve, way)) continue;
        if (excursion(curve, way, size) <= 1e-6) continue;
        zt_tell_at(listener, ZT_WARNING, track->key_places ? &track->key_places[way] : NULL,
                   "%s moves between this key and the next, which are equal; \"curve: hold\" "
                   "holds still",
                   track->name);
        return;
    }
}

/* ---- all of it -----------------------------------------------------------------------------
 */

void zt_advice_curves(const zt_animation *animation, zt_listener listener) {
    for (int32_t i = 0; i < animation->track_count; i++) {
        const zt_track *track = &animation->tracks[i];
        if (track->kind != ZT_TRACK_CURVE) continue;
        advise_range(animation, track, listener);
        advise_overflow(animation, track, listener);
        advise_equal_keys(track, listener);
    }
}
