/* What was chosen for a frame, in words: its precision, and how its time is divided. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>

#include "base/diag.h"
#include "base/random.h"
#include "keyframe/advice.h"
#include "sequence/renderer.h"

/* ---- precision ------------------------------------------------------------------------------
 */

/* What asks for double precision. */
static void say_why(char *text, size_t size, const zt_accuracy *a, const zt_scene *scene,
                    const zt_animation *animation) {
    const char *name = a->object < 0 ? "" : zt_advice_name_of_object(animation, a->object).text;
    switch (a->reason) {
    case ZT_ACCURACY_NEAR:
        snprintf(text, size,
                 "the camera is %.3g from %s, whose numbers reach %.4g; single precision would "
                 "be off by %.2g, and %.2g can be seen",
                 a->distance, name, a->number, a->wrong, a->seen);
        break;
    case ZT_ACCURACY_NARROW:
        snprintf(
            text, size,
            "%s is %.3g from the camera, in a view so narrow that %.2g can be seen; single "
            "precision would be off by %.2g",
            name, a->distance, a->seen, a->wrong);
        break;
    case ZT_ACCURACY_LAMP:
        snprintf(text, size,
                 "%s is %.3g from %s, whose numbers reach %.4g; single precision would be off "
                 "by %.2g",
                 zt_advice_name_of(animation, ZT_OWNER_POINT, a->other).text, a->distance, name,
                 a->number, a->wrong);
        break;
    case ZT_ACCURACY_TWIN:
        snprintf(
            text, size,
            "%s and %s are %.3g apart and their numbers reach %.4g; single precision would "
            "be off by %.2g",
            name, zt_advice_name_of_object(animation, a->other).text, a->distance, a->number,
            a->wrong);
        break;
    case ZT_ACCURACY_RANGE:
        snprintf(text, size,
                 "of %s a number is %.3g, whose square single precision cannot hold", name,
                 a->number);
        break;
    case ZT_ACCURACY_STRETCH:
        snprintf(text, size,
                 "%s is stretched %.3g times more one way than another, and single precision "
                 "has no digits left for it",
                 name, a->number);
        break;
    case ZT_ACCURACY_MIRRORS:
        snprintf(text, size,
                 "rays may meet %" PRId32 " mirrors one after the other, and the roundings of "
                 "single precision would add up",
                 scene->reflection_depth);
        break;
    case ZT_ACCURACY_FINE:
        snprintf(text, size, "its roundings stay below what can be seen");
        break;
    }
}

static void say_precision(zt_frame_choices *choices, const zt_renderer *r,
                          const zt_ready *ready, const zt_scene *scene) {
    const zt_accuracy *a = &ready->accuracy;
    const size_t size = sizeof choices->precision_text;
    char why[256];
    say_why(why, sizeof why, a, scene, r->animation);
    choices->precision = ready->precision;
    if (r->precision == ZT_PRECISION_DOUBLE)
        snprintf(choices->precision_text, size, "double precision, as asked for");
    else if (r->precision == ZT_PRECISION_SINGLE)
        snprintf(choices->precision_text, size, "single precision, as asked for%s%s",
                 a->reason == ZT_ACCURACY_FINE ? ": " : ", though ", why);
    else
        snprintf(choices->precision_text, size, "%s precision: %s",
                 ready->precision == ZT_PRECISION_SINGLE ? "single" : "double", why);
}

/* ---- motion ---------------------------------------------------------------------------------
 */

static const char *name_of(const zt_animation *animation, zt_part_thing thing) {
    return zt_advice_name_of(animation, thing.owner, thing.index).text;
}

/* "ball is at most 0.2 px off its way". */
static void say_off(char *text, size_t size, const zt_division *d,
                    const zt_animation *animation) {
    const char *name = name_of(animation, d->worst);
    if (d->worst.is_place)
        snprintf(text, size, "%s is at most %.2g px off its way", name,
                 d->off * animation->film.shutter.error);
    else
        snprintf(text, size, "%s is at most %.2g %% off", name, d->off * ZT_CHORD_SHARE * 100);
}

static void say_motion(char *text, size_t size, const zt_division *d,
                       const zt_animation *animation) {
    const zt_shutter *shutter = &animation->film.shutter;
    char off[128] = "all goes straight on", because[128] = "", steps[128] = "";
    *text = '\0';
    if (shutter->close <= shutter->open) return;
    if (d->off > 0) say_off(off, sizeof off, d, animation);
    if (d->asked)
        snprintf(because, sizeof because, ", because of %s", name_of(animation, d->most));
    if (d->stepping >= 0)
        snprintf(steps, sizeof steps, "; %s changes at once",
                 animation->tracks[d->stepping].name);
    double degrees = (shutter->close - shutter->open) * 360;
    if (d->moment_count == 1)
        snprintf(text, size, "%.4g degrees open: nothing moves", degrees);
    else
        snprintf(text, size, "%.4g degrees open: %" PRId32 " moments%s; %s%s%s", degrees,
                 d->moment_count, because, off, steps,
                 d->off > 1 ? "; that is more than can be met" : "");
}

/* ---- both -----------------------------------------------------------------------------------
 */

static uint64_t add_thing(uint64_t key, zt_part_thing thing) {
    return zt_random_key(zt_random_key(key, thing.owner), (uint64_t)thing.index);
}

/* What the sentences are about; of moments, about how many. */
static int64_t cause_of(const zt_accuracy *a, const zt_division *d) {
    uint64_t key = zt_random_key(a->reason, (uint64_t)a->object);
    key = zt_random_key(key, (uint64_t)a->other);
    key = zt_random_key(key, (uint64_t)ilogb(d->moment_count));
    if (d->asked) key = add_thing(key, d->most);
    if (d->off > 0) key = add_thing(key, d->worst);
    key = zt_random_key(key, d->off > 1);
    return (int64_t)zt_random_key(key, (uint64_t)d->stepping);
}

void zt_renderer_say(zt_frame_choices *choices, const zt_renderer *r, const zt_ready *ready,
                     const zt_exposure *exposure, const zt_division *division) {
    say_precision(choices, r, ready, exposure->moments);
    say_motion(choices->motion_text, sizeof choices->motion_text, division, r->animation);
    choices->moment_count = exposure->moment_count;
    choices->cause = cause_of(&ready->accuracy, division);
}

void zt_renderer_doubt(zt_renderer *r, const zt_ready *ready, const zt_exposure *exposure,
                       const zt_division *division, int64_t frame) {
    bool single = ready->precision == ZT_PRECISION_SINGLE;
    char why[256];
    if (single && ready->accuracy.reason != ZT_ACCURACY_FINE && !r->told_precision) {
        say_why(why, sizeof why, &ready->accuracy, exposure->moments, r->animation);
        zt_tell(r->listener, ZT_WARNING, "frame %" PRId64 " asks for double precision: %s",
                frame, why);
        r->told_precision = true;
    }
    if (division->off > 1 && !r->told_motion) {
        say_off(why, sizeof why, division, r->animation);
        zt_tell(r->listener, ZT_WARNING,
                "frame %" PRId64 " asks for more than its %" PRId32 " moments: %s", frame,
                division->moment_count, why);
        r->told_motion = true;
    }
}
