#include "description/doubts.h"

#include "keyframe/rotation.h"

static const double pi = 3.14159265358979323846;

typedef struct doubter {
    zt_mistakes *mistakes;
    const zt_film *film;
    const zt_property *property;
    const zt_keys *keys;
    const zt_curve *curve;
    double ranges[ZT_VALUE_WIDTH_MAX]; /* how far apart the values of a channel are */
} doubter;

static const char *when(const doubter *d, int32_t k, zt_shown *room) {
    *room = zt_show(d->keys->whens[k]->text);
    return room->text;
}

static const zt_place *place(const doubter *d, int32_t k) { return &d->keys->whens[k]->place; }

/* ---- times ----------------------------------------------------------------------------------
 */

/* Keys before the first frame or after the end, where the film cannot show them. Told of those
 * next to it. */
static void outside(const doubter *d) {
    const double *times = d->curve->times;
    double end_s = zt_rate_time(d->film->rate, d->film->frame_count), nearly = 1 + 1e-9;
    int32_t before = 0, after = d->keys->count;
    zt_shown room;
    while (before < after && times[before] < 0) before++;
    while (after > before && times[after - 1] > end_s * nearly) after--;
    if (before > 0 && d->curve->before == ZT_END_HOLD)
        zt_doubt(d->mistakes, place(d, before - 1), "the key at \"%s\" is before the film",
                 when(d, before - 1, &room));
    if (after < d->keys->count && d->curve->after == ZT_END_HOLD)
        zt_doubt(d->mistakes, place(d, after),
                 "the key at \"%s\" is after the film, which ends at %g s",
                 when(d, after, &room), end_s);
}

/* Whether the shutter is open for any frame at a time from one to another, in frames. */
static bool is_seen(const zt_film *film, double from, double to) {
    const double nearly = 1e-3;
    return ceil(from - film->shutter.close - nearly) <= to - film->shutter.open + nearly;
}

/* Keys that no frame meets. Told of the first. */
static void between_frames(const doubter *d) {
    const double nearly = 1e-3, far = 1e15;
    double rate = (double)d->film->rate.num / d->film->rate.den;
    zt_shown room;
    for (int32_t k = 0; k < d->keys->count; k++) {
        double frame = d->curve->times[k] * rate;
        if (fabs(frame) > far || fabs(frame - round(frame)) <= nearly ||
            is_seen(d->film, frame, frame))
            continue;
        zt_doubt(d->mistakes, place(d, k),
                 "the key at \"%s\" is between the frames %.0f and %.0f: none shows it",
                 when(d, k, &room), floor(frame), ceil(frame));
        return;
    }
}

/* Two keys with no frame between them, and more than half of all the movement; what is blurred
 * is meant. */
static void within_a_frame(const doubter *d, int32_t k) {
    const zt_curve *curve = d->curve;
    double rate = (double)d->film->rate.num / d->film->rate.den;
    double from = curve->times[k] * rate, to = curve->times[k + 1] * rate, frames = to - from;
    if (frames > 0.999 || d->keys->keys[k].kind == ZT_CURVE_HOLD) return;
    if (d->film->shutter.close > d->film->shutter.open && is_seen(d->film, from, to)) return;
    const double *a = curve->points + (int64_t)k * curve->point_width;
    bool large = false;
    for (int32_t c = 0; c < curve->point_width; c++)
        large |= fabs(a[c + curve->point_width] - a[c]) > 0.5 * d->ranges[c];
    if (!large) return;
    zt_shown room;
    zt_doubt(
        d->mistakes, place(d, k + 1),
        "\"%s\" is %.2g frames after the key before it, and the value jumps; \"curve: hold\" "
        "jumps at a key",
        when(d, k + 1, &room), frames);
}

/* ---- values ---------------------------------------------------------------------------------
 */

static void half_turn(const doubter *d, int32_t k) {
    const double exactly = 1e-6, nearly = pi / 180;
    const zt_curve *curve = d->curve;
    zt_curve_kind kind = d->keys->keys[k].kind;
    if (curve->value_kind != ZT_VALUE_ROTATION || curve->space != ZT_SPACE_VALUES) return;
    if (!curve->spring && (kind == ZT_CURVE_HOLD || kind == ZT_CURVE_HERMITE)) return;
    const double *v = curve->values + 4 * (int64_t)k;
    double angle =
        zt_rotation_angle((quat){v[0], v[1], v[2], v[3]}, (quat){v[4], v[5], v[6], v[7]});
    if (angle < pi - nearly) return;
    if (angle < pi - exactly)
        zt_doubt(
            d->mistakes, place(d, k + 1),
            "nearly half a turn from the key before it: a little more, and it goes the other "
            "way round; a key between them says which one");
    else
        zt_doubt(
            d->mistakes, place(d, k + 1),
            "half a turn from the key before it: both ways round are as short; a key between "
            "them says which one");
}

/* Handles of a Bezier way that reach beyond its other end. */
static void long_handles(const doubter *d, int32_t k) {
    const zt_key *key = &d->keys->keys[k];
    if (d->curve->spring || key->kind != ZT_CURVE_BEZIER) return;
    double way_s = (key[1].time_s - key->time_s) * (1 + 1e-9);
    const char *const text =
        "the \"%s\" handle of this key is longer than the way, which would run "
        "backwards; it is shortened to it";
    if (key->after_s > way_s) zt_doubt(d->mistakes, place(d, k), text, "out");
    if (key[1].before_s > way_s) zt_doubt(d->mistakes, place(d, k + 1), text, "in");
}

/* ---- all of it ------------------------------------------------------------------------------
 */

static void find_ranges(doubter *d) {
    const zt_curve *curve = d->curve;
    for (int32_t c = 0; c < curve->point_width; c++) {
        double min = INFINITY, max = -INFINITY;
        for (int32_t k = 0; k < curve->key_count; k++) {
            double x = curve->points[(int64_t)k * curve->point_width + c];
            min = fmin(min, x);
            max = fmax(max, x);
        }
        d->ranges[c] = max - min;
    }
}

void zt_doubts_tell(zt_reading *reading, const zt_property *property, const zt_keys *keys,
                    const zt_curve *curve) {
    doubter d = {.mistakes = &reading->mistakes,
                 .film = &reading->animation->film,
                 .property = property,
                 .keys = keys,
                 .curve = curve};
    if (curve->clipped)
        zt_doubt(d.mistakes, place(&d, 0),
                 "\"%s\" would move further than numbers reach; it goes as far as they do",
                 property->name);
    find_ranges(&d);
    outside(&d);
    between_frames(&d);
    for (int32_t k = 0; k + 1 < keys->count; k++) {
        within_a_frame(&d, k);
        half_turn(&d, k);
        long_handles(&d, k);
    }
}
